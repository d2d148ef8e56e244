//! One monitor automaton in execution.

use hrdsl_ir::{
    EventId, Expr, Nanos, Value,
    expr::{BinaryOp, EvalError},
    monitor::{Monitor, MonitorEdge, MonitorEffect, MonitorOutcome, MonitorTrigger, StateId},
};

use hrdsl_metric::{MeasuredTruth, outcome_of_measured};
use hrdsl_trace::{SeenStep, TraceStep, TraceStepKind};

use crate::{
    latest::LatestSamples,
    verdict::{MonitorHappening, MonitorVerdict, Violation},
};

/// When something happened, and by which step of the trace; a deadline has none.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TraceMoment {
    pub time: Nanos,
    pub step: Option<usize>,
}

/// What is due since a trigger.
#[derive(Clone, Debug)]
struct TriggerObligation {
    time: Nanos,
    /// The step that triggered it; a deadline has none.
    step: Option<SeenStep>,
}

/// A monitor with its state, clock and counters.
#[derive(Clone, Debug)]
pub(crate) struct MonitorMachine {
    monitor: Monitor,
    /// For each state the indices of its edges, in order.
    leaving: Vec<Vec<usize>>,
    /// For each condition its latest truth.
    truths: Vec<Option<bool>>,
    /// No edge triggers, but some watch samples: the first complete sample is the trigger.
    watches: bool,
    state: usize,
    entered: Nanos,
    /// When the clock was last set to zero.
    zero: Nanos,
    /// When the state's deadline is reached; `None`: it has none, or its edge was already tried.
    due: Option<Nanos>,
    /// The time of the latest deadline, and how many fired at that very time.
    burst: (Nanos, usize),
    /// The trigger that has been neither discharged nor left by a failure.
    obligation: Option<TriggerObligation>,
    triggered: u32,
    discharged: u32,
    failures: u32,
    first_failure: Option<Violation>,
    /// What is a violation if the requirement fails next.
    suspect: Option<Violation>,
    worst_margin: Option<(f64, Nanos)>,
    /// One of its comparisons divides, so that it may have no value where all signals have.
    divides: bool,
    /// When a comparison first had no value.
    unvalued: Option<Nanos>,
    /// All that it did; `None`: nobody asks for it.
    history: Option<Vec<MonitorHappening>>,
}

/// What an edge may be waiting for.
#[derive(Clone, Copy)]
enum EdgeCause<'a> {
    Event(EventId, &'a [Value]),
    /// A condition has got a truth, the first that it has.
    Becomes {
        condition: u16,
        truth: bool,
        first: bool,
    },
    Sample,
    Deadline,
}

impl EdgeCause<'_> {
    /// Whether the guard of such an edge is asked then, in whatever state: at its event, or at samples.
    fn asks(self, on: &MonitorTrigger) -> bool {
        match self {
            EdgeCause::Event(..) => self.starts(on),
            EdgeCause::Becomes { .. } | EdgeCause::Sample | EdgeCause::Deadline => match on {
                MonitorTrigger::Event(_) => false,
                MonitorTrigger::Becomes { .. } | MonitorTrigger::Sample | MonitorTrigger::Deadline => true,
            },
        }
    }

    fn starts(self, on: &MonitorTrigger) -> bool {
        match (self, on) {
            (EdgeCause::Event(event, args), MonitorTrigger::Event(patterns)) => {
                patterns.iter().any(|p| p.matches(event, args))
            }
            (
                EdgeCause::Becomes { condition, truth, first },
                MonitorTrigger::Becomes { condition: on, truth: to, first: also_first },
            ) => condition == *on && truth == *to && (!first || *also_first),
            (EdgeCause::Sample, MonitorTrigger::Sample) | (EdgeCause::Deadline, MonitorTrigger::Deadline) => {
                true
            }
            (
                EdgeCause::Event(..) | EdgeCause::Becomes { .. } | EdgeCause::Sample | EdgeCause::Deadline,
                MonitorTrigger::Event(_)
                | MonitorTrigger::Becomes { .. }
                | MonitorTrigger::Sample
                | MonitorTrigger::Deadline,
            ) => false,
        }
    }
}

