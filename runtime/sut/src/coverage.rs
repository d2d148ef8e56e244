//! Code coverage, and which lines ran when, as the runner writes them.

use std::{
    collections::BTreeMap,
    fs::File,
    io::{Read, Seek},
};

use hrdsl_ir::Nanos;
use hrdsl_results::FileCoverage;
use serde::Deserialize;

/// What the runner writes is much shorter; the program, which has the file open, too, may have made it as long as it likes.
const LONGEST: u64 = 64 << 20;

/// At which lines of the covered files a program was, by simulated time, as its runner tells (`spec/protocol.md`).
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
pub struct ProgramLines {
    /// The files, by the names of their coverage.
    pub files: Vec<ExecutedFile>,
    pub threads: Vec<ThreadLines>,
    /// Since when nobody looked any more, as there were too many lines.
    #[serde(default)]
    pub until: Option<Nanos>,
    /// How many threads nobody looked at, as there were too many.
    #[serde(default)]
    pub unseen: u64,
}

/// A file of the program's code.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
pub struct ExecutedFile {
    pub name: String,
    /// The CRC-32 of its bytes; none if it could not be read.
    #[serde(default)]
    pub crc: Option<u32>,
}

/// At which lines a thread was: columns of the same length, each with its first value, and then what each differs from the one before.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
pub struct ThreadLines {
    pub name: String,
    /// Nanoseconds.
    pub t: Vec<i64>,
    /// Places among the files.
    pub file: Vec<i64>,
    /// From 1; 0 while it is in none of the files.
    pub line: Vec<i64>,
}

/// What the runner of a program has measured.
#[derive(Debug, Default)]
pub(crate) struct MeasuredCode {
    pub coverage: Vec<FileCoverage>,
    pub lines: Option<ProgramLines>,
}

/// Reads what the runner wrote, in the order of `files`; `None` if it wrote nothing or was cut short.
pub(crate) fn read(mut written: File, files: &[String]) -> Option<MeasuredCode> {
    let mut text = Vec::new();
    if written.metadata().ok()?.len() > LONGEST {
        return None;
    }
    written.rewind().ok()?;
    written.take(LONGEST).read_to_end(&mut text).ok()?;
    let end = text.iter().position(|byte| *byte == b'\n').unwrap_or(text.len());
    let (coverage, lines) = text.split_at(end);
    let mut found: BTreeMap<String, FileCoverage> = serde_json::from_slice(coverage).ok()?;
    let known = |file: &String| found.remove(file).map(|c| FileCoverage { file: file.clone(), ..c });
    let coverage = files.iter().filter_map(known).collect();
    Some(MeasuredCode { coverage, lines: serde_json::from_slice(lines).ok() })
}
