//! Good and bad programs in lock-step: what each is taken for, and that none blocks or harms the harness.

mod common;

use std::{
    collections::{BTreeMap, VecDeque},
    path::Path,
    time::Duration,
};

use common::{GRACE, environment, launch, reply, run, try_environment};
use hrdsl_harness::SystemArrival;
use hrdsl_ir::{Symbol, Value};
use hrdsl_results::FileCoverage;
use hrdsl_sut::{
    HarnessReply, LaunchSpec, ProgramExit, ProgramRequest, ProtocolArgument, PythonEnv, ReplyAnswer,
    SutError, SutProcess,
};

fn hello(process: &mut SutProcess) {
    assert!(matches!(process.next().unwrap(), ProgramRequest::Hello { version: 2, .. }));
    reply(process, 0, ReplyAnswer::Hello { version: 2, program: "robot".into() });
}

/// What each wait is answered, and the rest as it is asked; time passes in waits.
fn answer_of_the_test(
    request: &ProgramRequest,
    waits: &mut VecDeque<(Vec<SystemArrival>, bool)>,
    time: &mut i64,
) -> ReplyAnswer {
    match request {
        ProgramRequest::Hello { version: 2, .. } => {
            ReplyAnswer::Hello { version: 2, program: "robot".into() }
        }
        // It looks whether something is there already.
        ProgramRequest::Wait { until: Some(0), .. } => {
            ReplyAnswer::Arrived { arrivals: Vec::new(), gave_up: false }
        }
        ProgramRequest::Wait { until, give_up } => {
            let (arrivals, gave_up) = waits.pop_front().expect("no more waits than the test knows");
            *time = until.or(*give_up).unwrap_or(*time).max(*time);
            ReplyAnswer::Arrived { arrivals, gave_up }
        }
        ProgramRequest::Read { signal } => ReplyAnswer::Value(match signal.as_str() {
            "pressure" => Value::Bool(false),
            "height" => Value::Float(1.25),
            _ => Value::Symbol(Symbol::intern("slow")),
        }),
        _ => ReplyAnswer::Ok,
    }
}

#[test]
fn a_good_program_is_answered() {
    let mut process = SutProcess::spawn(&launch(&["python3", "-u", "good.py", "one", "-m"])).unwrap();
    let event = |name: &str, args: &[(&str, bool)], time| SystemArrival::Event {
        name: name.into(),
        args: args.iter().map(|&(k, v)| (k.to_owned(), Value::Bool(v))).collect(),
        time,
    };
    // What each of its waits is answered: the pause, three waits for events, and the ends of four commands.
    let ended =
        |call: u64, how: Result<(), &str>| SystemArrival::Ended { call, how: how.map_err(str::to_owned) };
    let mut waits = VecDeque::from([
        (Vec::new(), false),
        (Vec::new(), true),
        (vec![event("a", &[], 1_250_000_000)], false),
        (vec![event("sensed", &[("gaze", true)], 2_000_000_000)], false),
        (vec![ended(1, Ok(()))], false),
        (vec![ended(2, Err("joint 2 is at its limit"))], false),
        (vec![ended(3, Ok(()))], false),
        (vec![ended(4, Ok(()))], false),
    ]);
    let mut requests = Vec::new();
    let mut time = 500_000_000;
    while requests.last() != Some(&ProgramRequest::Done) {
        let request = process.next().unwrap();
        let answer = answer_of_the_test(&request, &mut waits, &mut time);
        reply(&mut process, time, answer);
        requests.push(request);
    }
    assert_eq!(requests[0], ProgramRequest::Hello { version: 2, name: "good".into() });
    assert_eq!(requests[2], ProgramRequest::Wait { until: Some(2_000_000_000), give_up: None });
    let args = [("ready", Value::Bool(true)), ("n", Value::Int(3)), ("x", Value::Float(0.5))];
    let mut args: BTreeMap<_, _> =
        args.into_iter().map(|(k, v)| (k.to_owned(), ProtocolArgument::Scalar(v))).collect();
    args.insert("pace".into(), ProtocolArgument::Text("fast".into()));
    assert_eq!(requests[3], ProgramRequest::Emit { event: "decided".into(), args });
    assert!(requests.contains(&ProgramRequest::Wait { until: None, give_up: Some(4_000_000_000) }));
    let moved = |r: &ProgramRequest| matches!(r, ProgramRequest::Act { command, wait: false, call: Some(2), .. } if command == "move_joints");
    assert!(requests.iter().any(moved), "{requests:?}");
    let finished = process.finish(GRACE);
    assert_eq!(finished.exit, ProgramExit::Code(0), "{}", finished.output);
    let expected = "seed 17 args ['one', '-m']\nnow 0.5\nfirst None\nsecond Event(a() at 1.250 s)\n\
        third sensed True {'gaze': True} 2.0\nread False 1.25 slow\nmove True False joint 2 is at its limit\n\
        grip True True\n";
    assert_eq!(finished.output.stdout.text(), expected);
    assert_eq!(finished.coverage, None);
}

