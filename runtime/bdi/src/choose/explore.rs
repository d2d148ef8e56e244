//! Sets of beliefs from factors: all of them, enough for every tuple, a random sample, or what learning finds.

use std::{cell::Cell, collections::BTreeSet, rc::Rc};

use hrdsl_ir::{
    Program,
    abstract_test::BeliefSet,
    bdi::AgentId,
    suite::{BeliefChoice, ExploreMode},
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{
    cover::covering,
    factors::{BeliefFactor, ChooseError},
    fewer::fewer,
    judge::ConditionEvaluator,
    learn::FactorLearner,
    sets::{AlternativeRow, BATCH, MAX_SETS, belief_set, row_at, shuffle, sizes, space},
    space::AllowedSpace,
    tuples::SetTuples,
    within::within,
};

/// The sets found, and how they stand to the whole belief space.
#[derive(Clone, Debug, PartialEq)]
pub struct ExploredBeliefs {
    /// All different in what they choose.
    pub sets: Vec<BeliefSet>,
    /// The size of the whole belief space; `u128::MAX` if it is that or more.
    pub space: u128,
    /// Whether a limit cut short what was asked for: not all sets for `Exhaustive`, not all tuples for `Wise`.
    pub cut: bool,
    /// For `Wise`: the tuples that the sets have.
    pub tuples: Option<SetTuples>,
}

/// Explores the belief space without running anything.
///
/// - `Exhaustive`: all sets in lexicographic order (the last factor changes fastest), at most `tests`.
/// - `Wise(t)`: sets in which every t alternatives of t different factors occur together, even if that takes more than
///   `tests`; then different random ones up to `tests`. If the first way to choose them takes more than `tests`, others are
///   tried that may take no more.
/// - `Random`: `tests` different ones. `Learn` needs to be told what sets brought ([`BeliefExplorer`]); here it is the same.
///
/// A space of fewer than `tests` sets gives them all. The same arguments always give the same sets.
#[must_use]
pub fn explore(factors: &[BeliefFactor], explore: ExploreMode, tests: u32, seed: u64) -> ExploredBeliefs {
    let sizes = sizes(factors);
    let space = space(&sizes);
    let wanted = wanted(space, tests);
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut tuples = None;
    let (rows, cut) = match explore {
        // INVARIANT: `wanted` is at most the space.
        ExploreMode::Exhaustive => {
            let rows: Vec<AlternativeRow> = (0..wanted as u128).map(|index| row_at(&sizes, index)).collect();
            (rows, (wanted as u128) < space)
        }
        ExploreMode::Wise(_) if space == 0 => (Vec::new(), false),
        ExploreMode::Wise(strength) => {
            let found = covering(&sizes, strength.into(), MAX_SETS, &mut rng);
            let asked = usize::from(strength).max(2);
            let cut = found.rows.len() == MAX_SETS || found.strength < asked.min(sizes.len());
            let (rows, needed) = fitting(&sizes, found.strength, found.rows, wanted, seed);
            let rows = fill(rows, &sizes, space, wanted, &mut rng);
            tuples = SetTuples::new(&sizes, found.strength, &rows, needed);
            (rows, cut)
        }
        ExploreMode::Random | ExploreMode::Learn => {
            (fill(Vec::new(), &sizes, space, wanted, &mut rng), false)
        }
    };
    ExploredBeliefs { sets: rows.iter().map(|row| belief_set(factors, row)).collect(), space, cut, tuples }
}

/// Rows with the same tuples, no more than `wanted`, if there are more and as few are found, otherwise these; and how many
/// rows would do, as far as was found.
fn fitting(
    sizes: &[u32],
    strength: usize,
    rows: Vec<AlternativeRow>,
    wanted: usize,
    seed: u64,
) -> (Vec<AlternativeRow>, usize) {
    if rows.len() <= wanted || rows.len() >= MAX_SETS {
        let needed = rows.len();
        return (rows, needed);
    }
    // A stream of its own: what else is drawn does not depend on whether fewer rows were looked for.
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(1);
    let least = fewer(sizes, strength, rows.clone(), wanted, &mut rng);
    let needed = least.len();
    // If some tests will be left out in any case, the first greedy rows have more tuples than any others.
    (if needed <= wanted { least } else { rows }, needed)
}

/// Explores the belief space in batches, each after what the one before it brought is known.
pub struct BeliefExplorer<'a> {
    /// The size of the whole belief space; see [`ExploredBeliefs::space`].
    pub space: u128,
    /// See [`ExploredBeliefs::cut`].
    pub cut: bool,
    /// What conditions left out, and how that was found.
    pub notes: Vec<String>,
    /// For `Wise`: the tuples that the sets have.
    pub tuples: Option<SetTuples>,
    source: BeliefSetSource<'a>,
}

