//! Runs tests under a progress bar; what belongs to a test is written before it is counted.

use std::{
    fmt::Write as _,
    path::Path,
    sync::{Mutex, PoisonError},
};

use hrdsl_ir::test::Test;
use hrdsl_runtime::campaign::{CampaignRun, CampaignSetup, FinishedRun, ProgramOutput};
use indicatif::{ProgressBar, ProgressStyle};

use crate::{fault::CommandFault, files, results_folder};

/// What has come in so far.
#[derive(Default)]
struct CampaignProgress {
    violating: u32,
    errors: u32,
}

/// A bar for so many tests.
pub fn progress_bar(tests: usize) -> ProgressBar {
    let bar = ProgressBar::new(tests as u64);
    let template = "{bar:32} {pos}/{len} tests  {elapsed} (about {eta} left)  {msg}";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar
}

/// Runs the tests, and writes their recordings and output below a folder. `quiet`: the terminal is somebody else's.
pub fn execute(
    campaign: &CampaignSetup<'_>,
    tests: &[Test],
    to: &Path,
    quiet: bool,
) -> Result<CampaignRun, CommandFault> {
    let bar = if quiet { ProgressBar::hidden() } else { progress_bar(tests.len()) };
    let progress = Mutex::new(CampaignProgress::default());
    let run = campaign.run(tests, |done| {
        let written = write(&done, to);
        let mut progress = progress.lock().unwrap_or_else(PoisonError::into_inner);
        progress.violating += u32::from(done.result.has_failed());
        progress.errors += u32::from(done.result.error.is_some() || written.is_err());
        bar.set_message(format!("{} with violations, {} errors", progress.violating, progress.errors));
        bar.inc(1);
        written
    })?;
    bar.finish_and_clear();
    Ok(run)
}

/// Where a test's recording is.
pub fn recording(to: &Path, stem: &str) -> std::path::PathBuf {
    to.join(results_folder::TRACES).join(format!("{stem}.jsonl"))
}

fn write(done: &FinishedRun<'_>, to: &Path) -> Result<(), CommandFault> {
    let stem = done.result.name.file_stem();
    files::write(&recording(to, &stem), done.recording)?;
    if let Some(replay) = done.replay {
        files::write_bytes(&to.join(results_folder::REPLAYS).join(format!("{stem}.mcap")), replay)?;
    }
    let text = output_text(done.output);
    if !text.is_empty() {
        files::write(&to.join("output").join(format!("{stem}.txt")), &text)?;
    }
    Ok(())
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
