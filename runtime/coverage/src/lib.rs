//! Coverage: sorts tests into bins by what happened in their traces.
//!
//! A [`CoverageCollector`] watches one trace and counts, for each coverpoint, the events it asks for; its memory is one number
//! per point. [`TestCoverage`] is what one test covers. A [`MachineCollector`] does the same for the system's state machines. [`assume`] checks the assumptions under which stimuli are made.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::wildcard_enum_match_arm))]

pub mod assume;
mod collect;
mod machines;

pub use collect::{CoverageCollector, TestCoverage, hits_from_numbers};
pub use machines::{MachineCollector, MachineHits};

#[cfg(test)]
mod tests;
