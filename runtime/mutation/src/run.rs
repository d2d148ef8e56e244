//! Runs the tests: on the original, on the sentinels, on the mutants.

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    time::Duration,
};

use hrdsl_campaign::{CampaignSetup, CompiledMutants, LaunchMutant, ListedMutant, SingleRun, SingleRunner};
use hrdsl_ir::test::Test;
use hrdsl_results::{MutantFate, MutantOracle, NoticedTest, TestMethod};

use crate::{
    difference::first_difference,
    oracle::noticed_by,
    outcome::MutantOutcome,
    plan::{MutationPlan, PlannedMutant},
};

/// A program that thinks longer than this many times the processor time of the slowest test has hung.
const TIMES_SLOWER: u32 = 10;
/// No mutant is given less between two requests.
const LEAST_BUDGET: Duration = Duration::from_secs(1);

/// Runs of a mutant that survived, in which requirements are tried.
const MOST_OTHER_RUNS: usize = 8;
/// Bytes of their recordings; the first is kept, whatever its length.
const MOST_KEPT: usize = 4 << 20;

/// What mutants are run with.
pub struct MutationCampaign<'a> {
    /// That of the original; no coverage need be measured.
    pub campaign: CampaignSetup<'a>,
    pub tests: &'a [Test],
    /// What each test comes to on the original, in the order of the tests.
    pub originals: &'a [SingleRun],
    /// The mutants of each file, compiled.
    pub codes: &'a BTreeMap<String, CompiledMutants>,
    /// Whether each mutant is run against all tests that reach it, instead of until the first that notices it.
    pub matrix: bool,
}

/// Runs the tests on the code as it is; `on_done` is called as each ends. `None`: it was interrupted.
///
/// # Errors
/// Only if what the programs need to know cannot be kept for them.
pub fn run_originals(
    campaign: &CampaignSetup<'_>,
    tests: &[Test],
    on_done: impl Fn(&SingleRun) + Sync,
) -> Result<Option<Vec<SingleRun>>, String> {
    let runs = in_parallel(campaign, tests, |runner, test| {
        let run = runner.run(test, None)?;
        on_done(&run);
        Some(run)
    })?;
    Ok(runs.into_iter().collect())
}

/// Runs the tests on the code as it is once more, each file put in its own place as a mutant is, without code coverage. Gives each file that
/// does not do the same as before, with a test in which it does not: where that is so, another run of a mutant says nothing. `on_done` is called
/// as each test ends.
///
/// # Errors
/// As [`run_originals`].
pub fn run_controls<'c>(
    setup: &'c MutationCampaign<'_>,
    on_done: impl Fn() + Sync,
) -> Result<BTreeMap<&'c str, &'c str>, String> {
    let of_file = |(file, codes): (&'c String, &'c CompiledMutants)| {
        let tests = setup.tests.iter().zip(setup.originals);
        let is_there = |run: &SingleRun| {
            let own = run.executed.iter().find(|own| own.file == *file);
            own.is_none_or(|own| !own.executed.is_empty())
        };
        let tests = tests.filter(move |(_, original)| is_there(original));
        tests.map(move |(test, original)| (file.as_str(), codes.launch_original(), test, original))
    };
    let all: Vec<_> = setup.codes.iter().flat_map(of_file).collect();
    let unlike = in_parallel(&setup.campaign, &all, |runner, (file, launch, test, original)| {
        let run = runner.run(test, Some(launch))?;
        on_done();
        Some((run.recording != original.recording).then_some((*file, test.name.as_str())))
    })?;
    Ok(unlike.into_iter().flatten().flatten().rev().collect())
}

/// Lets each of these files raise at once, and runs the tests until one notices it; `on_done` is called as each file is done.
///
/// # Errors
/// As [`run_originals`].
pub fn run_sentinels(
    setup: &MutationCampaign<'_>,
    plan: &MutationPlan,
    on_done: impl Fn(&MutantOutcome) + Sync,
) -> Result<Vec<MutantOutcome>, String> {
    let files: BTreeSet<&str> = plan.mutants.iter().map(|planned| planned.mutant.file.as_str()).collect();
    let sentinel = |file: &&str| PlannedMutant {
        mutant: ListedMutant::sentinel(file),
        known: None,
        tests: plan.order.clone(),
    };
    let sentinels: Vec<PlannedMutant> = files.iter().map(sentinel).collect();
    run_mutants(setup, &sentinels, false, on_done)
}

/// Runs the mutants of a plan; `on_done` is called as each is done. What was not known when everything was to end is not run.
///
/// # Errors
/// As [`run_originals`].
pub fn run_plan(
    setup: &MutationCampaign<'_>,
    plan: &MutationPlan,
    on_done: impl Fn(&MutantOutcome) + Sync,
) -> Result<Vec<MutantOutcome>, String> {
    run_mutants(setup, &plan.mutants, setup.matrix, on_done)
}

