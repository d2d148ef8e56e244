//! The same bytes again and again: the systems of the examples, repeated on one worker and on two, and with each Python from 3.10 to
//! 3.13 that is installed.
//!
//! `cargo test -p hrdsl --test repeats -- --nocapture` repeats a test of each system 20 times, or 4 where it takes long, and says which
//! Pythons it found; with `HRDSL_SOAK=1` each is repeated fifty times as often. A new example has an entry in `repeated!`, for each of its
//! systems; the entry's name behind the command repeats that one alone.

#![allow(clippy::disallowed_methods, reason = "tests start interpreters")]

mod support;

use std::{
    collections::BTreeMap,
    env, fmt,
    fmt::Write as _,
    fs,
    os::unix::fs::PermissionsExt,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

use serde_json::Value;
use support::{command, expect_code, hrdsl_in, root, tree};

/// A system of an example, and the generated test of it that is repeated.
struct RepeatedSystem {
    example: &'static str,
    /// The file that has it, unless it is the scenario's own.
    file: Option<&'static str>,
    suite: &'static str,
    /// Of the suite's tests, counted from 1.
    test: usize,
    /// How often it is repeated when there is no soak.
    times: usize,
}

/// The systems, with a test for each that repeats it.
macro_rules! repeated {
    ($($name:ident: $system:expr,)*) => {
        const SYSTEMS: &[RepeatedSystem] = &[$($system),*];

        $(#[test]
        fn $name() {
            let system = $system;
            repeat(&system, if env::var_os("HRDSL_SOAK").is_some() { 50 * system.times } else { system.times });
        })*
    };
}

repeated! {
    corridor: RepeatedSystem { example: "corridor", file: None, suite: "by_agents", test: 7, times: 20 },
    corridor_with_rclpy: RepeatedSystem {
        example: "corridor",
        file: Some("with_rclpy/system.hri"),
        suite: "by_agents",
        test: 7,
        times: 20,
    },
    delivery: RepeatedSystem { example: "delivery", file: None, suite: "by_agents", test: 1, times: 20 },
    handover: RepeatedSystem { example: "handover", file: None, suite: "random_tests", test: 1, times: 20 },
    handover_with_rospy: RepeatedSystem {
        example: "handover",
        file: Some("with_rospy/system.hri"),
        suite: "random_tests",
        test: 1,
        times: 20,
    },
    homecare: RepeatedSystem { example: "homecare", file: None, suite: "bdi_tests", test: 6, times: 4 },
    workbench: RepeatedSystem { example: "workbench", file: None, suite: "random_tests", test: 2, times: 20 },
}

const PYTHONS: [&str; 4] = ["python3.10", "python3.11", "python3.12", "python3.13"];

/// All that a test left behind, with its name taken out.
#[derive(PartialEq, Eq)]
struct RunBytes {
    recording: String,
    output: String,
    /// What the results say of it.
    result: String,
}

impl fmt::Display for RepeatedSystem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.example, self.file.unwrap_or("scenario.hri"))
    }
}

impl RepeatedSystem {
    /// A copy of the example.
    fn folder(&self) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for (name, bytes) in tree(&root().join("examples").join(self.example)) {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, bytes).unwrap();
        }
        folder
    }

    /// The text of the test, with this name.
    fn test(&self, folder: &Path, name: &str) -> String {
        let line = format!("gen scenario.hri --suite {} -n {} -o made", self.suite, self.test);
        expect_code(&hrdsl_in(folder, &line), 0);
        let text = fs::read_to_string(folder.join(format!("made/{}.hri", self.suite))).unwrap();
        let own = format!("test {}.t{:03} {{", self.suite, self.test);
        let from = text.find(&own).unwrap_or_else(|| panic!("{self}: no `{own}` in\n{text}")) + own.len();
        let to = from + text[from..].find("\n}").unwrap();
        format!("test {name} {{{}\n}}\n", &text[from..to])
    }

    /// Runs tests of the folder, and gives what is left of each.
    fn run(
        &self,
        folder: &Path,
        tests: &str,
        options: &str,
        path: Option<&Path>,
    ) -> BTreeMap<String, RunBytes> {
        let system = self.file.map_or_else(String::new, |file| format!("--system {file}"));
        let line = format!("sim scenario.hri {tests} {system} {options} -o out --exit-zero");
        let mut hrdsl = command();
        if let Some(path) = path {
            let others = env::var_os("PATH").unwrap_or_default();
            let folders = [path.to_owned()].into_iter().chain(env::split_paths(&others));
            hrdsl.env("PATH", env::join_paths(folders).unwrap());
        }
        let done = hrdsl.args(line.split_whitespace()).current_dir(folder).output().unwrap();
        expect_code(&done, 0);
        let results: Value =
            serde_json::from_slice(&fs::read(folder.join("out/results.json")).unwrap()).unwrap();
        let results = results["tests"].as_array().unwrap();
        results.iter().map(|result| self.bytes(&folder.join("out"), result)).collect()
    }

    fn bytes(&self, out: &Path, result: &Value) -> (String, RunBytes) {
        let name = result["name"].as_str().unwrap();
        assert!(result["error"].is_null(), "{self}: {name}: {}", result["error"]);
        let read =
            |path: String| fs::read_to_string(out.join(path)).unwrap_or_default().replace(name, "NAME");
        let bytes = RunBytes {
            recording: read(format!("traces/{name}.jsonl")),
            output: read(format!("output/{name}.txt")),
            result: result.to_string().replace(name, "NAME"),
        };
        assert!(bytes.recording.contains("\"event\""), "{self}: nothing happens in {name}");
        (name.to_owned(), bytes)
    }
}

