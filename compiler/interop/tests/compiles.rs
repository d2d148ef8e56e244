//! What is imported is a scenario without errors.
#![allow(clippy::disallowed_methods, reason = "tests read files")]

use std::{fs, path::Path};

use hrdsl_compiler::{InputFile, compile};
use hrdsl_interop::{
    ForeignSource, NoForeignFiles,
    agentspeak::{AgentSpeakOptions, import},
};

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
        let compilation = compile(InputFile { name: &name, text: &text }, &[]);
        let wrong = compilation.diagnostics.iter().filter(|d| d.is_error());
        errors.extend(
            wrong.map(|d| format!("{}: {} {}", compilation.files.place(d.span()), d.code, d.message)),
        );
    }
    assert!(errors.is_empty(), "{}", errors.join("\n"));
}

/// Whatever is cut out of a program: what is still a program becomes a scenario without errors.
#[test]
fn what_is_left_of_programs_compiles() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/agentspeak");
    let programs =
        ["counter", "quirks", "words", "ask", "lists", "control", "domestic/src/robot", "contract_net/c"];
    let (mut errors, mut compiled) = (Vec::new(), 0);
    for name in programs {
        let text = fs::read_to_string(root.join(format!("{name}.asl"))).unwrap();
        let places: Vec<usize> = text.char_indices().map(|(i, _)| i).collect();
        for (n, start) in places.iter().enumerate().step_by(41) {
            for length in [1, 8, 40] {
                let end = places.get(n + length).copied().unwrap_or(text.len());
                let text = format!("{}{}", &text[..*start], &text[end..]);
                let files = [ForeignSource { name: "bob.asl".to_owned(), text }];
                let Ok(imported) = import(&files, &NoForeignFiles, &AgentSpeakOptions::default()) else {
                    continue;
                };
                let compilation = compile(InputFile { name, text: &imported.text }, &[]);
                compiled += 1;
                let wrong = compilation.diagnostics.iter().filter(|d| d.is_error());
                errors.extend(wrong.map(|d| {
                    format!(
                        "{}: {} {}\n{}",
                        compilation.files.place(d.span()),
                        d.code,
                        d.message,
                        imported.text
                    )
                }));
            }
        }
    }
    assert!(errors.is_empty(), "{}", errors.join("\n"));
    assert!(compiled > 100, "{compiled}");
}
