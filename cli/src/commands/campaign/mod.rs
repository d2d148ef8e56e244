//! What `sim` and `mutate` have in common: which tests, on which system, within which limits.

mod bar;
mod choices;
mod chosen_system;

use std::{ffi::OsString, path::PathBuf, time::Duration};

use hrdsl_ir::{Nanos, Program, system::SystemUnderTest, test::Test};
use hrdsl_runtime::{
    campaign::{
        CampaignSetup, CellIsolation, CellSettings, ForkPlan, ProgramLimits, StopFlag, SupervisorCommand,
        find_hulls, prepare,
    },
    results::GeneratedSuite,
    testgen::generate,
};

use super::generate::chosen;
use crate::{
    fault::CommandFault, files, hulls::HullFolder, installing::InstallProgress, interrupt,
    observation::ObservationArgs, quantity, terminal,
};
pub use bar::progress_bar;
pub use choices::IsolationArg;
pub use chosen_system::{chosen_system, is_file_name, system_file};

/// The argument that makes this program the supervisor of a cell.
pub const SUPERVISE: &str = "supervise-cell";

/// Which tests run, on what, and how.
#[derive(clap::Args)]
pub struct CampaignArgs {
    /// The scenario.
    pub file: PathBuf,
    /// Files or folders of tests; without, the scenario's suites are generated.
    pub tests: Vec<PathBuf>,
    /// Only this suite; may be given several times.
    #[arg(long, value_name = "NAME")]
    pub suite: Vec<String>,
    /// Only this test, as `SUITE.tNNN`; may be given several times.
    #[arg(long, value_name = "NAME")]
    pub test: Vec<String>,
    /// Which of the scenario's systems is tested, or a file with another one; by default the first.
    #[arg(long, value_name = "NAME|FILE")]
    pub system: Option<String>,
    /// How many concrete tests of each suite, instead of what the suite says.
    #[arg(short = 'n', long, value_name = "N")]
    pub count: Option<u32>,
    /// Tests that run at once; by default as many as there are cores.
    #[arg(short, long, visible_alias = "workers", value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub jobs: Option<u16>,
    /// Everything random comes from this.
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Start the program's interpreter anew for each test, instead of once for each worker; the results are the same.
    #[arg(long)]
    pub no_fork: bool,
    /// How tests are kept apart [default: namespaces where the system allows them, otherwise copies].
    #[arg(long, value_enum, value_name = "HOW")]
    pub isolation: Option<IsolationArg>,
    /// Processor time that the program may use in a test, as `90s` or `5min`, instead of what the scenario says.
    #[arg(long, value_name = "TIME", value_parser = quantity::time)]
    pub cpu_limit: Option<Duration>,
    /// Wall time after which a test is given up.
    #[arg(long, value_name = "TIME", value_parser = quantity::time)]
    pub wall_limit: Option<Duration>,
    /// Memory that each process of the program may use, as `500MB` or `2GB`.
    #[arg(long, value_name = "SIZE", value_parser = quantity::data)]
    pub memory_limit: Option<u64>,
    /// Output that the program may write in a test.
    #[arg(long, value_name = "SIZE", value_parser = quantity::data)]
    pub output_limit: Option<u64>,
    #[command(flatten)]
    pub observation: ObservationArgs,
}

