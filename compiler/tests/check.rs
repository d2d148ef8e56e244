//! The fixtures in `check/`: scenarios with the diagnostics they must give, each named at its place.
//!
//! `//~ HR0101 "leg_requst" help "leg_request"` on a line means: an error with this code, at exactly this text of the line,
//! whose help contains that text (quotes in the text are written as backquotes); `help` may be absent. Several expectations follow each other, each after its own `//~`.
//! `in "Ann"` after that: it is said with the instance `Ann` of a template.
//! Every diagnostic must be expected, and every expectation met. In `NAME.tests.hri` are tests for `NAME.hri`; in folders
//! are modules that fixtures use.

#![allow(clippy::disallowed_methods, reason = "the runner reads its fixtures")]

use std::{collections::BTreeMap, fs, path::Path};

use hrdsl_compiler::{CompilationResult, InputFile, ModuleLoader, ModuleText, compile, compile_with};
use hrdsl_source::SuggestedFix;

#[derive(Clone, Debug, PartialEq)]
struct Expected {
    file: u16,
    line: u32,
    code: String,
    text: String,
    help: String,
    /// The instance of a template that it is said with.
    instance: String,
}

/// The files beside the fixtures.
struct Beside<'a>(&'a Path);

impl ModuleLoader for Beside<'_> {
    fn load(&self, from: &str, path: &str) -> Result<ModuleText, String> {
        let folder = Path::new(from).parent().unwrap_or(Path::new(""));
        let name = folder.join(path);
        let text = fs::read_to_string(self.0.join(&name)).map_err(|_| "there is no such file".to_owned())?;
        Ok(ModuleText { name: name.to_string_lossy().into_owned(), text })
    }
}

fn quoted(text: &str) -> Option<(String, &str)> {
    let (inner, rest) = text.trim_start().strip_prefix('"')?.split_once('"')?;
    Some((inner.to_owned(), rest))
}

fn expectations(file: u16, text: &str) -> Vec<Expected> {
    let mut all = Vec::new();
    for (line, text) in (1..).zip(text.lines()) {
        for note in text.split("//~").skip(1) {
            let (code, rest) = note.trim_start().split_once(' ').unwrap_or((note.trim(), ""));
            let (at, rest) = quoted(rest).unwrap_or_else(|| panic!("line {line}: no text after {code}"));
            let (help, rest) =
                rest.trim_start().strip_prefix("help").and_then(quoted).unwrap_or((String::new(), rest));
            let instance =
                rest.trim_start().strip_prefix("in").and_then(quoted).map_or(String::new(), |q| q.0);
            all.push(Expected { file, line, code: code.to_owned(), text: at, help, instance });
        }
    }
    all
}

/// What is wrong between what was expected and what was said.
fn faults(c: &CompilationResult, mut expected: Vec<Expected>) -> Vec<String> {
    let mut faults = Vec::new();
    for d in &c.diagnostics {
        let (line, text) = (c.files.position(d.span()).line, c.files.text(d.span()));
        let help = d.help.as_deref().unwrap_or("");
        let met = |e: &Expected| {
            (e.file, e.line, e.code.as_str()) == (d.span().file.0, line, d.code.to_string().as_str())
                && e.text == text.split_whitespace().collect::<Vec<_>>().join(" ").replace('"', "`")
                && help.contains(&e.help)
                && (e.instance.is_empty()
                    || d.labels.iter().any(|l| l.text == format!("in the instance `{}`", e.instance)))
        };
        match expected.iter().position(met) {
            Some(at) => drop(expected.remove(at)),
            None => faults.push(format!(
                "not expected: {} {} \"{text}\": {} (help: {help})",
                c.files.place(d.span()),
                d.code,
                d.message
            )),
        }
    }
    faults.extend(expected.iter().map(|e| format!("expected, but not said: {e:?}")));
    faults
}

