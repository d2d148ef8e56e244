//! `hrdsl man`: the manual pages, made from the same words as `--help`.

use std::path::PathBuf;

use clap_mangen::Man;

use crate::{exit::CommandExit, fault::CommandFault, files, terminal};

/// Print hrdsl's manual page, or write one for each command.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  hrdsl man | man -l -
  hrdsl man --dir ~/.local/share/man/man1")]
pub struct ManArgs {
    /// The folder to write a page for each command to.
    #[arg(long, value_name = "DIR")]
    dir: Option<PathBuf>,
}

/// # Errors
/// A file that cannot be written.
pub fn run(args: &ManArgs, command: clap::Command) -> Result<CommandExit, CommandFault> {
    let mut command = command.disable_help_subcommand(true);
    command.build();
    let Some(dir) = &args.dir else {
        terminal::print_data(&page(&man(command))?)?;
        return Ok(CommandExit::Ok);
    };
    let commands = command.get_subcommands().cloned().collect::<Vec<_>>();
    for command in std::iter::once(command).chain(commands) {
        let man = man(command);
        let path = dir.join(man.get_filename());
        files::write(&path, &page(&man)?)?;
        terminal::print(&format!("{}\n", terminal::shown(&path)))?;
    }
    Ok(CommandExit::Ok)
}

fn man(command: clap::Command) -> Man {
    Man::new(command).source(concat!("hrdsl ", env!("CARGO_PKG_VERSION"))).manual("hrdsl")
}

fn page(man: &Man) -> Result<String, CommandFault> {
    let mut bytes = Vec::new();
    man.render(&mut bytes).map_err(|e| format!("cannot make the page: {e}"))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
