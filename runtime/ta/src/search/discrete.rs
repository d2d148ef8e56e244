//! The discrete states that a search has come to, each with a number, found by their hashes.
//!
//! An index of millions of states is slow to add to, since each place in it is far from the last one. So what a round adds is found in a
//! small index of its own until the round is stored; then several threads put it into the great one, which is in parts for that.

use prefetch_index::prefetch_index;

use crate::search::{
    hash_index::{HashIndex, SLOT, half, places_for},
    threads::CrewThreads,
};

/// Parts of the index.
const PARTS: usize = 16;
/// Fewer states are put into it before another thread is awake.
const FEW: usize = 256;

/// Packed discrete states.
pub(crate) struct DiscreteStates {
    /// How many words each has.
    width: usize,
    words: Vec<u64>,
    /// By part the numbers of its states.
    parts: Vec<HashIndex>,
    /// Whether a round is being stored.
    in_round: bool,
    /// Of each state that it has added, which is in no part yet, half of its hash.
    recent: Vec<u32>,
    recent_numbers: HashIndex,
    /// Of each part how many states belong to it, and the places that it has with them.
    sizes: [(usize, usize); PARTS],
    places: usize,
}

/// The part of a half: by the bits that say least of its place there.
fn part(half: u32) -> usize {
    half as usize % PARTS
}

impl DiscreteStates {
    /// Of so many words each.
    pub(crate) fn new(width: usize) -> Self {
        Self {
            width,
            words: Vec::new(),
            parts: (0..PARTS).map(|_| HashIndex::default()).collect(),
            in_round: false,
            recent: Vec::new(),
            recent_numbers: HashIndex::default(),
            sizes: [(0, 0); PARTS],
            places: 0,
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.words.len() / self.width
    }

    /// The bytes of the states and their index, as if what a round has added were in it: so they are the same without rounds.
    pub(crate) fn bytes(&self) -> usize {
        self.words.len() * size_of::<u64>() + self.places * SLOT
    }

    pub(crate) fn packed(&self, number: u32) -> &[u64] {
        &self.words[number as usize * self.width..(number as usize + 1) * self.width]
    }

    /// All, in the order of their numbers.
    pub(crate) fn all(&self) -> impl Iterator<Item = &[u64]> {
        self.words.chunks_exact(self.width)
    }

    /// Has the processor fetch a state while it does other things.
    pub(crate) fn prefetch(&self, number: u32) {
        prefetch_index(&self.words, number as usize * self.width);
    }

    /// Has the processor fetch where a state of this hash would be found.
    pub(crate) fn prefetch_place(&self, hash: u64) {
        let half = half(hash);
        self.parts[part(half)].prefetch(half);
    }

    /// The number of the state of this hash.
    pub(crate) fn find(&self, hash: u64, packed: &[u64]) -> Option<u32> {
        let half = half(hash);
        let known = self.parts[part(half)].find(half, |n| self.packed(n) == packed);
        if known.is_none() && !self.recent.is_empty() { self.find_recent(hash, packed) } else { known }
    }

    /// Its number if the round has added it.
    pub(crate) fn find_recent(&self, hash: u64, packed: &[u64]) -> Option<u32> {
        self.recent_numbers.find(half(hash), |n| self.packed(n) == packed)
    }

    /// Adds a state that is not there.
    pub(crate) fn add(&mut self, hash: u64, packed: &[u64]) -> u32 {
        // INVARIANT: budgets keep all numbers below `NIL`.
        let number = self.len() as u32;
        self.words.extend_from_slice(packed);
        let half = half(hash);
        let (numbers, places) = &mut self.sizes[part(half)];
        *numbers += 1;
        self.places -= *places;
        *places = places_for(*numbers, *places);
        self.places += *places;
        if self.in_round {
            self.recent.push(half);
            self.recent_numbers.insert(half, number);
        } else {
            self.parts[part(half)].insert(half, number);
        }
        number
    }

    /// What is added from now on is collected.
    pub(crate) fn begin_round(&mut self) {
        self.in_round = true;
    }

    /// Puts what was collected into the great index.
    pub(crate) fn end_round(&mut self, threads: &mut CrewThreads) {
        self.in_round = false;
        let recent = &self.recent;
        let first = (self.words.len() / self.width - recent.len()) as u32;
        let put = |(begin, parts): (usize, &mut [HashIndex])| {
            for (number, &half) in (first..).zip(recent) {
                let mine = part(half).checked_sub(begin).and_then(|at| parts.get_mut(at));
                if let Some(mine) = mine {
                    mine.insert(half, number);
                }
            }
        };
        if recent.len() < FEW {
            put((0, &mut self.parts));
        } else {
            let each = PARTS.div_ceil(threads.count());
            let pieces = self.parts.chunks_mut(each).enumerate();
            threads.each(pieces.map(|(i, parts)| (i * each, parts)), &put);
        }
        self.recent.clear();
        self.recent_numbers.clear();
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::search::store::hash_words;

    proptest! {
        /// Rounds of any length, or none, with any number of threads: all that was added is found, and counted alike.
        #[test]
        fn rounds_find_and_count_what_one_by_one_does(
            rounds in prop::collection::vec(prop::collection::btree_set(any::<[u64; 2]>(), 0..600), 0..4),
            threads in 1usize..4,
        ) {
            let mut threads = CrewThreads::new(threads);
            let (mut rounded, mut direct) = (DiscreteStates::new(2), DiscreteStates::new(2));
            let mut all: Vec<[u64; 2]> = Vec::new();
            for states in rounds {
                rounded.begin_round();
                for state in states {
                    let hash = hash_words(&state);
                    let known = all.iter().position(|s| *s == state).map(|n| n as u32);
                    prop_assert_eq!(rounded.find(hash, &state), known);
                    prop_assert_eq!(direct.find(hash, &state), known);
                    if known.is_none() {
                        prop_assert_eq!(rounded.add(hash, &state), all.len() as u32);
                        direct.add(hash, &state);
                        prop_assert_eq!(rounded.find_recent(hash, &state), Some(all.len() as u32));
                        all.push(state);
                        prop_assert_eq!(rounded.bytes(), direct.bytes());
                    }
                }
                rounded.end_round(&mut threads);
            }
            for (number, state) in (0..).zip(&all) {
                let hash = hash_words(state);
                prop_assert_eq!(rounded.find(hash, state), Some(number));
                prop_assert_eq!(rounded.find_recent(hash, state), None);
                prop_assert_eq!(direct.find(hash, state), Some(number));
            }
            let counted: usize = rounded.parts.iter().map(HashIndex::bytes).sum();
            prop_assert_eq!(counted, rounded.places * SLOT);
        }
    }
}
