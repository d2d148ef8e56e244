//! Fixes are exact: each replaces just the text that its title names, and certain ones remove what they are for.

#![allow(clippy::disallowed_methods, reason = "the test reads the fixtures")]

use std::{fs, path::Path};

use hrdsl_compiler::{CompilationResult, InputFile, compile};
use hrdsl_source::{Diagnostic, DiagnosticCode, SuggestedFix};

fn one(text: &str) -> CompilationResult {
    compile(InputFile { name: "a.hri", text }, &[])
}

/// ``replace `a` by `b` ``
fn words(title: &str) -> Option<(&str, &str)> {
    title.strip_prefix("replace `")?.strip_suffix('`')?.split_once("` by `")
}

fn fixes(compilation: &CompilationResult) -> Vec<(&Diagnostic, &SuggestedFix)> {
    compilation.diagnostics.iter().flat_map(|d| d.fixes.iter().map(move |f| (d, f))).collect()
}

#[test]
fn a_replacement_stands_for_what_it_names() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/check");
    let mut seen = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            continue;
        }
        let text = fs::read_to_string(path).unwrap();
        let compilation = one(&text);
        for (diagnostic, fix) in fixes(&compilation) {
            assert!(!fix.edits.is_empty() && fix.edits.is_sorted_by_key(|e| e.span));
            let Some((from, to)) = words(&fix.title) else { continue };
            seen += 1;
            let edit = &fix.edits[0];
            assert_eq!(compilation.files.text(edit.span), from, "{} {}", diagnostic.code, fix.title);
            assert_eq!(edit.text.trim(), to);
        }
        for d in compilation.diagnostics.iter().filter(|d| d.code == DiagnosticCode::UNKNOWN_NAME) {
            // A small variable can be replaced where the capital one is known.
            let capital = |h: &str| h.starts_with("variables of agents begin") && h.ends_with('`');
            let near = d.help.as_ref().is_some_and(|h| h.starts_with("did you mean") || capital(h));
            let quoted = compilation.files.text(d.span()).starts_with('"');
            assert_eq!(near && !quoted, !d.fixes.is_empty(), "{d:?}");
        }
    }
    assert!(seen >= 50, "only {seen} replacements in the fixtures");
}

const START: &str =
    "scenario a\nactor p : environment\nactor r : system\nevent e from p to r\nstimulus s by p { emit e }\n";

/// A plan's condition and body, and whether all that is said of it can be fixed for certain.
#[test]
fn certain_fixes_are_those_that_mend() {
    let cases = [
        ("n(X) && X ≤ 1", "s; s", true),
        ("n(X) && X ≠ 1", "s; s", true),
        ("n(X)\u{a0}\u{a0}&& X >= 1", "s", true),
        ("n(X) && X == 1 × 2", "s", true),
        ("n(X) && X == 2 − 1", "s", true),
        ("n(X)", "; s;; s", true),
        ("n(X)", "s\n s", true),
        ("n(X) & X == 1", "s", false),
        ("n(X) && X ≤≤ 1", "s", false),
        ("n(X) && X == 2 – 1", "s", false),
        ("n(X)", "s s", false),
        ("n(X)", "t", false),
    ];
    for (condition, body, certain) in cases {
        let plan = format!(
            "agent A plays p {{ belief n(x: 0..2)\n goal !g\n plan +!g when {condition} {{ {body} }} }}\n"
        );
        let mut text = format!("{START}{plan}");
        let compilation = one(&text);
        assert!(compilation.has_errors(), "{plan}");
        for _ in 0..5 {
            let compilation = one(&text);
            let found = fixes(&compilation).into_iter().find(|(_, f)| f.certain).map(|(_, f)| f.clone());
            let Some(fix) = found else { break };
            for edit in fix.edits.iter().rev() {
                text.replace_range(edit.span.range(), &edit.text);
            }
        }
        assert_eq!(!one(&text).has_errors(), certain, "{text}\n{:?}", one(&text).diagnostics);
    }
}
