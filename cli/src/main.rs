//! `hrdsl`, the command line: one file for each command; the only place with clap, stdout and files.

mod commands;
mod exit;
mod input;
mod render;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::exit::Exit;

/// Test the code of robots that work with people.
///
/// One `.hri` file says who takes part (agents, automata), what must hold (requirements), what must be seen (coverage),
/// and what it runs against (world, system under test).
#[derive(Parser)]
#[command(name = "hrdsl", version, max_term_width = 100, after_help = EXIT_CODES, subcommand_required = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Check(commands::check::Args),
    Emit(commands::emit::Args),
    Gen(commands::generate::Args),
    Sim(commands::sim::Args),
}

const EXIT_CODES: &str = "\
Exit codes:
  0  all is well
  1  the scenario has errors
  2  the command line is wrong, or a file cannot be read or written
  3  `sim`: a requirement was violated, or a test broke off (see --exit-zero)";

fn main() -> ExitCode {
    let result = match Cli::parse().command {
        Command::Check(args) => commands::check::run(&args),
        Command::Emit(args) => commands::emit::run(&args),
        Command::Gen(args) => commands::generate::run(&args),
        Command::Sim(args) => commands::sim::run(&args),
    };
    result
        .unwrap_or_else(|fault| {
            eprintln!("error: {fault}");
            Exit::Usage
        })
        .into()
}
