//! Timed conformance: whether what the code did in a run is something that the automata which model it can do.
//!
//! The relation is rtioco: the timed input-output conformance of Krichen and Tripakis, after Tretmans, relative to the inputs that occurred, as
//! UPPAAL-TRON (Larsen, Mikucionis, Nielsen) tests it. What the system's actor hears are the inputs, what it makes the outputs, and time is an
//! output: who comes too late, or not at all, does not conform. `spec/conformance.md` says it to the letter.
//!
//! # Steps
//! 1. [`system_models`] finds the automata that play the system;
//! 2. a [`ConformanceChecker`] is shown a trace, and keeps for each model the set of all states in which it can be: locations, variables, and a
//!    zone of clocks (`states`, `walk`);
//! 3. [`ConformanceChecker::finish`] gives a verdict for each model: an observation that leaves no state is a departure (`checker`), and
//!    what would have left some is what the model allowed (`allowed`).
//!
//! Besides, [`calibrate()`] says which bounds of a model recordings contradict, and which would fit; and a [`ModelTrail`] has the parts of a model that a
//! recording visits, and what it allows after each observation.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::wildcard_enum_match_arm))]

mod allowed;
mod bounds;
mod calibrate;
mod checker;
mod fitting;
mod model;
mod sharing;
mod states;
mod trail;
mod walk;

pub use calibrate::{ContradictedBound, ModelCalibration, RecordedRun, calibrate};
pub use checker::ConformanceChecker;
pub use model::{SystemModel, system_models};
pub use trail::{AllowanceDifference, ModelPart, ModelTrail};

use hrdsl_ir::{EventId, Nanos};

/// What is known of how a trace shows what the code did.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ConformanceOptions {
    /// What the code makes may be seen so much later than it happened, in the order in which it did.
    pub latency: Nanos,
    /// Events that happen and that traces do not have.
    pub unobserved: Vec<EventId>,
}