#[test]
fn what_is_absent_is_named() {
    for (words, name) in [
        (vec!["python3", "no_such_script.py"], "no_such_script.py"),
        (vec!["no-such-program-anywhere"], "no-such-program-anywhere"),
        (vec!["./no-such-file"], "no-such-file"),
        (vec![], "empty"),
    ] {
        let error = SutProcess::spawn(&launch(&words)).unwrap_err();
        assert!(
            matches!(&error, SutError::Absent { looked_for, .. } if looked_for.contains(name)),
            "{error}"
        );
    }
    let mut lost = launch(&["python3", "good.py"]);
    lost.dir = "/no/such/folder".into();
    assert!(SutProcess::spawn(&lost).unwrap_err().to_string().contains("/no/such/folder"));
    let error = SutProcess::spawn(&launch(&["python3.2", "good.py"])).unwrap_err();
    assert!(error.to_string().contains("`python3.2`"), "{error}");
}

#[test]
fn one_that_exits_is_reported_with_its_output() {
    let mut process = SutProcess::spawn(&launch(&["python3", "exits.py"])).unwrap();
    let error = process.next().unwrap_err();
    let SutError::Exited { exit, output, .. } = &error else { panic!("{error}") };
    assert_eq!((*exit, output.stdout.text().as_str()), (ProgramExit::Code(3), "going\n"));
    assert!(error.to_string().contains("exit code 3") && error.to_string().contains("  going"), "{error}");
    assert_eq!(process.finish(GRACE).exit, ProgramExit::Code(3));
}

#[test]
fn an_uncaught_exception_leaves_its_own_traceback() {
    let mut process = SutProcess::spawn(&launch(&["python3", "raises.py"])).unwrap();
    hello(&mut process);
    let error = process.next().unwrap_err();
    assert!(matches!(error, SutError::Exited { exit: ProgramExit::Code(1), .. }), "{error}");
    let text = error.output().unwrap().stderr.text();
    assert!(text.starts_with("Traceback") && text.ends_with("ValueError: a wheel came off\n"), "{text}");
    assert!(text.contains("raises.py\", line 10, in <module>") && !text.contains("runner.py"), "{text}");
}

#[test]
fn one_that_hangs_is_given_up_and_its_coverage_kept() {
    let mut hanging = launch(&["python3", "hangs.py"]);
    hanging.coverage = vec!["hangs.py".into()];
    let mut process = SutProcess::spawn(&hanging).unwrap();
    hello(&mut process);
    drop(process);
    hanging.limits.budget = Duration::from_millis(300);
    let mut process = SutProcess::spawn(&hanging).unwrap();
    let mut error = None;
    while error.is_none() {
        // Under load even the start may take longer than this budget, which is the same finding.
        match process.next() {
            Ok(_) => reply(&mut process, 0, ReplyAnswer::Ok),
            Err(e) => error = Some(e),
        }
    }
    assert!(matches!(error, Some(SutError::Overrun { .. })), "{error:?}");
    let finished = process.finish(Duration::from_millis(10));
    assert_eq!(finished.exit, ProgramExit::Killed);
}

