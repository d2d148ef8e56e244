//! `hrdsl gen` and `hrdsl sim` against real robot code.

mod support;

use std::{fs, path::Path};

use serde_json::Value;
use support::{expect_code, handover, hrdsl, root, stderr, stdout, tree};

fn sim(scenario: &Path, out: &Path, more: &[&str]) -> std::process::Output {
    let mut args = vec!["sim", scenario.to_str().unwrap(), "-o", out.to_str().unwrap()];
    args.extend(more);
    hrdsl(args)
}

fn results(out: &Path) -> Value {
    serde_json::from_slice(&fs::read(out.join("results.json")).unwrap()).unwrap()
}

/// A copy of the example with another robot program.
fn with_robot(folder: &Path, program: &str) -> std::path::PathBuf {
    let text = fs::read_to_string(handover()).unwrap();
    let text = text.replace("limit 300 s", "limit 40 s\n  budget 5 s");
    fs::write(folder.join("robot.py"), program).unwrap();
    fs::write(folder.join("scenario.hri"), text).unwrap();
    folder.join("scenario.hri")
}

#[test]
fn generated_tests_check_and_are_the_same_again() {
    let folder = tempfile::tempdir().unwrap();
    let dirs = ["a", "b"].map(|d| folder.path().join(d));
    for dir in &dirs {
        let out = hrdsl(["gen", handover().to_str().unwrap(), "-o", dir.to_str().unwrap(), "--seed", "3"]);
        expect_code(&out, 0);
    }
    assert_eq!(tree(&dirs[0]), tree(&dirs[1]));
    assert_eq!(tree(&dirs[0]).len(), 4, "those of three suites, and the mark of results");
    expect_code(&hrdsl(["check", handover().to_str().unwrap(), dirs[0].to_str().unwrap()]), 0);
}

#[test]
fn another_seed_gives_other_values() {
    let folder = tempfile::tempdir().unwrap();
    let make = |seed: &str| {
        let dir = folder.path().join(seed);
        let scenario = handover();
        let args = ["gen", scenario.to_str().unwrap(), "--suite", "random_tests", "-n", "5", "--seed", seed];
        expect_code(&hrdsl(args.into_iter().chain(["-o", dir.to_str().unwrap()])), 0);
        tree(&dir)
    };
    assert_ne!(make("1"), make("2"));
}

/// No test holds an action of the robot: only the environment's stimuli.
#[test]
fn tests_hold_stimuli_of_the_environment_only() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("t");
    expect_code(&hrdsl(["gen", handover().to_str().unwrap(), "-o", dir.to_str().unwrap()]), 0);
    let own = ["handover_offered", "decided", "released", "discarded", "sense", "sensed", "timed_out"];
    for (name, bytes) in tree(&dir) {
        for line in String::from_utf8(bytes).unwrap().lines().map(str::trim) {
            let word = line.split(['(', ' ']).next().unwrap();
            assert!(!own.contains(&word), "{name}: {line}");
        }
    }
}

#[test]
fn unknown_suites_are_named() {
    let out = hrdsl(["gen", handover().to_str().unwrap(), "--suite", "bdi_test"]);
    expect_code(&out, 2);
    assert!(stderr(&out).contains("bdi_tests, ta_tests, random_tests"), "{}", stderr(&out));
}

#[test]
fn a_campaign_is_repeatable_to_the_byte_with_any_number_of_workers() {
    let folder = tempfile::tempdir().unwrap();
    let dirs = ["1", "2", "3"].map(|j| (j, folder.path().join(j)));
    for (jobs, dir) in &dirs {
        let out = sim(&handover(), dir, &["-n", "3", "-j", jobs, "--exit-zero"]);
        expect_code(&out, 0);
        assert!(stdout(&out).contains("report.html"));
    }
    let first = tree(&dirs[0].1);
    assert!(first.contains_key("report.html") && first.contains_key("junit.xml"));
    assert_eq!(first.keys().filter(|k| k.ends_with(".jsonl")).count(), 9);
    for (_, dir) in &dirs[1..] {
        let other = tree(dir);
        assert_eq!(first.keys().collect::<Vec<_>>(), other.keys().collect::<Vec<_>>());
        for (name, bytes) in &first {
            assert!(*bytes == other[name], "{name} differs");
        }
    }
    let results = results(&dirs[0].1);
    for test in results["tests"].as_array().unwrap() {
        assert!(test["error"].is_null(), "{test}");
        assert!(test["code"]["lines"].as_u64().unwrap() > 60, "{test}");
    }
}

