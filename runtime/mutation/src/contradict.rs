//! Holds recordings of the code against mutants of its model.

use hrdsl_campaign::{ListedMutant, SingleRun, StopFlag};
use hrdsl_conformance::{ConformanceChecker, ConformanceOptions};
use hrdsl_ir::Program;
use hrdsl_judge::recorded_run;
use hrdsl_results::{ConformanceVerdict, MutantFate, NoticedTest, RunEnd, TestResult, TraceJudgement};
use hrdsl_trace::Trace;

use crate::{
    models::ModelMutant,
    oracle::noticed_by,
    outcome::MutantOutcome,
    plan::{MutationPlan, PlannedMutant},
};

/// What mutants of models are held against.
pub struct RecordedRuns<'a> {
    program: &'a Program,
    options: &'a ConformanceOptions,
    originals: &'a [SingleRun],
    /// What each recording has, and how it ended; `None` of one that cannot be read.
    traces: Vec<Option<(Trace, RunEnd)>>,
}

impl<'a> RecordedRuns<'a> {
    /// The runs of the code as it is; `options` say how recordings show what it did.
    #[must_use]
    pub fn new(program: &'a Program, options: &'a ConformanceOptions, originals: &'a [SingleRun]) -> Self {
        let read = |run: &SingleRun| recorded_run(program, run.recording.as_bytes(), false).ok();
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
                    MutantOutcome::not_run(planned.mutant.clone(), fate, planned.tests.len())
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
        let fate = MutantFate::NotDistinguished;
        let mut outcome = MutantOutcome::not_run(mutant.mutant.clone(), fate, tests.len());
        for at in tests {
            let (Some(original), Some(Some(trace))) = (self.originals.get(*at), self.traces.get(*at)) else {
                continue;
            };
            let (result, before) = (&original.result, &original.result.judgement.conformance);
            let now = self.verdicts(&changed, trace);
            outcome.ran += 1;
            *outcome.simulated.entry(result.method).or_default() += result.duration;
            let oracles = noticed_by(&only(before), &only(&now));
            if !oracles.is_empty() {
                outcome.fate = MutantFate::Killed;
                let (test, method) = (result.name.clone(), result.method);
                outcome.noticed.push(NoticedTest { test, oracles, error: None, method });
                if !all {
                    break;
                }
            } else if outcome.fate == MutantFate::NotDistinguished && now != *before {
                outcome.fate = MutantFate::Survived;
            }
        }
        outcome
    }

    fn verdicts(&self, program: &Program, (trace, ended): &(Trace, RunEnd)) -> Vec<ConformanceVerdict> {
        let mut checker = ConformanceChecker::new(program, self.options);
        trace.replay(&mut checker);
        let mut verdicts = checker.finish(*ended);
        if *ended == RunEnd::Error {
            verdicts.iter_mut().for_each(ConformanceVerdict::break_off);
        }
        verdicts
    }
}

/// A result that says nothing but this.
fn only(conformance: &[ConformanceVerdict]) -> TestResult {
    let judgement = TraceJudgement { conformance: conformance.to_vec(), ..TraceJudgement::default() };
    TestResult { judgement, ..TestResult::default() }
}
