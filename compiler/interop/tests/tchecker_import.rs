//! The import of TChecker's format: what becomes of every construct, and what is wrong with wrong files.

#![allow(clippy::disallowed_methods, reason = "tests read files")]

use std::{fs, path::Path};

use hrdsl_compiler::{InputFile, compile};
use hrdsl_interop::{
    ForeignSource, ImportedScenario, SyntaxError,
    tchecker::{TcheckerOptions, import},
};

fn of(text: &str) -> Result<ImportedScenario, Vec<SyntaxError>> {
    import(
        &ForeignSource { name: "model.txt".to_owned(), text: text.to_owned() },
        &TcheckerOptions::default(),
    )
}

fn fixture(name: &str) -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/tchecker");
    fs::read_to_string(folder.join(name)).unwrap()
}

/// The errors of the scenario.
fn errors(text: &str) -> Vec<String> {
    let compilation = compile(InputFile { name: "model.hri", text }, &[]);
    let wrong = compilation.diagnostics.iter().filter(|d| d.is_error());
    wrong.map(|d| format!("{}: {} {}", compilation.files.place(d.span()), d.code, d.message)).collect()
}

fn shown(imported: &ImportedScenario) -> String {
    let notes: Vec<String> = imported.notes.iter().map(ToString::to_string).collect();
    format!("{}\n----\n{}", imported.text, notes.join("\n"))
}

#[test]
fn a_model_becomes_a_scenario() {
    insta::assert_snapshot!(shown(&of(&fixture("fischer.txt")).unwrap()));
}

#[test]
fn every_construct_is_kept_or_told() {
    insta::assert_snapshot!(shown(&of(&fixture("everything.txt")).unwrap()));
}

#[test]
fn what_is_imported_compiles() {
    for name in ["fischer.txt", "everything.txt"] {
        assert_eq!(errors(&of(&fixture(name)).unwrap().text), Vec::<String>::new(), "{name}");
    }
}

#[test]
fn faults_are_told_with_their_places() {
    let wrong = [
        "",
        "process:P",
        "system:s\nsystem:t",
        "system:s\nprocess:P\nlocation:P:a",
        "system:s\nprocess:P\nlocation:P:a{initial:",
        "system:s\nprocess:P\nlocation:P:a{initial}",
        "system:s\nprocess:P\nlocation:Q:a{initial:}",
        "system:s\nprocess:P\nlocation:P:a{initial: : invariant: x<=3}",
        "system:s\nclock:1:x\nprocess:P\nlocation:P:a{initial: : invariant: x!=3}",
        "system:s\nclock:1:x\nprocess:P\nlocation:P:a{initial: : invariant: x<=}",
        "system:s\nclock:0:x",
        "system:s\nint:1:3:1:2:i",
        "system:s\nint:1:0:1:0",
        "system:s\nevent:e\nprocess:P\nlocation:P:a{initial:}\nedge:P:a:b:e",
        "system:s\nevent:e\nprocess:P\nlocation:P:a{initial:}\nedge:P:a:a:f",
        "system:s\nclock:1:x\nevent:e\nprocess:P\nlocation:P:a{initial:}\nedge:P:a:a:e{do: if 1 then x=0 end}",
        "system:s\nevent:e\nprocess:P\nsync:P@e",
        "system:s\nwhat:e",
        "system:s\nevent:e\nevent:e",
        "# a comment\nsystem:s",
        "system:s\nclock:1:x\nprocess:P\nlocation:P:a{initial: : invariant: x<=99999999999999}",
        "system:s\nclock:1:x\nevent:e\nprocess:P\nlocation:P:a{initial:}\nedge:P:a:a:e{do: x=-1}",
        "system:s\nclock:2:x\nprocess:P\nlocation:P:a{initial: : invariant: x[2]<1}",
    ];
    let told: Vec<String> = wrong
        .iter()
        .map(|text| {
            let errors = of(text).expect_err(text);
            errors
                .iter()
                .map(|e| format!("{}:{}: {}", e.line, e.column, e.message))
                .collect::<Vec<_>>()
                .join("\n")
        })
        .collect();
    insta::assert_snapshot!(told.join("\n"));
}

/// Whatever is cut or changed, there is a scenario or an error, and never a panic.
#[test]
fn broken_files_are_survived() {
    let text = fixture("everything.txt");
    for at in (0..text.len()).filter(|at| text.is_char_boundary(*at)) {
        let _ = of(&text[..at]);
        let mut without = text.clone();
        without.remove(at);
        let _ = of(&without);
        let _ = of(&format!("{}:{}", &text[..at], &text[at..]));
    }
    let deep = format!(
        "system:s\nevent:e\nprocess:P\nlocation:P:a{{initial:}}\nedge:P:a:a:e{{provided: {}1}}",
        "(".repeat(100_000)
    );
    assert!(of(&deep).is_err());
}

/// An edge gets no guard for what its own guard shows.
#[test]
fn a_guard_that_keeps_the_range_is_enough() {
    let edge = |provided: &str, body: &str| {
        let text = format!(
            "system:s\nint:1:0:3:0:n\nevent:e\nprocess:P\nlocation:P:a{{initial:}}\nedge:P:a:a:e{{provided: {provided} : do: {body}}}"
        );
        let text = of(&text).unwrap().text;
        text.lines().find_map(|l| l.trim().strip_prefix("a -> a when ").map(str::to_owned)).unwrap()
    };
    assert_eq!(edge("n<3", "n=n+1"), "n < 3 do n = n + 1 // e");
    assert_eq!(edge("0<n", "n=n-1"), "0 < n do n = n - 1 // e");
    assert_eq!(edge("n<=3", "n=n+1"), "n <= 3 && n + 1 <= 3 do n = n + 1 // e");
    assert_eq!(edge("n<3", "n=n+1; n=n+1"), "n < 3 && n + 1 + 1 <= 3 do n = n + 1; n = n + 1 // e");
}

/// The order of the declarations does not matter, but that the system is the first.
#[test]
fn names_may_be_declared_further_down() {
    let ordered = "system:s\nclock:1:x\nint:1:0:5:0:n\nevent:go\nprocess:P\nprocess:Q\n\
        location:P:a{initial: : invariant: x<=3}\nlocation:P:b{labels: done}\nlocation:Q:c{initial:}\n\
        edge:P:a:b:go{provided: x>=2 && n<3 : do: x=0; n=n+1}\nedge:Q:c:c:go\nsync:P@go:Q@go\n";
    let mut lines: Vec<&str> = ordered.lines().skip(1).collect();
    lines.reverse();
    let declared =
        |word: &str| lines.iter().rev().filter(|l| l.starts_with(word)).copied().collect::<Vec<_>>();
    // Edges and vectors first; of one kind the order counts, since names and numbers follow it.
    let words = ["sync", "edge", "location", "process", "event", "int", "clock"];
    let turned: Vec<&str> = words.iter().flat_map(|word| declared(word)).collect();
    let turned = format!("system:s\n{}\n", turned.join("\n"));
    assert_ne!(ordered, turned);
    assert_eq!(of(&turned).unwrap().text, of(ordered).unwrap().text);
    assert!(of(&turned.replace("system:s\n", "event:e\nsystem:s\n")).is_err());
}
