//! The nearest name: which declared name a misspelt one was meant to be.

use std::cmp::Reverse;

/// Costs of the edits. A slip of the keyboard most often swaps two letters; it more often adds or drops one than it exchanges it,
/// which also decides between `m` and `mm` for `mx`, `ms` and `s` for `sm`.
const INDEL: usize = 2;
const SWAP: usize = 1;
const REPLACE: usize = 3;

/// The weighted edit distance of optimal string alignment (Damerau–Levenshtein without edits inside a transposition).
#[must_use]
pub fn distance(a: &str, b: &str) -> usize {
    let a: Vec<char> = a.chars().collect();
    let b: Vec<char> = b.chars().collect();
    // INVARIANT: row[j] is the distance of a[..i] and b[..j]; `last` and `before` are the rows of i - 1 and i - 2.
    let mut before: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=b.len()).map(|j| j * INDEL).collect();
    let mut a_before = None;
    for (i, &in_a) in a.iter().enumerate() {
        let mut left = (i + 1) * INDEL;
        let mut row = vec![left];
        let mut b_before = None;
        // Both have an entry more than `b` has letters; the row before last is empty in the first round.
        let mut swapped = before.iter();
        for ((&in_b, diagonal), above) in b.iter().zip(&last).zip(last.iter().skip(1)) {
            let replace = if in_a == in_b { 0 } else { REPLACE };
            let mut best = (diagonal + replace).min(above + INDEL).min(left + INDEL);
            if b_before.is_some() {
                let swap = swapped.next().filter(|_| b_before == Some(in_a) && a_before == Some(in_b));
                best = swap.map_or(best, |cost| best.min(cost + SWAP));
            }
            row.push(best);
            (left, b_before) = (best, Some(in_b));
        }
        before = std::mem::replace(&mut last, row);
        a_before = Some(in_a);
    }
    last.last().copied().unwrap_or_default()
}

/// The candidate nearest to `name`, if one is near enough to have been meant; of equals the one that begins alike for
/// longer, then the first. A difference of case alone is always near.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let length = name.chars().count();
    let limit = (length * INDEL / 2).max(REPLACE);
    // Most names of a large scenario are told apart by their lengths, for which no table has to be made.
    let could_be = |c: &str| c != name && c.chars().count().abs_diff(length) * INDEL <= limit;
    candidates
        .into_iter()
        .filter(|c| could_be(c))
        .map(|c| (if c.eq_ignore_ascii_case(name) { 1 } else { distance(name, c) }, c))
        .filter(|(d, _)| *d <= limit)
        .min_by_key(|(d, c)| (*d, Reverse(name.chars().zip(c.chars()).take_while(|(a, b)| a == b).count())))
        .map(|(_, c)| c)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn slips_find_their_name() {
        let units = ["s", "ms", "m", "cm", "mm", "min"];
        assert_eq!(nearest("mx", units), Some("m"));
        assert_eq!(nearest("sm", units), Some("ms"));
        assert_eq!(nearest("dyx", ["dx", "dy"]), Some("dy"));
        assert_eq!(nearest("leg_reqeust", ["leg", "leg_request", "request"]), Some("leg_request"));
        assert_eq!(nearest("legx", ["leg1", "leg2", "leg"]), Some("leg"));
        assert_eq!(nearest("human", ["Human", "humane"]), Some("Human"));
        assert_eq!(nearest("zebra", ["leg", "hand"]), None);
    }

    proptest! {
        #[test]
        fn distance_is_a_symmetric_premetric(a in "[abc]{0,6}", b in "[abc]{0,6}") {
            prop_assert_eq!(distance(&a, &b), distance(&b, &a));
            prop_assert_eq!(distance(&a, &b) == 0, a == b);
            prop_assert!(distance(&a, &b) <= INDEL * (a.len() + b.len()));
        }

        #[test]
        fn one_insertion_or_swap_costs_one_edit(a in "[a-z]{2,8}", at in 0usize..8) {
            let at = at.min(a.len() - 2);
            let mut longer = a.clone();
            longer.insert(at, '_');
            prop_assert_eq!(distance(&a, &longer), INDEL);
            let mut swapped: Vec<char> = a.chars().collect();
            swapped.swap(at, at + 1);
            let swapped: String = swapped.into_iter().collect();
            prop_assert!(distance(&a, &swapped) <= SWAP);
        }
    }
}
