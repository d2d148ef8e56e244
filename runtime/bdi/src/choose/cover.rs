//! Covering arrays of strength t, greedily in the manner of AETG (Cohen, Dalal, Fredman, Patton, *IEEE Transactions on
//! Software Engineering* 23(7), 1997): the best of several randomly ordered rows is taken until every tuple is covered.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::{
    sets::{AlternativeRow, row_at, shuffle},
    space::AllowedSpace,
};

/// Rows that compete for each place in the array.
pub(super) const CANDIDATES: usize = 30;

/// Tuples that are kept track of, at most: a bit each.
pub(super) const MAX_TUPLES: u128 = 100_000_000;

/// A factor and one of its alternatives.
pub(super) type FactorChoice = (usize, u32);

/// A covering array, and the strength that it has.
pub(super) struct CoveringArray {
    pub rows: Vec<AlternativeRow>,
    /// Less than what was asked for if there would be too many tuples.
    pub strength: usize,
}

/// Which factors: in increasing order, as many as the strength.
struct FactorGroup {
    factors: Vec<usize>,
    /// Where its tuples start among all.
    start: usize,
    /// How many of its tuples are open.
    left: usize,
}

/// The tuples of alternatives of `strength` different factors that no row has yet.
pub(super) struct UncoveredTuples<'s> {
    sizes: &'s [u32],
    strength: usize,
    /// In lexicographic order of the factors.
    groups: Vec<FactorGroup>,
    /// `choose[k][n]`: how many sets of k there are of n; with it a group's place is found.
    choose: Vec<Vec<usize>>,
    /// A bit for each tuple: group by group, in each in lexicographic order of the alternatives.
    open: Vec<u64>,
    /// Open tuples by factor and alternative.
    of: Vec<Vec<usize>>,
    pub(super) left: usize,
}

impl<'s> UncoveredTuples<'s> {
    pub(super) fn new(sizes: &'s [u32], strength: usize) -> Self {
        let mut groups = Vec::new();
        let mut of: Vec<Vec<usize>> = sizes.iter().map(|size| vec![0; *size as usize]).collect();
        let mut start = 0;
        let mut factors: Vec<usize> = (0..strength).collect();
        loop {
            let tuples: usize = factors.iter().map(|f| sizes[*f] as usize).product();
            for factor in &factors {
                let each = tuples / (sizes[*factor] as usize).max(1);
                of[*factor].iter_mut().for_each(|n| *n += each);
            }
            groups.push(FactorGroup { factors: factors.clone(), start, left: tuples });
            start += tuples;
            if !next_group(&mut factors, sizes.len()) {
                break;
            }
        }
        let open = vec![u64::MAX; start.div_ceil(64)];
        Self { sizes, strength, groups, choose: pascal(sizes.len(), strength), open, of, left: start }
    }

    /// The place among the groups of these factors, which are in increasing order.
    fn group(&self, factors: &[usize]) -> usize {
        // Counted from the end: the groups that come after it in lexicographic order.
        let n = self.sizes.len();
        let after: usize =
            factors.iter().enumerate().map(|(i, f)| self.choose[self.strength - i][n - 1 - f]).sum();
        self.groups.len() - 1 - after
    }

    /// The first tuple of a group with these alternatives, all of its factors' but `open`'s, and the distance between
    /// those that differ in `open` only.
    fn line(&self, group: &FactorGroup, row: &AlternativeRow, open: usize) -> (usize, usize) {
        let (mut at, mut stride, mut step) = (group.start, 1, 0);
        for factor in group.factors.iter().rev() {
            if *factor == open {
                step = stride;
            } else {
                at += row[*factor] as usize * stride;
            }
            stride *= self.sizes[*factor] as usize;
        }
        (at, step)
    }

    fn is_open(&self, tuple: usize) -> bool {
        self.open[tuple / 64] >> (tuple % 64) & 1 == 1
    }