impl MonitorMachine {
    pub fn new(monitor: Monitor) -> Self {
        let mut leaving = vec![Vec::new(); monitor.states.len()];
        for (index, edge) in monitor.edges.iter().enumerate() {
            if let Some(edges) = leaving.get_mut(usize::from(edge.from.0)) {
                edges.push(index);
            }
        }
        let triggers = monitor.edges.iter().any(|e| e.effects.contains(&MonitorEffect::Trigger));
        let divides = asked(&monitor).any(divides);
        let mut machine = Self {
            leaving,
            truths: vec![None; monitor.conditions.len()],
            watches: !triggers && monitor.edges.iter().any(|e| e.on == MonitorTrigger::Sample),
            state: usize::from(monitor.initial.0),
            entered: 0,
            zero: 0,
            due: None,
            burst: (Nanos::MIN, 0),
            obligation: None,
            triggered: 0,
            discharged: 0,
            failures: 0,
            first_failure: None,
            suspect: None,
            worst_margin: None,
            divides,
            unvalued: None,
            history: None,
            monitor,
        };
        if machine.monitor.at_start.contains(&MonitorEffect::Trigger) {
            machine.triggered = 1;
            machine.obligation = Some(TriggerObligation { time: 0, step: None });
        }
        machine.arm(0);
        machine
    }

    /// From now on it keeps all that it does.
    pub fn recount(&mut self) {
        let mut history = Vec::new();
        if !self.monitor.at_start.is_empty() {
            history.push(MonitorHappening {
                time: 0,
                step: None,
                effects: self.monitor.at_start.clone(),
                pending: self.is_pending(),
                due: self.due,
                values: Vec::new(),
            });
        }
        self.history = Some(history);
    }

    pub fn take_history(&mut self) -> Vec<MonitorHappening> {
        self.history.take().unwrap_or_default()
    }

    /// When the next deadline is reached, if nothing happens before.
    pub fn due(&self) -> Option<Nanos> {
        self.due
    }

    /// Fires, in order, the deadlines that are reached strictly before `time`.
    pub fn fire_before(&mut self, time: Nanos, signals: &LatestSamples) {
        while let Some(due) = self.due.filter(|due| *due < time) {
            self.due = None;
            self.burst = if self.burst.0 == due { (due, self.burst.1 + 1) } else { (due, 1) };
            // Deadlines that follow each other in no time, round and round, would stop time.
            if self.burst.1 <= self.monitor.states.len() {
                self.react(EdgeCause::Deadline, TraceMoment { time: due, step: None }, signals);
            }
        }
    }

    pub fn event(&mut self, at: TraceMoment, event: EventId, args: &[Value], signals: &LatestSamples) {
        let measured = |m: &Monitor| {
            m.margin.as_ref().is_some_and(|margin| margin.at.iter().any(|p| p.matches(event, args)))
        };
        self.note_unvalued(EdgeCause::Event(event, args), at, signals);
        let inside = self.measures_here();
        if !measured(&self.monitor) {
            return self.react(EdgeCause::Event(event, args), at, signals);
        }
        self.react(EdgeCause::Event(event, args), at, signals);
        // An event that opens or closes what the requirement is about is not in it.
        if inside && self.measures_here() {
            self.measure(at.time, signals);
        }
    }

