//! What is imported is a scenario without errors.
#![allow(clippy::disallowed_methods, reason = "tests read files")]

use std::{fs, path::Path};

use hrdsl_compiler::{Input, compile};

#[test]
fn expected_texts_compile() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/agentspeak/expected");
    let mut names: Vec<_> = fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    names.retain(|p| p.extension().is_some_and(|e| e == "hri"));
    names.sort();
    assert!(names.len() >= 12);
    let mut errors = Vec::new();
    for path in names {
        let text = fs::read_to_string(&path).unwrap();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let compilation = compile(Input { name: &name, text: &text }, &[]);
        let wrong = compilation.diagnostics.iter().filter(|d| d.is_error());
        errors.extend(
            wrong.map(|d| format!("{}: {} {}", compilation.files.place(d.span()), d.code, d.message)),
        );
    }
    assert!(errors.is_empty(), "{}", errors.join("\n"));
}
