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
mod exit;
mod fault;
mod files;
mod fix;
mod input;
mod installing;
mod project;
mod quantity;
mod reach;
mod render;
mod results_folder;
mod terminal;

use std::{path::PathBuf, process::ExitCode};

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};

use crate::exit::Exit;

/// Test the code of robots that work with people.
///
/// One `.hri` file says who takes part (agents, automata), what must hold (requirements), what must be seen (coverage),
/// and what it runs against (world, system under test).
#[derive(Parser)]
#[command(name = "hrdsl", version, max_term_width = 100, after_help = exit::HELP, subcommand_required = true)]
struct Cli {
    /// When to use colours.
    #[arg(long, global = true, value_enum, value_name = "WHEN", default_value_t)]
    color: color::Choice,
    /// Let the files below this folder be named by others (`use "…"`, `include`), besides those of the project; may be given
    /// several times.
    #[arg(long, global = true, value_name = "DIR")]
    allow_path: Vec<PathBuf>,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Check(commands::check::Args),
    Completions(commands::completions::Args),
    Emit(commands::emit::Args),
    Explain(commands::explain::Args),
    Export(commands::export::Args),
    Fmt(commands::fmt::Args),
    Gen(commands::generate::Args),
    Import(commands::import::Args),
    Inspect(commands::inspect::Args),
    Judge(commands::judge::Args),
    Man(commands::man::Args),
    New(commands::new::Args),
    Prove(commands::prove::Args),
    Report(commands::report::Args),
    Sim(commands::sim::Args),
}

fn main() -> ExitCode {
    let mut args = std::env::args_os().skip(1);
    if args.next().is_some_and(|word| word == commands::sim::SUPERVISE) {
        return hrdsl_runtime::campaign::supervise(&args.collect::<Vec<_>>());
    }
    let choice = color::from_args(std::env::args_os());
    let matches = Cli::command().color(choice.into()).get_matches();
    let cli = Cli::from_arg_matches(&matches).unwrap_or_else(|e| e.exit());
    color::choose(cli.color);
    let allowed = reach::allow(&cli.allow_path);
    let result = allowed.and_then(|()| match cli.command {
        Command::Check(args) => commands::check::run(&args),
        Command::Completions(args) => commands::completions::run(&args, Cli::command()),
        Command::Emit(args) => commands::emit::run(&args),
        Command::Explain(args) => commands::explain::run(&args),
        Command::Export(args) => commands::export::run(&args),
        Command::Fmt(args) => commands::fmt::run(&args),
        Command::Gen(args) => commands::generate::run(&args),
        Command::Import(args) => commands::import::run(&args),
        Command::Inspect(args) => commands::inspect::run(&args),
        Command::Judge(args) => commands::judge::run(&args),
        Command::Man(args) => commands::man::run(&args, Cli::command()),
        Command::New(args) => commands::new::run(&args),
        Command::Prove(args) => commands::prove::run(&args),
        Command::Report(args) => commands::report::run(&args),
        Command::Sim(args) => commands::sim::run(&args),
    });
    result
        .unwrap_or_else(|fault| {
            terminal::say_line(format_args!("error: {fault}"));
            Exit::Usage
        })
        .into()
}
