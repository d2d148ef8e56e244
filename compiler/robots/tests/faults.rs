//! The cases in `faults/`: files that say in comments what is wrong with them, each at its place.

mod common;

use std::{collections::BTreeSet, path::Path};

use common::FilesInMemory;
use hrdsl_robots::{PackageTable, RobotFault, RobotRequest, read_map, read_robot};
use hrdsl_source::{SourceFiles, Span};

struct FaultCase {
    name: String,
    /// In the order of the text; the first is read.
    files: Vec<(String, String)>,
}

#[derive(Debug)]
struct ExpectedFault {
    line: u32,
    is_error: bool,
    kind: String,
    text: String,
    help: String,
}

/// `## NAME`, then blocks whose first line ends in the name of a file.
fn cases(page: &str) -> Vec<FaultCase> {
    let mut cases: Vec<FaultCase> = Vec::new();
    let mut inside: Option<(String, String)> = None;
    for line in page.lines() {
        match (&mut inside, line.strip_prefix("```")) {
            (Some(_), Some(_)) => cases.last_mut().unwrap().files.extend(inside.take()),
            (Some((_, text)), None) => *text += &format!("{line}\n"),
            (None, Some(head)) => {
                let name = head.split_once(' ').unwrap_or_else(|| panic!("a block without a file: {head}")).1;
                inside = Some((name.to_owned(), String::new()));
            }
            (None, None) => {
                if let Some(name) = line.strip_prefix("## ") {
                    cases.push(FaultCase { name: name.to_owned(), files: Vec::new() });
                }
            }
        }
    }
    cases
}

fn quoted(text: &str) -> Option<(&str, &str)> {
    text.trim_start().strip_prefix('"')?.split_once('"')
}

fn expectations(text: &str) -> Vec<ExpectedFault> {
    let mut all = Vec::new();
    for (line, text) in (1..).zip(text.lines()) {
        let text = text.replace("<!--~", "#~");
        for note in text.split("#~").skip(1) {
            let Some((words, at)) = note.trim_start().split_once(" \"") else { continue };
            let at = format!("\"{at}");
            let (is_error, kind) = match words.strip_prefix("warning ") {
                Some(kind) => (false, kind),
                None => (true, words),
            };
            let (wanted, rest) = quoted(&at).unwrap_or_else(|| panic!("line {line}: no text after {kind}"));
            let help = rest.trim_start().strip_prefix("help").and_then(quoted).map_or("", |q| q.0);
            let line = if text.trim_start().starts_with("#~") { line + 1 } else { line };
            let (kind, text) = (kind.to_owned(), wanted.to_owned());
            all.push(ExpectedFault { line, is_error, kind, text, help: help.replace('`', "\"") });
        }
    }
    all
}

fn said(case: &FaultCase, files: &mut SourceFiles) -> Vec<RobotFault> {
    let mut reader = FilesInMemory::default();
    for (name, text) in &case.files {
        reader = reader.with(&format!("w/{name}"), text.as_bytes());
    }
    let place = Span::new(files.add("scenario", ""), 0, 0);
    let path = format!("w/{}", case.files[0].0);
    if path.ends_with(".yaml") {
        return read_map(&path, place, files, &reader).err().into_iter().collect();
    }
    let packages = PackageTable::new().with("arm", "somewhere/arm");
    let semantics = case.files.iter().any(|(name, _)| name == "r.srdf").then_some(("w/r.srdf", place.into()));
    let request = RobotRequest { semantics, ..RobotRequest::new(&path, place, &packages) };
    read_robot(&request, files, &reader).faults
}

/// What is wrong between what was expected and what was said.
fn differences(case: &FaultCase, kinds: &mut BTreeSet<&str>) -> Vec<String> {
    let mut files = SourceFiles::default();
    let said = said(case, &mut files);
    let mut expected: Vec<(String, ExpectedFault)> = case
        .files
        .iter()
        .flat_map(|(name, text)| expectations(text).into_iter().map(move |e| (format!("w/{name}"), e)))
        .collect();
    let mut differences = Vec::new();
    for fault in said {
        kinds.insert(fault.kind.word());
        let (span, help) = (fault.place.span, fault.help.replace('`', "\""));
        let (line, text) = (files.position(span).line, files.text(span));
        let file = files.get(span.file).map(|file| file.name.as_str()).unwrap_or_default();
        let met = |(name, e): &(String, ExpectedFault)| {
            let same = (name.as_str(), e.line, e.is_error, e.kind.as_str(), e.text.as_str());
            same == (file, line, fault.is_error(), fault.kind.word(), text) && help.contains(&e.help)
        };
        match expected.iter().position(met) {
            Some(at) => drop(expected.remove(at)),
            None => differences.push(format!(
                "{}: not expected: {} {} \"{text}\": {} (help: {})",
                case.name,
                files.place(span),
                fault.kind.word(),
                fault.kind,
                fault.help
            )),
        }
    }
    differences.extend(expected.iter().map(|e| format!("{}: not said: {e:?}", case.name)));
    differences
}

#[test]
fn every_case_gives_what_it_says() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/faults");
    let mut all = Vec::new();
    let mut kinds = BTreeSet::new();
    for page in ["urdf.md", "xacro.md", "map.md"] {
        let bytes = hrdsl_robots::RobotReader::bytes(&common::RobotFolder(&folder), page).unwrap();
        let cases = cases(&String::from_utf8(bytes).unwrap());
        assert!(cases.len() > 7, "{page}: only {} cases: are they found?", cases.len());
        all.extend(cases.iter().flat_map(|case| differences(case, &mut kinds)));
    }
    assert!(all.is_empty(), "{} differences:\n{}", all.len(), all.join("\n"));
    // Those of packages are in another test.
    let elsewhere = ["duplicate-package", "malformed-manifest"];
    let never: Vec<&str> =
        words().into_iter().filter(|w| !kinds.contains(w) && !elsewhere.contains(w)).collect();
    assert!(never.is_empty(), "no case gives {never:?}");
}

/// The words of all kinds, as the source has them: a new kind needs a case.
fn words() -> Vec<&'static str> {
    let source = include_str!("../src/fault.rs");
    let word = |line: &'static str| Some(line.split_once("=> \"")?.1.split_once('"')?.0);
    source.lines().filter_map(word).collect()
}
