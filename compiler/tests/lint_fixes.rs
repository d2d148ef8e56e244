//! Each fix that a lint of the fixtures in `lint/` offers removes what it is offered for.

#![allow(clippy::disallowed_methods, reason = "the test reads its fixtures")]

use std::{
    fs,
    path::{Path, PathBuf},
};

use hrdsl_compiler::{CompilationResult, InputFile, compile};
use hrdsl_source::{Diagnostic, SuggestedFix};

fn fixtures(folder: &Path, all: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() { fixtures(&path, all) } else { all.push(path) }
    }
}

/// How often the same is said of the same text: a fix may uncover something of the same kind behind it.
fn said(c: &CompilationResult, of: &Diagnostic, text: &str) -> usize {
    let same = |d: &&Diagnostic| {
        (d.code, d.message.as_str(), c.files.text(d.span())) == (of.code, of.message.as_str(), text)
    };
    c.diagnostics.iter().filter(same).count()
}

fn fixed(text: &str, fix: &SuggestedFix) -> String {
    let mut text = text.to_owned();
    for edit in fix.edits.iter().rev() {
        text.replace_range(edit.span.range(), &edit.text);
    }
    text
}

#[test]
fn every_fix_mends_what_it_is_offered_for() {
    let mut paths = Vec::new();
    fixtures(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/lint"), &mut paths);
    paths.sort();
    let mut fixes = 0;
    for path in paths {
        let text = fs::read_to_string(&path).unwrap();
        let before = compile(InputFile { name: "fixture.hri", text: &text }, &[]);
        for d in &before.diagnostics {
            for fix in &d.fixes {
                let after = compile(InputFile { name: "fixture.hri", text: &fixed(&text, fix) }, &[]);
                let what = format!("{}: {}: {}", path.display(), d.code, fix.title);
                assert!(after.has_errors() <= before.has_errors(), "{what}: {:?}", after.diagnostics);
                let of = before.files.text(d.span());
                assert!(said(&after, d, of) < said(&before, d, of), "{what}");
                fixes += 1;
            }
        }
    }
    assert!(fixes >= 7, "there are only {fixes} fixes");
}
