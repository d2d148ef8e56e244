//! What can notice a mutant, and whether it does in a test.

use hrdsl_results::{ConformanceOutcome, MutantOracle, PredictionOutcome, TestResult, VerdictOutcome};

/// The oracles by which a mutant comes off worse than the original in the same test, in order. What the original is blamed for already
/// notices nothing.
#[must_use]
pub fn noticed_by(original: &TestResult, mutant: &TestResult) -> Vec<MutantOracle> {
    let mut oracles = Vec::new();
    let verdicts = original.judgement.verdicts.iter().zip(&mutant.judgement.verdicts);
    for (before, now) in verdicts {
        if now.outcome == VerdictOutcome::Fail && before.outcome != VerdictOutcome::Fail {
            oracles.push(MutantOracle::Requirement(now.requirement.clone()));
        }
    }
    let leaves = |test: &TestResult| {
        test.prediction.as_ref().is_some_and(|verdict| verdict.outcome == PredictionOutcome::Left)
    };
    if leaves(mutant) && !leaves(original) {
        oracles.push(MutantOracle::Prediction);
    }
    let departs = |test: &TestResult, model: &str| {
        let own = test.judgement.conformance.iter().filter(|verdict| verdict.model == model);
        own.into_iter().any(|verdict| verdict.outcome == ConformanceOutcome::Departs)
    };
    let models = mutant.judgement.conformance.iter().map(|verdict| verdict.model.as_str());
    if models.into_iter().any(|model| departs(mutant, model) && !departs(original, model)) {
        oracles.push(MutantOracle::Conformance);
    }
    if mutant.error.is_some() && original.error.is_none() {
        oracles.push(MutantOracle::Error);
    }
    oracles
}

#[cfg(test)]
mod tests {
    use hrdsl_results::{ConformanceVerdict, PredictionVerdict, TraceJudgement, VerdictResult};

    use super::*;

    fn test(verdict: VerdictOutcome, departs: bool) -> TestResult {
        let verdict = VerdictResult {
            requirement: "R1".into(),
            outcome: verdict,
            triggered: 1,
            failures: 0,
            failure: None,
            worst_margin: None,
            unvalued: None,
        };
        let outcome = if departs { ConformanceOutcome::Departs } else { ConformanceOutcome::Conforms };
        let conformance = ConformanceVerdict { model: "M".into(), outcome, departure: None, why: None };
        let judgement = TraceJudgement {
            verdicts: vec![verdict],
            conformance: vec![conformance],
            ..TraceJudgement::default()
        };
        TestResult { judgement, ..TestResult::default() }
    }

    fn words(original: &TestResult, mutant: &TestResult) -> String {
        let oracles: Vec<String> = noticed_by(original, mutant).iter().map(ToString::to_string).collect();
        oracles.join(", ")
    }

    #[test]
    fn only_what_becomes_worse_notices() {
        let (good, bad) = (test(VerdictOutcome::Pass, false), test(VerdictOutcome::Fail, true));
        assert_eq!(words(&good, &bad), "requirement R1, conformance");
        assert_eq!(words(&bad, &bad), "", "the original is no better");
        assert_eq!(words(&bad, &good), "", "the mutant is better");
        let silent = test(VerdictOutcome::Vacuous, false);
        assert_eq!(words(&good, &silent), "", "nobody is told of a vacuous verdict by a failing command");
    }

    #[test]
    fn a_run_that_breaks_off_is_noticed_by_its_error_alone() {
        let mut original = test(VerdictOutcome::Pass, false);
        let kept = PredictionVerdict { outcome: PredictionOutcome::Kept, ..PredictionVerdict::broken_off() };
        original.prediction = Some(kept.clone());
        let mut mutant = original.clone();
        mutant.break_off("the program ended with exit code 1".into());
        assert_eq!(words(&original, &mutant), "error");
        mutant = original.clone();
        mutant.prediction = Some(PredictionVerdict { outcome: PredictionOutcome::Left, ..kept });
        assert_eq!(words(&original, &mutant), "prediction");
    }
}