enum BeliefSetSource<'a> {
    /// Known from the start, the last one first.
    Fixed(Vec<BeliefSet>),
    Learner(Box<FactorLearner<'a>>),
}

impl<'a> BeliefExplorer<'a> {
    /// See [`explore`]; `Learn` makes at most `tests` different sets.
    #[must_use]
    pub fn new(factors: &[BeliefFactor], method: ExploreMode, tests: u32, seed: u64) -> Self {
        match method {
            ExploreMode::Exhaustive | ExploreMode::Wise(_) | ExploreMode::Random => {
                let ExploredBeliefs { mut sets, space, cut, tuples } = explore(factors, method, tests, seed);
                sets.reverse();
                Self { space, cut, notes: Vec::new(), tuples, source: BeliefSetSource::Fixed(sets) }
            }
            ExploreMode::Learn => {
                let space = space(&sizes(factors));
                let learner = FactorLearner::new(factors, wanted(space, tests), seed);
                let source = BeliefSetSource::Learner(Box::new(learner));
                Self { space, cut: false, notes: Vec::new(), tuples: None, source }
            }
        }
    }

    /// Explores what the conditions of the choices allow, in runs of these agents; without conditions the same as
    /// [`BeliefExplorer::new`]. The factors are those of the choices.
    ///
    /// # Errors
    /// A condition that cannot be asked, or conditions that allow nothing.
    pub fn of(
        program: &'a Program,
        agents: &[AgentId],
        choices: &'a [BeliefChoice],
        factors: &[BeliefFactor],
        method: (ExploreMode, u32, u64),
    ) -> Result<Self, ChooseError> {
        let (explore, tests, seed) = method;
        if choices.iter().all(|c| c.condition.is_none()) {
            return Ok(Self::new(factors, explore, tests, seed));
        }
        let mut judge = ConditionEvaluator::new(program, agents, choices)?;
        let scopes = judge.scopes(factors);
        let of_row = factors.to_vec();
        let fault = Rc::new(Cell::new(None));
        let told = Rc::clone(&fault);
        let holds = move |question: usize, row: &AlternativeRow| {
            let alternatives = of_row.iter().zip(row).map(|(f, a)| (f.agent, &f.alternatives[*a as usize]));
            let holds = judge
                .holds(question, &mut alternatives.flat_map(|(id, a)| a.facts.iter().map(move |f| (id, f))));
            told.set(judge.fault);
            holds
        };
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let space = AllowedSpace::new(sizes(factors), scopes, Box::new(holds), &mut rng);
        let mut explorer = Self::within(space, factors, (explore, tests), rng).map_err(|e| {
            if let ChooseError::NothingAllowed { choices, is_proved, .. } = e {
                ChooseError::NothingAllowed { choices, is_proved, fault: fault.get() }
            } else {
                e
            }
        })?;
        if let Some(fault) = fault.get() {
            let note = format!("where a condition had no value, its belief set was left out: {fault}");
            explorer.notes.push(note);
        }
        Ok(explorer)
    }

