//! UPPAAL's models (`.xml`, flat DTD and newer; `.xta`) and queries (`.q`, or in the model) to a scenario.
//!
//! # Steps
//! 1. `xml` or `xta`, `branches`: the file to templates and pieces of text, each character with its place
//! 2. `lex`, `parse`, `queries`: pieces to declarations, expressions, formulas
//! 3. `template`: the labels of each template
//! 4. `declare`, `record`, `comment`: what is declared for all; `call`, `statement`, `order`, `update`, `bits`: functions
//! 5. `process`: the processes of the system, each template with its arguments an automaton of its own; `cases`, `inline`:
//!    transitions that become several edges
//! 6. `clocks`, `stopwatch`: conditions over clocks, split into alternatives where a scenario has conjunctions only
//! 7. `write`: the text
//!
//! From the third step on, all that is known is in one place (`translation`).
//!
//! [`import`] does them all. A model that a scenario cannot say is refused, with the name and place of what is in the
//! way; a query that cannot be asked is left out.

mod ast;
mod bits;
mod branches;
mod call;
mod cases;
mod clocks;
mod comment;
mod declare;
mod expr;
mod fault;
mod inline;
mod known;
mod lex;
mod location;
mod order;
mod parse;
mod place;
mod process;
mod queries;
mod record;
mod scope;
mod statement;
mod stopwatch;
mod template;
mod translation;
mod update;
mod write;
mod xml;
mod xta;

use hrdsl_source::{FileId, SourceFiles, Span, TextPosition};

use self::{fault::UppaalFault, translation::UppaalTranslation};
use crate::exchange::{
    note::{ImportNote, ImportedScenario, NoteSeverity, SyntaxError},
    source::{ForeignSource, too_large},
};

/// How to import.
#[derive(Clone, Debug, Default)]
pub struct UppaalOptions {
    /// The scenario's name; otherwise that of the file.
    pub name: Option<String>,
}

/// Makes a scenario of a model and queries about it.
///
/// # Errors
/// What cannot be read, and what a scenario cannot say.
pub fn import(
    model: &ForeignSource,
    questions: Option<&ForeignSource>,
    options: &UppaalOptions,
) -> Result<ImportedScenario, Vec<SyntaxError>> {
    let large: Vec<SyntaxError> = std::iter::once(model).chain(questions).filter_map(too_large).collect();
    if !large.is_empty() {
        return Err(large);
    }
    let mut files = SourceFiles::default();
    let file = files.add(&model.name, &model.text);
    let mut replaced = None;
    let is_textual = [".xta", ".ta"].iter().any(|ending| model.name.ends_with(ending));
    let reader = if is_textual { xta::read } else { xml::read };
    let (mut read, unread) = reader(file, &model.text).map_err(|faults| errors(&files, faults))?;
    if let Some(source) = questions {
        let file: FileId = files.add(&source.name, &source.text);
        let before = std::mem::replace(&mut read.queries, queries::read(file, &source.text));
        if let Some(first) = before.first() {
            let many = if before.len() == 1 { "the query" } else { "the queries" };
            let message = format!("{many} of the model give way to those of {}", source.name);
            replaced = Some((first.formula.span(), NoteSeverity::Info, message));
        }
    }
    let mut cx = UppaalTranslation::new(&read);
    let scenario = options.name.clone().unwrap_or_else(|| stem(&model.name).to_owned());
    let written = cx.write(&scenario, &model.name);
    cx.faults.extend(unread);
    if !cx.faults.is_empty() {
        // What could not be declared is missing everywhere.
        let undeclared = std::mem::take(&mut cx.undeclared);
        cx.faults.retain(|fault| !undeclared.iter().any(|name| fault.misses(name)));
        return Err(errors(&files, cx.faults));
    }
    for (span, old, new) in std::mem::take(&mut cx.names.renamed) {
        let why = scope::why_renamed(&old, &scenario);
        cx.notes.push((span, NoteSeverity::Info, format!("`{old}` is called `{new}`: {why}")));
    }
    cx.notes.extend(replaced);
    let mut notes: Vec<ImportNote> =
        cx.notes.into_iter().chain(read.skipped.iter().cloned()).map(|n| note(&files, n)).collect();
    notes.sort();
    notes.dedup();
    let text = hrdsl_syntax::format(&written).unwrap_or(written);
    Ok(ImportedScenario { text, notes })
}

fn note(files: &SourceFiles, (span, severity, message): (Span, NoteSeverity, String)) -> ImportNote {
    let (file, TextPosition { line, column }) = place(files, span);
    ImportNote { file, line, column, severity, message, help: None }
}

fn errors(files: &SourceFiles, faults: Vec<UppaalFault>) -> Vec<SyntaxError> {
    let error = |fault: UppaalFault| {
        let (file, TextPosition { line, column }) = place(files, fault.span);
        SyntaxError { file, line, column, message: fault.message }
    };
    let mut errors: Vec<SyntaxError> = faults.into_iter().map(error).collect();
    errors.sort();
    errors.dedup();
    errors
}

fn place(files: &SourceFiles, span: Span) -> (String, TextPosition) {
    (files.get(span.file).map(|f| f.name.clone()).unwrap_or_default(), files.position(span))
}

/// The file's name without its folder and ending.
fn stem(name: &str) -> &str {
    let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
    file.rsplit_once('.').map_or(file, |(stem, _)| stem)
}
