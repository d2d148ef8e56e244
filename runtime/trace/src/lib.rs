//! `Trace`: what happened in one run.
//!
//! This is the waist between execution, which makes it, and judgement (monitors, coverage, reports), which reads it and
//! nothing else. A run in virtual time on a model, a run in simulation and a recording of a real robot all have this form.
//!
//! A trace is kept as text: [`record`] writes the recording format, [`parse`] reads it back. [`print`] shows a step to
//! people, [`decimal`] turns nanoseconds into seconds and back without loss. `spec/traces.md` defines the format.

pub mod decimal;
pub mod parse;
pub mod print;
pub mod record;

use hrdsl_ir::{EventId, Nanos, Value, world::SignalId};

/// One run's timestamped events and samples, in order of time; steps of the same instant in the order they happened.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    pub steps: Vec<Step>,
    /// When the run ended; no step is later.
    pub end: Nanos,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    pub time: Nanos,
    pub what: What,
}

#[derive(Clone, Debug, PartialEq)]
pub enum What {
    /// An event or stimulus happened.
    Event { event: EventId, args: Vec<Value> },
    /// A signal has this value from now on; it is recorded when it changes.
    Sample { signal: SignalId, value: Value },
}

/// Something that reads a trace step by step, in bounded memory: a monitor, a coverage collector, a recorder.
pub trait Observer {
    /// `index` counts the trace's steps from 0.
    fn step(&mut self, index: usize, step: &Step);
    /// The run ended; called once, after the last step.
    fn end(&mut self, time: Nanos);
}

impl Trace {
    /// Shows the whole trace to an observer.
    pub fn replay(&self, observer: &mut dyn Observer) {
        for (index, step) in self.steps.iter().enumerate() {
            observer.step(index, step);
        }
        observer.end(self.end);
    }
}

#[cfg(test)]
mod tests;
