//! What a search keeps: discrete states packed by known ranges, zones each once, and for each discrete state the zones that
//! no other covers.

use std::hash::Hasher;

use prefetch_index::prefetch_index;
use rustc_hash::FxHasher;

use crate::{
    search::{
        discrete::DiscreteStates,
        hash_index::{HashIndex, half},
        threads::CrewThreads,
    },
    zone::dbm::DbmNumber,
};

/// Bytes of a line of the processor's cache.
pub(crate) const LINE: usize = 64;

/// No node, no state, no zone.
pub(crate) const NIL: u32 = u32::MAX;

/// Where a number of the discrete vector lies in the packed form.
#[derive(Clone, Copy)]
struct PackedField {
    word: usize,
    shift: u32,
    mask: u64,
    lo: i64,
}

/// How discrete states are packed.
pub(crate) struct StateLayout {
    fields: Vec<PackedField>,
    pub words: usize,
}

impl StateLayout {
    /// Places each number in as few bits as its range needs, none across two words; what does not matter is left out.
    pub(crate) fn new(ranges: &[(i64, i64)], matters: &[bool]) -> Self {
        let (mut word, mut used, mut fields) = (0, 0, Vec::new());
        for (&(lo, hi), &matters) in ranges.iter().zip(matters) {
            let width = if matters { 64 - (hi.wrapping_sub(lo) as u64).leading_zeros() } else { 0 };
            if used + width > 64 {
                (word, used) = (word + 1, 0);
            }
            let mask = if width == 64 { u64::MAX } else { (1 << width) - 1 };
            // A number of one value only takes no bits; its shift must still be a legal one.
            fields.push(PackedField { word, shift: used.min(63), mask, lo });
            used += width;
        }
        Self { fields, words: word + 1 }
    }

    pub(crate) fn pack(&self, state: &[i64], out: &mut Vec<u64>) {
        out.clear();
        out.resize(self.words, 0);
        for (f, &n) in self.fields.iter().zip(state) {
            out[f.word] |= (n.wrapping_sub(f.lo) as u64 & f.mask) << f.shift;
        }
    }

    pub(crate) fn unpack(&self, packed: &[u64], out: &mut Vec<i64>) {
        out.clear();
        out.extend(
            self.fields.iter().map(|f| f.lo.wrapping_add(((packed[f.word] >> f.shift) & f.mask) as i64)),
        );
    }
}

pub(crate) fn hash_words(words: &[u64]) -> u64 {
    let mut h = FxHasher::default();
    words.iter().for_each(|w| h.write_u64(*w));
    h.finish()
}

pub(crate) fn hash_zone<N: DbmNumber>(zone: &[N]) -> u64 {
    let mut h = FxHasher::default();
    let mut chunks = zone.chunks_exact(4);
    for c in &mut chunks {
        let low = c[0].word() ^ (c[1].word() << 16);
        h.write_u64(low ^ (c[2].word() << 32) ^ (c[3].word() << 48));
    }
    chunks.remainder().iter().for_each(|n| h.write_u64(n.word()));
    h.finish()
}

/// A discrete state on its way to be looked up.
#[derive(Default)]
pub(crate) struct PackedState {
    pub words: Vec<u64>,
    pub hash: u64,
    /// Its number, if it is stored and was looked up.
    pub known: Option<u32>,
}

/// A symbolic state.
#[derive(Clone, Copy)]
pub(crate) struct SymbolicNode {
    pub parent: u32,
    /// Which of the transitions in the expansion of the parent led here.
    pub via: u32,
    pub discrete: u32,
    /// Where its zone starts.
    pub zone: u32,
    /// The next of the same discrete state.
    pub next: u32,
}

/// Nodes, a bit for each.
#[derive(Default)]
pub(crate) struct NodeSet {
    bits: Vec<u64>,
}

impl NodeSet {
    pub(crate) fn bytes(&self) -> usize {
        self.bits.len() * size_of::<u64>()
    }

    pub(crate) fn has(&self, node: u32) -> bool {
        self.bits.get(node as usize / 64).is_some_and(|word| word >> (node % 64) & 1 == 1)
    }

    /// Whether it was not there.
    pub(crate) fn add(&mut self, node: u32) -> bool {
        let (word, bit) = (node as usize / 64, 1 << (node % 64));
        if self.bits.len() <= word {
            self.bits.resize(word + 1, 0);
        }
        let new = self.bits[word] & bit == 0;
        self.bits[word] |= bit;
        new
    }
}

pub(crate) struct PassedList<N> {
    pub layout: StateLayout,
    discrete: DiscreteStates,
    /// By discrete state its newest node.
    heads: Vec<u32>,
    pub nodes: Vec<SymbolicNode>,
    /// Those that a greater one of the same discrete state drove out: only the path to them is kept.
    pub covered: NodeSet,
    zones: Vec<N>,
    /// Where zones begin, by their hashes.
    places: HashIndex,
    /// The ranks of the one-way counters of each node, so many of each.
    ranks: Vec<u32>,
    counters: usize,
    /// By how many transitions each node was come to, if that is kept.
    lengths: Option<Vec<u32>>,
    pub stored: usize,
}

