//! Pairwise covering arrays, greedily in the manner of AETG (Cohen, Dalal, Fredman, Patton, *IEEE Transactions on
//! Software Engineering* 23(7), 1997): the best of several randomly ordered rows is taken until every pair is covered.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// Rows that compete for each place in the array.
const CANDIDATES: usize = 30;

/// An index of an alternative for each factor.
pub(super) type Row = Vec<u32>;

/// The pairs of alternatives of two different factors that no row has yet.
struct Uncovered {
    /// Where each factor's alternatives start, when all are counted through; one more at the end.
    starts: Vec<usize>,
    /// A symmetric matrix over all alternatives.
    open: Vec<bool>,
    /// Open pairs by alternative.
    of: Vec<usize>,
    left: usize,
}

impl Uncovered {
    fn new(sizes: &[u32]) -> Self {
        let mut starts = vec![0];
        for size in sizes {
            starts.push(starts[starts.len() - 1] + *size as usize);
        }
        let all = starts[sizes.len()];
        let (mut open, mut of, mut left) = (vec![false; all * all], vec![0; all], 0);
        for (f, window) in starts.windows(2).enumerate() {
            for a in window[0]..window[1] {
                for b in starts[f + 1]..all {
                    (open[a * all + b], open[b * all + a]) = (true, true);
                    of[a] += 1;
                    of[b] += 1;
                    left += 1;
                }
            }
        }
        Self { starts, open, of, left }
    }

    fn place(&self, factor: usize, alternative: u32) -> usize {
        self.starts[factor] + alternative as usize
    }

    fn is_open(&self, a: usize, b: usize) -> bool {
        self.open[a * self.of.len() + b]
    }

    fn cover(&mut self, row: &Row) {
        let all = self.of.len();
        let places: Vec<usize> = row.iter().enumerate().map(|(f, a)| self.place(f, *a)).collect();
        for (i, a) in places.iter().enumerate() {
            for b in &places[i + 1..] {
                if self.is_open(*a, *b) {
                    (self.open[a * all + b], self.open[b * all + a]) = (false, false);
                    self.of[*a] -= 1;
                    self.of[*b] -= 1;
                    self.left -= 1;
                }
            }
        }
    }

    /// The factor and alternative with the most open pairs; the first of several.
    fn neediest(&self) -> (usize, u32) {
        let mut best = (0, 0, 0);
        for (factor, window) in self.starts.windows(2).enumerate() {
            for place in window[0]..window[1] {
                if self.of[place] > best.0 {
                    best = (self.of[place], factor, (place - window[0]) as u32);
                }
            }
        }
        (best.1, best.2)
    }
}

/// Rows in which every pair of alternatives of two different factors occurs, at most `limit`. With a single factor
/// every alternative occurs; without factors there is one empty row.
pub(super) fn pairwise(sizes: &[u32], limit: usize, rng: &mut ChaCha8Rng) -> Vec<Row> {
    if let [] | [_] = sizes {
        let alone = sizes.first().map_or(vec![vec![]], |size| (0..*size).map(|a| vec![a]).collect());
        return alone.into_iter().take(limit).collect();
    }
    let mut uncovered = Uncovered::new(sizes);
    let mut rows = Vec::new();
    while uncovered.left > 0 && rows.len() < limit {
        let mut best: (usize, Row) = (0, Row::new());
        let start = uncovered.neediest();
        for _ in 0..CANDIDATES {
            let (gain, row) = candidate(&uncovered, start, sizes, rng);
            if gain > best.0 {
                best = (gain, row);
            }
        }
        // INVARIANT: each candidate covers an open pair of the neediest alternative, so this ends.
        uncovered.cover(&best.1);
        rows.push(best.1);
    }
    rows
}

