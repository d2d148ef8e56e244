//! Fewer rows than the greedy ones: constructions where they fit, then a row is left out as long as a search can cover its
//! tuples with the others. The search is tabu search (Lin, Luo, Cai, Su, Hao and Zhang, *IEEE/ACM International Conference on
//! Automated Software Engineering*, 2015), without its random walks.

use std::collections::BTreeSet;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::{
    construct::constructions,
    cover::{FactorChoice, next_group, tuples},
    sets::AlternativeRow,
};

/// Tuples that are looked at, at most: tens of milliseconds.
const WORK: usize = 4_000_000;

/// So many moves after it was changed, an alternative stays.
const TABU: usize = 4;

/// Rows that have all the tuples too, no more than those given, which have them; they are looked for until there are `wanted`.
/// If no fewer are found, these are the rows given.
pub(super) fn fewer(
    sizes: &[u32],
    strength: usize,
    rows: Vec<AlternativeRow>,
    wanted: usize,
    rng: &mut ChaCha8Rng,
) -> Vec<AlternativeRow> {
    let least = wanted.max(fewest(sizes, strength));
    if rows.len() <= least {
        return rows;
    }
    let mut best = rows;
    for made in constructions(sizes, strength, best.len()) {
        let made = different(made);
        if made.len() < best.len() {
            best = made;
        }
    }
    if best.len() <= least || tuples(sizes, strength) > WORK as u128 {
        return best;
    }
    RowSearch::new(sizes, strength, best).reduce(least, &mut EveryRow, rng)
}

/// The same of rows that have all tuples that some row has which the rules allow; so have the rows that are found, and the
/// rules allow these.
pub(super) fn fewer_allowed(
    sizes: &[u32],
    strength: usize,
    rows: Vec<AlternativeRow>,
    wanted: usize,
    rules: &mut dyn RowRules,
    rng: &mut ChaCha8Rng,
) -> Vec<AlternativeRow> {
    if rows.len() <= wanted || strength > sizes.len() || tuples(sizes, strength) > WORK as u128 {
        return rows;
    }
    let mut search = RowSearch::new(sizes, strength, rows);
    // What no row has cannot be had.
    search.counts.open.clear();
    let least = wanted.max(search.counts.fewest());
    search.reduce(least, rules, rng)
}

/// Which rows there may be.
pub(super) trait RowRules {
    /// Whether an allowed row may have this alternative instead of the one that it has.
    fn permits(&mut self, row: &AlternativeRow, place: FactorChoice) -> bool;

    /// What has to be changed, so that an allowed row has the tuple and is allowed; nothing if no way is known. The second
    /// number says what was looked at.
    fn changes(
        &mut self,
        row: &AlternativeRow,
        tuple: &[FactorChoice],
        rng: &mut ChaCha8Rng,
    ) -> (Vec<FactorChoice>, usize);
}

/// Without conditions.
struct EveryRow;

impl RowRules for EveryRow {
    fn permits(&mut self, _: &AlternativeRow, _: FactorChoice) -> bool {
        true
    }

    fn changes(
        &mut self,
        _: &AlternativeRow,
        tuple: &[FactorChoice],
        _: &mut ChaCha8Rng,
    ) -> (Vec<FactorChoice>, usize) {
        (tuple.to_vec(), 0)
    }
}

/// No fewer rows have all tuples: those of the largest factors.
fn fewest(sizes: &[u32], strength: usize) -> usize {
    let mut sizes = sizes.to_vec();
    sizes.sort_unstable_by_key(|size| std::cmp::Reverse(*size));
    sizes.iter().take(strength).fold(1, |n: usize, size| n.saturating_mul(*size as usize))
}

/// The first of equal rows.
fn different(mut rows: Vec<AlternativeRow>) -> Vec<AlternativeRow> {
    let mut seen = BTreeSet::new();
    rows.retain(|row| seen.insert(row.clone()));
    rows
}

/// Which factors, in increasing order, and how far apart the tuples are that differ in one of them.
struct FactorTuples {
    factors: Vec<usize>,
    strides: Vec<usize>,
    /// The number of its first tuple.
    start: usize,
}

/// How often each tuple occurs in rows.
struct TupleCounts {
    /// In lexicographic order.
    groups: Vec<FactorTuples>,
    /// By factor: the groups that have it, and its place in each.
    of: Vec<Vec<(usize, usize)>>,
    /// By number: group by group, in each in lexicographic order of the alternatives.
    counts: Vec<u32>,
    /// Those that do not occur.
    open: BTreeSet<usize>,
}

