//! Sets of beliefs from factors: all of them, enough for every pair, or a random sample.

use std::collections::BTreeSet;

use hrdsl_ir::{
    bdi::{AgentId, Fact},
    suite::Explore,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{
    Factor,
    cover::{Row, pairwise, shuffle},
};

/// More sets than this are never made.
pub const MAX_SETS: usize = 1_000_000;

/// What the agents of one abstract test start with.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BeliefSet {
    /// In the order of the factors.
    pub facts: Vec<(AgentId, Fact)>,
    /// Each fact as it is written; [`Alternative::text`](super::Alternative::text).
    pub text: Vec<String>,
}

/// The sets found, and how they stand to the whole belief space.
#[derive(Clone, Debug, PartialEq)]
pub struct Explored {
    /// All different in what they choose.
    pub sets: Vec<BeliefSet>,
    /// The size of the whole belief space; `u128::MAX` if it is that or more.
    pub space: u128,
    /// Whether a limit cut short what was asked for: not all sets for `Exhaustive`, not all pairs for `Pairwise`.
    pub cut: bool,
}

/// Explores the belief space.
///
/// - `Exhaustive`: all sets in lexicographic order (the last factor changes fastest), at most `tests`.
/// - `Pairwise`: sets in which every two alternatives of two different factors occur together, even if that takes more
///   than `tests`; then different random ones up to `tests`.
/// - `Random`: `tests` different ones.
///
/// A space of fewer than `tests` sets gives them all. The same arguments always give the same sets.
#[must_use]
pub fn explore(factors: &[Factor], explore: Explore, tests: u32, seed: u64) -> Explored {
    let sizes: Vec<u32> = factors.iter().map(|f| f.alternatives.len() as u32).collect();
    let space = sizes.iter().fold(1u128, |product, size| product.saturating_mul(u128::from(*size)));
    let wanted = usize::try_from(space).unwrap_or(usize::MAX).min(tests as usize).min(MAX_SETS);
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (rows, cut) = match explore {
        // INVARIANT: `wanted` is at most the space.
        Explore::Exhaustive => {
            let rows: Vec<Row> = (0..wanted as u128).map(|index| row_at(&sizes, index)).collect();
            (rows, (wanted as u128) < space)
        }
        Explore::Wise(_) if space == 0 => (Vec::new(), false),
        Explore::Wise(_) => {
            let rows = pairwise(&sizes, MAX_SETS, &mut rng);
            let cut = rows.len() == MAX_SETS;
            (fill(rows, &sizes, space, wanted, &mut rng), cut)
        }
        Explore::Random | Explore::Learn => (fill(Vec::new(), &sizes, space, wanted, &mut rng), false),
    };
    Explored { sets: rows.iter().map(|row| belief_set(factors, row)).collect(), space, cut }
}

fn belief_set(factors: &[Factor], row: &Row) -> BeliefSet {
    let mut set = BeliefSet::default();
    for (factor, choice) in factors.iter().zip(row) {
        let alternative = &factor.alternatives[*choice as usize];
        set.facts.extend(alternative.facts.iter().map(|fact| (factor.agent, fact.clone())));
        if !alternative.facts.is_empty() {
            set.text.push(alternative.text.clone());
        }
    }
    set
}

/// The row of this index in lexicographic order.
fn row_at(sizes: &[u32], mut index: u128) -> Row {
    let mut row = vec![0; sizes.len()];
    for (digit, size) in row.iter_mut().zip(sizes).rev() {
        *digit = (index % u128::from(*size)) as u32;
        index /= u128::from(*size);
    }
    row
}

