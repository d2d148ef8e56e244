//! Which mutants are run, and against which tests.

use hrdsl_campaign::{ListedMutant, SingleRun};
use hrdsl_results::{FileCoverage, MutantFate};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Some of the mutants, drawn by a seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MutantSample {
    pub count: usize,
    pub seed: u64,
}

/// A mutant, and what is to be done with it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlannedMutant {
    pub mutant: ListedMutant,
    /// What is known of it without a run.
    pub known: Option<MutantFate>,
    /// The places of the tests that reach it, the shortest first.
    pub tests: Vec<usize>,
}

/// What is to be run.
#[derive(Clone, Debug, Default)]
pub struct MutationPlan {
    /// In the order of the files, and in each by number.
    pub mutants: Vec<PlannedMutant>,
    /// How many were worth a run before some were drawn.
    pub worth: usize,
    /// All tests, the shortest first.
    pub order: Vec<usize>,
}

impl MutationPlan {
    /// A plan for these mutants, given what the tests did on the original. With a sample, mutants that are worth a run and were not drawn
    /// are left out.
    #[must_use]
    pub fn new(listed: Vec<ListedMutant>, originals: &[SingleRun], sample: Option<MutantSample>) -> Self {
        let is_worth = |mutant: &ListedMutant| mutant.needless.is_empty();
        let worth = listed.iter().filter(|mutant| is_worth(mutant)).count();
        let mut drawn = sample.map(|sample| draw(worth, sample).into_iter());
        let kept = listed.into_iter().filter(|mutant| {
            !is_worth(mutant) || drawn.as_mut().is_none_or(|drawn| drawn.next().unwrap_or_default())
        });
        let kept: Vec<ListedMutant> = kept.collect();
        let mut order: Vec<usize> = (0..originals.len()).collect();
        let length = |test: &usize| originals.get(*test).map_or(0.0, |run| run.result.duration);
        order.sort_by(|a, b| length(a).total_cmp(&length(b)));
        let mutants = kept.into_iter().map(|mutant| planned(mutant, originals, &order)).collect();
        Self { mutants, worth, order }
    }

    /// How many runs it takes if nothing is noticed, or all are asked for; without those of the sentinels.
    #[must_use]
    pub fn runs(&self) -> usize {
        self.mutants.iter().map(|planned| planned.tests.len()).sum()
    }

    /// Seconds that these runs simulate if each lasts as long as the original's.
    #[must_use]
    pub fn simulated(&self, originals: &[SingleRun]) -> f64 {
        let tests = self.mutants.iter().flat_map(|planned| &planned.tests);
        tests.filter_map(|test| originals.get(*test)).fold(0.0, |sum, run| sum + run.result.duration)
    }
}

fn planned(mutant: ListedMutant, originals: &[SingleRun], order: &[usize]) -> PlannedMutant {
    let known = match mutant.needless.as_str() {
        "" => None,
        "equivalent" => Some(MutantFate::Equivalent),
        "duplicate" => Some(MutantFate::Duplicate),
        _ => Some(MutantFate::Invalid),
    };
    if known.is_some() {
        return PlannedMutant { mutant, known, tests: Vec::new() };
    }
    let reaches = |test: &usize| originals.get(*test).is_some_and(|run| reaches(run, &mutant));
    let tests: Vec<usize> = order.iter().copied().filter(reaches).collect();
    let known = tests.is_empty().then_some(MutantFate::NotReached);
    PlannedMutant { mutant, known, tests }
}

/// Whether a run executes what the mutant changes; also if that is not known, since the run broke off or its coverage is missing.
fn reaches(run: &SingleRun, mutant: &ListedMutant) -> bool {
    let Some(file) = run.executed.iter().find(|file| file.file == mutant.file) else { return true };
    run.result.error.is_some() || mutant.lines.iter().any(|line| executes(file, *line))
}

/// A line within a statement is executed with its first; one before all statements is taken to be.
fn executes(file: &FileCoverage, line: u32) -> bool {
    let after = file.statements.partition_point(|first| *first <= line);
    let Some(first) = after.checked_sub(1).and_then(|at| file.statements.get(at)) else { return true };
    file.executed.binary_search(first).is_ok()
}

/// Which of so many are drawn: each set of that size is as likely as another.
fn draw(of: usize, sample: MutantSample) -> Vec<bool> {
    let mut rng = ChaCha8Rng::seed_from_u64(sample.seed);
    let mut wanted = sample.count.min(of);
    (0..of)
        .map(|at| {
            let is_drawn = wanted > 0 && rng.random_range(0..of - at) < wanted;
            wanted -= usize::from(is_drawn);
            is_drawn
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use hrdsl_results::TestResult;

    use super::*;

    fn original(duration: f64, executed: &[u32]) -> SingleRun {
        let file = FileCoverage {
            file: "robot.py".into(),
            statements: vec![2, 3, 7],
            executed: executed.to_vec(),
            ..FileCoverage::default()
        };
        let result = TestResult { duration, ..TestResult::default() };
        SingleRun { result, recording: String::new(), executed: vec![file], cpu: Duration::ZERO }
    }

    fn mutant(number: u32, line: u32, needless: &str) -> ListedMutant {
        let needless = needless.to_owned();
        ListedMutant { number, line, lines: vec![line], needless, ..ListedMutant::sentinel("robot.py") }
    }

    #[test]
    fn mutants_run_against_the_tests_that_reach_them_the_shortest_first() {
        let originals = [original(9.0, &[2, 3]), original(5.0, &[2, 7]), original(1.0, &[2])];
        let listed = vec![mutant(1, 2, ""), mutant(2, 5, ""), mutant(3, 7, "equivalent"), mutant(4, 1, "")];
        let plan = MutationPlan::new(listed, &originals, None);
        let tests: Vec<&[usize]> = plan.mutants.iter().map(|planned| planned.tests.as_slice()).collect();
        assert_eq!(
            tests,
            [&[2, 1, 0][..], &[0], &[], &[2, 1, 0]],
            "line 5 is within the statement of line 3"
        );
        assert_eq!(plan.mutants[2].known, Some(MutantFate::Equivalent));
        assert_eq!((plan.worth, plan.runs(), plan.simulated(&originals)), (3, 7, 39.0));
        let none = MutationPlan::new(vec![mutant(1, 7, "")], &originals[2..], None);
        assert_eq!(none.mutants[0].known, Some(MutantFate::NotReached));
    }

    #[test]
    fn what_a_test_that_broke_off_reached_is_not_known() {
        let mut broken = original(1.0, &[]);
        broken.result.break_off("it crashed".into());
        let plan = MutationPlan::new(vec![mutant(1, 7, "")], &[broken], None);
        assert_eq!(plan.mutants[0].tests, [0]);
    }

    #[test]
    fn a_sample_is_of_what_is_worth_a_run_and_the_same_for_a_seed() {
        let listed = || (1..=50).map(|n| mutant(n, 2, if n == 9 { "duplicate" } else { "" })).collect();
        let numbers = |seed| -> Vec<u32> {
            let sample = MutantSample { count: 10, seed };
            let plan = MutationPlan::new(listed(), &[original(1.0, &[2])], Some(sample));
            plan.mutants.iter().filter(|p| p.known.is_none()).map(|p| p.mutant.number).collect()
        };
        assert_eq!(numbers(4).len(), 10);
        assert_eq!(numbers(4), numbers(4));
        assert_ne!(numbers(4), numbers(5));
    }
}
