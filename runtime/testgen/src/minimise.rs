//! Fewer tests that reach the same: a greedy set cover.

use std::collections::BTreeSet;

use hrdsl_ir::abstract_test::{AbstractTest, ReachedGoals};

/// Which tests to keep, in their order, so that together they reach what all of them do: first that which reaches most
/// that is not reached yet (the first of several), again and again; then, in the order in which they were taken, those go
/// that reach nothing which no other of them does. If no test reaches anything all stay.
#[must_use]
pub fn minimised(tests: &[AbstractTest]) -> Vec<usize> {
    let mut open: ReachedGoals = tests.iter().flat_map(|t| t.reaches.iter().copied()).collect();
    if open.is_empty() {
        return (0..tests.len()).collect();
    }
    let mut taken: Vec<usize> = Vec::new();
    while !open.is_empty() {
        let gain = |test: &AbstractTest| test.reaches.intersection(&open).count();
        // `min_by_key` takes the first of several, `max_by_key` the last.
        let Some(best) = (0..tests.len()).min_by_key(|i| std::cmp::Reverse(gain(&tests[*i]))) else { break };
        open.retain(|goal| !tests[best].reaches.contains(goal));
        taken.push(best);
    }
    drop_redundant(tests, &mut taken);
    taken.sort_unstable();
    taken
}

fn drop_redundant(tests: &[AbstractTest], taken: &mut Vec<usize>) {
    let mut at = 0;
    while at < taken.len() {
        let others = taken.iter().enumerate().filter(|(i, _)| *i != at);
        let others: BTreeSet<usize> =
            others.flat_map(|(_, test)| tests[*test].reaches.iter().copied()).collect();
        if tests[taken[at]].reaches.is_subset(&others) {
            taken.remove(at);
        } else {
            at += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keep(sets: &[&[usize]]) -> Vec<usize> {
        let test = |goals: &&[usize]| AbstractTest {
            reaches: goals.iter().copied().collect(),
            ..AbstractTest::default()
        };
        minimised(&sets.iter().map(test).collect::<Vec<_>>())
    }

    #[test]
    fn the_largest_gain_comes_first_and_the_first_of_several() {
        assert_eq!(keep(&[&[0], &[0, 1], &[2], &[1, 2]]), [1, 2]);
        assert_eq!(keep(&[&[0, 1], &[1, 0], &[]]), [0]);
        assert_eq!(keep(&[&[], &[]]), [0, 1]);
        assert_eq!(keep(&[]), Vec::<usize>::new());
    }

    #[test]
    fn what_the_greedy_choice_made_redundant_goes() {
        // The largest comes first, and is covered by those that the rest needs.
        let sets: [&[usize]; 4] = [&[1, 2, 3, 4], &[1, 2, 5], &[3, 6], &[4, 7]];
        assert_eq!(keep(&sets), [1, 2, 3]);
    }

    #[test]
    fn nothing_that_was_reached_is_lost() {
        // Sets of a small generator: 40 tests over 30 goals.
        let mut state = 7u64;
        let mut next = |n: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % n
        };
        for _ in 0..50 {
            let sets: Vec<Vec<usize>> =
                (0..40).map(|_| (0..next(6)).map(|_| next(30) as usize).collect()).collect();
            let views: Vec<&[usize]> = sets.iter().map(Vec::as_slice).collect();
            let kept = keep(&views);
            let all: BTreeSet<usize> = sets.iter().flatten().copied().collect();
            let held: BTreeSet<usize> = kept.iter().flat_map(|i| sets[*i].iter().copied()).collect();
            assert_eq!(all, held);
            for gone in &kept {
                let rest = kept.iter().filter(|i| *i != gone).flat_map(|i| sets[*i].iter().copied());
                assert_ne!(rest.collect::<BTreeSet<_>>(), all, "{gone} could go");
            }
        }
    }
}
