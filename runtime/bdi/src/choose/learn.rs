//! Exploration that learns: alternatives that brought something new are chosen more often.

use std::collections::{BTreeMap, BTreeSet};

use hrdsl_ir::abstract_test::BeliefSet;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{
    factors::BeliefFactor,
    sets::{AlternativeRow, BATCH, belief_set, sizes},
    space::{AllowedSpace, NextRow},
    within::after,
};

/// How far a value moves to what was seen.
const ALPHA: f64 = 0.5;
/// What the next decision's value counts for this one.
const GAMMA: f64 = 0.9;
/// The chance that a decision is made at random: at first, times this after each batch, and at the least.
const EPSILON: (f64, f64, f64) = (1.0, 0.9, 0.1);
/// How often a row that is there already is drawn again.
const ATTEMPTS: usize = 50;

/// Q-learning (Watkins 1989) over the factors, as it was used for the tests of robotic code by Araiza-Illan, Pipe and
/// Eder, *Intelligent agent-based stimulation for testing robotic software in human-robot interactions* (2016).
///
/// A set of beliefs is an episode: one decision for each factor, in order. The state of a decision is its factor and the
/// alternative that was taken for the factor before; the action is the alternative. What a set brought, the number of
/// goals that its run was the first to reach, is the reward of its last decision; all values start at 0 and are learned
/// from the last decision of an episode to the first:
///
/// ```text
/// Q(s, a) := Q(s, a) + α · (r + γ · max Q(s′, ·) − Q(s, a))        α = 0.5, γ = 0.9
/// ```
///
/// A decision is made at random with the probability ε, which is 1 in the first batch, 0.9 times as much in each that
/// follows, and at least 0.1; otherwise it is one of the alternatives with the greatest value. Sets come in batches of
/// [`BATCH`], and values change between batches only, so that runs may be made in parallel. No set comes twice.
pub struct FactorLearner<'a> {
    factors: Vec<BeliefFactor>,
    sizes: Vec<u32>,
    /// By factor, the alternative before it (0 for the first) and the alternative; absent: 0.
    values: BTreeMap<(u32, u32, u32), f64>,
    seen: BTreeSet<AlternativeRow>,
    /// Of the last batch.
    rows: Vec<AlternativeRow>,
    epsilon: f64,
    wanted: usize,
    rng: ChaCha8Rng,
    /// What conditions allow; without it everything is.
    space: Option<AllowedSpace<'a>>,
}

impl<'a> FactorLearner<'a> {
    /// Makes `wanted` different sets; there must be as many.
    pub(super) fn new(factors: &[BeliefFactor], wanted: usize, seed: u64) -> Self {
        Self {
            factors: factors.to_vec(),
            sizes: sizes(factors),
            values: BTreeMap::new(),
            seen: BTreeSet::new(),
            rows: Vec::new(),
            epsilon: EPSILON.0,
            wanted,
            rng: ChaCha8Rng::seed_from_u64(seed),
            space: None,
        }
    }

    /// Makes at most `wanted` different sets that the space allows.
    pub(super) fn within(
        factors: &[BeliefFactor],
        wanted: usize,
        space: AllowedSpace<'a>,
        rng: ChaCha8Rng,
    ) -> Self {
        Self { rng, space: Some(space), ..Self::new(factors, wanted, 0) }
    }

    /// How many sets are left, at most.
    #[must_use]
    pub fn left(&self) -> usize {
        self.wanted.saturating_sub(self.seen.len())
    }

    /// The next sets, at most [`BATCH`]; none when there are as many as were wanted.
    pub fn next_batch(&mut self) -> Vec<BeliefSet> {
        self.rows = (0..self.left().min(BATCH)).map_while(|_| self.new_row()).collect();
        self.rows.iter().map(|row| belief_set(&self.factors, row)).collect()
    }

    /// Learns what the sets of the last batch brought, in their order.
    pub fn learn(&mut self, rewards: &[u32]) {
        for (row, reward) in std::mem::take(&mut self.rows).iter().zip(rewards) {
            self.episode(row, f64::from(*reward));
        }
        self.epsilon = (self.epsilon * EPSILON.1).max(EPSILON.2);
    }

    fn episode(&mut self, row: &AlternativeRow, reward: f64) {
        for factor in (0..row.len()).rev() {
            let target = match factor + 1 {
                last if last == row.len() => reward,
                next => GAMMA * self.best(next, row[factor], (0..self.sizes[next]).collect()).0,
            };
            let key = (factor as u32, before(row, factor), row[factor]);
            let value = self.values.entry(key).or_default();
            *value += ALPHA * (target - *value);
        }
    }

    /// The greatest value of a decision among some alternatives, and those that have it.
    fn best(&self, factor: usize, before: u32, among: Vec<u32>) -> (f64, Vec<u32>) {
        let mut best = (f64::NEG_INFINITY, Vec::new());
        for alternative in among {
            let value = self.values.get(&(factor as u32, before, alternative)).copied().unwrap_or(0.0);
            if value > best.0 {
                best = (value, Vec::new());
            }
            if value >= best.0 {
                best.1.push(alternative);
            }
        }
        best
    }

    /// A row that was not there yet: drawn; if that takes too long the first after the last one drawn.
    fn new_row(&mut self) -> Option<AlternativeRow> {
        let mut last = None;
        for _ in 0..=ATTEMPTS {
            let Some(row) = self.draw() else { continue };
            if self.seen.insert(row.clone()) {
                return Some(row);
            }
            last = Some(row);
        }
        let row = self.after(last.unwrap_or_else(|| vec![0; self.sizes.len()]))?;
        self.seen.insert(row.clone());
        Some(row)
    }

