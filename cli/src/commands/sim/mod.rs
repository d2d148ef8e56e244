//! `hrdsl sim`: the tests against the code under test, and the reports.

mod choices;
mod chosen_system;
mod determinism;
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

use hrdsl_ir::{Nanos, Program, system::SystemUnderTest, test::Test};
use hrdsl_runtime::{
    campaign::{
        CampaignRun, CampaignSetup, CampaignTimes, CellIsolation, CellSettings, ForkPlan, ProcessorClocks,
        ProgramLimits, StopFlag, SupervisorCommand, find_hulls, prepare,
    },
    judge::tally,
    report,
    results::{CampaignResults, GeneratedSuite},
    testgen::generate,
};
use serde::Serialize;

use choices::{IsolationArg, ReplaysArg};
use chosen_system::{chosen_system, system_file};

use super::{
    generate::{chosen, describe, save},
    shown,
};
use crate::{
    color, covered_files,
    exit::CommandExit,
    fault::CommandFault,
    files,
    hulls::HullFolder,
    input,
    installing::InstallProgress,
    interrupt,
    observation::{ObservationArgs, locate},
    quantity,
    results_folder::ResultsFolder,
    terminal,
};

/// What `sim` writes into its folder, the reports last.
const NAMES: [&str; 9] =
    ["tests", "traces", "replays", "output", "files", "run.json", "results.json", "junit.xml", "report.html"];
const REPORTS: [&str; 4] = ["run.json", "results.json", "junit.xml", "report.html"];

/// The argument that makes this program the supervisor of a cell.
pub const SUPERVISE: &str = "supervise-cell";

/// Run tests against the code under test in simulation, and report.
///
/// Without tests, the scenario's suites are generated first. In the output folder: report.html, results.json, junit.xml,
/// run.json, the tests, a recording of each, and what the program wrote in each.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  hrdsl sim scenario.hri\n  hrdsl sim scenario.hri tests/bdi_tests.hri -j 1\n  hrdsl sim scenario.hri --suite ta_tests -n 40 -o out\n  hrdsl sim scenario.hri --test bdi_tests.t017 --keep-files\n  hrdsl sim scenario.hri --replays all\n  hrdsl sim scenario.hri --system with_rospy/system.hri\n  hrdsl sim scenario.hri --check-determinism\n  hrdsl sim scenario.hri --suite ta_tests -n 4 --repeat 100\n  hrdsl sim scenario.hri --schedules 20"
)]
pub struct SimArgs {
    /// The scenario.
    file: PathBuf,
    /// Files or folders of tests; without, the scenario's suites are generated.
    tests: Vec<PathBuf>,
    /// Only this suite; may be given several times.
    #[arg(long, value_name = "NAME")]
    suite: Vec<String>,
    /// Only this test, as `SUITE.tNNN`; may be given several times.
    #[arg(long, value_name = "NAME")]
    test: Vec<String>,
    /// Which of the scenario's systems is tested, or a file with another one; by default the first.
    #[arg(long, value_name = "NAME|FILE")]
    system: Option<String>,
    /// How many concrete tests of each suite, instead of what the suite says.
    #[arg(short = 'n', long, value_name = "N")]
    count: Option<u32>,
    /// Tests that run at once; by default as many as there are cores.
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// Everything random comes from this.
    #[arg(long, default_value_t = 0)]
    seed: u64,
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
    /// Say where processor time goes, on the console and in run.json.
    #[arg(long, conflicts_with = "debug")]
    timings: bool,
    /// Keep the files that the program writes in each test, in `files/`.
    #[arg(long)]
    keep_files: bool,
    /// Of which tests there is a file in `replays/` that `hrdsl view` shows, and other tools open.
    #[arg(long, value_enum, value_name = "WHICH", default_value_t = ReplaysArg::Failing)]
    replays: ReplaysArg,
    /// Let `breakpoint()` in the program under test have the terminal; of one test, named by --test.
    #[arg(long, requires = "test", conflicts_with_all = ["check_determinism", "jobs"])]
    debug: bool,
    /// Start the program's interpreter anew for each test, instead of once for each worker; the results are the same.
    #[arg(long)]
    no_fork: bool,
    /// How tests are kept apart [default: namespaces where the system allows them, otherwise copies].
    #[arg(long, value_enum, value_name = "HOW")]
    isolation: Option<IsolationArg>,
    /// Processor time that the program may use in a test, as `90s` or `5min`, instead of what the scenario says.
    #[arg(long, value_name = "TIME", value_parser = quantity::time)]
    cpu_limit: Option<Duration>,
    /// Wall time after which a test is given up.
    #[arg(long, value_name = "TIME", value_parser = quantity::time)]
    wall_limit: Option<Duration>,
    /// Memory that each process of the program may use, as `500MB` or `2GB`.
    #[arg(long, value_name = "SIZE", value_parser = quantity::data)]
    memory_limit: Option<u64>,
    /// Output that the program may write in a test.
    #[arg(long, value_name = "SIZE", value_parser = quantity::data)]
    output_limit: Option<u64>,
    #[command(flatten)]
    observation: ObservationArgs,
}

