//! `hrdsl sim` against programs that do what programs should not, and against people who interrupt it: no result is lost, none
//! is false, and nothing is left running.
#![allow(clippy::disallowed_methods, reason = "tests start processes and read files")]

mod support;

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    time::{Duration, Instant},
};

use serde_json::Value;
use support::{command, expect_code, hrdsl_in, stderr, stdout, tree};

const SCENARIO: &str = r#"scenario mini

actor person : environment
actor robot  : system

event asked from person to robot
event said(n: 0..9) from robot

stimulus ask by person { emit asked }

require R1 functional "who asks is answered" asked causes said(_) within 5 s

cover asks    = count(asked)   bins none = 0, some = 1..
cover answers = count(said(_)) bins none = 0, some = 1..
cross talk = asks * answers {
  bin "asked"    when asks.some
  bin "answered" when answers.some
}

system robot {
  run "python3 robot.py"
  limit 20 s
  budget 5 s
}
"#;

const GOOD: &str = "
import hrdsl
node = hrdsl.Node('robot')
while True:
    node.wait_for('asked')
    node.emit('said', n=1)
";

/// A project with this robot and so many tests that ask once.
fn project(robot: &str, tests: usize) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let text: String =
        (1..=tests).map(|n| format!("test hand.t{n:02} {{ seed {n}; ask; wait 1 s }}\n")).collect();
    fs::write(folder.path().join("scenario.hri"), SCENARIO).unwrap();
    fs::write(folder.path().join("robot.py"), robot).unwrap();
    fs::write(folder.path().join("tests.hri"), text).unwrap();
    folder
}

fn sim(folder: &Path, more: &str) -> std::process::Output {
    hrdsl_in(folder, &format!("sim scenario.hri tests.hri -o out {more}"))
}

fn results(folder: &Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("out/results.json")).unwrap()).unwrap()
}

fn errors(folder: &Path) -> Vec<String> {
    let results = results(folder);
    let tests = results["tests"].as_array().unwrap();
    tests.iter().map(|t| t["error"].as_str().unwrap_or_default().to_owned()).collect()
}

#[test]
fn waits_that_let_no_time_pass_end_with_an_error() {
    let robot = "import hrdsl\nn = hrdsl.Node('robot')\nwhile True:\n    n.wait_for('asked', timeout=0)\n";
    let folder = project(robot, 1);
    expect_code(&sim(folder.path(), ""), 3);
    let error = &errors(folder.path())[0];
    assert!(error.contains("requests without letting simulated time pass"), "{error}");
    // Many requests at each of many instants are none too many.
    let robot = "import hrdsl\nnode = hrdsl.Node('robot')\nfor n in range(2000):\n    for k in range(60):\n        node.now()\n    node.sleep(0.01)\nnode.wait_for('asked')\nnode.emit('said', n=1)\n";
    let folder = project(robot, 1);
    sim(folder.path(), "");
    assert_eq!(errors(folder.path()), [""]);
}

/// Sixteen programs at once on few cores, each of which computes for a second: nobody's budget is used up by the others.
#[test]
fn load_changes_no_verdict() {
    let robot = "
import hrdsl
node = hrdsl.Node('robot')
node.wait_for('asked')
n = 0
for i in range(8_000_000):
    n += i
node.emit('said', n=1)
";
    let folder = project(robot, 16);
    fs::write(folder.path().join("scenario.hri"), SCENARIO.replace("budget 5 s", "budget 8 s")).unwrap();
    expect_code(&sim(folder.path(), "-j 16"), 0);
    assert_eq!(errors(folder.path()), vec![""; 16]);
}