#[test]
fn one_that_hangs_is_terminated_with_its_coverage() {
    let mut hanging = launch(&["python3", "hangs.py"]);
    hanging.coverage = vec!["hangs.py".into()];
    let (_, finished) = {
        // A first run, so that the static analysis is there.
        let mut first = launch(&["python3", "hello.py"]);
        first.coverage = hanging.coverage.clone();
        run(&first)
    };
    assert_eq!(finished.coverage.unwrap()[0].executed, Vec::<u32>::new(), "it was never imported");
    let mut process = SutProcess::spawn(&hanging).unwrap();
    hello(&mut process);
    let finished = process.finish(Duration::from_millis(300));
    assert_eq!(finished.exit, ProgramExit::Killed);
    let coverage = finished.coverage.expect("written on SIGTERM");
    assert!(coverage[0].executed.contains(&1), "{coverage:?}");
}

#[test]
fn rubbish_is_told_from_requests() {
    let mut process = SutProcess::spawn(&launch(&["sh", "-c", "exec python3 rubbish.py short"])).unwrap();
    let error = process.next().unwrap_err();
    assert!(
        matches!(&error, SutError::Rubbish { line, .. } if line == "Traceback: this is no request"),
        "{error}"
    );
    let mut process = SutProcess::spawn(&launch(&["sh", "-c", "exec python3 rubbish.py endless"])).unwrap();
    let error = process.next().unwrap_err();
    assert!(matches!(&error, SutError::Rubbish { line, .. } if line.len() == 200), "{error}");
    assert!(error.to_string().contains("longer than 1048576 bytes"), "{error}");
}

#[test]
fn a_flood_of_output_is_kept_in_bounds() {
    let (requests, finished) = run(&launch(&["python3", "floods.py"]));
    assert_eq!(requests.len(), 13);
    let out = &finished.output.stdout;
    assert_eq!(out.bytes, 100_000_000 + 22);
    assert!(out.head.starts_with("the beginning\n") && out.tail.ends_with("the end\n"));
    assert_eq!(out.head.len() + out.tail.len(), 1 << 16);
}

#[test]
fn one_that_reads_no_reply_does_not_block_the_harness() {
    let mut deaf = launch(&["sh", "-c", "exec python3 deaf.py"]);
    deaf.limits.budget = Duration::from_millis(500);
    let mut process = SutProcess::spawn(&deaf).unwrap();
    let error = loop {
        let request = match process.next() {
            Ok(request) => request,
            Err(e) => break e,
        };
        assert_eq!(request, ProgramRequest::Now);
        if let Err(e) = process.reply(&HarnessReply { time: 0, answer: ReplyAnswer::Ok }) {
            break e;
        }
    };
    assert!(matches!(error, SutError::Overrun { .. }), "{error}");
    assert_eq!(process.finish(Duration::ZERO).exit, ProgramExit::Killed);
}

#[test]
fn a_child_left_behind_does_not_hide_the_end() {
    let mut process = SutProcess::spawn(&launch(&["python3", "forks.py"])).unwrap();
    hello(&mut process);
    assert!(matches!(process.next().unwrap(), ProgramRequest::Emit { .. }));
    reply(&mut process, 0, ReplyAnswer::Ok);
    let error = process.next().unwrap_err();
    assert!(matches!(error, SutError::Exited { exit: ProgramExit::Code(7), .. }), "{error}");
    assert!(process.finish(GRACE).others);
}

#[test]
fn chance_and_clocks_come_from_the_seed_and_simulated_time() {
    let mut launch = launch(&["python3", "chance.py"]);
    let text = |launch: &_| run(launch).1.output.stdout.text();
    let first = text(&launch);
    assert_eq!(first, text(&launch), "the same seed, the same bytes");
    launch.seed = u64::MAX;
    launch.hash_seed = 7;
    let other = text(&launch);
    let lines = |t: &str| t.lines().map(str::to_owned).collect::<Vec<_>>();
    let (first, other) = (lines(&first), lines(&other));
    assert_eq!(first.len(), 8, "{first:?}");
    assert_ne!(first[0], other[0]);
    assert_ne!(first[1], other[1]);
    assert_eq!(first[2..], other[2..], "clocks do not depend on the seed");
    assert_eq!(first[2], "1735689600.0 1735689600000000000 0.0 0 Wed Jan  1 00:00:00 2025 00:00:00");
    assert_eq!(first[3], "2025-01-01 00:00:00 2025-01-01 00:00:00+00:00 2025-01-01");
    assert_eq!(first[4], "True None");
    assert_eq!(first[5], "1735689690.25 90.25 90.25 Wed Jan  1 00:01:30 2025");
    assert_eq!(first[6], "2025-01-01 00:01:29.250000 <class 'datetime.datetime'>");
    assert!(first[7].starts_with("91.25 Use exit()"), "{}", first[7]);
}

