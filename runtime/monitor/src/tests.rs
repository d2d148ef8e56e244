//! Unit tests of the checker on small automata built by hand.

use hrdsl_ir::{
    ActorId, ArgPattern, Event, EventId, Expr, Span, Symbol, Type, Unit, Value,
    expr::BinaryOp,
    monitor::{Monitor, MonitorEdge, MonitorEffect, MonitorMargin, MonitorState, RequirementKind, StateId},
    world::{Signal, SignalId},
};
use hrdsl_trace::Trace;

use super::*;

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
        events: vec![event("ask"), event("answer"), event("noise")],
        signals: vec![signal("near"), signal("far")],
        monitors,
        ..Program::default()
    }
}

fn indices(counterexample: &[SeenStep]) -> Vec<usize> {
    counterexample.iter().map(|seen| seen.index).collect()
}

fn monitor(states: &[(bool, Option<Nanos>)], edges: Vec<MonitorEdge>) -> Monitor {
    let state = |&(pending, deadline): &(bool, Option<Nanos>)| MonitorState {
        name: String::new(),
        pending,
        deadline,
    };
    Monitor {
        name: "R".to_owned(),
        kind: RequirementKind::Functional,
        title: String::new(),
        doc: String::new(),
        text: String::new(),
        signals: vec![SignalId(0), SignalId(1)],
        states: states.iter().map(state).collect(),
        initial: StateId(0),
        at_start: Vec::new(),
        conditions: Vec::new(),
        edges,
        margin: None,
        formula: None,
        origin: Span::default(),
    }
}

fn edge(from: u16, to: u16, on: MonitorTrigger, effects: &[MonitorEffect]) -> MonitorEdge {
    MonitorEdge {
        from: StateId(from),
        to: StateId(to),
        on,
        guard: None,
        clock: None,
        effects: effects.to_vec(),
    }
}

fn on(event: u16) -> MonitorTrigger {
    MonitorTrigger::Event(vec![EventPattern { event: EventId(event), args: Vec::new() }])
}

fn happens(time: Nanos, event: u16) -> TraceStep {
    TraceStep { time, what: TraceStepKind::Event { event: EventId(event), args: Vec::new() } }
}

fn reads(time: Nanos, signal: u16, value: f64) -> TraceStep {
    TraceStep { time, what: TraceStepKind::Sample { signal: SignalId(signal), value: Value::Float(value) } }
}

fn check(monitor: Monitor, steps: Vec<TraceStep>, end: Nanos) -> MonitorVerdict {
    let mut checker = MonitorRunner::new(&program(vec![monitor]));
    Trace { steps, end }.replay(&mut checker);
    checker.verdicts().remove(0)
}

/// `ask` is followed by `answer` within 10 ns.
fn response() -> Monitor {
    use MonitorEffect::{Discharge, Fail, ResetClock, Trigger};
    monitor(
        &[(false, None), (true, Some(10))],
        vec![
            edge(0, 1, on(0), &[Trigger, ResetClock]),
            edge(1, 0, on(1), &[Discharge]),
            edge(1, 0, MonitorTrigger::Deadline, &[Fail]),
            edge(1, 1, on(0), &[Trigger]),
        ],
    )
}

#[test]
fn an_answer_at_the_very_deadline_is_in_time() {
    let verdict = check(response(), vec![happens(5, 0), happens(15, 1)], 100);
    assert_eq!((verdict.outcome, verdict.discharged), (MonitorOutcome::Pass, 1));
    let verdict = check(response(), vec![happens(5, 0), happens(16, 1)], 100);
    assert_eq!((verdict.outcome, verdict.discharged), (MonitorOutcome::Fail, 0));
}

#[test]
fn a_missed_deadline_is_a_violation_at_its_own_time() {
    let verdict = check(response(), vec![happens(5, 0), happens(7, 0), happens(90, 2)], 100);
    let violation = verdict.first_failure.unwrap();
    assert_eq!((violation.time, violation.step, violation.trigger_time), (15, None, 5));
    assert_eq!(indices(&violation.counterexample), [0]);
    assert_eq!((verdict.triggered, verdict.failures, verdict.pending_since), (2, 1, None));
}