/// The first run of each test sleeps where simulated time does not reach; the second, alone, finds out by a file that lies
/// outside its copy and goes on. One of them always sleeps.
#[test]
fn a_test_that_wall_time_ends_is_run_again_alone_and_marked() {
    let outside = tempfile::tempdir_in("/var/tmp").unwrap();
    let robot = format!(
        "
import ctypes, os, hrdsl
node = hrdsl.Node('robot')
mark = '{}/%d' % node.seed
if node.seed == 3 or not os.path.exists(mark):
    open(mark, 'w').close()
    ctypes.CDLL(None).pause()
node.wait_for('asked')
node.emit('said', n=1)
",
        outside.path().display()
    );
    let folder = project(&robot, 3);
    fs::write(folder.path().join("scenario.hri"), SCENARIO.replace("budget 5 s", "budget 1 s")).unwrap();
    let out = sim(folder.path(), "-j 2 --isolation copies");
    expect_code(&out, 3);
    let results = results(folder.path());
    let marks: Vec<&Value> = results["tests"].as_array().unwrap().iter().map(|t| &t["marks"]).collect();
    let depends = serde_json::json!(["depends_on_load"]);
    assert_eq!(marks, [&depends, &depends, &Value::Null]);
    let errors = errors(folder.path());
    assert_eq!(errors[..2], ["", ""]);
    assert!(errors[2].contains("it slept for 1 s of wall time"), "{}", errors[2]);
    assert!(stdout(&out).contains("depends on load"), "{}", stdout(&out));
}

#[test]
fn a_test_that_broke_off_hits_no_bin_and_its_output_is_kept() {
    let robot = "import sys, hrdsl\nnode = hrdsl.Node('robot')\nnode.wait_for('asked')\nprint('got it')\nnode.emit('said', n=1)\nsys.exit('no more today')\n";
    let folder = project(robot, 2);
    let out = sim(folder.path(), "");
    expect_code(&out, 3);
    let results = results(folder.path());
    for bin in results["bins"].as_array().unwrap() {
        assert_eq!(bin["hits"], serde_json::json!([0]), "{bin}");
    }
    let text = stdout(&out);
    assert!(text.contains("its last line on stderr: no more today"), "{text}");
    assert!(text.contains("  hrdsl sim ../scenario.hri ../tests.hri --test hand.t01\n"), "{text}");
    for report in ["report.html", "junit.xml"] {
        let text = fs::read_to_string(folder.path().join("out").join(report)).unwrap().replace("&#x2f;", "/");
        assert!(text.contains("hrdsl sim ../scenario.hri ../tests.hri --test hand.t01"), "{report}");
    }
    let output = fs::read_to_string(folder.path().join("out/output/mini.hand.t01.txt")).unwrap();
    assert_eq!(output, "── stdout ──\ngot it\n── stderr ──\nno more today\n");
    // And the command does what it says.
    let again = hrdsl_in(&folder.path().join("out"), "sim ../scenario.hri ../tests.hri --test hand.t01");
    expect_code(&again, 3);
    assert!(stdout(&again).contains("\n1 test, "), "{}", stdout(&again));
    let unknown = sim(folder.path(), "--test hand.t99");
    expect_code(&unknown, 2);
    assert!(
        stderr(&unknown).contains("no test is called `hand.t99`; there are hand.t01, hand.t02"),
        "{}",
        stderr(&unknown)
    );
}

#[test]
fn an_exception_in_a_thread_is_in_the_output_of_a_test_that_passes() {
    let robot = "import threading, hrdsl\nnode = hrdsl.Node('robot')\nt = threading.Thread(target=lambda: 1 / 0)\nt.start()\nt.join()\nnode.wait_for('asked')\nnode.emit('said', n=1)\n";
    let folder = project(robot, 1);
    expect_code(&sim(folder.path(), ""), 0);
    let output = fs::read_to_string(folder.path().join("out/output/mini.hand.t01.txt")).unwrap();
    assert!(output.contains("ZeroDivisionError"), "{output}");
    let page = fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    assert!(page.contains("ZeroDivisionError"));
}

