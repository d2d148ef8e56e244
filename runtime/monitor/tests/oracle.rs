//! The monitors of the language's requirement patterns against oracles that look at the whole trace at once.

use hrdsl_ir::{
    ActorId, Event, EventId, EventPattern, Expr, Nanos, Program, Span, Type, Unit, Value,
    expr::{BinaryOp, UnaryOp},
    monitor::{
        Monitor, MonitorEdge, MonitorEffect, MonitorMargin, MonitorState, MonitorTrigger, RequirementKind,
        StateId,
    },
    world::{Signal, SignalId},
};
use hrdsl_monitor::{MonitorOutcome, MonitorRunner, MonitorVerdict};
use hrdsl_trace::{Trace, TraceStep, TraceStepKind};
use proptest::prelude::*;

use MonitorEffect::{Discharge, Fail, ResetClock, Trigger};

const E: u16 = 0;
const F: u16 = 1;
const UNTIL: u16 = 2;
const LIMIT: f64 = 5.0;

fn pattern(event: u16) -> EventPattern {
    EventPattern { event: EventId(event), args: Vec::new() }
}

fn on(event: u16) -> MonitorTrigger {
    MonitorTrigger::Event(vec![pattern(event)])
}

fn edge(
    from: u16,
    to: u16,
    on: MonitorTrigger,
    guard: Option<Expr>,
    effects: &[MonitorEffect],
) -> MonitorEdge {
    MonitorEdge { from: StateId(from), to: StateId(to), on, guard, clock: None, effects: effects.to_vec() }
}

fn monitor(
    states: &[(&str, bool, Option<Nanos>)],
    edges: Vec<MonitorEdge>,
    signals: Vec<SignalId>,
) -> Monitor {
    let states = states
        .iter()
        .map(|&(name, pending, deadline)| MonitorState { name: name.to_owned(), pending, deadline })
        .collect();
    Monitor {
        name: "R".to_owned(),
        kind: RequirementKind::Safety,
        title: String::new(),
        doc: String::new(),
        text: String::new(),
        signals,
        states,
        initial: StateId(0),
        at_start: Vec::new(),
        conditions: Vec::new(),
        edges,
        margin: None,
        formula: None,
        origin: Span::default(),
    }
}

/// `E causes F within D`; without a bound: `E causes F`.
fn causes(within: Option<Nanos>) -> Monitor {
    monitor(
        &[("idle", false, None), ("pending", true, within)],
        vec![
            edge(0, 1, on(E), None, &[Trigger, ResetClock]),
            edge(1, 0, on(F), None, &[Discharge]),
            edge(1, 0, MonitorTrigger::Deadline, None, &[Fail]),
            edge(1, 1, on(E), None, &[Trigger]),
        ],
        Vec::new(),
    )
}

/// `E forbids F until UNTIL`
fn forbids() -> Monitor {
    monitor(
        &[("free", false, None), ("forbidden", false, None)],
        vec![
            edge(0, 1, on(E), None, &[Trigger]),
            edge(1, 1, on(F), None, &[Fail]),
            edge(1, 0, on(UNTIL), None, &[Discharge]),
            edge(1, 1, on(E), None, &[Trigger]),
        ],
        Vec::new(),
    )
}

fn below() -> Expr {
    Expr::binary(BinaryOp::Lt, Expr::Var(0), Expr::float(LIMIT))
}

/// `never E while x < LIMIT`
fn never() -> Monitor {
    let mut never = monitor(
        &[("watch", false, None)],
        vec![
            edge(0, 0, on(E), Some(below()), &[Trigger, Fail]),
            edge(0, 0, on(E), None, &[Trigger, Discharge]),
        ],
        vec![SignalId(0)],
    );
    let value = Expr::binary(BinaryOp::Sub, Expr::Var(0), Expr::float(LIMIT));
    never.margin = Some(MonitorMargin { value, unit: Unit::Metre, at: vec![pattern(E)], within: Vec::new() });
    never
}

