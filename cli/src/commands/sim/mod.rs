//! `hrdsl sim`: the tests against the code under test, and the reports.

mod choices;
mod comparison;
mod determinism;
mod physics_steps;
mod rerun;
mod run;
mod schedules;
mod timings;

use std::{
    collections::BTreeMap,
    ffi::OsString,
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use hrdsl_ir::{Program, system::SystemUnderTest, test::Test};
use hrdsl_runtime::{
    campaign::{CampaignRun, CampaignSetup, CampaignTimes, CellIsolation, ProcessorClocks, ProgramLimits},
    judge::{CampaignOutcome, tally},
    report,
    results::{CampaignResults, GeneratedSuite},
};
use hrdsl_source::SourceFiles;
use serde::Serialize;

use choices::ReplaysArg;
use determinism::RunDifferences;

use super::{
    campaign::{CampaignArgs, chosen_system, generate_suites, selected, stop_flag, system_file},
    generate::{describe, save},
    shown,
    sources::CodeSources,
};
use crate::{
    color, covered_files, exit::CommandExit, fault::CommandFault, files, input, observation::locate,
    quantity, results_folder::ResultsFolder, terminal,
};

/// What `sim` writes into its folder, the reports last.
const NAMES: [&str; 9] =
    ["tests", "traces", "replays", "output", "files", "run.json", "results.json", "junit.xml", "report.html"];
const REPORTS: [&str; 4] = ["run.json", "results.json", "junit.xml", "report.html"];

/// Run tests against the code under test in simulation, and report.
///
/// Without tests, the scenario's suites are generated first. In the output folder: report.html, results.json, junit.xml,
/// run.json, the tests, a recording of each, and what the program wrote in each.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  hrdsl sim scenario.hri\n  hrdsl sim scenario.hri tests/bdi_tests.hri -j 1\n  hrdsl sim scenario.hri --suite ta_tests -n 40 -o out\n  hrdsl sim scenario.hri --test bdi_tests.t017 --keep-files\n  hrdsl sim scenario.hri --replays all\n  hrdsl sim scenario.hri --system with_rospy/system.hri\n  hrdsl sim scenario.hri --check-determinism\n  hrdsl sim scenario.hri --suite ta_tests -n 4 --repeat 100\n  hrdsl sim scenario.hri --schedules 20\n  hrdsl sim scenario.hri --suite ta_tests --physics-steps 5ms,2ms,1ms"
)]
pub struct SimArgs {
    #[command(flatten)]
    campaign: CampaignArgs,
    /// The folder for the results [default: hrdsl-out/SCENARIO].
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Exit with 0 even if requirements were violated or tests broke off.
    #[arg(long)]
    exit_zero: bool,
    /// Run the tests twice, and name the first event of each test that differs.
    #[arg(long)]
    check_determinism: bool,
    /// Run the tests so many times, and name the first event of each test that differs from its first run.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..), conflicts_with_all = ["check_determinism", "debug"])]
    repeat: Option<u32>,
    /// Run the tests in so many other orders of the programs' threads, too, and name those that come to something else.
    #[arg(long, value_name = "N", conflicts_with_all = ["debug", "schedule"])]
    schedules: Option<u32>,
    /// Let this number say in which order threads run that are ready; by default, first come first served.
    #[arg(long, value_name = "K")]
    schedule: Option<u32>,
    /// Do the physics in steps of this time, as `2ms`, and not in those of the world.
    #[arg(long, value_name = "TIME", value_parser = quantity::time)]
    physics_step: Option<Duration>,
    /// Run the tests with these steps of the physics, too, as `5ms,1ms`, and name those that come to something else.
    #[arg(long, value_name = "TIMES", value_delimiter = ',', value_parser = quantity::time, conflicts_with = "debug")]
    physics_steps: Vec<Duration>,
    /// Say where processor time goes, on the console and in run.json.
    #[arg(long, conflicts_with = "debug")]
    timings: bool,
    /// Say of each requirement how often it was triggered, and its least margin.
    #[arg(long)]
    triggers: bool,
    /// Keep the files that the program writes in each test, in `files/`.
    #[arg(long)]
    keep_files: bool,
    /// Of which tests there is a file in `replays/` that `hrdsl view` shows, and other tools open.
    #[arg(long, value_enum, value_name = "WHICH", default_value_t = ReplaysArg::Failing)]
    replays: ReplaysArg,
    /// Let `breakpoint()` in the program under test have the terminal; of one test, named by --test.
    #[arg(long, requires = "test", conflicts_with_all = ["check_determinism", "jobs"])]
    debug: bool,
}