#[test]
fn one_that_never_speaks_is_told_from_one_that_dies() {
    let folder = project("import os\nos._exit(4)\n", 1);
    expect_code(&sim(folder.path(), ""), 3);
    assert!(
        errors(folder.path())[0].contains("it never spoke to the harness"),
        "{:?}",
        errors(folder.path())
    );
}

/// With namespaces and without: neither what earlier tests wrote, nor the order and number of tests, changes a result.
#[test]
fn tests_do_not_see_each_others_files() {
    let robot = "
import os, hrdsl
node = hrdsl.Node('robot')
with open('log.txt', 'a') as file:
    file.write('once more\\n')
n = len(open('log.txt').readlines()) + len(os.listdir(os.path.expanduser('~')))
open(os.path.expanduser('~/seen'), 'w').close()
node.wait_for('asked')
print(n, sorted(os.listdir('.')))
node.emit('said', n=min(n, 9))
";
    for isolation in ["namespaces", "copies"] {
        let folder = project(robot, 3);
        let run = |jobs: &str| {
            expect_code(&sim(folder.path(), &format!("-j {jobs} --isolation {isolation}")), 0);
            tree(&folder.path().join("out"))
        };
        let first = run("1");
        assert!(first == run("3"), "{isolation}");
        let output = String::from_utf8(first["output/mini.hand.t03.txt"].clone()).unwrap();
        assert!(output.starts_with("── stdout ──\n1 ['log.txt', "), "{output}");
        assert!(!output.contains("'out'"), "results are not for the programs to see: {output}");
        assert!(!folder.path().join("log.txt").exists());
    }
}

#[test]
fn files_are_kept_for_whoever_asks() {
    let robot = "import hrdsl\nnode = hrdsl.Node('robot')\nopen('log.txt', 'w').write('kept')\nopen('own.jsonl', 'w').write('{}')\nnode.wait_for('asked')\nnode.emit('said', n=1)\n";
    let folder = project(robot, 2);
    expect_code(&sim(folder.path(), "--keep-files"), 0);
    for test in ["t01", "t02"] {
        let path = folder.path().join(format!("out/files/mini.hand.{test}/project/log.txt"));
        assert_eq!(fs::read_to_string(path).unwrap(), "kept");
    }
    // What the robot wrote is no recording.
    expect_code(&hrdsl_in(folder.path(), "judge scenario.hri out"), 0);
}

#[test]
fn secrets_stay_with_the_user() {
    let robot = "import os, hrdsl\nnode = hrdsl.Node('robot')\nprint(sorted(os.environ.items()))\nnode.wait_for('asked')\nnode.emit('said', n=1)\n";
    let folder = project(robot, 1);
    let with_env = SCENARIO.replace("limit 20 s", "limit 20 s\n  env ROBOT_NAME, NOT_SET");
    fs::write(folder.path().join("scenario.hri"), with_env).unwrap();
    let mut command = command();
    command.args(["sim", "scenario.hri", "tests.hri", "-o", "out"]).current_dir(folder.path());
    expect_code(&command.env("API_TOKEN", "hunter2").env("ROBOT_NAME", "bert").output().unwrap(), 0);
    for (name, bytes) in tree(&folder.path().join("out")) {
        assert!(!String::from_utf8_lossy(&bytes).contains("hunter2"), "{name}");
    }
    let output = fs::read_to_string(folder.path().join("out/output/mini.hand.t01.txt")).unwrap();
    assert!(output.contains("('ROBOT_NAME', 'bert')") && !output.contains("NOT_SET"), "{output}");
}