    pub(super) fn cover(&mut self, row: &AlternativeRow) {
        for index in 0..self.groups.len() {
            let tuple = self.line(&self.groups[index], row, usize::MAX).0;
            self.close(index, tuple, row);
        }
    }

    /// A tuple, which a row has, is no longer looked for.
    fn close(&mut self, group: usize, tuple: usize, row: &AlternativeRow) {
        if self.is_open(tuple) {
            self.open[tuple / 64] &= !(1 << (tuple % 64));
            for factor in &self.groups[group].factors {
                self.of[*factor][row[*factor] as usize] -= 1;
            }
            self.groups[group].left -= 1;
            self.left -= 1;
        }
    }

    /// Closes the tuples that occur in no allowed row; gives how many these are.
    pub(super) fn exclude(&mut self, space: &mut AllowedSpace<'_>, rng: &mut ChaCha8Rng) -> u64 {
        let (mut closed, mut row) = (0, vec![0; self.sizes.len()]);
        for index in 0..self.groups.len() {
            let factors = self.groups[index].factors.clone();
            let mut groups: Vec<usize> = factors.iter().filter_map(|f| space.group_of[*f]).collect();
            groups.sort_unstable();
            groups.dedup();
            let parts: Vec<(Vec<usize>, Vec<bool>)> = groups
                .into_iter()
                .map(|g| {
                    let of: Vec<usize> =
                        factors.iter().copied().filter(|f| space.group_of[*f] == Some(g)).collect();
                    let seen = space.seen(g, &of, rng);
                    (of, seen)
                })
                .collect();
            if parts.iter().all(|(_, seen)| seen.iter().all(|s| *s)) {
                continue;
            }
            let count: usize = factors.iter().map(|f| self.sizes[*f] as usize).product();
            for tuple in 0..count {
                self.places(&factors, tuple).into_iter().for_each(|(f, a)| row[f] = a);
                let at =
                    |of: &[usize]| of.iter().fold(0, |at, f| at * self.sizes[*f] as usize + row[*f] as usize);
                if !parts.iter().all(|(of, seen)| seen[at(of)]) {
                    self.close(index, self.groups[index].start + tuple, &row);
                    closed += 1;
                }
            }
        }
        closed
    }

    /// The alternative with the most open tuples; the first of several.
    pub(super) fn neediest(&self) -> FactorChoice {
        let mut best = (0, 0, 0);
        for (factor, counts) in self.of.iter().enumerate() {
            for (alternative, open) in (0u32..).zip(counts) {
                if *open > best.0 {
                    best = (*open, factor, alternative);
                }
            }
        }
        (best.1, best.2)
    }

    /// What candidates begin with: the neediest alternative; if tuples are of more than two, the first open tuple that it
    /// is in, so that every candidate covers one.
    fn seed(&self) -> Vec<FactorChoice> {
        let (factor, alternative) = self.neediest();
        if self.strength == 2 {
            return vec![(factor, alternative)];
        }
        self.open_tuple((factor, alternative))
    }

    /// The first open tuple that has this alternative.
    pub(super) fn open_tuple(&self, (factor, alternative): FactorChoice) -> Vec<FactorChoice> {
        let with = |g: &&FactorGroup| g.left > 0 && g.factors.contains(&factor);
        for group in self.groups.iter().filter(with) {
            let tuples: usize = group.factors.iter().map(|f| self.sizes[*f] as usize).product();
            for tuple in (0..tuples).filter(|t| self.is_open(group.start + t)) {
                let places = self.places(&group.factors, tuple);
                if places.contains(&(factor, alternative)) {
                    return places;
                }
            }
        }
        vec![(factor, alternative)]
    }

    /// The alternatives of the tuple of this number of these factors.
    fn places(&self, factors: &[usize], mut tuple: usize) -> Vec<FactorChoice> {
        let mut places = Vec::with_capacity(self.strength);
        for factor in factors.iter().rev() {
            let size = self.sizes[*factor] as usize;
            places.push((*factor, (tuple % size) as u32));
            tuple /= size;
        }
        places.reverse();
        places
    }

