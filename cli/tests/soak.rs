//! `hrdsl sim` against the hostile programs of `hostile/`: each test gets an ending, the expected one, and nothing is left.
//!
//! A program says in its first comments what is expected of its tests (`# expect: pass`, `# expect: any`, or `# expect: error
//! "…"`, with a part of the message), and, if need be, what must be in its output (`# output: "…"`), the command that runs it
//! (`# run: …`), options of `hrdsl sim` (`# options: …`), and that it would harm the machine outside of namespaces
//! (`# needs: namespaces`).
//!
//! Every sixth program runs with one test; with `HRDSL_SOAK=1` all of them run with three, in namespaces and in copies.
//! `HRDSL_SOAK_ONLY=WORD` chooses those with this word in their names.
#![allow(clippy::disallowed_methods, reason = "tests start processes and read files")]

mod support;

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    os::unix::fs::{MetadataExt, PermissionsExt},
    path::{Path, PathBuf},
    process::{Command, Output, Stdio},
    sync::{
        Mutex,
        atomic::{AtomicUsize, Ordering},
    },
    time::{Duration, Instant},
};

use serde_json::Value;
use support::{command, root, stderr, stdout};

const SCENARIO: &str = r#"scenario soak

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
  run RUN
  COVERAGE
  env SOAK_MARK
  limit 20 s
  budget 1 s
  cpu 5 s
  wall 60 s
  memory 300 MB
  output 5 MB
}
"#;

/// Programs that run at once: most of them wait.
const AT_ONCE: usize = 6;

/// One program may take so long, on a machine that does much else; it only guards.
const GUARD: Duration = Duration::from_secs(600);

/// What is expected of each test.
#[derive(Clone, Debug, PartialEq)]
enum Expected {
    Pass,
    Any,
    /// A test that breaks off with this in its message.
    Error(String),
}

#[derive(Debug)]
struct Hostile {
    name: String,
    text: String,
    expected: Expected,
    output: Option<String>,
    run: Option<String>,
    options: String,
    needs_namespaces: bool,
}

impl Hostile {
    fn read(path: &Path) -> Self {
        let text = fs::read_to_string(path).unwrap();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        let said = |key: &str| {
            let start = format!("# {key}: ");
            text.lines().take(8).find_map(|l| l.strip_prefix(&start)).map(str::to_owned)
        };
        let unquoted = |text: &str| text.trim_matches('"').to_owned();
        let expected = match said("expect").as_deref() {
            Some("pass") => Expected::Pass,
            Some("any") => Expected::Any,
            Some(error) => Expected::Error(unquoted(error.strip_prefix("error ").expect("a kind of ending"))),
            None => panic!("{name} does not say what is expected"),
        };
        let needs = said("needs");
        assert!(needs.as_deref().is_none_or(|n| n == "namespaces"), "{name}");
        Self {
            expected,
            output: said("output").as_deref().map(unquoted),
            run: said("run"),
            options: said("options").unwrap_or_default(),
            needs_namespaces: needs.is_some(),
            name,
            text,
        }
    }

    /// Writes a project with this program and so many tests.
    fn project(&self, folder: &Path, tests: usize) {
        let python = self.name.ends_with(".py");
        let file = if python { "robot.py" } else { "robot.sh" };
        let interpreter = if python { "python3" } else { "bash" };
        let run = self.run.clone().unwrap_or_else(|| format!("{interpreter} {file}"));
        let coverage = if python { "coverage \"robot.py\"" } else { "" };
        let scenario = SCENARIO.replace("RUN", &format!("{run:?}")).replace("COVERAGE", coverage);
        fs::write(folder.join("scenario.hri"), scenario).unwrap();
        fs::write(folder.join(file), &self.text).unwrap();
        let tests: String =
            (1..=tests).map(|n| format!("test hand.t{n} {{ seed {n}; ask; wait 1 s }}\n")).collect();
        fs::write(folder.join("tests.hri"), tests).unwrap();
    }
}

/// A program that runs in cells of one kind, and what is to be found out about it.
struct Case<'h> {
    hostile: &'h Hostile,
    isolation: &'static str,
    tests: usize,
    /// In the environment of the program and of all that it starts.
    mark: String,
    faults: Vec<String>,
    endings: BTreeMap<String, usize>,
}

