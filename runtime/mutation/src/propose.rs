//! Requirements that would notice what survived: each is tried before it is proposed.

use std::collections::{BTreeMap, BTreeSet};

use hrdsl_campaign::SingleRun;
use hrdsl_conformance::ConformanceOptions;
use hrdsl_ir::Program;
use hrdsl_judge::{judge_recording, recorded_run};
use hrdsl_results::{ProposedRequirement, TestName, VerdictOutcome, VerdictResult};

use crate::{
    candidates::{BrokenFacts, Candidate},
    common::CommonFacts,
    facts::RunFacts,
    outcome::MutantOutcome,
};

/// What the names of requirements begin with that are tried.
const PREFIX: &str = "Proposed_";
/// Patterns that are tried at once.
const AT_ONCE: usize = 64;
/// Patterns that are tried for one mutant, of all its runs.
const MOST_TRIED: usize = 64;
/// Proposals for one mutant.
const MOST: usize = 3;

/// Gives each mutant that survived the patterns of requirements that would notice it: they hold in all runs of the original, hold not only
/// because nothing triggers them, and fail in one of the mutant's other runs. `compile` is the scenario with more text at its end, `None` if that
/// has errors.
pub fn propose(
    program: &Program,
    options: &ConformanceOptions,
    originals: &[SingleRun],
    outcomes: &mut [MutantOutcome],
    compile: &dyn Fn(&str) -> Option<Program>,
) {
    let names: Vec<&TestName> = originals.iter().map(|run| &run.result.name).collect();
    let originals: Vec<&str> =
        originals.iter().filter(|run| run.result.error.is_none()).map(|run| run.recording.as_str()).collect();
    let candidates = candidates_of(program, &originals, outcomes);
    let mut all: Vec<&str> = candidates.values().flatten().map(|one| one.pattern.as_str()).collect();
    all.sort_unstable();
    all.dedup();
    let mut trials = Vec::new();
    for patterns in all.chunks(AT_ONCE) {
        compiled(patterns, compile, &mut trials);
    }
    for trial in &mut trials {
        trial.keep_what_holds(&originals, options);
    }
    for (at, wanted) in &candidates {
        let Some(outcome) = outcomes.get_mut(*at) else { continue };
        let mut found: Vec<(ProposedRequirement, &str)> = Vec::new();
        for (test, recording) in &outcome.other_runs {
            let Some(test) = names.get(*test) else { continue };
            let left: Vec<&Candidate> = wanted
                .iter()
                .filter(|one| found.iter().all(|(proposal, _)| proposal.pattern != one.pattern))
                .collect();
            let asked = trials.iter().filter(|trial| trial.has_one_of(&left));
            let broken: BTreeMap<&str, f64> =
                asked.flat_map(|trial| trial.failing(recording, options)).collect();
            found.extend(left.into_iter().filter_map(|one| {
                let (pattern, time) = (one.pattern.clone(), *broken.get(one.pattern.as_str())?);
                Some((ProposedRequirement { pattern, time, test: (*test).clone() }, one.topic.as_str()))
            }));
        }
        outcome.proposals = chosen(found);
    }
}

/// What notices first is nearest to the fault; of those at once the narrowest. What says about the same as another comes after it.
fn chosen(mut found: Vec<(ProposedRequirement, &str)>) -> Vec<ProposedRequirement> {
    found.sort_by(|(a, _), (b, _)| a.time.total_cmp(&b.time));
    let mut topics: BTreeSet<&str> = BTreeSet::new();
    let (mut first, further): (Vec<_>, Vec<_>) =
        found.into_iter().partition(|(_, topic)| topics.insert(topic));
    first.extend(further);
    first.truncate(MOST);
    first.into_iter().map(|(proposal, _)| proposal).collect()
}

/// What may be broken in the runs of each mutant that survived, by the place of the mutant.
fn candidates_of(
    program: &Program,
    originals: &[&str],
    outcomes: &[MutantOutcome],
) -> BTreeMap<usize, Vec<Candidate>> {
    let survivors = || outcomes.iter().enumerate().filter(|(_, outcome)| !outcome.other_runs.is_empty());
    if survivors().next().is_none() {
        return BTreeMap::new();
    }
    let facts = |text: &str| {
        recorded_run(program, text.as_bytes(), false).ok().map(|(trace, _)| RunFacts::of(&trace))
    };
    let common = CommonFacts::of(program, originals.iter().filter_map(|text| facts(text)).collect());
    let broken = |text: &str| {
        let run = facts(text).map(|facts| common.formed(facts));
        run.map_or_else(Vec::new, |run| BrokenFacts { program, common: &common, run: &run }.candidates())
    };
    let of_all = |(at, outcome): (usize, &MutantOutcome)| {
        let mut all: Vec<Candidate> = Vec::new();
        for candidate in outcome.other_runs.iter().flat_map(|(_, text)| broken(text)) {
            if all.len() < MOST_TRIED && !all.contains(&candidate) {
                all.push(candidate);
            }
        }
        (at, all)
    };
    survivors().map(of_all).collect()
}

/// A scenario whose requirements are patterns to try.
struct RequirementTrial {
    program: Program,
    /// In the order of the requirements; `None` of one that does not hold.
    patterns: Vec<Option<String>>,
}

/// Compiles patterns, and leaves out those that are errors.
fn compiled(
    patterns: &[&str],
    compile: &dyn Fn(&str) -> Option<Program>,
    trials: &mut Vec<RequirementTrial>,
) {
    let lines = patterns.iter().enumerate();
    let text: String =
        lines.map(|(at, pattern)| format!("\nrequire {PREFIX}{at} safety {pattern}")).collect();
    if let Some(mut program) = compile(&(text + "\n")) {
        program.monitors.retain(|monitor| monitor.name.starts_with(PREFIX));
        // Nothing else is asked: no automaton plays the system.
        program.automata.iter_mut().for_each(|automaton| automaton.actor = None);
        if program.monitors.len() == patterns.len() {
            trials.push(RequirementTrial {
                program,
                patterns: patterns.iter().map(|pattern| Some((*pattern).to_owned())).collect(),
            });
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
                    VerdictOutcome::Vacuous => {}
                    VerdictOutcome::Inconclusive | VerdictOutcome::Fail | VerdictOutcome::Error => {
                        *pattern = None;
                    }
                }
            }
        }
        for (pattern, passed) in self.patterns.iter_mut().zip(passed) {
            if !passed {
                *pattern = None;
            }
        }
    }

    /// Whether one of these is a pattern of this, and holds on the original.
    fn has_one_of(&self, candidates: &[&Candidate]) -> bool {
        self.patterns.iter().flatten().any(|pattern| candidates.iter().any(|one| one.pattern == *pattern))
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