impl RunBytes {
    /// Fails at the first line that differs.
    fn assert_same(&self, other: &RunBytes, what: &str) {
        let parts = [
            ("recording", &self.recording, &other.recording),
            ("output", &self.output, &other.output),
            ("result", &self.result, &other.result),
        ];
        for (part, one, two) in parts {
            let pair = one.lines().zip(two.lines()).enumerate().find(|(_, (a, b))| a != b);
            if let Some((at, (a, b))) = pair {
                panic!("{what}: line {} of the {part}: {a}\nthen: {b}", at + 1);
            }
            assert!(one == two, "{what}: one {part} is the beginning of the other");
        }
    }
}

/// Runs as many copies of one test, half of them on one worker and half on two, and compares them.
fn repeat(system: &RepeatedSystem, times: usize) {
    let folder = system.folder();
    let one = system.test(folder.path(), "NAME");
    let mut copies = String::new();
    for number in 1..=times / 2 {
        let _ = writeln!(copies, "{}", one.replacen("NAME", &format!("again.t{number:04}"), 1));
    }
    fs::write(folder.path().join("again.hri"), copies).unwrap();
    let mut first: Option<RunBytes> = None;
    for workers in [1, 2] {
        let runs = system.run(folder.path(), "again.hri", &format!("-j {workers}"), None);
        assert_eq!(runs.len(), times / 2, "{system}");
        for (name, bytes) in runs {
            match &first {
                Some(first) => first.assert_same(&bytes, &format!("{system}: {name} on {workers} workers")),
                None => first = Some(bytes),
            }
        }
    }
    println!("{system}: {times} times the same");
}

/// Where a Python of this name is: on the path, or where pyenv has it.
fn interpreter(name: &str) -> Option<PathBuf> {
    let home = || Some(PathBuf::from(env::var_os("HOME")?).join(".pyenv"));
    let versions = env::var_os("PYENV_ROOT").map(PathBuf::from).or_else(home)?.join("versions");
    let prefix = format!("{}.", name.trim_start_matches("python"));
    let entries = fs::read_dir(versions).into_iter().flatten().flatten();
    let installed = entries.filter(|e| e.file_name().to_string_lossy().starts_with(&prefix));
    let mut places: Vec<PathBuf> = installed.map(|e| e.path().join("bin").join(name)).collect();
    places.sort_unstable();
    places.insert(0, PathBuf::from(name));
    let ask =
        "import sys; print(sys.executable if sys.version.split('.')[:2] == sys.argv[1].split('.') else '')";
    places.iter().find_map(|place| {
        let mut python = Command::new(place);
        let told = python
            .args(["-I", "-c", ask, prefix.trim_end_matches('.')])
            .stderr(Stdio::null())
            .output()
            .ok()?;
        let executable = String::from_utf8(told.stdout).ok()?;
        let executable = executable.trim();
        (told.status.success() && !executable.is_empty()).then(|| PathBuf::from(executable))
    })
}

/// A folder in which `python3` is this interpreter.
fn standing_in(interpreter: &Path) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let script = format!("#!/bin/sh\nexec '{}' \"$@\"\n", interpreter.display());
    let path = folder.path().join("python3");
    fs::write(&path, script).unwrap();
    fs::set_permissions(path, fs::Permissions::from_mode(0o755)).unwrap();
    folder
}