impl Case<'_> {
    fn check(&mut self, holds: bool, what: impl FnOnce() -> String) {
        if !holds {
            self.faults.push(format!("{} in {}: {}", self.hostile.name, self.isolation, what()));
        }
    }

    fn run(&mut self) {
        let folder = tempfile::tempdir().unwrap();
        let (project, temporary) = (folder.path().join("project"), folder.path().join("tmp"));
        fs::create_dir(&project).unwrap();
        fs::create_dir(&temporary).unwrap();
        self.hostile.project(&project, self.tests);
        let before = listing(&project);
        let begun = Instant::now();
        let out = self.sim(&project, &temporary);
        let Some(out) = out else { return };
        if std::env::var_os("HRDSL_SOAK").is_some() || std::env::var_os("HRDSL_SOAK_ONLY").is_some() {
            eprintln!(
                "{:>6.1} s  {} in {}",
                begun.elapsed().as_secs_f64(),
                self.hostile.name,
                self.isolation
            );
        }
        self.look_at_output(&out);
        self.look_at_results(&project.join("out"), &out);
        let mut after = listing(&project);
        after.retain(|path, _| !path.starts_with("out"));
        self.check(before == after, || format!("the project has changed: {before:?} to {after:?}"));
        let left: Vec<PathBuf> = listing(&temporary).into_keys().collect();
        self.check(left.is_empty(), || {
            format!("left in the temporary folder: {:?}", &left[..left.len().min(5)])
        });
        let left = marked(&self.mark);
        self.check(left.is_empty(), || format!("left running: {left:?}"));
        // What is left is removed here, however deep it lies.
        let _ = Command::new("rm").arg("-rf").arg(folder.path()).status();
    }

    /// `None` if it did not end in time.
    fn sim(&mut self, project: &Path, temporary: &Path) -> Option<Output> {
        let mut command = command();
        command.args([
            "sim",
            "scenario.hri",
            "tests.hri",
            "-o",
            "out",
            "-j",
            "2",
            "--isolation",
            self.isolation,
        ]);
        command.args(self.hostile.options.split_whitespace()).current_dir(project).stdin(Stdio::null());
        command.env("SOAK_MARK", &self.mark).env("TMPDIR", temporary);
        let (stdout, stderr) = (project.with_extension("stdout"), project.with_extension("stderr"));
        command.stdout(fs::File::create(&stdout).unwrap()).stderr(fs::File::create(&stderr).unwrap());
        let mut child = command.spawn().unwrap();
        let until = Instant::now() + GUARD;
        let status = loop {
            match child.try_wait().unwrap() {
                Some(status) => break status,
                None if Instant::now() > until => {
                    let _ = child.kill();
                    let _ = child.wait();
                    self.check(false, || format!("has not ended within {} s", GUARD.as_secs()));
                    return None;
                }
                None => std::thread::sleep(Duration::from_millis(20)),
            }
        };
        Some(Output { status, stdout: fs::read(stdout).unwrap(), stderr: fs::read(stderr).unwrap() })
    }

    fn look_at_output(&mut self, out: &Output) {
        let code = out.status.code();
        let expected: &[i32] = match self.hostile.expected {
            Expected::Pass => &[0],
            Expected::Any => &[0, 3],
            Expected::Error(_) => &[3],
        };
        self.check(code.is_some_and(|c| expected.contains(&c)), || {
            format!("exit code {code:?}, not of {expected:?}:\n{}\n{}", stdout(out), stderr(out))
        });
        for text in [stdout(out), stderr(out)] {
            let steers =
                text.chars().any(|c| c != '\n' && c.is_control() || ('\u{202a}'..='\u{202e}').contains(&c));
            self.check(!steers, || format!("what is printed steers the terminal: {text:?}"));
        }
    }

    fn look_at_results(&mut self, out: &Path, said: &Output) {
        let Some(results) =
            fs::read(out.join("results.json")).ok().and_then(|t| serde_json::from_slice(&t).ok())
        else {
            return self.check(false, || format!("no results:\n{}\n{}", stdout(said), stderr(said)));
        };
        let results: Value = results;
        let tests = results["tests"].as_array().cloned().unwrap_or_default();
        let planned = self.tests;
        self.check(tests.len() == planned, || format!("{} tests of {planned}", tests.len()));
        for test in &tests {
            self.look_at_test(test);
        }
        let recordings = fs::read_dir(out.join("traces")).map_or(0, Iterator::count);
        self.check(recordings == self.tests, || format!("{recordings} recordings"));
        let page = fs::read_to_string(out.join("report.html")).unwrap_or_default();
        self.check(page.contains("</html>"), || "no report".to_owned());
        let junit = fs::read_to_string(out.join("junit.xml")).unwrap_or_default();
        let allowed = |c: char| !c.is_control() && !"\u{fffe}\u{ffff}".contains(c) || "\t\r\n".contains(c);
        self.check(junit.contains("</testsuites>") && junit.chars().all(allowed), || {
            format!("no XML: {junit:?}")
        });
        if let Some(expected) = &self.hostile.output {
            for n in 1..=self.tests {
                let text =
                    fs::read_to_string(out.join(format!("output/soak.hand.t{n}.txt"))).unwrap_or_default();
                self.check(text.contains(expected), || format!("the output of test {n} is {text:?}"));
            }
        }
    }

    fn look_at_test(&mut self, test: &Value) {
        let ended = test["ended"].as_str().unwrap_or("none").to_owned();
        self.check(["quiescent", "limit", "error"].contains(&&*ended), || {
            format!("a test without an end: {test}")
        });
        let error = test["error"].as_str();
        match &self.hostile.expected {
            Expected::Pass => self.check(error.is_none(), || format!("{error:?}")),
            Expected::Error(part) => {
                let has = error.is_some_and(|e| e.contains(part));
                self.check(has, || format!("expected {part:?}, got {error:?}"));
            }
            Expected::Any => {}
        }
        *self.endings.entry(ended).or_default() += 1;
    }
}

