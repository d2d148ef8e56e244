//! Three robots that are not ours, each in a scenario of its own: an arm carries a box, a base drives through a door, a humanoid reaches
//! round a post. No Rust knows of them.
//!
//! `HRDSL_ROBOTS=FOLDER cargo test -p hrdsl --test robot_scenes -- --nocapture`, where
//! `pip install --no-deps --target FOLDER example-robot-data==6.0.0 pybullet==3.2.7` has put the robots. Without the variable nothing is done.
//!
//! Every requirement passes in one run and fails in another: with a load that is too heavy, a door that is shut, a place inside the post,
//! and with programs that do not look where they go. What the programs measured of their devices is told.
#![allow(clippy::disallowed_methods, reason = "the test reads a folder that is named by the environment")]

mod support;

use std::{
    collections::{BTreeMap, BTreeSet},
    env, fs,
    path::PathBuf,
};

use serde_json::Value;
use support::{expect_code, hrdsl_in, root, tree};

/// The scenes, in a folder from which `robots` leads to the robots.
struct Scenes {
    folder: tempfile::TempDir,
    robots: PathBuf,
}

fn scenes() -> Option<Scenes> {
    let robots = PathBuf::from(env::var_os("HRDSL_ROBOTS")?).canonicalize().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let names = fs::read_dir(root().join("cli/tests/robot_scenes")).unwrap().flatten();
    for file in names.map(|entry| entry.path()).filter(|path| path.is_file()) {
        fs::copy(&file, folder.path().join(file.file_name().unwrap())).unwrap();
    }
    std::os::unix::fs::symlink(&robots, folder.path().join("robots")).unwrap();
    Some(Scenes { folder, robots })
}

/// Of each test the outcomes of its requirements, in their order: `pass fail`.
type Outcomes = BTreeMap<String, String>;

impl Scenes {
    /// Runs the tests of a scenario against one of its systems.
    fn run(&self, scenario: &str, system: &str) -> Outcomes {
        let folder = self.folder.path();
        let out = format!("out/{scenario}_{system}");
        let robots = self.robots.display();
        let line = format!(
            "sim {scenario}.hri {scenario}_tests.hri --system {system} --allow-path {robots} --check-determinism --exit-zero -o {out}"
        );
        expect_code(&hrdsl_in(folder, &line), 0);
        self.tell(&out, scenario, system);
        let results = fs::read(folder.join(&out).join("results.json")).unwrap();
        let results: Value = serde_json::from_slice(&results).unwrap();
        let outcomes = |test: &Value| {
            assert!(test["error"].is_null(), "{test}");
            let verdicts = test["verdicts"].as_array().unwrap();
            let words: Vec<&str> = verdicts.iter().map(|v| v["outcome"].as_str().unwrap()).collect();
            let name = test["name"].as_str().unwrap();
            (name.rsplit('.').next().unwrap_or(name).to_owned(), words.join(" "))
        };
        results["tests"].as_array().unwrap().iter().map(outcomes).collect()
    }

    /// What the programs said.
    fn tell(&self, out: &str, scenario: &str, system: &str) {
        let mut said = String::new();
        for (name, text) in tree(&self.folder.path().join(out).join("output")) {
            for line in String::from_utf8_lossy(&text).lines().filter(|line| !line.starts_with("──")) {
                let line = format!("{}, {system}: {line}", name.trim_end_matches(".txt"));
                println!("{line}");
                said += &format!("{line}\n");
            }
        }
        // spec/robots.md has these figures, rounded.
        let followed =
            FOLLOWED.iter().filter(|line| line.starts_with(&format!("{scenario}.")) && system == "robot");
        for line in followed {
            assert!(said.contains(line), "{line}\nis not in\n{said}");
        }
    }
}

/// How well the devices follow.
const FOLLOWED: [&str; 3] = [
    "arm.carries, robot: tracking error: on the way 0.0006 rad, at the end 0.00066 rad",
    "door.open, robot: tracking error: at most 0.5657 m/s, a second after a command 0.01670 m/s",
    "reach.round, robot: tracking error: on the way 0.0023 rad, at the end 0.00091 rad",
];

fn expected(tests: &[(&str, &str)]) -> Outcomes {
    tests.iter().map(|(test, words)| ((*test).to_owned(), (*words).to_owned())).collect()
}

/// Each requirement passes somewhere, and fails somewhere.
fn show_both(runs: &[&Outcomes]) {
    let mut seen: BTreeMap<usize, BTreeSet<String>> = BTreeMap::new();
    for words in runs.iter().flat_map(|run| run.values()) {
        for (at, word) in words.split(' ').enumerate() {
            seen.entry(at).or_default().insert(word.to_owned());
        }
    }
    for (at, words) in seen {
        assert!(words.contains("pass") && words.contains("fail"), "R{}: {words:?}", at + 1);
    }
}

#[test]
fn an_arm_carries_a_box_from_one_table_to_the_other() {
    let Some(scenes) = scenes() else { return };
    let robot = scenes.run("arm", "robot");
    assert_eq!(
        robot,
        expected(&[("carries", "pass pass pass pass"), ("too_heavy", "fail vacuous pass pass")])
    );
    let careless = scenes.run("arm", "careless");
    assert_eq!(careless["carries"], "pass fail fail fail");
    show_both(&[&robot, &careless]);
}

#[test]
fn a_base_drives_through_a_door_that_its_laser_sees() {
    let Some(scenes) = scenes() else { return };
    let robot = scenes.run("door", "robot");
    let (open, shut) = ("pass pass vacuous pass", "fail pass pass vacuous");
    assert_eq!(robot, expected(&[("open", open), ("shut", shut)]));
    let blind = scenes.run("door", "blind");
    assert_eq!(blind, expected(&[("open", "fail fail vacuous fail"), ("shut", "fail fail fail fail")]));
    show_both(&[&robot, &blind]);
}

#[test]
fn a_humanoid_reaches_round_a_post() {
    let Some(scenes) = scenes() else { return };
    let robot = scenes.run("reach", "robot");
    assert_eq!(robot, expected(&[("round", "pass pass pass"), ("walled", "fail pass pass")]));
    let straight = scenes.run("reach", "straight");
    assert_eq!(straight["round"], "fail fail fail");
    show_both(&[&robot, &straight]);
}
