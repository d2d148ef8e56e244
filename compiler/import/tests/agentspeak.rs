//! Jason programs to scenarios: each program of `tests/agentspeak` against its expected text and report.
//!
//! `HRDSL_RENEW=1 cargo test -p hrdsl-import` writes the expected files anew; the difference is read.
#![allow(clippy::disallowed_methods, reason = "tests read files")]

use std::{
    fs,
    path::{Path, PathBuf},
};

use hrdsl_import::{
    Imported, Loader, NoFiles, Severity, Source, SyntaxError,
    agentspeak::{Options, import},
};
use hrdsl_source::FileId;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/agentspeak")
}

/// The files of the folder of programs.
struct Disk;

impl Loader for Disk {
    fn load(&self, from: &str, path: &str) -> Result<Source, String> {
        let folder = Path::new(from).parent().unwrap();
        let name = folder.join(path).display().to_string();
        let text = fs::read_to_string(root().join(&name)).map_err(|_| format!("there is no file {name}"))?;
        Ok(Source { name, text })
    }
}

fn from_files(names: &[&str]) -> Result<Imported, Vec<SyntaxError>> {
    let source =
        |n: &&str| Source { name: (*n).to_owned(), text: fs::read_to_string(root().join(n)).unwrap() };
    let files: Vec<Source> = names.iter().map(source).collect();
    import(&files, &Disk, &Options::default())
}

fn from_text(text: &str) -> Imported {
    let files = [Source { name: "bob.asl".to_owned(), text: text.to_owned() }];
    import(&files, &NoFiles, &Options::default()).unwrap_or_else(|e| panic!("{e:?}"))
}

fn report(result: &Result<Imported, Vec<SyntaxError>>) -> String {
    match result {
        Ok(imported) => imported.notes.iter().map(|n| format!("{n}\n")).collect(),
        Err(errors) => errors.iter().map(|e| format!("{e}\n")).collect(),
    }
}

/// The text can be read, and is in the style of the language.
fn is_readable(text: &str, name: &str) {
    let (_, diagnostics) = hrdsl_syntax::parse(FileId(0), text);
    let said: Vec<String> =
        diagnostics.iter().map(|d| format!("{} at {}", d.message, d.span().start)).collect();
    assert_eq!(said, Vec::<String>::new(), "{name}:\n{text}");
    assert_eq!(hrdsl_syntax::format(text).unwrap(), text, "{name} is formatted");
}

fn compare(file: &str, text: &str) {
    let path = root().join("expected").join(file);
    if std::env::var_os("HRDSL_RENEW").is_some() {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, text).unwrap();
    }
    let expected = fs::read_to_string(&path).unwrap_or_default();
    assert_eq!(text, expected, "{file}");
}

const PROGRAMS: &[&[&str]] = &[
    &["domestic/domestic.mas2j"],
    &["contract_net/cnp.mas2j"],
    &["counter.asl"],
    &["quirks.asl"],
    &["words.asl"],
    &["include.asl"],
    &["ask.asl"],
    &["lists.asl"],
    &["control.asl"],
    &["domestic/src/owner.asl"],
    &["contract_net/p.asl", "contract_net/c.asl", "contract_net/pr.asl"],
    &["contract_net/pr.asl"],
];

#[test]
fn programs_become_scenarios() {
    for files in PROGRAMS {
        let name = files[0].replace('/', "_");
        let result = from_files(files);
        compare(&format!("{name}.txt"), &report(&result));
        let imported = result.unwrap_or_else(|e| panic!("{name}: {e:?}"));
        is_readable(&imported.text, &name);
        compare(&format!("{name}.hri"), &imported.text);
        let comments = imported.text.matches("// not carried over: ").count();
        let left_out = imported.notes.iter().filter(|n| n.severity == Severity::LeftOut).count();
        assert!(comments >= left_out, "{name}: {left_out} are left out, and {comments} comments say so");
    }
}

#[test]
fn what_cannot_be_read_is_said() {
    for file in ["broken.asl", "crew/crew.mas2j"] {
        let result = from_files(&[file]);
        assert!(result.is_err(), "{file}");
        compare(&format!("{}.txt", file.replace('/', "_")), &report(&result));
    }
}
