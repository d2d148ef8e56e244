//! All tests of a campaign, in parallel: each is run, judged, and handed on before the next is counted.

use std::{
    path::{Path, PathBuf},
    sync::{
        Mutex,
        atomic::{AtomicUsize, Ordering},
    },
    time::Duration,
};

use hrdsl_coverage::Collector;
use hrdsl_ir::{Program, system::System, test::Test};
use hrdsl_monitor::{Checker, Outcome, Verdict};
use hrdsl_sut::{Answer, Launch, Needs, Process, Reply, SutError};
pub use hrdsl_sut::{Hooked, Preparation, PythonEnv};
use hrdsl_trace::{Trace, print, record};

use crate::{
    harness::{Ended, Fault, Harness, Player, ProgramPlayer, Run, ScriptPlayer, Stage, SutFault},
    results::{self, Failure, Ratios, TestResult, VerdictResult, WitnessStep},
    testgen,
};

/// How much of the program's output is kept, in bytes for each stream.
const OUTPUT_LIMIT: usize = 64 * 1024;
/// Wall-clock time that the program has to end when its test is over.
const GRACE: Duration = Duration::from_secs(5);

/// What a campaign runs with.
pub struct Campaign<'a> {
    pub program: &'a Program,
    /// The scenario's folder: where the program under test is started.
    pub dir: PathBuf,
    pub env: PythonEnv,
    /// Workers; at least one.
    pub jobs: usize,
}

/// A finished test, with its recording.
pub struct Done<'a> {
    pub index: usize,
    pub result: &'a TestResult,
    /// JSON Lines.
    pub recording: &'a str,
}

/// Installs what the program under test needs, into `cache` on first use; `listen` is told what happens. The program
/// is the words of the `run` command; it runs in `dir`, where its `requirements.txt` lies.
///
/// # Errors
/// Why it could not be installed.
pub fn prepare(
    run: &[String],
    dir: &Path,
    cache: &Path,
    listen: &dyn Fn(Preparation<'_>),
) -> Result<PythonEnv, SutError> {
    let list = dir.join("requirements.txt");
    let requirements = list.exists().then_some(list.as_path());
    let python = PythonEnv::interpreter_of(run);
    PythonEnv::prepare(&Needs { python, dir, requirements, cache }, listen)
}

impl Campaign<'_> {
    /// Runs the tests. `on_done` is called for each as it ends, in any order, one at a time.
    ///
    /// # Errors
    /// Only if the scenario has no system under test; what befalls a test is its result.
    pub fn run(&self, tests: &[Test], on_done: impl Fn(Done<'_>) + Sync) -> Result<Vec<TestResult>, String> {
        let system =
            self.program.system.as_ref().ok_or("the scenario has no `system` to run tests against")?;
        let next = AtomicUsize::new(0);
        let results: Mutex<Vec<Option<TestResult>>> = Mutex::new(vec![None; tests.len()]);
        let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        std::thread::scope(|scope| {
            for worker in 0..self.jobs.max(1) {
                let (next, results, on_done) = (&next, &results, &on_done);
                scope.spawn(move || {
                    if self.jobs <= cores {
                        // A speed-up only; the run is right on any core.
                        let _ = hrdsl_sut::pin_to_core(worker);
                    }
                    loop {
                        let index = next.fetch_add(1, Ordering::Relaxed);
                        let Some(test) = tests.get(index) else { return };
                        let (result, recording) = self.run_one(system, test);
                        let mut results = results.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                        on_done(Done { index, result: &result, recording: &recording });
                        results[index] = Some(result);
                    }
                });
            }
        });
        let results = results.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        Ok(results.into_iter().flatten().collect())
    }

    /// Runs and judges one test; gives its result and recording.
    fn run_one(&self, system: &System, test: &Test) -> (TestResult, String) {
        let (run, files) = self.execute(system, test);
        let header = record::Header {
            scenario: self.program.name.clone(),
            test: Some(test.name.clone()),
            seed: Some(test.seed),
        };
        let recording = record::write(self.program, &header, &run.trace);
        (judge(self.program, test, &run, files), recording)
    }

    fn execute(&self, system: &System, test: &Test) -> (Run, Vec<hrdsl_sut::FileCoverage>) {
        let failed = |fault| (Run { trace: Trace::default(), ended: Ended::Fault(fault) }, Vec::new());
        let stage = match Stage::new(self.program) {
            Ok(stage) => stage,
            Err(why) => return failed(Fault::World(why)),
        };
        let launch = Launch {
            command: system.run.clone(),
            dir: self.dir.clone(),
            seed: test.seed,
            coverage: system.coverage.clone(),
            env: self.env.clone(),
            budget: Duration::from_nanos(system.budget.max(0).unsigned_abs()),
            output_limit: OUTPUT_LIMIT,
        };
        let mut process = match Process::spawn(&launch) {
            Ok(process) => process,
            Err(error) => return failed(Fault::System(SutFault::from(error))),
        };
        let players: Vec<Box<dyn Player + '_>> = vec![
            Box::new(ScriptPlayer::new(self.program, test)),
            Box::new(ProgramPlayer::new(self.program, system.actor, &mut process)),
        ];
        let run = Harness::new(self.program, players, stage, system.limit).run();
        if !matches!(run.ended, Ended::Fault(_)) {
            // It may have ended by itself: then nobody reads this.
            let _ = process.reply(&Reply { time: run.trace.end, answer: Answer::Stop });
        }
        let finished = process.finish(GRACE);
        (run, finished.coverage.unwrap_or_default())
    }
}