/// The rows of the table of sources that are repeatable: what is read, and what it depends on.
fn repeatable_rows() -> BTreeMap<String, String> {
    let page = include_str!("../../../spec/randomness.md");
    let (_, section) = page.split_once("## What code under test sees").expect("the section");
    let rows = section.lines().filter_map(|line| {
        let cells: Vec<&str> = line.trim_matches('|').split(" | ").map(str::trim).collect();
        let [name, _, gets] = cells[..] else { return None };
        let by = ["seed", "simulated time", "fixed"].into_iter().find(|by| gets.starts_with(by))?;
        Some((name.to_owned(), by.to_owned()))
    });
    rows.collect()
}

#[test]
fn each_row_of_the_table_of_sources_is_repeatable() {
    let mut launch = launch(&["python3", "-W", "ignore", "repeatable.py"]);
    let read = |launch: &mut LaunchSpec, seed| {
        launch.seed = seed;
        let (_, finished) = run(launch);
        let text = finished.output.stdout.text();
        let lines = text.lines().map(|line| line.split_once(": ").expect("a row and what it read"));
        lines.map(|(name, read)| (name.to_owned(), read.to_owned())).collect::<BTreeMap<_, _>>()
    };
    let (first, again, other) = (read(&mut launch, 17), read(&mut launch, 17), read(&mut launch, 18));
    launch.hash_seed = 18;
    let hashed = read(&mut launch, 17);
    let rows = repeatable_rows();
    assert_eq!(first.keys().collect::<Vec<_>>(), rows.keys().collect::<Vec<_>>(), "the page and the program");
    for (name, by) in &rows {
        assert_eq!(first[name], again[name], "{name}");
        assert_eq!(first[name] != other[name], by == "seed", "{name}, with another seed");
    }
    let hashes = "hashes of texts, and the order of sets";
    assert_ne!(first[hashes], hashed[hashes], "with another seed of the campaign");
}

#[test]
fn coverage_has_the_statements_and_branches() {
    let mut launch = launch(&["python3", "covered.py"]);
    launch.coverage = vec!["hello.py".into(), "covered.py".into()];
    let (_, finished) = run(&launch);
    let first = finished.coverage.unwrap_or_else(|| panic!("no coverage{}", finished.output));
    let statements = vec![2, 3, 6, 7, 8, 9, 10, 11, 18, 19, 20, 21, 24, 27, 28, 29, 30, 31, 32, 33, 34, 35];
    let expected = FileCoverage {
        file: "covered.py".into(),
        executed: statements.iter().copied().filter(|l| ![9, 10, 11, 34, 35].contains(l)).collect(),
        statements,
        branches: vec![(7, 8), (7, 9), (9, 10), (9, 11), (20, -18), (20, 21), (33, -1), (33, 34)],
        executed_branches: vec![(7, 8), (20, 21), (33, -1)],
    };
    assert_eq!(first[0].file, "hello.py");
    assert_eq!(first[0].executed, Vec::<u32>::new());
    assert_eq!(first[1], expected);
    assert_eq!(run(&launch).1.coverage.unwrap(), first, "with the analysis from the cache");
}

#[test]
fn coverage_is_written_after_an_exception_too() {
    let mut launch = launch(&["python3", "covered.py"]);
    launch.coverage = vec!["covered.py".into()];
    launch.seed = 101;
    let mut process = SutProcess::spawn(&launch).unwrap();
    hello(&mut process);
    assert!(matches!(process.next().unwrap_err(), SutError::Exited { exit: ProgramExit::Code(1), .. }));
    let coverage = process.finish(GRACE).coverage.expect("coverage");
    assert!(coverage[0].executed.ends_with(&[33, 34, 35]), "{coverage:?}");
    assert!(coverage[0].executed_branches.contains(&(9, 10)), "{coverage:?}");
}