impl TupleCounts {
    fn new(sizes: &[u32], strength: usize) -> Self {
        let (mut groups, mut of, mut start) = (Vec::new(), vec![Vec::new(); sizes.len()], 0);
        let mut factors: Vec<usize> = (0..strength).collect();
        loop {
            let mut strides = vec![1; strength];
            for place in (1..strength).rev() {
                strides[place - 1] = strides[place] * sizes[factors[place]] as usize;
            }
            factors.iter().enumerate().for_each(|(place, f)| of[*f].push((groups.len(), place)));
            let count = strides[0] * sizes[factors[0]] as usize;
            groups.push(FactorTuples { factors: factors.clone(), strides, start });
            start += count;
            if !next_group(&mut factors, sizes.len()) {
                break;
            }
        }
        Self { groups, of, counts: vec![0; start], open: (0..start).collect() }
    }

    fn tuple(&self, group: usize, row: &AlternativeRow) -> usize {
        let FactorTuples { factors, strides, start } = &self.groups[group];
        factors.iter().zip(strides).fold(*start, |at, (f, stride)| at + row[*f] as usize * stride)
    }

    fn put(&mut self, tuple: usize) {
        self.counts[tuple] += 1;
        if self.counts[tuple] == 1 {
            self.open.remove(&tuple);
        }
    }

    fn take(&mut self, tuple: usize) {
        self.counts[tuple] -= 1;
        if self.counts[tuple] == 0 {
            self.open.insert(tuple);
        }
    }

    /// How many tuples a row alone has.
    fn alone(&self, row: &AlternativeRow) -> usize {
        (0..self.groups.len()).filter(|group| self.counts[self.tuple(*group, row)] == 1).count()
    }

    /// No fewer rows have the tuples that occur: as many as those of some factors.
    fn fewest(&self) -> usize {
        let ends = self.groups.iter().skip(1).map(|g| g.start).chain([self.counts.len()]);
        let occur = |(group, end): (&FactorTuples, usize)| {
            self.counts[group.start..end].iter().filter(|n| **n > 0).count()
        };
        self.groups.iter().zip(ends).map(occur).max().unwrap_or(0)
    }

    /// The tuples that a row has with a factor, and those that it would have with another alternative of it.
    fn changes(
        &self,
        row: &AlternativeRow,
        factor: usize,
        alternative: u32,
    ) -> impl Iterator<Item = (usize, usize)> {
        self.of[factor].iter().map(move |(group, place)| {
            let (before, stride) = (self.tuple(*group, row), self.groups[*group].strides[*place]);
            (before, before - row[factor] as usize * stride + alternative as usize * stride)
        })
    }

    /// The factors and alternatives of a tuple.
    fn places(&self, tuple: usize) -> Vec<(usize, u32)> {
        let group = &self.groups[self.groups.partition_point(|g| g.start <= tuple) - 1];
        let mut rest = tuple - group.start;
        let mut place = |(factor, stride): (&usize, &usize)| {
            let alternative = rest / stride;
            rest %= stride;
            (*factor, alternative as u32)
        };
        group.factors.iter().zip(&group.strides).map(&mut place).collect()
    }
}

/// Rows that are changed until they have all tuples.
struct RowSearch {
    rows: Vec<AlternativeRow>,
    counts: TupleCounts,
    /// By row and factor: the move from which on it may be changed.
    free_from: Vec<Vec<usize>>,
    moves: usize,
    /// Tuples looked at.
    work: usize,
}

impl RowSearch {
    fn new(sizes: &[u32], strength: usize, rows: Vec<AlternativeRow>) -> Self {
        let mut counts = TupleCounts::new(sizes, strength);
        for row in &rows {
            for group in 0..counts.groups.len() {
                counts.put(counts.tuple(group, row));
            }
        }
        let free_from = vec![vec![0; sizes.len()]; rows.len()];
        Self { rows, counts, free_from, moves: 0, work: 0 }
    }

    /// Leaves rows out as long as there are more than `least`, and the others come to have all tuples; the last that do.
    fn reduce(mut self, least: usize, rules: &mut dyn RowRules, rng: &mut ChaCha8Rng) -> Vec<AlternativeRow> {
        let mut best = self.rows.clone();
        while best.len() > least && self.work <= WORK {
            self.leave_out();
            if !self.cover(rules, rng) {
                break;
            }
            best.clone_from(&self.rows);
        }
        different(best)
    }