    /// Explores the part of the space that is allowed.
    pub(super) fn within(
        mut space: AllowedSpace<'a>,
        factors: &[BeliefFactor],
        (method, tests): (ExploreMode, u32),
        mut rng: ChaCha8Rng,
    ) -> Result<Self, ChooseError> {
        let whole = self::space(&space.sizes);
        let allowed = space.allowed();
        if allowed == Some(0) || space.empty().is_some() {
            let choices = match space.empty() {
                Some(group) => group.factors.iter().map(|f| factors[*f].name.clone()).collect(),
                None => Vec::new(),
            };
            let is_proved = allowed == Some(0);
            return Err(ChooseError::NothingAllowed { choices, is_proved, fault: None });
        }
        let mut notes = vec![match allowed {
            Some(allowed) => format!(
                "the conditions allow {allowed} of {whole} belief sets; {} are left out",
                whole.saturating_sub(allowed)
            ),
            None => "the belief space is too large to go through: what the conditions allow was searched for at random"
                .to_owned(),
        }];
        let tests = tests as usize;
        if method == ExploreMode::Learn {
            let wanted = allowed.map_or(tests, |n| wanted(n, u32::try_from(tests).unwrap_or(u32::MAX)));
            let learner = FactorLearner::within(factors, wanted.min(MAX_SETS), space, rng);
            return Ok(Self {
                space: whole,
                cut: false,
                notes,
                tuples: None,
                source: BeliefSetSource::Learner(Box::new(learner)),
            });
        }
        let found = within(&mut space, method, tests, &mut rng);
        let mut sets: Vec<BeliefSet> = found.rows.iter().map(|row| belief_set(factors, row)).collect();
        sets.reverse();
        notes.extend(found.notes);
        let tuples = found
            .strength
            .and_then(|(strength, needed)| SetTuples::new(&space.sizes, strength, &found.rows, needed));
        Ok(Self { space: whole, cut: found.cut, notes, tuples, source: BeliefSetSource::Fixed(sets) })
    }

    /// How many sets are left, at most.
    #[must_use]
    pub fn left(&self) -> usize {
        match &self.source {
            BeliefSetSource::Fixed(sets) => sets.len(),
            BeliefSetSource::Learner(learner) => learner.left(),
        }
    }

    /// The next sets, at most [`BATCH`]; none at the end.
    pub fn next_batch(&mut self) -> Vec<BeliefSet> {
        match &mut self.source {
            BeliefSetSource::Fixed(sets) => {
                sets.split_off(sets.len().saturating_sub(BATCH)).into_iter().rev().collect()
            }
            BeliefSetSource::Learner(learner) => learner.next_batch(),
        }
    }

    /// What the sets of the last batch brought, in their order.
    pub fn learn(&mut self, rewards: &[u32]) {
        match &mut self.source {
            BeliefSetSource::Fixed(_) => {}
            BeliefSetSource::Learner(learner) => learner.learn(rewards),
        }
    }
}

fn wanted(space: u128, tests: u32) -> usize {
    usize::try_from(space).unwrap_or(usize::MAX).min(tests as usize).min(MAX_SETS)
}