#[test]
fn a_campaign_is_the_same_whether_interpreters_are_forked_or_started_anew() {
    let examples = root().join("examples");
    for (scenario, system) in [
        (handover(), None),
        (handover(), Some("handover/with_rospy/system.hri")),
        (examples.join("corridor/scenario.hri"), Some("corridor/with_rclpy/system.hri")),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let dirs = ["--jobs 2", "--jobs 1 --no-fork"].map(|how| (how, folder.path().join(&how[7..8])));
        let system = system.map(|file| examples.join(file));
        for (how, dir) in &dirs {
            let mut more = vec!["--exit-zero"];
            more.extend(how.split(' '));
            match &system {
                Some(system) => more.extend(["-n", "1", "--system", system.to_str().unwrap()]),
                None => more.extend(["-n", "2"]),
            }
            expect_code(&sim(&scenario, dir, &more), 0);
        }
        let [forked, anew] = dirs.map(|(_, dir)| tree(&dir));
        assert_eq!(forked.keys().collect::<Vec<_>>(), anew.keys().collect::<Vec<_>>());
        for (name, bytes) in &forked {
            assert!(*bytes == anew[name], "{name} of {system:?} differs");
        }
    }
}

#[test]
fn tests_from_a_file_run_as_those_that_were_generated() {
    let folder = tempfile::tempdir().unwrap();
    let [a, b, tests] = ["a", "b", "tests"].map(|d| folder.path().join(d));
    let scenario = handover();
    let pick = ["--suite", "bdi_tests", "-n", "2"];
    expect_code(&sim(&scenario, &a, &[&pick[..], &["--exit-zero"]].concat()), 0);
    let gen_args = ["gen", scenario.to_str().unwrap(), "-o", tests.to_str().unwrap()];
    expect_code(&hrdsl(gen_args.iter().chain(&pick)), 0);
    expect_code(&sim(&scenario, &b, &[tests.to_str().unwrap(), "--exit-zero"]), 0);
    let traces = |dir: &Path| tree(&dir.join("traces"));
    assert_eq!(traces(&a), traces(&b));
}

/// Each broken robot is an error of its tests, with the reason; the campaign ends with all results.
#[test]
fn broken_robots_are_errors_of_their_tests() {
    let robots = [
        ("import sys\nsys.exit(3)\n", "ended"),
        ("raise RuntimeError('no arm today')\n", "no arm today"),
        ("import hrdsl\nn = hrdsl.Node('robot')\nwhile True:\n    pass\n", "within 5 s of processor time"),
        ("import os\nos.write(int(os.environ['HRDSL_REQUEST_FD']), b'rubbish\\n')\n", "rubbish"),
    ];
    for (program, reason) in robots {
        let folder = tempfile::tempdir().unwrap();
        let scenario = with_robot(folder.path(), program);
        let out = sim(&scenario, &folder.path().join("out"), &["--suite", "random_tests", "-n", "2"]);
        expect_code(&out, 3);
        let results = results(&folder.path().join("out"));
        let tests = results["tests"].as_array().unwrap();
        assert_eq!(tests.len(), 2);
        for test in tests {
            assert_eq!(test["ended"], "error");
            let error = test["error"].as_str().unwrap();
            assert!(error.contains(reason), "{reason}: {error}");
            assert!(test["verdicts"].as_array().unwrap().iter().all(|v| v["outcome"] != "pass"));
        }
    }
}

/// A robot that breaks in some tests only spoils those only.
#[test]
fn the_other_tests_are_complete() {
    let folder = tempfile::tempdir().unwrap();
    let program = "import hrdsl\nn = hrdsl.Node('robot')\nassert n.seed % 2, 'an even day'\nprint('x' * 1000000)\nn.sleep(100)\n";
    let scenario = with_robot(folder.path(), program);
    let out = sim(&scenario, &folder.path().join("out"), &["--suite", "random_tests", "-n", "4"]);
    expect_code(&out, 3);
    let results = results(&folder.path().join("out"));
    let ended: Vec<&str> =
        results["tests"].as_array().unwrap().iter().map(|t| t["ended"].as_str().unwrap()).collect();
    assert_eq!(ended, ["limit", "error", "limit", "error"]);
}

#[test]
fn an_absent_robot_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = with_robot(folder.path(), "");
    fs::remove_file(folder.path().join("robot.py")).unwrap();
    let out = sim(&scenario, &folder.path().join("out"), &["--suite", "random_tests", "-n", "1"]);
    expect_code(&out, 3);
    let results = results(&folder.path().join("out"));
    assert!(results["tests"][0]["error"].as_str().unwrap().contains("robot.py"), "{}", results["tests"][0]);
}

/// The arm's own limit is above what the requirement allows: whether the arm is slow is up to the code.
#[test]
fn a_robot_that_hurries_violates_the_limit_of_speed() {
    let folder = tempfile::tempdir().unwrap();
    let example = root().join("examples/handover");
    for name in ["scenario.hri", "fsm.py", "robot.py"] {
        let text = fs::read_to_string(example.join(name)).unwrap();
        assert!(name != "robot.py" || text.contains("CARRY_SPEED = 0.2 "));
        fs::write(folder.path().join(name), text.replace("CARRY_SPEED = 0.2 ", "CARRY_SPEED = 0.3 "))
            .unwrap();
    }
    let out = folder.path().join("out");
    expect_code(&sim(&folder.path().join("scenario.hri"), &out, &["--suite", "bdi_tests", "-n", "2"]), 3);
    let results = results(&out);
    let r6 = results["requirements"].as_array().unwrap().iter().find(|r| r["name"] == "R6").unwrap();
    assert_eq!(
        r6["failing"],
        serde_json::json!(["handover.bdi_tests.t002"]),
        "in the first nobody asks: {r6}"
    );
}