    /// One of the monitor's signals has a new sample.
    pub fn sample(&mut self, at: TraceMoment, signals: &LatestSamples) {
        for condition in 0..self.truths.len() {
            self.look(condition, at, signals);
        }
        self.note_unvalued(EdgeCause::Sample, at, signals);
        if self.measures_samples() && self.measures_here() {
            self.measure(at.time, signals);
        }
        let complete = || self.monitor.signals.iter().all(|s| signals.get(*s).is_some());
        if self.watches && self.triggered == 0 && complete() {
            self.triggered = 1;
            self.obligation = Some(obligation(EdgeCause::Sample, at, signals));
            if let Some(history) = &mut self.history {
                let effects = vec![MonitorEffect::Trigger];
                let (time, step, values) = (at.time, at.step, Vec::new());
                history.push(MonitorHappening { time, step, effects, pending: false, due: None, values });
            }
        }
        self.react(EdgeCause::Sample, at, signals);
    }

    /// Looks at a condition again. One that reads a signal without a sample has no truth yet.
    fn look(&mut self, condition: usize, at: TraceMoment, signals: &LatestSamples) {
        let Some(truth) = self.truth(&self.monitor.conditions[condition], signals) else { return };
        let before = self.truths[condition].replace(truth);
        if before != Some(truth) {
            let condition = u16::try_from(condition).unwrap_or(u16::MAX);
            self.react(EdgeCause::Becomes { condition, truth, first: before.is_none() }, at, signals);
        }
    }

    /// Takes the first edge that the cause starts and whose guard holds.
    fn react(&mut self, cause: EdgeCause<'_>, at: TraceMoment, signals: &LatestSamples) {
        let enabled = |edge: &MonitorEdge| {
            cause.starts(&edge.on)
                && edge.clock.is_none_or(|clock| clock.allows(at.time.saturating_sub(self.zero)))
                && edge.guard.as_ref().is_none_or(|g| self.truth(g, signals) == Some(true))
        };
        let edges = self.leaving.get(self.state).map_or(&[][..], Vec::as_slice);
        if let Some(&edge) = edges.iter().find(|&&edge| enabled(&self.monitor.edges[edge])) {
            self.take(edge, cause, at, signals);
        }
    }

    fn take(&mut self, edge: usize, cause: EdgeCause<'_>, at: TraceMoment, signals: &LatestSamples) {
        let to = usize::from(self.monitor.edges[edge].to.0);
        let moves = to != self.state;
        let has = |effect| self.monitor.edges[edge].effects.contains(&effect);
        let outside = !self.measures_here();
        let (resets, fails) = (has(MonitorEffect::ResetClock), has(MonitorEffect::Fail));
        for index in 0..self.monitor.edges[edge].effects.len() {
            match self.monitor.edges[edge].effects[index] {
                MonitorEffect::ResetClock => self.zero = at.time,
                MonitorEffect::Trigger => {
                    self.triggered = self.triggered.saturating_add(1);
                    // A further trigger of an obligation whose time goes on joins it: the first stays in the counterexample.
                    let joins = !moves && !resets && !fails && self.obligation.is_some();
                    if !joins {
                        self.obligation = Some(obligation(cause, at, signals));
                    }
                }
                MonitorEffect::Discharge => {
                    self.discharged = self.discharged.saturating_add(1);
                    self.obligation = None;
                }
                MonitorEffect::Suspect => self.suspect = Some(self.violation(cause, at, signals)),
                MonitorEffect::Fail => self.fail(cause, at, signals),
            }
        }
        if moves {
            self.state = to;
            self.entered = at.time;
            if fails {
                self.obligation = None;
            }
        }
        if moves || resets {
            self.arm(at.time);
        }
        if outside && self.measures_samples() && self.measures_here() {
            self.measure(at.time, signals);
        }
        self.note(edge, at, signals);
    }

    /// Keeps what an edge did, if somebody asks for it.
    fn note(&mut self, edge: usize, at: TraceMoment, signals: &LatestSamples) {
        if self.history.is_none() {
            return;
        }
        let effects = self.monitor.edges[edge].effects.clone();
        let pending = self.is_pending();
        let read = self.monitor.signals.iter().filter_map(|s| signals.get(*s).map(|r| (*s, r.value)));
        let values = if effects.contains(&MonitorEffect::Fail) { read.collect() } else { Vec::new() };
        let happening =
            MonitorHappening { time: at.time, step: at.step, effects, pending, due: self.due, values };
        self.history.get_or_insert_default().push(happening);
    }

