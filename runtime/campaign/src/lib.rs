//! All tests of a campaign, in parallel: each is run, judged, and handed on before the next is counted; then
//! [`tally`](hrdsl_judge::tally) adds them up.
#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod accuracy;
mod binding;
mod execute;
mod forks;
mod hulls;
mod interfaces;
mod internal;
mod log;
mod output;
mod replay;
mod single;
mod times;

use std::{
    ffi::OsString,
    path::{Path, PathBuf},
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
};

use hrdsl_conformance::ConformanceOptions;
use hrdsl_harness::{
    AwaitInVain, HarnessError, HarnessRun, PortHistory, RunTermination, SaidHistory, SpentTime,
    SystemFaultKind, SystemLog,
};
use hrdsl_ir::{
    Program,
    system::{SystemProgram, SystemUnderTest},
    test::Test,
    value::seconds,
};
use hrdsl_judge::{CampaignOutcome, FinishedTest, TraceJudge};
use hrdsl_results::{
    FileCoverage, PhysicsAccuracy, PredictedRun, PredictionVerdict, RunEnd, RunMark, TestName, TestResult,
    TraceJudgement, UnmetAwait,
};
pub use hrdsl_sim::HullStore;
pub use hrdsl_sut::{
    CapturedOutput, CellSettings, CompiledMutants, HookedPackage, LaunchMutant, ListedMutant,
    PreparationStep, ProcessorClocks, ProgramLimits, PythonEnv, StopFlag,
    cell::{CellIsolation, SupervisorCommand, supervise},
};
use hrdsl_sut::{EnvironmentNeeds, FinishedProcess, LaunchMiddleware, LaunchSpec, SutError};
use hrdsl_trace::{
    MachineDeclaration, Trace,
    picture::WorldPicture,
    record::{self, RecordingEnd, RecordingHeader},
};

use hrdsl_testgen::step_lines;

use binding::{binding_text, module_folders};
pub use forks::ForkPlan;
use forks::WorkerServers;
pub use hulls::{FoundHulls, find_hulls};
pub use internal::{InternalError, guarded, record_panics};
pub use single::{SingleRun, SingleRunner};
pub use times::CampaignTimes;
use times::{CampaignStopwatch, TestTimes};

/// How much of the program's output is kept, in bytes for each stream.
const OUTPUT_KEPT: usize = 64 * 1024;
/// Lines of a program's complaints that go into the results.
const LAST_LINES: usize = 20;

/// What a campaign runs with.
#[derive(Clone)]
pub struct CampaignSetup<'a> {
    pub program: &'a Program,
    /// Which of the program's systems is tested.
    pub system: &'a SystemUnderTest,
    /// The table of interfaces that its programs can use, as JSON; empty without a middleware.
    pub interfaces: String,
    /// The scenario's folder: where the program under test is started.
    pub dir: PathBuf,
    pub env: PythonEnv,
    /// The campaign's own seed, from which the programs' hashes of texts follow; all other chance is of each test's seed.
    pub seed: u64,
    pub cells: CellSettings,
    pub limits: ProgramLimits,
    /// Variables that the program gets besides the default ones.
    pub variables: Vec<(OsString, OsString)>,
    /// The folder in which each test's files are kept, in a folder of the test's
    /// [`file_stem`](TestName::file_stem).
    pub keep: Option<PathBuf>,
    /// How the programs' interpreters are started.
    pub forks: ForkPlan,
    /// Workers; at least one.
    pub jobs: usize,
    /// Set when the campaign is to end before its last test.
    pub stop: StopFlag,
    /// How traces show what the code did, to the models that it is held against.
    pub conformance: ConformanceOptions,
    /// Whether a picture of the world is taken in each test, for a file by which it can be looked at again. Which of them are worth keeping is known
    /// when all tests are judged.
    pub replays: bool,
    /// What measures where processor time goes; `None`: nobody asks, and no clock is looked at.
    pub clocks: Option<ProcessorClocks>,
}

/// A finished test, with what belongs to it.
pub struct FinishedRun<'a> {
    pub index: usize,
    pub result: &'a TestResult,
    /// JSON Lines.
    pub recording: &'a str,
    /// The file by which it can be looked at again, or why it could not be made; `None` if there is to be none.
    pub replay: Option<Result<&'a [u8], &'a str>>,
    pub output: &'a [ProgramOutput],
}

/// What one program of the system wrote.
#[derive(Clone, Debug)]
pub struct ProgramOutput {
    pub program: String,
    pub output: CapturedOutput,
}

/// A finished test, and where its programs met.
#[derive(Clone, Debug, Default)]
struct PortedTest {
    finished: FinishedTest,
    /// What its programs opened to speak with each other.
    ports: PortHistory,
}

