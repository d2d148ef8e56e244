//! `hrdsl view`: recorded tests as a page that replays them.

use std::{
    fs,
    path::{Path, PathBuf},
};

use hrdsl_ir::Program;
use hrdsl_runtime::{
    recording,
    results::TestName,
    viewer::{PageOpening, RunGroup, SharedAssets, ViewedRun, page, replay::mesh_assets},
};

use super::{
    recorded::{exported, keep_used, viewed},
    sources::CodeSources,
};
use crate::{exit::CommandExit, fault::CommandFault, files, input, results_folder, terminal};

/// So large a page may be with all tests on it, in bytes; a test that is named is shown whatever its size.
const LARGEST: usize = 8 << 20;

/// Make a page that replays recorded tests: the scene in 3D, and all that happened on a time line.
///
/// The page is one file that needs nothing but a browser, and opens at the first violation. A test is named as `SUITE.tNNN`, and looked for in the
/// folder of the results; or a recording is named by its file. Without either, the page has all tests that can be replayed.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  hrdsl view scenario.hri bdi_tests.t017\n  hrdsl view scenario.hri\n  hrdsl view scenario.hri bdi_tests.t017 --beside bdi_tests.t003 -o both.html\n  hrdsl view scenario.hri out/replays/handover.bdi_tests.t017.mcap\n  hrdsl view scenario.hri bdi_tests.t017 -o foxglove.mcap"
)]
pub struct ViewArgs {
    /// The scenario.
    file: PathBuf,
    /// A test, as `SUITE.tNNN`, or a recording (`.mcap`, `.jsonl`).
    what: Option<String>,
    /// Another one, to compare it with: both play side by side, and the first difference is marked.
    #[arg(long, value_name = "TEST|RECORDING", requires = "what")]
    beside: Option<String>,
    /// The folder of the results [default: hrdsl-out/SCENARIO].
    #[arg(long, value_name = "DIR")]
    results: Option<PathBuf>,
    /// The page to write; or, if its name ends in .mcap, a recording that Foxglove plays.
    #[arg(short, long, value_name = "FILE", default_value = "view.html")]
    out: PathBuf,
}

/// # Errors
/// A scenario or recording that cannot be read, a test that nobody has recorded, or a page that cannot be written.
pub fn run(args: &ViewArgs) -> Result<CommandExit, CommandFault> {
    refuse_foreign(&args.out)?;
    let (compilation, gone) = input::load_to_look(&args.file)?;
    let Some(program) = input::report_errors(&args.file, &compilation) else {
        return Ok(CommandExit::Errors);
    };
    let results = args.results.clone().unwrap_or_else(|| Path::new("hrdsl-out").join(&program.name));
    for mesh in gone {
        terminal::say_line(format_args!("note: the mesh {mesh} is not there; a box stands for it"));
    }
    if is_recording(&args.out) {
        return export(args, program, &results);
    }
    let (mut assets, left_out) = mesh_assets(program);
    if left_out > 0 {
        terminal::say_line(format_args!(
            "note: {left_out} meshes are too large for the page; boxes stand for them"
        ));
    }
    let mut sources = CodeSources::beside(&args.file).written_as(&compilation.files);
    let html = match &args.what {
        Some(what) => chosen(args, program, &results, what, &mut sources, &mut assets)?,
        None => all(program, &results, &mut sources, &mut assets)?,
    };
    files::write(&args.out, &html)?;
    terminal::print(&format!("view: {}\n", terminal::shown(&args.out)))?;
    Ok(CommandExit::Ok)
}

/// Whether a recording is to be written, and no page.
fn is_recording(out: &Path) -> bool {
    out.extension().is_some_and(|ending| ending == "mcap")
}

/// Nobody's file is lost: only a page or an export of this command is replaced.
fn refuse_foreign(out: &Path) -> Result<(), CommandFault> {
    let is_page = |bytes: &[u8]| String::from_utf8_lossy(bytes).contains("id=\"hrdsl-index\"");
    let is_ours =
        |bytes: Vec<u8>| if is_recording(out) { recording::is_export(&bytes) } else { is_page(&bytes) };
    if !out.exists() || fs::read(out).is_ok_and(is_ours) {
        return Ok(());
    }
    let what = if is_recording(out) { "export" } else { "page" };
    Err(format!(
        "{} is no {what} of `hrdsl view` and would be lost; name another file with -o",
        terminal::shown(out)
    ))
}

/// Writes a recording in the form that other tools play.
fn export(args: &ViewArgs, program: &Program, results: &Path) -> Result<CommandExit, CommandFault> {
    let (Some(what), None) = (&args.what, &args.beside) else {
        return Err(
            "a file that ends in .mcap takes one recording: name a test, and nothing beside it".to_owned()
        );
    };
    let path = found(program, results, what)?;
    files::write_bytes(&args.out, &exported(program, &path)?)?;
    terminal::print(&format!("view: {}\n", terminal::shown(&args.out)))?;
    Ok(CommandExit::Ok)
}

