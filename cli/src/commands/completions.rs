//! `hrdsl completions`: what a shell needs to complete hrdsl's commands and options.

use clap_complete::{Shell, generate};

use crate::{exit::Exit, fault::Fault, terminal};

/// Print a shell's completions of hrdsl's commands and options.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  hrdsl completions bash > ~/.local/share/bash-completion/completions/hrdsl
  hrdsl completions zsh > ~/.zfunc/_hrdsl
  hrdsl completions fish > ~/.config/fish/completions/hrdsl.fish")]
pub struct Args {
    /// The shell.
    shell: Shell,
}

/// # Errors
/// What is wrong with stdout.
pub fn run(args: &Args, mut command: clap::Command) -> Result<Exit, Fault> {
    let mut script = Vec::new();
    generate(args.shell, &mut command, "hrdsl", &mut script);
    terminal::print_data(&String::from_utf8_lossy(&script))?;
    Ok(Exit::Ok)
}
