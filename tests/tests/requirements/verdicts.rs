//! The runs on the pages, with the verdicts that stand beside them.

use std::{collections::BTreeMap, fs, path::Path};

use hrdsl_ir::{EventId, Nanos, Value, value::SECOND, world::SignalId};
use hrdsl_trace::{Trace, TraceStep, TraceStepKind};

use crate::{program, verdicts_of};

/// A row of a table: the requirement, the run, the verdict.
type Row = (String, String, String);

/// The rows of the page's tables of verdicts. A requirement that is left out is that of the row before.
fn rows(page: &str) -> Vec<Row> {
    let (mut rows, mut inside, mut last): (Vec<Row>, bool, String) = (Vec::new(), false, String::new());
    for line in page.lines() {
        let cells: Vec<&str> =
            line.trim().trim_matches('|').split('|').map(|cell| cell.trim().trim_matches('`')).collect();
        match cells.as_slice() {
            ["requirement", "run", "verdict"] => inside = true,
            ["---", ..] => {}
            [requirement, run, verdict] if inside => {
                if !requirement.is_empty() {
                    last = (*requirement).to_owned();
                }
                rows.push((last.clone(), (*run).to_owned(), (*verdict).to_owned()));
            }
            _ => inside = false,
        }
    }
    rows
}

/// `1 a, 2 not p, 3`
fn run(text: &str) -> Trace {
    let mut trace = Trace::default();
    for part in text.split(", ") {
        let mut words = part.split(' ');
        let time: f64 = words.next().and_then(|t| t.parse().ok()).unwrap_or_else(|| panic!("{text}"));
        let time = (time * SECOND as f64).round() as Nanos;
        trace.end = time;
        let Some(word) = words.next() else { continue };
        let (holds, name) = if word == "not" { (false, words.next().unwrap()) } else { (true, word) };
        let event = ["a", "b", "c", "d"].iter().position(|e| *e == name);
        let what = match (event, ["p", "q"].iter().position(|s| *s == name)) {
            (Some(event), _) => TraceStepKind::Event { event: EventId(event as u16), args: Vec::new() },
            (None, Some(signal)) => {
                TraceStepKind::Sample { signal: SignalId(signal as u16), value: Value::Bool(holds) }
            }
            (None, None) => panic!("`{name}` is nothing: {text}"),
        };
        trace.steps.push(TraceStep { time, what });
    }
    trace
}

#[test]
fn the_runs_on_the_pages_have_their_verdicts() {
    let spec = Path::new(env!("CARGO_MANIFEST_DIR")).join("../spec");
    let mut all: Vec<Row> = Vec::new();
    for page in ["requirements.md", "scopes.md"] {
        let found = rows(&fs::read_to_string(spec.join(page)).unwrap());
        assert!(found.len() > 30, "{page} has {} runs", found.len());
        all.extend(found);
    }
    let mut numbers: BTreeMap<&str, usize> = BTreeMap::new();
    let mut texts = Vec::new();
    for (requirement, ..) in &all {
        numbers.entry(requirement).or_insert_with(|| {
            texts.push(format!("require R{} safety {requirement}", texts.len()));
            texts.len() - 1
        });
    }
    let program = program(&texts.join("\n"));
    for (requirement, text, verdict) in &all {
        let verdicts = verdicts_of(&program, &run(text));
        assert_eq!(
            &verdicts[numbers[requirement.as_str()]].outcome.to_string(),
            verdict,
            "{requirement}: {text}"
        );
    }
}