/// The page of one test, or of two.
fn chosen(
    args: &ViewArgs,
    program: &Program,
    results: &Path,
    what: &str,
    sources: &mut CodeSources,
    assets: &mut SharedAssets,
) -> Result<String, CommandFault> {
    let path = found(program, results, what)?;
    let mut first = viewed(program, &path, sources)?;
    let mut opening = PageOpening { run: Some(first.id.clone()), beside: None };
    let mut runs = Vec::new();
    if let Some(beside) = &args.beside {
        let mut second = viewed(program, &found(program, results, beside)?, sources)?;
        if second.id == first.id {
            // The same test twice, such as before a change and after it.
            second.id = format!("{}-beside", second.id);
            second.label = format!("{} ({beside})", second.label);
            second.group = RunGroup::Version;
        }
        first.beside = Some(second.id.clone());
        opening.beside = Some(second.id.clone());
        runs.push(second);
    }
    runs.insert(0, first);
    say_notes(&runs);
    keep_used(assets, runs.iter().map(|run| &run.document));
    sources.put(assets, runs.iter().map(|run| &run.document));
    let title = format!("{} {}", program.name, runs.first().map_or("", |run| run.label.as_str()));
    Ok(page(&title, &runs, assets, &opening))
}

/// The page of all tests that can be replayed, as far as they fit.
fn all(
    program: &Program,
    results: &Path,
    sources: &mut CodeSources,
    assets: &mut SharedAssets,
) -> Result<String, CommandFault> {
    let folder = results.join(results_folder::REPLAYS);
    let mut runs = Vec::new();
    for path in recordings(&folder, "mcap") {
        match viewed(program, &path, sources) {
            Ok(run) => runs.push(run),
            Err(why) => terminal::say_line(format_args!("error: {why}")),
        }
    }
    if runs.is_empty() {
        return Err(format!(
            "there is nothing to replay in {}: `hrdsl sim --replays all` records each test",
            terminal::shown(&folder)
        ));
    }
    // Each requirement's first failure comes first, so that it is on the page.
    runs.sort_by_key(|run| run.requirement.is_none());
    let mut seen: Vec<String> = Vec::new();
    runs.sort_by_key(|run| {
        let is_new = run.requirement.as_ref().is_some_and(|name| !seen.contains(name));
        seen.extend(run.requirement.clone().filter(|_| is_new));
        !is_new
    });
    keep_used(assets, runs.iter().map(|run| &run.document));
    sources.put(assets, runs.iter().map(|run| &run.document));
    let opening = PageOpening::default();
    let mut html = page(&program.name, &runs, assets, &opening);
    while html.len() > LARGEST && runs.len() > 1 {
        let share = (html.len() - LARGEST).div_ceil((html.len() / runs.len()).max(1)).max(1);
        let kept = runs.len().saturating_sub(share).max(1);
        for run in runs.drain(kept..) {
            terminal::say_line(format_args!("note: no room on the page for {}; name it to see it", run.id));
        }
        html = page(&program.name, &runs, assets, &opening);
    }
    say_notes(&runs);
    Ok(html)
}

fn say_notes(runs: &[ViewedRun]) {
    for run in runs {
        for note in &run.document.notes {
            terminal::say_line(format_args!("note: {}: {note}", run.id));
        }
    }
}

/// The recording that is meant: a file, or that of a test.
fn found(program: &Program, results: &Path, what: &str) -> Result<PathBuf, CommandFault> {
    let path = Path::new(what);
    if path.is_file() {
        return Ok(path.to_owned());
    }
    let prefix = format!("{}.", program.name);
    let full = if what.starts_with(&prefix) { what.to_owned() } else { prefix.clone() + what };
    let stem = TestName::from(full).file_stem();
    let (replays, traces) = (results.join(results_folder::REPLAYS), results.join(results_folder::TRACES));
    let known = [replays.join(format!("{stem}.mcap")), traces.join(format!("{stem}.jsonl"))];
    if let Some(path) = known.into_iter().find(|path| path.is_file()) {
        return Ok(path);
    }
    let mut names: Vec<String> = recordings(&replays, "mcap")
        .into_iter()
        .chain(recordings(&traces, "jsonl"))
        .filter_map(|path| Some(path.file_stem()?.to_string_lossy().trim_start_matches(&prefix).to_owned()))
        .collect();
    names.dedup();
    let some = names.iter().take(3).map(String::as_str).collect::<Vec<_>>().join(", ");
    let there = if some.is_empty() { String::new() } else { format!("; there are {some}, …") };
    Err(format!(
        "`{what}` is no recording, and no test of the results in {}{there}",
        terminal::shown(results)
    ))
}

/// The recordings in a folder, in order.
fn recordings(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok);
    let mut paths: Vec<PathBuf> = entries
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|e| e == ending))
        .collect();
    paths.sort();
    paths
}