#[test]
fn what_is_not_repeatable_is_named() {
    let folder = project(GOOD, 2);
    let out = sim(folder.path(), "--repeat 5");
    expect_code(&out, 0);
    assert!(stdout(&out).contains("2 tests ran 5 times, byte for byte the same"), "{}", stdout(&out));
    let robot = "
import hrdsl
node = hrdsl.Node('robot')
n = open('/dev/urandom', 'rb').read(8)
node.wait_for('asked')
for byte in n:
    node.emit('said', n=byte % 10)
";
    let folder = project(robot, 2);
    let out = sim(folder.path(), "--check-determinism");
    expect_code(&out, 3);
    let text = stdout(&out);
    assert!(
        text.contains("2 of 2 tests differ between two runs") && text.contains("mini.hand.t01, run 2: step "),
        "{text}"
    );
}

#[test]
fn limits_are_said_in_the_scenario_and_on_the_command_line() {
    let robot = "
import hrdsl
node = hrdsl.Node('robot')
node.wait_for('asked')
try:
    taken = bytearray(400_000_000)
    node.emit('said', n=2)
except MemoryError:
    node.emit('said', n=1)
for n in range(2_000):
    print('x' * 1_000)
for n in range(8_000_000):
    pass
node.sleep(1)
";
    let folder = project(robot, 1);
    let with = |members: &str, options: &str| -> ([bool; 2], String) {
        let scenario = SCENARIO.replace("limit 20 s", &format!("limit 20 s\n  {members}"));
        fs::write(folder.path().join("scenario.hri"), scenario).unwrap();
        sim(folder.path(), options);
        let trace = tree(&folder.path().join("out/traces")).into_values().next().unwrap();
        let said = String::from_utf8(trace).unwrap();
        let said = ["\"n\":1", "\"n\":2"].map(|n| said.contains(n));
        (said, errors(folder.path())[0].clone())
    };
    assert_eq!(with("", ""), ([false, true], String::new()));
    assert_eq!(with("memory 200 MB", "").0, [true, false]);
    assert_eq!(with("memory 200 MB", "--memory-limit 1GB").0, [false, true]);
    assert!(with("output 1 MB", "").1.contains("more than 1000000 bytes of output"));
    assert!(with("", "--output-limit 1MB").1.contains("more than 1000000 bytes of output"));
    // Processor time is looked at from time to time; this program takes longer than that.
    assert!(with("cpu 1 ms", "").1.contains("more than 0.001 s of processor time"));
}

#[test]
fn a_long_name_is_the_name_of_a_file_all_the_same() {
    let folder = project(GOOD, 0);
    let long = "x".repeat(300);
    fs::write(folder.path().join("tests.hri"), format!("test {long} {{ ask; wait 1 s }}\n")).unwrap();
    expect_code(&sim(folder.path(), ""), 0);
    let names: Vec<String> = tree(&folder.path().join("out/traces")).into_keys().collect();
    assert!(names.len() == 1 && names[0].len() < 220, "{names:?}");
}

#[test]
fn a_debugger_has_the_terminal_and_interrupts_are_for_it() {
    let robot = "import hrdsl\nnode = hrdsl.Node('robot')\nx = 41\nbreakpoint()\nnode.wait_for('asked')\nnode.emit('said', n=x - 40)\n";
    for isolation in ["namespaces", "copies"] {
        let folder = project(robot, 2);
        let words =
            format!("sim scenario.hri tests.hri -o out --test hand.t01 --debug --isolation {isolation}");
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/debug_session.py");
        let mut session = Command::new("python3");
        session.arg(script).arg(folder.path()).arg(env!("CARGO_BIN_EXE_hrdsl")).args(words.split(' '));
        let out = session.env("NO_COLOR", "1").env("HRDSL_CACHE", support::root().join("target/hrdsl-cache"));
        let out = out.output().unwrap();
        expect_code(&out, 0);
        let shown = stdout(&out);
        assert!(shown.contains("41"), "{shown}");
        let trace = tree(&folder.path().join("out/traces")).into_values().next().unwrap();
        assert!(String::from_utf8(trace).unwrap().contains("\"n\":5"), "what was typed counts: {shown}");
    }
    let folder = project(robot, 2);
    let out = sim(folder.path(), "");
    expect_code(&out, 3);
    assert!(
        errors(folder.path())[0].contains("hrdsl sim --test NAME --debug"),
        "{:?}",
        errors(folder.path())
    );
}