fn run_mutants(
    setup: &MutationCampaign<'_>,
    mutants: &[PlannedMutant],
    all: bool,
    on_done: impl Fn(&MutantOutcome) + Sync,
) -> Result<Vec<MutantOutcome>, String> {
    let limits = hrdsl_campaign::ProgramLimits { budget: budget(setup), ..setup.campaign.limits };
    let campaign =
        CampaignSetup { limits, keep: None, replays: false, clocks: None, ..setup.campaign.clone() };
    let outcomes = in_parallel(&campaign, mutants, |runner, planned| {
        let outcome = match planned.known {
            Some(fate) => MutantOutcome::not_run(planned.mutant.clone(), fate, 0),
            None => run_one(setup, planned, all, runner)?,
        };
        on_done(&outcome);
        Some(outcome)
    })?;
    let known = outcomes.into_iter().zip(mutants).map(|(outcome, planned)| {
        let not_run = || {
            let fate = planned.known.unwrap_or(MutantFate::NotRun);
            MutantOutcome::not_run(planned.mutant.clone(), fate, planned.tests.len())
        };
        outcome.unwrap_or_else(not_run)
    });
    Ok(known.collect())
}

/// What a mutant may think between two requests: what it is to be, unless the original needs far less for whole tests.
fn budget(setup: &MutationCampaign<'_>) -> Duration {
    let most = setup.originals.iter().map(|run| run.cpu).max().unwrap_or_default();
    setup.campaign.limits.budget.min(LEAST_BUDGET.max(most * TIMES_SLOWER))
}

/// Runs one mutant. `None`: everything is to end.
fn run_one(
    setup: &MutationCampaign<'_>,
    planned: &PlannedMutant,
    all: bool,
    runner: &mut SingleRunner<'_>,
) -> Option<MutantOutcome> {
    let mutant = &planned.mutant;
    let launch: Option<LaunchMutant> = setup.codes.get(&mutant.file).map(|codes| codes.launch(mutant.number));
    let mut outcome =
        MutantOutcome::not_run(mutant.clone(), MutantFate::NotDistinguished, planned.tests.len());
    let tests = planned.tests.iter().filter_map(|at| {
        let (test, original) = (setup.tests.get(*at)?, setup.originals.get(*at)?);
        Some((*at, test, original))
    });
    for (at, test, original) in tests {
        let run = runner.run(test, launch.as_ref())?;
        let method: TestMethod = run.result.method;
        outcome.ran += 1;
        *outcome.simulated.entry(method).or_default() += run.result.duration;
        let oracles = noticed_by(&original.result, &run.result);
        if !oracles.is_empty() {
            outcome.fate = MutantFate::Killed;
            let error = run.result.error.as_ref().filter(|_| oracles.contains(&MutantOracle::Error));
            let error = error.map(|error| shortened(error));
            outcome.noticed.push(NoticedTest { test: run.result.name.clone(), oracles, error, method });
            if !all {
                break;
            }
        } else if outcome.fate != MutantFate::Killed && run.recording != original.recording {
            outcome.fate = MutantFate::Survived;
            keep(&mut outcome.other_runs, (at, run.recording));
        }
    }
    if outcome.fate != MutantFate::Survived {
        // What another test saw matters no more, once one has noticed it.
        outcome.other_runs.clear();
    }
    if let Some((at, recording)) = outcome.other_runs.first() {
        let program = setup.campaign.program;
        outcome.difference = setup
            .originals
            .get(*at)
            .and_then(|run| first_difference(program, &run.result.name, (&run.recording, recording)));
    }
    Some(outcome)
}

/// Keeps a run of a mutant, for requirements to be tried on it, unless there are enough.
fn keep(runs: &mut Vec<(usize, String)>, run: (usize, String)) {
    let size: usize = runs.iter().map(|(_, recording)| recording.len()).sum();
    if runs.is_empty() || runs.len() < MOST_OTHER_RUNS && size + run.1.len() <= MOST_KEPT {
        runs.push(run);
    }
}

/// The first line of an error, and the last, which says what was raised.
fn shortened(error: &str) -> String {
    let mut lines = error.lines().map(str::trim).filter(|line| !line.is_empty());
    let first = lines.next().unwrap_or_default().trim_end_matches(':');
    lines.next_back().map_or_else(|| first.to_owned(), |last| format!("{first}: {last}"))
}

/// Does something with each, in as many threads as the campaign has workers, each with a runner of its own. What gives `None` ends its
/// worker.
fn in_parallel<T: Sync, R: Send>(
    campaign: &CampaignSetup<'_>,
    all: &[T],
    act: impl Fn(&mut SingleRunner<'_>, &T) -> Option<R> + Sync,
) -> Result<Vec<Option<R>>, String> {
    let next = AtomicUsize::new(0);
    let done: Mutex<Vec<(usize, R)>> = Mutex::default();
    let work = || -> Result<(), String> {
        let mut runner = SingleRunner::new(campaign)?;
        loop {
            let at = next.fetch_add(1, Ordering::Relaxed);
            let Some(item) = all.get(at).filter(|_| !campaign.stop.is_set()) else { return Ok(()) };
            let Some(result) = act(&mut runner, item) else { return Ok(()) };
            done.lock().unwrap_or_else(PoisonError::into_inner).push((at, result));
        }
    };
    let faults: Vec<Result<(), String>> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..campaign.jobs.max(1)).map(|_| scope.spawn(work)).collect();
        let joined = workers.into_iter().map(|worker| worker.join());
        joined.map(|end| end.unwrap_or_else(|panic| std::panic::resume_unwind(panic))).collect()
    });
    faults.into_iter().collect::<Result<(), String>>()?;
    let mut results: Vec<Option<R>> = all.iter().map(|_| None).collect();
    for (at, result) in done.into_inner().unwrap_or_else(PoisonError::into_inner) {
        if let Some(place) = results.get_mut(at) {
            *place = Some(result);
        }
    }
    Ok(results)
}
