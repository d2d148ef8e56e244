//! What lock-step costs: a round trip of `node.now()`, and a whole process from start to finish. At the end, how many round trips
//! a second of processor time is enough for, which does not depend on what else the machine does.

use std::{
    path::{Path, PathBuf},
    process::Command,
    time::Duration,
};

use hrdsl_sut::{
    CellSettings, EnvironmentNeeds, FinishedProcess, ForkServer, HarnessReply, LaunchMiddleware, LaunchSpec,
    ProgramLimits, ProgramRequest, PythonEnv, ReplyAnswer, StopFlag, SutProcess, cell::SupervisorCommand,
    pin_to_free_core,
};

fn main() {
    divan::main();
    // Not when the benchmarks are only listed or tried.
    if std::env::args().any(|arg| arg == "--bench") {
        for (name, coverage) in [("plain", false), ("under coverage", true)] {
            let mut rates: Vec<f64> = (0..5).map(|_| round_trips_per_second(coverage)).collect();
            rates.sort_by(f64::total_cmp);
            println!(
                "{:.0} round trips in a second of processor time, {name} ({:.0} to {:.0})",
                rates[2], rates[0], rates[4]
            );
        }
    }
}

/// Round trips in a second of processor time, of the harness and the program together; what its start and end cost is not
/// counted. Both are on one core.
fn round_trips_per_second(coverage: bool) -> f64 {
    const ROUND_TRIPS: u32 = 40_000;
    let _pinned = pin_to_free_core();
    let cost = |round_trips: u32| {
        let before = processor_time();
        let mut process = SutProcess::spawn(&launch("ask_forever.py", coverage)).expect("a process");
        for _ in 0..=round_trips {
            answer(&mut process);
        }
        process.next().expect("a request");
        process
            .reply(&HarnessReply { time: 0, answer: ReplyAnswer::Stop { reason: "the end".to_owned() } })
            .expect("a reply");
        drop(process.finish(Duration::from_secs(10)));
        processor_time() - before
    };
    f64::from(ROUND_TRIPS) / (cost(ROUND_TRIPS) - cost(0))
}

/// What this process and its children that have ended have used, in seconds.
fn processor_time() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").expect("Linux");
    // After the name of the program, which may have blanks: user and system time, then those of the children.
    let (_, fields) = stat.rsplit_once(')').expect("a name");
    let ticks = fields.split_whitespace().skip(11).take(4).map(|n| n.parse::<f64>().expect("a number"));
    ticks.sum::<f64>() / 100.0
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
        lines: false,
        env,
        middleware: None,
        variables: Vec::new(),
        cells: CellSettings::probe(SupervisorCommand::program(env!("CARGO_BIN_EXE_hrdsl-cell")), &root, None)
            .expect("a cell"),
        limits: ProgramLimits::default(),
        output_kept: 1 << 16,
        keep: None,
        stop: StopFlag::default(),
        mutant: None,
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

/// The same for a node of rospy, which asks for its time once it is one.
#[divan::bench(args = [false, true], sample_count = 100)]
fn fork_to_node(bencher: divan::Bencher, coverage: bool) {
    let mut launch = launch("hello_rospy.py", coverage);
    let folder = tempfile::tempdir().expect("a folder");
    launch.middleware = Some(rospy(folder.path()));
    let mut server = server(&launch);
    bencher.bench_local(|| {
        let mut process = SutProcess::fork(&launch, &mut server).expect("a process");
        answer(&mut process);
        process
    });
}

/// What a program of ROS 1 is told, with the definitions of two packages.
fn rospy(folder: &Path) -> LaunchMiddleware {
    const WRITE: &str = "import json, sys, tables; json.dump(dict(ros=1, base_frame='world', groups={}, packages={}, \
                         interfaces=tables.table(['std_msgs', 'rosgraph_msgs'])), open(sys.argv[1], 'w'))";
    let tables = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../sdk/python/tests");
    let binding = folder.join("binding.json");
    let mut python = Command::new("python3");
    python.args(["-c", WRITE]).arg(&binding).env("PYTHONPATH", tables);
    assert!(python.status().expect("Python 3").success(), "no table of definitions");
    LaunchMiddleware { name: "ros1", binding, modules: Vec::new() }
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