/// What a campaign came to, and where its processor time went, if that was measured.
#[derive(Clone, Debug, Default)]
pub struct CampaignRun {
    pub outcome: CampaignOutcome,
    pub times: Option<CampaignTimes>,
}

/// A test that was run, and what wall time has to do with it.
struct TestAttempt {
    finished: PortedTest,
    recording: String,
    replay: Option<Result<Vec<u8>, String>>,
    output: Vec<ProgramOutput>,
    fault: Option<SystemFaultKind>,
    times: TestTimes,
}

/// Installs what the programs under test need, into `cache` on first use; `listen` is told what happens. They run in `dir`, where
/// their `requirements.txt` lies, with the interpreter that the first of them names.
///
/// # Errors
/// Why it could not be installed.
pub fn prepare(
    system: &SystemUnderTest,
    dir: &Path,
    cache: &Path,
    listen: &dyn Fn(PreparationStep<'_>),
) -> Result<PythonEnv, SutError> {
    let list = dir.join("requirements.txt");
    let requirements = list.exists().then_some(list.as_path());
    let python = PythonEnv::interpreter_of(system.programs.iter().map(|p| p.run.as_slice()));
    PythonEnv::prepare(&EnvironmentNeeds { python, dir, requirements, cache }, listen)
}

impl CampaignSetup<'_> {
    /// Runs the tests. `on_done` is called for each as it ends, in any order, one at a time; what it gives is why the test
    /// cannot count, which is then its error.
    ///
    /// A test that wall time has ended is run once more when all others are done, alone: if it then comes to another end,
    /// that is its result, and it is marked.
    ///
    /// # Errors
    /// Only if what the programs need to know cannot be kept for them; what befalls a test is its result.
    pub fn run(
        &self,
        tests: &[Test],
        on_done: impl Fn(FinishedRun<'_>) -> Result<(), String> + Sync,
    ) -> Result<CampaignRun, String> {
        let system = &self.told_system()?;
        let next = AtomicUsize::new(0);
        let sum = CampaignStopwatch::start(self.clocks);
        let results: Mutex<Vec<Option<PortedTest>>> = Mutex::new(vec![None; tests.len()]);
        let finish = |index: usize, mut attempt: TestAttempt| {
            let mut results = results.lock().unwrap_or_else(PoisonError::into_inner);
            let TestAttempt { finished, recording, replay, output, .. } = &attempt;
            let result = &finished.finished.result;
            let mut writing = SpentTime::default();
            let replay = replay.as_ref().map(|file| file.as_deref().map_err(String::as_str));
            let done = || on_done(FinishedRun { index, result, recording, replay, output });
            if let Err(why) = self.measured(&mut writing, done) {
                attempt.finished.finished.result.break_off(why);
            }
            attempt.times.recordings += writing;
            attempt.times.whole += writing;
            sum.add(&attempt.times);
            results[index] = Some(attempt.finished);
        };
        let again: Mutex<Vec<(usize, TestAttempt)>> = Mutex::default();
        std::thread::scope(|scope| {
            for _ in 0..self.jobs.max(1) {
                scope.spawn(|| {
                    // A speed-up, and one processor for the program whatever the number of workers.
                    let _pinned = hrdsl_sut::pin_to_free_core();
                    let mut servers = WorkerServers::default();
                    while let Some(test) = self.next_test(tests, &next) {
                        let attempt = self.run_one(system, &tests[test], &mut servers);
                        match attempt.fault {
                            Some(SystemFaultKind::Interrupted) => return,
                            Some(SystemFaultKind::WallTime) => {
                                again.lock().unwrap_or_else(PoisonError::into_inner).push((test, attempt));
                            }
                            Some(SystemFaultKind::Program) | None => finish(test, attempt),
                        }
                    }
                });
            }
        });
        let mut again = again.into_inner().unwrap_or_else(PoisonError::into_inner);
        again.sort_by_key(|(index, _)| *index);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                let _pinned = hrdsl_sut::pin_to_free_core();
                let mut servers = WorkerServers::default();
                for (index, first) in again {
                    let attempt = self.run_again(system, &tests[index], first, &mut servers);
                    finish(index, attempt);
                }
            });
        });
        let results = results.into_inner().unwrap_or_else(PoisonError::into_inner);
        Ok(CampaignRun { outcome: self.outcome(results), times: sum.end() })
    }

    /// What came of the tests, one result for each that was run.
    fn outcome(&self, results: Vec<Option<PortedTest>>) -> CampaignOutcome {
        let interrupted = self.stop.is_set() && results.iter().any(Option::is_none);
        let planned = results.len();
        let tests: Vec<PortedTest> = results.into_iter().flatten().collect();
        let warnings = interfaces::warnings(self.system.binding.as_ref(), &tests);
        let tests = tests.into_iter().map(|test| test.finished).collect();
        CampaignOutcome { tests, planned, interrupted, warnings, ..CampaignOutcome::default() }
    }

    fn next_test(&self, tests: &[Test], next: &AtomicUsize) -> Option<usize> {
        let index = next.fetch_add(1, Ordering::Relaxed);
        (index < tests.len() && !self.stop.is_set()).then_some(index)
    }

    /// Runs a test once more that wall time has ended.
    fn run_again(
        &self,
        system: &CampaignSystem<'_>,
        test: &Test,
        first: TestAttempt,
        servers: &mut WorkerServers,
    ) -> TestAttempt {
        if self.stop.is_set() {
            return first;
        }
        let mut second = self.run_one(system, test, servers);
        match second.fault {
            Some(SystemFaultKind::Interrupted) => first,
            Some(SystemFaultKind::WallTime) => second,
            Some(SystemFaultKind::Program) | None => {
                second.finished.finished.result.marks.push(RunMark::DependsOnLoad);
                second
            }
        }
    }

    /// Runs and judges one test. A fault of hrdsl itself breaks off this test alone.
    fn run_one(&self, system: &CampaignSystem<'_>, test: &Test, servers: &mut WorkerServers) -> TestAttempt {
        let mut times = TestTimes::default();
        let mut whole = SpentTime::default();
        let mut attempt = self.measured(&mut whole, || {
            let run = || {
                let run = self.execute(system, test, servers, &mut times);
                self.judged(test, run, &mut times)
            };
            guarded(run).unwrap_or_else(|fault| {
                let run = (failed(HarnessError::Internal(fault.to_string())), Vec::new());
                self.judged(test, run, &mut TestTimes::default())
            })
        });
        attempt.times = TestTimes { whole, ..times };
        attempt
    }

    /// Does something, and measures what it takes if somebody asks.
    fn measured<T>(&self, spent: &mut SpentTime, act: impl FnOnce() -> T) -> T {
        match self.clocks {
            Some(clocks) => spent.measure(clocks.thread, act),
            None => act(),
        }
    }

    fn judged(
        &self,
        test: &Test,
        (run, finished): (HarnessRun, Vec<(String, FinishedProcess)>),
        times: &mut TestTimes,
    ) -> TestAttempt {
        times.simulated = run.trace.end;
        times.programs = finished.iter().map(|(_, f)| f.cpu).sum();
        let header = RecordingHeader {
            test: Some(test.name.clone()),
            seed: Some(test.seed),
            ..RecordingHeader::of(self.program)
        };
        let ending = ending(&run, &finished);
        let recording = self
            .measured(&mut times.recordings, || record::write(self.program, &header, &run.trace, &ending));
        let judgement = || judge(self.program, &self.conformance, &run.trace, ending.kind);
        let (judgement, machines) = self.measured(&mut times.judgement, judgement);
        let replay = self.replays.then(|| {
            let file = || replay::file(self.program, &run, &recording, &judgement, &finished);
            self.measured(&mut times.recordings, file)
        });
        let fault = match &run.ended {
            RunTermination::Fault(HarnessError::System(fault)) => Some(fault.kind),
            RunTermination::Fault(
                HarnessError::Model(_) | HarnessError::World(_) | HarnessError::Internal(_),
            )
            | RunTermination::Quiescent
            | RunTermination::Limit => None,
        };
        let output = |(program, f): &(String, FinishedProcess)| ProgramOutput {
            program: program.clone(),
            output: f.output.clone(),
        };
        let output = finished.iter().map(output).collect();
        let mut finished = test_result(self.program, test, run, (ending, judgement), finished);
        finished.finished.machines = machines;
        TestAttempt { finished, recording, replay, output, fault, times: TestTimes::default() }
    }

    /// The system with what its programs are told.
    fn told_system(&self) -> Result<CampaignSystem<'_>, String> {
        let middleware = self.middleware().map_err(|e| e.to_string())?;
        Ok(CampaignSystem { declared: self.system, middleware, mutant: None })
    }

    /// What programs find out about their middleware.
    fn middleware(&self) -> Result<Option<LaunchMiddleware>, SutError> {
        let Some(binding) = &self.system.binding else { return Ok(None) };
        let text = binding_text(self.program, binding, &self.interfaces);
        let file = self.env.kept(&text)?;
        Ok(Some(LaunchMiddleware {
            name: binding.kind.name(),
            binding: file,
            modules: module_folders(binding),
        }))
    }

    fn launch(
        &self,
        system: &CampaignSystem<'_>,
        program: &SystemProgram,
        seed: u64,
        test: Option<&Test>,
    ) -> LaunchSpec {
        let several = system.declared.programs.len() > 1;
        let folder = |folder: &PathBuf| {
            let folder = folder.join(TestName::from(test?.name.as_str()).file_stem());
            Some(if several { folder.join(&program.name) } else { folder })
        };
        LaunchSpec {
            command: program.run.clone(),
            dir: self.dir.clone(),
            seed,
            hash_seed: hash_seed(self.seed),
            coverage: program.coverage.clone(),
            lines: self.replays && !program.coverage.is_empty(),
            env: self.env.clone(),
            middleware: system.middleware.clone(),
            variables: self.variables.clone(),
            cells: self.cells.clone(),
            limits: self.limits,
            output_kept: OUTPUT_KEPT,
            keep: self.keep.as_ref().and_then(folder),
            stop: self.stop.clone(),
            mutant: system.mutant.clone(),
        }
    }
}

