//! `hrdsl emit`: the data at every stage, as JSON.

use std::path::PathBuf;

use clap::ValueEnum;
use hrdsl_compiler::{CompilationResult, ast};
use hrdsl_interop::{
    automaton::{FormulaAutomaton, automaton_of},
    picture,
};
use hrdsl_ir::monitor::Monitor;
use serde::Serialize;

use crate::{exit::CommandExit, fault::CommandFault, input, terminal};

/// Print what the compiler makes of a scenario, at any stage, as JSON.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  hrdsl emit ast scenario.hri\n  hrdsl emit ta scenario.hri | jq '.automata[0].locations'\n  hrdsl emit monitors scenario.hri --dot | dot -Tsvg > monitors.svg"
)]
pub struct EmitArgs {
    /// Which stop.
    stage: EmitStage,
    /// The scenario.
    file: PathBuf,
    /// Of monitors: draw them, in DOT (Graphviz).
    #[arg(long)]
    dot: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum EmitStage {
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
pub fn run(args: &EmitArgs) -> Result<CommandExit, CommandFault> {
    let compilation = input::load(&args.file, &[])?;
    let has_errors = input::report(&compilation).is_none();
    if args.dot {
        if !matches!(args.stage, EmitStage::Monitors) {
            return Err("only monitors are drawn: write `hrdsl emit monitors FILE --dot`".to_owned());
        }
        let Some(program) = &compilation.program else { return Ok(CommandExit::Errors) };
        terminal::print_data(&picture::monitors_dot(program))?;
        return Ok(CommandExit::Ok);
    }
    let Some(text) = emit(args.stage, &compilation) else { return Ok(CommandExit::Errors) };
    terminal::print_data(&(text? + "\n"))?;
    Ok(if has_errors { CommandExit::Errors } else { CommandExit::Ok })
}

/// What a formula is as an automaton, or why it is none.
#[derive(Serialize)]
struct FormulaEmission {
    requirement: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    automaton: Option<FormulaAutomaton>,
    #[serde(skip_serializing_if = "Option::is_none")]
    obstacle: Option<String>,
}

impl FormulaEmission {
    fn of(monitor: &Monitor) -> Option<Self> {
        let found = automaton_of(monitor.formula.as_ref()?);
        let requirement = monitor.name.clone();
        Some(match found {
            Ok(automaton) => Self { requirement, automaton: Some(automaton), obstacle: None },
            Err(obstacle) => Self { requirement, automaton: None, obstacle: Some(obstacle) },
        })
    }
}

/// `None` if the scenario's errors keep it from getting that far.
fn emit(stage: EmitStage, compilation: &CompilationResult) -> Option<Result<String, CommandFault>> {
    #[derive(Serialize)]
    struct EmittedAutomata<'a> {
        shared: &'a [hrdsl_ir::ta::AutomatonVar],
        automata: &'a [hrdsl_ir::ta::Automaton],
        networks: &'a [hrdsl_ir::ta::Network],
    }
    #[derive(Serialize)]
    struct EmittedMonitors<'a> {
        monitors: &'a [Monitor],
        /// Those of requirements that are formulas.
        formula_automata: Vec<FormulaEmission>,
        assumptions: &'a [hrdsl_ir::monitor::Assumption],
    }
    #[derive(Serialize)]
    struct EmittedWorld<'a> {
        world: &'a Option<hrdsl_ir::world::World>,
        signals: &'a [hrdsl_ir::world::Signal],
        systems: &'a [hrdsl_ir::system::SystemUnderTest],
    }
    let program = compilation.program.as_ref();
    match stage {
        EmitStage::Ast => {
            Some(json(&compilation.ast.iter().map(AsRef::as_ref).collect::<Vec<&ast::FileSyntax>>()))
        }
        EmitStage::Scenario => Some(json(compilation.scenario.as_ref()?)),
        EmitStage::Bdi => Some(json(&program?.agents)),
        EmitStage::Ta => {
            let p = program?;
            Some(json(&EmittedAutomata { shared: &p.shared, automata: &p.automata, networks: &p.networks }))
        }
        EmitStage::Monitors => {
            let p = program?;
            let formula_automata = p.monitors.iter().filter_map(FormulaEmission::of).collect();
            Some(json(&EmittedMonitors {
                monitors: &p.monitors,
                formula_automata,
                assumptions: &p.assumptions,
            }))
        }
        EmitStage::Coverage => Some(json(&program?.coverage)),
        EmitStage::World => {
            let p = program?;
            Some(json(&EmittedWorld { world: &p.world, signals: &p.signals, systems: &p.systems }))
        }
    }
}

fn json<T: Serialize>(value: &T) -> Result<String, CommandFault> {
    serde_json::to_string_pretty(value).map_err(|e| format!("cannot print: {e}"))
}
