//! A table that finds numbers by the hashes of what they stand for.
//!
//! Open addressing with linear probing over one array: a place holds half of the hash beside the number, so that the array
//! grows without a look at what the numbers stand for, nearly from end to end in order, and a place can be fetched ahead of its use.

use prefetch_index::prefetch_index;

/// No number: nothing is in the place.
const EMPTY: u64 = u64::MAX;
const LEAST: usize = 16;
/// The bytes of a place.
pub(crate) const SLOT: usize = size_of::<u64>();

/// Numbers below `u32::MAX`, by hashes.
#[derive(Default)]
pub(crate) struct HashIndex {
    /// Half of the hash, then the number.
    slots: Vec<u64>,
    len: usize,
}

/// Half of a hash: the good bits of what multiplication leaves of it.
pub(crate) fn half(hash: u64) -> u32 {
    (hash.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 32) as u32
}

/// How many places an index of so many numbers has that had so many before the last one: at most four fifths are full.
pub(crate) fn places_for(numbers: usize, before: usize) -> usize {
    if numbers * 5 > before * 4 { (before / 2 * 3).max(LEAST) } else { before }
}

impl HashIndex {
    pub(crate) fn bytes(&self) -> usize {
        self.slots.len() * SLOT
    }

    pub(crate) fn clear(&mut self) {
        if self.len > 0 {
            self.slots.fill(EMPTY);
            self.len = 0;
        }
    }

    /// Where a half belongs. Greater ones are behind smaller ones, so that growing goes through both arrays from end to end.
    fn home(&self, half: u32) -> usize {
        ((u64::from(half) * self.slots.len() as u64) >> 32) as usize
    }

    fn next(&self, at: usize) -> usize {
        if at + 1 == self.slots.len() { 0 } else { at + 1 }
    }

    /// Has the processor fetch the place of this half while it does other things.
    pub(crate) fn prefetch(&self, half: u32) {
        prefetch_index(&self.slots, self.home(half));
    }

    /// The number with this half that `is` the one.
    pub(crate) fn find(&self, half: u32, is: impl Fn(u32) -> bool) -> Option<u32> {
        let mut at = self.home(half);
        loop {
            let slot = *self.slots.get(at)?;
            if slot == EMPTY {
                return None;
            }
            if (slot >> 32) as u32 == half && is(slot as u32) {
                return Some(slot as u32);
            }
            at = self.next(at);
        }
    }

    /// Adds a number that is not there.
    pub(crate) fn insert(&mut self, half: u32, number: u32) {
        let more = places_for(self.len + 1, self.slots.len());
        if more > self.slots.len() {
            let old = std::mem::replace(&mut self.slots, vec![EMPTY; more]);
            old.into_iter().filter(|slot| *slot != EMPTY).for_each(|slot| self.put(slot));
        }
        self.put(u64::from(half) << 32 | u64::from(number));
        self.len += 1;
    }

    fn put(&mut self, slot: u64) {
        let mut at = self.home((slot >> 32) as u32);
        while self.slots[at] != EMPTY {
            at = self.next(at);
        }
        self.slots[at] = slot;
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Halves that collide, at both ends of the array, among others.
        #[test]
        fn what_was_added_is_found(
            halves in prop::collection::vec(prop_oneof![0u32..3, u32::MAX - 3..=u32::MAX, any::<u32>()], 0..300),
            absent in prop::collection::vec(any::<u32>(), 0..20),
        ) {
            let mut index = HashIndex::default();
            let mut known = BTreeMap::<u32, Vec<u32>>::new();
            for (number, &half) in (0..).zip(&halves) {
                prop_assert_eq!(index.find(half, |n| n == number), None);
                index.insert(half, number);
                known.entry(half).or_default().push(number);
            }
            for (half, numbers) in &known {
                for &number in numbers {
                    prop_assert_eq!(index.find(*half, |n| n == number), Some(number));
                }
            }
            for half in absent {
                let first = known.get(&half).map(|numbers| numbers[0]);
                prop_assert_eq!(index.find(half, |_| true), first);
            }
            index.clear();
            prop_assert!(halves.iter().all(|half| index.find(*half, |_| true).is_none()));
        }
    }
}
