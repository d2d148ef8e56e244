//! Formulas as they are written: to tokens, to a tree, and with the names, types and units of a scenario to a [`CheckedFormula`].

mod check;
mod checked;
mod error;
mod lexer;
mod names;
mod terms;
mod tree;
pub(crate) mod units;

use hrdsl_ir::Program;

pub use checked::CheckedFormula;
pub use error::{FormulaError, TextRange};

/// Reads a formula over the signals and events of the program.
///
/// # Errors
/// The first thing that is wrong: where, and what would be right.
pub fn read_formula(program: &Program, text: &str) -> Result<CheckedFormula, FormulaError> {
    let tree = tree::parse(text)?;
    check::check(program, text, &tree)
}
