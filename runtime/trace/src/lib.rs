//! `Trace`: what happened in one run.
//!
//! This is the waist between execution, which makes it, and judgement (monitors, coverage, reports), which reads it and
//! nothing else. A run in virtual time on a model, a run in simulation and a recording, whoever wrote it, all have this form.
//!
//! A trace is kept as text: [`record`] writes the recording format, [`parse`] reads it back, step by step if it is long.
//! [`print`](mod@print) shows a step to people, [`decimal`] turns nanoseconds into seconds and back without loss, [`vocabulary`] tells
//! scenarios apart whose recordings are not each other's. `spec/traces.md` defines the format. Beside the trace, and judged by nobody, there may be
//! a [`picture`] of the world.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::wildcard_enum_match_arm))]

pub mod decimal;
mod machine;
pub mod parse;
pub mod picture;
pub mod print;
pub mod record;
pub mod vocabulary;

use hrdsl_ir::{EventId, Nanos, Value, world::SignalId};
use serde::{Deserialize, Serialize};

pub use machine::{MachineDeclaration, MachineEdge, MachineStep};

/// One run's timestamped events and samples, in order of time; steps of the same instant in the order they happened.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    pub steps: Vec<TraceStep>,
    /// When the run ended; no step is later.
    pub end: Nanos,
}

#[derive(Clone, Debug, PartialEq)]
pub struct TraceStep {
    pub time: Nanos,
    pub what: TraceStepKind,
}

#[derive(Clone, Debug, PartialEq)]
pub enum TraceStepKind {
    /// An event or stimulus happened.
    Event { event: EventId, args: Vec<Value> },
    /// A signal has this value from now on; it is recorded when it changes.
    Sample { signal: SignalId, value: Value },
    /// A state machine of the system was declared, begun or has moved. No requirement reads it.
    Machine(Box<MachineStep>),
}

/// A step of a trace that need not be kept for it.
#[derive(Clone, Debug, PartialEq)]
pub struct SeenStep {
    /// Its place in the trace, from 0.
    pub index: usize,
    pub step: TraceStep,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RunEnd {
    /// Nothing more could happen.
    #[default]
    Quiescent,
    /// At the time limit.
    Limit,
    /// It broke off: what it did not do, it might have done.
    Error,
}

impl RunEnd {
    pub const ALL: [RunEnd; 3] = [RunEnd::Quiescent, RunEnd::Limit, RunEnd::Error];

    /// The word for it, in recordings and results.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            RunEnd::Quiescent => "quiescent",
            RunEnd::Limit => "limit",
            RunEnd::Error => "error",
        }
    }

    /// The end that a word stands for; `quiet` is what older recordings say for `quiescent`.
    #[must_use]
    pub fn of_word(word: &str) -> Option<Self> {
        let word = if word == "quiet" { "quiescent" } else { word };
        Self::ALL.into_iter().find(|end| end.word() == word)
    }
}

/// Something that reads a trace step by step, in bounded memory: a monitor, a coverage collector, a recorder.
pub trait TraceObserver {
    /// `index` counts the trace's steps from 0.
    fn step(&mut self, index: usize, step: &TraceStep);
    /// The run ended; called once, after the last step.
    fn end(&mut self, time: Nanos);
}

impl Trace {
    /// Shows the whole trace to an observer.
    pub fn replay(&self, observer: &mut dyn TraceObserver) {
        for (index, step) in self.steps.iter().enumerate() {
            observer.step(index, step);
        }
        observer.end(self.end);
    }
}

/// A trace takes down what it is shown.
impl TraceObserver for Trace {
    fn step(&mut self, _: usize, step: &TraceStep) {
        self.steps.push(step.clone());
    }

    fn end(&mut self, time: Nanos) {
        self.end = time;
    }
}

#[cfg(test)]
mod tests;