#[test]
fn the_end_of_the_run_decides_between_open_and_failed() {
    let open = check(response(), vec![happens(5, 0)], 14);
    assert_eq!((open.outcome, open.pending_since), (MonitorOutcome::Inconclusive, Some(5)));
    let over = check(response(), vec![happens(5, 0)], 15);
    assert_eq!((over.outcome, over.pending_since), (MonitorOutcome::Fail, None));
    let answered_last = check(response(), vec![happens(5, 0), happens(15, 1)], 15);
    assert_eq!(answered_last.outcome, MonitorOutcome::Pass);
}

#[test]
fn a_trace_that_never_triggers_says_nothing() {
    let verdict = check(response(), vec![happens(5, 1), happens(6, 2)], 100);
    assert_eq!((verdict.outcome, verdict.triggered), (MonitorOutcome::Vacuous, 0));
}

#[test]
fn a_failed_requirement_may_have_an_open_obligation_too() {
    let verdict = check(response(), vec![happens(0, 0), happens(50, 0)], 55);
    assert_eq!((verdict.outcome, verdict.pending_since), (MonitorOutcome::Fail, Some(50)));
}

#[test]
fn a_run_may_begin_with_an_obligation() {
    let first = monitor(
        &[(true, Some(10)), (false, None)],
        vec![edge(0, 1, MonitorTrigger::Deadline, &[MonitorEffect::Fail])],
    );
    let violation = check(first.clone(), vec![happens(10, 2)], 20).first_failure.unwrap();
    assert_eq!((violation.time, violation.trigger_time), (10, 10));
    assert_eq!(check(first, Vec::new(), 9).pending_since, Some(0));
}

#[test]
fn deadlines_follow_each_other_at_their_exact_times() {
    use MonitorEffect::{Fail, ResetClock};
    // Without a reset the second state's deadline counts from the same zero; one already past is due on entry.
    let chain = monitor(
        &[(false, Some(10)), (false, Some(25)), (false, Some(5)), (false, None)],
        vec![
            edge(0, 1, MonitorTrigger::Deadline, &[]),
            edge(1, 2, MonitorTrigger::Deadline, &[]),
            edge(2, 3, MonitorTrigger::Deadline, &[Fail]),
        ],
    );
    assert_eq!(check(chain, Vec::new(), 100).first_failure.unwrap().time, 25);
    let periodic =
        monitor(&[(false, Some(10))], vec![edge(0, 0, MonitorTrigger::Deadline, &[Fail, ResetClock])]);
    assert_eq!(check(periodic.clone(), vec![happens(95, 2)], 100).failures, 10);
    // Without the reset the clock reaches the deadline only once.
    let mut once = periodic;
    once.edges[0].effects = vec![Fail];
    assert_eq!(check(once, Vec::new(), 100).failures, 1);
}

#[test]
fn deadlines_that_take_no_time_cannot_stop_time() {
    use MonitorEffect::{Fail, ResetClock};
    let round = monitor(
        &[(false, Some(0)), (false, Some(0))],
        vec![
            edge(0, 1, MonitorTrigger::Deadline, &[Fail, ResetClock]),
            edge(1, 0, MonitorTrigger::Deadline, &[Fail, ResetClock]),
        ],
    );
    assert_eq!(check(round, vec![happens(1, 0)], 100).failures, 2);
}

/// Whether `near < limit`.
fn below(limit: f64) -> Expr {
    Expr::binary(BinaryOp::Lt, Expr::Var(0), Expr::float(limit))
}

fn never_close() -> Monitor {
    let mut close = edge(0, 0, on(0), &[MonitorEffect::Trigger, MonitorEffect::Fail]);
    close.guard = Some(below(0.05));
    let mut never = monitor(&[(false, None)], vec![close, edge(0, 0, on(0), &[MonitorEffect::Trigger])]);
    never.margin = Some(MonitorMargin {
        value: Expr::binary(BinaryOp::Sub, Expr::Var(0), Expr::float(0.05)),
        unit: Unit::Metre,
        at: vec![EventPattern { event: EventId(0), args: Vec::new() }],
        within: Vec::new(),
    });
    never
}

