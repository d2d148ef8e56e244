//! What the states of a round lead to with local time, before it is stored.
//!
//! Each worker has a batch of its own for a round; what the states of one chunk lead to stands together in it.

use hashbrown::HashTable;

use super::{
    crew::LocalContext,
    refusal::LocalSearchError,
    space::LocalWorkspace,
    waiting::{PackedZone, ZoneSlab, append_narrow},
    zone::{self, LocalLuBounds, LocalZoneBound},
};
use crate::search::{
    batch::PendingZone,
    store::{NIL, PackedState},
    waiting::level,
};

/// A successor that something comes of: it meets goals by its transition, or nothing stored simulates it.
pub(super) struct LocalSuccessor {
    /// Its number among those of its node.
    pub number: u32,
    /// Where the goals that the transition meets end in those of the batch.
    hits: usize,
    found: Option<FoundState>,
}

/// A successor that no stored state simulates, nor one found before, and where its parts begin in the batch.
struct FoundState {
    /// The node whose successor it is: its place in the batch.
    node: u32,
    /// The successor of the same discrete state that was found before it, or [`NIL`].
    before: u32,
    /// `NIL`: its discrete state was not there when the round began.
    discrete: u32,
    level: u32,
    hash: u64,
    /// Most synchronised zones are stored already.
    together: PendingZone,
    /// How many clocks matter.
    clocks: usize,
    words: usize,
    /// The goals that its discrete state meets, if that was not there when the round began.
    met: (usize, usize),
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
    /// Where the nodes that it relies on end in those of the batch.
    relied_on: usize,
    /// Its successors were stored, as far as nothing simulates them.
    pub done: bool,
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
    met: Vec<usize>,
    together: Vec<LocalZoneBound>,
    lu: Vec<LocalLuBounds>,
    /// How many bounds a zone has.
    bounds: usize,
    narrow: Vec<i16>,
    wide: Vec<LocalZoneBound>,
    driven_out: Vec<u32>,
    /// The last successor found of each discrete state.
    last: HashTable<u32>,
    /// For each node those whose successors simulate some of its own, which therefore are not here.
    relied_on: Vec<u32>,
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
        self.met.clear();
        self.together.clear();
        self.lu.clear();
        self.narrow.clear();
        self.wide.clear();
        self.driven_out.clear();
        self.last.clear();
        self.relied_on.clear();
    }

    /// The nodes that follow are those of the round's chunk of this number.
    pub(super) fn begin_chunk(&mut self, number: usize) {
        self.chunks.push((number, self.nodes.len()));
    }

    /// The transition that is looked at meets a goal.
    pub(super) fn hit(&mut self, goal: usize) {
        self.hits.push(goal);
    }

    /// Keeps what is in the workspace, looked up, unless a successor that was found before simulates it.
    pub(super) fn found(&mut self, c: &LocalContext, w: &mut LocalWorkspace, driven_out: &[u32]) {
        let node = self.nodes.len() as u32;
        let PackedState { hash, known, .. } = w.packed;
        let before = self.last_of(hash, &w.packed.words);
        if let Some(by) = self.simulating(c, w, before) {
            // Of one node all successors are stored, or none.
            let first = self.nodes.last().map_or(0, |n| n.relied_on);
            if by != node && !self.relied_on[first..].contains(&by) {
                self.relied_on.push(by);
            }
            return;
        }
        let met = self.met.len();
        if known.is_none() && c.look(w, &mut self.met).is_err() {
            // Whoever stores it comes to the same failure.
            self.met.truncate(met);
            self.relied_on.push(node);
            return;
        }
        let met = (met, self.met.len());
        self.set_last(hash, before);
        let first = self.driven_out.len();
        self.driven_out.extend_from_slice(driven_out);
        self.bounds = w.zone.bounds().len();
        let at = self.narrow.len();
        let zone = if append_narrow(w.zone.bounds(), &mut self.narrow) {
            ZoneSpan::Narrow(at)
        } else {
            self.wide.extend_from_slice(w.zone.bounds());
            ZoneSpan::Wide(self.wide.len() - self.bounds)
        };
        let at = self.together.len();
        self.together.extend_from_slice(&w.together);
        let together = PendingZone::of(c.store, &mut self.together, at);
        self.pending = Some(FoundState {
            node,
            before,
            discrete: known.unwrap_or(NIL),
            level: level(c.levels, &w.effect.target, &[]),
            hash,
            together,
            clocks: w.lu.len(),
            words: self.words.len(),
            met,
            lu: self.lu.len(),
            zone,
            driven_out: (first, self.driven_out.len()),
        });
        self.words.extend_from_slice(&w.packed.words);
        self.lu.extend_from_slice(&w.lu);
    }

    /// The last successor found of a discrete state, or [`NIL`].
    fn last_of(&self, hash: u64, packed: &[u64]) -> u32 {
        let is = |&s: &u32| {
            let found = self.successors[s as usize].found.as_ref();
            found.is_some_and(|f| self.words[f.words..].starts_with(packed))
        };
        self.last.find(hash, is).copied().unwrap_or(NIL)
    }

    /// The next successor takes the place of the last one of its discrete state, if there is one.
    fn set_last(&mut self, hash: u64, before: u32) {
        let next = self.successors.len() as u32;
        match self.last.find_mut(hash, |&s| s == before) {
            Some(last) => *last = next,
            None => {
                let of = |&s: &u32| self.successors[s as usize].found.as_ref().map_or(0, |f| f.hash);
                self.last.insert_unique(hash, next, of);
            }
        }
    }

    /// The node of a successor of the discrete state, this one or one found before, that simulates the state in the workspace.
    fn simulating(&self, c: &LocalContext, w: &LocalWorkspace, mut last: u32) -> Option<u32> {
        let entries = (w.lu.len() + 1).pow(2);
        while last != NIL {
            let f = self.successors[last as usize].found.as_ref()?;
            let old = f.together.entries(c.store, &self.together, entries);
            if zone::is_simulated(&w.together, old, &w.lu) {
                return Some(f.node);
            }
            last = f.before;
        }
        None
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
        self.nodes.push(LocalExpansion {
            node,
            transitions,
            end: self.successors.len(),
            relied_on: self.relied_on.len(),
            done: false,
            failure,
        });
    }

    /// Whether the successors of a node are all here, or simulated by what was stored. Otherwise it must be expanded again: it relied on
    /// successors of nodes that were driven out meanwhile.
    pub(super) fn is_whole(&self, node: usize) -> bool {
        let first = node.checked_sub(1).map_or(0, |before| self.nodes[before].relied_on);
        self.relied_on[first..self.nodes[node].relied_on].iter().all(|&on| self.nodes[on as usize].done)
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

    /// Writes the zones that are waited with to where they wait.
    pub(super) fn write(&self, slab: &mut ZoneSlab<i16>) {
        slab.write(&self.narrow, self.bounds);
    }

    /// The goals that the discrete state of a successor meets, which was not there when the round began.
    pub(super) fn met(&self, successor: usize) -> &[usize] {
        self.successors[successor].found.as_ref().map_or(&[], |f| &self.met[f.met.0..f.met.1])
    }

    /// What is to be stored of a successor, whose packed state has so many words; `None`: a stored one
    /// simulates it. The nodes before `compared` were there when the round began.
    pub(super) fn arrival(
        &self,
        successor: usize,
        words: usize,
        (worker, compared): (usize, u32),
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
                ZoneSpan::Narrow(at) => PackedZone::Unwritten { worker, at },
                ZoneSpan::Wide(at) => PackedZone::Wide(&self.wide[at..at + self.bounds]),
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
