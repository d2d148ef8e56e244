//! Witnesses: a run of a network that shows something, with concrete times.

use hrdsl_ir::{
    EventId, Nanos, Value,
    ta::{ChannelId, LocationId},
};
use hrdsl_trace::{Trace, TraceStep, TraceStepKind};
use serde::{Deserialize, Serialize};

use crate::network::semantics::AutomatonMove;

/// A run of the network.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WitnessRun {
    /// The network's name.
    pub network: String,
    /// Ticks in a nanosecond; 1 unless strict bounds are finer than that.
    pub ticks: i64,
    pub steps: Vec<WitnessRunStep>,
    /// When what it shows is so, in ticks: with the last transition, or later if time had to pass.
    pub end: i64,
    pub ending: RunEnding,
}

/// How a run goes on after its last transition.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RunEnding {
    /// What was asked for is reached.
    #[default]
    Reached,
    /// The steps from this one on can be repeated for ever; not always with the same delays. Runs in which time does not
    /// pass beyond a bound (Zeno runs) count.
    Again(usize),
    /// Nothing more can happen.
    Stuck,
    /// Time can pass for ever, and nothing has to happen.
    Waits,
    /// What would happen next, at this instant, is a fault of the model.
    Fault,
}

/// One transition.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WitnessRunStep {
    /// Since the start, in ticks.
    pub time: i64,
    /// What was sent; `None`: nothing.
    pub event: Option<(EventId, Vec<Value>)>,
    /// The channel that it went over, with the arguments of the offer.
    pub channel: Option<(ChannelId, Vec<Value>)>,
    /// The edges taken: the sender's first, then those of who takes part, in the network's order; of a multi-way channel in the
    /// order of its participants.
    pub moves: Vec<AutomatonMove>,
    /// Which automata changed their location: index in the network, from, to.
    pub locations: Vec<(usize, LocationId, LocationId)>,
    /// Which variables changed: slot of the network, from, to.
    pub variables: Vec<(usize, Value, Value)>,
}

impl WitnessRun {
    /// The time of a step in nanoseconds, rounded down if ticks are finer.
    #[must_use]
    pub fn nanos(&self, step: &WitnessRunStep) -> Nanos {
        step.time.div_euclid(self.ticks.max(1))
    }

    /// The events as a trace, which ends with the last transition.
    #[must_use]
    pub fn trace(&self) -> Trace {
        let mut trace = Trace::default();
        for step in &self.steps {
            trace.end = self.nanos(step);
            if let Some((event, args)) = &step.event {
                let what = TraceStepKind::Event { event: *event, args: args.clone() };
                trace.steps.push(TraceStep { time: trace.end, what });
            }
        }
        trace
    }
}
