//! `hrdsl check`: every name, type, unit and role of a scenario.

use std::path::PathBuf;

use crate::{
    exit::Exit,
    input::{self, Fault},
};

/// Check a scenario: every name, type, unit and role.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  hrdsl check examples/handover/scenario.hri\n  hrdsl check scenario.hri tests/*.hri"
)]
pub struct Args {
    /// The scenario.
    file: PathBuf,
    /// Files or folders of tests to check in its vocabulary.
    tests: Vec<PathBuf>,
}

/// # Errors
/// A file that cannot be read.
pub fn run(args: &Args) -> Result<Exit, Fault> {
    let compilation = input::load(&args.file, &args.tests)?;
    let Some(program) = input::report(&compilation) else { return Ok(Exit::Errors) };
    println!(
        "{}: scenario `{}` is well formed: {} events and stimuli, {} agents ({} plans), {} automata ({} edges), {} requirements, {} bins, {} suites, {} tests",
        args.file.display(),
        program.name,
        program.events.len(),
        program.agents.len(),
        program.agents.iter().map(|a| a.plans.len()).sum::<usize>(),
        program.automata.len(),
        program.automata.iter().map(|a| a.edges.len()).sum::<usize>(),
        program.monitors.len(),
        program.coverage.crosses.iter().map(|c| c.bins.len()).sum::<usize>(),
        program.suites.len(),
        program.tests.len(),
    );
    Ok(Exit::Ok)
}
