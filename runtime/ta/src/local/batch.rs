//! What the states of a round lead to with local time, before it is stored.
//!
//! Each worker has a batch of its own for a round; what the states of one chunk lead to stands together in it.

use super::{
    crew::LocalContext,
    refusal::LocalSearchError,
    space::LocalWorkspace,
    waiting::PackedZone,
    zone::{LocalLuBounds, LocalZoneBound},
};
use crate::search::{batch::PendingZone, store::NIL, waiting::level};

/// A successor that something comes of: it meets goals by its transition, or nothing stored simulates it.
pub(super) struct LocalSuccessor {
    /// Its number among those of its node.
    pub number: u32,
    /// Where the goals that the transition meets end in those of the batch.
    hits: usize,
    found: Option<FoundState>,
}

/// A successor that no stored state simulates, and where its parts begin in the batch.
struct FoundState {
    /// `NIL`: its discrete state was not there when the round began.
    discrete: u32,
    level: u32,
    hash: u64,
    /// Most synchronised zones are stored already.
    together: PendingZone,
    /// How many clocks matter.
    clocks: usize,
    words: usize,
    state: usize,
    lu: usize,
    zone: ZoneSpan,
    driven_out: (usize, usize),
}

/// Where a packed zone is in the batch.
enum ZoneSpan {
    Narrow(usize),
    Wide(usize),
}

/// A synchronised zone that is to be stored.
#[derive(Clone, Copy)]
pub(super) enum ArrivedZone<'a> {
    /// It is stored already, here.
    Stored(u32),
    New {
        bounds: &'a [LocalZoneBound],
        hash: u64,
    },
}

/// What is to be stored of a state.
pub(super) struct LocalArrival<'a> {
    pub packed: &'a [u64],
    pub hash: u64,
    /// `NIL`: it is not known to be stored.
    pub discrete: u32,
    pub level: u32,
    /// The synchronised zone.
    pub together: ArrivedZone<'a>,
    pub lu: &'a [LocalLuBounds],
    pub zone: PackedZone<'a>,
    /// All stored nodes before this one were compared with it; it simulates `driven_out` of them.
    pub compared: u32,
    pub driven_out: &'a [u32],
}

/// What one state leads to.
pub(super) struct LocalExpansion {
    pub node: u32,
    pub transitions: usize,
    /// Where its successors end in those of the batch.
    pub end: usize,
    /// Its last transition fails.
    pub failure: Option<LocalSearchError>,
}

/// What the states of a worker's chunks lead to.
#[derive(Default)]
pub(super) struct LocalBatch {
    /// The chunks' numbers in the round, and where their nodes begin.
    chunks: Vec<(usize, usize)>,
    pub nodes: Vec<LocalExpansion>,
    pub successors: Vec<LocalSuccessor>,
    hits: Vec<usize>,
    words: Vec<u64>,
    states: Vec<i64>,
    together: Vec<LocalZoneBound>,
    lu: Vec<LocalLuBounds>,
    narrow: Vec<i16>,
    wide: Vec<LocalZoneBound>,
    driven_out: Vec<u32>,
    /// What the successor that is being added leads to.
    pending: Option<FoundState>,
}

impl LocalBatch {
    pub(super) fn clear(&mut self) {
        self.chunks.clear();
        self.nodes.clear();
        self.successors.clear();
        self.hits.clear();
        self.words.clear();
        self.states.clear();
        self.together.clear();
        self.lu.clear();
        self.narrow.clear();
        self.wide.clear();
        self.driven_out.clear();
    }

    /// The nodes that follow are those of the round's chunk of this number.
    pub(super) fn begin_chunk(&mut self, number: usize) {
        self.chunks.push((number, self.nodes.len()));
    }

    /// The transition that is looked at meets a goal.
    pub(super) fn hit(&mut self, goal: usize) {
        self.hits.push(goal);
    }

