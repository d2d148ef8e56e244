//! One declaration checked alone: what is said of it is what the check of the whole says of it.

#![allow(clippy::disallowed_methods, reason = "the test reads its fixtures")]

use std::{collections::BTreeSet, fs, path::Path};

use hrdsl_compiler::{CompilationResult, InputFile, compile, recheck};
use hrdsl_source::{DiagnosticCode, FileId, Severity, Span};

/// The examples, and the fixtures of the checker with their hundreds of errors.
fn scenarios() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let fixtures = fs::read_dir(root.join("tests/check")).unwrap().map(|e| e.unwrap().path());
    let examples =
        fs::read_dir(root.join("../examples")).unwrap().map(|e| e.unwrap().path().join("scenario.hri"));
    let mut all: Vec<(String, String)> = fixtures
        .chain(examples)
        .filter(|path| path.extension().is_some_and(|e| e == "hri"))
        .filter_map(|path| Some((path.display().to_string(), fs::read_to_string(&path).ok()?)))
        .collect();
    all.sort();
    assert!(all.len() > 30, "{}", all.len());
    all
}

type Said = BTreeSet<(Span, DiagnosticCode, Severity, String)>;

/// What is said of the whole, in one place of it: that there is no world or no name, what `allow` allows, what is wrong with a
/// workspace of definitions, which is read before anything is checked.
fn is_of_the_whole(name: &str, code: DiagnosticCode) -> bool {
    let codes = [DiagnosticCode::MISSING_DECLARATION, DiagnosticCode::BAD_DEFINITION];
    codes.contains(&code) || name.ends_with("allow_wrong.hri")
}

/// What a whole check says of one declaration: its errors.
fn of_declaration(c: &CompilationResult, whole: Span) -> Said {
    let inside = |span: Span| span.file == whole.file && whole.start <= span.start && span.end <= whole.end;
    let errors = c.diagnostics.iter().filter(|d| d.is_error() && inside(d.span()));
    errors.map(|d| (d.span(), d.code, d.severity, d.message.clone())).collect()
}

#[test]
fn of_the_same_text_the_same_is_said() {
    let (mut declarations, mut errors, mut wrong) = (0, 0, Vec::new());
    for (name, text) in scenarios() {
        let c = compile(InputFile { name: &name, text: &text }, &[]);
        for item in &c.ast[0].items {
            let span = item.span;
            let Some(again) = recheck(&c, span.start as usize, &text[span.range()]) else { continue };
            assert!(again.same_names, "{name}: {}", &text[span.range()]);
            let said: Said = again
                .diagnostics
                .iter()
                .filter(|d| d.is_error())
                .map(|d| (d.span(), d.code, d.severity, d.message.clone()))
                .collect();
            let expected = of_declaration(&c, span);
            let differs = |(_, code, ..): &&(_, DiagnosticCode, _, _)| !is_of_the_whole(&name, *code);
            let alone: Vec<_> = said.difference(&expected).filter(differs).collect();
            let whole: Vec<_> = expected.difference(&said).filter(differs).collect();
            if !alone.is_empty() || !whole.is_empty() {
                let text = text[span.range()].lines().next();
                wrong.push(format!("{name}: {text:?}\n  alone {alone:?}\n  whole {whole:?}"));
            }
            declarations += 1;
            errors += said.len();
        }
    }
    assert!(wrong.is_empty(), "{} of {declarations}:\n{}", wrong.len(), wrong.join("\n"));
    assert!(declarations > 800 && errors > 300, "{declarations} declarations, {errors} errors");
}

const TEXT: &str = "scenario small\nactor person : environment\nactor robot : system\nevent asked(n: int) from person\n\
event done from robot\nagent Human plays person {\n  belief hungry\n  plan +!go when hungry { asked(3) }\n  goal !go\n}\n\
require R1 functional \"who asks is served\" asked causes done within 3 s\n";

#[test]
fn new_text_is_checked_where_it_stands() {
    let c = compile(InputFile { name: "small", text: TEXT }, &[]);
    assert!(!c.has_errors(), "{:?}", c.diagnostics);
    let at = TEXT.find("agent").unwrap();
    let new = "agent Human plays person {\n  belief hungry\n\n\n  plan +!go when hungry { asekd(3) }\n  goal !go\n}";
    let again = recheck(&c, at + 40, new).unwrap();
    assert!(again.same_names);
    let [only] = again.diagnostics.as_slice() else { panic!("{:?}", again.diagnostics) };
    let edited = TEXT.replacen(&TEXT[at..TEXT.find("\nrequire").unwrap()], new, 1);
    assert_eq!(&edited[only.span().range()], "asekd");
    assert_eq!(only.span().file, FileId(0));
    assert!(only.help.as_ref().unwrap().contains("asked"), "{only:?}");
}

#[test]
fn places_in_later_declarations_move_along() {
    let c = compile(InputFile { name: "small", text: TEXT }, &[]);
    let at = TEXT.find("event asked").unwrap();
    let new = "event        done from person";
    let again = recheck(&c, at, new).unwrap();
    assert!(!again.same_names);
    let edited = TEXT.replacen("event asked(n: int) from person", new, 1);
    let whole = compile(InputFile { name: "small", text: &edited }, &[]);
    // The whole check says it of the later one of the two.
    let twice = |c: &[hrdsl_source::Diagnostic]| -> BTreeSet<Span> {
        c.iter()
            .filter(|d| d.code == DiagnosticCode::DUPLICATE_NAME)
            .flat_map(|d| d.labels.iter().map(|l| l.span))
            .collect()
    };
    let places = twice(&whole.diagnostics);
    assert_eq!(places.len(), 2);
    assert!(twice(&again.diagnostics).is_subset(&places));
}

#[test]
fn what_is_no_declaration_is_not_checked() {
    let c = compile(InputFile { name: "small", text: TEXT }, &[]);
    let at = TEXT.find("event done").unwrap();
    for text in ["", "// gone", "event a from person event b from person", "scenario other"] {
        assert!(recheck(&c, at, text).is_none(), "{text}");
    }
    assert!(recheck(&c, TEXT.len() + 5, "event a from person").is_none());
    let other = recheck(&c, at, "event finished from robot").unwrap();
    assert!(!other.same_names && other.diagnostics.is_empty(), "{other:?}");
}
