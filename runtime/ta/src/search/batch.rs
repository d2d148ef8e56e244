//! What expansions lead to, before it is stored.
//!
//! Each worker has a batch of its own for a round. What the states of one chunk lead to stands together in it.

use std::ops::Range;

use crate::{
    network::error::ModelError,
    search::{
        probe::ProbeFinding,
        store::{PassedList, hash_zone},
    },
    zone::dbm::DbmNumber,
};

/// A path to a goal: a node, then perhaps one transition more of its expansion. No node: the initial state.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GoalPath {
    pub node: u32,
    pub via: Option<u32>,
}

/// A symbolic state to store.
#[derive(Clone, Copy)]
pub(crate) struct PendingState {
    pub parent: u32,
    pub via: u32,
    /// `NIL`: it was not there when the round began.
    pub discrete: u32,
    /// Its place in the topological order of locations.
    pub level: u32,
    pub hash: u64,
    pub(super) zone: PendingZone,
    pub(super) dim: u32,
    /// Where the numbers of those that it covers are in the batch.
    pub(super) covered: (u32, u32),
}

/// The zone of a symbolic state to store. Most zones are known: then their entries need not be handed on.
#[derive(Clone, Copy)]
pub(crate) enum PendingZone {
    /// It was stored before the round, here.
    Stored(u32),
    /// Where it begins in the batch.
    New { at: u32, hash: u64 },
}

impl PendingZone {
    /// The zone that `zones` ends with, from there on: if it is stored, it is taken away.
    pub(crate) fn of<N: DbmNumber>(store: &PassedList<N>, zones: &mut Vec<N>, at: usize) -> Self {
        let hash = hash_zone(&zones[at..]);
        match store.find_zone(&zones[at..], hash) {
            Some(known) => {
                zones.truncate(at);
                Self::Stored(known)
            }
            None => Self::New { at: at as u32, hash },
        }
    }

    /// Its entries, which are so many: in the store, or in the `zones` of the batch.
    pub(crate) fn entries<'a, N: DbmNumber>(
        self,
        store: &'a PassedList<N>,
        zones: &'a [N],
        count: usize,
    ) -> &'a [N] {
        match self {
            Self::Stored(at) => store.zone_at(at, count),
            Self::New { at, .. } => &zones[at as usize..at as usize + count],
        }
    }
}

impl PendingState {
    /// How many entries its zone has.
    pub(crate) fn entries(&self) -> usize {
        (self.dim * self.dim) as usize
    }
}

/// A goal that is met.
pub(crate) struct GoalHit {
    pub goal: usize,
    pub path: GoalPath,
    /// When the time since the start is a clock: its least value, as an [`arrival`](super::expand::arrival).
    pub arrival: i64,
}

/// What the states of one chunk lead to: a part of a batch.
struct ExpansionChunk {
    /// Which chunk of the round.
    number: usize,
    items: Range<usize>,
    hits: Range<usize>,
    findings: Range<usize>,
    /// The last of its transitions fails.
    fault: Option<(ModelError, GoalPath)>,
    visited: usize,
    transitions: usize,
}

/// What the expansions of one worker in a round lead to.
pub(crate) struct ExpansionBatch<N> {
    chunks: Vec<ExpansionChunk>,
    items: Vec<PendingState>,
    pub(super) hits: Vec<GoalHit>,
    pub(super) findings: Vec<ProbeFinding>,
    pub(super) words: Vec<u64>,
    pub(super) zones: Vec<N>,
    pub(super) ranks: Vec<u32>,
    pub(super) covered: Vec<u32>,
    /// Of the chunk that is expanded.
    pub(super) visited: usize,
    pub(super) transitions: usize,
}

/// A chunk of a round: of which batch, and its place there.
#[derive(Clone, Copy)]
pub(crate) struct ChunkPlace {
    pub batch: usize,
    pub chunk: usize,
}

impl<N> Default for ExpansionBatch<N> {
    fn default() -> Self {
        Self {
            chunks: Vec::new(),
            items: Vec::new(),
            hits: Vec::new(),
            findings: Vec::new(),
            words: Vec::new(),
            zones: Vec::new(),
            ranks: Vec::new(),
            covered: Vec::new(),
            visited: 0,
            transitions: 0,
        }
    }
}