    /// For each alternative of a factor: how many open tuples it makes with alternatives of the factors that are placed,
    /// which are in increasing order.
    pub(super) fn gains(&self, factor: usize, placed: &[usize], row: &AlternativeRow) -> Vec<usize> {
        let mut gains = vec![0; self.sizes[factor] as usize];
        let others = self.strength - 1;
        if placed.len() < others {
            return gains;
        }
        if others == 1 {
            placed.iter().for_each(|other| self.pair_gains(factor, *other, row[*other], &mut gains));
            return gains;
        }
        let mut chosen: Vec<usize> = (0..others).collect();
        let mut factors = vec![factor; self.strength];
        loop {
            let before = chosen.iter().take_while(|i| placed[**i] < factor).count();
            for (at, i) in chosen.iter().enumerate() {
                factors[at + usize::from(at >= before)] = placed[*i];
            }
            factors[before] = factor;
            let group = &self.groups[self.group(&factors)];
            if group.left > 0 {
                let (at, step) = self.line(group, row, factor);
                for (alternative, gain) in gains.iter_mut().enumerate() {
                    *gain += usize::from(self.is_open(at + alternative * step));
                }
            }
            if !next_group(&mut chosen, placed.len()) {
                return gains;
            }
        }
    }

    /// The part of `gains` that a single other alternative makes, if tuples are pairs: most suites are.
    fn pair_gains(&self, factor: usize, other: usize, taken: u32, gains: &mut [usize]) {
        let (n, low, high) = (self.sizes.len(), factor.min(other), factor.max(other));
        let group = &self.groups[low * n - low * (low + 1) / 2 + high - low - 1];
        if group.left == 0 {
            return;
        }
        let (at, step) = if factor == high {
            (group.start + taken as usize * gains.len(), 1)
        } else {
            (group.start + taken as usize, self.sizes[other] as usize)
        };
        for (alternative, gain) in gains.iter_mut().enumerate() {
            *gain += usize::from(self.is_open(at + alternative * step));
        }
    }
}

/// The next set of numbers below `n` in lexicographic order; false after the last.
pub(super) fn next_group(numbers: &mut [usize], n: usize) -> bool {
    let many = numbers.len();
    let Some(at) = (0..many).rev().find(|i| numbers[*i] < n - (many - i)) else { return false };
    numbers[at] += 1;
    for i in at + 1..many {
        numbers[i] = numbers[i - 1] + 1;
    }
    true
}

/// `[k][n]`: n over k.
fn pascal(n: usize, k: usize) -> Vec<Vec<usize>> {
    let mut rows = vec![vec![1; n + 1]];
    for k in 1..=k {
        let mut row = vec![0; n + 1];
        for n in 1..=n {
            row[n] = row[n - 1] + rows[k - 1][n - 1];
        }
        rows.push(row);
    }
    rows
}

/// How many tuples of alternatives of `strength` different factors there are.
pub(super) fn tuples(sizes: &[u32], strength: usize) -> u128 {
    let mut of = vec![0u128; strength + 1];
    of[0] = 1;
    for size in sizes {
        for k in (1..=strength).rev() {
            of[k] = of[k].saturating_add(of[k - 1].saturating_mul(u128::from(*size)));
        }
    }
    of[strength]
}