/// # Errors
/// A file, a suite or test that does not exist, a folder whose files would be lost, a model that cannot be run, or what the
/// code needs cannot be installed.
pub fn run(args: &SimArgs) -> Result<CommandExit, CommandFault> {
    let beside = system_file(&args.campaign)?;
    let beside: Vec<&str> = beside.as_deref().into_iter().collect();
    let compilation = input::load_beside(&args.campaign.file, &args.campaign.tests, &beside)?;
    let Some(program) = input::report_errors(&args.campaign.file, &compilation) else {
        return Ok(CommandExit::Errors);
    };
    let stepped = args.physics_step.map(|step| physics_steps::with_step(program, step)).transpose()?;
    let program = stepped.as_ref().unwrap_or(program);
    let finer = physics_steps::with_steps(program, &args.physics_steps)?;
    let system = chosen_system(program, args.campaign.system.as_deref())?;
    let system = &covered_files::named(system, &files::folder(&args.campaign.file));
    let out = args.out.clone().unwrap_or_else(|| Path::new("hrdsl-out").join(&program.name));
    let folder = ResultsFolder::open(&out, &NAMES)?;

    let generated = generate_suites(&args.campaign, program, &|made| keep_suite(program, &folder, made))?;
    let tests = selected(&args.campaign, program, &generated)?;
    if args.debug && tests.len() != 1 {
        return Err(format!("--debug runs one test, and {} are chosen; name one with --test", tests.len()));
    }
    let interfaces = input::interface_table(&compilation, system)?;
    let campaign = prepared(args, program, system, interfaces, &out, &folder)?;
    let begun = Instant::now();
    let run::ExecutedTests { run, unreplayed } =
        run::execute(&campaign, &tests, &folder.staging(), args.debug)?;
    let CampaignRun { outcome, times } = run;
    let differences = compared(args, &campaign, (&tests, &outcome, &folder.staging()), &finer)?;
    let interrupted = outcome.interrupted;
    let dir = campaign.dir.clone();
    let sources =
        system.coverage().into_iter().filter_map(|f| files::read(&dir.join(&f)).ok().map(|text| (f, text)));
    let sources = sources.collect::<BTreeMap<_, _>>();
    let mut results =
        tally(program, args.campaign.seed, &generated, outcome, &sources, rerun::words(args, &out));
    locate(&mut results, &compilation);
    (results.view, results.unreplayed) = (rerun::view_of_results(args, &out), unreplayed);
    publish(&results, &campaign, (args, times.as_ref()), &compilation.files, folder)?;
    summarise(&results, &campaign, (args, &out), begun.elapsed())?;
    if let Some(times) = &times {
        terminal::print(&timings::table(times))?;
    }
    for found in &differences {
        terminal::print(&found.text)?;
    }
    let is_same = differences.iter().all(|found| found.tests == 0);
    Ok(if interrupted {
        CommandExit::Interrupted
    } else if !is_same || !(results.is_clean() || args.exit_zero) {
        CommandExit::Findings
    } else {
        CommandExit::Ok
    })
}

/// What becomes of the tests, whose files are below a folder, once more, in other orders of threads, and in other steps of the physics:
/// in these programs.
fn compared(
    args: &SimArgs,
    campaign: &CampaignSetup<'_>,
    (tests, outcome, files): (&[Test], &CampaignOutcome, &Path),
    stepped: &[(Duration, Program)],
) -> Result<Vec<RunDifferences>, CommandFault> {
    let mut found = Vec::new();
    if outcome.interrupted {
        return Ok(found);
    }
    if let Some(runs) = args.repeat.or(args.check_determinism.then_some(2)) {
        found.push(determinism::compare(campaign, tests, outcome, files, runs)?);
    }
    let orders = args.schedules.map(|count| (schedules::others(campaign, count), schedules::words()));
    let steps = (!stepped.is_empty())
        .then(|| (physics_steps::others(campaign, stepped), physics_steps::words(campaign.program)));
    for (ways, words) in orders.into_iter().chain(steps) {
        found.push(comparison::compare((tests, outcome), ways, &words)?);
    }
    Ok(found)
}

/// Writes the tests of a suite, and says what they are.
fn keep_suite(
    program: &Program,
    folder: &ResultsFolder,
    generated: &GeneratedSuite,
) -> Result<(), CommandFault> {
    save(&folder.staging().join("tests"), program, generated)?;
    terminal::print(&describe(generated))
}

/// Makes the campaign ready.
fn prepared<'p>(
    args: &SimArgs,
    program: &'p Program,
    system: &'p SystemUnderTest,
    interfaces: String,
    out: &Path,
    folder: &ResultsFolder,
) -> Result<CampaignSetup<'p>, CommandFault> {
    let hidden = hidden(&files::folder(&args.campaign.file), out, folder);
    let campaign = args.campaign.setup(program, system, interfaces, hidden, stop_flag(args.debug)?)?;
    let mut campaign = CampaignSetup {
        variables: variables(args, campaign.variables.clone()),
        keep: args.keep_files.then(|| folder.staging().join("files")).map(absolute).transpose()?,
        replays: args.replays != ReplaysArg::None,
        clocks: args.timings.then_some(ProcessorClocks::SYSTEM),
        ..campaign
    };
    if args.debug {
        // Whoever debugs takes the time that it takes.
        let for_ever = Duration::from_secs(u64::from(u32::MAX));
        let limits = ProgramLimits::default();
        campaign.limits = ProgramLimits { budget: for_ever, cpu: for_ever, wall: for_ever, ..limits };
        campaign.cells.terminal = true;
        campaign.jobs = 1;
    }
    args.campaign.plan_forks(&mut campaign)?;
    Ok(campaign)
}