/// The system with what its programs are told.
struct CampaignSystem<'a> {
    declared: &'a SystemUnderTest,
    middleware: Option<LaunchMiddleware>,
    /// What is run in the place of one of their files.
    mutant: Option<LaunchMutant>,
}

/// Python takes seeds of 32 bits.
fn hash_seed(seed: u64) -> u32 {
    u32::try_from(seed & u64::from(u32::MAX)).unwrap_or_default()
}

/// A run that never began.
fn failed(fault: HarnessError) -> HarnessRun {
    let (trace, ports, log) = (Trace::default(), PortHistory::default(), SystemLog::default());
    let (unmet, picture) = (Vec::new(), WorldPicture::default());
    let (ended, said) = (RunTermination::Fault(fault), SaidHistory::default());
    HarnessRun { trace, ended, ports, log, unmet, accuracy: None, said, picture }
}

/// What is known about a test when its run is over.
fn test_result(
    program: &Program,
    test: &Test,
    run: HarnessRun,
    (ending, judgement): (RecordingEnd, TraceJudgement),
    finished: Vec<(String, FinishedProcess)>,
) -> PortedTest {
    let output = output::summary(&finished);
    let others = finished.iter().any(|(_, f)| f.others);
    let executed = FileCoverage::united(finished.into_iter().filter_map(|(_, f)| f.coverage).flatten());
    let unmet: Vec<UnmetAwait> = run.unmet.iter().map(unmet_await).collect();
    let predicted = &test.provenance.predicts;
    let prediction = PredictionVerdict::of(PredictedRun {
        method: test.provenance.method,
        ended: ending.kind,
        predicted,
        hit: &judgement.bins,
        unmet: &unmet,
    });
    let result = TestResult {
        name: test.name.as_str().into(),
        suite: test.provenance.suite.as_str().into(),
        method: test.provenance.method,
        seed: test.seed,
        ended: ending.kind,
        error: ending.error,
        marks: if others { vec![RunMark::OtherProcesses] } else { Vec::new() },
        waits: interfaces::unserved_waits(&run.ports),
        log: log::summary(&run.log),
        duration: seconds(run.trace.end),
        judgement,
        predicted: predicted.clone(),
        prediction,
        unmet,
        because: test.provenance.because.clone(),
        code: output::ratios(&executed),
        steps: step_lines(program, test),
        output,
        physics: run.accuracy.map(accuracy::physics).filter(|p| *p != PhysicsAccuracy::default()),
    };
    let finished = FinishedTest { result, executed, ..FinishedTest::default() };
    PortedTest { finished, ports: run.ports }
}

