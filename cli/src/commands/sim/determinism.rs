//! `--check-determinism` and `--repeat`: further runs of the same tests, compared with the first byte by byte.

use std::{
    collections::BTreeMap,
    fmt::Write as _,
    path::Path,
    sync::{Mutex, PoisonError},
};

use hrdsl_ir::test::Test;
use hrdsl_runtime::{
    campaign::{CampaignRun, CampaignSetup},
    judge::CampaignOutcome,
    results::TestResult,
};

use super::run::{output_text, recording};
use crate::{commands::campaign::progress_bar, fault::CommandFault, files};

/// Differences that are listed, at most.
const LISTED: usize = 20;

/// What further runs made different.
pub struct RunDifferences {
    /// How many tests differ.
    pub tests: usize,
    /// For people.
    pub text: String,
}

/// For each test that differs, by its place among the tests: its name, the run (from 2) and the first difference.
type FoundDifferences = BTreeMap<usize, (String, u32, String)>;

/// Runs the tests until each has run so many times, every other time in the opposite order, and compares their recordings, output and
/// results with those of the first run, whose files are below a folder.
pub fn compare(
    campaign: &CampaignSetup<'_>,
    tests: &[Test],
    outcome: &CampaignOutcome,
    first: &Path,
    runs: u32,
) -> Result<RunDifferences, CommandFault> {
    let known: BTreeMap<String, String> =
        outcome.tests.iter().map(|test| (test.result.name.to_string(), result_text(&test.result))).collect();
    let backwards: Vec<Test> = tests.iter().rev().cloned().collect();
    let bar = progress_bar(tests.len() * (runs as usize).saturating_sub(1), "tests");
    bar.set_message("again, to compare");
    let found: Mutex<FoundDifferences> = Mutex::default();
    // Further runs keep no files: those of the first are the results.
    let again = CampaignSetup { keep: None, clocks: None, replays: false, ..campaign.clone() };
    let mut ran = 1;
    let mut interrupted = None;
    for run in 2..=runs {
        let is_backwards = run % 2 == 0;
        let CampaignRun { outcome, .. } =
            again.run(if is_backwards { &backwards } else { tests }, |done| {
                let stem = done.result.name.file_stem();
                let name = done.result.name.to_string();
                let before = files::read_whole(&recording(first, &stem))?;
                let output =
                    files::read_whole(&first.join("output").join(format!("{stem}.txt"))).unwrap_or_default();
                let difference = difference(&before, done.recording)
                    .or_else(|| output_difference(&output, &output_text(done.output)))
                    .or_else(|| result_difference(known.get(&name)?, &result_text(done.result)));
                if let Some(difference) = difference {
                    let at = if is_backwards { tests.len() - done.index } else { done.index };
                    let mut found = found.lock().unwrap_or_else(PoisonError::into_inner);
                    found.entry(at).or_insert((name, run, difference));
                }
                bar.inc(1);
                Ok(())
            })?;
        if outcome.interrupted {
            interrupted = Some((run, outcome.tests.len()));
            break;
        }
        ran = run;
    }
    bar.finish_and_clear();
    let found = found.into_inner().unwrap_or_else(PoisonError::into_inner);
    Ok(RunDifferences { tests: found.len(), text: text(&found, tests.len(), ran, interrupted) })
}

/// `interrupted`: the run that was, and how many tests it had done.
fn text(found: &FoundDifferences, tests: usize, ran: u32, interrupted: Option<(u32, usize)>) -> String {
    let mut text = String::new();
    if let Some((run, done)) = interrupted {
        let _ = writeln!(text, "determinism: run {run} was interrupted after {done} tests");
    }
    let count = found.len();
    if count > 0 {
        let _ = writeln!(text, "determinism: {count} of {tests} tests differ between two runs");
    } else if ran > 1 {
        let times = if ran == 2 { "twice".to_owned() } else { format!("{ran} times") };
        let _ = writeln!(text, "determinism: {tests} tests ran {times}, byte for byte the same");
    }
    for (name, run, difference) in found.values().take(LISTED) {
        let _ = writeln!(text, "  {name}, run {run}: {difference}");
    }
    if count > LISTED {
        let _ = writeln!(text, "  and {} more", count - LISTED);
    }
    if count > 0 {
        text.push_str("  (spec/randomness.md lists what is repeatable and what is not)\n");
    }
    text
}

/// All that the results say of a test.
fn result_text(result: &TestResult) -> String {
    serde_json::to_string_pretty(result).unwrap_or_default()
}

fn output_difference(first: &str, second: &str) -> Option<String> {
    line_difference(first, second).map(|(line, a, b)| format!("output, line {line}: {a}; then: {b}"))
}

fn result_difference(first: &str, second: &str) -> Option<String> {
    let (_, a, b) = line_difference(first, second)?;
    Some(format!("results: first {}; then {}", a.trim(), b.trim()))
}

/// The first event in which two recordings differ.
fn difference(first: &str, second: &str) -> Option<String> {
    let (line, a, b) = line_difference(first, second)?;
    // The first line is the header.
    let what = if line > 1 { format!("step {}", line - 2) } else { "header".to_owned() };
    Some(format!("{what}: first {a}; then {b}"))
}

/// The number of the first line that differs, from 1, and both lines.
fn line_difference<'t>(first: &'t str, second: &'t str) -> Option<(usize, &'t str, &'t str)> {
    if first == second {
        return None;
    }
    let (mut a, mut b) = (first.lines(), second.lines());
    for line in 1.. {
        match (a.next(), b.next()) {
            (None, None) => return None,
            (x, y) if x != y => return Some((line, x.unwrap_or("nothing"), y.unwrap_or("nothing"))),
            _ => {}
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::difference;

    #[test]
    fn the_first_event_that_differs_is_named() {
        let (a, b) = ("{}\n{\"t\":1}\n{\"end\":2}\n", "{}\n{\"t\":2}\n{\"end\":2}\n");
        assert_eq!(difference(a, a), None);
        assert_eq!(difference(a, b).unwrap(), "step 0: first {\"t\":1}; then {\"t\":2}");
        assert_eq!(difference(a, "{}\n").unwrap(), "step 0: first {\"t\":1}; then nothing");
    }
}