/// Not even covered lines may differ: what counts as a line follows from the source alone. (What versions of Python print of an
/// uncaught exception does differ; there is none in these runs.)
#[test]
fn every_python_gives_the_same_bytes() {
    let found: Vec<(&str, Option<PathBuf>)> = PYTHONS.map(|name| (name, interpreter(name))).into();
    for (name, place) in &found {
        println!("{name} {}", if place.is_some() { "is compared" } else { "is not installed, and left out" });
    }
    let installed = found.iter().filter(|(_, place)| place.is_some()).count();
    assert!(installed > 0, "no Python from 3.10 to 3.13 is installed");
    if installed == 1 {
        println!("there is nothing to compare it with");
        return;
    }
    for system in SYSTEMS {
        let folder = system.folder();
        let mut first: Option<(&str, BTreeMap<String, RunBytes>)> = None;
        for (python, place) in &found {
            let Some(place) = place else { continue };
            let path = standing_in(place);
            let options = format!("--suite {} -n 2", system.suite);
            let runs = system.run(folder.path(), "", &options, Some(path.path()));
            let told: Value =
                serde_json::from_slice(&fs::read(folder.path().join("out/run.json")).unwrap()).unwrap();
            let version = format!("{}.", python.trim_start_matches("python"));
            assert!(told["python"].as_str().unwrap().starts_with(&version), "{told}");
            let Some((other, before)) = &first else {
                first = Some((python, runs));
                continue;
            };
            assert_eq!(before.len(), runs.len(), "{system}");
            for (name, bytes) in before {
                bytes.assert_same(&runs[name], &format!("{system}: {name} with {other} and {python}"));
            }
        }
    }
}

/// What is not in the list is not repeated.
#[test]
fn every_system_of_the_examples_is_repeated() {
    for (name, bytes) in tree(&root().join("examples")) {
        let Some((example, file)) = name.split_once('/').filter(|_| name.ends_with(".hri")) else { continue };
        let text = String::from_utf8(bytes).unwrap();
        if text.lines().any(|line| line.starts_with("system ")) {
            let scenario =
                fs::read_to_string(root().join("examples").join(example).join("scenario.hri")).unwrap();
            let own = file == "scenario.hri" || scenario.contains(&format!("use \"{file}\""));
            let is_listed = |s: &RepeatedSystem| s.example == example && s.file == (!own).then_some(file);
            assert!(SYSTEMS.iter().any(is_listed), "{name} has a system that is not in the list");
        }
    }
}

/// A ball falls for 0.4 s, g/2 · (0.4 s)²; and farther by half of g · 0.4 s · step/4, since the solver divides a step by four.
const FALLING: &str = r#"scenario falling

actor house : environment
actor robot : system
event begun from house to robot
stimulus look by house { emit begun; hold 400 ms }

world {
  body ball: dynamic sphere(5 cm) at (0 m, 0 m, 105 cm) mass 1 kg
}
require R1 safety "the ball stays up" globally height(ball) > 20 cm

system robot { run "python3 robot.py"; limit 400 ms }
"#;

#[test]
fn a_verdict_that_hangs_on_the_physics_step_is_found() {
    let tests = "test fall.t1 { seed 1; look }\n";
    let robot = "import hrdsl\nnode = hrdsl.Node('robot')\nnode.wait_for('begun')\nnode.sleep(1)\n";
    let at = support::folder(&[("scenario.hri", FALLING), ("a.tests.hri", tests), ("robot.py", robot)]);
    let sim = |more: &str| hrdsl_in(at.path(), &format!("sim scenario.hri a.tests.hri -o out {more}"));

    // 1 m - 0.785 m - 0.005 m is above 20 cm, with 40 ms 1 m - 0.785 m - 0.02 m below.
    let same = sim("--physics-steps 5ms,1ms");
    expect_code(&same, 0);
    assert!(support::stdout(&same).contains("1 test comes to the same in 2 other steps of the physics"));
    let other = sim("--physics-steps 5ms,40ms");
    expect_code(&other, 3);
    let text = support::stdout(&other);
    assert!(
        text.contains("falling.fall.t1: with --physics-step 40ms, R1 is violated, and passed with 10ms"),
        "{text}"
    );
    assert!(text.contains("as many differ: 0 with --physics-step 5ms, 1 with --physics-step 40ms"), "{text}");

    // In that step alone, and how to do it again; what makes no sense is refused.
    let alone = sim("--physics-step 40ms");
    expect_code(&alone, 3);
    assert!(support::stdout(&alone).contains("--physics-step 40ms --test"), "{}", support::stdout(&alone));
    for (step, why) in [("0s", "of more than 0 s"), ("2s", "of 1 s at most")] {
        let refused = sim(&format!("--physics-step {step}"));
        expect_code(&refused, 2);
        assert!(support::stderr(&refused).contains(why), "{}", support::stderr(&refused));
    }
}