/// All that is in a folder, with its size.
fn listing(folder: &Path) -> BTreeMap<PathBuf, u64> {
    let mut found = BTreeMap::new();
    let mut open = vec![PathBuf::new()];
    while let Some(next) = open.pop() {
        for entry in fs::read_dir(folder.join(&next)).into_iter().flatten().flatten() {
            let path = next.join(entry.file_name());
            let is = entry.metadata().unwrap();
            if is.is_dir() && open.len() < 1000 && path.components().count() < 100 {
                open.push(path.clone());
            }
            found.insert(path, if is.is_dir() { u64::from(is.permissions().mode()) } else { is.size() });
        }
    }
    found
}

/// The processes that have this mark in their environment: programs of cells, and what they have started.
fn marked(mark: &str) -> Vec<String> {
    let has = |e: &fs::DirEntry| {
        let environment = fs::read(e.path().join("environ")).unwrap_or_default();
        environment.windows(mark.len()).any(|w| w == mark.as_bytes())
    };
    let name = |e: &fs::DirEntry| {
        let line = fs::read(e.path().join("cmdline")).unwrap_or_default();
        format!("{} {}", e.file_name().display(), String::from_utf8_lossy(&line).replace('\0', " "))
    };
    fs::read_dir("/proc").unwrap().flatten().filter(has).map(|e| name(&e)).collect()
}

/// The supervisors of cells that this build has started.
fn supervisors() -> Vec<PathBuf> {
    let own = Path::new(env!("CARGO_BIN_EXE_hrdsl")).canonicalize().unwrap();
    let is = |pid: &PathBuf| {
        fs::read_link(pid.join("exe")).is_ok_and(|exe| exe == own)
            && fs::read(pid.join("cmdline"))
                .is_ok_and(|l| l.split(|b| *b == 0).any(|w| w == b"supervise-cell"))
    };
    fs::read_dir("/proc").unwrap().flatten().map(|e| e.path()).filter(is).collect()
}

fn programs() -> Vec<Hostile> {
    let folder = root().join("cli/tests/hostile");
    let mut paths: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    paths.sort();
    paths.iter().map(|path| Hostile::read(path)).collect()
}

/// What is outside of the cells, as far as the programs reach for it.
fn outside() -> BTreeSet<PathBuf> {
    let folders = ["/", "/etc", "/usr", "/var", "/var/tmp", "/dev", "/dev/shm"];
    let written = folders.map(|folder| Path::new(folder).join("hrdsl-soak"));
    let shared = [PathBuf::from("/dev/shm/full"), PathBuf::from("/tmp/hrdsl-soak")];
    written.into_iter().chain(shared).filter(|path| path.exists()).collect()
}

