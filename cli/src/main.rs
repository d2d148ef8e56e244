//! `hrdsl`, the command line: one file for each command; the only place with clap and stdout, and with the files of
//! scenarios and results.
#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]
#![warn(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "terminal.rs prints, and lets nothing through that steers"
)]

mod color;
mod commands;
mod covered_files;
mod edge_sources;
mod exit;
mod fault;
mod files;
mod fix;
mod hulls;
mod input;
mod installing;
mod interrupt;
mod observation;
mod project;
mod quantity;
mod reach;
mod recorded_run;
mod render;
mod results_folder;
mod terminal;

use std::{path::PathBuf, process::ExitCode};

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};

use hrdsl_runtime::campaign::{InternalError, guarded, record_panics};

use crate::exit::CommandExit;

/// Test the code of robots that work with people.
///
/// One `.hri` file says who takes part (agents, automata), what must hold (requirements), what must be seen (coverage),
/// and what it runs against (world, system under test).
#[derive(Parser)]
#[command(name = "hrdsl", version, max_term_width = 100, after_help = exit::HELP, subcommand_required = true)]
struct CommandLine {
    /// When to use colours.
    #[arg(long, global = true, value_enum, value_name = "WHEN", default_value_t)]
    color: color::ColorArg,
    /// Let the files below this folder be named by others (`use "…"`, `include`), besides those of the project; may be given
    /// several times.
    #[arg(long, global = true, value_name = "DIR")]
    allow_path: Vec<PathBuf>,
    #[command(subcommand)]
    command: TopLevelCommand,
}

#[derive(Subcommand)]
enum TopLevelCommand {
    Calibrate(commands::calibrate::CalibrateArgs),
    Check(commands::check::CheckArgs),
    Completions(commands::completions::CompletionsArgs),
    Conformance(commands::conformance::ConformanceArgs),
    Emit(commands::emit::EmitArgs),
    Explain(commands::explain::ExplainArgs),
    Export(commands::export::ExportArgs),
    Fmt(commands::fmt::FmtArgs),
    Gen(commands::generate::GenerateArgs),
    Import(commands::import::ImportArgs),
    Inspect(commands::inspect::InspectArgs),
    Judge(commands::judge::JudgeArgs),
    Man(commands::man::ManArgs),
    Mutate(commands::mutate::MutateArgs),
    New(commands::new::NewArgs),
    Prove(commands::prove::ProveArgs),
    Report(commands::report::ReportArgs),
    Run(commands::run::RunArgs),
    Sim(commands::sim::SimArgs),
    Step(commands::step::StepArgs),
    View(commands::view::ViewArgs),
}

fn main() -> ExitCode {
    record_panics();
    guarded(run).unwrap_or_else(|fault| internal_error(&fault))
}

fn internal_error(fault: &InternalError) -> ExitCode {
    terminal::say_line(format_args!(
        "{fault}\n  This is a fault of hrdsl {}, not of your files. Please report it with this line, the command and the files.",
        env!("CARGO_PKG_VERSION")
    ));
    CommandExit::Internal.into()
}

fn run() -> ExitCode {
    let mut args = std::env::args_os().skip(1);
    if args.next().is_some_and(|word| word == commands::campaign::SUPERVISE) {
        return hrdsl_runtime::campaign::supervise(&args.collect::<Vec<_>>());
    }
    let choice = color::from_args(std::env::args_os());
    let matches = CommandLine::command().color(choice.into()).get_matches();
    let cli = CommandLine::from_arg_matches(&matches).unwrap_or_else(|e| e.exit());
    color::choose(cli.color);
    let allowed = reach::allow(&cli.allow_path);
    let result = allowed.and_then(|()| match cli.command {
        TopLevelCommand::Calibrate(args) => commands::calibrate::run(&args),
        TopLevelCommand::Check(args) => commands::check::run(&args),
        TopLevelCommand::Completions(args) => commands::completions::run(&args, CommandLine::command()),
        TopLevelCommand::Conformance(args) => commands::conformance::run(&args),
        TopLevelCommand::Emit(args) => commands::emit::run(&args),
        TopLevelCommand::Explain(args) => commands::explain::run(&args),
        TopLevelCommand::Export(args) => commands::export::run(&args),
        TopLevelCommand::Fmt(args) => commands::fmt::run(&args),
        TopLevelCommand::Gen(args) => commands::generate::run(&args),
        TopLevelCommand::Import(args) => commands::import::run(&args),
        TopLevelCommand::Inspect(args) => commands::inspect::run(&args),
        TopLevelCommand::Judge(args) => commands::judge::run(&args),
        TopLevelCommand::Man(args) => commands::man::run(&args, CommandLine::command()),
        TopLevelCommand::Mutate(args) => commands::mutate::run(&args),
        TopLevelCommand::New(args) => commands::new::run(&args),
        TopLevelCommand::Prove(args) => commands::prove::run(&args),
        TopLevelCommand::Report(args) => commands::report::run(&args),
        TopLevelCommand::Run(args) => commands::run::run(&args),
        TopLevelCommand::Sim(args) => commands::sim::run(&args),
        TopLevelCommand::Step(args) => commands::step::run(&args),
        TopLevelCommand::View(args) => commands::view::run(&args),
    });
    result
        .unwrap_or_else(|fault| {
            terminal::say_line(format_args!("error: {fault}"));
            CommandExit::Usage
        })
        .into()
}
