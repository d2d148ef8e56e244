//! Runs that a fork server forks: the same as those that are started anew, and the same whatever ran before.

mod common;

use std::{fs, path::Path, process::Command};

use common::{GRACE, YesHarness, launch, reply};
use hrdsl_sut::{FinishedProcess, ForkServer, LaunchSpec, ProgramExit, ProgramRequest, SutError, SutProcess};

/// Runs a program to its normal end.
fn finish(mut process: SutProcess) -> FinishedProcess {
    let mut harness = YesHarness::default();
    loop {
        let request = process.next().unwrap();
        let answer = harness.answer(&request);
        reply(&mut process, harness.time, answer);
        if request == ProgramRequest::Done {
            return process.finish(GRACE);
        }
    }
}

fn forked(launch: &LaunchSpec, server: &mut ForkServer) -> FinishedProcess {
    finish(SutProcess::fork(launch, server).unwrap())
}

fn server(launch: &LaunchSpec) -> ForkServer {
    ForkServer::start(launch, &ForkServer::find_modules(launch).unwrap()).unwrap()
}

#[test]
fn a_fork_finds_what_a_fresh_process_does() {
    let launch = launch(&["python3", "within.py"]);
    let (fresh, forked) =
        (finish(SutProcess::spawn(&launch).unwrap()), forked(&launch, &mut server(&launch)));
    assert_eq!(fresh.exit, ProgramExit::Code(0), "{}", fresh.output);
    assert_eq!(forked.output.stdout.text(), fresh.output.stdout.text(), "{}", forked.output.stderr.text());
    assert_eq!((forked.exit, forked.others), (fresh.exit, fresh.others));
}

#[test]
fn a_run_depends_neither_on_the_server_nor_on_the_runs_before() {
    let mut launch = launch(&["python3", "within.py", "addresses"]);
    launch.coverage = vec!["within.py".into()];
    let (mut one, mut other) = (server(&launch), server(&launch));
    let first = forked(&launch, &mut one);
    assert_eq!(first.exit, ProgramExit::Code(0), "{}", first.output);
    launch.seed = 12345;
    for _ in 0..20 {
        assert_ne!(forked(&launch, &mut one).output.stdout.text(), first.output.stdout.text());
    }
    launch.seed = 17;
    for server in [&mut one, &mut other] {
        let later = forked(&launch, server);
        assert_eq!(later.output.stdout.text(), first.output.stdout.text());
        assert_eq!(later.coverage, first.coverage);
    }
    assert!(!first.coverage.unwrap()[0].executed.is_empty());
}

#[test]
fn files_of_a_fork_are_kept_on_request() {
    let kept = tempfile::tempdir().unwrap();
    let mut launch = launch(&["python3", "within.py"]);
    let mut server = server(&launch);
    launch.keep = Some(kept.path().join("t1"));
    let finished = forked(&launch, &mut server);
    assert_eq!(finished.kept.unwrap().failures, Vec::<String>::new());
    assert_eq!(fs::read_to_string(kept.path().join("t1/project/within.txt")).unwrap(), "text");
    assert!(!launch.dir.join("within.txt").exists());
}

#[test]
fn a_server_that_somebody_kills_is_started_again() {
    let mark = format!("hrdsl-fork-{}", std::process::id());
    let launch = launch(&["python3", "within.py", &mark]);
    let mut server = server(&launch);
    let first = forked(&launch, &mut server);
    for _ in 0..2 {
        for pid in marked(&mark) {
            assert!(Command::new("kill").args(["-KILL", &pid]).status().unwrap().success());
        }
        assert_eq!(forked(&launch, &mut server).output.stdout.text(), first.output.stdout.text());
    }
    drop(server);
    assert_eq!(marked(&mark), Vec::<String>::new(), "nothing outlives the server's handle");
}

#[test]
fn a_test_goes_on_when_the_server_is_killed() {
    let mark = format!("hrdsl-fork-{}-on", std::process::id());
    let launch = launch(&["python3", "within.py", &mark]);
    let mut server = server(&launch);
    let before = marked(&mark);
    let process = SutProcess::fork(&launch, &mut server).unwrap();
    // One of them may have been forked for the first test already: it is this test's supervisor by now, and has another command line.
    let server: Vec<String> = marked(&mark).into_iter().filter(|pid| before.contains(pid)).collect();
    assert!(!server.is_empty(), "{before:?}");
    for pid in server {
        let _ = Command::new("kill").args(["-KILL", &pid]).status().unwrap();
    }
    assert_eq!(finish(process).exit, ProgramExit::Code(0));
}

#[test]
fn there_is_no_server_for_what_cannot_be_forked() {
    assert!(!launch(&["python3"]).can_fork() && !launch(&["./within.py"]).can_fork());
    let launch = launch(&["python3", "within.py"]);
    assert!(launch.can_fork());
    let why = ForkServer::start(&launch, &["no_such_module".to_owned()]).unwrap_err();
    let SutError::Io { source, .. } = &why else { panic!("{why}") };
    assert!(source.to_string().ends_with("No module named 'no_such_module'"), "{why}");
}

/// The numbers of the processes whose command lines have this word.
fn marked(mark: &str) -> Vec<String> {
    let has = |folder: &Path| {
        fs::read(folder.join("cmdline")).is_ok_and(|l| l.split(|b| *b == 0).any(|w| w == mark.as_bytes()))
    };
    let number = |folder: &Path| folder.file_name()?.to_str().map(str::to_owned);
    let folders = fs::read_dir("/proc").unwrap().map(|e| e.unwrap().path());
    folders.filter(|f| has(f)).filter_map(|f| number(&f)).collect()
}
