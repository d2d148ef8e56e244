//! `hrdsl emit`: the data at every stage, as JSON.

use std::path::PathBuf;

use clap::ValueEnum;
use hrdsl_compiler::Compilation;
use serde::Serialize;

use crate::{exit::Exit, fault::Fault, input, terminal};

/// Print what the compiler makes of a scenario, at any stage, as JSON.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  hrdsl emit ast scenario.hri\n  hrdsl emit ta scenario.hri | jq '.automata[0].locations'"
)]
pub struct Args {
    /// Which stop.
    stage: Product,
    /// The scenario.
    file: PathBuf,
}

#[derive(Clone, Copy, ValueEnum)]
enum Product {
    /// What was written, before any name is looked up.
    Ast,
    /// What was meant: names resolved, expressions typed.
    Scenario,
    /// The agents of the program.
    Bdi,
    /// The timed automata and networks of the program.
    Ta,
    /// The monitor automata of the requirements, and the assumptions.
    Monitors,
    /// Coverpoints and crosses.
    Coverage,
    /// Bodies, joints, devices, rules and signals.
    World,
}

/// # Errors
/// A file that cannot be read.
pub fn run(args: &Args) -> Result<Exit, Fault> {
    let compilation = input::load(&args.file, &[])?;
    let has_errors = input::report(&compilation).is_none();
    let Some(text) = emit(args.stage, &compilation) else { return Ok(Exit::Errors) };
    terminal::print_data(&(text? + "\n"))?;
    Ok(if has_errors { Exit::Errors } else { Exit::Ok })
}

/// `None` if the scenario's errors keep it from getting that far.
fn emit(stage: Product, compilation: &Compilation) -> Option<Result<String, Fault>> {
    #[derive(Serialize)]
    struct Ta<'a> {
        shared: &'a [hrdsl_ir::ta::Var],
        automata: &'a [hrdsl_ir::ta::Automaton],
        networks: &'a [hrdsl_ir::ta::Network],
    }
    #[derive(Serialize)]
    struct Monitors<'a> {
        monitors: &'a [hrdsl_ir::monitor::Monitor],
        assumptions: &'a [hrdsl_ir::monitor::Assumption],
    }
    #[derive(Serialize)]
    struct World<'a> {
        world: &'a Option<hrdsl_ir::world::World>,
        signals: &'a [hrdsl_ir::world::Signal],
        system: &'a Option<hrdsl_ir::system::System>,
    }
    let program = compilation.program.as_ref();
    match stage {
        Product::Ast => Some(json(&compilation.ast)),
        Product::Scenario => Some(json(compilation.scenario.as_ref()?)),
        Product::Bdi => Some(json(&program?.agents)),
        Product::Ta => {
            let p = program?;
            Some(json(&Ta { shared: &p.shared, automata: &p.automata, networks: &p.networks }))
        }
        Product::Monitors => {
            let p = program?;
            Some(json(&Monitors { monitors: &p.monitors, assumptions: &p.assumptions }))
        }
        Product::Coverage => Some(json(&program?.coverage)),
        Product::World => {
            let p = program?;
            Some(json(&World { world: &p.world, signals: &p.signals, system: &p.system }))
        }
    }
}

fn json<T: Serialize>(value: &T) -> Result<String, Fault> {
    serde_json::to_string_pretty(value).map_err(|e| format!("cannot print: {e}"))
}
