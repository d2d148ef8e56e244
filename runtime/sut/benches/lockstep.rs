//! What lock-step costs: a round trip of `node.now()`, and a whole process from start to finish.

use std::{
    path::{Path, PathBuf},
    time::Duration,
};

use hrdsl_sut::{
    CellSettings, EnvironmentNeeds, FinishedProcess, ForkServer, HarnessReply, LaunchSpec, ProgramLimits,
    ProgramRequest, PythonEnv, ReplyAnswer, StopFlag, SutProcess, cell::SupervisorCommand, pin_to_free_core,
};

fn main() {
    divan::main();
}

fn launch(script: &str, coverage: bool) -> LaunchSpec {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let cache = root.join("../../target/hrdsl-sut-cache");
    let needs =
        EnvironmentNeeds { python: "python3", dir: Path::new("."), requirements: None, cache: &cache };
    let env = PythonEnv::prepare(&needs, &|_| {}).expect("Python 3 and a way to install coverage.py");
    LaunchSpec {
        command: vec!["python3".into(), script.into()],
        dir: root.join("tests/programs"),
        seed: 1,
        hash_seed: 1,
        coverage: if coverage { vec![script.into()] } else { Vec::new() },
        env,
        middleware: None,
        variables: Vec::new(),
        cells: CellSettings::probe(SupervisorCommand::program(env!("CARGO_BIN_EXE_hrdsl-cell")), &root, None)
            .expect("a cell"),
        limits: ProgramLimits::default(),
        output_kept: 1 << 16,
        keep: None,
        stop: StopFlag::default(),
    }
}

fn answer(process: &mut SutProcess) -> ProgramRequest {
    let request = process.next().expect("a request");
    process.reply(&HarnessReply { time: 0, answer: ReplyAnswer::Ok }).expect("a reply");
    request
}

/// 1,000 round trips; parent and child left to the scheduler, then on one core. (The last benchmark, in this order:
/// the thread stays pinned.)
#[divan::bench(args = [false, true], sample_count = 50)]
fn thousand_round_trips(bencher: divan::Bencher, pinned: bool) {
    if pinned {
        let _pinned = pin_to_free_core().expect("a core");
    }
    let mut process = SutProcess::spawn(&launch("ask_forever.py", false)).expect("a process");
    answer(&mut process);
    bencher.counter(divan::counter::ItemsCount::new(1000_u32)).bench_local(|| {
        for _ in 0..1000 {
            answer(&mut process);
        }
    });
}

/// From the start of a program that only says hello to its end, in an interpreter of its own; with and without coverage.
#[divan::bench(args = [false, true], sample_count = 30)]
fn start_to_finish(bencher: divan::Bencher, coverage: bool) {
    let launch = launch("hello.py", coverage);
    bencher.bench_local(|| finish(SutProcess::spawn(&launch).expect("a process")));
}

/// The same, forked by a server.
#[divan::bench(args = [false, true], sample_count = 100)]
fn fork_to_finish(bencher: divan::Bencher, coverage: bool) {
    let launch = launch("hello.py", coverage);
    let mut server = server(&launch);
    bencher.bench_local(|| finish(SutProcess::fork(&launch, &mut server).expect("a process")));
}

/// From the order for a fork to its first request: what a test waits for before it begins.
#[divan::bench(args = [false, true], sample_count = 100)]
fn fork_to_hello(bencher: divan::Bencher, coverage: bool) {
    let launch = launch("hello.py", coverage);
    let mut server = server(&launch);
    bencher.bench_local(|| {
        let mut process = SutProcess::fork(&launch, &mut server).expect("a process");
        answer(&mut process);
        process
    });
}

/// What a worker does once: an interpreter with its imports, that waits for tests.
#[divan::bench(args = [false, true], sample_count = 20)]
fn start_a_server(bencher: divan::Bencher, coverage: bool) {
    let launch = launch("hello.py", coverage);
    let modules = ForkServer::find_modules(&launch).expect("a fork server");
    bencher.bench_local(|| ForkServer::start(&launch, &modules).expect("a fork server"));
}

fn server(launch: &LaunchSpec) -> ForkServer {
    let modules = ForkServer::find_modules(launch).expect("a fork server");
    ForkServer::start(launch, &modules).expect("a fork server")
}

fn finish(mut process: SutProcess) -> FinishedProcess {
    while answer(&mut process) != ProgramRequest::Done {}
    process.finish(Duration::from_secs(10))
}
