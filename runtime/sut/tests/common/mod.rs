//! What the tests share: an environment prepared once, and launches of the scripts beside.

use std::{
    path::{Path, PathBuf},
    sync::OnceLock,
    time::Duration,
};

use hrdsl_harness::SystemArrival;
use hrdsl_sut::{
    CellSettings, EnvironmentNeeds, FinishedProcess, HarnessReply, LaunchSpec, ProgramLimits, ProgramRequest,
    PythonEnv, ReplyAnswer, StopFlag, SutError, SutProcess,
    cell::{CellIsolation, SupervisorCommand},
};

pub const GRACE: Duration = Duration::from_secs(20);

/// For the interpreter named by `HRDSL_TEST_PYTHON`, or `python3`.
pub fn environment(requirements: Option<&Path>) -> PythonEnv {
    try_environment(requirements).unwrap()
}

/// The same, where what is required may not be had.
pub fn try_environment(requirements: Option<&Path>) -> Result<PythonEnv, SutError> {
    let python = std::env::var("HRDSL_TEST_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let cache = Path::new(env!("CARGO_TARGET_TMPDIR")).join("sut");
    let dir = Path::new(".");
    PythonEnv::prepare(&EnvironmentNeeds { python: &python, dir, requirements, cache: &cache }, &|_| {})
}

fn plain_environment() -> PythonEnv {
    static ENV: OnceLock<PythonEnv> = OnceLock::new();
    ENV.get_or_init(|| environment(None)).clone()
}

pub fn launch(words: &[&str]) -> LaunchSpec {
    LaunchSpec {
        command: words.iter().map(|&w| w.to_owned()).collect(),
        dir: PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/programs"),
        seed: 17,
        hash_seed: 17,
        coverage: Vec::new(),
        lines: false,
        env: plain_environment(),
        middleware: None,
        variables: Vec::new(),
        cells: cells(None),
        limits: ProgramLimits { budget: Duration::from_secs(20), ..ProgramLimits::default() },
        output_kept: 1 << 16,
        keep: None,
        stop: StopFlag::default(),
        mutant: None,
    }
}

/// Cells of one kind, or of the best that the machine allows.
pub fn cells(isolation: Option<CellIsolation>) -> CellSettings {
    let supervisor = SupervisorCommand::program(env!("CARGO_BIN_EXE_hrdsl-cell"));
    CellSettings::probe(supervisor, Path::new(env!("CARGO_MANIFEST_DIR")), isolation).unwrap()
}

pub fn reply(process: &mut SutProcess, time: i64, answer: ReplyAnswer) {
    process.reply(&HarnessReply { time, answer }).unwrap();
}

/// A harness whose waits pass time, and whose commands end at once.
#[derive(Default)]
#[allow(dead_code, reason = "not every test file uses it")]
pub struct YesHarness {
    pub time: i64,
    ended: Vec<u64>,
}

#[allow(dead_code, reason = "not every test file uses it")]
impl YesHarness {
    pub fn answer(&mut self, request: &ProgramRequest) -> ReplyAnswer {
        match request {
            ProgramRequest::Hello { version, .. } if *version > 1 => {
                ReplyAnswer::Hello { version: *version, program: "robot".into() }
            }
            ProgramRequest::Sleep { seconds } => {
                self.time += hrdsl_ir::value::nanos(*seconds);
                ReplyAnswer::Ok
            }
            ProgramRequest::Act { wait: false, call: Some(call), .. } => {
                self.ended.push(*call);
                ReplyAnswer::Ok
            }
            ProgramRequest::Wait { until, give_up } => {
                let ended = std::mem::take(&mut self.ended).into_iter();
                let arrivals: Vec<SystemArrival> =
                    ended.map(|call| SystemArrival::Ended { call, how: Ok(()) }).collect();
                if arrivals.is_empty() {
                    self.time = until.iter().chain(give_up).min().copied().unwrap_or(0).max(self.time);
                }
                ReplyAnswer::Arrived { gave_up: arrivals.is_empty() && until.is_none(), arrivals }
            }
            _ => ReplyAnswer::Ok,
        }
    }
}

/// Runs a program to its normal end, with a harness that says yes to everything.
#[allow(dead_code, reason = "not every test file uses it")]
pub fn run(launch: &LaunchSpec) -> (Vec<ProgramRequest>, FinishedProcess) {
    let mut process = SutProcess::spawn(launch).unwrap();
    let mut requests = Vec::new();
    let mut harness = YesHarness::default();
    while requests.last() != Some(&ProgramRequest::Done) {
        let request = process.next().unwrap();
        let answer = harness.answer(&request);
        reply(&mut process, harness.time, answer);
        requests.push(request);
    }
    (requests, process.finish(GRACE))
}
