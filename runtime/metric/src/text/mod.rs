//! Formulas as they are written: to tokens, to a tree, and with the names, types and units of a scenario to a [`CheckedFormula`].

pub(crate) mod check;
mod error;
mod lexer;
mod names;
mod tree;
pub(crate) mod units;

use std::ops::Range;

use hrdsl_ir::{Program, Unit, world::SignalId};

use crate::{atom::AtomSource, formula::MetricGoal};
pub use error::FormulaError;

/// A formula over the signals and events of a scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckedFormula {
    pub goal: MetricGoal,
    /// What the goal's atoms are.
    pub(crate) atoms: Vec<AtomSource>,
    /// The signals that they read.
    pub(crate) signals: Vec<SignalId>,
    /// The unit of all comparisons of numbers; `None`: there are none, or they are of different units, and no margin is told.
    pub unit: Option<Unit>,
}

/// A part of the text, in bytes.
pub type TextRange = Range<usize>;

/// Reads a formula over the signals and events of the program.
///
/// # Errors
/// The first thing that is wrong: where, and what would be right.
pub fn read_formula(program: &Program, text: &str) -> Result<CheckedFormula, FormulaError> {
    let tree = tree::parse(text)?;
    check::check(program, text, &tree)
}