    /// Sets when the state's deadline is due: at once if the clock is already past it.
    fn arm(&mut self, now: Nanos) {
        let deadline = self.monitor.states.get(self.state).and_then(|s| s.deadline);
        self.due = deadline.map(|d| self.zero.saturating_add(d).max(now));
    }

    fn fail(&mut self, cause: EdgeCause<'_>, at: TraceMoment, signals: &LatestSamples) {
        self.failures = self.failures.saturating_add(1);
        let suspect = self.suspect.take();
        if self.first_failure.is_some() {
            return;
        }
        let violation = match suspect {
            Some(mut violation) => {
                // What makes a violation of it is the end of what shows it.
                let closing = obligation(cause, at, signals).step;
                let known = |step: &SeenStep| violation.counterexample.iter().all(|k| k.index != step.index);
                if let Some(step) = closing.filter(known) {
                    violation.counterexample.push(step);
                }
                violation
            }
            None => self.violation(cause, at, signals),
        };
        self.first_failure = Some(violation);
    }

    /// What there is to show for a violation that happens here.
    fn violation(&self, cause: EdgeCause<'_>, at: TraceMoment, signals: &LatestSamples) -> Violation {
        let here = obligation(cause, at, signals);
        let trigger = self.obligation.clone().unwrap_or_else(|| here.clone());
        let read = self.monitor.signals.iter().filter_map(|s| signals.get(*s).map(|r| (*s, r)));
        let mut counterexample: Vec<SeenStep> = Vec::new();
        for step in trigger.step.into_iter().chain(here.step).chain(read.clone().map(|(s, r)| r.seen(s))) {
            if counterexample.iter().all(|known| known.index != step.index) {
                counterexample.push(step);
            }
        }
        let values = read.map(|(signal, r)| (signal, r.value)).collect();
        Violation { time: at.time, step: at.step, trigger_time: trigger.time, counterexample, values }
    }

    fn is_pending(&self) -> bool {
        self.monitor.states.get(self.state).is_some_and(|s| s.pending)
    }

    fn measures_samples(&self) -> bool {
        self.monitor.margin.as_ref().is_some_and(|margin| margin.at.is_empty())
    }

    /// Whether the margin is taken in the state that it is in.
    fn measures_here(&self) -> bool {
        let is_here = |s: &StateId| usize::from(s.0) == self.state;
        self.monitor.margin.as_ref().is_some_and(|m| m.within.is_empty() || m.within.iter().any(is_here))
    }

    fn measure(&mut self, time: Nanos, signals: &LatestSamples) {
        let Some(margin) = &self.monitor.margin else { return };
        let measured = self.value(&margin.value, signals).and_then(Value::as_f64);
        if let Some(value) = measured.filter(|v| v.is_finite())
            && self.worst_margin.is_none_or(|(worst, _)| value < worst)
        {
            self.worst_margin = Some((value, time));
        }
    }

    /// The latest sample of one of its signals.
    fn sampled(&self, place: u16, signals: &LatestSamples) -> Option<Value> {
        let signal = self.monitor.signals.get(usize::from(place))?;
        signals.get(*signal).map(|reading| reading.value)
    }

    /// The expression's value; none if it reads a signal without a sample, or has no value for another reason.
    fn value(&self, expr: &Expr, signals: &LatestSamples) -> Option<Value> {
        expr.eval(&|place| self.sampled(place, signals)).ok()
    }