/// `globally x < LIMIT`
fn globally() -> Monitor {
    let above = || Some(Expr::Unary(UnaryOp::Not, Box::new(below())));
    let mut globally = monitor(
        &[("unseen", false, None), ("holds", false, None), ("broken", false, None)],
        vec![
            edge(0, 1, MonitorTrigger::Sample, Some(below()), &[Trigger]),
            edge(0, 2, MonitorTrigger::Sample, above(), &[Trigger, Fail]),
            edge(1, 2, MonitorTrigger::Sample, above(), &[Fail]),
            edge(2, 1, MonitorTrigger::Sample, Some(below()), &[]),
        ],
        vec![SignalId(0)],
    );
    let value = Expr::binary(BinaryOp::Sub, Expr::float(LIMIT), Expr::Var(0));
    globally.margin = Some(MonitorMargin { value, unit: Unit::Metre, at: Vec::new(), within: Vec::new() });
    globally
}

fn program(monitors: Vec<Monitor>) -> Program {
    let event = |name: &str| Event {
        name: name.to_owned(),
        params: Vec::new(),
        from: ActorId(0),
        to: Vec::new(),
        stimulus: None,
        origin: Span::default(),
    };
    let signal = |name: &str| Signal {
        name: name.to_owned(),
        ty: Type::Float(Unit::Metre),
        to: Vec::new(),
        terms: Vec::new(),
        value: Expr::float(0.0),
        recorded: true,
        origin: Span::default(),
    };
    Program {
        events: ["e", "f", "until", "other"].map(event).to_vec(),
        signals: ["x", "y"].map(signal).to_vec(),
        monitors,
        ..Program::default()
    }
}

fn judge(monitors: Vec<Monitor>, trace: &Trace) -> Vec<MonitorVerdict> {
    let mut checker = MonitorRunner::new(&program(monitors));
    trace.replay(&mut checker);
    checker.verdicts()
}

fn judge_one(monitor: Monitor, trace: &Trace) -> MonitorVerdict {
    judge(vec![monitor], trace).remove(0)
}

/// Short traces with small gaps, so that steps coincide with each other and with deadlines.
fn traces() -> impl Strategy<Value = Trace> {
    let event = (0u16..4).prop_map(|e| TraceStepKind::Event { event: EventId(e), args: Vec::new() });
    let sample = (0u16..2, 0i32..10)
        .prop_map(|(s, v)| TraceStepKind::Sample { signal: SignalId(s), value: Value::Float(f64::from(v)) });
    let step = (0i64..5, prop_oneof![2 => event, 1 => sample]);
    (prop::collection::vec(step, 0..40), 0i64..12).prop_map(|(gaps, rest)| {
        let mut time = 0;
        let steps = gaps
            .into_iter()
            .map(|(gap, what)| {
                time += gap;
                TraceStep { time, what }
            })
            .collect();
        Trace { steps, end: time + rest }
    })
}

fn events(trace: &Trace) -> Vec<(usize, Nanos, u16)> {
    let only = |(i, s): (usize, &TraceStep)| match &s.what {
        TraceStepKind::Event { event, .. } => Some((i, s.time, event.0)),
        TraceStepKind::Sample { .. } | TraceStepKind::Machine(_) => None,
    };
    trace.steps.iter().enumerate().filter_map(only).collect()
}

/// The samples of `x`.
fn samples(trace: &Trace) -> Vec<(usize, Nanos, f64)> {
    let only = |(i, s): (usize, &TraceStep)| match s.what {
        TraceStepKind::Sample { signal: SignalId(0), value } => Some((i, s.time, value.as_f64().unwrap())),
        TraceStepKind::Sample { .. } | TraceStepKind::Event { .. } | TraceStepKind::Machine(_) => None,
    };
    trace.steps.iter().enumerate().filter_map(only).collect()
}

#[derive(Debug, Default, PartialEq)]
struct Expected {
    triggered: usize,
    discharged: usize,
    /// Times of all failures, and the step of each.
    failures: Vec<(Nanos, Option<usize>)>,
    pending_since: Option<Nanos>,
}

fn agree(verdict: &MonitorVerdict, expected: &Expected) -> Result<(), TestCaseError> {
    prop_assert_eq!(verdict.triggered as usize, expected.triggered);
    prop_assert_eq!(verdict.discharged as usize, expected.discharged);
    prop_assert_eq!(verdict.failures as usize, expected.failures.len());
    let first = verdict.first_failure.as_ref().map(|v| (v.time, v.step));
    prop_assert_eq!(first, expected.failures.first().copied());
    prop_assert_eq!(verdict.pending_since, expected.pending_since);
    let outcome = match expected {
        e if !e.failures.is_empty() => MonitorOutcome::Fail,
        e if e.pending_since.is_some() => MonitorOutcome::Inconclusive,
        e if e.triggered == 0 => MonitorOutcome::Vacuous,
        _ => MonitorOutcome::Pass,
    };
    prop_assert_eq!(verdict.outcome, outcome);
    Ok(())
}