    /// Keeps what is in the workspace; its discrete state is `known`, or not yet stored, packed like this with its hash.
    pub(super) fn found(
        &mut self,
        c: &LocalContext,
        w: &LocalWorkspace,
        known: Option<u32>,
        (hash, packed): (u64, &[u64]),
        driven_out: &[u32],
        narrow: &mut Vec<i16>,
    ) {
        let first = self.driven_out.len();
        self.driven_out.extend_from_slice(driven_out);
        let zone = match PackedZone::of(&w.zone, narrow) {
            PackedZone::Narrow(bounds) => {
                self.narrow.extend_from_slice(bounds);
                ZoneSpan::Narrow(self.narrow.len() - bounds.len())
            }
            PackedZone::Wide(bounds) => {
                self.wide.extend_from_slice(bounds);
                ZoneSpan::Wide(self.wide.len() - bounds.len())
            }
        };
        let at = self.together.len();
        self.together.extend_from_slice(&w.together);
        let together = PendingZone::of(c.store, &mut self.together, at);
        self.pending = Some(FoundState {
            discrete: known.unwrap_or(NIL),
            level: level(c.levels, &w.effect.target, &[]),
            hash,
            together,
            clocks: w.lu.len(),
            words: self.words.len(),
            state: self.states.len(),
            lu: self.lu.len(),
            zone,
            driven_out: (first, self.driven_out.len()),
        });
        self.words.extend_from_slice(packed);
        // Only goals ask for it.
        if known.is_none() && !c.open.is_empty() {
            self.states.extend_from_slice(&w.effect.target);
        }
        self.lu.extend_from_slice(&w.lu);
    }

    /// The successor of this number is complete.
    pub(super) fn end_successor(&mut self, number: u32) {
        let found = self.pending.take();
        let before = self.successors.last().map_or(0, |s| s.hits);
        if found.is_some() || self.hits.len() > before {
            self.successors.push(LocalSuccessor { number, hits: self.hits.len(), found });
        }
    }

    pub(super) fn end_node(&mut self, node: u32, transitions: usize, failure: Option<LocalSearchError>) {
        self.nodes.push(LocalExpansion { node, transitions, end: self.successors.len(), failure });
    }

    /// Where the successors of a node begin.
    pub(super) fn first_successor(&self, node: usize) -> usize {
        node.checked_sub(1).map_or(0, |before| self.nodes[before].end)
    }

    /// The goals that the transition to the successor meets.
    pub(super) fn hits(&self, successor: usize) -> &[usize] {
        let before = successor.checked_sub(1).map_or(0, |before| self.successors[before].hits);
        &self.hits[before..self.successors[successor].hits]
    }

    /// The discrete state of a successor that was not there when the round began, if goals ask for it.
    pub(super) fn state(&self, successor: usize, size: usize) -> &[i64] {
        let found = self.successors[successor].found.as_ref();
        found.and_then(|f| self.states.get(f.state..f.state + size)).unwrap_or(&[])
    }

    /// What is to be stored of a successor, whose packed state has so many words and whose zone so many bounds; `None`: a stored one
    /// simulates it. The nodes before `compared` were there when the round began.
    pub(super) fn arrival(
        &self,
        successor: usize,
        words: usize,
        bounds: usize,
        compared: u32,
    ) -> Option<LocalArrival<'_>> {
        let f = self.successors[successor].found.as_ref()?;
        let dim = f.clocks + 1;
        Some(LocalArrival {
            packed: &self.words[f.words..f.words + words],
            hash: f.hash,
            discrete: f.discrete,
            level: f.level,
            together: match f.together {
                PendingZone::Stored(at) => ArrivedZone::Stored(at),
                PendingZone::New { at, hash } => {
                    ArrivedZone::New { bounds: &self.together[at as usize..at as usize + dim * dim], hash }
                }
            },
            lu: &self.lu[f.lu..f.lu + f.clocks],
            zone: match f.zone {
                ZoneSpan::Narrow(at) => PackedZone::Narrow(&self.narrow[at..at + bounds]),
                ZoneSpan::Wide(at) => PackedZone::Wide(&self.wide[at..at + bounds]),
            },
            compared,
            driven_out: &self.driven_out[f.driven_out.0..f.driven_out.1],
        })
    }
}

/// The nodes of a round in their order: in which batch each is, and its place there.
pub(super) fn in_order(batches: &[LocalBatch], out: &mut Vec<(usize, usize)>) {
    let mut chunks: Vec<(usize, usize, std::ops::Range<usize>)> = Vec::new();
    for (number, batch) in batches.iter().enumerate() {
        let ends = batch.chunks.iter().skip(1).map(|c| c.1).chain([batch.nodes.len()]);
        chunks
            .extend(batch.chunks.iter().zip(ends).map(|(&(chunk, first), end)| (chunk, number, first..end)));
    }
    chunks.sort_unstable_by_key(|(chunk, _, _)| *chunk);
    out.clear();
    out.extend(chunks.into_iter().flat_map(|(_, batch, nodes)| nodes.map(move |node| (batch, node))));
}