/// Adds different random rows until there are `wanted`, which is at most the space.
fn fill(mut rows: Vec<Row>, sizes: &[u32], space: u128, wanted: usize, rng: &mut ChaCha8Rng) -> Vec<Row> {
    let mut seen: BTreeSet<Row> = rows.iter().cloned().collect();
    // In a small space drawing would take long to find the last ones: deal them out instead.
    if space <= 4 * wanted as u128 {
        let mut rest: Vec<Row> =
            (0..space).map(|index| row_at(sizes, index)).filter(|row| !seen.contains(row)).collect();
        shuffle(&mut rest, rng);
        rest.truncate(wanted.saturating_sub(rows.len()));
        rows.append(&mut rest);
    }
    while rows.len() < wanted {
        let row: Row = sizes.iter().map(|size| rng.random_range(0..*size)).collect();
        if seen.insert(row.clone()) {
            rows.push(row);
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::{Value, bdi::BeliefId};
    use proptest::prelude::*;

    use super::*;
    use crate::choose::Alternative;

    fn space(sizes: &[u32]) -> Vec<Factor> {
        let alternative = |f: u16, a: u32| Alternative {
            facts: vec![Fact { belief: BeliefId(f), args: vec![Value::Int(i64::from(a))] }],
            text: format!("b{f}({a})"),
        };
        (0u16..)
            .zip(sizes)
            .map(|(f, n)| Factor {
                agent: AgentId(0),
                name: format!("b{f}"),
                alternatives: (0..*n).map(|a| alternative(f, a)).collect(),
            })
            .collect()
    }

    fn texts(found: &Explored) -> Vec<String> {
        found.sets.iter().map(|s| s.text.join(" ")).collect()
    }

    #[test]
    fn exhaustive_is_lexicographic_and_says_when_it_is_cut() {
        let all = explore(&space(&[2, 3]), Explore::Exhaustive, 100, 0);
        assert_eq!(
            texts(&all),
            ["b0(0) b1(0)", "b0(0) b1(1)", "b0(0) b1(2)", "b0(1) b1(0)", "b0(1) b1(1)", "b0(1) b1(2)"]
        );
        assert_eq!((all.space, all.cut), (6, false));
        let some = explore(&space(&[2, 3]), Explore::Exhaustive, 4, 0);
        assert_eq!(texts(&some), texts(&all)[..4]);
        assert!(some.cut);
        let vast = explore(&space(&[9; 60]), Explore::Exhaustive, 2, 0);
        assert_eq!((vast.space, vast.sets.len(), vast.cut), (u128::MAX, 2, true));
    }

    #[test]
    fn what_is_not_held_is_not_told() {
        let mut factors = space(&[2, 2]);
        factors[0].alternatives[0] = Alternative { facts: vec![], text: "not b0".into() };
        let all = explore(&factors, Explore::Exhaustive, 9, 0);
        assert_eq!(texts(&all), ["b1(0)", "b1(1)", "b0(1) b1(0)", "b0(1) b1(1)"]);
        assert_eq!(all.sets[0].facts.len(), 1);
    }

    #[test]
    fn no_factors_give_one_empty_set() {
        for how in [Explore::Exhaustive, Explore::Pairwise, Explore::Random] {
            assert_eq!(explore(&[], how, 5, 0).sets, [BeliefSet::default()]);
        }
    }

    #[test]
    fn pairwise_takes_more_than_was_asked_for_if_it_must() {
        let found = explore(&space(&[4, 5, 2]), Explore::Pairwise, 3, 7);
        assert!(found.sets.len() >= 20 && !found.cut);
    }

    #[test]
    fn seeds_matter() {
        let run = |seed| explore(&space(&[5; 6]), Explore::Random, 20, seed);
        assert_eq!(run(1), run(1));
        assert_ne!(run(1), run(2));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn sets_are_different_and_as_many_as_there_can_be(
            sizes in prop::collection::vec(1u32..5, 0..6), tests in 0u32..200, seed: u64,
        ) {
            let product: u32 = sizes.iter().product();
            for how in [Explore::Exhaustive, Explore::Pairwise, Explore::Random] {
                let found = explore(&space(&sizes), how, tests, seed);
                let mut distinct = texts(&found);
                distinct.sort();
                distinct.dedup();
                prop_assert_eq!(distinct.len(), found.sets.len());
                let least = product.min(tests) as usize;
                if how == Explore::Pairwise {
                    prop_assert!(found.sets.len() >= least && found.sets.len() <= product as usize);
                } else {
                    prop_assert_eq!(found.sets.len(), least);
                }
            }
        }
    }
}