impl<N: DbmNumber> ExpansionBatch<N> {
    pub(crate) fn clear(&mut self) {
        self.chunks.clear();
        self.items.clear();
        self.hits.clear();
        self.findings.clear();
        self.words.clear();
        self.zones.clear();
        self.ranks.clear();
        self.covered.clear();
    }

    /// What was added since the last chunk are the findings of this one.
    pub(crate) fn end_chunk(&mut self, number: usize, fault: Option<(ModelError, GoalPath)>) {
        let last = self.chunks.last();
        let from = |end: fn(&ExpansionChunk) -> usize| last.map_or(0, end);
        let chunk = ExpansionChunk {
            number,
            items: from(|c| c.items.end)..self.items.len(),
            hits: from(|c| c.hits.end)..self.hits.len(),
            findings: from(|c| c.findings.end)..self.findings.len(),
            fault,
            visited: std::mem::take(&mut self.visited),
            transitions: std::mem::take(&mut self.transitions),
        };
        self.chunks.push(chunk);
    }

    /// Adds a symbolic state, whose words and ranks were added before.
    pub(super) fn push(&mut self, item: PendingState) {
        self.items.push(item);
    }

    /// How many states were expanded for the chunk, and their transitions.
    pub(crate) fn work(&self, chunk: usize) -> (usize, usize) {
        (self.chunks[chunk].visited, self.chunks[chunk].transitions)
    }

    pub(crate) fn take_fault(&mut self, chunk: usize) -> Option<(ModelError, GoalPath)> {
        self.chunks[chunk].fault.take()
    }

    pub(crate) fn items(&self, chunk: usize) -> Range<usize> {
        self.chunks[chunk].items.clone()
    }

    pub(crate) fn hits(&self, chunk: usize) -> &[GoalHit] {
        &self.hits[self.chunks[chunk].hits.clone()]
    }

    pub(crate) fn findings(&self, chunk: usize) -> &[ProbeFinding] {
        &self.findings[self.chunks[chunk].findings.clone()]
    }

    pub(crate) fn item(&self, item: usize) -> &PendingState {
        &self.items[item]
    }

    /// Its discrete state, of so many words.
    pub(crate) fn packed(&self, item: usize, words: usize) -> &[u64] {
        &self.words[item * words..(item + 1) * words]
    }

    /// Its zone, which may be a stored one.
    pub(crate) fn zone<'a>(&'a self, item: &PendingState, store: &'a PassedList<N>) -> &'a [N] {
        item.zone.entries(store, &self.zones, item.entries())
    }

    /// Where its zone is stored now.
    pub(crate) fn intern(&self, item: &PendingState, store: &mut PassedList<N>) -> u32 {
        match item.zone {
            PendingZone::Stored(at) => at,
            PendingZone::New { at, hash } => {
                store.intern(&self.zones[at as usize..at as usize + item.entries()], hash)
            }
        }
    }

    /// The ranks of so many one-way counters.
    pub(crate) fn ranks(&self, item: usize, counters: usize) -> &[u32] {
        &self.ranks[item * counters..(item + 1) * counters]
    }

    /// Stored states that the item covers.
    pub(crate) fn covered(&self, item: &PendingState) -> &[u32] {
        &self.covered[item.covered.0 as usize..item.covered.1 as usize]
    }

    pub(crate) fn bytes(&self) -> usize {
        self.items.len() * size_of::<PendingState>()
            + self.words.len() * 8
            + self.zones.len() * size_of::<N>()
            + (self.ranks.len() + self.covered.len()) * 4
    }
}

/// The chunks of a round in their order.
pub(crate) fn in_order<N>(batches: &[ExpansionBatch<N>]) -> Vec<ChunkPlace> {
    let places = |(batch, b): (usize, &ExpansionBatch<N>)| {
        b.chunks
            .iter()
            .enumerate()
            .map(move |(chunk, c)| (c.number, ChunkPlace { batch, chunk }))
            .collect::<Vec<_>>()
    };
    let mut all: Vec<(usize, ChunkPlace)> = batches.iter().enumerate().flat_map(places).collect();
    all.sort_unstable_by_key(|(number, _)| *number);
    all.into_iter().map(|(_, place)| place).collect()
}