    /// What a condition comes to, of what was measured and what was not; none if it reads a signal without a sample.
    fn truth(&self, condition: &Expr, signals: &LatestSamples) -> Option<bool> {
        let sampled = |place| self.sampled(place, signals);
        match condition.eval(&sampled) {
            Ok(value) => value.as_bool(),
            Err(EvalError::Unbound(_)) => None,
            Err(_) => MeasuredTruth::of(condition, &sampled).map(|measured| measured.truth),
        }
    }

    /// Notes the time if a condition that is asked for this cause now compares what has no value. Most samples are numbers, and say at once
    /// that none does.
    fn note_unvalued(&mut self, cause: EdgeCause<'_>, at: TraceMoment, signals: &LatestSamples) {
        let is_finite = |value: Value| !matches!(value, Value::Float(number) if !number.is_finite());
        let mut read = self.monitor.signals.iter().filter_map(|signal| signals.get(*signal));
        if self.unvalued.is_some() || (!self.divides && read.all(|reading| is_finite(reading.value))) {
            return;
        }
        let (conditions, edges) = (self.monitor.conditions.iter(), &self.monitor.edges);
        let watched = conditions.filter(|_| !matches!(cause, EdgeCause::Event(..)));
        let guards = edges.iter().filter(|edge| cause.asks(&edge.on)).filter_map(|edge| edge.guard.as_ref());
        let measured = |condition| MeasuredTruth::of(condition, &|place| self.sampled(place, signals));
        if watched.chain(guards).filter_map(measured).any(|measured| measured.unvalued) {
            self.unvalued = Some(at.time);
        }
    }

    pub fn verdict(self, index: usize) -> MonitorVerdict {
        let pending = self.is_pending();
        let judged = if self.failures > 0 {
            MonitorOutcome::Fail
        } else if pending {
            MonitorOutcome::Inconclusive
        } else if self.triggered == 0 {
            MonitorOutcome::Vacuous
        } else {
            MonitorOutcome::Pass
        };
        let outcome = outcome_of_measured(judged, self.unvalued);
        let since = self.obligation.as_ref().map_or(self.entered, |trigger| trigger.time);
        MonitorVerdict {
            monitor: index,
            outcome,
            triggered: self.triggered,
            discharged: self.discharged,
            failures: self.failures,
            first_failure: self.first_failure,
            worst_margin: self.worst_margin,
            pending_since: pending.then_some(since),
            unvalued: self.unvalued,
        }
    }
}

/// All conditions that a monitor may ask: those that it watches, and the guards of its edges.
fn asked(monitor: &Monitor) -> impl Iterator<Item = &Expr> {
    monitor.conditions.iter().chain(monitor.edges.iter().filter_map(|edge| edge.guard.as_ref()))
}

/// Whether something in it is divided.
fn divides(expr: &Expr) -> bool {
    match expr {
        Expr::Const(_) | Expr::Var(_) => false,
        Expr::Unary(_, a) => divides(a),
        Expr::Binary(op, a, b) => matches!(op, BinaryOp::Div | BinaryOp::Rem) || divides(a) || divides(b),
        Expr::If(c, a, b) => divides(c) || divides(a) || divides(b),
        Expr::Call(_, args) => args.iter().any(divides),
        // What no requirement has: to look again at each sample is never wrong.
        Expr::List(..) | Expr::Element(_) | Expr::Apply(..) => true,
    }
}

/// What is due from a moment on, with the step that it is due to.
fn obligation(cause: EdgeCause<'_>, at: TraceMoment, signals: &LatestSamples) -> TriggerObligation {
    let step = at.step.and_then(|index| match cause {
        EdgeCause::Event(event, args) => {
            let what = TraceStepKind::Event { event, args: args.to_vec() };
            Some(SeenStep { index, step: TraceStep { time: at.time, what } })
        }
        EdgeCause::Sample | EdgeCause::Becomes { .. } => signals.of_step(index),
        EdgeCause::Deadline => None,
    });
    TriggerObligation { time: at.time, step }
}
