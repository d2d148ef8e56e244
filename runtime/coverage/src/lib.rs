//! Coverage: sorts tests into bins by what happened in their traces.
//!
//! A [`Collector`] watches one trace and counts, for each coverage point, the events it asks for; its memory is one number
//! per point. [`Coverage`] is what one test covers, [`Merge`] what a set of tests covers, in whatever order and on however
//! many machines they ran. [`assume`] checks the assumptions under which stimuli are made.

pub mod assume;
mod collect;
mod merge;

pub use collect::{Collector, Coverage, hits_from_numbers};
pub use merge::{Count, Merge, Mismatch, Row};

#[cfg(test)]
mod tests;