/// Adds different random rows until there are `wanted`, which is at most the space.
fn fill(
    mut rows: Vec<AlternativeRow>,
    sizes: &[u32],
    space: u128,
    wanted: usize,
    rng: &mut ChaCha8Rng,
) -> Vec<AlternativeRow> {
    let mut seen: BTreeSet<AlternativeRow> = rows.iter().cloned().collect();
    // In a small space drawing would take long to find the last ones: deal them out instead.
    if space <= 4 * wanted as u128 {
        let mut rest: Vec<AlternativeRow> =
            (0..space).map(|index| row_at(sizes, index)).filter(|row| !seen.contains(row)).collect();
        shuffle(&mut rest, rng);
        rest.truncate(wanted.saturating_sub(rows.len()));
        rows.append(&mut rest);
    }
    while rows.len() < wanted {
        let row: AlternativeRow = sizes.iter().map(|size| rng.random_range(0..*size)).collect();
        if seen.insert(row.clone()) {
            rows.push(row);
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::{
        Value,
        bdi::{BeliefId, InitialFact},
    };
    use proptest::prelude::*;

    use super::*;
    use crate::choose::FactorAlternative;

    fn factors(sizes: &[u32]) -> Vec<BeliefFactor> {
        let alternative = |f: u16, a: u32| FactorAlternative {
            facts: vec![InitialFact {
                belief: BeliefId(f),
                args: vec![Value::Int(i64::from(a))],
                annotations: vec![],
            }],
            text: format!("b{f}({a})"),
        };
        (0u16..)
            .zip(sizes)
            .map(|(f, n)| BeliefFactor {
                agent: AgentId(0),
                name: format!("b{f}"),
                alternatives: (0..*n).map(|a| alternative(f, a)).collect(),
            })
            .collect()
    }

    fn texts(found: &ExploredBeliefs) -> Vec<String> {
        found.sets.iter().map(|s| s.text.join(" ")).collect()
    }

    #[test]
    fn exhaustive_is_lexicographic_and_says_when_it_is_cut() {
        let all = explore(&factors(&[2, 3]), ExploreMode::Exhaustive, 100, 0);
        assert_eq!(
            texts(&all),
            ["b0(0) b1(0)", "b0(0) b1(1)", "b0(0) b1(2)", "b0(1) b1(0)", "b0(1) b1(1)", "b0(1) b1(2)"]
        );
        assert_eq!((all.space, all.cut), (6, false));
        let some = explore(&factors(&[2, 3]), ExploreMode::Exhaustive, 4, 0);
        assert_eq!(texts(&some), texts(&all)[..4]);
        assert!(some.cut);
        let vast = explore(&factors(&[9; 60]), ExploreMode::Exhaustive, 2, 0);
        assert_eq!((vast.space, vast.sets.len(), vast.cut), (u128::MAX, 2, true));
    }

    #[test]
    fn what_is_not_held_is_not_told() {
        let mut factors = factors(&[2, 2]);
        factors[0].alternatives[0] = FactorAlternative { facts: vec![], text: "not b0".into() };
        let all = explore(&factors, ExploreMode::Exhaustive, 9, 0);
        assert_eq!(texts(&all), ["b1(0)", "b1(1)", "b0(1) b1(0)", "b0(1) b1(1)"]);
        assert_eq!(all.sets[0].facts.len(), 1);
    }

    #[test]
    fn no_factors_give_one_empty_set() {
        for method in [
            ExploreMode::Exhaustive,
            ExploreMode::Wise(2),
            ExploreMode::Wise(3),
            ExploreMode::Random,
            ExploreMode::Learn,
        ] {
            assert_eq!(explore(&[], method, 5, 0).sets, [BeliefSet::default()]);
        }
    }

    #[test]
    fn pairwise_takes_more_than_was_asked_for_if_it_must() {
        let found = explore(&factors(&[4, 5, 2]), ExploreMode::Wise(2), 3, 7);
        assert!(found.sets.len() >= 20 && !found.cut);
    }

    #[test]
    fn seeds_matter() {
        let run = |seed| explore(&factors(&[5; 6]), ExploreMode::Random, 20, seed);
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
            let methods = [ExploreMode::Exhaustive, ExploreMode::Wise(2), ExploreMode::Wise(3), ExploreMode::Random, ExploreMode::Learn];
            for method in methods {
                let found = explore(&factors(&sizes), method, tests, seed);
                let mut explorer = BeliefExplorer::new(&factors(&sizes), method, tests, seed);
                let mut batched = Vec::new();
                loop {
                    let batch = explorer.next_batch();
                    if batch.is_empty() {
                        break;
                    }
                    prop_assert!(batch.len() <= BATCH);
                    explorer.learn(&vec![1; batch.len()]);
                    batched.extend(batch);
                }
                prop_assert_eq!(batched.len(), found.sets.len());
                if method != ExploreMode::Learn {
                    prop_assert_eq!(&batched, &found.sets);
                }
                let found = ExploredBeliefs { sets: batched, ..found };
                let mut distinct = texts(&found);
                distinct.sort();
                distinct.dedup();
                prop_assert_eq!(distinct.len(), found.sets.len());
                let least = product.min(tests) as usize;
                if matches!(method, ExploreMode::Wise(_)) {
                    prop_assert!(found.sets.len() >= least && found.sets.len() <= product as usize);
                } else {
                    prop_assert_eq!(found.sets.len(), least);
                }
            }
        }
    }
}
