//! `hrdsl export`: networks of automata to the files of other tools.

use std::path::{Path, PathBuf};

use clap::Subcommand;
use hrdsl_compiler::Compilation;
use hrdsl_interop::{Obstacle, picture, tchecker, uppaal};
use hrdsl_ir::{Program, ta::Network};

use crate::{exit::Exit, fault::Fault, files, input, terminal};

/// Write a network of automata as a file of another tool.
///
/// What the other tool cannot say ends the export; all such things are listed with their places.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  hrdsl export uppaal gate.hri -o gate.xml
  hrdsl export uppaal gate.hri --network crossing --queries gate.q > gate.xml
  hrdsl export tchecker gate.hri -o gate.txt
  hrdsl export dot gate.hri | dot -Tsvg > gate.svg")]
pub struct Args {
    #[command(subcommand)]
    to: Tool,
}

#[derive(Subcommand)]
enum Tool {
    Uppaal(Uppaal),
    /// To TChecker's text format; each location gets the label `AUTOMATON_LOCATION`.
    #[command(after_help = "\
Examples:
  hrdsl export tchecker gate.hri -o gate.txt
  hrdsl export tchecker gate.hri | tck-reach -a covreach -l Train_cross")]
    Tchecker(Plain),
    /// As a picture for Graphviz: the automata with their locations and edges.
    #[command(after_help = "\
Examples:
  hrdsl export dot gate.hri | dot -Tsvg > gate.svg")]
    Dot(Plain),
    /// As a Mermaid state diagram, which many Markdown viewers draw.
    #[command(after_help = "\
Examples:
  hrdsl export mermaid gate.hri -o gate.mmd")]
    Mermaid(Plain),
}

/// Of which scenario, and where to.
#[derive(clap::Args)]
struct Plain {
    /// The scenario.
    #[arg(value_name = "FILE.hri")]
    file: PathBuf,
    /// The network; it may be left out if there is only one.
    #[arg(long, value_name = "NETWORK")]
    network: Option<String>,
    /// The file to write; otherwise the text goes to stdout.
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
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
        Tool::Tchecker(args) => plain(args, tchecker::export),
        Tool::Dot(args) => plain(args, |program, network| Ok(picture::dot(program, network))),
        Tool::Mermaid(args) => plain(args, |program, network| Ok(picture::mermaid(program, network))),
    }
}

fn plain(
    args: &Plain,
    export: impl Fn(&Program, &Network) -> Result<String, Vec<Obstacle>>,
) -> Result<Exit, Fault> {
    let compilation = input::load(&args.file, &[])?;
    let Some(program) = input::report_errors(&args.file, &compilation) else { return Ok(Exit::Errors) };
    let index = network(program, args.network.as_deref(), &args.file.display().to_string())?;
    match export(program, &program.networks[index]) {
        Ok(text) => {
            write(args.out.as_deref(), &text)?;
            Ok(Exit::Ok)
        }
        Err(obstacles) => Ok(refused(&args.file, &compilation, &obstacles)),
    }
}

fn refused(file: &Path, compilation: &Compilation, obstacles: &[Obstacle]) -> Exit {
    said(compilation, obstacles, "error");
    terminal::say_line(format_args!(
        "{} cannot be exported: change the scenario, or export another network",
        terminal::shown(file)
    ));
    Exit::Errors
}

fn to_uppaal(args: &Uppaal) -> Result<Exit, Fault> {
    let compilation = input::load(&args.file, &[])?;
    let Some(program) = input::report_errors(&args.file, &compilation) else { return Ok(Exit::Errors) };
    let network = network(program, args.network.as_deref(), &args.file.display().to_string())?;
    match uppaal::export(program, network) {
        Ok(exported) => {
            said(&compilation, &exported.left_out, "left out");
            if let Some(path) = &args.queries {
                files::write(path, &exported.queries)?;
            }
            write(args.out.as_deref(), &exported.text)?;
            Ok(Exit::Ok)
        }
        Err(faults) => Ok(refused(&args.file, &compilation, &faults)),
    }
}

fn said(compilation: &Compilation, all: &[Obstacle], word: &str) {
    for Obstacle { origin, message } in all {
        terminal::say_line(format_args!("{}: {word}: {message}", compilation.files.place(*origin)));
    }
}

/// To the file, or to stdout.
fn write(out: Option<&Path>, text: &str) -> Result<(), Fault> {
    match out {
        Some(path) => files::write(path, text),
        None => terminal::print_data(text),
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
