//! Runs tests under a progress bar; what belongs to a test is written before it is counted.

use std::{
    collections::BTreeMap,
    fmt::Write as _,
    fs,
    path::Path,
    sync::{Mutex, PoisonError},
};

use hrdsl_ir::test::Test;
use hrdsl_runtime::{
    campaign::{CampaignRun, CampaignSetup, FinishedRun, ProgramOutput},
    results::UnreplayedTest,
};
use indicatif::ProgressBar;

use crate::{commands::campaign::progress_bar, fault::CommandFault, files, results_folder, terminal};

/// What has come in so far.
#[derive(Default)]
struct CampaignProgress {
    violating: u32,
    errors: u32,
}

/// What came of the tests, and which of them cannot be looked at although they should be.
pub struct ExecutedTests {
    pub run: CampaignRun,
    /// In the order of the tests.
    pub unreplayed: Vec<UnreplayedTest>,
}

/// Runs the tests, and writes their recordings and output below a folder. `quiet`: the terminal is somebody else's.
pub fn execute(
    campaign: &CampaignSetup<'_>,
    tests: &[Test],
    to: &Path,
    quiet: bool,
) -> Result<ExecutedTests, CommandFault> {
    let bar = if quiet { ProgressBar::hidden() } else { progress_bar(tests.len(), "tests") };
    let progress = Mutex::new(CampaignProgress::default());
    let unreplayed: Mutex<BTreeMap<usize, UnreplayedTest>> = Mutex::default();
    let run = campaign.run(tests, |done| {
        let written = write(&done, to);
        if let Err(why) = write_replay(&done, to) {
            let unreplayed_test = UnreplayedTest { test: done.result.name.clone(), why };
            let mut unreplayed = unreplayed.lock().unwrap_or_else(PoisonError::into_inner);
            unreplayed.insert(done.index, unreplayed_test);
        }
        let mut progress = progress.lock().unwrap_or_else(PoisonError::into_inner);
        progress.violating += u32::from(done.result.has_failed());
        progress.errors += u32::from(done.result.error.is_some() || written.is_err());
        bar.set_message(format!("{} with violations, {} errors", progress.violating, progress.errors));
        bar.inc(1);
        written
    })?;
    bar.finish_and_clear();
    let unreplayed = unreplayed.into_inner().unwrap_or_else(PoisonError::into_inner).into_values();
    let unreplayed: Vec<UnreplayedTest> = unreplayed.collect();
    warn(&unreplayed);
    Ok(ExecutedTests { run, unreplayed })
}

/// Where a test's recording is.
pub fn recording(to: &Path, stem: &str) -> std::path::PathBuf {
    to.join(results_folder::TRACES).join(format!("{stem}.jsonl"))
}

fn write(done: &FinishedRun<'_>, to: &Path) -> Result<(), CommandFault> {
    let stem = done.result.name.file_stem();
    files::write(&recording(to, &stem), done.recording)?;
    let text = output_text(done.output);
    if !text.is_empty() {
        files::write(&to.join("output").join(format!("{stem}.txt")), &text)?;
    }
    Ok(())
}

/// Writes the file by which a test can be looked at, if it is to have one. Nothing is judged by it, so that a test counts without it.
///
/// # Errors
/// Why it is not there: the same on every machine and in every folder, as it becomes part of the results.
fn write_replay(done: &FinishedRun<'_>, to: &Path) -> Result<(), String> {
    let Some(replay) = done.replay else { return Ok(()) };
    let bytes = replay.map_err(str::to_owned)?;
    let folder = to.join(results_folder::REPLAYS);
    let path = folder.join(format!("{}.mcap", done.result.name.file_stem()));
    fs::create_dir_all(&folder).and_then(|()| fs::write(&path, bytes)).map_err(|e| {
        // Half a file is worse than none; that it cannot be removed changes nothing.
        let _ = fs::remove_file(&path);
        format!("its recording with a picture cannot be written: {e}")
    })
}

/// Says which tests cannot be looked at.
fn warn(unreplayed: &[UnreplayedTest]) {
    const NAMED: usize = 3;
    for UnreplayedTest { test, why } in unreplayed.iter().take(NAMED) {
        terminal::say_line(format_args!("warning: {test} cannot be replayed: {why}"));
    }
    if unreplayed.len() > NAMED {
        let more = unreplayed.len() - NAMED;
        terminal::say_line(format_args!("warning: nor can {more} more; results.json names them all"));
    }
}

/// What the programs wrote, with headings between the streams.
pub fn output_text(output: &[ProgramOutput]) -> String {
    let mut text = String::new();
    for ProgramOutput { program, output: written } in output {
        let of = if output.len() > 1 { format!("{program}: ") } else { String::new() };
        for (name, stream) in [("stdout", &written.stdout), ("stderr", &written.stderr)] {
            if stream.bytes > 0 {
                let _ = writeln!(text, "── {of}{name} ──\n{}", stream.text().trim_end_matches('\n'));
            }
        }
    }
    text
}
