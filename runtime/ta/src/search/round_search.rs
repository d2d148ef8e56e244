//! A search that is gone through round by round, by those who look at what it comes to.

use std::{cell::Cell, ops::ControlFlow};

use crate::{
    network::actions::PathTransition,
    search::{
        probe::{ProbeFinding, StateProbe},
        report::{SearchCutoff, SearchProgress, SearchReport, SearchStatistics, WidestVariable},
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
    /// Asked before each round whether to go on.
    pub go_on: Option<GoOn<'a>>,
}

/// Told how far a search is; `false` ends it.
pub(crate) type GoOn<'a> = &'a dyn Fn(&SearchProgress<'_>) -> bool;

/// Who watches the searches that a question takes, and what they took.
#[derive(Clone, Copy)]
pub(crate) struct SearchCompany<'a> {
    pub go_on: GoOn<'a>,
    pub took: &'a Cell<Option<SearchStatistics>>,
    /// Of the last one that ended before its end.
    pub widest: &'a Cell<Option<WidestVariable>>,
}

impl SearchCompany<'_> {
    /// Another search has ended.
    pub(crate) fn add(&self, took: SearchStatistics) {
        self.took.set(Some(self.took.get().map_or(took, |before| before.and(took))));
    }
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

    /// No run meets these goals, as is known from elsewhere.
    fn exclude(&mut self, goals: &[usize]);

    /// What was found, when `round` has broken off with this end.
    ///
    /// # Errors
    /// If the engine contradicts itself.
    fn report(&mut self, exhausted: Option<SearchCutoff>) -> Result<SearchReport, SearchError>;

    /// Symbolic states kept.
    fn stored(&self) -> usize;

    /// The int with the most values so far.
    fn widest(&self) -> Option<WidestVariable>;

    /// What it took so far.
    fn statistics(&self) -> SearchStatistics;
}
