//! The conformance suite of agents: each section of `spec/agentspeak` is a small program with the log of its run. hrdsl and
//! the reference in Python must both print that log.
//!
//! A block `hri,run` is a scenario; all its agents play, in their order, without chosen beliefs. The block `log` after it is
//! what is printed; of a long log the middle is left out, but it is compared. With `HRDSL_UPDATE=1` the logs are written anew;
//! read them before they are believed.

use std::{collections::BTreeSet, fs, path::Path};

use hrdsl_bdi::CYCLE_LIMIT;
use hrdsl_compiler::{InputFile, compile};
use hrdsl_ir::abstract_test::BeliefSet;

use crate::{
    agents::{Cast, by_the_pages, difference, printed},
    page::{Block, pages, root, shown, split},
};

/// As many programs as there must be.
const ENOUGH: usize = 150;

/// Lines of a log that are shown whole.
const WHOLE: usize = 60;

struct Checked {
    faults: Vec<String>,
    programs: usize,
    page: String,
}

#[test]
fn every_program_has_its_log() {
    let folder = root().join("spec/agentspeak");
    let update = std::env::var_os("HRDSL_UPDATE").is_some();
    let (mut faults, mut programs) = (Vec::new(), 0);
    for path in pages(&folder) {
        let checked = page(&path, update);
        programs += checked.programs;
        faults.extend(checked.faults);
        if update {
            fs::write(&path, checked.page).unwrap();
        }
    }
    assert!(faults.is_empty(), "{} of {programs} programs:\n{}", faults.len(), faults.join("\n\n"));
    assert!(programs >= ENOUGH, "only {programs} programs of {ENOUGH}");
}

fn page(path: &Path, update: bool) -> Checked {
    let text = fs::read_to_string(path).unwrap();
    let blocks = split(&text).0;
    let mut checked = Checked { faults: Vec::new(), programs: 0, page: text.clone() };
    let mut seen = BTreeSet::new();
    for (at, block) in blocks.iter().enumerate().filter(|(_, b)| b.info == "hri,run") {
        let place = format!("{}:{}", shown(path), block.line);
        checked.programs += 1;
        if !seen.insert(block.text.as_str()) {
            checked.faults.push(format!("{place}: the same program twice"));
        }
        let Some(log) = blocks.get(at + 1).filter(|b| b.info == "log") else {
            checked.faults.push(format!("{place}: no block `log` follows"));
            continue;
        };
        match run(block) {
            Ok(ours) if update => {
                let (from, to) = (
                    format!("{}```log\n{}```", head(block), log.text),
                    format!("{}```log\n{ours}```", head(block)),
                );
                checked.page = checked.page.replacen(&from, &to, 1);
            }
            Ok(ours) => {
                checked
                    .faults
                    .extend(difference(&ours, &log.text).map(|d| format!("{place}: not the log\n{d}")));
            }
            Err(fault) => checked.faults.push(format!("{place}: {fault}")),
        }
    }
    checked
}

/// The end of a program, up to its log: what tells its log from an equal one of another program.
fn head(block: &Block) -> String {
    format!("{}```\n\n", block.text)
}

/// The log, if the reference has the same.
fn run(block: &Block) -> Result<String, String> {
    let compilation = compile(InputFile { name: "program.hri", text: &block.text }, &[]);
    let errors = compilation.diagnostics.iter().filter(|d| d.is_error());
    let said: Vec<_> =
        errors.map(|d| format!("{} {}: {}", compilation.files.place(d.span()), d.code, d.message)).collect();
    if !said.is_empty() {
        return Err(said.join("\n"));
    }
    let program = compilation.program.ok_or("no program")?;
    let agents = (0..program.agents.len() as u16).collect();
    let cast: Cast = (agents, BeliefSet::default());
    let ours = printed(&program, &block.text, &cast, CYCLE_LIMIT);
    if block.text.contains(".random(") || block.text.contains(".shuffle(") {
        // The reference has no chance.
        return Ok(shortened(&ours));
    }
    let theirs = by_the_pages(&program, &block.text, &[cast], CYCLE_LIMIT);
    let theirs = theirs.first().map_or("", String::as_str);
    difference(&ours, theirs)
        .map_or_else(|| Ok(shortened(&ours)), |d| Err(format!("the reference differs\n{d}")))
}

/// A log without the middle, if it is long: of a livelock.
fn shortened(log: &str) -> String {
    let lines: Vec<&str> = log.lines().collect();
    if lines.len() <= WHOLE {
        return log.to_owned();
    }
    let (first, last) = (&lines[..10], &lines[lines.len() - 4..]);
    let left_out = format!("… {} lines", lines.len() - first.len() - last.len());
    [first, &[left_out.as_str()], last].concat().iter().flat_map(|line| [line, "\n"]).collect()
}