/// Requirements rest on what is seen: a robot whose hand never opens, and that says all that it has to say, is found out.
#[test]
fn a_robot_that_only_says_released_is_found_out() {
    let folder = tempfile::tempdir().unwrap();
    let example = root().join("examples/handover");
    for name in ["scenario.hri", "fsm.py", "robot.py"] {
        let text = fs::read_to_string(example.join(name)).unwrap();
        let opens = "if not self.gripper.open():";
        assert!(name != "robot.py" || text.contains(opens));
        fs::write(folder.path().join(name), text.replace(opens, "if self.node.sleep(0.5) is not None:"))
            .unwrap();
    }
    let out = folder.path().join("out");
    expect_code(&sim(&folder.path().join("scenario.hri"), &out, &["--suite", "bdi_tests", "-n", "6"]), 3);
    let results = results(&out);
    let said = fs::read_to_string(out.join("traces/handover.bdi_tests.t002.jsonl")).unwrap();
    assert!(said.contains(r#""event":"discarded""#) && !said.contains(r#""event":"let_go""#), "{said}");
    let failing = |name: &str| {
        let all = results["requirements"].as_array().unwrap();
        all.iter().find(|r| r["name"] == name).unwrap()["failing"].as_array().unwrap().len()
    };
    assert!(failing("R1") > 0, "{results}");
}

/// What is recorded is what is judged: each counterexample's lines are in the recording at their place.
#[test]
fn failures_are_borne_out_by_recordings() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    expect_code(&sim(&handover(), &out, &["--suite", "bdi_tests", "-n", "12", "--exit-zero"]), 0);
    let results = results(&out);
    let mut failures = 0;
    for test in results["tests"].as_array().unwrap() {
        let path = out.join("traces").join(format!("{}.jsonl", test["name"].as_str().unwrap()));
        let recording = fs::read_to_string(path).unwrap();
        let lines: Vec<Value> = recording.lines().map(|l| serde_json::from_str(l).unwrap()).collect();
        for verdict in test["verdicts"].as_array().unwrap() {
            let Some(counterexample) = verdict["failure"]["counterexample"].as_array() else { continue };
            failures += 1;
            assert!(!counterexample.is_empty());
            for step in counterexample {
                let line = &lines[step["step"].as_u64().unwrap() as usize + 1];
                assert_eq!(line["t"].as_f64(), step["time"].as_f64());
                let named = line["event"].as_str().or(line["signal"].as_str()).unwrap();
                assert!(step["text"].as_str().unwrap().contains(named), "{step} is not {line}");
            }
        }
    }
    assert!(failures > 0, "the example's robot has faults, and none was found");
}

#[test]
fn the_robot_code_has_fourteen_states() {
    let text = fs::read_to_string(root().join("examples/handover/robot.py")).unwrap();
    assert_eq!(text.matches("(RobotState)").count(), 14);
}

/// The test that the README begins with is generated like this, and found to fail like this.
#[test]
fn the_readme_shows_a_test_that_fails() {
    let readme = fs::read_to_string(root().join("README.md")).unwrap();
    let block = |with: &str| {
        let mut blocks = readme.split("```text\n").skip(1).map(|b| b.split_once("```").unwrap().0);
        blocks.find(|b| b.contains(with)).unwrap_or_else(|| panic!("no block with {with}"))
    };
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let run = sim(&handover(), &out, &["--test", "bdi_tests.t002", "--exit-zero"]);
    let tests = fs::read_to_string(out.join("tests/bdi_tests.hri")).unwrap();
    assert!(tests.contains(block("test bdi_tests.t002")), "{tests}");
    let violation = block("✗ R5").trim_end();
    assert!(stdout(&run).contains(violation), "{violation}\n{}", stdout(&run));
    let scenario = fs::read_to_string(handover()).unwrap();
    assert!(scenario.contains(block("require R5")));
    let recording = fs::read_to_string(out.join("traces/handover.bdi_tests.t002.jsonl")).unwrap();
    assert!(
        recording
            .contains(r#"{"t":13.17,"signal":"distance(person.hand, robot.finger_right)","value":0.0495"#)
    );
}

/// The results that the example comes with. To update them after a change that is meant to change them:
/// `HRDSL_UPDATE=1 cargo test -p hrdsl --test campaign`, and read the difference.
#[test]
fn the_example_gives_the_expected_results() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let run = sim(&handover(), &out, &["-n", "16", "--exit-zero"]);
    expect_code(&run, 0);
    let text = stdout(&run);
    // What depends on the machine is left out: paths, versions, wall time.
    let (summary, _) = text.rsplit_once("ran in ").unwrap();
    let summary: String =
        summary.lines().filter(|l| !l.starts_with("  hrdsl sim ")).map(|l| format!("{l}\n")).collect();
    let path = root().join("examples/handover/expected.txt");
    if std::env::var_os("HRDSL_UPDATE").is_some() {
        fs::write(&path, &summary).unwrap();
    }
    assert_eq!(summary, fs::read_to_string(path).unwrap());
}