/// # Errors
/// A file, a suite or test that does not exist, a folder whose files would be lost, a model that cannot be run, or what the
/// code needs cannot be installed.
pub fn run(args: &SimArgs) -> Result<CommandExit, CommandFault> {
    let beside = system_file(args)?;
    let beside: Vec<&str> = beside.as_deref().into_iter().collect();
    let compilation = input::load_beside(&args.file, &args.tests, &beside)?;
    let Some(program) = input::report_errors(&args.file, &compilation) else {
        return Ok(CommandExit::Errors);
    };
    let system = chosen_system(program, args.system.as_deref())?;
    let system = &covered_files::named(system, &files::folder(&args.file));
    let out = args.out.clone().unwrap_or_else(|| Path::new("hrdsl-out").join(&program.name));
    let folder = ResultsFolder::open(&out, &NAMES)?;

    let generated = generate_suites(args, program, &folder.staging())?;
    let tests = selected(args, program, &generated)?;
    if args.debug && tests.len() != 1 {
        return Err(format!("--debug runs one test, and {} are chosen; name one with --test", tests.len()));
    }
    let interfaces = input::interface_table(&compilation, system)?;
    let campaign = prepared(args, program, system, interfaces, &out, &folder)?;
    let begun = Instant::now();
    let run::ExecutedTests { run, unreplayed } =
        run::execute(&campaign, &tests, &folder.staging(), args.debug)?;
    let CampaignRun { outcome, times } = run;
    let differences = match args.repeat.or(args.check_determinism.then_some(2)) {
        Some(runs) if !outcome.interrupted => {
            Some(determinism::compare(&campaign, &tests, &outcome, &folder.staging(), runs)?)
        }
        Some(_) | None => None,
    };
    let races = match args.schedules {
        Some(count) if !outcome.interrupted => Some(schedules::compare(&campaign, &tests, &outcome, count)?),
        Some(_) | None => None,
    };
    let interrupted = outcome.interrupted;
    let dir = campaign.dir.clone();
    let sources =
        system.coverage().into_iter().filter_map(|f| files::read(&dir.join(&f)).ok().map(|text| (f, text)));
    let sources = sources.collect::<BTreeMap<_, _>>();
    let mut results = tally(program, args.seed, &generated, outcome, &sources, rerun::words(args, &out));
    locate(&mut results, &compilation);
    (results.view, results.unreplayed) = (rerun::view_of_results(args, &out), unreplayed);
    publish(&results, &campaign, (args, times.as_ref()), folder)?;
    summarise(&results, &campaign, (args, &out), begun.elapsed())?;
    if let Some(times) = &times {
        terminal::print(&timings::table(times))?;
    }
    let repeatable = differences.as_ref().is_none_or(|d| d.tests == 0);
    if let Some(differences) = differences {
        terminal::print(&differences.text)?;
    }
    let racy = races.as_ref().is_some_and(|races| races.tests > 0);
    if let Some(races) = races {
        terminal::print(&races.text)?;
    }
    Ok(if interrupted {
        CommandExit::Interrupted
    } else if racy || !repeatable || !(results.is_clean() || args.exit_zero) {
        CommandExit::Findings
    } else {
        CommandExit::Ok
    })
}

