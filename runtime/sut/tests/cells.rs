//! What a cell keeps apart, and that nothing outlives it: with namespaces, and with copies where they are refused.

mod common;

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    time::{Duration, Instant},
};

use common::{GRACE, cells, launch, reply, run};
use hrdsl_sut::{
    LaunchSpec, LimitOverrun, ProgramExit, ProgramRequest, ReplyAnswer, SutError, SutProcess,
    cell::CellIsolation,
};

const BOTH: [CellIsolation; 2] = [CellIsolation::Namespaces, CellIsolation::Copies];

/// A launch of a program in a copy of the programs' folder, which it may do with what it likes.
fn launch_in(folder: &Path, isolation: CellIsolation, words: &[&str]) -> LaunchSpec {
    for entry in fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/programs")).unwrap() {
        let entry = entry.unwrap();
        if entry.file_type().unwrap().is_file() {
            fs::copy(entry.path(), folder.join(entry.file_name())).unwrap();
        }
    }
    let mut launch = launch(words);
    launch.dir = folder.canonicalize().unwrap();
    launch.cells = cells(Some(isolation));
    launch
}

#[test]
fn what_a_program_writes_is_its_own() {
    for isolation in BOTH {
        let (place, elsewhere) = (tempfile::tempdir().unwrap(), tempfile::tempdir_in("/var/tmp").unwrap());
        fs::create_dir_all(place.path().join("hidden/deep")).unwrap();
        let file = elsewhere.path().join("file.txt");
        let words = ["python3", "files.py", file.to_str().unwrap()];
        let mut launch = launch_in(place.path(), isolation, &words);
        launch.cells.hidden =
            ["hidden/deep", "hidden", "hidden", "not/there"].map(|folder| launch.dir.join(folder)).into();
        let before = tree(&launch.dir);
        let text = || run(&launch).1.output.stdout.text();
        let (first, second) = (text(), text());
        let lines = [&first, &second].map(|t| t.lines().collect::<Vec<_>>());
        let paths = format!("{} /tmp/.hrdsl-cell/home /tmp/.hrdsl-cell/tmp", launch.dir.display());
        assert_eq!(lines[0][0], format!("[1, 1, 1, 1] {paths}"));
        assert!(lines.iter().all(|l| l[1].ends_with(" False False")), "{first}");
        assert_eq!(tree(&launch.dir), before, "and changes nothing");
        if isolation == CellIsolation::Namespaces {
            assert_eq!(first, second, "every test finds the same");
            assert_eq!(lines[0][1], "2 False False", "the same process number, too");
            assert!(!file.exists());
        } else {
            assert_eq!(lines[1][0], format!("[1, 1, 1, 2] {paths}"), "but for what lies elsewhere");
        }
    }
}

#[test]
fn files_are_kept_on_request() {
    for isolation in BOTH {
        let (place, kept) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let elsewhere = tempfile::tempdir_in("/var/tmp").unwrap();
        let file = elsewhere.path().join("file.txt");
        let mut launch = launch_in(place.path(), isolation, &["python3", "files.py", file.to_str().unwrap()]);
        launch.keep = Some(kept.path().join("t1"));
        let finished = run(&launch).1;
        let mut expected: Vec<String> = Vec::new();
        if isolation == CellIsolation::Namespaces {
            expected.push(format!("elsewhere{}", file.display()));
        }
        expected.extend(
            ["home/state.txt", "project/hello.py", "project/log.txt", "tmp/cache.txt"].map(String::from),
        );
        let found: Vec<String> = tree(&kept.path().join("t1")).into_iter().map(|(name, _)| name).collect();
        assert_eq!(found, expected, "{isolation:?}");
        assert_eq!(finished.kept.unwrap().failures, Vec::<String>::new());
    }
}

#[test]
fn nothing_outlives_a_cell() {
    for (isolation, end) in BOTH.into_iter().flat_map(|i| [(i, true), (i, false)]) {
        let place = tempfile::tempdir().unwrap();
        let mark = format!("hrdsl-mark-{}-{isolation:?}-{end}", std::process::id());
        let launch = launch_in(place.path(), isolation, &["python3", "leaves.py", &mark]);
        let mut process = SutProcess::spawn(&launch).unwrap();
        assert!(matches!(process.next().unwrap(), ProgramRequest::Hello { .. }));
        reply(&mut process, 0, ReplyAnswer::Ok);
        assert!(matches!(process.next().unwrap(), ProgramRequest::Emit { .. }));
        // One that is just becoming another program has no command line for a moment.
        until(|| marked(&mark).len() == 4, "the program and three that it started");
        reply(&mut process, 0, ReplyAnswer::Ok);
        if end {
            let finished = process.finish(GRACE);
            assert!(finished.others);
            assert_eq!(finished.exit, ProgramExit::Code(0), "{}", finished.output);
        } else {
            drop(process);
        }
        assert_eq!(marked(&mark), Vec::<String>::new(), "{isolation:?}");
    }
}

