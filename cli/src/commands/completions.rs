//! `hrdsl completions`: what a shell needs to complete hrdsl's commands and options.

use clap_complete::{Shell, generate};

use crate::{exit::CommandExit, fault::CommandFault, terminal};

/// Print a shell's completions of hrdsl's commands and options.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  hrdsl completions bash > ~/.local/share/bash-completion/completions/hrdsl
  hrdsl completions zsh > ~/.zfunc/_hrdsl
  hrdsl completions fish > ~/.config/fish/completions/hrdsl.fish")]
pub struct CompletionsArgs {
    /// The shell.
    shell: Shell,
}

/// # Errors
/// What is wrong with stdout.
pub fn run(args: &CompletionsArgs, mut command: clap::Command) -> Result<CommandExit, CommandFault> {
    let mut script = Vec::new();
    generate(args.shell, &mut command, "hrdsl", &mut script);
    terminal::print_data(&String::from_utf8_lossy(&script))?;
    Ok(CommandExit::Ok)
}