/// Cuts the list of events into episodes: each starts with a trigger and lasts until its answer or its deadline.
fn expect_response(trace: &Trace, within: Nanos) -> Expected {
    let events = events(trace);
    let mut expected =
        Expected { triggered: events.iter().filter(|e| e.2 == E).count(), ..Expected::default() };
    let mut rest = events.as_slice();
    while let Some(start) = rest.iter().position(|e| e.2 == E) {
        let begun = rest[start].1;
        let deadline = begun.saturating_add(within);
        rest = &rest[start + 1..];
        let in_time = rest.partition_point(|e| e.1 <= deadline);
        if let Some(answer) = rest[..in_time].iter().position(|e| e.2 == F) {
            expected.discharged += 1;
            rest = &rest[answer + 1..];
        } else if deadline <= trace.end {
            expected.failures.push((deadline, None));
            rest = &rest[in_time..];
        } else {
            expected.pending_since = Some(begun);
            break;
        }
    }
    expected
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn bounded_response(trace in traces(), within in 0i64..15) {
        agree(&judge_one(causes(Some(within)), &trace), &expect_response(&trace, within))?;
    }

    #[test]
    fn unbounded_response(trace in traces()) {
        agree(&judge_one(causes(None), &trace), &expect_response(&trace, Nanos::MAX))?;
    }

    #[test]
    fn the_first_trigger_begins_the_counterexample(trace in traces(), within in 0i64..15) {
        if let Some(violation) = judge_one(causes(Some(within)), &trace).first_failure {
            prop_assert_eq!(violation.trigger_time + within, violation.time);
            let trigger = &trace.steps[violation.counterexample[0].index];
            for seen in &violation.counterexample {
                prop_assert_eq!(&seen.step, &trace.steps[seen.index], "what is shown is what was there");
            }
            prop_assert_eq!(trigger.time, violation.trigger_time);
            prop_assert_eq!(&trigger.what, &TraceStepKind::Event { event: EventId(E), args: Vec::new() });
        }
    }

    #[test]
    fn forbid_until(trace in traces()) {
        let events = events(&trace);
        // What the last trigger or release before each event was.
        let before = |k: usize| events[..k].iter().rev().find(|e| e.2 == E || e.2 == UNTIL).map(|e| e.2);
        let mut expected = Expected::default();
        for (k, &(step, time, event)) in events.iter().enumerate() {
            let armed = before(k) == Some(E);
            expected.triggered += usize::from(event == E);
            expected.discharged += usize::from(event == UNTIL && armed);
            if event == F && armed {
                expected.failures.push((time, Some(step)));
            }
        }
        agree(&judge_one(forbids(), &trace), &expected)?;
    }

    #[test]
    fn never_while(trace in traces()) {
        let samples = samples(&trace);
        let mut expected = Expected::default();
        let mut worst: Option<(f64, Nanos)> = None;
        for (step, time, _) in events(&trace).into_iter().filter(|e| e.2 == E) {
            let latest = samples.iter().rev().find(|s| s.0 < step).map(|s| s.2);
            let fails = latest.is_some_and(|x| x < LIMIT);
            expected.triggered += 1;
            expected.discharged += usize::from(!fails);
            if fails {
                expected.failures.push((time, Some(step)));
            }
            if let Some(margin) = latest.map(|x| x - LIMIT) && worst.is_none_or(|w| margin < w.0) {
                worst = Some((margin, time));
            }
        }
        let verdict = judge_one(never(), &trace);
        agree(&verdict, &expected)?;
        prop_assert_eq!(verdict.worst_margin, worst);
    }

    #[test]
    fn globally_holds(trace in traces()) {
        // Of the samples of one instant the last counts.
        let all = samples(&trace);
        let last = |(k, s): &(usize, &(usize, Nanos, f64))| all.get(k + 1).is_none_or(|next| next.1 > s.1);
        let samples: Vec<_> = all.iter().enumerate().filter(last).map(|(_, s)| *s).collect();
        // One failure for each stretch of bad samples.
        let begins = |k: usize| samples[k].2 >= LIMIT && (k == 0 || samples[k - 1].2 < LIMIT);
        let expected = Expected {
            triggered: usize::from(!samples.is_empty()),
            failures: (0..samples.len()).filter(|&k| begins(k)).map(|k| (samples[k].1, Some(samples[k].0))).collect(),
            ..Expected::default()
        };
        let verdict = judge_one(globally(), &trace);
        agree(&verdict, &expected)?;
        let highest = samples.iter().map(|s| s.2).fold(f64::NEG_INFINITY, f64::max);
        let first = samples.iter().find(|s| s.2 == highest).map(|s| (LIMIT - highest, s.1));
        prop_assert_eq!(verdict.worst_margin, first);
    }

    /// The shared index and the shared clock of deadlines do not let monitors disturb each other.
    #[test]
    fn monitors_do_not_see_each_other(trace in traces(), within in 0i64..15) {
        let all = vec![causes(Some(within)), forbids(), never(), causes(Some(3)), globally(), causes(None)];
        let together = judge(all.clone(), &trace);
        for (index, alone) in all.into_iter().enumerate() {
            let mut alone = judge_one(alone, &trace);
            alone.monitor = index;
            prop_assert_eq!(&together[index], &alone);
        }
    }

    /// Steps that no monitor reads change nothing but the indices.
    #[test]
    fn foreign_steps_change_nothing(trace in traces(), within in 0i64..15) {
        let foreign = |s: &TraceStep| match &s.what {
            TraceStepKind::Event { event, .. } => event.0 == 3,
            TraceStepKind::Sample { signal, .. } => signal.0 == 1,
            TraceStepKind::Machine(_) => false,
        };
        let mut bare = trace.clone();
        bare.steps.retain(|s| !foreign(s));
        for monitor in [causes(Some(within)), forbids(), never(), globally()] {
            let (with, without) = (judge_one(monitor.clone(), &trace), judge_one(monitor, &bare));
            prop_assert_eq!((with.outcome, with.triggered, with.discharged, with.failures, with.worst_margin),
                (without.outcome, without.triggered, without.discharged, without.failures, without.worst_margin));
            let time = |v: MonitorVerdict| v.first_failure.map(|f| (f.time, f.trigger_time));
            prop_assert_eq!(time(with), time(without));
        }
    }
}