/// Rows in which every tuple of alternatives of `strength` different factors (at least 2) occurs, at most `limit`. If
/// there are too many tuples the strength is lowered, to 2 at the least. With no more factors than that, but for pairs of
/// two, these are all rows there can be, in lexicographic order: with a single factor every alternative occurs; without
/// factors there is one empty row.
pub(super) fn covering(sizes: &[u32], strength: usize, limit: usize, rng: &mut ChaCha8Rng) -> CoveringArray {
    let mut strength = strength.max(2);
    if sizes.len() < 2 || (strength > 2 && strength >= sizes.len()) {
        let space = sizes.iter().fold(1u128, |n, size| n.saturating_mul(u128::from(*size)));
        let rows = (0..space.min(limit as u128)).map(|index| row_at(sizes, index)).collect();
        return CoveringArray { rows, strength };
    }
    while strength > 2 && tuples(sizes, strength) > MAX_TUPLES {
        strength -= 1;
    }
    let mut uncovered = UncoveredTuples::new(sizes, strength);
    let mut rows = Vec::new();
    while uncovered.left > 0 && rows.len() < limit {
        let mut best: Option<(usize, AlternativeRow)> = None;
        let start = uncovered.seed();
        for _ in 0..CANDIDATES {
            let (gain, row) = candidate(&uncovered, &start, rng);
            if best.as_ref().is_none_or(|(most, _)| gain > *most) {
                best = Some((gain, row));
            }
        }
        // INVARIANT: each candidate covers an open tuple of the neediest alternative, so this ends.
        let Some((_, row)) = best else { break };
        uncovered.cover(&row);
        rows.push(row);
    }
    CoveringArray { rows, strength }
}

