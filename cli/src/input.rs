//! Reading scenarios: from files to a checked program, or to diagnostics on stderr.

use std::{
    fs,
    path::{Path, PathBuf},
};

use hrdsl_compiler::{Compilation, Input, compile};
use hrdsl_ir::Program;

use crate::render;

/// A failure that is no diagnostic: a file, an argument.
pub type Fault = String;

/// Reads a text file.
///
/// # Errors
/// The file's name and what is wrong with it.
pub fn read(path: &Path) -> Result<String, Fault> {
    let bytes = fs::read(path).map_err(|e| match e.kind() {
        std::io::ErrorKind::NotFound => format!("no such file: {}", path.display()),
        _ => format!("cannot read {}: {e}", path.display()),
    })?;
    String::from_utf8(bytes)
        .map_err(|e| format!("{} is not UTF-8 text (byte {})", path.display(), e.utf8_error().valid_up_to()))
}

/// Writes a file, and the folders above it.
///
/// # Errors
/// The file's name and what is wrong.
pub fn write(path: &Path, text: &str) -> Result<(), Fault> {
    let fault = |e: std::io::Error| format!("cannot write {}: {e}", path.display());
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(fault)?;
    }
    fs::write(path, text).map_err(fault)
}

/// Compiles a scenario and files of tests; a folder stands for the `.hri` files in it.
///
/// # Errors
/// A file that cannot be read.
pub fn load(scenario: &Path, tests: &[PathBuf]) -> Result<Compilation, Fault> {
    let text = read(scenario)?;
    let name = scenario.display().to_string();
    let mut files = Vec::new();
    for path in tests {
        for file in expand(path)? {
            files.push((file.display().to_string(), read(&file)?));
        }
    }
    let tests: Vec<Input<'_>> = files.iter().map(|(name, text)| Input { name, text }).collect();
    Ok(compile(Input { name: &name, text: &text }, &tests))
}

fn expand(path: &Path) -> Result<Vec<PathBuf>, Fault> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let entries = fs::read_dir(path).map_err(|e| format!("cannot read {}: {e}", path.display()))?;
    let mut files: Vec<PathBuf> = entries
        .filter_map(Result::ok)
        .map(|e| e.path())
        .filter(|p| p.extension().is_some_and(|e| e == "hri"))
        .collect();
    files.sort();
    if files.is_empty() {
        return Err(format!("no .hri file in {}", path.display()));
    }
    Ok(files)
}

/// The folder of a scenario, where its robot code is.
#[must_use]
pub fn folder(scenario: &Path) -> PathBuf {
    match scenario.parent() {
        Some(folder) if folder.as_os_str().is_empty() => PathBuf::from("."),
        Some(folder) => folder.to_owned(),
        None => PathBuf::from("."),
    }
}

/// Shows all diagnostics on stderr; gives the program, which there is if none of them is an error.
pub fn report(compilation: &Compilation) -> Option<&Program> {
    for diagnostic in &compilation.diagnostics {
        eprint!("{}", render::diagnostic(&compilation.files, diagnostic));
    }
    let errors = compilation.diagnostics.iter().filter(|d| d.is_error()).count();
    let warnings = compilation.diagnostics.len() - errors;
    if errors + warnings > 0 {
        eprintln!("{}", render::totals(errors, warnings));
    }
    compilation.program.as_ref()
}
