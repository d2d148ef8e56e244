//! Requirements at work: executes [`Monitor`](hrdsl_ir::monitor::Monitor) automata over a trace and gives verdicts.
//!
//! The [`MonitorRunner`] is an [`TraceObserver`]: it is shown the steps of a run, live or recorded, one by one, and keeps nothing but
//! each automaton's state, counters, first failure, and the latest sample of each signal. Its memory does not grow with
//! the trace. A requirement that is a formula is judged by a [`FormulaMonitor`](hrdsl_metric::FormulaMonitor), in memory for what its windows hold.
//!
//! # Steps
//! 1. [`MonitorRunner::new`] readies all monitors of a program and indexes them by the events and signals they read.
//! 2. [`TraceObserver::step`] first lets time pass up to the step, which fires the deadlines reached strictly before it, then
//!    shows the step to the monitors that read it.
//! 3. [`TraceObserver::end`] fires the deadlines reached up to and including the end of the run: the time of such an
//!    obligation is over, and no event can meet it any more.
//! 4. [`MonitorRunner::verdicts`] judges.
#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod formula;
mod latest;
mod machine;
mod verdict;

use hrdsl_ir::{EventPattern, Nanos, Program, monitor::MonitorTrigger};
use hrdsl_trace::{TraceObserver, TraceStep, TraceStepKind};

use formula::RequiredFormulas;
pub use hrdsl_ir::monitor::MonitorOutcome;
pub use hrdsl_trace::SeenStep;
use latest::{LatestSamples, SampleReading};
use machine::{MonitorMachine, TraceMoment};
pub use verdict::{MonitorHappening, MonitorVerdict, Violation};

/// Runs all monitors of a program over one trace.
#[derive(Clone, Debug)]
pub struct MonitorRunner {
    machines: Vec<MonitorMachine>,
    /// For each event of the program, the monitors with an edge or a margin on it.
    by_event: Vec<Vec<usize>>,
    /// For each signal of the program, the monitors that read it.
    by_signal: Vec<Vec<usize>>,
    formulas: RequiredFormulas,
    signals: LatestSamples,
    /// For each monitor the last of the samples of this instant that it has not yet reacted to.
    sampled: Vec<Option<TraceMoment>>,
    now: Nanos,
    /// No deadline is due before this; it may be too early (then a scan finds nothing), never too late.
    next_due: Nanos,
    ended: bool,
}

impl MonitorRunner {
    /// All monitors of the program in their initial states, at time 0.
    #[must_use]
    pub fn new(program: &Program) -> Self {
        let machines: Vec<MonitorMachine> =
            program.monitors.iter().cloned().map(MonitorMachine::new).collect();
        let mut by_event = vec![Vec::new(); program.events.len()];
        let mut by_signal = vec![Vec::new(); program.signals.len()];
        for (index, monitor) in program.monitors.iter().enumerate() {
            let on_edges = monitor.edges.iter().flat_map(|edge| match &edge.on {
                MonitorTrigger::Event(patterns) => patterns.as_slice(),
                MonitorTrigger::Becomes { .. } | MonitorTrigger::Sample | MonitorTrigger::Deadline => &[],
            });
            let at_margin = monitor.margin.iter().flat_map(|margin| &margin.at);
            for pattern in on_edges.chain(at_margin) {
                enter(&mut by_event, pattern_key(pattern), index);
            }
            // A formula has no machine that would take samples.
            let signals = if monitor.formula.is_some() { &[][..] } else { &monitor.signals };
            for signal in signals {
                enter(&mut by_signal, usize::from(signal.0), index);
            }
        }
        let next_due = earliest(&machines);
        let signals = LatestSamples::new(program.signals.len());
        let sampled = vec![None; machines.len()];
        let formulas = RequiredFormulas::new(program);
        Self { machines, by_event, by_signal, formulas, signals, sampled, now: 0, next_due, ended: false }
    }

    /// The verdicts, in the order of the program's monitors.
    ///
    /// Without a call of [`TraceObserver::end`] they are those of the trace so far: no time has passed since its last step.
    #[must_use]
    pub fn verdicts(self) -> Vec<MonitorVerdict> {
        self.recounted().into_iter().map(|(verdict, _)| verdict).collect()
    }

