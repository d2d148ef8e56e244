//! What the campaign came to: the score, by oracle and by method, and each mutant.

use std::collections::BTreeMap;

use hrdsl_results::{
    MUTATION_FORMAT, MUTATION_VERSION, MethodScore, MutantCounts, MutantFate, MutantOracle, MutantReport,
    MutationAbout, MutationReport, OracleScore, TestMethod,
};

use crate::{
    outcome::MutantOutcome,
    plan::{MutantSample, MutationPlan},
};

const SECONDS_PER_HOUR: f64 = 3600.0;

/// Adds up what became of the mutants.
#[must_use]
pub fn add_up(
    about: MutationAbout,
    plan: &MutationPlan,
    sample: Option<MutantSample>,
    sentinels: Vec<MutantOutcome>,
    outcomes: Vec<MutantOutcome>,
) -> MutationReport {
    let counts = counts(&outcomes);
    let noticeable = counts.killed + counts.survived + counts.not_reached;
    let unknown = sentinels.iter().any(|sentinel| sentinel.fate == MutantFate::NotRun);
    MutationReport {
        format: MUTATION_FORMAT.to_owned(),
        version: MUTATION_VERSION,
        hrdsl: env!("CARGO_PKG_VERSION").to_owned(),
        about,
        interrupted: unknown || counts.not_run > 0,
        worth: plan.worth,
        drawn: sample.map(|sample| sample.count.min(plan.worth)),
        score: (noticeable > 0).then(|| counts.killed as f64 / noticeable as f64),
        counts,
        oracles: oracles(&outcomes),
        methods: methods(&outcomes),
        sentinels: sentinels.into_iter().map(reported).collect(),
        mutants: outcomes.into_iter().map(reported).collect(),
    }
}

fn reported(outcome: MutantOutcome) -> MutantReport {
    let MutantOutcome { mutant, fate, reached, ran, noticed, difference, proposals, .. } = outcome;
    MutantReport {
        file: mutant.file,
        line: mutant.line,
        number: mutant.number,
        operator: mutant.operator,
        what: mutant.what,
        fate,
        reached,
        ran,
        noticed,
        difference,
        proposals,
    }
}

fn counts(outcomes: &[MutantOutcome]) -> MutantCounts {
    let mut counts = MutantCounts::default();
    for outcome in outcomes {
        *match outcome.fate {
            MutantFate::Killed => &mut counts.killed,
            MutantFate::Survived => &mut counts.survived,
            MutantFate::NotDistinguished => &mut counts.not_distinguished,
            MutantFate::Permissive => &mut counts.permissive,
            MutantFate::NotReached => &mut counts.not_reached,
            MutantFate::Equivalent => &mut counts.equivalent,
            MutantFate::Duplicate => &mut counts.duplicate,
            MutantFate::Invalid => &mut counts.invalid,
            MutantFate::NotRun => &mut counts.not_run,
        } += 1;
    }
    counts
}

fn oracles(outcomes: &[MutantOutcome]) -> Vec<OracleScore> {
    let mut scores: BTreeMap<MutantOracle, OracleScore> = BTreeMap::new();
    for outcome in outcomes {
        let mut own: BTreeMap<&MutantOracle, Vec<TestMethod>> = BTreeMap::new();
        for noticed in &outcome.noticed {
            for oracle in &noticed.oracles {
                own.entry(oracle).or_default().push(noticed.method);
            }
        }
        let alone = usize::from(own.len() == 1);
        for (oracle, mut by) in own {
            let empty =
                || OracleScore { oracle: oracle.clone(), killed: 0, methods: BTreeMap::new(), alone: 0 };
            let score = scores.entry(oracle.clone()).or_insert_with(empty);
            score.killed += 1;
            score.alone += alone;
            by.sort();
            by.dedup();
            for method in by {
                *score.methods.entry(method).or_default() += 1;
            }
        }
    }
    scores.into_values().collect()
}

