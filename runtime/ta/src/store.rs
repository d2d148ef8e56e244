//! What a search keeps: discrete states packed by known ranges, zones each once, and for each discrete state the zones that
//! no other covers.

use std::hash::Hasher;

use hashbrown::HashTable;
use rustc_hash::FxHasher;

use crate::{dbm::Number, network::Model};

/// No node, no state, no zone.
pub(crate) const NIL: u32 = u32::MAX;

/// Where a number of the discrete vector lies in the packed form.
#[derive(Clone, Copy)]
struct Field {
    word: usize,
    shift: u32,
    mask: u64,
    lo: i64,
}

/// How discrete states are packed.
pub(crate) struct Layout {
    fields: Vec<Field>,
    pub words: usize,
}

impl Layout {
    /// Places each number in as few bits as its range needs, none across two words; what does not matter is left out.
    pub(crate) fn new(model: &Model, matters: &[bool]) -> Self {
        let (mut word, mut used, mut fields) = (0, 0, Vec::new());
        for (&(lo, hi), &matters) in model.ranges().iter().zip(matters) {
            let width = if matters { 64 - (hi.wrapping_sub(lo) as u64).leading_zeros() } else { 0 };
            if used + width > 64 {
                (word, used) = (word + 1, 0);
            }
            let mask = if width == 64 { u64::MAX } else { (1 << width) - 1 };
            // A number of one value only takes no bits; its shift must still be a legal one.
            fields.push(Field { word, shift: used.min(63), mask, lo });
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

pub(crate) fn hash_zone<N: Number>(zone: &[N]) -> u64 {
    let mut h = FxHasher::default();
    let mut chunks = zone.chunks_exact(4);
    for c in &mut chunks {
        let low = c[0].word() ^ (c[1].word() << 16);
        h.write_u64(low ^ (c[2].word() << 32) ^ (c[3].word() << 48));
    }
    chunks.remainder().iter().for_each(|n| h.write_u64(n.word()));
    h.finish()
}

/// A symbolic state.
#[derive(Clone, Copy)]
pub(crate) struct Node {
    pub parent: u32,
    /// Which of the transitions in the expansion of the parent led here.
    pub via: u32,
    pub discrete: u32,
    /// Where its zone starts.
    pub zone: u32,
    /// The next of the same discrete state.
    pub next: u32,
    /// A greater one of the same discrete state drove it out: only the way to it is kept.
    pub covered: bool,
}

pub(crate) struct Store<N> {
    pub layout: Layout,
    words: Vec<u64>,
    heads: Vec<u32>,
    numbers: HashTable<u32>,
    pub nodes: Vec<Node>,
    zones: Vec<N>,
    places: HashTable<(u32, u32)>,
    pub stored: usize,
}

impl<N: Number> Store<N> {
    pub(crate) fn new(layout: Layout) -> Self {
        Self {
            layout,
            words: Vec::new(),
            heads: Vec::new(),
            numbers: HashTable::new(),
            nodes: Vec::new(),
            zones: Vec::new(),
            places: HashTable::new(),
            stored: 0,
        }
    }

    pub(crate) fn discrete_states(&self) -> usize {
        self.heads.len()
    }

    /// The bytes in use.
    pub(crate) fn bytes(&self) -> usize {
        self.words.len() * 8
            + self.heads.len() * 4
            + self.numbers.capacity() * 5
            + self.nodes.len() * size_of::<Node>()
            + self.zones.len() * size_of::<N>()
            + self.places.capacity() * 9
    }

    pub(crate) fn packed(&self, discrete: u32) -> &[u64] {
        let w = self.layout.words;
        &self.words[discrete as usize * w..(discrete as usize + 1) * w]
    }

    pub(crate) fn zone(&self, node: &Node, dim: usize) -> &[N] {
        &self.zones[node.zone as usize..node.zone as usize + dim * dim]
    }

    pub(crate) fn find(&self, hash: u64, packed: &[u64]) -> Option<u32> {
        self.numbers.find(hash, |&n| self.packed(n) == packed).copied()
    }

    /// The newest node of a discrete state.
    pub(crate) fn head(&self, discrete: u32) -> u32 {
        self.heads[discrete as usize]
    }

    pub(crate) fn add_discrete(&mut self, hash: u64, packed: &[u64]) -> u32 {
        // INVARIANT: budgets keep all numbers below `NIL`.
        let n = self.heads.len() as u32;
        self.words.extend_from_slice(packed);
        self.heads.push(NIL);
        let (w, words) = (self.layout.words, &self.words);
        self.numbers.insert_unique(hash, n, |&n| hash_words(&words[n as usize * w..(n as usize + 1) * w]));
        n
    }

    /// Where the zone is, which is added if it is not there.
    fn intern(&mut self, zone: &[N]) -> u32 {
        let hash = hash_zone(zone);
        let (zones, len) = (&self.zones, zone.len() as u32);
        let at = |at: u32, len: u32| &zones[at as usize..(at + len) as usize];
        if let Some(&(known, _)) = self.places.find(hash, |&(a, l)| l == len && at(a, l) == zone) {
            return known;
        }
        let place = self.zones.len() as u32;
        self.zones.extend_from_slice(zone);
        let zones = &self.zones;
        self.places
            .insert_unique(hash, (place, len), |&(a, l)| hash_zone(&zones[a as usize..(a + l) as usize]));
        place
    }

    /// Whether there is room for another zone of so many entries.
    pub(crate) fn has_room(&self, entries: usize) -> bool {
        self.zones.len() + entries < NIL as usize && self.nodes.len() + 1 < NIL as usize
    }

    pub(crate) fn add(&mut self, parent: u32, via: u32, discrete: u32, zone: &[N]) -> u32 {
        let zone = self.intern(zone);
        let id = self.nodes.len() as u32;
        let next = std::mem::replace(&mut self.heads[discrete as usize], id);
        self.nodes.push(Node { parent, via, discrete, zone, next, covered: false });
        self.stored += 1;
        id
    }

    /// Takes those out of the chain that are marked.
    pub(crate) fn unlink(&mut self, discrete: u32) {
        let mut at = self.heads[discrete as usize];
        let mut last = NIL;
        while at != NIL {
            let node = self.nodes[at as usize];
            if node.covered {
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
        let node = &mut self.nodes[node as usize];
        if !node.covered {
            node.covered = true;
            self.stored -= 1;
        }
    }
}
