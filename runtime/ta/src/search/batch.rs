//! What expansions lead to, before it is stored.

use crate::{network::error::ModelError, search::probe::ProbeFinding};

/// A path to a goal: a node, then perhaps one transition more of its expansion. No node: the initial state.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GoalPath {
    pub node: u32,
    pub via: Option<u32>,
}

/// A symbolic state to store.
pub(crate) struct PendingState {
    pub parent: u32,
    pub via: u32,
    /// `NIL`: it was not there when the round began.
    pub discrete: u32,
    pub hash: u64,
    /// Its place in the topological order of locations.
    pub level: u32,
    pub dim: usize,
    pub(super) words: usize,
    pub(super) zone: usize,
    pub(super) ranks: usize,
    pub(super) covered: (usize, usize),
}

/// A goal that is met.
pub(crate) struct GoalHit {
    pub goal: usize,
    pub path: GoalPath,
    /// When the time since the start is a clock: its least value, as an [`arrival`](super::expand::arrival).
    pub arrival: i64,
}

/// What expansions lead to.
pub(crate) struct ExpansionBatch<N> {
    pub items: Vec<PendingState>,
    pub hits: Vec<GoalHit>,
    pub findings: Vec<ProbeFinding>,
    pub fault: Option<(ModelError, GoalPath)>,
    pub visited: usize,
    pub transitions: usize,
    pub(super) words: Vec<u64>,
    pub(super) zones: Vec<N>,
    pub(super) ranks: Vec<u32>,
    pub(super) covered: Vec<u32>,
}

impl<N> Default for ExpansionBatch<N> {
    fn default() -> Self {
        Self {
            items: Vec::new(),
            hits: Vec::new(),
            findings: Vec::new(),
            fault: None,
            visited: 0,
            transitions: 0,
            words: Vec::new(),
            zones: Vec::new(),
            ranks: Vec::new(),
            covered: Vec::new(),
        }
    }
}

impl<N> ExpansionBatch<N> {
    pub(crate) fn clear(&mut self) {
        self.items.clear();
        self.hits.clear();
        self.findings.clear();
        self.fault = None;
        self.visited = 0;
        self.transitions = 0;
        self.words.clear();
        self.zones.clear();
        self.ranks.clear();
        self.covered.clear();
    }

    pub(crate) fn packed(&self, item: &PendingState, words: usize) -> &[u64] {
        &self.words[item.words..item.words + words]
    }

    pub(crate) fn zone(&self, item: &PendingState) -> &[N] {
        &self.zones[item.zone..item.zone + item.dim * item.dim]
    }

    /// The ranks of so many one-way counters.
    pub(crate) fn ranks(&self, item: &PendingState, counters: usize) -> &[u32] {
        &self.ranks[item.ranks..item.ranks + counters]
    }

    /// Stored states that the item covers.
    pub(crate) fn covered(&self, item: &PendingState) -> &[u32] {
        &self.covered[item.covered.0..item.covered.1]
    }

    pub(crate) fn bytes(&self) -> usize {
        self.items.capacity() * size_of::<PendingState>()
            + self.words.capacity() * 8
            + self.zones.capacity() * size_of::<N>()
            + (self.ranks.capacity() + self.covered.capacity()) * 4
    }
}