// ── results folders ──

#[test]
fn nothing_of_the_users_is_overwritten_or_removed() {
    let folder = project(GOOD, 1);
    let out = folder.path().join("out");
    fs::create_dir_all(out.join("traces")).unwrap();
    fs::write(out.join("traces/mine.txt"), "mine").unwrap();
    fs::write(out.join("notes.md"), "mine").unwrap();
    let refused = sim(folder.path(), "");
    expect_code(&refused, 2);
    assert!(stderr(&refused).contains("traces/mine.txt was not written by hrdsl"), "{}", stderr(&refused));
    fs::remove_file(out.join("traces/mine.txt")).unwrap();
    for _ in 0..2 {
        expect_code(&sim(folder.path(), ""), 0);
        assert_eq!(fs::read_to_string(out.join("notes.md")).unwrap(), "mine");
    }
}

#[test]
fn a_second_run_into_the_same_folder_is_refused() {
    let slow = "import hrdsl\nnode = hrdsl.Node('robot')\nfor i in range(10**9):\n    pass\n";
    let folder = project(slow, 1);
    let mut first = begin(folder.path(), "");
    until(|| folder.path().join("out/.hrdsl-partial").exists(), "the first run has begun");
    let second = sim(folder.path(), "");
    expect_code(&second, 2);
    assert!(stderr(&second).contains("another run is writing to out"), "{}", stderr(&second));
    first.kill().unwrap();
    first.wait().unwrap();
}

// ── interrupts ──

fn begin(folder: &Path, more: &str) -> std::process::Child {
    let mut command = command();
    command.args(format!("sim scenario.hri tests.hri -o out {more}").split_whitespace()).current_dir(folder);
    command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap()
}

