//! What a search found, and how far it is.

use crate::witness::run::WitnessRun;

/// How a goal ended.
#[derive(Clone, Debug, PartialEq)]
pub enum GoalOutcome {
    /// The witness was replayed under concrete clocks.
    Reached(Box<WitnessRun>),
    /// All that can be reached was seen.
    Unreachable,
    /// The budget was used up first.
    Inconclusive(SearchCutoff),
}

/// What ended a search before its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SearchCutoff {
    States,
    Memory,
    /// The caller had enough: see [`explore`](crate::explore).
    Stopped,
}

/// What a search found.
#[derive(Clone, Debug, PartialEq)]
pub struct SearchReport {
    /// One for each goal, in the order of the question.
    pub goals: Vec<GoalOutcome>,
    /// Symbolic states kept at the end.
    pub states_stored: usize,
    /// Symbolic states whose successors were computed.
    pub states_visited: usize,
    /// Discrete states.
    pub discrete_states: usize,
    /// Symbolic transitions computed.
    pub transitions: usize,
    /// The most bytes that states took at any time.
    pub peak_bytes: usize,
    /// Nothing was left to explore. Without goals a search goes on to this end or to that of its budget.
    pub complete: bool,
    /// Why local time, which was asked for, does not serve this network or these goals.
    pub global_because: Option<String>,
}

/// How far a search is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SearchProgress {
    pub stored: usize,
    pub visited: usize,
    pub waiting: usize,
    pub bytes: usize,
    /// Goals that are not met yet.
    pub open: usize,
}