fn has_namespaces() -> bool {
    let folder = support::folder(&[]);
    let hostile = Hostile::read(&root().join("cli/tests/hostile/shell_protocol.sh"));
    hostile.project(folder.path(), 1);
    let out = support::hrdsl_in(folder.path(), "sim scenario.hri tests.hri --isolation namespaces");
    out.status.success()
}

/// Held by each test: the supervisors of one are none that the other has left.
static ALONE: Mutex<()> = Mutex::new(());

#[test]
fn every_test_ends_as_expected_and_nothing_is_left() {
    let _alone = ALONE.lock();
    let whole = std::env::var_os("HRDSL_SOAK").is_some();
    let only = std::env::var("HRDSL_SOAK_ONLY").ok();
    let programs = programs();
    assert!(programs.len() >= 80);
    let isolations: &[&'static str] = match (has_namespaces(), whole) {
        (true, true) => &["namespaces", "copies"],
        (true, false) => &["namespaces"],
        (false, _) => &["copies"],
    };
    let chosen =
        programs.iter().enumerate().filter(|(n, _)| whole || only.is_some() || n % 6 == 0).map(|(_, p)| p);
    let chosen = chosen.filter(|p| only.as_ref().is_none_or(|word| p.name.contains(word.as_str())));
    let runs = chosen.flat_map(|hostile| isolations.iter().map(move |isolation| (hostile, *isolation)));
    let runs: Vec<_> =
        runs.filter(|(h, isolation)| *isolation == "namespaces" || !h.needs_namespaces).collect();
    let (next, done) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let before = outside();
    std::thread::scope(|scope| {
        for _ in 0..AT_ONCE {
            scope.spawn(|| {
                while let Some((hostile, isolation)) = runs.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let mark = format!("soak-{}-{}-{isolation}-", std::process::id(), hostile.name);
                    let tests = if whole { 3 } else { 1 };
                    let (faults, endings) = (Vec::new(), BTreeMap::new());
                    let mut case = Case { hostile, isolation, tests, mark, faults, endings };
                    case.run();
                    done.lock().unwrap().push((case.faults, case.endings));
                }
            });
        }
    });
    let mut endings: BTreeMap<String, usize> = BTreeMap::new();
    let mut faults = Vec::new();
    for (found, ended) in done.into_inner().unwrap() {
        faults.extend(found);
        ended.into_iter().for_each(|(ending, n)| *endings.entry(ending).or_default() += n);
    }
    let tests: usize = endings.values().sum();
    let names: BTreeSet<&str> = runs.iter().map(|(h, _)| h.name.as_str()).collect();
    println!(
        "soak: {} programs, {} runs in {}, {tests} tests, {} endings {endings:?}, {} faults",
        names.len(),
        runs.len(),
        isolations.join(" and "),
        endings.len(),
        faults.len()
    );
    faults.sort();
    assert!(faults.is_empty(), "{}", faults.join("\n\n"));
    assert_eq!(supervisors(), Vec::<PathBuf>::new(), "supervisors are left");
    assert_eq!(outside(), before, "something is left outside of the cells");
}

/// Root has rights in namespaces that others must be left when they make their own.
#[test]
fn whoever_is_not_root_has_namespaces_too() {
    let _alone = ALONE.lock();
    let other = ["-U", "--map-user=1000", "--map-group=1000"];
    let mut probe = Command::new("unshare");
    if !probe.args(other).arg("true").stderr(Stdio::null()).status().is_ok_and(|s| s.success()) {
        return;
    }
    let folder = support::folder(&[]);
    let hostile = Hostile::read(&root().join("cli/tests/hostile/files_everywhere.py"));
    hostile.project(folder.path(), 2);
    let mut command = Command::new("unshare");
    command.args(other).arg(env!("CARGO_BIN_EXE_hrdsl")).args(["sim", "scenario.hri", "tests.hri"]);
    command.args(["--isolation", "namespaces", "--keep-files"]).current_dir(folder.path());
    let out = command.env("HRDSL_CACHE", root().join("target/hrdsl-cache")).output().unwrap();
    support::expect_code(&out, 0);
    assert!(folder.path().join("hrdsl-out/soak/files/soak.hand.t2/project/scenario.hri").exists());
}
