//! `--check-determinism`: a second run of the same tests, compared with the first, event by event.

use std::{
    collections::BTreeMap,
    fmt::Write as _,
    path::Path,
    sync::{Mutex, PoisonError},
};

use hrdsl_ir::test::Test;
use hrdsl_runtime::campaign::CampaignSetup;

use super::run::{output_text, progress_bar, recording};
use crate::{fault::CommandFault, files};

/// Differences that are listed, at most.
const LISTED: usize = 20;

/// What the second run made different.
pub struct RunDifferences {
    /// How many tests differ.
    pub tests: usize,
    /// For people.
    pub text: String,
}

/// Runs the tests once more, in the opposite order, and compares their recordings and output with those below a folder.
pub fn compare(
    campaign: &CampaignSetup<'_>,
    tests: &[Test],
    first: &Path,
) -> Result<RunDifferences, CommandFault> {
    let backwards: Vec<Test> = tests.iter().rev().cloned().collect();
    let bar = progress_bar(tests.len());
    bar.set_message("again, to compare");
    let found: Mutex<BTreeMap<usize, (String, String)>> = Mutex::default();
    // The second run keeps no files: those of the first are the results.
    let again = CampaignSetup { keep: None, ..campaign.clone() };
    let outcome = again.run(&backwards, |done| {
        let stem = done.result.name.file_stem();
        let before = files::read(&recording(first, &stem))?;
        let output = files::read(&first.join("output").join(format!("{stem}.txt"))).unwrap_or_default();
        let difference = difference(&before, done.recording).or_else(|| {
            let again = output_text(done.output);
            line_difference(&output, &again)
                .map(|(line, a, b)| format!("output, line {line}: {a}; then: {b}"))
        });
        if let Some(difference) = difference {
            let mut found = found.lock().unwrap_or_else(PoisonError::into_inner);
            found.insert(tests.len() - done.index, (done.result.name.to_string(), difference));
        }
        bar.inc(1);
        Ok(())
    })?;
    bar.finish_and_clear();
    let found = found.into_inner().unwrap_or_else(PoisonError::into_inner);
    let mut text = String::new();
    if outcome.interrupted {
        let _ =
            writeln!(text, "determinism: the second run was interrupted after {} tests", outcome.tests.len());
    }
    if found.is_empty() {
        let _ =
            writeln!(text, "determinism: {} tests ran twice, event by event the same", outcome.tests.len());
    } else {
        let _ = writeln!(
            text,
            "determinism: {} of {} tests differ between two runs",
            found.len(),
            outcome.tests.len()
        );
    }
    for (name, difference) in found.values().take(LISTED) {
        let _ = writeln!(text, "  {name}: {difference}");
    }
    if found.len() > LISTED {
        let _ = writeln!(text, "  and {} more", found.len() - LISTED);
    }
    if !found.is_empty() {
        text.push_str("  (spec/randomness.md lists what is repeatable and what is not)\n");
    }
    Ok(RunDifferences { tests: found.len(), text })
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