impl<N: DbmNumber> PassedList<N> {
    /// The layout leaves out so many one-way counters, whose ranks stand with the nodes.
    pub(crate) fn new(layout: StateLayout, counters: usize, keep_lengths: bool) -> Self {
        Self {
            discrete: DiscreteStates::new(layout.words),
            layout,
            heads: Vec::new(),
            nodes: Vec::new(),
            covered: NodeSet::default(),
            zones: Vec::new(),
            places: HashIndex::default(),
            ranks: Vec::new(),
            counters,
            lengths: keep_lengths.then(Vec::new),
            stored: 0,
        }
    }

    pub(crate) fn discrete_states(&self) -> usize {
        self.heads.len()
    }

    /// The bytes in use.
    pub(crate) fn bytes(&self) -> usize {
        self.discrete.bytes()
            + self.heads.len() * 4
            + self.nodes.len() * size_of::<SymbolicNode>()
            + self.covered.bytes()
            + self.zones.len() * size_of::<N>()
            + self.places.bytes()
            + self.ranks.len() * 4
            + self.lengths.as_ref().map_or(0, Vec::len) * 4
    }

    /// Whether a state that comes from `parent` has taken more transitions than this one, as far as that is kept.
    pub(crate) fn is_longer_way(&self, parent: u32, than: u32) -> bool {
        self.lengths.as_ref().is_some_and(|l| parent != NIL && l[parent as usize] + 1 > l[than as usize])
    }

    /// The ranks of a node's one-way counters.
    pub(crate) fn ranks(&self, node: u32) -> &[u32] {
        &self.ranks[node as usize * self.counters..(node as usize + 1) * self.counters]
    }

    /// The least and greatest of each number of the discrete states; of numbers that the layout leaves out, their least possible.
    pub(crate) fn extremes(&self) -> Vec<(i64, i64)> {
        let mut all = vec![(i64::MAX, i64::MIN); self.layout.fields.len()];
        let mut state = Vec::new();
        for words in self.discrete.all() {
            self.layout.unpack(words, &mut state);
            for (seen, &n) in all.iter_mut().zip(&state) {
                *seen = (seen.0.min(n), seen.1.max(n));
            }
        }
        all
    }

    pub(crate) fn packed(&self, discrete: u32) -> &[u64] {
        self.discrete.packed(discrete)
    }

    pub(crate) fn zone(&self, node: &SymbolicNode, dim: usize) -> &[N] {
        self.zone_at(node.zone, dim * dim)
    }

    /// Has the processor fetch what is kept of these nodes, with so many entries of each zone, while it does other things.
    pub(crate) fn prefetch(&self, nodes: &[u32], entries: usize) {
        for &n in nodes {
            prefetch_index(&self.nodes, n as usize);
        }
        for &n in nodes {
            let node = &self.nodes[n as usize];
            self.discrete.prefetch(node.discrete);
            for at in (0..entries).step_by(LINE / size_of::<N>()) {
                prefetch_index(&self.zones, node.zone as usize + at);
            }
        }
    }

    /// The zone of so many entries that begins there.
    pub(crate) fn zone_at(&self, place: u32, size: usize) -> &[N] {
        &self.zones[place as usize..place as usize + size]
    }

    /// Where the zone of this hash is, if it is stored.
    pub(crate) fn find_zone(&self, zone: &[N], hash: u64) -> Option<u32> {
        // Where a longer one begins with this, it is there, too.
        self.places.find(half(hash), |at| self.zones[at as usize..].starts_with(zone))
    }

    pub(crate) fn find(&self, hash: u64, packed: &[u64]) -> Option<u32> {
        self.discrete.find(hash, packed)
    }

    /// Packs a discrete state that is [looked up](Self::look_up) soon, and has the processor fetch its place meanwhile.
    pub(crate) fn anticipate(&self, state: &[i64], out: &mut PackedState) {
        self.layout.pack(state, &mut out.words);
        out.hash = hash_words(&out.words);
        self.discrete.prefetch_place(out.hash);
    }

    /// Looks up a packed state, and has the processor fetch its newest node's number.
    pub(crate) fn look_up(&self, state: &mut PackedState) {
        state.known = self.find(state.hash, &state.words);
        if let Some(known) = state.known {
            prefetch_index(&self.heads, known as usize);
        }
    }

    /// As [`find`](Self::find), of what the round has added.
    pub(crate) fn find_recent(&self, hash: u64, packed: &[u64]) -> Option<u32> {
        self.discrete.find_recent(hash, packed)
    }

    /// A round is stored from now on.
    pub(crate) fn begin_round(&mut self) {
        self.discrete.begin_round();
    }

    /// The round is stored.
    pub(crate) fn end_round(&mut self, threads: &mut CrewThreads) {
        self.discrete.end_round(threads);
    }

