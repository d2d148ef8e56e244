//! Scenarios as they are given to commands: compiled with their tests, and what is wrong with them said.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

use hrdsl_compiler::{CompilationResult, InputFile, compile_beside};
use hrdsl_ir::{Program, system::SystemUnderTest};
use hrdsl_source::{Diagnostic, FileId, SourceFiles, printable_line};

use crate::{
    fault::CommandFault,
    files::read_scenario,
    project::{SourceKind, kind_of},
    reach::DiskModules,
    render, terminal,
};

/// The table of interfaces that the programs of a system can use, as JSON; empty without a middleware.
///
/// # Errors
/// None that is known: the table holds nothing that JSON cannot say.
pub fn interface_table(
    compilation: &CompilationResult,
    system: &SystemUnderTest,
) -> Result<String, CommandFault> {
    let table = system.binding.as_ref().and_then(|binding| compilation.interface_table(binding.kind));
    let text = table.map(|table| serde_json::to_string(&table)).transpose();
    Ok(text.map_err(|e| e.to_string())?.unwrap_or_default())
}

/// Compiles a scenario and files of tests; a folder stands for the `.hri` files in it.
///
/// # Errors
/// A file that cannot be read.
pub fn load(scenario: &Path, tests: &[PathBuf]) -> Result<CompilationResult, CommandFault> {
    load_beside(scenario, tests, &[])
}

/// The same, with files that the scenario is to use besides, by their paths from its folder.
///
/// # Errors
/// The same.
pub fn load_beside(
    scenario: &Path,
    tests: &[PathBuf],
    beside: &[&str],
) -> Result<CompilationResult, CommandFault> {
    load_with(scenario, tests, beside, "")
}

/// The same, with more text at the end of the scenario.
///
/// # Errors
/// The same.
pub fn load_with(
    scenario: &Path,
    tests: &[PathBuf],
    beside: &[&str],
    more: &str,
) -> Result<CompilationResult, CommandFault> {
    let text = read_scenario(scenario)? + more;
    let name = scenario.display().to_string();
    let mut files = Vec::new();
    for path in tests {
        for file in expand(path)? {
            files.push((file.display().to_string(), read_scenario(&file)?));
        }
    }
    let tests: Vec<InputFile<'_>> = files.iter().map(|(name, text)| InputFile { name, text }).collect();
    let (input, modules) = (InputFile { name: &name, text: &text }, DiskModules::of(Some(scenario)));
    Ok(compile_beside(input, &tests, beside, &modules))
}

/// Compiles a scenario of which recordings are looked at; and the meshes that are not there, for which something stands, as poses and verdicts do
/// not depend on them.
///
/// # Errors
/// A file that cannot be read.
pub fn load_to_look(scenario: &Path) -> Result<(CompilationResult, Vec<String>), CommandFault> {
    let text = read_scenario(scenario)?;
    let name = scenario.display().to_string();
    let (input, modules) = (InputFile { name: &name, text: &text }, DiskModules::to_look(Some(scenario)));
    let compilation = compile_beside(input, &[], &[], &modules);
    Ok((compilation, modules.gone()))
}

fn expand(path: &Path) -> Result<Vec<PathBuf>, CommandFault> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let entries = fs::read_dir(path).map_err(|e| format!("cannot read {}: {e}", terminal::shown(path)))?;
    let mut files: Vec<PathBuf> = entries
        .filter_map(Result::ok)
        .map(|e| e.path())
        .filter(|p| p.extension().is_some_and(|e| e == "hri"))
        .collect();
    files.sort();
    if files.is_empty() {
        return Err(format!("no .hri file in {}", terminal::shown(path)));
    }
    Ok(files)
}

/// Shows the diagnostics on stderr, at most so many of each file (0: all): errors before warnings, in the order of the text.
pub fn show(files: &SourceFiles, diagnostics: &[&Diagnostic], most: usize) {
    let mut by_file: BTreeMap<FileId, Vec<&Diagnostic>> = BTreeMap::new();
    for diagnostic in diagnostics {
        by_file.entry(diagnostic.span().file).or_default().push(diagnostic);
    }
    for (file, all) in by_file {
        let (errors, warnings): (Vec<&Diagnostic>, Vec<&Diagnostic>) = all.iter().partition(|d| d.is_error());
        let most = if most == 0 { all.len() } else { most };
        let (shown, rest) = (most.min(errors.len()), most.saturating_sub(errors.len()).min(warnings.len()));
        let (mut left_errors, mut left_warnings) = (shown, rest);
        for diagnostic in all {
            let left = if diagnostic.is_error() { &mut left_errors } else { &mut left_warnings };
            if *left > 0 {
                *left -= 1;
                terminal::say(render::diagnostic(files, diagnostic));
            }
        }
        let (errors, warnings) = (errors.len() - shown, warnings.len() - rest);
        if errors + warnings > 0 {
            let (name, more) = (printable_line(files.name(file)), render::totals(errors, warnings));
            terminal::say_line(format_args!(
                "{name}: {more} more are not shown (`hrdsl check --max-findings 0` shows all)"
            ));
        }
    }
}

/// Shows the diagnostics on stderr; gives the program, which there is if none of them is an error.
pub fn report(compilation: &CompilationResult) -> Option<&Program> {
    let all: Vec<&Diagnostic> = compilation.diagnostics.iter().collect();
    show(&compilation.files, &all, render::SHOWN);
    let errors = all.iter().filter(|d| d.is_error()).count();
    if !all.is_empty() {
        terminal::say_line(render::totals(errors, all.len() - errors));
    }
    compilation.program.as_ref()
}

/// What a file holds that is no scenario of its own.
fn part(compilation: &CompilationResult) -> Option<&'static str> {
    match kind_of(compilation.ast.first()?) {
        SourceKind::Scenario => None,
        SourceKind::Tests => Some("tests, and no scenario that they are of"),
        SourceKind::System => Some("systems, and no scenario that they are of"),
        SourceKind::Module => Some("declarations that are a part of a scenario"),
    }
}

/// Shows the errors on stderr, and how many warnings there are: who runs tests has seen them, or can.
pub fn report_errors<'c>(scenario: &Path, compilation: &'c CompilationResult) -> Option<&'c Program> {
    let (errors, warnings): (Vec<_>, Vec<_>) = compilation.diagnostics.iter().partition(|d| d.is_error());
    show(&compilation.files, &errors, render::SHOWN);
    if !errors.is_empty() {
        terminal::say_line(render::totals(errors.len(), 0));
        if let Some(what) = part(compilation) {
            let file = terminal::shown(scenario);
            terminal::say_line(format_args!("note: {file} holds {what}: give the file in which it begins"));
        }
    }
    if !warnings.is_empty() {
        let (count, them) =
            (render::totals(0, warnings.len()), if warnings.len() == 1 { "it" } else { "them" });
        terminal::say_line(format_args!(
            "{count} (`hrdsl check {}` shows {them})",
            terminal::shown(scenario)
        ));
    }
    compilation.program.as_ref()
}
