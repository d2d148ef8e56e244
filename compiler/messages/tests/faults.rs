//! The workspaces in `faults/`: definitions that say in comments what is wrong with them, each at its place.
//!
//! `#~ unknown-type "Poze" help "Pose"` on a line means: a fault of this kind, at exactly this text of the line, whose help contains
//! that text; `help` may be absent. A line that is nothing but such a comment speaks of the next line that is not; quotes in the
//! text are written as backquotes. Several follow each other, each after its own `#~`. Every fault must be expected, and every
//! expectation met. In `package.xml` it is `<!--~ … -->`, of its line.

mod common;

use std::{collections::BTreeSet, path::Path};

use common::{FolderOnDisk, with_standard};
use hrdsl_messages::{MessageFault, RosVersion};
use hrdsl_source::{FileId, SourceFiles, Span};

#[derive(Clone, Debug, PartialEq)]
struct ExpectedFault {
    file: FileId,
    line: u32,
    kind: String,
    text: String,
    help: String,
}

fn quoted(text: &str) -> Option<(String, &str)> {
    let (inner, rest) = text.trim_start().strip_prefix('"')?.split_once('"')?;
    Some((inner.replace('`', "\""), rest))
}

fn expectations(file: FileId, text: &str) -> Vec<ExpectedFault> {
    let mut all = Vec::new();
    let mut of_next: Vec<ExpectedFault> = Vec::new();
    for (line, text) in (1..).zip(text.lines()) {
        let mut here = std::mem::take(&mut of_next);
        let text = text.replace("<!--~", "#~");
        for note in text.split("#~").skip(1) {
            let (kind, rest) = note.trim_start().split_once(' ').unwrap_or((note.trim(), ""));
            let (at, rest) = quoted(rest).unwrap_or_else(|| panic!("line {line}: no text after {kind}"));
            let help = rest.trim_start().strip_prefix("help").and_then(quoted).map_or(String::new(), |q| q.0);
            here.push(ExpectedFault { file, line, kind: kind.to_owned(), text: at, help });
        }
        here.iter_mut().for_each(|expected| expected.line = line);
        if text.starts_with("#~") { of_next = here } else { all.extend(here) }
    }
    all.extend(of_next);
    all
}

/// What is wrong between what was expected and what was said.
fn differences(files: &SourceFiles, said: &[MessageFault], kinds: &mut BTreeSet<&str>) -> Vec<String> {
    let mut expected: Vec<ExpectedFault> =
        files.iter().flat_map(|(id, file)| expectations(id, &file.text)).collect();
    let mut differences = Vec::new();
    for fault in said {
        kinds.insert(fault.kind.word());
        let (line, text) = (files.position(fault.span).line, files.text(fault.span));
        let met = |e: &ExpectedFault| {
            (e.file, e.line, &*e.kind, &*e.text) == (fault.span.file, line, fault.kind.word(), text)
                && fault.help.contains(&e.help)
        };
        match expected.iter().position(met) {
            Some(at) => drop(expected.remove(at)),
            None => differences.push(format!(
                "not expected: {} {} \"{text}\": {} (help: {})",
                files.place(fault.span),
                fault.kind.word(),
                fault.kind,
                fault.help
            )),
        }
    }
    let missing = expected.iter().map(|e| format!("not said: {}: {e:?}", files.get(e.file).unwrap().name));
    differences.extend(missing);
    differences
}

#[test]
fn every_definition_gives_what_it_says() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/faults");
    let mut all = Vec::new();
    let mut kinds = BTreeSet::new();
    for (version, path) in [(RosVersion::Ros1, "ros1"), (RosVersion::Ros2, "ros2")] {
        let mut files = SourceFiles::default();
        let place = Span::new(files.add("scenario", ""), 0, 0);
        let builder = with_standard(version, &mut files);
        let library = builder.workspace(&FolderOnDisk(&folder), path, place).finish();
        let mut said = library.faults().to_vec();
        said.extend(library.messages().flat_map(|(_, message)| message.faults.iter().cloned()));
        let found = differences(&files, &said, &mut kinds);
        assert!(said.len() > 20, "{version}: only {} faults: are the fixtures found?", said.len());
        all.extend(found);
    }
    assert!(all.is_empty(), "{} differences:\n{}", all.len(), all.join("\n"));
    // Those without a line in a file of a workspace are in the other tests.
    let elsewhere = ["empty-workspace", "misplaced-text", "too-much", "unreadable"];
    let known = MessageFaultKindWords::all();
    let never: Vec<&&str> = known.iter().filter(|w| !kinds.contains(**w) && !elsewhere.contains(w)).collect();
    assert!(never.is_empty(), "no fixture gives {never:?}");
}

/// The words of all kinds, as the source has them: a new kind needs a fixture.
struct MessageFaultKindWords;

impl MessageFaultKindWords {
    fn all() -> Vec<&'static str> {
        let source = include_str!("../src/fault.rs");
        source
            .lines()
            .filter_map(|l| l.split_once("=> \"")?.1.split_once('"'))
            .map(|(word, _)| word)
            .collect()
    }
}
