//! The examples besides the hand-over, with the real binary: they check, generate by all three methods, and run.

mod support;

use std::{collections::BTreeMap, fs, path::Path};

use serde_json::Value;
use support::{expect_code, hrdsl, hrdsl_in, root, stdout, tree};

/// The generated files of an example, and what was said of them; checked, and made twice.
fn generated(example: &str, folder: &Path) -> (BTreeMap<String, String>, String) {
    let scenario = root().join("examples").join(example).join("scenario.hri");
    let scenario = scenario.to_str().unwrap();
    expect_code(&hrdsl(["check", scenario, "--deny", "warnings"]), 0);
    let made = ["a", "b"].map(|d| folder.join(d)).map(|dir| {
        let out = hrdsl(["gen", scenario, "-o", dir.to_str().unwrap()]);
        expect_code(&out, 0);
        (tree(&dir), stdout(&out).replace(dir.to_str().unwrap(), "OUT"))
    });
    assert_eq!(made[0], made[1], "two runs give the same");
    expect_code(&hrdsl(["check", scenario, folder.join("a").to_str().unwrap(), "--deny", "warnings"]), 0);
    let [(mut files, said), _] = made;
    assert!(files.remove(".hrdsl-results").is_some());
    let text = |(name, bytes)| (name, String::from_utf8(bytes).unwrap());
    (files.into_iter().map(text).collect(), said)
}

fn tests(text: &str) -> usize {
    text.lines().filter(|l| l.starts_with("test ")).count()
}

/// All bins that tests of this text are to fall into.
fn predicted(text: &str) -> Vec<&str> {
    let lines = text.lines().filter_map(|l| l.trim().strip_prefix("predicts \""));
    let mut bins: Vec<&str> = lines.map(|l| l.trim_end_matches('"')).collect();
    bins.sort_unstable();
    bins.dedup();
    bins
}

fn lines(file: &str) -> usize {
    let path = root().join("examples").join(file);
    fs::read_to_string(path).unwrap().lines().count()
}

#[test]
fn home_care_generates_by_all_methods() {
    let folder = tempfile::tempdir().unwrap();
    let (files, said) = generated("homecare", folder.path());
    assert_eq!(files.len(), 3);
    for (name, text) in &files {
        assert_eq!(tests(text), 50, "{name}");
    }
    let bins = [
        "human_robot.clean, and cleaned",
        "human_robot.feed, and fed",
        "human_robot.fridge, and checked",
        "human_robot.other commands, and idle",
        "human_robot.sink, and checked",
        "human_robot.two chores, and both done",
    ];
    assert_eq!(predicted(&files["bdi_tests.hri"]), bins);
    assert_eq!(predicted(&files["ta_tests.hri"]), bins);
    assert!(said.contains("goals: 71 reached, 0 unreachable, 0 inconclusive"), "{said}");
}

/// What the person's `rest` holds is drawn for each test, and the model's time for it is not waited once more.
#[test]
fn a_sampled_hold_is_not_waited_twice() {
    let folder = tempfile::tempdir().unwrap();
    let (files, _) = generated("homecare", folder.path());
    let steps: Vec<&str> = files["bdi_tests.hri"].lines().map(str::trim).collect();
    let after_rest: Vec<&str> =
        steps.windows(2).filter(|w| w[0].starts_with("rest(")).map(|w| w[1]).collect();
    assert!(after_rest.iter().any(|s| s.starts_with("order(")), "{after_rest:?}");
    assert!(after_rest.iter().all(|s| !s.starts_with("wait ")), "{after_rest:?}");
}

