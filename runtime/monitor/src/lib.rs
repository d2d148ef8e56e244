//! Requirements at work: executes [`Monitor`](hrdsl_ir::monitor::Monitor) automata over a trace and gives verdicts.
//!
//! The [`Checker`] is an [`Observer`]: it is shown the steps of a run, live or recorded, one by one, and keeps nothing but
//! each automaton's state, counters, first failure, and the latest sample of each signal. Its memory does not grow with
//! the trace.
//!
//! # Steps
//! 1. [`Checker::new`] readies all monitors of a program and indexes them by the events and signals they read.
//! 2. [`Observer::step`] first lets time pass up to the step, which fires the deadlines reached strictly before it, then
//!    shows the step to the monitors that read it.
//! 3. [`Observer::end`] fires the deadlines reached up to and including the end of the run: the time of such an
//!    obligation is over, and no event can meet it any more.
//! 4. [`Checker::verdicts`] judges.

mod machine;
mod verdict;

use hrdsl_ir::{EventPattern, Nanos, Program, Value, monitor::On, world::SignalId};
use hrdsl_trace::{Observer, Step, What};

use machine::{Machine, Moment};
pub use verdict::{Outcome, SeenStep, Verdict, Violation};

/// Runs all monitors of a program over one trace.
#[derive(Clone, Debug)]
pub struct Checker {
    machines: Vec<Machine>,
    /// For each event of the program, the monitors with an edge or a margin on it.
    by_event: Vec<Vec<usize>>,
    /// For each signal of the program, the monitors that read it.
    by_signal: Vec<Vec<usize>>,
    signals: Latest,
    /// For each monitor the last of the samples of this instant that it has not yet reacted to.
    sampled: Vec<Option<Moment>>,
    now: Nanos,
    /// No deadline is due before this; it may be too early (then a scan finds nothing), never too late.
    next_due: Nanos,
    ended: bool,
}

impl Checker {
    /// All monitors of the program in their initial states, at time 0.
    #[must_use]
    pub fn new(program: &Program) -> Self {
        let machines: Vec<Machine> = program.monitors.iter().cloned().map(Machine::new).collect();
        let mut by_event = vec![Vec::new(); program.events.len()];
        let mut by_signal = vec![Vec::new(); program.signals.len()];
        for (index, monitor) in program.monitors.iter().enumerate() {
            let on_edges = monitor.edges.iter().flat_map(|edge| match &edge.on {
                On::Event(patterns) => patterns.as_slice(),
                On::Sample | On::Deadline => &[],
            });
            let at_margin = monitor.margin.iter().flat_map(|margin| &margin.at);
            for pattern in on_edges.chain(at_margin) {
                enter(&mut by_event, pattern_key(pattern), index);
            }
            for signal in &monitor.signals {
                enter(&mut by_signal, usize::from(signal.0), index);
            }
        }
        let next_due = earliest(&machines);
        let signals = Latest(vec![None; program.signals.len()]);
        let sampled = vec![None; machines.len()];
        Self { machines, by_event, by_signal, signals, sampled, now: 0, next_due, ended: false }
    }

    /// The verdicts, in the order of the program's monitors.
    ///
    /// Without a call of [`Observer::end`] they are those of the trace so far: no time has passed since its last step.
    #[must_use]
    pub fn verdicts(mut self) -> Vec<Verdict> {
        self.take_all_samples();
        self.machines.into_iter().enumerate().map(|(index, machine)| machine.verdict(index)).collect()
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

impl Observer for Checker {
    /// A step earlier than the one before it counts as simultaneous with that one; a step after the end is ignored.
    fn step(&mut self, index: usize, step: &Step) {
        if self.ended {
            return;
        }
        if step.time > self.now {
            self.take_all_samples();
        }
        self.now = self.now.max(step.time);
        self.fire_before(self.now);
        let at = Moment { time: self.now, step: Some(index) };
        match &step.what {
            What::Event { event, args } => {
                let event_index = usize::from(event.0);
                for k in 0..self.by_event.get(event_index).map_or(0, Vec::len) {
                    let reader = self.by_event[event_index][k];
                    self.take_samples(reader);
                    let machine = &mut self.machines[reader];
                    machine.event(at, *event, args, &self.signals);
                    self.next_due = self.next_due.min(machine.due().unwrap_or(Nanos::MAX));
                }
            }
            What::Sample { signal, value } => {
                self.signals.set(*signal, Reading { value: *value, step: index, time: step.time });
                for &reader in self.by_signal.get(usize::from(signal.0)).into_iter().flatten() {
                    self.sampled[reader] = Some(at);
                }
            }
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

/// The latest sample of each signal of the program.
#[derive(Clone, Debug)]
pub(crate) struct Latest(Vec<Option<Reading>>);

#[derive(Clone, Copy, Debug)]
pub(crate) struct Reading {
    pub value: Value,
    /// The step of the trace that brought it.
    pub step: usize,
    pub time: Nanos,
}

impl Reading {
    /// The step that brought it.
    pub fn seen(self, signal: SignalId) -> SeenStep {
        let what = What::Sample { signal, value: self.value };
        SeenStep { index: self.step, step: Step { time: self.time, what } }
    }
}

impl Latest {
    pub fn get(&self, signal: SignalId) -> Option<Reading> {
        self.0.get(usize::from(signal.0)).copied().flatten()
    }

    /// The sample that is this step of the trace, if it is the latest of its signal.
    pub fn of_step(&self, index: usize) -> Option<SeenStep> {
        let of =
            |(signal, reading): (u16, &Option<Reading>)| Some((signal, reading.filter(|r| r.step == index)?));
        let (signal, reading) = (0u16..).zip(&self.0).find_map(of)?;
        Some(reading.seen(SignalId(signal)))
    }

    fn set(&mut self, signal: SignalId, reading: Reading) {
        if let Some(slot) = self.0.get_mut(usize::from(signal.0)) {
            *slot = Some(reading);
        }
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

fn earliest(machines: &[Machine]) -> Nanos {
    machines.iter().filter_map(Machine::due).min().unwrap_or(Nanos::MAX)
}

#[cfg(test)]
mod tests;