/// Folders that the programs must not see: what is in them depends on the tests that have already run.
fn hidden(project: &Path, out: &Path, folder: &ResultsFolder) -> Vec<PathBuf> {
    let Ok(project) = project.canonicalize() else { return Vec::new() };
    let Ok(out) = out.canonicalize() else { return Vec::new() };
    let mut hidden = vec![project.join("hrdsl-out")];
    if project.starts_with(&out) {
        hidden.extend(NAMES.iter().map(|name| out.join(name)));
        hidden.extend(folder.staging().canonicalize());
    } else {
        hidden.push(out);
    }
    hidden
}

/// What the program finds in its environment besides what every program does.
fn variables(args: &SimArgs, mut variables: Vec<(OsString, OsString)>) -> Vec<(OsString, OsString)> {
    if let Some(schedule) = args.schedule {
        variables.retain(|(name, _)| name != schedules::VARIABLE);
        variables.push((schedules::VARIABLE.into(), schedule.to_string().into()));
    }
    if args.debug {
        variables.push(("HRDSL_DEBUG".into(), "1".into()));
        variables.extend(std::env::var_os("TERM").map(|term| ("TERM".into(), term)));
    }
    variables
}

fn absolute(path: PathBuf) -> Result<PathBuf, CommandFault> {
    std::path::absolute(&path).map_err(|e| format!("cannot find {}: {e}", terminal::shown(&path)))
}

/// On what a campaign ran: the one file of the results that differs between machines and versions.
#[derive(Serialize)]
struct RunInfo<'a> {
    format: &'static str,
    version: u32,
    hrdsl: &'static str,
    /// The version of the interpreter, and where it is.
    python: String,
    isolation: CellIsolation,
    /// What could not be kept apart.
    gaps: &'a [String],
    system: String,
    /// Where processor time went, if somebody asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    timings: Option<&'a CampaignTimes>,
}

/// Writes the reports, and puts all results in their places.
fn publish(
    results: &CampaignResults,
    campaign: &CampaignSetup<'_>,
    (args, timings): (&SimArgs, Option<&CampaignTimes>),
    texts: &SourceFiles,
    folder: ResultsFolder,
) -> Result<(), CommandFault> {
    let to = folder.staging();
    let info = RunInfo {
        format: "hrdsl-run",
        version: 1,
        hrdsl: env!("CARGO_PKG_VERSION"),
        python: campaign.env.version(),
        isolation: campaign.cells.isolation,
        gaps: &campaign.cells.gaps,
        system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
        timings,
    };
    files::write(&to.join("run.json"), &files::json(&info)?)?;
    files::write(&to.join("results.json"), &results.to_json().map_err(|e| e.to_string())?)?;
    files::write(&to.join("junit.xml"), &report::junit(results))?;
    if args.replays == ReplaysArg::Failing {
        shown::keep_failing(results, &to)?;
    }
    let sources = CodeSources::within(&campaign.dir).written_as(texts);
    let replays = shown::make(campaign.program, sources, results, &to);
    files::write(&to.join("report.html"), &shown::page(results, replays.as_ref(), None))?;
    folder.publish(&REPORTS)
}

/// Prints the summary. Wall time is said here and nowhere else, since it differs between equal runs.
fn summarise(
    results: &CampaignResults,
    campaign: &CampaignSetup<'_>,
    (args, out): (&SimArgs, &Path),
    wall: Duration,
) -> Result<(), CommandFault> {
    let summary = report::summary(results, super::report::WIDTH, color::stdout_has());
    let width = super::report::WIDTH;
    let triggers = if args.triggers {
        report::trigger_totals(results, width, color::stdout_has())
    } else {
        String::new()
    };
    let how = match campaign.cells.isolation {
        CellIsolation::Namespaces => "in namespaces",
        CellIsolation::Copies => "in copies of the folder",
    };
    let ran = format!(
        "ran {how} with Python {}, {} at once, in {:.1} s of wall time\n",
        campaign.env.version(),
        campaign.jobs,
        wall.as_secs_f64()
    );
    let again = if !results.is_clean() {
        let again = format!("to run one test again: (cd {} && {} NAME)\n", rerun::quoted(out), results.rerun);
        let looks = args.replays != ReplaysArg::None;
        again + &if looks { rerun::view_words(args) } else { String::new() }
    } else {
        String::new()
    };
    let page = out.join("report.html");
    terminal::print(&format!("{summary}{triggers}{ran}{again}report: {}\n", terminal::shown(&page)))
}
