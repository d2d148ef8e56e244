//! The corpus of the fuzz targets, replayed: every input that was ever of interest, through the target that it belongs to.

#![allow(clippy::disallowed_methods, reason = "reads the corpus")]

use std::{
    collections::BTreeSet,
    fmt::Write,
    fs::{self, File},
    io::Read,
    path::PathBuf,
};

use hrdsl_model::UNITS;
use hrdsl_syntax::token::KEYWORDS;

#[path = "../../fuzz/targets.rs"]
mod targets;

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../fuzz")
}

#[test]
fn the_corpus_holds() {
    for (name, target) in targets::TARGETS {
        let packed = File::open(folder().join("corpus").join(format!("{name}.tar.gz"))).unwrap();
        let mut archive = tar::Archive::new(flate2::read::GzDecoder::new(packed));
        let mut seen = 0;
        for entry in archive.entries().unwrap() {
            let mut entry = entry.unwrap();
            let mut data = Vec::new();
            entry.read_to_end(&mut data).unwrap();
            // Which input it is that fails.
            println!("{name}: {}", entry.path().unwrap().display());
            target(&data);
            seen += 1;
        }
        assert!(seen > 100, "the target `{name}` has no corpus");
        let Ok(inputs) = fs::read_dir(folder().join("regressions").join(name)) else { continue };
        for input in inputs {
            let path = input.unwrap().path();
            println!("{}", path.display());
            target(&fs::read(&path).unwrap());
        }
    }
}

/// Every target of the corpus has a binary that libFuzzer drives, and the other way round.
#[test]
fn every_target_is_fuzzed() {
    let files = fs::read_dir(folder().join("fuzz_targets")).unwrap();
    let fuzzed: BTreeSet<String> =
        files.map(|f| f.unwrap().path().file_stem().unwrap().to_string_lossy().into_owned()).collect();
    let replayed: BTreeSet<String> = targets::TARGETS.iter().map(|(name, _)| (*name).to_owned()).collect();
    assert_eq!(fuzzed, replayed);
}

/// The words and marks of the language, as libFuzzer reads them.
#[expect(clippy::too_many_lines, reason = "a flat list")]
fn dictionary() -> String {
    let marks = [
        "(",
        ")",
        "{",
        "}",
        "[",
        "]",
        ",",
        ";",
        ":",
        ".",
        "..",
        "@",
        "?",
        "|",
        "->",
        "=",
        "+=",
        "-=",
        "-+",
        "!",
        "!!",
        "&&",
        "||",
        "==",
        "!=",
        "<",
        "<=",
        ">",
        ">=",
        "+",
        "-",
        "*",
        "/",
        "%",
        "^",
        "_",
        "//",
        "///",
        "bool",
        "float",
        "number",
        "event",
        "actor",
        "place",
        "arm",
        "gripper",
        "std.person",
        "std.robots.bert2",
        "else if",
        "plan +!",
        "plan -!",
        "-+",
        "9223372036854775807",
        "0.0",
        "1e308",
        "abs",
        "min",
        "max",
        "norm",
        "distance",
        "range",
        "angle",
        "visible",
        "holds",
        "joint_speed",
        "rising",
        "fixed",
        "dynamic",
        "kinematic",
        "box",
        "sphere",
        "capsule",
        "cylinder",
        "pairwise",
        "environment",
        "~",
        "int",
        "string",
        "[source(self)]",
        "[H | T]",
        "@p[atomic]",
        ".findall(X, b(X), L)",
        ".count(b(_), N)",
        ".member(X, [1, 2])",
        ".send(A, tell, b(1))",
        ".ask(A, b(X), 5 s)",
        ".drop_intention(g)",
        "wise(3)",
    ];
    let words = KEYWORDS.iter().map(|k| k.word).chain(marks);
    let mut text =
        "# The words of the language; made by `HRDSL_UPDATE=1 cargo test -p hrdsl-compiler --test corpus`.\n"
            .to_owned();
    let mut seen = BTreeSet::new();
    for word in words.filter(|w| seen.insert(*w)) {
        let _ = writeln!(text, "\"{word}\"");
    }
    for unit in UNITS {
        let _ = writeln!(text, "\" 1 {}\"", unit.symbol);
    }
    text.push_str("\"\\x0a//====\\x0a\"\n\"\\\"\"\n");
    text
}

#[test]
fn the_dictionary_is_that_of_the_language() {
    let path = folder().join("hri.dict");
    let now = dictionary();
    assert!(now.contains(&targets::SEPARATOR.trim().replace('\n', "\\x0a")));
    if std::env::var_os("HRDSL_UPDATE").is_some() {
        fs::write(&path, &now).unwrap();
    }
    let kept = fs::read_to_string(&path).unwrap_or_default();
    assert_eq!(kept, now, "old: HRDSL_UPDATE=1 cargo test -p hrdsl-compiler --test corpus");
}
