//! What a search found, and how far it is.

use serde::Serialize;

use crate::{network::model::CompiledNetwork, witness::run::WitnessRun};

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
    /// Clocks stand still, zones reach the goal, and no run was found that does.
    Zones,
}

/// An int of the network, and between what it was seen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WidestVariable {
    pub name: String,
    pub lo: i64,
    pub hi: i64,
}

impl WidestVariable {
    /// Of these states.
    pub(crate) fn among<'s>(
        model: &CompiledNetwork,
        states: impl Iterator<Item = &'s [i64]>,
    ) -> Option<Self> {
        let mut extremes = vec![(i64::MAX, i64::MIN); model.size()];
        for state in states {
            for (seen, &n) in extremes.iter_mut().zip(state) {
                *seen = (seen.0.min(n), seen.1.max(n));
            }
        }
        Self::of(model, &extremes)
    }

    /// Of the least and greatest of each number of the state.
    pub(crate) fn of(model: &CompiledNetwork, extremes: &[(i64, i64)]) -> Option<Self> {
        let is_int = |slot: &usize| !model.slots[*slot].is_bool && model.slots[*slot].enumeration.is_none();
        let spans = (0..model.slots.len()).filter(is_int).map(|slot| (slot, extremes[model.slot_at(slot)]));
        let (slot, (lo, hi)) = spans.max_by_key(|(_, (lo, hi))| hi.saturating_sub(*lo))?;
        (hi.saturating_sub(lo) > 1).then(|| Self { name: model.slot_name(slot), lo, hi })
    }
}

impl std::fmt::Display for WidestVariable {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { name, lo, hi } = self;
        write!(f, "`{name}` has the most values so far, from {lo} to {hi}")
    }
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
    /// Where it was left to the search whose time zones tell: what it chose, and why.
    pub chosen: Option<String>,
    /// Of a search that ended before its end: the int with the most values so far, if there is one with more than two.
    pub widest: Option<WidestVariable>,
}

/// What a search took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct SearchStatistics {
    /// Symbolic states kept at the end.
    pub stored: usize,
    /// Symbolic states whose successors were computed.
    pub visited: usize,
    /// Symbolic transitions computed.
    pub transitions: usize,
    pub discrete_states: usize,
    /// The most bytes that states took at any time.
    pub bytes: usize,
}

impl SearchStatistics {
    /// Of this search and of another one after it.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            stored: self.stored + other.stored,
            visited: self.visited + other.visited,
            transitions: self.transitions + other.transitions,
            discrete_states: self.discrete_states.max(other.discrete_states),
            bytes: self.bytes.max(other.bytes),
        }
    }
}

impl SearchReport {
    #[must_use]
    pub fn statistics(&self) -> SearchStatistics {
        SearchStatistics {
            stored: self.states_stored,
            visited: self.states_visited,
            transitions: self.transitions,
            discrete_states: self.discrete_states,
            bytes: self.peak_bytes,
        }
    }
}

/// How far a search is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SearchProgress<'s> {
    pub stored: usize,
    pub visited: usize,
    pub waiting: usize,
    pub bytes: usize,
    /// Goals that are not met yet.
    pub open: usize,
    /// For each goal whether it is not met yet.
    pub unmet: &'s [bool],
}