#[test]
fn a_program_does_not_escape_by_its_supervisor() {
    for signal in ["SIGKILL", "SIGTERM", "SIGSTOP"] {
        let place = tempfile::tempdir().unwrap();
        let mark = format!("hrdsl-mark-{}-{signal}", std::process::id());
        fs::write(place.path().join(&mark), "").unwrap();
        let words = ["python3", "reaches.py", "parent", &mark, signal];
        let mut launch = launch_in(place.path(), CellIsolation::Copies, &words);
        launch.limits.budget = Duration::from_secs(1);
        let mut process = SutProcess::spawn(&launch).unwrap();
        assert!(matches!(process.next().unwrap(), ProgramRequest::Hello { .. }));
        reply(&mut process, 0, ReplyAnswer::Ok);
        let error = process.next().unwrap_err();
        // One that is stopped goes on at once, and watches the budget.
        let stopped = matches!(error, SutError::Overrun { overrun: LimitOverrun::Budget(_), .. });
        assert!(
            matches!(error, SutError::Exited { .. }) || signal == "SIGSTOP" && stopped,
            "{signal}: {error}"
        );
        let _ = process.finish(Duration::ZERO);
        assert_eq!(marked(&mark), Vec::<String>::new(), "{signal}");
        assert_eq!(leftovers(&mark), Vec::<PathBuf>::new(), "{signal}");
    }
}

#[test]
fn nothing_beyond_the_cell_is_within_reach() {
    let place = tempfile::tempdir().unwrap();
    let launch = launch_in(place.path(), CellIsolation::Namespaces, &["python3", "reaches.py", "beyond"]);
    assert_eq!(run(&launch).1.output.stdout.text(), "[False, False, False, False]\n");
}

/// The supervisor sees the harness's death by its socket: so it does here, where the harness is a process that is killed.
#[test]
fn nothing_outlives_the_harness() {
    for isolation in BOTH {
        let mark = format!("hrdsl-mark-{}-{isolation:?}-kill", std::process::id());
        let mut harness = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "a_harness_that_will_be_killed", "--ignored", "--nocapture"])
            .env("HRDSL_MARK", &mark)
            .env("HRDSL_COPIES", if isolation == CellIsolation::Copies { "1" } else { "0" })
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        until(|| marked(&mark).len() == 4, "the program runs");
        harness.kill().unwrap();
        harness.wait().unwrap();
        until(|| marked(&mark).is_empty(), "everything is gone");
        until(|| leftovers(&mark).is_empty(), "and its folders");
    }
}

#[test]
#[ignore = "run by the test above, which kills it"]
fn a_harness_that_will_be_killed() {
    let Ok(mark) = std::env::var("HRDSL_MARK") else { return };
    let copies = std::env::var("HRDSL_COPIES").as_deref() == Ok("1");
    let isolation = if copies { CellIsolation::Copies } else { CellIsolation::Namespaces };
    let place = tempfile::tempdir().unwrap();
    fs::write(place.path().join(&mark), "").unwrap();
    let launch = launch_in(place.path(), isolation, &["python3", "leaves.py", &mark]);
    let mut process = SutProcess::spawn(&launch).unwrap();
    let _ = process.next();
    reply(&mut process, 0, ReplyAnswer::Ok);
    let _ = process.next();
    std::thread::sleep(Duration::from_secs(1000));
}

