//! Coverage: sorts tests into bins by what happened in their traces.
//!
//! A [`CoverageCollector`] watches one trace and counts, for each coverpoint, the events it asks for; its memory is one number
//! per point. [`TestCoverage`] is what one test covers, [`MergedCoverage`] what a set of tests covers, in whatever order and on however
//! many machines they ran. [`assume`] checks the assumptions under which stimuli are made.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::wildcard_enum_match_arm))]

pub mod assume;
mod collect;
mod merge;

pub use collect::{CoverageCollector, TestCoverage, hits_from_numbers};
pub use merge::{BinCount, CoverageMismatchError, CoverageRow, MergedCoverage};

#[cfg(test)]
mod tests;
