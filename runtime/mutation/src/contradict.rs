//! Holds recordings of the code against mutants of its model.

use hrdsl_campaign::{ListedMutant, SingleRun, StopFlag};
use hrdsl_conformance::{AllowanceDifference, ConformanceChecker, ConformanceOptions, ModelTrail};
use hrdsl_ir::Program;
use hrdsl_judge::recorded_run;
use hrdsl_results::{
    ConformanceOutcome, ConformanceVerdict, MutantFate, NoticedTest, RunEnd, TestResult, TraceJudgement,
};
use hrdsl_trace::Trace;

use crate::{
    models::ModelMutant,
    oracle::noticed_by,
    outcome::MutantOutcome,
    plan::{MutationPlan, PlannedMutant},
};

type FollowedRecording = ((Trace, RunEnd), Vec<ModelTrail>);

/// What mutants of models are held against.
pub struct RecordedRuns<'a> {
    program: &'a Program,
    options: &'a ConformanceOptions,
    originals: &'a [SingleRun],
    /// What each recording has and how it ended, and what it shows of the models as they are; `None` of one that cannot be read.
    traces: Vec<Option<FollowedRecording>>,
}

impl<'a> RecordedRuns<'a> {
    /// The runs of the code as it is; `options` say how recordings show what it did.
    #[must_use]
    pub fn new(program: &'a Program, options: &'a ConformanceOptions, originals: &'a [SingleRun]) -> Self {
        let read = |run: &SingleRun| {
            let trace = recorded_run(program, run.recording.as_bytes(), false).ok()?;
            let (_, trails) = followed((program, program), options, &trace);
            Some((trace, trails))
        };
        let traces = originals.iter().map(read).collect();
        Self { program, options, originals, traces }
    }

    /// Holds the runs against the mutants of a plan, one after the other, until the first that contradicts each, or `all`. No code runs.
    /// `on_done` is called as each is done; what was not known when everything was to end is not run.
    pub fn contradict(
        &self,
        plan: &MutationPlan,
        mutants: &[ModelMutant],
        (all, stop): (bool, &StopFlag),
        on_done: impl Fn(&MutantOutcome),
    ) -> Vec<MutantOutcome> {
        let outcome = |planned: &PlannedMutant| {
            let found = |listed: &ListedMutant| mutants.iter().find(|mutant| mutant.mutant == *listed);
            let outcome = match (planned.known, found(&planned.mutant)) {
                (None, Some(mutant)) if !stop.is_set() => self.outcome(mutant, &planned.tests, all),
                (known, _) => {
                    let fate = known.unwrap_or(MutantFate::NotRun);
                    MutantOutcome::not_run(planned.mutant.clone(), fate, 0)
                }
            };
            on_done(&outcome);
            outcome
        };
        plan.mutants.iter().map(outcome).collect()
    }

    /// What becomes of one mutant.
    #[must_use]
    pub fn outcome(&self, mutant: &ModelMutant, tests: &[usize], all: bool) -> MutantOutcome {
        let changed = mutant.applied(self.program);
        let mut outcome = MutantOutcome::not_run(mutant.mutant.clone(), MutantFate::NotReached, 0);
        let mut seen = AllowanceDifference::default();
        for at in tests {
            let (Some(original), Some(Some((trace, own)))) = (self.originals.get(*at), self.traces.get(*at))
            else {
                continue;
            };
            let (result, before) = (&original.result, &original.result.judgement.conformance);
            let (now, trails) = followed((self.program, &changed), self.options, trace);
            outcome.ran += 1;
            *outcome.simulated.entry(result.method).or_default() += result.duration;
            let visits = |part| own.iter().chain(&trails).any(|trail| trail.visits(part));
            outcome.reached += usize::from(mutant.part().is_none_or(visits));
            let oracles = noticed_by(&only(before), &only(&now));
            if !oracles.is_empty() {
                outcome.fate = MutantFate::Killed;
                let (test, method) = (result.name.clone(), result.method);
                outcome.noticed.push(NoticedTest { test, oracles, error: None, method });
                if !all {
                    break;
                }
            }
            let allowances = trails.iter().zip(own).map(|(trail, own)| trail.against(own));
            for difference in allowances.chain(now.iter().zip(before).map(judged_otherwise)) {
                seen.less |= difference.less;
                seen.more |= difference.more;
            }
        }
        if outcome.fate != MutantFate::Killed {
            outcome.fate = fate_of(outcome.reached, seen);
        }
        outcome
    }
}

/// What becomes of a mutant that no run contradicts.
fn fate_of(reached: usize, seen: AllowanceDifference) -> MutantFate {
    match seen {
        _ if reached == 0 => MutantFate::NotReached,
        AllowanceDifference { less: true, .. } => MutantFate::Survived,
        AllowanceDifference { more: true, .. } => MutantFate::Permissive,
        AllowanceDifference { less: false, more: false } => MutantFate::NotDistinguished,
    }
}

/// What a verdict of a mutant says of what it allows, against that of the model as it is. One that is inconclusive allows who knows what.
fn judged_otherwise((now, before): (&ConformanceVerdict, &ConformanceVerdict)) -> AllowanceDifference {
    let is_other = now.outcome != before.outcome;
    let conforms = now.outcome == ConformanceOutcome::Conforms;
    AllowanceDifference { less: is_other && !conforms, more: is_other && conforms }
}

/// The verdicts on a recording by the models of a program, with their trails: as far ahead as those of the original speak of.
fn followed(
    (original, program): (&Program, &Program),
    options: &ConformanceOptions,
    (trace, ended): &(Trace, RunEnd),
) -> (Vec<ConformanceVerdict>, Vec<ModelTrail>) {
    let mut checker = ConformanceChecker::trailing(program, options, original);
    trace.replay(&mut checker);
    let (mut verdicts, trails): (Vec<_>, Vec<_>) = checker.finish_trails(*ended).into_iter().unzip();
    if *ended == RunEnd::Error {
        verdicts.iter_mut().for_each(ConformanceVerdict::break_off);
    }
    (verdicts, trails)
}

/// A result that says nothing but this.
fn only(conformance: &[ConformanceVerdict]) -> TestResult {
    let judgement = TraceJudgement { conformance: conformance.to_vec(), ..TraceJudgement::default() };
    TestResult { judgement, ..TestResult::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn less_counts_against_the_tests_and_more_alone_does_not() {
        let seen = |less, more| AllowanceDifference { less, more };
        let fates = [seen(true, false), seen(true, true), seen(false, true), seen(false, false)];
        assert_eq!(
            fates.map(|seen| fate_of(1, seen)),
            [
                MutantFate::Survived,
                MutantFate::Survived,
                MutantFate::Permissive,
                MutantFate::NotDistinguished
            ]
        );
        assert_eq!(fate_of(0, seen(true, true)), MutantFate::NotReached);
    }

    #[test]
    fn a_verdict_that_becomes_another_says_what_is_allowed() {
        let verdict = |outcome| ConformanceVerdict {
            outcome,
            ..ConformanceVerdict::inconclusive("Lamp".into(), String::new())
        };
        let [conforms, departs, unknown] =
            [ConformanceOutcome::Conforms, ConformanceOutcome::Departs, ConformanceOutcome::Inconclusive]
                .map(verdict);
        let less = AllowanceDifference { less: true, more: false };
        let more = AllowanceDifference { less: false, more: true };
        assert_eq!(judged_otherwise((&departs, &departs)), AllowanceDifference::default());
        assert_eq!(judged_otherwise((&unknown, &conforms)), less);
        assert_eq!(judged_otherwise((&conforms, &departs)), more);
    }
}