#[test]
fn a_stop_ends_the_program_in_order() {
    let mut launch = launch(&["python3", "stopped.py"]);
    launch.coverage = vec!["stopped.py".into()];
    for by_reply in [true, false] {
        let mut process = SutProcess::spawn(&launch).unwrap();
        hello(&mut process);
        let mut request = process.next().unwrap();
        while !matches!(request, ProgramRequest::Wait { until: None, .. }) {
            let answer = match request {
                // It looks whether something is there already.
                ProgramRequest::Wait { .. } => ReplyAnswer::Arrived { arrivals: Vec::new(), gave_up: false },
                _ => ReplyAnswer::Ok,
            };
            reply(&mut process, 0, answer);
            request = process.next().unwrap();
        }
        assert_eq!(request, ProgramRequest::Wait { until: None, give_up: None });
        if by_reply {
            reply(&mut process, 7, ReplyAnswer::Stop { reason: "it is late".into() });
        }
        let why = if by_reply { "it is late" } else { "the harness has gone" };
        let finished = process.finish(GRACE);
        assert_eq!(finished.exit, ProgramExit::Code(0), "{}", finished.output);
        assert_eq!(finished.output.stdout.text(), format!("stopped: {why}\ncleaning up\n"));
        assert_eq!(finished.output.stderr.text(), "");
        assert!(finished.coverage.is_some());
    }
}

#[test]
fn what_is_refused_is_an_exception_in_the_program() {
    let mut process = SutProcess::spawn(&launch(&["python3", "refused.py"])).unwrap();
    hello(&mut process);
    assert!(matches!(process.next().unwrap(), ProgramRequest::Emit { .. }));
    let help = Some("did you mean leg_request?".to_owned());
    reply(&mut process, 0, ReplyAnswer::Error { error: "no event leg_reqest".into(), help });
    assert!(
        matches!(process.next().unwrap(), ProgramRequest::Read { .. }),
        "the malformed ones never come up here"
    );
    reply(&mut process, 0, ReplyAnswer::Error { error: "no signal nothing".into(), help: None });
    let error = process.next().unwrap_err();
    let output = error.output().unwrap();
    let text = output.stdout.text();
    assert!(
        text.starts_with("error: no event leg_reqest | help: did you mean leg_request?\nvalue error: "),
        "{text}"
    );
    assert_eq!(text.matches("value error: ").count(), 3, "{text}");
    assert_eq!(text.matches("refused: ").count(), 3, "{text}");
    assert!(text.contains("protocol version 9"), "{text}");
    assert!(output.stderr.text().contains("ProtocolError: no signal nothing"), "{}", output.stderr.text());
}

#[test]
fn one_that_ignores_every_signal_is_killed() {
    let mut launch = launch(&["python3", "stubborn.py"]);
    launch.coverage = vec!["stubborn.py".into()];
    let mut process = SutProcess::spawn(&launch).unwrap();
    hello(&mut process);
    assert_eq!(process.next().unwrap(), ProgramRequest::Now);
    reply(&mut process, 0, ReplyAnswer::Ok);
    let finished = process.finish(Duration::from_millis(50));
    assert_eq!((finished.exit, finished.coverage), (ProgramExit::Killed, None));
}

#[test]
fn other_programs_and_modules_speak_the_protocol_too() {
    let (requests, finished) = run(&launch(&["sh", "-c", "echo before; exec python3 hello.py"]));
    assert_eq!(requests.len(), 2, "hello and, at exit, done");
    assert_eq!(finished.output.stdout.text(), "before\n");
    let (requests, finished) = run(&launch(&["python3", "-m", "hello"]));
    assert_eq!((requests.len(), finished.exit), (2, ProgramExit::Code(0)));
    let (requests, finished) =
        run(&launch(&["python3", "-c", "import hello, time; print(time.monotonic())"]));
    assert_eq!((requests.len(), finished.output.stdout.text().as_str()), (2, "0.0\n"));
    let told =
        SutProcess::spawn(&launch(&["ros2", "run", "tea_bot", "brain"])).map(drop).unwrap_err().to_string();
    assert!(told.contains("each node is a program of its own"), "{told}");
    let by_hand =
        r#"printf '{"request":"done"}\n' >&$HRDSL_REQUEST_FD; read -r line <&$HRDSL_REPLY_FD; echo "$line""#;
    let (requests, finished) = run(&launch(&["bash", "-c", by_hand]));
    assert_eq!((requests.len(), finished.output.stdout.text().as_str()), (1, "{\"t\":0}\n"));
}

