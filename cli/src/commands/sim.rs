//! `hrdsl sim`: the tests against the code under test, and the reports.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
};

use hrdsl_ir::{Program, test::Test};
use hrdsl_runtime::{
    campaign::{Campaign, prepare},
    report,
    results::Results,
    tally,
    testgen::{Generated, generate},
};
use indicatif::{ProgressBar, ProgressStyle};

use super::generate::{chosen, describe, save};
use crate::{
    color,
    exit::Exit,
    input::{self, Fault},
    installing::Installing,
};

/// Run tests against the code under test in simulation, and report.
///
/// Without tests, the scenario's suites are generated first. In the output folder: report.html, results.json, junit.xml,
/// the tests, and a recording of each.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  hrdsl sim scenario.hri\n  hrdsl sim scenario.hri tests/bdi_tests.hri -j 1\n  hrdsl sim scenario.hri --suite ta_tests -n 40 -o out"
)]
pub struct Args {
    /// The scenario.
    file: PathBuf,
    /// Files or folders of tests; without, the scenario's suites are generated.
    tests: Vec<PathBuf>,
    /// Only this suite; may be given several times.
    #[arg(long, value_name = "NAME")]
    suite: Vec<String>,
    /// How many concrete tests of each suite, instead of what the suite says.
    #[arg(short = 'n', long, value_name = "N")]
    count: Option<u32>,
    /// Tests that run at once; by default as many as there are cores.
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// Everything random comes from this.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// The folder for the results [default: hrdsl-out/<scenario>].
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Exit with 0 even if requirements were violated or tests broke off.
    #[arg(long)]
    exit_zero: bool,
}

/// # Errors
/// A file, a suite that does not exist, a model that cannot be run, or what the code needs cannot be installed.
pub fn run(args: &Args) -> Result<Exit, Fault> {
    let compilation = input::load(&args.file, &args.tests)?;
    let Some(program) = input::report_errors(&args.file, &compilation) else { return Ok(Exit::Errors) };
    let system =
        program.system.as_ref().ok_or("the scenario has no `system` block: there is nothing to run")?;
    let out = args.out.clone().unwrap_or_else(|| Path::new("hrdsl-out").join(&program.name));

    let generated = generate_suites(args, program, &out)?;
    let tests = selected(args, program, &generated)?;
    let dir = input::folder(&args.file);
    let console = Installing::default();
    let env = prepare(&system.run, &dir, &cache()?, &|step| console.show(step)).map_err(|e| e.to_string())?;
    let jobs = args.jobs.map_or_else(cores, usize::from);
    let campaign = Campaign { program, dir: dir.clone(), env, jobs };
    let results = execute(&campaign, &tests, &out)?;

    let sources = system.coverage.iter().filter_map(|f| Some((f.clone(), input::read(&dir.join(f)).ok()?)));
    let results = tally(program, args.seed, &generated, results, &sources.collect::<BTreeMap<_, _>>());
    publish(&results, &out)?;
    let clean = results.tests.iter().all(|t| t.error.is_none() && !t.has_failed());
    Ok(if clean || args.exit_zero { Exit::Ok } else { Exit::Findings })
}

/// Generates the suites, unless tests were given.
fn generate_suites(args: &Args, program: &Program, out: &Path) -> Result<Vec<Generated>, Fault> {
    if !args.tests.is_empty() {
        return Ok(Vec::new());
    }
    let mut all = Vec::new();
    for suite in chosen(program, &args.suite)? {
        let generated = generate(program, suite, args.count, args.seed)?;
        save(&out.join("tests"), program, &generated)?;
        input::print(&describe(&generated))?;
        all.push(generated);
    }
    Ok(all)
}

/// The tests to run, in order.
fn selected(args: &Args, program: &Program, generated: &[Generated]) -> Result<Vec<Test>, Fault> {
    let tests: Vec<Test> = if args.tests.is_empty() {
        generated.iter().flat_map(|g| g.tests.clone()).collect()
    } else {
        let wanted = |t: &&Test| args.suite.is_empty() || args.suite.contains(&t.provenance.suite);
        program
            .tests
            .iter()
            .filter(wanted)
            .take(args.count.map_or(usize::MAX, |n| n as usize))
            .cloned()
            .collect()
    };
    if tests.is_empty() {
        return Err("there is no test to run".to_owned());
    }
    Ok(tests)
}

fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

/// Where Python packages are kept: `$HRDSL_CACHE`, else the user's cache folder.
fn cache() -> Result<PathBuf, Fault> {
    let var = |name: &str| std::env::var_os(name).filter(|v| !v.is_empty()).map(PathBuf::from);
    var("HRDSL_CACHE")
        .or_else(|| var("XDG_CACHE_HOME").map(|c| c.join("hrdsl")))
        .or_else(|| var("HOME").map(|h| h.join(".cache/hrdsl")))
        .ok_or_else(|| "no folder for the cache: set HRDSL_CACHE".to_owned())
}

/// What has come in so far.
#[derive(Default)]
struct Progress {
    violating: u32,
    errors: u32,
    /// The first recording that could not be written.
    fault: Option<Fault>,
}

/// Runs the tests under a progress bar; each recording is written before its test is counted.
fn execute(
    campaign: &Campaign<'_>,
    tests: &[Test],
    out: &Path,
) -> Result<Vec<hrdsl_runtime::results::TestResult>, Fault> {
    let traces = out.join("traces");
    if traces.exists() {
        fs::remove_dir_all(&traces).map_err(|e| format!("cannot clear {}: {e}", traces.display()))?;
    }
    let bar = ProgressBar::new(tests.len() as u64);
    if let Ok(style) =
        ProgressStyle::with_template("{bar:32} {pos}/{len} tests  {elapsed} (about {eta} left)  {msg}")
    {
        bar.set_style(style);
    }
    let progress = Mutex::new(Progress::default());
    let results = campaign.run(tests, |done| {
        let mut progress = progress.lock().unwrap_or_else(PoisonError::into_inner);
        progress.violating += u32::from(done.result.has_failed());
        progress.errors += u32::from(done.result.error.is_some());
        let path = traces.join(format!("{}.jsonl", done.result.name));
        if let Err(fault) = input::write(&path, done.recording) {
            progress.fault.get_or_insert(fault);
        }
        bar.set_message(format!("{} with violations, {} errors", progress.violating, progress.errors));
        bar.inc(1);
    })?;
    bar.finish_and_clear();
    match progress.into_inner().unwrap_or_else(PoisonError::into_inner).fault {
        Some(fault) => Err(fault),
        None => Ok(results),
    }
}

/// Writes the reports and prints the summary.
fn publish(results: &Results, out: &Path) -> Result<(), Fault> {
    let json = serde_json::to_string_pretty(results).map_err(|e| format!("cannot write results: {e}"))?;
    input::write(&out.join("results.json"), &(json + "\n"))?;
    input::write(&out.join("junit.xml"), &report::junit(results))?;
    let page = out.join("report.html");
    input::write(&page, &report::html(results))?;
    let summary = report::summary(results, 100, color::stdout_has());
    input::print(&format!("{summary}report: {}\n", page.display()))
}