    /// The same, which keeps all that the monitors do, in memory that grows with the trace.
    #[must_use]
    pub fn recounting(mut self) -> Self {
        self.machines.iter_mut().for_each(MonitorMachine::recount);
        self
    }

    /// The verdicts, each with what its monitor did, in order, if it [recounts](Self::recounting).
    #[must_use]
    pub fn recounted(mut self) -> Vec<(MonitorVerdict, Vec<MonitorHappening>)> {
        self.take_all_samples();
        let told = |(index, mut machine): (usize, MonitorMachine)| {
            let history = machine.take_history();
            (machine.verdict(index), history)
        };
        let mut told: Vec<_> = self.machines.into_iter().enumerate().map(told).collect();
        for (verdict, history) in self.formulas.finish(self.now) {
            if let Some(place) = told.get_mut(verdict.monitor) {
                *place = (verdict, history);
            }
        }
        told
    }

    /// Lets a monitor react to the samples of this instant, as to one: a condition over several signals never sees some of
    /// them new and others old.
    fn take_samples(&mut self, index: usize) {
        let Some(at) = self.sampled[index].take() else { return };
        let machine = &mut self.machines[index];
        machine.sample(at, &self.signals);
        self.next_due = self.next_due.min(machine.due().unwrap_or(Nanos::MAX));
    }

    fn take_all_samples(&mut self) {
        for index in 0..self.machines.len() {
            self.take_samples(index);
        }
    }

    fn fire_before(&mut self, time: Nanos) {
        if self.next_due >= time {
            return;
        }
        for machine in &mut self.machines {
            machine.fire_before(time, &self.signals);
        }
        self.next_due = earliest(&self.machines);
    }
}

impl TraceObserver for MonitorRunner {
    /// A step earlier than the one before it counts as simultaneous with that one; a step after the end is ignored.
    fn step(&mut self, index: usize, step: &TraceStep) {
        if self.ended {
            return;
        }
        if step.time > self.now {
            self.take_all_samples();
        }
        self.now = self.now.max(step.time);
        self.fire_before(self.now);
        let at = TraceMoment { time: self.now, step: Some(index) };
        self.formulas.step(index, step);
        match &step.what {
            TraceStepKind::Event { event, args } => {
                let event_index = usize::from(event.0);
                for k in 0..self.by_event.get(event_index).map_or(0, Vec::len) {
                    let reader = self.by_event[event_index][k];
                    self.take_samples(reader);
                    let machine = &mut self.machines[reader];
                    machine.event(at, *event, args, &self.signals);
                    self.next_due = self.next_due.min(machine.due().unwrap_or(Nanos::MAX));
                }
            }
            TraceStepKind::Sample { signal, value } => {
                self.signals.set(*signal, SampleReading { value: *value, step: index, time: step.time });
                for &reader in self.by_signal.get(usize::from(signal.0)).into_iter().flatten() {
                    self.sampled[reader] = Some(at);
                }
            }
            TraceStepKind::Machine(_) => {}
        }
    }

    fn end(&mut self, time: Nanos) {
        if self.ended {
            return;
        }
        self.take_all_samples();
        self.now = self.now.max(time);
        // Times are whole nanoseconds: "up to and including now" is "before the next one".
        self.fire_before(self.now.saturating_add(1));
        self.ended = true;
    }
}

fn pattern_key(pattern: &EventPattern) -> usize {
    usize::from(pattern.event.0)
}

/// Monitors come in order, so that a repeated one is the last.
fn enter(index: &mut [Vec<usize>], key: usize, monitor: usize) {
    if let Some(readers) = index.get_mut(key)
        && readers.last() != Some(&monitor)
    {
        readers.push(monitor);
    }
}

fn earliest(machines: &[MonitorMachine]) -> Nanos {
    machines.iter().filter_map(MonitorMachine::due).min().unwrap_or(Nanos::MAX)
}

#[cfg(test)]
mod tests;