/// The last line of Python's tests; some are skipped where NumPy is not installed.
fn is_ok(text: &str) -> bool {
    text.lines().last().is_some_and(|last| last == "OK" || last.starts_with("OK (skipped="))
}

/// With NumPy, which the SDK's tests use where it is there: it is installed if the index of packages can be reached.
fn environment_with_numpy() -> PythonEnv {
    let list = Path::new(env!("CARGO_TARGET_TMPDIR")).join("numpy.txt");
    std::fs::write(&list, "numpy\n").unwrap();
    try_environment(Some(&list)).unwrap_or_else(|why| {
        eprintln!("the tests of the SDK that need NumPy are skipped: {why}");
        environment(None)
    })
}

#[test]
fn the_sdks_own_tests_pass() {
    sdk_tests("test_[!a-q]*.py");
}

/// They take long, and two tests run at once.
#[test]
fn so_does_the_other_half() {
    sdk_tests("test_[a-q]*.py");
}

fn sdk_tests(files: &str) {
    // `env`: they run programs in simulated time, and themselves in real time.
    let alone = ["env", "-u", "HRDSL_SEED", "-u", "HRDSL_REQUEST_FD", "-u", "HRDSL_REPLY_FD"];
    let mut tests = launch(&[&alone[..], &["python3", "-m", "unittest", "discover", "-p", files]].concat());
    tests.env = environment_with_numpy();
    let coverage = tests.env.coverage_package().as_os_str().to_owned();
    tests.variables.push(("HRDSL_COVERAGE_PACKAGE".into(), coverage));
    tests.dir = tests.dir.join("../../../../sdk/python/tests");
    tests.limits.budget = Duration::from_secs(1800);
    let finished = SutProcess::spawn(&tests).unwrap().finish(Duration::from_secs(1800));
    let text = finished.output.stderr.text();
    assert!(finished.exit == ProgramExit::Code(0) && is_ok(&text), "{text}");
}

#[test]
fn requirements_are_installed_and_found() {
    let dir = tempfile::tempdir().unwrap();
    // A wheel made by hand, so that no index is asked.
    let make = "import zipfile; z = zipfile.ZipFile('robotlib-1.0-py3-none-any.whl', 'w'); \
        d = 'robotlib-1.0.dist-info/'; z.writestr('robotlib.py', 'GREETING = \"from the wheel\"\\n'); \
        z.writestr(d + 'METADATA', 'Metadata-Version: 2.1\\nName: robotlib\\nVersion: 1.0\\n'); \
        z.writestr(d + 'WHEEL', 'Wheel-Version: 1.0\\nGenerator: test\\nRoot-Is-Purelib: true\\nTag: py3-none-any\\n'); \
        z.writestr(d + 'RECORD', ''); z.close()";
    let made = std::process::Command::new("python3").args(["-c", make]).current_dir(dir.path()).status();
    assert!(made.unwrap().success());
    let list = dir.path().join("requirements.txt");
    std::fs::write(&list, "./robotlib-1.0-py3-none-any.whl\n").unwrap();
    std::fs::write(dir.path().join("robot.py"), "import robotlib\nprint(robotlib.GREETING)\n").unwrap();
    let mut launch = launch(&["python3", "robot.py"]);
    launch.env = environment(Some(&list));
    launch.dir = dir.path().to_owned();
    let (requests, finished) = run(&launch);
    assert_eq!(requests.last(), Some(&ProgramRequest::Done));
    assert_eq!(finished.output.stdout.text(), "from the wheel\n", "{}", finished.output);
}
