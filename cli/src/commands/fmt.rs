//! `hrdsl fmt`: files in the one style of the language.

use std::{
    fs,
    path::{Path, PathBuf},
};

use hrdsl_compiler::format;
use hrdsl_source::{Diagnostic, SourceFiles, printable_line};

use crate::{color, exit::CommandExit, fault::CommandFault, files, project, render, terminal};

/// The text on stdin, among the paths.
const STDIN: &str = "-";

/// Write scenarios in the one style of the language.
///
/// Comments stay where they are. A file with faults in its syntax is not changed.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  hrdsl fmt\n  hrdsl fmt scenario.hri tests/\n  hrdsl fmt --check .\n  hrdsl fmt --diff scenario.hri\n  hrdsl fmt - < scenario.hri"
)]
pub struct FmtArgs {
    /// Files, folders (all `.hri` files in them), or `-` for stdin to stdout.
    #[arg(value_name = "PATH", default_value = ".")]
    paths: Vec<PathBuf>,
    /// Change nothing; list the files that would change, and exit with 1 if there are any.
    #[arg(long)]
    check: bool,
    /// Change nothing; show what would change.
    #[arg(long)]
    diff: bool,
}

/// How many files came out how.
#[derive(Default)]
struct FormatTally {
    changed: usize,
    unchanged: usize,
    /// With faults in their syntax.
    faulty: usize,
    /// Not to be read or written.
    failed: usize,
}

/// # Errors
/// A path that is not there, a folder that cannot be read.
pub fn run(args: &FmtArgs) -> Result<CommandExit, CommandFault> {
    let mut tally = FormatTally::default();
    let mut paths = Vec::new();
    for path in &args.paths {
        if path.as_os_str() == STDIN {
            stdin(args, &mut tally)?;
        } else {
            expand(path, &mut paths)?;
        }
    }
    paths.sort();
    paths.dedup();
    for path in &paths {
        if let Err(fault) = file(args, path, &mut tally) {
            terminal::say_line(format_args!("error: {fault}"));
            tally.failed += 1;
        }
    }
    if !paths.is_empty() {
        terminal::say_line(summary(&tally, args.check || args.diff));
    }
    Ok(exit(args, &tally))
}

fn exit(args: &FmtArgs, tally: &FormatTally) -> CommandExit {
    if tally.failed > 0 {
        CommandExit::Usage
    } else if tally.faulty > 0 || (args.check && tally.changed > 0) {
        CommandExit::Errors
    } else {
        CommandExit::Ok
    }
}

/// `3 files reformatted, 4 left unchanged`
fn summary(tally: &FormatTally, dry: bool) -> String {
    let files = |n: usize| format!("{n} file{}", if n == 1 { "" } else { "s" });
    let done = if dry { "would be reformatted" } else { "reformatted" };
    let mut text = format!("{} {done}, {} left unchanged", files(tally.changed), tally.unchanged);
    if tally.faulty > 0 {
        text += &format!(", {} with errors", tally.faulty);
    }
    if tally.failed > 0 {
        text += &format!(", {} failed", tally.failed);
    }
    text
}

// ── Texts ──

fn stdin(args: &FmtArgs, tally: &mut FormatTally) -> Result<(), CommandFault> {
    let text = files::read_stdin()?;
    let Some(formatted) = formatted("<stdin>", &text, tally) else { return Ok(()) };
    if args.check || args.diff {
        show(args, "<stdin>", &text, &formatted)
    } else {
        terminal::print_data(&formatted)
    }
}

fn file(args: &FmtArgs, path: &Path, tally: &mut FormatTally) -> Result<(), CommandFault> {
    let text = files::read_scenario(path)?;
    let name = path.display().to_string();
    let Some(formatted) = formatted(&name, &text, tally) else { return Ok(()) };
    if formatted == text {
        return Ok(());
    }
    if args.check || args.diff {
        return show(args, &name, &text, &formatted);
    }
    // Put in its place beside it, even a read-only file could be replaced.
    let readonly = fs::metadata(path).is_ok_and(|m| m.permissions().readonly());
    let written = if readonly {
        Err(format!("cannot write {}: it is read-only", terminal::shown(path)))
    } else {
        files::replace(path, &formatted)
    };
    written.inspect_err(|_| tally.changed -= 1)
}

/// The text in style, counted; of one with faults, its diagnostics are shown.
fn formatted(name: &str, text: &str, tally: &mut FormatTally) -> Option<String> {
    match format(text) {
        Ok(formatted) => {
            if formatted == text {
                tally.unchanged += 1;
            } else {
                tally.changed += 1;
            }
            Some(formatted)
        }
        Err(diagnostics) => {
            report(name, text, &diagnostics);
            tally.faulty += 1;
            None
        }
    }
}

fn report(name: &str, text: &str, diagnostics: &[Diagnostic]) {
    let mut files = SourceFiles::default();
    files.add(name, text);
    for diagnostic in diagnostics {
        terminal::say(render::diagnostic(&files, diagnostic));
    }
}

/// What would change: the name, or the difference.
fn show(args: &FmtArgs, name: &str, text: &str, formatted: &str) -> Result<(), CommandFault> {
    if text == formatted {
        return Ok(());
    }
    if args.diff {
        return terminal::print(&render::unified(name, text, formatted, color::stdout_has()));
    }
    terminal::print(&format!("{}\n", printable_line(name)))
}

// ── Files ──

/// The `.hri` files of a folder and the folders in it; any other path is a file by itself.
fn expand(path: &Path, found: &mut Vec<PathBuf>) -> Result<(), CommandFault> {
    if !path.is_dir() {
        found.push(path.to_owned());
        return Ok(());
    }
    let hidden = |p: &Path| p.file_name().is_some_and(|n| n.to_string_lossy().starts_with('.'));
    // What a link points to is elsewhere, and is formatted there.
    found.extend(project::walk(path)?.into_iter().filter(|p| !hidden(p) && !p.is_symlink()));
    Ok(())
}