    /// The newest node of a discrete state.
    pub(crate) fn head(&self, discrete: u32) -> u32 {
        self.heads[discrete as usize]
    }

    pub(crate) fn add_discrete(&mut self, hash: u64, packed: &[u64]) -> u32 {
        self.heads.push(NIL);
        self.discrete.add(hash, packed)
    }

    /// Where the zone of this hash is, which is added if it is not there.
    pub(crate) fn intern(&mut self, zone: &[N], hash: u64) -> u32 {
        if let Some(known) = self.find_zone(zone, hash) {
            return known;
        }
        let place = self.zones.len() as u32;
        self.zones.extend_from_slice(zone);
        self.places.insert(half(hash), place);
        place
    }

    /// Whether there is room for another zone of so many entries.
    pub(crate) fn has_room(&self, entries: usize) -> bool {
        self.zones.len() + entries < NIL as usize && self.nodes.len() + 1 < NIL as usize
    }

    /// A node with an interned zone.
    pub(crate) fn add(&mut self, parent: u32, via: u32, discrete: u32, zone: u32, ranks: &[u32]) -> u32 {
        self.ranks.extend_from_slice(ranks);
        if let Some(lengths) = &mut self.lengths {
            let before = (parent != NIL).then(|| lengths[parent as usize]);
            lengths.push(before.map_or(0, |n| n + 1));
        }
        let id = self.nodes.len() as u32;
        let next = std::mem::replace(&mut self.heads[discrete as usize], id);
        self.nodes.push(SymbolicNode { parent, via, discrete, zone, next });
        self.stored += 1;
        id
    }

    /// Takes those out of the chain that are marked.
    pub(crate) fn unlink(&mut self, discrete: u32) {
        let mut at = self.heads[discrete as usize];
        let mut last = NIL;
        while at != NIL {
            let node = self.nodes[at as usize];
            if self.covered.has(at) {
                if last == NIL {
                    self.heads[discrete as usize] = node.next;
                } else {
                    self.nodes[last as usize].next = node.next;
                }
            } else {
                last = at;
            }
            at = node.next;
        }
    }

    pub(crate) fn cover(&mut self, node: u32) {
        if self.covered.add(node) {
            self.stored -= 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn range() -> impl Strategy<Value = (i64, i64)> {
        prop_oneof![
            (-5i64..5, 0i64..300).prop_map(|(lo, n)| (lo, lo + n)),
            Just((0, 0)),
            Just((i64::MIN, i64::MAX)),
            (any::<i64>(), any::<i64>()).prop_map(|(a, b)| (a.min(b), a.max(b))),
        ]
    }

    /// A range, a number in it, and whether it matters.
    fn number() -> impl Strategy<Value = ((i64, i64), i64, bool)> {
        (range(), any::<u64>(), any::<bool>()).prop_map(|((lo, hi), n, matters)| {
            let size = (hi.wrapping_sub(lo) as u64).wrapping_add(1);
            let offset = if size == 0 { n } else { n % size };
            ((lo, hi), lo.wrapping_add(offset as i64), matters)
        })
    }

    proptest! {
        #[test]
        fn what_matters_comes_back(numbers in prop::collection::vec(number(), 1..20)) {
            let ranges: Vec<_> = numbers.iter().map(|n| n.0).collect();
            let state: Vec<_> = numbers.iter().map(|n| n.1).collect();
            let matters: Vec<_> = numbers.iter().map(|n| n.2).collect();
            let layout = StateLayout::new(&ranges, &matters);
            let (mut packed, mut back) = (Vec::new(), Vec::new());
            layout.pack(&state, &mut packed);
            prop_assert_eq!(packed.len(), layout.words);
            layout.unpack(&packed, &mut back);
            for (((lo, _), n, matters), b) in numbers.iter().zip(&back) {
                prop_assert_eq!(if *matters { *n } else { *lo }, *b);
            }
        }
    }

    #[test]
    fn a_chain_loses_what_is_covered() {
        let mut store = PassedList::<i16>::new(StateLayout::new(&[(0, 3)], &[true]), 0, false);
        let d = store.add_discrete(hash_words(&[2]), &[2]);
        let mut add = |k: i16| {
            let zone = store.intern(&[k], hash_zone(&[k]));
            store.add(NIL, 0, d, zone, &[])
        };
        let ids: Vec<u32> = (0..4).map(&mut add).collect();
        // The same zone is kept once.
        let again = add(2);
        store.cover(again);
        store.cover(ids[3]);
        store.cover(ids[1]);
        store.unlink(d);
        assert_eq!(store.stored, 2);
        assert_eq!(store.head(d), ids[2]);
        assert_eq!(store.nodes[ids[2] as usize].next, ids[0]);
        assert_eq!(store.nodes[ids[0] as usize].next, NIL);
        assert_eq!(store.nodes[again as usize].zone, store.nodes[ids[2] as usize].zone);
    }
}
