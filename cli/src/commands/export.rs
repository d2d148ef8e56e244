//! `hrdsl export`: networks of automata to the files of other tools.

use std::path::{Path, PathBuf};

use clap::Subcommand;
use hrdsl_compiler::CompilationResult;
use hrdsl_interop::{ExportObstacle, picture, tchecker, uppaal};
use hrdsl_ir::{Program, ta::Network};

use crate::{exit::CommandExit, fault::CommandFault, files, input, terminal};

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
pub struct ExportArgs {
    #[command(subcommand)]
    to: ExportFormat,
}

#[derive(Subcommand)]
enum ExportFormat {
    Uppaal(UppaalExportArgs),
    /// To TChecker's text format; each location gets the label `AUTOMATON_LOCATION`.
    #[command(after_help = "\
Examples:
  hrdsl export tchecker gate.hri -o gate.txt
  hrdsl export tchecker gate.hri | tck-reach -a covreach -l Train_cross")]
    Tchecker(PlainExportArgs),
    /// As a picture for Graphviz: the automata with their locations and edges.
    #[command(after_help = "\
Examples:
  hrdsl export dot gate.hri | dot -Tsvg > gate.svg")]
    Dot(PlainExportArgs),
    /// As a Mermaid state diagram, which many Markdown viewers draw.
    #[command(after_help = "\
Examples:
  hrdsl export mermaid gate.hri -o gate.mmd")]
    Mermaid(PlainExportArgs),
}

/// Of which scenario, and where to.
#[derive(clap::Args)]
struct PlainExportArgs {
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
struct UppaalExportArgs {
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
pub fn run(args: &ExportArgs) -> Result<CommandExit, CommandFault> {
    match &args.to {
        ExportFormat::Uppaal(args) => to_uppaal(args),
        ExportFormat::Tchecker(args) => plain(args, tchecker::export),
        ExportFormat::Dot(args) => plain(args, |program, network| Ok(picture::dot(program, network))),
        ExportFormat::Mermaid(args) => plain(args, |program, network| Ok(picture::mermaid(program, network))),
    }
}

fn plain(
    args: &PlainExportArgs,
    export: impl Fn(&Program, &Network) -> Result<String, Vec<ExportObstacle>>,
) -> Result<CommandExit, CommandFault> {
    let compilation = input::load(&args.file, &[])?;
    let Some(program) = input::report_errors(&args.file, &compilation) else {
        return Ok(CommandExit::Errors);
    };
    let index = network(program, args.network.as_deref(), &args.file.display().to_string())?;
    match export(program, &program.networks[index]) {
        Ok(text) => {
            write(args.out.as_deref(), &text)?;
            Ok(CommandExit::Ok)
        }
        Err(obstacles) => Ok(refused(&args.file, &compilation, &obstacles)),
    }
}

fn refused(file: &Path, compilation: &CompilationResult, obstacles: &[ExportObstacle]) -> CommandExit {
    said(compilation, obstacles, "error");
    terminal::say_line(format_args!(
        "{} cannot be exported: change the scenario, or export another network",
        terminal::shown(file)
    ));
    CommandExit::Errors
}

fn to_uppaal(args: &UppaalExportArgs) -> Result<CommandExit, CommandFault> {
    let compilation = input::load(&args.file, &[])?;
    let Some(program) = input::report_errors(&args.file, &compilation) else {
        return Ok(CommandExit::Errors);
    };
    let network = network(program, args.network.as_deref(), &args.file.display().to_string())?;
    match uppaal::export_with(program, network, &compilation.files) {
        Ok(exported) => {
            said(&compilation, &exported.left_out, "left out");
            if let Some(path) = &args.queries {
                files::write(path, &exported.queries)?;
            }
            write(args.out.as_deref(), &exported.text)?;
            Ok(CommandExit::Ok)
        }
        Err(faults) => Ok(refused(&args.file, &compilation, &faults)),
    }
}

fn said(compilation: &CompilationResult, all: &[ExportObstacle], word: &str) {
    for ExportObstacle { origin, message } in all {
        terminal::say_line(format_args!("{}: {word}: {message}", compilation.files.place(*origin)));
    }
}

/// To the file, or to stdout.
fn write(out: Option<&Path>, text: &str) -> Result<(), CommandFault> {
    match out {
        Some(path) => files::write(path, text),
        None => terminal::print_data(text),
    }
}

/// The index of the network of this name, or of the only one.
pub fn network(program: &Program, name: Option<&str>, file: &str) -> Result<usize, CommandFault> {
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
