//! `hrdsl export`: networks of automata to the files of other tools.

use std::path::PathBuf;

use clap::Subcommand;
use hrdsl_compiler::Compilation;
use hrdsl_export::{
    Obstacle,
    uppaal::{self, Exported},
};
use hrdsl_ir::Program;

use crate::{
    exit::Exit,
    input::{self, Fault},
};

/// Write a network of automata as a file of another tool.
///
/// What the other tool cannot say ends the export; all such things are listed with their places.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  hrdsl export uppaal gate.hri -o gate.xml
  hrdsl export uppaal gate.hri --network crossing --queries gate.q > gate.xml")]
pub struct Args {
    #[command(subcommand)]
    to: Tool,
}

#[derive(Subcommand)]
enum Tool {
    Uppaal(Uppaal),
}

/// To UPPAAL: the XML of version 4 and newer, with the network's queries.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  hrdsl export uppaal gate.hri -o gate.xml
  hrdsl export uppaal gate.hri --network crossing --queries gate.q > gate.xml")]
struct Uppaal {
    /// The scenario.
    #[arg(value_name = "FILE.hri")]
    file: PathBuf,
    /// The network; it may be left out if there is only one.
    #[arg(long, value_name = "NETWORK")]
    network: Option<String>,
    /// The file to write; otherwise the model goes to stdout.
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Write the queries to a file of their own, too.
    #[arg(long, value_name = "FILE")]
    queries: Option<PathBuf>,
}

/// # Errors
/// A file that cannot be read or written, a network that is not there.
pub fn run(args: &Args) -> Result<Exit, Fault> {
    match &args.to {
        Tool::Uppaal(args) => to_uppaal(args),
    }
}

fn to_uppaal(args: &Uppaal) -> Result<Exit, Fault> {
    let compilation = input::load(&args.file, &[])?;
    let Some(program) = input::report_errors(&args.file, &compilation) else { return Ok(Exit::Errors) };
    let network = network(program, args.network.as_deref(), &args.file.display().to_string())?;
    match uppaal::export(program, network) {
        Ok(exported) => {
            said(&compilation, &exported.left_out, "left out");
            write(args, &exported)?;
            Ok(Exit::Ok)
        }
        Err(faults) => {
            said(&compilation, &faults, "error");
            eprintln!(
                "{} cannot be exported: change the scenario, or export another network",
                args.file.display()
            );
            Ok(Exit::Errors)
        }
    }
}

fn said(compilation: &Compilation, all: &[Obstacle], word: &str) {
    for Obstacle { origin, message } in all {
        eprintln!("{}: {word}: {message}", compilation.files.place(*origin));
    }
}

fn write(args: &Uppaal, exported: &Exported) -> Result<(), Fault> {
    if let Some(path) = &args.queries {
        input::write(path, &exported.queries)?;
    }
    match &args.out {
        Some(path) => input::write(path, &exported.text),
        None => input::print(&exported.text),
    }
}

/// The index of the network of this name, or of the only one.
pub fn network(program: &Program, name: Option<&str>, file: &str) -> Result<usize, Fault> {
    let names: Vec<String> = program.networks.iter().map(|n| format!("`{}`", n.name)).collect();
    let known = names.join(", ");
    match name {
        Some(name) => program
            .networks
            .iter()
            .position(|n| n.name == name)
            .ok_or_else(|| format!("{file} has no network `{name}`: it has {known}")),
        None if names.is_empty() => {
            Err(format!("{file} has no network: add one, as in `network all = A | B`"))
        }
        None if names.len() == 1 => Ok(0),
        None => Err(format!("{file} has several networks ({known}): say which by `--network`")),
    }
}
