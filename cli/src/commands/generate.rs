//! `hrdsl gen`: tests from a scenario's suites, written as `.hri`.

use std::path::{Path, PathBuf};

use hrdsl_ir::{Program, suite::Suite};
use hrdsl_runtime::testgen::{Generated, GoalStatus, generate, write};

use crate::{
    exit::Exit,
    input::{self, Fault},
};

/// Generate tests from a scenario's suites and write them as readable `.hri`.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  hrdsl gen scenario.hri\n  hrdsl gen scenario.hri --suite bdi_tests -n 20 --seed 7 -o tests"
)]
pub struct Args {
    /// The scenario.
    file: PathBuf,
    /// Only this suite; may be given several times.
    #[arg(long, value_name = "NAME")]
    suite: Vec<String>,
    /// How many concrete tests of each suite, instead of what the suite says.
    #[arg(short = 'n', long, value_name = "N")]
    count: Option<u32>,
    /// Everything random comes from this.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// The folder to write to, one file for each suite.
    #[arg(short, long, value_name = "DIR", default_value = "hrdsl-tests")]
    out: PathBuf,
}

/// # Errors
/// A file, a suite that does not exist, or a model that cannot be run.
pub fn run(args: &Args) -> Result<Exit, Fault> {
    let compilation = input::load(&args.file, &[])?;
    let Some(program) = input::report_errors(&args.file, &compilation) else { return Ok(Exit::Errors) };
    for suite in chosen(program, &args.suite)? {
        let generated = generate(program, suite, args.count, args.seed)?;
        let path = save(&args.out, program, &generated)?;
        input::print(&format!("{}  written to {}\n", describe(&generated), path.display()))?;
    }
    Ok(Exit::Ok)
}

/// The suites of these names; all, without names.
///
/// # Errors
/// A name that is no suite's.
pub fn chosen<'p>(program: &'p Program, names: &[String]) -> Result<Vec<&'p Suite>, Fault> {
    for name in names {
        if program.suites.iter().all(|s| s.name != *name) {
            let known: Vec<&str> = program.suites.iter().map(|s| s.name.as_str()).collect();
            return Err(format!("no suite `{name}`; the scenario has: {}", known.join(", ")));
        }
    }
    let suites: Vec<&Suite> =
        program.suites.iter().filter(|s| names.is_empty() || names.contains(&s.name)).collect();
    if suites.is_empty() {
        return Err("the scenario has no suite to generate tests from".to_owned());
    }
    Ok(suites)
}

/// Writes a suite's tests; gives the file's path.
///
/// # Errors
/// A file that cannot be written.
pub fn save(folder: &Path, program: &Program, generated: &Generated) -> Result<PathBuf, Fault> {
    let path = folder.join(format!("{}.hri", generated.suite));
    input::write(&path, &write(program, &generated.tests))?;
    Ok(path)
}

/// What was generated, in a few lines.
#[must_use]
pub fn describe(generated: &Generated) -> String {
    let mut out = format!(
        "{} (by {}): {} abstract tests, {} concrete\n",
        generated.suite,
        generated.method,
        generated.abstract_tests,
        generated.tests.len()
    );
    for note in &generated.notes {
        out += &format!("  {note}\n");
    }
    let count = |status| generated.goals.iter().filter(|g| g.status == status).count();
    if !generated.goals.is_empty() {
        out += &format!(
            "  goals: {} reached, {} unreachable, {} open\n",
            count(GoalStatus::Reached),
            count(GoalStatus::Unreachable),
            count(GoalStatus::Open)
        );
    }
    for goal in generated.goals.iter().filter(|g| g.status != GoalStatus::Reached) {
        let status = if goal.status == GoalStatus::Open { "open" } else { "unreachable" };
        out += &format!("  {status}: {}: {}\n", goal.goal, goal.reason);
    }
    out
}
