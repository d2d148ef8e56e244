//! The example whose robot drives: two nodes of ROS 1 with an action, services and a scan, without a line of hrdsl.

mod support;

use std::{collections::BTreeMap, fs, path::Path};

use serde_json::Value;
use support::{expect_code, hrdsl_in, root, tree};

/// A copy of the example.
fn copy(folder: &Path) {
    for (name, bytes) in tree(&root().join("examples/delivery")) {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
}

fn results(folder: &Path, out: &str) -> Value {
    serde_json::from_slice(&fs::read(folder.join(out).join("results.json")).unwrap()).unwrap()
}

/// Of each test, the outcome of each requirement.
fn outcomes(results: &Value) -> BTreeMap<String, BTreeMap<String, String>> {
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    let verdicts = |test: &Value| {
        assert!(test["error"].is_null(), "{test}");
        let verdicts = test["verdicts"].as_array().unwrap().iter();
        verdicts.map(|v| (text(&v["requirement"]), text(&v["outcome"]))).collect()
    };
    results["tests"].as_array().unwrap().iter().map(|t| (text(&t["name"]), verdicts(t))).collect()
}

#[test]
fn two_nodes_give_the_same_bytes_on_one_worker_and_on_two() {
    let folder = tempfile::tempdir().unwrap();
    copy(folder.path());
    for jobs in ["1", "2"] {
        let line = format!("sim scenario.hri -n 2 -j {jobs} --check-determinism --exit-zero -o out{jobs}");
        expect_code(&hrdsl_in(folder.path(), &line), 0);
    }
    let [one, two] = ["out1", "out2"].map(|out| tree(&folder.path().join(out)));
    assert_eq!(one.keys().filter(|k| k.ends_with(".jsonl")).count(), 6);
    assert_eq!(one.keys().collect::<Vec<_>>(), two.keys().collect::<Vec<_>>());
    for (name, bytes) in &one {
        assert!(*bytes == two[name], "{name} differs");
    }
    let results = results(folder.path(), "out1");
    assert_eq!(outcomes(&results).len(), 6, "and none is in error");
    let code = &results["code"].as_array().unwrap();
    let files: Vec<&str> = code.iter().map(|f| f["file"].as_str().unwrap()).collect();
    let of = |file: &str| format!("src/courier/{file}");
    assert_eq!(files, ["scripts/driver.py", "scripts/mission.py", "src/courier/motion.py"].map(of));
    for file in code.iter() {
        let [lines, total] = ["lines", "lines_total"].map(|n| file["ratios"][n].as_u64().unwrap());
        assert!(lines * 10 > total * 8, "{file}");
    }
}

/// Somebody comes right up to the robot, which waits for them; somebody steps briskly in from the side.
const TESTS: &str = "
test close.t1 {
  seed 1
  wait 2 s
  call(mail)
  wait 1 s
  step_in(outward) with ahead = 2.5 m
  wait 4 s
  step_up(outward) with ahead = 0.48 m
  await excuse_me within 10 s
  step_aside
  await home | stuck within 90 s
}
test side.t1 {
  seed 1
  wait 2 s
  call(lab)
  wait 1 s
  step_in(outward) with ahead = 2.3 m
  step_aside
  await arrived within 60 s
  take(lab) with dx = 0 m
  await home | stuck within 90 s
}
";

/// In a file of the copy, replaces what must be there.
fn edit(folder: &Path, file: &str, from: &str, to: &str) {
    let text = fs::read_to_string(folder.join(file)).unwrap();
    assert!(text.contains(from), "{file}: {from}");
    fs::write(folder.join(file), text.replace(from, to)).unwrap();
}

/// The two faults that its README tells of, and how to fix them.
#[test]
fn faults_of_the_driver_are_found_and_gone_when_they_are_fixed() {
    let folder = tempfile::tempdir().unwrap();
    copy(folder.path());
    fs::write(folder.path().join("tests.hri"), TESTS).unwrap();
    let run = |out: &str| {
        let line = format!("sim scenario.hri tests.hri --exit-zero -o {out}");
        expect_code(&hrdsl_in(folder.path(), &line), 0);
        outcomes(&results(folder.path(), out))
    };
    let failing = |outcomes: &BTreeMap<String, String>| {
        let failing = outcomes.iter().filter(|(_, outcome)| *outcome == "fail");
        failing.map(|(name, _)| name.clone()).collect::<Vec<_>>()
    };
    let found = run("found");
    assert_eq!(failing(&found["delivery.close.t1"]), ["R1", "R2"]);
    assert_eq!(failing(&found["delivery.side.t1"]), ["R1"]);

    let guard = "        if not scan.range_min <= distance <= scan.range_max:\n";
    let fixed = format!("        if distance < scan.range_min:\n            return 0.0\n{guard}");
    edit(folder.path(), "src/courier/src/courier/motion.py", guard, &fixed);
    edit(folder.path(), "scenario.hri", "_max_speed:=0.5", "_max_speed:=0.5 _half_width:=0.6");
    for (test, outcomes) in run("fixed") {
        assert_eq!(failing(&outcomes), [""; 0], "{test}");
        for requirement in ["R1", "R2", "R3", "R5"] {
            assert_eq!(outcomes[requirement], "pass", "{test}: {requirement}");
        }
    }
}
