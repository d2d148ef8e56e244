//! `hrdsl check`: every name, type, unit and role of scenarios and their tests.

use std::path::PathBuf;

use clap::ValueEnum;
use hrdsl_source::{Diagnostic, DiagnosticCode, REGISTRY, Severity, printable_line};
use indexmap::IndexSet;

use crate::{
    color,
    exit::CommandExit,
    fault::CommandFault,
    files, fix, input,
    project::{CheckedProject, CheckedUnit},
    render, terminal,
};

/// Check scenarios and their tests: every name, type, unit and role.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  hrdsl check examples/handover/scenario.hri
  hrdsl check scenario.hri tests/*.hri
  hrdsl check scenario.hri with_rospy/system.hri
  hrdsl check . --deny warnings
  hrdsl check scenario.hri --diff
  hrdsl check scenario.hri --fix
  hrdsl check --format sarif . > hrdsl.sarif
  hrdsl check - < scenario.hri")]
pub struct CheckArgs {
    /// Scenarios, files of tests, folders to search for `.hri` files; `-` is standard input.
    #[arg(required = true, value_name = "PATH")]
    paths: Vec<PathBuf>,
    /// How to say what was found.
    #[arg(long, value_enum, default_value_t)]
    format: CheckFormat,
    /// Make warnings errors: all (`warnings`), or those of a code (`HR0403`); may be given several times.
    #[arg(long, value_name = "WHAT", value_parser = denied)]
    deny: Vec<DeniedFindings>,
    /// The most findings of a file that are shown to people; 0: all of them.
    #[arg(long, value_name = "N", default_value_t = render::SHOWN)]
    max_findings: usize,
    /// Apply the fixes that are certain to the files.
    #[arg(long)]
    fix: bool,
    /// Show what --fix would change, and change nothing.
    #[arg(long, conflicts_with_all = ["fix", "format"])]
    diff: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum CheckFormat {
    /// Text with pieces of source, on stderr.
    #[default]
    Human,
    /// One JSON document on stdout.
    Json,
    /// SARIF 2.1.0 on stdout.
    Sarif,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum DeniedFindings {
    Warnings,
    Code(DiagnosticCode),
}

fn denied(text: &str) -> Result<DeniedFindings, String> {
    if text == "warnings" {
        return Ok(DeniedFindings::Warnings);
    }
    let found = REGISTRY.iter().find(|i| i.code.to_string().eq_ignore_ascii_case(text));
    found
        .map(|i| DeniedFindings::Code(i.code))
        .ok_or_else(|| "it is `warnings` or a code such as `HR0403`; `hrdsl explain` lists them".to_owned())
}

/// # Errors
/// A file that cannot be read or written, or tests without a scenario.
pub fn run(args: &CheckArgs) -> Result<CommandExit, CommandFault> {
    let mut project = CheckedProject::open(&args.paths)?;
    if args.fix {
        apply_fixes(&mut project)?;
    }
    let checked = check(&project, &args.deny);
    match args.format {
        CheckFormat::Human => {
            show(&checked, args.max_findings);
            let text = if args.diff { difference(&project) } else { summary(&project, &checked) };
            terminal::print(&text)?;
        }
        CheckFormat::Json => terminal::print_data(&render::json(&project, &checked)?)?,
        CheckFormat::Sarif => terminal::print_data(&render::sarif(&project, &checked)?)?,
    }
    let failed = checked.iter().any(|c| c.program().is_none());
    // The process ends now: to take all of it apart first would be a tenth of the time.
    std::mem::forget((project, checked));
    Ok(if failed { CommandExit::Errors } else { CommandExit::Ok })
}

/// Compiles every unit. What is said of a module that several units use is said once.
fn check(project: &CheckedProject, deny: &[DeniedFindings]) -> Vec<CheckedUnit> {
    let mut seen = IndexSet::new();
    let mut checked = Vec::new();
    for unit in &project.units {
        let mut compilation = project.compile(unit);
        for diagnostic in &mut compilation.diagnostics {
            deny.iter().for_each(|deny| promote(diagnostic, *deny));
        }
        let files = &compilation.files;
        compilation.diagnostics.retain(|d| {
            let name = files.get(d.span().file).map(|f| f.name.clone());
            seen.insert((name, d.span().start, d.span().end, d.code, d.message.clone()))
        });
        checked.push(CheckedUnit { unit: unit.clone(), compilation });
    }
    checked
}

/// A denied warning is an error.
fn promote(diagnostic: &mut Diagnostic, deny: DeniedFindings) {
    let meant = match deny {
        DeniedFindings::Warnings => true,
        DeniedFindings::Code(code) => diagnostic.code == code,
    };
    if meant {
        diagnostic.severity = Severity::Error;
    }
}

/// Fixes the files, and says how on stderr.
fn apply_fixes(project: &mut CheckedProject) -> Result<(), CommandFault> {
    if project.sources.iter().any(|s| s.path.is_none()) {
        return Err("`--fix` cannot change standard input; `--diff` shows the changes".to_owned());
    }
    let before = project.clone();
    let applied = fix::apply(project);
    let mut files = 0;
    for (old, new) in before.sources.iter().zip(&project.sources).filter(|(a, b)| a.text() != b.text()) {
        if let Some(path) = &old.path {
            files::replace(path, new.text())?;
            files += 1;
        }
    }
    for fix in &applied {
        terminal::say_line(format_args!("fixed {}: {}", fix.place, fix.title));
    }
    let plural = |n: usize, one: &str, many: &str| format!("{n} {}", if n == 1 { one } else { many });
    if applied.is_empty() {
        terminal::say_line("nothing to fix");
        return Ok(());
    }
    terminal::say_line(format_args!(
        "{} in {}",
        plural(applied.len(), "fix", "fixes"),
        plural(files, "file", "files")
    ));
    Ok(())
}

fn difference(project: &CheckedProject) -> String {
    let mut fixed = project.clone();
    fix::apply(&mut fixed);
    let pairs = project.sources.iter().zip(&fixed.sources);
    pairs.map(|(old, new)| render::unified(&old.name, old.text(), new.text(), color::stdout_has())).collect()
}

/// What was found, on stderr: of each file so much.
fn show(checked: &[CheckedUnit], most: usize) {
    let (mut errors, mut warnings) = (0, 0);
    for CheckedUnit { compilation, .. } in checked {
        let all: Vec<&Diagnostic> = compilation.diagnostics.iter().collect();
        input::show(&compilation.files, &all, most);
        let wrong = all.iter().filter(|d| d.is_error()).count();
        (errors, warnings) = (errors + wrong, warnings + all.len() - wrong);
    }
    if errors + warnings > 0 {
        terminal::say_line(render::totals(errors, warnings));
    }
}

/// A line for each scenario that is well formed.
fn summary(project: &CheckedProject, checked: &[CheckedUnit]) -> String {
    let line = |c: &CheckedUnit| {
        let program = c.program()?;
        let name = printable_line(&project.sources[c.unit.head].name);
        if c.compilation.is_module() {
            let shared = c.compilation.declarations();
            let plural = if shared == 1 { "" } else { "s" };
            return Some(format!("{name}: module is well formed: {shared} declaration{plural}\n"));
        }
        let counts = [
            (program.events.len(), "event or stimulus", "events and stimuli"),
            (program.agents.len(), "agent", "agents"),
            (program.agents.iter().map(|a| a.plans.len()).sum(), "plan", "plans"),
            (program.automata.len(), "automaton", "automata"),
            (program.automata.iter().map(|a| a.edges.len()).sum(), "edge", "edges"),
            (program.monitors.len(), "requirement", "requirements"),
            (program.coverage.crosses.iter().map(|c| c.bins.len()).sum(), "bin", "bins"),
            (program.suites.len(), "suite", "suites"),
            (program.tests.len(), "test", "tests"),
        ];
        let counts: Vec<String> = counts
            .into_iter()
            .filter(|(n, _, _)| *n > 0)
            .map(|(n, one, many)| format!("{n} {}", if n == 1 { one } else { many }))
            .collect();
        let scenario = &program.name;
        if counts.is_empty() {
            return Some(format!("{name}: scenario `{scenario}` is well formed, and has no behaviour yet\n"));
        }
        Some(format!("{name}: scenario `{scenario}` is well formed: {}\n", counts.join(", ")))
    };
    checked.iter().filter_map(line).collect()
}
