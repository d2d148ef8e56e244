//! How networks are searched, and the one place that calls the search.

use std::sync::atomic::{AtomicBool, AtomicUsize};

use hrdsl_ir::suite::{Delays, WitnessKind};
use hrdsl_ta::{Budget, Counter, Error, Goal, Limit, Report};

use super::Observed;

/// How to search.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Settings {
    pub budget: Budget,
    pub order: Order,
    /// Threads that search at once; 0 is 1.
    pub threads: usize,
    pub witness: WitnessKind,
    pub delays: Delays,
    /// Of what is drawn: sampled delays, a random order.
    pub seed: u64,
    /// First look for what keeps windowed assumptions for certain: better for tests. Otherwise first for what cannot be
    /// reached even without them: better for proofs.
    pub keep_first: bool,
}

/// In which order states are looked at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Order {
    #[default]
    Breadth,
    Depth,
    Random,
    Topological,
}

/// Who watches a search from another thread.
#[derive(Clone, Copy, Debug)]
pub struct Watch<'a> {
    /// Set: the search ends soon, and what is not decided is open.
    pub stop: &'a AtomicBool,
    /// How many states are stored so far.
    pub stored: &'a AtomicUsize,
}

pub(crate) fn search(
    observed: &Observed,
    goals: &[Goal],
    counters: &[Counter],
    limits: &[Limit],
    settings: &Settings,
) -> Result<Report, Error> {
    hrdsl_ta::check(&observed.program, &observed.network, goals, counters, limits, settings.budget)
}
