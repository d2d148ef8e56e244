//! How to search.

use crate::{network::query::SearchBudget, zone::extrapolation::ExtrapolationAbstraction};

/// In which order waiting states are expanded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SearchOrder {
    /// The oldest first.
    Breadth,
    /// The oldest first, those that one round has brought in an order drawn from the seed: other runs as short as any.
    RandomBreadth,
    /// The newest first.
    Depth,
    /// The newest first, those of one state in an order drawn from the seed.
    RandomDepth,
    /// By a topological order of the locations, and states that cover others first (Herbreteau and Tran, "Improving
    /// Search Order for Reachability Testing in Timed Automata", 2015).
    #[default]
    Topological,
}

/// When a state covers another of the same discrete part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SubsumptionRelation {
    /// Its zone has all valuations of the other.
    Inclusion,
    /// The zones are the same.
    Equality,
    /// It can simulate the other, as far as lower and upper bounds of clocks tell: aLU (Herbreteau, Srivathsan and
    /// Walukiewicz, "Better Abstractions for Timed Automata", LICS 2012).
    #[default]
    Simulation,
}

/// Whose time zones tell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TimeFrame {
    /// What takes fewer zones, as far as the beginning of the search tells: see `decide/chosen.rs`.
    #[default]
    Chosen,
    /// One time for all automata.
    Common,
    /// Each automaton has a time of its own, where that serves the network and the goals: see [`local`](crate::local). Then
    /// `subsumption`, `abstraction`, `threads`, `keep_committed`, `reduce`, `counters` and `keep_shorter` have no meaning.
    Local,
}

/// How to search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SearchOptions {
    pub order: SearchOrder,
    pub subsumption: SubsumptionRelation,
    pub abstraction: ExtrapolationAbstraction,
    /// Threads; results do not depend on it.
    pub threads: usize,
    /// States with a committed location are stored, too; otherwise transitions out of them are a part of those into them.
    pub keep_committed: bool,
    /// Variables that nothing depends on are left out of the state.
    pub reduce: bool,
    /// A state covers others that differ in worse values of one-way counters alone, too: see `search/monotone.rs`. Not with
    /// `Equality`.
    pub counters: bool,
    /// No state is driven out by one that came by more transitions: breadth first, with committed states kept, witnesses are the
    /// shortest then.
    pub keep_shorter: bool,
    pub time: TimeFrame,
    pub budget: SearchBudget,
    pub seed: u64,
}

impl Default for SearchOptions {
    fn default() -> Self {
        Self {
            order: SearchOrder::default(),
            subsumption: SubsumptionRelation::default(),
            abstraction: ExtrapolationAbstraction::default(),
            threads: 1,
            keep_committed: true,
            reduce: true,
            counters: true,
            keep_shorter: false,
            time: TimeFrame::default(),
            budget: SearchBudget::default(),
            seed: 0,
        }
    }
}

impl SearchOptions {
    /// The plain zone graph by ExtraLU+ and inclusion, breadth first, of all states.
    #[must_use]
    pub fn reference() -> Self {
        Self {
            order: SearchOrder::Breadth,
            subsumption: SubsumptionRelation::Inclusion,
            reduce: false,
            counters: false,
            time: TimeFrame::Common,
            ..Self::default()
        }
    }

    /// Witnesses have as few transitions as any.
    #[must_use]
    pub fn shortest() -> Self {
        Self { order: SearchOrder::Breadth, keep_shorter: true, ..Self::default() }
    }
}