/// Installs what the code needs, and finds out how its tests can be kept apart.
fn prepared<'p>(
    args: &SimArgs,
    program: &'p Program,
    system: &'p SystemUnderTest,
    interfaces: String,
    out: &Path,
    folder: &ResultsFolder,
) -> Result<CampaignSetup<'p>, CommandFault> {
    let dir = files::folder(&args.file);
    let console = InstallProgress::default();
    let cache = cache()?;
    let env = prepare(system, &dir, &cache, &|step| console.show(step)).map_err(|e| e.to_string())?;
    find_hulls(program, &HullFolder { folder: cache.join("hulls") });
    let wanted = args.isolation.map(|how| match how {
        IsolationArg::Namespaces => CellIsolation::Namespaces,
        IsolationArg::Copies => CellIsolation::Copies,
    });
    let mut cells = CellSettings::probe(SupervisorCommand::this_program(SUPERVISE), &dir, wanted)
        .map_err(|e| e.to_string())?;
    cells.hidden = hidden(&dir, out, folder);
    cells.terminal = args.debug;
    cells.network = system.online;
    for gap in &cells.gaps {
        terminal::say_line(format_args!("note: {gap}"));
    }
    for complaint in env.analyse(&dir, &system.coverage()).map_err(|e| e.to_string())? {
        terminal::say_line(format_args!("warning: {}", complaint.trim_start_matches("hrdsl: ")));
    }
    let mut campaign = CampaignSetup {
        program,
        system,
        interfaces,
        dir,
        env,
        seed: args.seed,
        cells,
        limits: limits(args, system),
        variables: variables(args, system),
        keep: args.keep_files.then(|| folder.staging().join("files")).map(absolute).transpose()?,
        jobs: if args.debug { 1 } else { args.jobs.map_or_else(cores, usize::from) },
        forks: ForkPlan::default(),
        stop: stop_flag(args.debug)?,
        conformance: args.observation.options(program)?,
        replays: args.replays != ReplaysArg::None,
        clocks: args.timings.then_some(ProcessorClocks::SYSTEM),
    };
    for complaint in campaign.plan_forks(args.no_fork)? {
        terminal::say_line(format_args!(
            "note: the program is started anew for each test, which takes longer: {complaint}"
        ));
    }
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
fn variables(args: &SimArgs, system: &SystemUnderTest) -> Vec<(OsString, OsString)> {
    let given = |name: &String| Some((name.into(), std::env::var_os(name)?));
    let mut variables: Vec<_> = system.env.iter().filter_map(given).collect();
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

fn limits(args: &SimArgs, system: &SystemUnderTest) -> ProgramLimits {
    let default = ProgramLimits::default();
    if args.debug {
        // Whoever debugs takes the time that it takes.
        let for_ever = Duration::from_secs(u64::from(u32::MAX));
        return ProgramLimits { budget: for_ever, cpu: for_ever, wall: for_ever, ..default };
    }
    let declared = |time: Option<Nanos>| time.map(|t| Duration::from_nanos(t.max(0).unsigned_abs()));
    ProgramLimits {
        budget: declared(Some(system.budget)).unwrap_or(default.budget),
        cpu: args.cpu_limit.or(declared(system.cpu)).unwrap_or(default.cpu),
        wall: args.wall_limit.or(declared(system.wall)).unwrap_or(default.wall),
        memory: args.memory_limit.or(system.memory).unwrap_or(default.memory),
        output: args.output_limit.or(system.output).unwrap_or(default.output),
    }
}

/// Set by an interrupt or a request to terminate; at the second, the program ends at once. While somebody debugs,
/// interrupts are for the debugger.
pub(super) fn stop_flag(debug: bool) -> Result<StopFlag, CommandFault> {
    interrupt::flag(debug).map(StopFlag::from_shared)
}

fn absolute(path: PathBuf) -> Result<PathBuf, CommandFault> {
    std::path::absolute(&path).map_err(|e| format!("cannot find {}: {e}", terminal::shown(&path)))
}

/// Generates the suites, unless tests were given.
fn generate_suites(
    args: &SimArgs,
    program: &Program,
    to: &Path,
) -> Result<Vec<GeneratedSuite>, CommandFault> {
    if !args.tests.is_empty() {
        return Ok(Vec::new());
    }
    let mut all = Vec::new();
    for suite in chosen(program, &args.suite)? {
        let is_of_suite = |name: &String| {
            short(program, name).strip_prefix(&suite.name).is_some_and(|r| r.starts_with('.'))
        };
        if !args.test.is_empty() && !args.test.iter().any(is_of_suite) {
            continue;
        }
        let generated = generate(program, suite, args.count, args.seed)?;
        save(&to.join("tests"), program, &generated)?;
        terminal::print(&describe(&generated))?;
        all.push(generated);
    }
    Ok(all)
}

/// The tests to run, in order.
fn selected(
    args: &SimArgs,
    program: &Program,
    generated: &[GeneratedSuite],
) -> Result<Vec<Test>, CommandFault> {
    let mut tests: Vec<Test> = if args.tests.is_empty() {
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
    let is_called = |test: &Test, name: &String| short(program, &test.name) == short(program, name);
    for name in &args.test {
        if !tests.iter().any(|t| is_called(t, name)) {
            let known: Vec<&str> = tests.iter().take(3).map(|t| short(program, &t.name)).collect();
            let known = if known.is_empty() {
                String::new()
            } else {
                format!("; there are {}, …", known.join(", "))
            };
            return Err(format!("no test is called `{name}`{known}"));
        }
    }
    tests.retain(|t| args.test.is_empty() || args.test.iter().any(|name| is_called(t, name)));
    if tests.is_empty() {
        return Err("there is no test to run".to_owned());
    }
    Ok(tests)
}

/// The name of a test without that of its scenario.
fn short<'n>(program: &Program, name: &'n str) -> &'n str {
    name.strip_prefix(&program.name).and_then(|rest| rest.strip_prefix('.')).unwrap_or(name)
}

fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

/// Where Python packages are kept: `$HRDSL_CACHE`, else the user's cache folder.
pub(super) fn cache() -> Result<PathBuf, CommandFault> {
    let var = |name: &str| std::env::var_os(name).filter(|v| !v.is_empty()).map(PathBuf::from);
    var("HRDSL_CACHE")
        .or_else(|| var("XDG_CACHE_HOME").map(|c| c.join("hrdsl")))
        .or_else(|| var("HOME").map(|h| h.join(".cache/hrdsl")))
        .ok_or_else(|| "no folder for the cache: set HRDSL_CACHE".to_owned())
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
    let replays = shown::make(campaign.program, results, &to);
    files::write(&to.join("report.html"), &shown::page(results, replays.as_ref()))?;
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
    terminal::print(&format!("{summary}{ran}{again}report: {}\n", terminal::shown(&page)))
}