#[test]
fn a_violation_shows_the_samples_it_rests_on() {
    let steps = vec![happens(0, 0), reads(1, 0, 1.0), happens(2, 0), reads(3, 0, 0.01), happens(4, 0)];
    let verdict = check(never_close(), steps, 10);
    let violation = verdict.first_failure.unwrap();
    assert_eq!((violation.time, violation.step, violation.trigger_time), (4, Some(4), 4));
    assert_eq!(indices(&violation.counterexample), [4, 3]);
    assert_eq!(violation.values, [(SignalId(0), Value::Float(0.01))]);
    assert_eq!(verdict.worst_margin, Some((0.01 - 0.05, 4)));
    assert_eq!(verdict.triggered, 3);
}

#[test]
fn margins_count_only_where_they_are_asked_for() {
    let steps = vec![reads(1, 0, 0.001), reads(2, 0, 0.5), happens(3, 0), reads(4, 0, 0.002)];
    let verdict = check(never_close(), steps, 10);
    assert_eq!(verdict.worst_margin, Some((0.5 - 0.05, 3)));
    assert_eq!(verdict.outcome, MonitorOutcome::Pass);
}

#[test]
fn a_guard_without_samples_does_not_hold() {
    let verdict = check(never_close(), vec![happens(0, 0)], 10);
    assert_eq!((verdict.outcome, verdict.worst_margin), (MonitorOutcome::Pass, None));
    // Neither a condition nor its negation holds on what was not measured. A comparison of what has no value is false, and never a pass.
    let reciprocal = Expr::binary(BinaryOp::Div, Expr::float(1.0), Expr::Var(0));
    let positive = Expr::binary(BinaryOp::Gt, reciprocal, Expr::float(0.0));
    let negative = Expr::Unary(hrdsl_ir::expr::UnaryOp::Not, Box::new(positive.clone()));
    for (guard, judged) in [(positive, MonitorOutcome::Inconclusive), (negative, MonitorOutcome::Fail)] {
        let mut fails = edge(0, 0, MonitorTrigger::Sample, &[MonitorEffect::Trigger, MonitorEffect::Fail]);
        fails.guard = Some(guard);
        let watch = monitor(&[(false, None)], vec![fails]);
        let verdict = check(watch.clone(), vec![reads(0, 1, 1.0)], 10);
        assert_eq!((verdict.outcome, verdict.unvalued), (MonitorOutcome::Vacuous, None));
        let verdict = check(watch, vec![reads(0, 1, 1.0), reads(1, 0, 0.0)], 10);
        assert_eq!((verdict.outcome, verdict.unvalued), (judged, Some(1)));
    }
}

#[test]
fn a_monitor_that_only_watches_is_triggered_by_its_first_complete_sample() {
    let mut fails = edge(0, 0, MonitorTrigger::Sample, &[MonitorEffect::Fail]);
    fails.guard = Some(below(0.05));
    let watch = monitor(&[(false, None)], vec![fails]);
    let verdict = check(watch.clone(), vec![reads(0, 0, 1.0)], 10);
    assert_eq!(verdict.outcome, MonitorOutcome::Vacuous);
    let verdict = check(watch, vec![reads(0, 0, 1.0), reads(1, 1, 1.0), reads(2, 0, 2.0)], 10);
    assert_eq!((verdict.outcome, verdict.triggered), (MonitorOutcome::Pass, 1));
}

#[test]
fn the_first_enabled_edge_is_taken_and_only_that() {
    let mut guarded = edge(0, 1, on(0), &[MonitorEffect::Trigger]);
    guarded.guard = Some(Expr::bool(false));
    let edges = vec![
        guarded,
        edge(0, 2, on(0), &[MonitorEffect::Trigger]),
        edge(0, 1, on(0), &[MonitorEffect::Trigger, MonitorEffect::Fail]),
        edge(2, 1, on(0), &[MonitorEffect::Fail]),
    ];
    let states = [(false, None), (false, None), (true, None)];
    let verdict = check(monitor(&states, edges), vec![happens(3, 0)], 10);
    assert_eq!(
        (verdict.outcome, verdict.triggered, verdict.pending_since),
        (MonitorOutcome::Inconclusive, 1, Some(3))
    );
}