/// A row that starts from alternatives of some factors and goes through the other factors in a random order, each time
/// taking what covers most with the row so far; and how many open tuples these steps covered.
fn candidate(
    uncovered: &UncoveredTuples,
    start: &[FactorChoice],
    rng: &mut ChaCha8Rng,
) -> (usize, AlternativeRow) {
    let mut row: AlternativeRow = vec![0; uncovered.sizes.len()];
    let mut placed: Vec<usize> = start.iter().map(|(factor, _)| *factor).collect();
    for (factor, alternative) in start {
        row[*factor] = *alternative;
    }
    let mut order: Vec<usize> = (0..row.len()).filter(|f| !placed.contains(f)).collect();
    shuffle(&mut order, rng);
    let mut gain = 0;
    for factor in order {
        let gains = uncovered.gains(factor, &placed, &row);
        let most = gains.iter().copied().max().unwrap_or(0);
        let ties: Vec<u32> = (0u32..).zip(&gains).filter(|(_, g)| **g == most).map(|(a, _)| a).collect();
        row[factor] = ties[rng.random_range(0..ties.len() as u32) as usize];
        placed.insert(placed.partition_point(|f| *f < factor), factor);
        gain += most;
    }
    (gain, row)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use proptest::prelude::*;
    use rand::SeedableRng;

    use super::*;

    fn rows(sizes: &[u32], strength: usize, seed: u64) -> Vec<AlternativeRow> {
        covering(sizes, strength, usize::MAX, &mut ChaCha8Rng::seed_from_u64(seed)).rows
    }

    /// All tuples that rows cover, and the number there is, counted without the machinery above.
    fn counted(sizes: &[u32], rows: &[AlternativeRow], strength: usize) -> (usize, usize) {
        let (mut seen, mut all) = (0, 0);
        for mask in (0u32..1 << sizes.len()).filter(|m| m.count_ones() as usize == strength) {
            let factors: Vec<usize> = (0..sizes.len()).filter(|f| mask >> f & 1 == 1).collect();
            all += factors.iter().map(|f| sizes[*f] as usize).product::<usize>();
            let here: BTreeSet<Vec<u32>> =
                rows.iter().map(|r| factors.iter().map(|f| r[*f]).collect()).collect();
            seen += here.len();
        }
        (seen, all)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn every_pair_occurs(sizes in prop::collection::vec(1u32..7, 0..8), seed: u64) {
            let found = rows(&sizes, 2, seed);
            let (seen, all) = counted(&sizes, &found, 2);
            prop_assert_eq!(seen, all);
            for row in &found {
                prop_assert_eq!(row.len(), sizes.len());
                prop_assert!(row.iter().zip(&sizes).all(|(a, n)| a < n));
            }
            let distinct: BTreeSet<&AlternativeRow> = found.iter().collect();
            prop_assert_eq!(distinct.len(), found.len(), "a row covers something that no other does");
            // No array is smaller than the product of the two largest factors; a greedy one is not far above.
            let mut sorted = sizes.clone();
            sorted.sort_unstable_by(|a, b| b.cmp(a));
            if let [a, b, ..] = sorted[..] {
                prop_assert!(found.len() >= (a * b) as usize);
                prop_assert!(found.len() <= (a * b) as usize * 2 + 6, "{} rows for {:?}", found.len(), sizes);
            }
            prop_assert_eq!(&found, &rows(&sizes, 2, seed));
        }

        #[test]
        fn every_tuple_occurs(sizes in prop::collection::vec(1u32..4, 0..8), strength in 3usize..=6, seed: u64) {
            let found = rows(&sizes, strength, seed);
            let least = strength.min(sizes.len());
            let (seen, all) = counted(&sizes, &found, least);
            prop_assert_eq!(seen, all);
            let distinct: BTreeSet<&AlternativeRow> = found.iter().collect();
            prop_assert_eq!(distinct.len(), found.len());
            let mut sorted = sizes.clone();
            sorted.sort_unstable_by(|a, b| b.cmp(a));
            let bound: usize = sorted.iter().take(least).map(|n| *n as usize).product();
            prop_assert!(found.len() >= bound);
            prop_assert!(found.len() <= bound * 3 + 12, "{} rows for {:?}", found.len(), sizes);
            prop_assert_eq!(&found, &rows(&sizes, strength, seed));
        }

        #[test]
        fn groups_are_found_at_their_place(n in 2usize..9, strength in 2usize..=6) {
            prop_assume!(strength <= n);
            let sizes = vec![2; n];
            let uncovered = UncoveredTuples::new(&sizes, strength);
            for (index, group) in uncovered.groups.iter().enumerate() {
                prop_assert_eq!(uncovered.group(&group.factors), index);
            }
            prop_assert_eq!(uncovered.left as u128, tuples(&sizes, strength));
        }
    }

    #[test]
    fn many_small_factors_need_few_rows() {
        // The literature's yardstick: 13 factors of 3 values need 15 rows at best, and AETG finds about 17 to 19.
        let found = rows(&[3; 13], 2, 1);
        assert!(found.len() <= 21, "{}", found.len());
        // 6 factors of 3 values, triples: 33 at best, AETG about 47 (Cohen and others 1997).
        let found = rows(&[3; 6], 3, 1);
        assert!(found.len() <= 52, "{}", found.len());
        // 4 legs with three readings each, four moods and how many are wanted: 512 at best.
        let found = rows(&[5, 8, 8, 8, 8, 2, 2, 2, 2], 3, 1);
        assert!(found.len() <= 900, "{}", found.len());
    }

    #[test]
    fn a_single_factor_gives_each_alternative_once() {
        let mut rng = ChaCha8Rng::seed_from_u64(0);
        for strength in [2, 3, 6] {
            assert_eq!(covering(&[3], strength, 9, &mut rng).rows, [[0], [1], [2]]);
            assert_eq!(covering(&[], strength, 9, &mut rng).rows, [AlternativeRow::new()]);
        }
        assert_eq!(covering(&[4, 4], 2, 3, &mut rng).rows.len(), 3);
    }

    #[test]
    fn what_has_too_many_tuples_is_covered_less_strongly() {
        assert_eq!(tuples(&[2, 3, 4], 2), 6 + 8 + 12);
        assert_eq!(tuples(&[2, 3, 4], 3), 24);
        let mut rng = ChaCha8Rng::seed_from_u64(0);
        let found = covering(&[1000, 1000, 1000, 2], 3, 5, &mut rng);
        assert_eq!((found.strength, found.rows.len()), (2, 5));
    }
}