/// A row that starts from an alternative of a factor and goes through the other factors in a random order, each time
/// taking what covers most with the row so far; and how many open pairs it covers.
fn candidate(
    uncovered: &Uncovered,
    (first, start): (usize, u32),
    sizes: &[u32],
    rng: &mut ChaCha8Rng,
) -> (usize, Row) {
    let mut order: Vec<usize> = (0..sizes.len()).filter(|f| *f != first).collect();
    shuffle(&mut order, rng);
    let mut row: Row = vec![0; sizes.len()];
    row[first] = start;
    let mut placed = vec![uncovered.place(first, start)];
    let mut gain = 0;
    for factor in order {
        let gains: Vec<usize> = (0..sizes[factor])
            .map(|a| {
                let place = uncovered.place(factor, a);
                placed.iter().filter(|p| uncovered.is_open(**p, place)).count()
            })
            .collect();
        let most = gains.iter().copied().max().unwrap_or(0);
        let ties: Vec<u32> = (0u32..).zip(&gains).filter(|(_, g)| **g == most).map(|(a, _)| a).collect();
        row[factor] = ties[rng.random_range(0..ties.len() as u32) as usize];
        placed.push(uncovered.place(factor, row[factor]));
        gain += most;
    }
    (gain, row)
}

/// Fisher and Yates.
pub(super) fn shuffle<T>(items: &mut [T], rng: &mut ChaCha8Rng) {
    for last in (1..items.len()).rev() {
        items.swap(last, rng.random_range(0..=last as u64) as usize);
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use proptest::prelude::*;
    use rand::SeedableRng;

    use super::*;

    /// All pairs that rows cover, and the number there is, counted without the machinery above.
    fn pairs(sizes: &[u32], rows: &[Row]) -> (usize, usize) {
        let mut seen = BTreeSet::new();
        let mut all = 0;
        for i in 0..sizes.len() {
            for j in i + 1..sizes.len() {
                all += (sizes[i] * sizes[j]) as usize;
                seen.extend(rows.iter().map(|row| (i, row[i], j, row[j])));
            }
        }
        (seen.len(), all)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn every_pair_occurs(sizes in prop::collection::vec(1u32..7, 0..8), seed: u64) {
            let rows = pairwise(&sizes, usize::MAX, &mut ChaCha8Rng::seed_from_u64(seed));
            let (seen, all) = pairs(&sizes, &rows);
            prop_assert_eq!(seen, all);
            for row in &rows {
                prop_assert_eq!(row.len(), sizes.len());
                prop_assert!(row.iter().zip(&sizes).all(|(a, n)| a < n));
            }
            let distinct: BTreeSet<&Row> = rows.iter().collect();
            prop_assert_eq!(distinct.len(), rows.len(), "a row covers something that no other does");
            // No array is smaller than the product of the two largest factors; a greedy one is not far above.
            let mut sorted = sizes.clone();
            sorted.sort_unstable_by(|a, b| b.cmp(a));
            if let [a, b, ..] = sorted[..] {
                prop_assert!(rows.len() >= (a * b) as usize);
                prop_assert!(rows.len() <= (a * b) as usize * 2 + 6, "{} rows for {:?}", rows.len(), sizes);
            }
            prop_assert_eq!(&rows, &pairwise(&sizes, usize::MAX, &mut ChaCha8Rng::seed_from_u64(seed)));
        }
    }

    #[test]
    fn many_small_factors_need_few_rows() {
        // The literature's yardstick: 13 factors of 3 values need 15 rows at best, and AETG finds about 17 to 19.
        let rows = pairwise(&[3; 13], usize::MAX, &mut ChaCha8Rng::seed_from_u64(1));
        assert!(rows.len() <= 21, "{}", rows.len());
    }

    #[test]
    fn a_single_factor_gives_each_alternative_once() {
        let mut rng = ChaCha8Rng::seed_from_u64(0);
        assert_eq!(pairwise(&[3], 9, &mut rng), [[0], [1], [2]]);
        assert_eq!(pairwise(&[], 9, &mut rng), [Row::new()]);
        assert_eq!(pairwise(&[4, 4], 3, &mut rng).len(), 3);
    }
}
