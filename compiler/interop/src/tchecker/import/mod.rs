//! TChecker's text format to a scenario: processes become automata, sync vectors multi-way channels, labels queries.
//!
//! # Steps
//! 1. `parse`, `term`: the declarations, and the expressions and statements in their attributes
//! 2. `names`: what everything is called in the scenario
//! 3. `write`: the text, by `expr` (integers, conditions, bounds on clocks) and `effect` (what edges do)
//!
//! [`import`] does them all. The format is described in the manual of TChecker 0.3 and later. One of its units of time is a
//! second here.

mod ast;
mod effect;
mod expr;
mod names;
mod parse;
mod term;
mod write;

use crate::exchange::{
    note::{ImportNote, ImportedScenario, NoteSeverity, SyntaxError},
    source::{ForeignSource, too_large},
};

/// How to import.
#[derive(Clone, Debug, Default)]
pub struct TcheckerOptions {
    /// The scenario's name; otherwise that of the system.
    pub name: Option<String>,
}

/// Makes a scenario from a system of timed automata.
///
/// # Errors
/// What cannot be read, or cannot be said in a scenario, and where.
pub fn import(file: &ForeignSource, options: &TcheckerOptions) -> Result<ImportedScenario, Vec<SyntaxError>> {
    if let Some(large) = too_large(file) {
        return Err(vec![large]);
    }
    let (mut model, faults) = parse::parse(&file.text);
    if let Some(name) = &options.name {
        model.name.clone_from(name);
    }
    if !faults.is_empty() {
        return Err(errors(file, faults));
    }
    let written = write::write(&model).map_err(|faults| errors(file, faults))?;
    let mut notes: Vec<ImportNote> = Vec::new();
    for (at, severity, message) in written.notes {
        let (line, column) = place(&file.text, at);
        notes.push(ImportNote { file: file.name.clone(), line, column, severity, message, help: None });
    }
    for (key, at) in &model.ignored {
        let (line, column) = place(&file.text, *at);
        let message = format!("the attribute `{key}` has no meaning here");
        let severity = NoteSeverity::LeftOut;
        notes.push(ImportNote { file: file.name.clone(), line, column, severity, message, help: None });
    }
    notes.sort();
    notes.dedup();
    let text = hrdsl_syntax::format(&written.text).unwrap_or(written.text);
    Ok(ImportedScenario { text, notes })
}

fn errors(file: &ForeignSource, faults: Vec<parse::TcheckerFault>) -> Vec<SyntaxError> {
    let error = |f: parse::TcheckerFault| {
        let (line, column) = place(&file.text, f.at);
        SyntaxError { file: file.name.clone(), line, column, message: f.message }
    };
    let mut all: Vec<SyntaxError> = faults.into_iter().map(error).collect();
    all.sort();
    all.dedup();
    all
}

/// Line and column, from 1, the column in characters.
fn place(text: &str, at: usize) -> (u32, u32) {
    let before = text.get(..at).unwrap_or(text);
    let line = before.matches('\n').count() + 1;
    let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
    (u32::try_from(line).unwrap_or(u32::MAX), u32::try_from(column).unwrap_or(u32::MAX))
}