impl CampaignArgs {
    /// Installs what the code needs, and finds out how its tests can be kept apart. `hidden` are folders that its programs must not see.
    ///
    /// # Errors
    /// What cannot be installed, and a machine that cannot keep tests apart as it was asked to.
    pub fn setup<'p>(
        &self,
        program: &'p Program,
        system: &'p SystemUnderTest,
        interfaces: String,
        hidden: Vec<PathBuf>,
        stop: StopFlag,
    ) -> Result<CampaignSetup<'p>, CommandFault> {
        let dir = files::folder(&self.file);
        let console = InstallProgress::default();
        let cache = cache()?;
        let env = prepare(system, &dir, &cache, &|step| console.show(step)).map_err(|e| e.to_string())?;
        find_hulls(program, &HullFolder { folder: cache.join("hulls") });
        let wanted = self.isolation.map(|how| match how {
            IsolationArg::Namespaces => CellIsolation::Namespaces,
            IsolationArg::Copies => CellIsolation::Copies,
        });
        let mut cells = CellSettings::probe(SupervisorCommand::this_program(SUPERVISE), &dir, wanted)
            .map_err(|e| e.to_string())?;
        cells.hidden = hidden;
        cells.network = system.online;
        for gap in &cells.gaps {
            terminal::say_line(format_args!("note: {gap}"));
        }
        for complaint in env.analyse(&dir, &system.coverage()).map_err(|e| e.to_string())? {
            terminal::say_line(format_args!("warning: {}", complaint.trim_start_matches("hrdsl: ")));
        }
        Ok(CampaignSetup {
            program,
            system,
            interfaces,
            dir,
            env,
            seed: self.seed,
            cells,
            limits: self.limits(system),
            variables: variables(system),
            keep: None,
            jobs: self.jobs.map_or_else(cores, usize::from),
            forks: ForkPlan::default(),
            stop,
            conformance: self.observation.options(program)?,
            replays: false,
            clocks: None,
        })
    }

    /// Finds out how interpreters are started, when all else is known; says for which programs they cannot be forked.
    ///
    /// # Errors
    /// Only if what the programs need to know cannot be kept for them.
    pub fn plan_forks(&self, campaign: &mut CampaignSetup<'_>) -> Result<(), CommandFault> {
        for complaint in campaign.plan_forks(self.no_fork)? {
            terminal::say_line(format_args!(
                "note: the program is started anew for each test, which takes longer: {complaint}"
            ));
        }
        Ok(())
    }

    fn limits(&self, system: &SystemUnderTest) -> ProgramLimits {
        let default = ProgramLimits::default();
        let declared = |time: Option<Nanos>| time.map(|t| Duration::from_nanos(t.max(0).unsigned_abs()));
        ProgramLimits {
            budget: declared(Some(system.budget)).unwrap_or(default.budget),
            cpu: self.cpu_limit.or(declared(system.cpu)).unwrap_or(default.cpu),
            wall: self.wall_limit.or(declared(system.wall)).unwrap_or(default.wall),
            memory: self.memory_limit.or(system.memory).unwrap_or(default.memory),
            output: self.output_limit.or(system.output).unwrap_or(default.output),
        }
    }
}

/// What the program finds in its environment besides what every program does.
fn variables(system: &SystemUnderTest) -> Vec<(OsString, OsString)> {
    let given = |name: &String| Some((name.into(), std::env::var_os(name)?));
    system.env.iter().filter_map(given).collect()
}

/// Set by an interrupt or a request to terminate; at the second, the program ends at once. While somebody debugs,
/// interrupts are for the debugger.
pub fn stop_flag(debug: bool) -> Result<StopFlag, CommandFault> {
    interrupt::flag(debug).map(StopFlag::from_shared)
}

/// Generates the suites, unless tests were given; `keep` is shown each.
///
/// # Errors
/// A suite that does not exist or cannot be generated, and what `keep` gives.
pub fn generate_suites(
    args: &CampaignArgs,
    program: &Program,
    keep: &dyn Fn(&GeneratedSuite) -> Result<(), CommandFault>,
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
        keep(&generated)?;
        all.push(generated);
    }
    Ok(all)
}

/// The tests to run, in order.
///
/// # Errors
/// A test that does not exist, and that there is none.
pub fn selected(
    args: &CampaignArgs,
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
pub fn cache() -> Result<PathBuf, CommandFault> {
    let var = |name: &str| std::env::var_os(name).filter(|v| !v.is_empty()).map(PathBuf::from);
    var("HRDSL_CACHE")
        .or_else(|| var("XDG_CACHE_HOME").map(|c| c.join("hrdsl")))
        .or_else(|| var("HOME").map(|h| h.join(".cache/hrdsl")))
        .ok_or_else(|| "no folder for the cache: set HRDSL_CACHE".to_owned())
}
