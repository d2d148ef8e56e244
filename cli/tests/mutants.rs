//! The faults that stand beside the hand-over's code: each can be put in, and one of them is noticed.

#![allow(clippy::disallowed_methods, reason = "tests start interpreters")]

mod support;

use std::{fs, path::Path, process::Command};

use serde_json::Value;
use support::{expect_code, root, stdout};

fn python(script: &str, args: &[&str]) -> std::process::Output {
    let path = root().join("examples/handover/mutants").join(script);
    // What the scripts import is not to leave compiled files in the example.
    Command::new("python3").arg("-B").arg(path).args(args).output().unwrap()
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

#[test]
fn every_fault_fits_the_code_and_is_one_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let copies = folder.path().join("copies");
    expect_code(&python("apply.py", &["--all", text(&copies)]), 0);
    let original = fs::read(root().join("examples/handover/robot.py")).unwrap();
    let made: Vec<_> = fs::read_dir(&copies).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert!(made.len() >= 40, "{} copies", made.len());
    let differ = made.iter().filter(|copy| fs::read(copy.join("robot.py")).unwrap() != original);
    // One is in the state machine's container.
    assert_eq!(differ.count(), made.len() - 1);
}

#[test]
fn a_robot_that_lets_go_of_what_nobody_is_ready_for_is_noticed() {
    let folder = tempfile::tempdir().unwrap();
    let args = [text(folder.path()), "-n", "4", "--hrdsl", env!("CARGO_BIN_EXE_hrdsl"), "--json"];
    let only = ["--only", "any_sensor", "gaze_and_pressure_swapped", "timeout_not_announced"];
    let out = python("measure.py", &[&args[..], &only[..]].concat());
    expect_code(&out, 0);
    let table: Value = serde_json::from_str(&stdout(&out)).unwrap();
    assert_eq!(fs::read_to_string(folder.path().join("table.json")).unwrap(), stdout(&out));
    let told = |fault: &str, what: &str| table[fault][what].clone();
    assert_eq!(told("any_sensor", "noticed")["R3"], serde_json::json!(["agents"]), "{table}");
    assert_eq!(told("any_sensor", "noticed")["R19"], serde_json::json!(["agents"]), "{table}");
    // What its head expects are requirements alone: that the model notices it, too, is another reason.
    let right = told("any_sensor", "right");
    assert!(right.as_array().unwrap().contains(&"R19".into()), "{table}");
    assert!(!right.as_array().unwrap().contains(&"conformance".into()), "{table}");
    // No requirement asks what the code says.
    let methods = &told("timeout_not_announced", "noticed")["conformance"];
    assert!(methods.as_array().unwrap().len() >= 2, "{table}");
    assert_eq!(told("timeout_not_announced", "right"), serde_json::json!(["conformance"]), "{table}");
    // Both must hold for the robot to be ready: which is which makes no difference.
    assert_eq!(told("gaze_and_pressure_swapped", "noticed"), serde_json::json!({}), "{table}");
    assert_eq!(told("gaze_and_pressure_swapped", "distinguished"), serde_json::json!(false), "{table}");
}

/// The workbench's robot with a mutant of its code: the sentinel ends every test, and a hand that does not open when it is told to drops nothing.
#[test]
fn a_generated_mutant_runs_in_place_of_the_code() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    for name in ["scenario.hri", "tests.hri", "robot.py"] {
        fs::copy(root().join("examples/workbench").join(name), path(name)).unwrap();
    }
    let original = fs::read(path("robot.py")).unwrap();
    let sdk = root().join("sdk/python");
    let listed = Command::new("python3")
        .args([
            "-B",
            "-m",
            "hrdsl.mutation",
            "list",
            text(&path("robot.py")),
            "--operator",
            "dropped",
            "--json",
        ])
        .env("PYTHONPATH", &sdk)
        .output()
        .unwrap();
    expect_code(&listed, 0);
    let listed: Value = serde_json::from_str(&stdout(&listed)).unwrap();
    let is_open = |m: &&Value| m["what"].as_str().unwrap().starts_with("open ");
    let mutants = listed["mutants"].as_array().unwrap();
    let dropped = mutants.iter().find(is_open).expect("the hand opens")["number"].as_u64().unwrap();
    let results = |number: u64| -> Value {
        let run = format!("python3 -m hrdsl.mutation run robot.py {number} -- robot.py");
        fs::write(
            path("mutant.hri"),
            format!("system mutated plays robot {{ run \"{run}\"; limit 30 s }}\n"),
        )
        .unwrap();
        let line = "sim scenario.hri tests.hri --system mutant.hri --exit-zero -o out";
        expect_code(&support::hrdsl_in(folder.path(), line), 0);
        serde_json::from_slice(&fs::read(path("out/results.json")).unwrap()).unwrap()
    };
    let sentinel = results(0);
    let tests = sentinel["tests"].as_array().unwrap();
    assert!(tests.len() == 4 && tests.iter().all(|test| !test["error"].is_null()), "{sentinel}");
    let kept = results(dropped);
    let failing = |requirement: &str| {
        let own = |row: &&Value| row["name"] == requirement;
        kept["requirements"].as_array().unwrap().iter().find(own).unwrap()["failing"].clone()
    };
    assert_eq!(failing("R2"), serde_json::json!([]), "nothing is dropped");
    assert_eq!(failing("R1"), serde_json::json!(["workbench.slips"]));
    assert_eq!(fs::read(path("robot.py")).unwrap(), original, "no file is written");
}