#[test]
fn limits_are_of_what_the_program_uses() {
    let overrun = |what: &str, change: &dyn Fn(&mut LaunchSpec)| {
        let mut launch = launch(&["python3", "uses.py", what]);
        change(&mut launch);
        let mut process = SutProcess::spawn(&launch).unwrap();
        let mut time = 0;
        let error = loop {
            match process.next() {
                Ok(ProgramRequest::Sleep { seconds }) => time += hrdsl_ir::value::nanos(seconds),
                Ok(_) => {}
                Err(error) => break error,
            }
            reply(&mut process, time, ReplyAnswer::Ok);
        };
        let _ = process.finish(Duration::ZERO);
        let SutError::Overrun { overrun, .. } = error else { panic!("{error}") };
        overrun
    };
    let short = Duration::from_millis(500);
    let budget = |launch: &mut LaunchSpec| launch.limits.budget = short;
    assert_eq!(overrun("cpu", &budget), LimitOverrun::Budget(short));
    assert_eq!(overrun("sleep", &budget), LimitOverrun::Asleep(short));
    assert_eq!(overrun("cpu-between-requests", &|l| l.limits.cpu = short), LimitOverrun::Cpu(short));
    assert_eq!(overrun("sleep", &|l| l.limits.wall = short), LimitOverrun::Wall(short));
    assert_eq!(overrun("output", &|l| l.limits.output = 1 << 20), LimitOverrun::Output(1 << 20));
}

#[test]
fn memory_ends_at_the_same_place_in_every_run() {
    let mut launch = launch(&["python3", "uses.py", "memory"]);
    launch.limits.memory = 200 << 20;
    let first = run(&launch).1.output.stdout.text();
    assert!(first.starts_with("memory error after 1"), "{first}");
    assert_eq!(first, run(&launch).1.output.stdout.text());
}

#[test]
fn other_processes_are_noticed_and_secrets_are_not_handed_on() {
    for isolation in BOTH {
        let with = |what: &str| {
            let mut launch = launch(&["python3", "uses.py", what]);
            launch.cells = cells(Some(isolation));
            launch.variables = vec![("ROBOT_NAME".into(), "bert".into())];
            run(&launch).1
        };
        assert!(with("children").others);
        let plain = with("environment");
        assert!(!plain.others);
        let text = plain.output.stdout.text();
        assert!(
            text.contains("'ROBOT_NAME'") && text.contains("'HOME'") && !text.contains("CARGO"),
            "{text}"
        );
        assert_eq!(
            with("signals").output.stdout.text(),
            "set() 0 1\n",
            "nothing blocked, and as Python has it"
        );
        assert_eq!(with("addresses").output.stdout.text(), with("addresses").output.stdout.text());
    }
}

#[test]
fn what_cannot_be_kept_apart_is_said() {
    assert_eq!(cells(Some(CellIsolation::Namespaces)).gaps, Vec::<String>::new());
    let gaps = cells(Some(CellIsolation::Copies)).gaps;
    assert!(gaps.iter().any(|g| g.contains("absolute paths elsewhere")), "{gaps:?}");
}

/// Command lines of living processes that have this word.
fn marked(mark: &str) -> Vec<String> {
    let line = |pid: PathBuf| {
        let line = fs::read(pid.join("cmdline")).ok()?;
        let words: Vec<String> =
            line.split(|b| *b == 0).map(|w| String::from_utf8_lossy(w).into_owned()).collect();
        // The supervisor's own processes and this test's do not have it.
        words.iter().any(|w| w == mark).then(|| words.join(" "))
    };
    fs::read_dir("/proc").unwrap().filter_map(|e| line(e.unwrap().path())).collect()
}

/// Cells' folders whose project has a file of this name.
fn leftovers(mark: &str) -> Vec<PathBuf> {
    let folders = fs::read_dir(std::env::temp_dir()).unwrap().filter_map(|e| Some(e.ok()?.path()));
    folders
        .filter(|f| f.to_string_lossy().contains("hrdsl-cell-") && f.join("project").join(mark).exists())
        .collect()
}

fn until(holds: impl Fn() -> bool, what: &str) {
    let end = Instant::now() + Duration::from_secs(60);
    while !holds() {
        assert!(Instant::now() < end, "{what}: not within a minute");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// All files in and below a folder, with their texts.
fn tree(root: &Path) -> Vec<(String, Vec<u8>)> {
    let mut found = Vec::new();
    let mut open = vec![root.to_owned()];
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(&folder).unwrap().map(Result::unwrap) {
            if entry.file_type().unwrap().is_dir() {
                open.push(entry.path());
            } else {
                let name = entry.path().strip_prefix(root).unwrap().display().to_string();
                found.push((name, fs::read(entry.path()).unwrap()));
            }
        }
    }
    found.sort();
    found
}