    /// Leaves out the row, the first of several, that alone has the fewest tuples.
    fn leave_out(&mut self) {
        self.work += self.rows.len() * self.counts.groups.len();
        let Some(at) = (0..self.rows.len()).min_by_key(|at| self.counts.alone(&self.rows[*at])) else {
            return;
        };
        let row = self.rows.remove(at);
        self.free_from.remove(at);
        for group in 0..self.counts.groups.len() {
            self.counts.take(self.counts.tuple(group, &row));
        }
    }

    /// Changes rows until all tuples occur; `false` if that took too long.
    fn cover(&mut self, rules: &mut dyn RowRules, rng: &mut ChaCha8Rng) -> bool {
        while !self.counts.open.is_empty() {
            if self.work > WORK {
                return false;
            }
            let drawn = rng.random_range(0..self.counts.open.len() as u32) as usize;
            let Some(tuple) = self.counts.open.iter().nth(drawn).copied() else { return false };
            let places = self.counts.places(tuple);
            let nearest = self.nearest(&places, rules);
            if nearest.is_empty() {
                if self.rows.is_empty() {
                    return false;
                }
                let at = rng.random_range(0..self.rows.len() as u32) as usize;
                let (changes, work) = rules.changes(&self.rows[at], &places, rng);
                self.work += work;
                changes.into_iter().for_each(|place| self.change(at, place));
            } else {
                let (at, place) = nearest[rng.random_range(0..nearest.len() as u32) as usize];
                self.change(at, place);
            }
            self.moves += 1;
        }
        true
    }

    /// The changes of one alternative by which a row gets the tuple, and that leave the fewest tuples open.
    fn nearest(&mut self, places: &[FactorChoice], rules: &mut dyn RowRules) -> Vec<(usize, FactorChoice)> {
        let (mut best, mut least) = (Vec::new(), isize::MAX);
        self.work += self.rows.len();
        for (at, row) in self.rows.iter().enumerate() {
            let mut other = places.iter().filter(|(f, a)| row[*f] != *a);
            let (Some(place), None) = (other.next(), other.next()) else { continue };
            if self.free_from[at][place.0] > self.moves || !rules.permits(row, *place) {
                continue;
            }
            self.work += self.counts.of[place.0].len();
            let opened = self.counts.changes(row, place.0, place.1).map(|(before, after)| {
                isize::from(self.counts.counts[before] == 1) - isize::from(self.counts.counts[after] == 0)
            });
            let opened: isize = opened.sum();
            if opened < least {
                (best, least) = (Vec::new(), opened);
            }
            if opened == least {
                best.push((at, *place));
            }
        }
        best
    }