#[test]
fn an_obligation_ends_when_it_is_met_or_lost() {
    use MonitorEffect::{Discharge, Fail, Trigger};
    // All in one state: each answer ends what the triggers before it began.
    let edges =
        vec![edge(0, 0, on(0), &[Trigger]), edge(0, 0, on(1), &[Discharge]), edge(0, 0, on(2), &[Fail])];
    let steps = [(1, 0), (2, 0), (3, 1), (4, 0), (5, 0), (6, 2)].map(|(t, e)| happens(t, e)).to_vec();
    let violation = check(monitor(&[(false, None)], edges), steps, 10).first_failure.unwrap();
    assert_eq!((violation.trigger_time, indices(&violation.counterexample)), (4, vec![3, 5]));
    // What is pending after a violation is not what was violated.
    let edges = vec![edge(0, 1, on(0), &[Trigger]), edge(1, 2, on(2), &[Fail])];
    let states = [(false, None), (true, None), (true, None)];
    let verdict = check(monitor(&states, edges), vec![happens(1, 0), happens(5, 2)], 10);
    assert_eq!((verdict.outcome, verdict.pending_since), (MonitorOutcome::Fail, Some(5)));
}

#[test]
fn arguments_are_matched() {
    let pattern = EventPattern { event: EventId(0), args: vec![ArgPattern::Is(Value::Bool(true))] };
    let edges = vec![edge(0, 0, MonitorTrigger::Event(vec![pattern]), &[MonitorEffect::Trigger])];
    let yes_no = |b| TraceStep {
        time: 0,
        what: TraceStepKind::Event { event: EventId(0), args: vec![Value::Bool(b)] },
    };
    let verdict = check(monitor(&[(false, None)], edges), vec![yes_no(true), yes_no(false)], 1);
    assert_eq!(verdict.triggered, 1);
}

#[test]
fn symbols_are_matched_and_guard() {
    let symbol = |name: &str| Value::Symbol(Symbol::intern(name));
    let pattern = EventPattern { event: EventId(0), args: vec![ArgPattern::Is(symbol("go"))] };
    let is_fast = Expr::binary(BinaryOp::Eq, Expr::Var(0), Expr::Const(symbol("fast")));
    let trigger = MonitorEdge {
        guard: Some(is_fast),
        ..edge(0, 0, MonitorTrigger::Event(vec![pattern]), &[MonitorEffect::Trigger])
    };
    let said = |time, name| TraceStep {
        time,
        what: TraceStepKind::Event { event: EventId(0), args: vec![symbol(name)] },
    };
    let feed = |time, name| {
        let value = symbol(name);
        TraceStep { time, what: TraceStepKind::Sample { signal: SignalId(0), value } }
    };
    // Only the one that is said while the signal is `fast` and says `go`.
    let steps =
        vec![said(0, "go"), feed(1, "slow"), said(2, "go"), feed(3, "fast"), said(4, "stop"), said(5, "go")];
    let verdict = check(monitor(&[(false, None)], vec![trigger]), steps, 9);
    assert_eq!(verdict.triggered, 1);
}

#[test]
fn bad_input_is_borne() {
    let mut odd = response();
    odd.edges.push(edge(9, 0, on(7), &[MonitorEffect::Fail]));
    odd.edges.push(edge(0, 9, on(2), &[]));
    odd.signals.push(SignalId(77));
    // Unknown events and signals, time that goes backwards, steps after the end.
    let mut checker = MonitorRunner::new(&program(vec![odd]));
    for (i, step) in
        [happens(5, 0), happens(3, 1), happens(8, 99), reads(8, 99, 0.0), happens(9, 2)].iter().enumerate()
    {
        checker.step(i, step);
    }
    checker.end(10);
    checker.step(5, &happens(11, 0));
    checker.end(100);
    let verdict = checker.verdicts().remove(0);
    assert_eq!((verdict.outcome, verdict.triggered), (MonitorOutcome::Pass, 1));
}