fn unmet_await(vain: &AwaitInVain) -> UnmetAwait {
    UnmetAwait { step: vain.step, since: seconds(vain.since), until: seconds(vain.until) }
}

fn judge(
    program: &Program,
    options: &ConformanceOptions,
    trace: &Trace,
    ended: RunEnd,
) -> (TraceJudgement, Vec<MachineDeclaration>) {
    let mut judge = TraceJudge::new(program, options);
    trace.replay(&mut judge);
    judge.finish(ended)
}

/// How a run ended; that a file of its program could not be kept breaks it off, too.
fn ending(run: &HarnessRun, finished: &[(String, FinishedProcess)]) -> RecordingEnd {
    let broke_off = |error| RecordingEnd { kind: RunEnd::Error, error: Some(error) };
    let kind = match &run.ended {
        RunTermination::Fault(fault) => return broke_off(fault.to_string()),
        RunTermination::Quiescent => RunEnd::Quiescent,
        RunTermination::Limit => RunEnd::Limit,
    };
    let kept = finished.iter().filter_map(|(_, f)| f.kept.as_ref());
    match kept.flat_map(|k| &k.failures).next() {
        Some(file) => broke_off(format!("a file of the program could not be kept: {file}")),
        None => RecordingEnd { kind, error: None },
    }
}