    fn change(&mut self, at: usize, (factor, alternative): (usize, u32)) {
        if self.rows[at][factor] == alternative {
            return;
        }
        let changes: Vec<(usize, usize)> = self.counts.changes(&self.rows[at], factor, alternative).collect();
        for (before, after) in changes {
            self.counts.take(before);
            self.counts.put(after);
        }
        self.rows[at][factor] = alternative;
        self.free_from[at][factor] = self.moves + 1 + TABU;
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use rand::SeedableRng;

    use super::*;
    use crate::choose::cover::covering;

    /// The greedy rows, and what is left of them.
    fn both(sizes: &[u32], strength: usize, seed: u64) -> (usize, Vec<AlternativeRow>) {
        let greedy = covering(sizes, strength, usize::MAX, &mut ChaCha8Rng::seed_from_u64(seed)).rows;
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(1);
        (greedy.len(), fewer(sizes, strength, greedy, 0, &mut rng))
    }

    /// Sizes, each with how many factors have it; the tuples' size; the greedy rows; and the rows that are left of them.
    type KnownShape = (&'static [(u32, usize)], usize, usize, usize);

    /// For the seed 0.
    const SHAPES: &[KnownShape] = &[
        (&[(2, 4)], 2, 6, 5),
        (&[(2, 10)], 2, 10, 6),
        (&[(2, 20)], 2, 10, 8),
        (&[(2, 50)], 2, 13, 9),
        (&[(2, 100)], 2, 16, 10),
        (&[(3, 4)], 2, 9, 9),
        (&[(3, 7)], 2, 16, 12),
        (&[(3, 13)], 2, 19, 15),
        (&[(3, 40)], 2, 27, 21),
        (&[(4, 10)], 2, 30, 25),
        (&[(5, 6)], 2, 32, 25),
        (&[(6, 4)], 2, 44, 37),
        (&[(10, 20)], 2, 204, 187),
        (&[(5, 1), (3, 4), (2, 6)], 2, 19, 15),
        (&[(5, 1), (8, 4), (2, 2)], 2, 78, 64),
        (&[(2, 10)], 3, 18, 12),
        (&[(3, 4)], 3, 34, 27),
        (&[(3, 6)], 3, 46, 33),
        (&[(4, 5)], 3, 93, 64),
        (&[(5, 1), (3, 4), (2, 2)], 3, 63, 50),
        (&[(2, 6)], 4, 27, 21),
    ];

    #[test]
    fn no_shape_takes_more_rows_than_it_did() {
        for (shape, strength, most_greedy, most) in SHAPES {
            let sizes: Vec<u32> = shape.iter().flat_map(|(size, n)| std::iter::repeat_n(*size, *n)).collect();
            let (greedy, rows) = both(&sizes, *strength, 0);
            assert!(greedy <= *most_greedy && rows.len() <= *most, "{sizes:?}: {greedy}, {}", rows.len());
            assert_covers(&sizes, *strength, &rows);
        }
    }

    /// Counts the tuples without the machinery above.
    fn assert_covers(sizes: &[u32], strength: usize, rows: &[AlternativeRow]) {
        let distinct: BTreeSet<&AlternativeRow> = rows.iter().collect();
        assert_eq!(distinct.len(), rows.len(), "{sizes:?}");
        assert!(rows.iter().all(|row| row.len() == sizes.len() && row.iter().zip(sizes).all(|(a, n)| a < n)));
        let mut factors: Vec<usize> = (0..strength).collect();
        loop {
            let seen: BTreeSet<Vec<u32>> =
                rows.iter().map(|row| factors.iter().map(|f| row[*f]).collect()).collect();
            let all: usize = factors.iter().map(|f| sizes[*f] as usize).product();
            assert_eq!(seen.len(), all, "{factors:?} of {sizes:?}");
            if !next_group(&mut factors, sizes.len()) {
                return;
            }
        }
    }

    #[test]
    fn what_is_wanted_ends_the_search() {
        let greedy = covering(&[3; 13], 2, usize::MAX, &mut ChaCha8Rng::seed_from_u64(0)).rows;
        let of = |wanted| fewer(&[3; 13], 2, greedy.clone(), wanted, &mut ChaCha8Rng::seed_from_u64(0));
        assert_eq!(of(greedy.len()), greedy);
        assert_eq!(of(0).len(), 15);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn fewer_rows_have_all_tuples(
            sizes in prop::collection::vec(1u32..5, 2..8), strength in 2usize..4, wanted in 0usize..20, seed: u64,
        ) {
            prop_assume!(strength < sizes.len());
            let greedy = covering(&sizes, strength, usize::MAX, &mut ChaCha8Rng::seed_from_u64(seed)).rows;
            let of = || fewer(&sizes, strength, greedy.clone(), wanted, &mut ChaCha8Rng::seed_from_u64(seed));
            let rows = of();
            prop_assert!(rows.len() <= greedy.len());
            assert_covers(&sizes, strength, &rows);
            prop_assert_eq!(rows, of());
        }
    }

    #[test]
    fn constructions_have_all_tuples() {
        let shapes: [(&[u32], usize, usize); 10] = [
            (&[3; 13], 2, 15),
            (&[4; 21], 2, 28),
            (&[5; 6], 2, 25),
            (&[8; 9], 2, 64),
            (&[9, 8, 9, 7, 2, 9, 1, 9, 9, 9], 2, 81),
            (&[2; 100], 2, 10),
            (&[2, 1, 2, 2, 2], 2, 6),
            (&[5; 6], 3, 125),
            (&[4, 7, 3, 2, 5], 4, 420),
            (&[16; 3], 2, 256),
        ];
        for (sizes, strength, count) in shapes {
            let made = constructions(sizes, strength, usize::MAX);
            assert!(made.iter().any(|rows| rows.len() == count), "{sizes:?}");
            made.into_iter().for_each(|rows| assert_covers(sizes, strength, &different(rows)));
        }
        assert!(constructions(&[3; 13], 2, 15).is_empty());
    }
}
