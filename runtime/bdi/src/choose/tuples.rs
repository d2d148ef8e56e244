//! The tuples of alternatives that sets of beliefs have, and how many are lost with some of the sets.

use super::{
    cover::{MAX_TUPLES, UncoveredTuples, tuples},
    sets::AlternativeRow,
};

/// The tuples of sets that were chosen so that all tuples occur.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SetTuples {
    /// Of how many alternatives a tuple is.
    pub strength: usize,
    /// As many sets would do for all tuples, as far as was found; there may be more sets.
    pub needed: usize,
    sizes: Vec<u32>,
    rows: Vec<AlternativeRow>,
}

impl SetTuples {
    /// `None` if there are no dimensions, or too many tuples to count.
    pub(super) fn new(
        sizes: &[u32],
        strength: usize,
        rows: &[AlternativeRow],
        needed: usize,
    ) -> Option<Self> {
        let strength = strength.min(sizes.len());
        let counted = strength > 0 && tuples(sizes, strength) <= MAX_TUPLES;
        counted.then(|| Self { strength, needed, sizes: sizes.to_vec(), rows: rows.to_vec() })
    }

    /// How many different tuples all sets have, and how many of these no set has with one of these numbers, from 1.
    #[must_use]
    pub fn lost(&self, kept: impl IntoIterator<Item = u64>) -> (usize, usize) {
        let mut open = UncoveredTuples::new(&self.sizes, self.strength);
        let whole = open.left;
        let place = |number: u64| usize::try_from(number).ok()?.checked_sub(1);
        kept.into_iter().filter_map(place).filter_map(|at| self.rows.get(at)).for_each(|row| open.cover(row));
        let kept = whole - open.left;
        self.rows.iter().for_each(|row| open.cover(row));
        let all = whole - open.left;
        (all, all - kept)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_only_other_sets_have_is_lost() {
        let rows = [vec![0, 0, 0], vec![0, 1, 1], vec![1, 0, 1], vec![1, 1, 0]];
        let tuples = SetTuples::new(&[2, 2, 2], 2, &rows, 4).unwrap();
        assert_eq!(tuples.lost([1, 2, 3, 4]), (12, 0));
        assert_eq!(tuples.lost([4, 2, 1]), (12, 3));
        assert_eq!(tuples.lost([]), (12, 12));
        // A number that there is not, and pairs that no set has.
        let tuples = SetTuples::new(&[2, 2, 2], 2, &rows[..2], 2).unwrap();
        assert_eq!(tuples.lost([0, 2, 3]), (6, 3));
        // A single dimension has its alternatives.
        assert_eq!(SetTuples::new(&[3], 2, &[vec![0], vec![1], vec![2]], 3).unwrap().lost([1]), (3, 2));
        assert_eq!(SetTuples::new(&[], 2, &[vec![]], 1), None);
    }
}
