//! Requirements that would notice what survived: each is tried before it is proposed.

use std::collections::BTreeMap;

use hrdsl_campaign::SingleRun;
use hrdsl_conformance::ConformanceOptions;
use hrdsl_ir::Program;
use hrdsl_judge::{judge_recording, recorded_run};
use hrdsl_results::{ProposedRequirement, VerdictOutcome, VerdictResult};

use crate::{
    facts::{CommonFacts, RunFacts},
    outcome::MutantOutcome,
};

/// What the names of requirements begin with that are tried.
const PREFIX: &str = "Proposed_";
/// Patterns that are tried at once.
const AT_ONCE: usize = 64;
/// Proposals for one mutant.
const MOST: usize = 3;

/// Gives each mutant that survived the patterns of requirements that would notice it: they hold in all runs of the original, hold not only
/// because nothing triggers them, and fail in the mutant's first other run. `compile` is the scenario with more text at its end, `None` if that
/// has errors.
pub fn propose(
    program: &Program,
    options: &ConformanceOptions,
    originals: &[SingleRun],
    outcomes: &mut [MutantOutcome],
    compile: &dyn Fn(&str) -> Option<Program>,
) {
    let originals: Vec<&str> =
        originals.iter().filter(|run| run.result.error.is_none()).map(|run| run.recording.as_str()).collect();
    let candidates = candidates(program, &originals, outcomes);
    let mut all: Vec<String> = candidates.values().flatten().cloned().collect();
    all.sort();
    all.dedup();
    let mut trials = Vec::new();
    for patterns in all.chunks(AT_ONCE) {
        compiled(patterns, compile, &mut trials);
    }
    for trial in &mut trials {
        trial.keep_what_holds(&originals, options);
    }
    for (at, wanted) in candidates {
        let Some(outcome) = outcomes.get_mut(at) else { continue };
        let Some((_, recording)) = &outcome.other_run else { continue };
        let broken: BTreeMap<&str, f64> =
            trials.iter().flat_map(|trial| trial.failing(recording, options)).collect();
        let found = wanted.into_iter().filter_map(|pattern| {
            let time = *broken.get(pattern.as_str())?;
            Some(ProposedRequirement { pattern, time })
        });
        let mut found: Vec<ProposedRequirement> = found.collect();
        // What notices first is nearest to the fault; of those at once the narrowest.
        found.sort_by(|a, b| a.time.total_cmp(&b.time));
        found.truncate(MOST);
        outcome.proposals = found;
    }
}

/// What may be broken in each run of a mutant that survived, by the place of the mutant.
fn candidates(
    program: &Program,
    originals: &[&str],
    outcomes: &[MutantOutcome],
) -> BTreeMap<usize, Vec<String>> {
    let survivors: Vec<(usize, &str)> = outcomes
        .iter()
        .enumerate()
        .filter_map(|(at, outcome)| Some((at, outcome.other_run.as_ref()?.1.as_str())))
        .collect();
    if survivors.is_empty() {
        return BTreeMap::new();
    }
    let facts = |text: &str| {
        recorded_run(program, text.as_bytes(), false).ok().map(|(trace, _)| RunFacts::of(&trace))
    };
    let runs: Vec<RunFacts> = originals.iter().filter_map(|text| facts(text)).collect();
    let common = CommonFacts::of(program, &runs);
    let broken = |text: &str| facts(text).map_or_else(Vec::new, |run| common.broken_by(program, &run));
    survivors.into_iter().map(|(at, text)| (at, broken(text))).collect()
}

/// A scenario whose requirements are patterns to try.
struct RequirementTrial {
    program: Program,
    /// In the order of the requirements; `None` of one that does not hold.
    patterns: Vec<Option<String>>,
}

/// Compiles patterns, and leaves out those that are errors.
fn compiled(
    patterns: &[String],
    compile: &dyn Fn(&str) -> Option<Program>,
    trials: &mut Vec<RequirementTrial>,
) {
    let lines = patterns.iter().enumerate();
    let text: String =
        lines.map(|(at, pattern)| format!("\nrequire {PREFIX}{at} safety {pattern}")).collect();
    if let Some(mut program) = compile(&(text + "\n")) {
        program.monitors.retain(|monitor| monitor.name.starts_with(PREFIX));
        if program.monitors.len() == patterns.len() {
            trials.push(RequirementTrial { program, patterns: patterns.iter().cloned().map(Some).collect() });
        }
        return;
    }
    let (first, second) = patterns.split_at(patterns.len() / 2);
    if !first.is_empty() {
        compiled(first, compile, trials);
        compiled(second, compile, trials);
    }
}

impl RequirementTrial {
    fn keep_what_holds(&mut self, originals: &[&str], options: &ConformanceOptions) {
        let mut passed = vec![false; self.patterns.len()];
        for recording in originals {
            let verdicts = self.judged(recording, options);
            if verdicts.is_empty() {
                self.patterns.fill(None);
            }
            for ((pattern, passed), verdict) in self.patterns.iter_mut().zip(&mut passed).zip(verdicts) {
                match verdict.outcome {
                    VerdictOutcome::Pass => *passed = true,
                    VerdictOutcome::Vacuous | VerdictOutcome::Inconclusive => {}
                    VerdictOutcome::Fail | VerdictOutcome::Error => *pattern = None,
                }
            }
        }
        for (pattern, passed) in self.patterns.iter_mut().zip(passed) {
            if !passed {
                *pattern = None;
            }
        }
    }

    /// The patterns that hold on the original and fail here, with the time of the first failure in seconds.
    fn failing(&self, recording: &str, options: &ConformanceOptions) -> Vec<(&str, f64)> {
        let verdicts = self.judged(recording, options);
        let failing = self.patterns.iter().zip(&verdicts).filter_map(|(pattern, verdict)| {
            let failure = verdict.failure.as_ref().filter(|_| verdict.outcome == VerdictOutcome::Fail)?;
            Some((pattern.as_deref()?, failure.time))
        });
        failing.collect()
    }

    /// The verdicts on a recording, in the order of the requirements; none, if it cannot be read.
    fn judged(&self, recording: &str, options: &ConformanceOptions) -> Vec<VerdictResult> {
        let judged = judge_recording(&self.program, recording.as_bytes(), true, options);
        judged.map_or_else(|_| Vec::new(), |judged| judged.judgement.verdicts)
    }
}