#[test]
fn a_long_trace_is_no_trouble() {
    let step = |i: i64| TraceStep {
        time: i * 7,
        what: TraceStepKind::Event { event: EventId((i % 4) as u16), args: Vec::new() },
    };
    let trace = Trace { steps: (0..200_000).map(step).collect(), end: 1_400_000 };
    let verdict = judge_one(causes(Some(7)), &trace);
    assert_eq!((verdict.outcome, verdict.discharged), (MonitorOutcome::Pass, 50_000));
}

/// Two signals that move together: between their samples of one instant one is new and the other old.
#[test]
fn samples_of_one_instant_are_one() {
    let differ = Expr::binary(BinaryOp::Ne, Expr::Var(0), Expr::Var(1));
    let equal = monitor(
        &[("watch", false, None)],
        vec![
            edge(0, 0, MonitorTrigger::Sample, Some(differ), &[Trigger, Fail]),
            edge(0, 0, MonitorTrigger::Sample, None, &[Trigger]),
        ],
        vec![SignalId(0), SignalId(1)],
    );
    let sample = |time, signal, x| TraceStep {
        time,
        what: TraceStepKind::Sample { signal: SignalId(signal), value: Value::Float(x) },
    };
    let mut steps = vec![sample(0, 0, 1.0), sample(0, 1, 1.0), sample(7, 0, 2.0), sample(7, 1, 2.0)];
    let together = judge_one(equal.clone(), &Trace { steps: steps.clone(), end: 9 });
    assert_eq!((together.outcome, together.triggered), (MonitorOutcome::Pass, 2));
    steps[3].time = 8;
    let apart = judge_one(equal, &Trace { steps, end: 9 });
    assert_eq!(
        (apart.outcome, apart.failures, apart.first_failure.unwrap().time),
        (MonitorOutcome::Fail, 1, 7)
    );
}