/// The fixtures in a folder and those below it, by path.
fn fixtures(folder: &Path, all: &mut BTreeMap<String, String>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            fixtures(&path, all);
        } else {
            all.insert(path.to_string_lossy().into_owned(), fs::read_to_string(&path).unwrap());
        }
    }
}

/// In `lint/` are scenarios in which each lint's diagnostic must be expected just as an error is.
#[test]
fn every_lint_says_what_it_should_and_nothing_else() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/lint");
    let mut all = BTreeMap::new();
    fixtures(&folder, &mut all);
    let mut wrong = Vec::new();
    for (path, text) in &all {
        let name = path.trim_start_matches(&*folder.to_string_lossy());
        let c = compile(InputFile { name, text }, &[]);
        wrong.extend(faults(&c, expectations(0, text)));
    }
    assert!(all.len() >= 8, "the fixtures are not found");
    assert!(wrong.is_empty(), "{} faults:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn every_fixture_gives_what_it_says() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/check");
    let mut fixtures: BTreeMap<String, String> = BTreeMap::new();
    for entry in fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            continue;
        }
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        fixtures.insert(name, fs::read_to_string(path).unwrap());
    }
    let mut all = Vec::new();
    for (name, text) in fixtures.iter().filter(|(n, _)| !n.ends_with(".tests.hri")) {
        let tests_name = name.replace(".hri", ".tests.hri");
        let tests: Vec<InputFile<'_>> =
            fixtures.get(&tests_name).map(|text| InputFile { name: &tests_name, text }).into_iter().collect();
        let c = compile_with(InputFile { name, text }, &tests, &Beside(&folder));
        let expected = c.files.iter().flat_map(|(id, file)| expectations(id.0, &file.text)).collect();
        all.extend(faults(&c, expected));
        // What the checker could not make sense of has a diagnostic.
        if !c.has_errors() && format!("{:?}", c.scenario).contains("kind: Error") {
            all.push(format!("{name}: something is wrong, and nothing is said"));
        }
        let errors = c.diagnostics.iter().any(hrdsl_source::Diagnostic::is_error);
        assert_eq!(
            c.program.is_none(),
            errors,
            "{name}: there is a program if and only if there are no errors"
        );
        assert!(c.diagnostics.is_sorted_by_key(|d| d.span()), "{name}: not in the order of the text");
    }
    assert!(fixtures.len() >= 10, "the fixtures are not found");
    assert!(all.is_empty(), "{} faults:\n{}", all.len(), all.join("\n"));
}

/// The text with a change made.
fn changed(text: &str, fix: &SuggestedFix) -> String {
    let mut text = text.to_owned();
    for edit in fix.edits.iter().rev() {
        text.replace_range(edit.span.range(), &edit.text);
    }
    text
}

/// A change that may be made unasked leaves no trace of what it fixes, and breaks nothing.
#[test]
fn certain_fixes_mend() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/lint");
    let mut all = BTreeMap::new();
    fixtures(&folder, &mut all);
    let mut tried = 0;
    for (name, text) in all.iter().filter(|(n, _)| !n.ends_with(".tests.hri")) {
        let compiled = |text: &str| compile(InputFile { name, text }, &[]);
        let before = compiled(text);
        let errors = |c: &CompilationResult| c.diagnostics.iter().filter(|d| d.is_error()).count();
        for d in &before.diagnostics {
            for fix in d.fixes.iter().filter(|f| f.certain) {
                let after = compiled(&changed(text, fix));
                let said =
                    |c: &CompilationResult| c.diagnostics.iter().filter(|e| e.message == d.message).count();
                let place = before.files.place(d.span());
                assert!(errors(&after) <= errors(&before), "{place}: `{}` breaks the text", fix.title);
                assert!(said(&after) < said(&before), "{place}: `{}` does not fix it", fix.title);
                tried += 1;
            }
        }
    }
    assert!(tried >= 8, "only {tried} fixes were found");
}