/// Judges a run: verdicts and coverage, from the trace alone.
fn judge(program: &Program, test: &Test, run: &Run, files: Vec<hrdsl_sut::FileCoverage>) -> TestResult {
    let mut checker = Checker::new(program);
    run.trace.replay(&mut checker);
    let mut collector = Collector::new(program);
    run.trace.replay(&mut collector);
    let error = match &run.ended {
        Ended::Fault(fault) => Some(fault.to_string()),
        Ended::Quiet | Ended::Limit => None,
    };
    let verdicts = checker.verdicts();
    let verdict = |v: &Verdict| verdict_result(program, &run.trace, v, error.is_some());
    TestResult {
        name: test.name.clone(),
        suite: test.provenance.suite.clone(),
        method: test.provenance.method.clone(),
        seed: test.seed,
        ended: match run.ended {
            Ended::Quiet => "quiet",
            Ended::Limit => "limit",
            Ended::Fault(_) => "error",
        },
        duration: results::in_seconds(run.trace.end),
        verdicts: verdicts.iter().map(verdict).collect(),
        bins: collector.finish().cross_names(&program.coverage),
        predicted: test.provenance.predicts.clone(),
        because: test.provenance.because.clone(),
        code: ratios(&files),
        steps: test.steps.iter().map(|s| testgen::step_text(program, s)).collect(),
        files,
        error,
    }
}

/// Lines and branches of one run over all files.
fn ratios(files: &[hrdsl_sut::FileCoverage]) -> Ratios {
    let count = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    let mut sum = Ratios::default();
    for file in files {
        sum.lines += count(file.executed.len());
        sum.lines_total += count(file.statements.len());
        sum.branches += count(file.executed_branches.len());
        sum.branches_total += count(file.branches.len());
    }
    sum
}

/// A run that broke off can show a violation, but nothing else about a requirement.
fn verdict_result(program: &Program, trace: &Trace, verdict: &Verdict, broke_off: bool) -> VerdictResult {
    let monitor = &program.monitors[verdict.monitor];
    let outcome = match verdict.outcome {
        Outcome::Fail => "fail",
        Outcome::Pass | Outcome::NotChecked | Outcome::Open if broke_off => "error",
        Outcome::Pass => "pass",
        Outcome::NotChecked => "not_checked",
        Outcome::Open => "open",
    };
    let unit = monitor.margin.as_ref().map_or("", |m| m.unit.symbol());
    VerdictResult {
        requirement: monitor.name.clone(),
        outcome,
        triggered: verdict.triggered,
        failures: verdict.failures,
        failure: failure(program, trace, verdict),
        worst_margin: verdict.worst_margin.map(|(value, _)| (value, unit)),
    }
}

fn failure(program: &Program, trace: &Trace, verdict: &Verdict) -> Option<Failure> {
    let violation = verdict.first_failure.as_ref()?;
    let step = |index: &usize| {
        let step = trace.steps.get(*index)?;
        let (who, what) = print::who_did_what(program, &step.what);
        Some(WitnessStep {
            step: *index,
            time: results::in_seconds(step.time),
            text: format!("{who} {what}"),
        })
    };
    let mut witness: Vec<WitnessStep> = violation.witness.iter().filter_map(step).collect();
    witness.sort_by_key(|w| w.step);
    Some(Failure {
        time: results::in_seconds(violation.time),
        triggered_at: results::in_seconds(violation.trigger_time),
        deadline: violation.step.is_none(),
        witness,
    })
}
