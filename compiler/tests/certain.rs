//! Certain fixes hold: each one of each fixture, taken by itself, takes its finding away and brings no error.

#![allow(clippy::disallowed_methods, reason = "the test reads its fixtures")]

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

use hrdsl_compiler::{CompilationResult, InputFile, compile};
use hrdsl_source::SuggestedFix;

#[path = "fixing/mod.rs"]
mod fixing;

fn fixtures(folder: &Path, all: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() { fixtures(&path, all) } else { all.push(path) }
    }
}

fn one(text: &str) -> CompilationResult {
    compile(InputFile { name: "fixture.hri", text }, &[])
}

#[test]
fn in_every_fixture() {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    let mut paths = Vec::new();
    ["check", "lint", "scenarios"].iter().for_each(|f| fixtures(&tests.join(f), &mut paths));
    let (mut faults, mut tried) = (Vec::new(), 0);
    for path in paths {
        let text = fs::read_to_string(&path).unwrap();
        let (wrong, fixes) = fixing::faults(&text, &one);
        faults.extend(wrong.into_iter().map(|f| format!("{}: {f}", path.display())));
        tried += fixes;
    }
    assert!(tried >= 20, "only {tried} certain fixes were found");
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

/// What the scenario with `line` says is unused, with whether it can go for certain.
fn unused(text: &str) -> BTreeMap<String, Option<bool>> {
    let c = one(text);
    assert!(!c.has_errors(), "{:?}", c.diagnostics);
    let (wrong, _) = fixing::faults(text, &one);
    assert!(wrong.is_empty(), "{wrong:?}");
    let found = c.diagnostics.iter().filter(|d| d.code.to_string() == "HR0107");
    found
        .map(|d| (c.files.text(d.span()).to_owned(), d.fixes.first().map(|f: &SuggestedFix| f.certain)))
        .collect()
}

const QUERIES: &str = "scenario queries
var seen: 0..3
var cells: (0..3)[2]
var idle: 0..3
var all: clock
var none: clock
automaton P {
  clock x, y, z
  var n: 0..3
  var m: 0..1
  var k: 0..3
  var l: 0..3
  var gone: 0..3
  fn twice(i: 0..1) -> 0..6 { return k + k }
  init location a
  location b
  a -> b do x = 0; y = 0; z = 0
}
automaton Q {
  var n: 0..3
  var gone: 0..3
  clock y
  init location a
  location b
  a -> b do y = 0
}
network net = P | Q
query one of net = E<> P.n == 1 and seen == 1 and cells[P.m] == 1
query two of net = sup{Q.n == 1}: P.x, all, P.l
query three of net = P.y - Q.y < 1 s --> P.twice(0) == 2
";

#[test]
fn what_queries_read_is_read() {
    let found = unused(QUERIES);
    let expected = [("gone", Some(true)), ("idle", Some(true)), ("none", Some(true)), ("z", None)];
    assert_eq!(found, expected.map(|(n, c)| (n.to_owned(), c)).into());
}

/// Nothing makes the templates, but they speak of what they would use.
#[test]
fn what_a_template_names_does_not_go_for_certain() {
    let text = "scenario templates
actor p: environment
event asked from p
channel go
var count: 0..3
const LIMIT = 3
automaton T(n: 0..3) plays p {
  init location a
  a -> a when count < LIMIT do asked
  a -> a on go
}
";
    let found = unused(text);
    assert_eq!(found["T"], Some(true));
    for name in ["go", "count", "asked"] {
        assert!(found.get(name).is_none_or(|certain| *certain != Some(true)), "{name}: {found:?}");
    }
}

#[test]
fn one_of_several_does_not_take_the_others_along() {
    let text = "scenario several\nactor p: environment\nactor r: system\nevent a, b from p to r\nstimulus s by p { emit a }\n";
    assert_eq!(unused(text)["b"], None);
}