fn until(holds: impl Fn() -> bool, what: &str) {
    let end = Instant::now() + Duration::from_secs(120);
    while !holds() {
        assert!(Instant::now() < end, "{what}: not within two minutes");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Living processes whose command line has this word.
fn running(mark: &str) -> usize {
    let has = |pid: PathBuf| {
        fs::read(pid.join("cmdline")).is_ok_and(|l| l.split(|b| *b == 0).any(|w| w == mark.as_bytes()))
    };
    fs::read_dir("/proc").unwrap().filter(|e| has(e.as_ref().unwrap().path())).count()
}

/// Its first tests end at once, all others never; each leaves a daemon behind.
fn endless(mark: &str) -> String {
    format!(
        "
import os, signal, subprocess, sys, hrdsl
node = hrdsl.Node('robot')
if node.seed > 2:
    sleeper = [sys.executable, '-c', 'import signal, time; signal.signal(signal.SIGTERM, signal.SIG_IGN); time.sleep(1000)', '{mark}']
    subprocess.Popen(sleeper, start_new_session=True)
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    while True:
        pass
node.wait_for('asked')
node.emit('said', n=1)
"
    )
}

#[test]
fn an_interrupted_campaign_publishes_what_it_has_and_leaves_nothing_running() {
    for (isolation, signal) in [("namespaces", "INT"), ("copies", "TERM")] {
        let mark = format!("hrdsl-robust-{}-{signal}", std::process::id());
        let folder = project(&endless(&mark), 4);
        let scenario = SCENARIO.replace("budget 5 s", "budget 500 s");
        fs::write(folder.path().join("scenario.hri"), scenario).unwrap();
        let run = begin(folder.path(), &format!("-j 1 --isolation {isolation}"));
        until(|| running(&mark) == 1, "the third test runs");
        let kill = Command::new("kill").args([&format!("-{signal}"), &run.id().to_string()]).status();
        assert!(kill.unwrap().success());
        let out = run.wait_with_output().unwrap();
        expect_code(&out, 5);
        assert_eq!(running(&mark), 0, "{signal}");
        let results = results(folder.path());
        assert_eq!((&results["interrupted"], &results["planned"]), (&Value::Bool(true), &Value::from(4)));
        assert_eq!(results["tests"].as_array().unwrap().len(), 2);
        assert_eq!(tree(&folder.path().join("out/traces")).len(), 2);
        assert!(stdout(&out).contains("interrupted: 2 of 4 tests had not ended"), "{}", stdout(&out));
    }
}

#[test]
fn a_killed_campaign_leaves_nothing_running_and_the_earlier_results() {
    for isolation in ["namespaces", "copies"] {
        let mark = format!("hrdsl-robust-{}-KILL-{isolation}", std::process::id());
        let folder = project(GOOD, 4);
        expect_code(&sim(folder.path(), ""), 0);
        let before = tree(&folder.path().join("out"));
        fs::write(folder.path().join("robot.py"), endless(&mark)).unwrap();
        let mut run = begin(folder.path(), &format!("-j 2 --isolation {isolation}"));
        until(|| running(&mark) == 2, "two tests run");
        run.kill().unwrap();
        run.wait().unwrap();
        until(|| running(&mark) == 0, "everything is gone");
        let mut after = tree(&folder.path().join("out"));
        after.retain(|name, _| !name.starts_with(".hrdsl-partial"));
        assert!(before == after, "the earlier results are as they were");
        fs::write(folder.path().join("robot.py"), GOOD).unwrap();
        expect_code(&sim(folder.path(), ""), 0);
        assert!(!folder.path().join("out/.hrdsl-partial").exists());
    }
}

// ── what the system refuses ──

/// Runs a script in namespaces of its own as their root, if the system lets ordinary tools do so.
fn as_root_of_namespaces(folder: &Path, script: &str) -> Option<std::process::Output> {
    let mut probe = Command::new("unshare");
    if !probe.args(["-Urm", "true"]).stderr(Stdio::null()).status().is_ok_and(|s| s.success()) {
        return None;
    }
    let mut command = Command::new("unshare");
    command.args(["-Urm", "sh", "-c", script]).current_dir(folder).env("HRDSL", env!("CARGO_BIN_EXE_hrdsl"));
    command.env("NO_COLOR", "1").env("HRDSL_CACHE", support::root().join("target/hrdsl-cache"));
    Some(command.output().unwrap())
}

#[test]
fn where_namespaces_are_refused_tests_run_in_copies_and_it_is_said_once() {
    let folder = project(GOOD, 2);
    let script = "echo 0 > /proc/sys/user/max_user_namespaces; echo 0 > /proc/sys/user/max_pid_namespaces; \
                  exec $HRDSL sim scenario.hri tests.hri -o out";
    let Some(out) = as_root_of_namespaces(folder.path(), script) else { return };
    expect_code(&out, 0);
    let said = stderr(&out);
    assert_eq!(said.matches("namespaces cannot be had here").count(), 1, "{said}");
    assert!(said.contains("absolute paths elsewhere"), "{said}");
    let run: Value = serde_json::from_slice(&fs::read(folder.path().join("out/run.json")).unwrap()).unwrap();
    assert_eq!(run["isolation"], "copies");
}

#[test]
fn a_project_on_several_file_systems_is_as_much_its_own() {
    let robot = "
import os, hrdsl
node = hrdsl.Node('robot')
for path in ['log.txt', 'disk/log.txt', 'disk/deep/log.txt', 'data.txt']:
    with open(path, 'a') as file:
        file.write('x')
    assert os.path.getsize(path) == 1 + 4 * (path == 'data.txt'), path
node.wait_for('asked')
node.emit('said', n=1)
";
    let folder = project(robot, 2);
    fs::create_dir(folder.path().join("disk")).unwrap();
    fs::write(folder.path().join("data.txt"), "data").unwrap();
    // A neighbour that takes much room takes nothing from the other files.
    fs::write(folder.path().join("big.bin"), vec![1; 20 << 20]).unwrap();
    let script = "mount -t tmpfs tmpfs disk && mkdir disk/deep && mount -t tmpfs tmpfs disk/deep && \
                  $HRDSL sim scenario.hri tests.hri -j 1 --isolation namespaces -o out";
    let Some(out) = as_root_of_namespaces(folder.path(), script) else { return };
    expect_code(&out, 0);
    assert!(!folder.path().join("log.txt").exists());
    assert_eq!(fs::read_to_string(folder.path().join("data.txt")).unwrap(), "data");
}

#[test]
fn a_full_disk_costs_the_tests_that_it_hits_and_no_others() {
    let robot = "
import hrdsl
node = hrdsl.Node('robot')
node.wait_for('asked')
print(('%x' % node.seed) * (60000 if node.seed % 2 else 1))
node.emit('said', n=1)
";
    let folder = project(robot, 6);
    fs::create_dir(folder.path().join("disk")).unwrap();
    let script = "mount -t tmpfs -o size=260k tmpfs disk && $HRDSL sim scenario.hri tests.hri -j 1 -o disk/out; code=$?; \
                  cp -r disk/out out; exit $code";
    let Some(out) = as_root_of_namespaces(folder.path(), script) else { return };
    // Whether the reports still fit depends on the size of the blocks; the run must say what it could not write.
    let code = out.status.code().unwrap();
    assert!([2, 3].contains(&code), "{code}: {}", stderr(&out));
    if code == 3 {
        let errors = errors(folder.path());
        assert!(errors.iter().any(|e| e.contains("No space left")), "{errors:?}");
        assert!(errors.iter().any(String::is_empty), "{errors:?}");
    } else {
        assert!(stderr(&out).contains("No space left"), "{}", stderr(&out));
    }
}

/// What robot code asks of a device is refused in the words of its declaration.
#[test]
fn robot_code_hears_what_a_device_can_do() {
    let world = "\npart hand {\n  body palm: fixed box(4 cm, 8 cm, 8 cm) at (0 m, 0 m, 1 m)\n  gripper grip: palm tool (6 cm, 0 m, 0 m) reach 4 cm delay 100 ms\n}\nworld { part robot = hand at (0 m, 0 m, 0 m) }\n";
    let asked = [
        ("grip.command('wave')", "`robot.grip` is a gripper, and cannot `wave`", "a gripper can close, open"),
        ("grip.command('close', gently=1)", "`close` has no argument `gently`", ""),
        ("node.arm('robot.arm').move_to((0, 0, 1))", "the world has no device `robot.arm`", "robot.grip"),
    ];
    for (call, error, help) in asked {
        let robot =
            format!("import hrdsl\nnode = hrdsl.Node('robot')\ngrip = node.gripper('robot.grip')\n{call}\n");
        let folder = project(&robot, 1);
        let scenario = folder.path().join("scenario.hri");
        fs::write(&scenario, format!("{SCENARIO}{world}")).unwrap();
        expect_code(&sim(folder.path(), ""), 3);
        let said = &errors(folder.path())[0];
        assert!(said.contains(error) && said.contains(help), "{call}: {said}");
    }
    // Nothing to hold is no error: the code hears why, and goes on.
    let robot = "import hrdsl\nnode = hrdsl.Node('robot')\ngrip = node.gripper('robot.grip')\nassert not grip.close() and grip.last_error == 'the gripper closed on nothing'\nassert grip.open()\nnode.wait_for('asked')\nnode.emit('said', n=1)\n";
    let folder = project(robot, 1);
    fs::write(folder.path().join("scenario.hri"), format!("{SCENARIO}{world}")).unwrap();
    sim(folder.path(), "");
    assert_eq!(errors(folder.path()), [""]);
}
