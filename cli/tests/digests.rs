//! What the examples give, as digests: a change that is not meant to change it does not.
//!
//! Every test compares small campaigns; the whole ones run with
//! `HRDSL_SOAK=1 cargo test -p hrdsl --test digests`. To update the digests after a change that is meant to change them, add
//! `HRDSL_UPDATE=1`, and say in the change log what is different.

mod support;

use std::{collections::BTreeMap, fmt::Write as _, fs, path::Path};

use serde_json::Value;
use sha2::{Digest, Sha256};
use support::{expect_code, hrdsl_in, root, tree};

/// What a part of the results is made of, by its name.
type Parts = BTreeMap<&'static str, Sha256>;

/// Generates an example's tests, and runs them if there is something to run.
fn parts(example: &str, runs: bool, count: Option<u32>) -> Parts {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in tree(&root().join("examples").join(example)) {
        let to = folder.path().join(name);
        fs::create_dir_all(to.parent().unwrap()).unwrap();
        fs::write(to, bytes).unwrap();
    }
    let count = count.map_or_else(String::new, |n| format!(" -n {n}"));
    let mut parts = Parts::new();
    if runs {
        let line = format!("sim scenario.hri -o out --exit-zero{count}");
        expect_code(&hrdsl_in(folder.path(), &line), 0);
        judged(&folder.path().join("out/results.json"), &mut parts);
    } else {
        expect_code(&hrdsl_in(folder.path(), &format!("gen scenario.hri -o out/tests{count}")), 0);
    }
    for (name, bytes) in tree(&folder.path().join("out")) {
        let mut add = |part: &'static str, bytes: &[u8]| {
            let digest = parts.entry(part).or_default();
            digest.update(name.as_bytes());
            digest.update(bytes);
        };
        match name.split('/').next() {
            Some("tests") if !name.contains(".hrdsl-results") => add("tests", &bytes),
            Some("traces") => add("steps", steps(&bytes)),
            Some("output") => add("output", &bytes),
            Some("junit.xml") => add("junit.xml", &bytes),
            Some("report.html") => add("report.html", &bytes),
            Some(_) | None => {}
        }
    }
    parts
}

/// A recording without its first and last line, which say where it comes from and how it ended.
fn steps(recording: &[u8]) -> &[u8] {
    let text = recording.strip_suffix(b"\n").unwrap();
    let from = text.iter().position(|b| *b == b'\n').unwrap();
    let to = text.iter().rposition(|b| *b == b'\n').unwrap();
    &text[from..to.max(from)]
}

fn judged(results: &Path, parts: &mut Parts) {
    let results: Value = serde_json::from_slice(&fs::read(results).unwrap()).unwrap();
    let digest = |of: &mut dyn Iterator<Item = String>| Sha256::new_with_prefix(of.collect::<String>());
    let tests = results["tests"].as_array().unwrap();
    let test = |t: &Value, what: &str| format!("{} {}\n", t["name"], t[what]);
    parts.insert("verdicts", digest(&mut tests.iter().map(|t| test(t, "verdicts"))));
    parts.insert("endings", digest(&mut tests.iter().map(|t| test(t, "ended") + &test(t, "error"))));
    parts.insert("bins", digest(&mut tests.iter().map(|t| test(t, "bins") + &test(t, "predicted"))));
    parts.insert("code", digest(&mut tests.iter().map(|t| test(t, "code"))));
    for test in tests {
        exact(test);
    }
    let goals = results["suites"].as_array().unwrap().iter();
    parts.insert("goals", digest(&mut goals.map(|s| format!("{} {}\n", s["name"], s["goals"]))));
}

/// No links of a robot may be in each other by more than a millimetre, nor any other bodies by more than two, as falls and blows leave them
/// for a moment; no joint beyond its limits at all; and none apart by more than a centimetre, as a finger that is torn gives way.
fn exact(test: &Value) {
    let worst = |pointer: &str| test["physics"].pointer(pointer).and_then(Value::as_f64).unwrap_or(0.0);
    let (own, others) = (worst("/self_penetration/depth"), worst("/penetration/depth"));
    let (beyond, apart) = (worst("/beyond_limit/by"), worst("/joint_gap/apart"));
    assert!(
        own < 1e-3 && others < 2e-3 && beyond == 0.0 && apart < 1e-2,
        "{}: {}",
        test["name"],
        test["physics"]
    );
}

/// The examples whose campaigns have no digests here: the same holds in reduced ones, and none ends as an error.
#[test]
fn the_physics_of_the_other_examples_is_exact() {
    for example in ["delivery", "homecare", "workbench"] {
        let folder = tempfile::tempdir().unwrap();
        for (name, bytes) in tree(&root().join("examples").join(example)) {
            let to = folder.path().join(name);
            fs::create_dir_all(to.parent().unwrap()).unwrap();
            fs::write(to, bytes).unwrap();
        }
        expect_code(&hrdsl_in(folder.path(), "sim scenario.hri -o out --exit-zero -n 2"), 0);
        let results: Value =
            serde_json::from_slice(&fs::read(folder.path().join("out/results.json")).unwrap()).unwrap();
        let tests = results["tests"].as_array().unwrap();
        assert!(!tests.is_empty());
        for test in tests {
            assert!(test["error"].is_null(), "{}: {}", test["name"], test["error"]);
            exact(test);
        }
    }
}

#[test]
fn the_examples_give_what_they_gave() {
    let whole = std::env::var_os("HRDSL_SOAK").is_some();
    let (size, count) = if whole { ("whole", None) } else { ("small", Some(8)) };
    let mut found = String::new();
    for (example, runs) in [("corridor", true), ("handover", true), ("homecare", false)] {
        for (part, digest) in parts(example, runs, count) {
            let hex = digest.finalize().iter().fold(String::new(), |hex, byte| format!("{hex}{byte:02x}"));
            let _ = writeln!(found, "{size} {example} {part} {hex}");
        }
    }
    let path = root().join("cli/tests/digests.txt");
    let before = fs::read_to_string(&path).unwrap_or_default();
    let (own, others): (Vec<&str>, Vec<&str>) = before.lines().partition(|l| l.starts_with(size));
    if std::env::var_os("HRDSL_UPDATE").is_some() {
        let mut lines: Vec<&str> = others.into_iter().chain(found.lines()).collect();
        lines.sort_unstable();
        fs::write(&path, lines.join("\n") + "\n").unwrap();
    } else {
        let found: Vec<&str> = found.lines().collect();
        let differs: Vec<&&str> = found.iter().filter(|l| !own.contains(*l)).collect();
        assert!(differs.is_empty() && own.len() == found.len(), "these differ: {differs:#?}");
    }
}