    /// The first row that was not there from this one on, and from the start again after the end.
    fn after(&mut self, mut row: AlternativeRow) -> Option<AlternativeRow> {
        let Some(space) = &mut self.space else {
            while self.seen.contains(&row) {
                advance(&mut row, &self.sizes);
            }
            return Some(row);
        };
        for from in [row, vec![0; self.sizes.len()]] {
            let mut next = space.next(&from);
            while let NextRow::Row(row) = next {
                if !self.seen.contains(&row) {
                    return Some(row);
                }
                next = after(space, &row);
            }
        }
        // A row that is found otherwise may be left where the search takes too long.
        (0..ATTEMPTS).find_map(|_| space.draw(&mut self.rng).filter(|row| !self.seen.contains(row)))
    }

    /// `None` if the alternatives that were taken leave none that is allowed.
    fn draw(&mut self) -> Option<AlternativeRow> {
        let mut row = AlternativeRow::with_capacity(self.sizes.len());
        for factor in 0..self.sizes.len() {
            let at_random = self.rng.random_range(0.0..1.0) < self.epsilon;
            let permitted = match &mut self.space {
                Some(space) => space.permitted(&row),
                None => (0..self.sizes[factor]).collect(),
            };
            let among =
                if at_random { permitted } else { self.best(factor, before(&row, factor), permitted).1 };
            let drawn = self.rng.random_range(0..among.len().max(1) as u32) as usize;
            row.push(*among.get(drawn)?);
        }
        Some(row)
    }
}

/// The alternative taken for the factor before; 0 for the first factor.
fn before(row: &AlternativeRow, factor: usize) -> u32 {
    factor.checked_sub(1).map_or(0, |f| row[f])
}

/// The next row in lexicographic order, the first after the last.
fn advance(row: &mut AlternativeRow, sizes: &[u32]) {
    for (digit, size) in row.iter_mut().zip(sizes).rev() {
        *digit += 1;
        if *digit < *size {
            return;
        }
        *digit = 0;
    }
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::bdi::AgentId;

    use super::{super::FactorAlternative, *};

    fn factors(sizes: &[u32]) -> Vec<BeliefFactor> {
        let alternative = |a: u32| FactorAlternative { facts: vec![], text: a.to_string() };
        let factor = |n: &u32| BeliefFactor {
            agent: AgentId(0),
            name: String::new(),
            alternatives: (0..*n).map(alternative).collect(),
        };
        sizes.iter().map(factor).collect()
    }

    /// Rows of so many batches, when each set brings what `reward` says.
    fn run(
        learner: &mut FactorLearner,
        batches: usize,
        reward: impl Fn(&AlternativeRow) -> u32,
    ) -> Vec<AlternativeRow> {
        let mut all = Vec::new();
        for _ in 0..batches {
            learner.next_batch();
            let rows = learner.rows.clone();
            learner.learn(&rows.iter().map(&reward).collect::<Vec<_>>());
            all.extend(rows);
        }
        all
    }

    #[test]
    fn the_whole_space_comes_once() {
        let mut learner = FactorLearner::new(&factors(&[3, 2, 4]), 24, 7);
        let rows = run(&mut learner, 9, |row| row[0]);
        assert_eq!(rows.len(), 24);
        assert_eq!(rows.iter().collect::<BTreeSet<_>>().len(), 24);
        assert!(learner.next_batch().is_empty());
        assert_eq!(run(&mut FactorLearner::new(&[], 1, 0), 2, |_| 1), [AlternativeRow::new()]);
    }

    #[test]
    fn what_brings_something_is_chosen_more_often() {
        // Only sets with alternative 7 after alternative 3 bring anything: one in 64 at random.
        let is_good = |row: &AlternativeRow| row[1] == 3 && row[2] == 7;
        let mut learner = FactorLearner::new(&factors(&[8, 8, 8, 8]), 4096, 11);
        let rows = run(&mut learner, 40, |row| u32::from(is_good(row)));
        let good = |rows: &[AlternativeRow]| rows.iter().filter(|r| is_good(r)).count();
        let (first, last) = (good(&rows[..320]), good(&rows[320..]));
        assert!(first < 64 && good(&rows) >= 32, "{first} of 320, then {last} of 320");
        // There are 64 such sets in all; at random 10 of 640 would be among them.
    }

    #[test]
    fn values_are_learned_from_the_last_decision_back() {
        let mut learner = FactorLearner::new(&factors(&[2, 2]), 4, 0);
        learner.episode(&vec![1, 0], 8.0);
        assert_eq!(learner.values[&(1, 1, 0)], 4.0);
        assert_eq!(learner.values[&(0, 0, 1)], 0.5 * 0.9 * 4.0);
        learner.episode(&vec![1, 0], 0.0);
        assert_eq!(learner.values[&(1, 1, 0)], 2.0);
        assert_eq!(learner.best(1, 1, vec![0, 1]), (2.0, vec![0]));
        assert_eq!(learner.best(1, 0, vec![0, 1]), (0.0, vec![0, 1]));
    }

    #[test]
    fn the_same_seed_and_rewards_give_the_same_sets() {
        let rows =
            |seed| run(&mut FactorLearner::new(&factors(&[5; 5]), 200, seed), 12, |row| row[0] * row[4]);
        assert_eq!(rows(3), rows(3));
        assert_ne!(rows(3), rows(4));
    }
}