fn methods(outcomes: &[MutantOutcome]) -> Vec<MethodScore> {
    let mut sums: BTreeMap<TestMethod, (usize, f64)> = BTreeMap::new();
    for outcome in outcomes {
        for (method, simulated) in &outcome.simulated {
            let (killed, hours) = sums.entry(*method).or_default();
            *hours += simulated / SECONDS_PER_HOUR;
            *killed += usize::from(outcome.noticed.iter().any(|noticed| noticed.method == *method));
        }
    }
    let score = |(method, (killed, simulated_hours)): (TestMethod, (usize, f64))| MethodScore {
        method,
        killed,
        simulated_hours,
        killed_per_hour: (simulated_hours > 0.0).then(|| killed as f64 / simulated_hours),
    };
    sums.into_iter().map(score).collect()
}

#[cfg(test)]
mod tests {
    use hrdsl_campaign::ListedMutant;
    use hrdsl_results::NoticedTest;

    use super::*;

    fn noticed(test: &str, method: TestMethod, oracles: &[MutantOracle]) -> NoticedTest {
        NoticedTest { test: test.into(), oracles: oracles.to_vec(), error: None, method }
    }

    fn outcome(fate: MutantFate, noticed: Vec<NoticedTest>) -> MutantOutcome {
        let simulated = [(TestMethod::Search, 1800.0), (TestMethod::Random, 3600.0)].into();
        let mutant = ListedMutant::sentinel("robot.py");
        MutantOutcome { noticed, simulated, ..MutantOutcome::not_run(mutant, fate, 2) }
    }

    #[test]
    fn a_mutant_counts_once_for_each_oracle_and_method_that_notices_it() {
        let requirement = MutantOracle::Requirement("R1".into());
        let both = [requirement.clone(), MutantOracle::Prediction];
        let outcomes = [
            outcome(
                MutantFate::Killed,
                vec![noticed("a", TestMethod::Search, &both), noticed("b", TestMethod::Search, &both[..1])],
            ),
            outcome(MutantFate::Killed, vec![noticed("c", TestMethod::Random, &both[..1])]),
            outcome(MutantFate::Survived, Vec::new()),
        ];
        let found: Vec<(String, usize, usize)> =
            oracles(&outcomes).iter().map(|o| (o.oracle.to_string(), o.killed, o.alone)).collect();
        assert_eq!(found, [("requirement R1".to_owned(), 2, 1), ("prediction".to_owned(), 1, 0)]);
        let found: Vec<(TestMethod, usize, f64, Option<f64>)> = methods(&outcomes)
            .iter()
            .map(|m| (m.method, m.killed, m.simulated_hours, m.killed_per_hour))
            .collect();
        let expected =
            [(TestMethod::Search, 1, 1.5, Some(1.0 / 1.5)), (TestMethod::Random, 1, 3.0, Some(1.0 / 3.0))];
        assert_eq!(found, expected);
    }

    #[test]
    fn what_proves_nothing_is_not_part_of_the_score() {
        let about = MutationAbout {
            scenario: "s".into(),
            system: "robot".into(),
            tests: 2,
            failing: 0,
            seed: 0,
            matrix: false,
            models: false,
            operators: Vec::new(),
        };
        let report = |fates: &[MutantFate]| {
            let outcomes = fates.iter().map(|fate| outcome(*fate, Vec::new())).collect();
            let sentinels = vec![outcome(MutantFate::NotDistinguished, Vec::new())];
            add_up(about.clone(), &MutationPlan::default(), None, sentinels, outcomes)
        };
        let some = report(&[
            MutantFate::Killed,
            MutantFate::NotReached,
            MutantFate::Survived,
            MutantFate::Killed,
            MutantFate::NotDistinguished,
            MutantFate::Permissive,
            MutantFate::Equivalent,
        ]);
        assert_eq!((some.score, some.interrupted), (Some(0.5), false));
        assert_eq!(some.unmeasured().collect::<Vec<_>>(), ["robot.py"]);
        let none = report(&[MutantFate::NotDistinguished, MutantFate::NotRun]);
        assert_eq!((none.score, none.interrupted), (None, true));
    }
}