/// A copy of home care, with one test that was written by hand.
fn home_care(folder: &Path, test: &str) {
    for (name, bytes) in tree(&root().join("examples/homecare")) {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
    fs::write(folder.join("test.hri"), format!("scenario homecare\n{test}\n")).unwrap();
}

/// Which requirements a test of home care fails, and which it passes.
fn failed_and_passed(file: &str, test: &str) -> [Vec<String>; 2] {
    let folder = tempfile::tempdir().unwrap();
    home_care(folder.path(), test);
    expect_code(&hrdsl_in(folder.path(), &format!("sim {file} test.hri -o out --exit-zero")), 0);
    let outcomes = outcomes(folder.path());
    ["fail", "pass"]
        .map(|wanted| outcomes.iter().filter(|(_, o)| o[0] == wanted).map(|(name, _)| name.clone()).collect())
}

#[test]
fn home_care_brings_food_and_clears_the_table() {
    let test = "test hand.day { person { order(feed); wait 150 s; order(clean); wait 170 s; order(other) } }";
    assert_eq!(
        failed_and_passed("scenario.hri", test),
        [vec![], vec!["R1".to_owned(), "R2".to_owned(), "R3".to_owned()]]
    );
}

/// The dog as published topples the robot on its way to the table: the food comes too late, the robot lies about, and does not come home.
/// The honest one is in the way, and no more.
#[test]
fn the_dog_of_home_care_topples_the_robot_only_as_published() {
    let dog = "await moving(table) within 90 s; wait 10 s; pester; pester; pester; pester; pester; retreat";
    let test = format!("test hand.dog {{ person {{ order(feed) }} dog {{ {dog} }} }}");
    let [failed, _] = failed_and_passed("scenario.hri", &test);
    assert_eq!(failed, ["R1", "R2", "R3", "R4", "Upright"]);
    let [failed, _] = failed_and_passed("honest.hri", &test);
    assert!(!failed.contains(&"Upright".to_owned()), "{failed:?}");
}

/// The published models alone, without world, requirements and suites, have 348 and 131 lines of agents, and 725 and 722
/// lines of automata. The hand-over has 22 requirements and the times of its code.
#[test]
fn scenarios_are_short() {
    for (file, most) in
        [("handover/scenario.hri", 450), ("homecare/care.hri", 250), ("corridor/scenario.hri", 165)]
    {
        assert!(lines(file) < most, "{file}: {}", lines(file));
    }
}

#[test]
fn the_corridor_generates_by_all_methods() {
    let folder = tempfile::tempdir().unwrap();
    let (files, said) = generated("corridor", folder.path());
    assert_eq!(files.len(), 3);
    for (name, text) in &files {
        assert_eq!(tests(text), 16, "{name}");
    }
    assert_eq!(predicted(&files["by_agents.hri"]).len(), 5);
    assert_eq!(predicted(&files["by_search.hri"]).len(), 5);
    assert!(said.contains("32 reached, 0 unreachable, 0 inconclusive"), "{said}");
}

#[test]
fn the_delivery_generates_by_all_methods() {
    let folder = tempfile::tempdir().unwrap();
    let (files, said) = generated("delivery", folder.path());
    assert_eq!(files.len(), 3);
    for (name, text) in &files {
        assert_eq!(tests(text), 24, "{name}");
    }
    assert_eq!(predicted(&files["by_agents.hri"]).len(), 10);
    assert_eq!(predicted(&files["by_search.hri"]).len(), 10);
    assert!(said.contains("72 reached, 0 unreachable, 0 inconclusive"), "{said}");
}

/// A copy of the corridor.
fn corridor(folder: &Path) {
    for (name, bytes) in tree(&root().join("examples/corridor")) {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
}

/// Another text in a file.
fn change(path: &Path, from: &str, to: &str) {
    let text = fs::read_to_string(path).unwrap();
    assert!(text.contains(from), "{from}");
    fs::write(path, text.replacen(from, to, 1)).unwrap();
}

/// Of each requirement, the outcomes of all tests.
fn outcomes(folder: &Path) -> BTreeMap<String, Vec<String>> {
    let results = fs::read(folder.join("out/results.json")).unwrap();
    let results: Value = serde_json::from_slice(&results).unwrap();
    let mut outcomes: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for test in results["tests"].as_array().unwrap() {
        assert!(test["error"].is_null(), "{test}");
        for verdict in test["verdicts"].as_array().unwrap() {
            let name = verdict["requirement"].as_str().unwrap().to_owned();
            outcomes.entry(name).or_default().push(verdict["outcome"].as_str().unwrap().to_owned());
        }
    }
    outcomes
}

#[test]
fn the_corridor_runs_against_its_code() {
    for system in ["", "--system with_rclpy/system.hri"] {
        let folder = tempfile::tempdir().unwrap();
        corridor(folder.path());
        expect_code(&hrdsl_in(folder.path(), &format!("sim scenario.hri {system} -n 5 -o out")), 0);
        let outcomes = outcomes(folder.path());
        assert_eq!(outcomes.len(), 4);
        for (name, outcomes) in &outcomes {
            assert_eq!(outcomes.len(), 15);
            assert!(outcomes.iter().any(|o| o == "pass"), "{name} is put to the test: {outcomes:?}");
            assert!(outcomes.iter().all(|o| o != "fail"), "{name}: {outcomes:?}");
        }
        let (executed, lines) = covered(folder.path());
        assert!(executed * 100 >= lines * 95, "{executed} of {lines} lines {system}");
    }
}

/// The lines of code that the tests executed, and how many there are.
fn covered(folder: &Path) -> (u64, u64) {
    let results = fs::read(folder.join("out/results.json")).unwrap();
    let results: Value = serde_json::from_slice(&results).unwrap();
    let files = results["code"].as_array().unwrap();
    let count = |what: &str| files.iter().map(|f| f["ratios"][what].as_u64().unwrap()).sum();
    (count("lines"), count("lines_total"))
}

/// The faults that its README tells how to make are found.
#[test]
fn faults_in_the_corridor_are_found() {
    let look = "            if self.node.read(\"someone\"):\n                return self.braking\n";
    let faults = [("R1", "robot.py", look, ""), ("R2", "robot.py", "ASKS = 2", "ASKS = 8")];
    for (requirement, file, from, to) in faults {
        let folder = tempfile::tempdir().unwrap();
        corridor(folder.path());
        change(&folder.path().join(file), from, to);
        expect_code(&hrdsl_in(folder.path(), "sim scenario.hri --suite by_agents -o out"), 3);
        let outcomes = outcomes(folder.path());
        assert!(outcomes[requirement].iter().any(|o| o == "fail"), "{outcomes:?}");
    }
}

/// What holds, what slips, what falls and what cannot be seen comes out of the physics.
#[test]
fn the_workbench_shows_what_the_world_decides() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in tree(&root().join("examples/workbench")) {
        fs::write(folder.path().join(name), bytes).unwrap();
    }
    expect_code(&hrdsl_in(folder.path(), "check . --deny warnings"), 0);
    expect_code(&hrdsl_in(folder.path(), "sim scenario.hri tests.hri -o out --exit-zero"), 0);
    let results: Value =
        serde_json::from_slice(&fs::read(folder.path().join("out/results.json")).unwrap()).unwrap();
    let failing: Vec<(&str, Vec<&str>)> = results["tests"]
        .as_array()
        .unwrap()
        .iter()
        .map(|test| {
            let failed = test["verdicts"].as_array().unwrap().iter().filter(|v| v["outcome"] == "fail");
            (test["name"].as_str().unwrap(), failed.map(|v| v["requirement"].as_str().unwrap()).collect())
        })
        .collect();
    assert_eq!(
        failing,
        [
            ("workbench.grips", vec![]),
            ("workbench.slips", vec!["R1"]),
            ("workbench.drops", vec!["R2"]),
            ("workbench.unseen", vec!["R3"]),
        ]
    );
}
