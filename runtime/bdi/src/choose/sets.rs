//! Sets of beliefs, and the rows of numbers that stand for them.

use hrdsl_ir::abstract_test::BeliefSet;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::factors::BeliefFactor;

/// More sets than this are never made.
pub const MAX_SETS: usize = 1_000_000;

/// How many sets are run before what they reached is looked at. It is part of what `learn` means.
pub const BATCH: usize = 16;

/// An index of an alternative for each factor.
pub(super) type AlternativeRow = Vec<u32>;

pub(super) fn sizes(factors: &[BeliefFactor]) -> Vec<u32> {
    factors.iter().map(|f| f.alternatives.len() as u32).collect()
}

/// How many rows there are.
pub(super) fn space(sizes: &[u32]) -> u128 {
    sizes.iter().fold(1u128, |product, size| product.saturating_mul(u128::from(*size)))
}

pub(super) fn belief_set(factors: &[BeliefFactor], row: &AlternativeRow) -> BeliefSet {
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
pub(super) fn row_at(sizes: &[u32], mut index: u128) -> AlternativeRow {
    let mut row = vec![0; sizes.len()];
    for (digit, size) in row.iter_mut().zip(sizes).rev() {
        *digit = (index % u128::from(*size)) as u32;
        index /= u128::from(*size);
    }
    row
}

/// Fisher and Yates.
pub(super) fn shuffle<T>(items: &mut [T], rng: &mut ChaCha8Rng) {
    for last in (1..items.len()).rev() {
        items.swap(last, rng.random_range(0..=last as u64) as usize);
    }
}
