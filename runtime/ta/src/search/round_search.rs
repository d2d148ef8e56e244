//! A search that is gone through round by round, by those who look at what it comes to.

use std::ops::ControlFlow;

use crate::{
    network::actions::PathTransition,
    search::{
        probe::{ProbeFinding, StateProbe},
        report::SearchCutoff,
    },
    witness::error::SearchError,
};

/// What a search does beside looking for goals.
#[derive(Clone, Copy, Default)]
pub(crate) struct SearchAside<'a> {
    pub probe: Option<&'a dyn StateProbe>,
    /// The time since the start is a clock, up to so many units, states are taken by its least value, and of each goal (or question of
    /// the probe) the earliest is found.
    pub within: Option<i64>,
}

/// A search that is gone through round by round.
pub(crate) trait RoundSearch {
    /// Goes on by a round, and adds what the probe found in it. It breaks off at the end, with the budget that was used up.
    ///
    /// # Errors
    /// If the model is at fault, or the engine contradicts itself.
    fn round(
        &mut self,
        found: &mut Vec<ProbeFinding>,
    ) -> Result<ControlFlow<Option<SearchCutoff>>, SearchError>;

    /// What arrives later than this is left out from now on.
    fn only_until(&mut self, arrival: i64);

    /// The path to a node.
    ///
    /// # Errors
    /// If the engine contradicts itself.
    fn path_to(&mut self, node: u32) -> Result<Vec<PathTransition>, SearchError>;

    /// The path to a goal that was met.
    ///
    /// # Errors
    /// If the engine contradicts itself.
    fn path_to_goal(&mut self, goal: usize) -> Result<Option<Vec<PathTransition>>, SearchError>;

    /// Symbolic states kept.
    fn stored(&self) -> usize;
}
