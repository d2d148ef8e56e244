//! Formulas as deterministic timed automata: which of them are one, and what it looks like; of the others, what keeps them from it.
//!
//! An automaton reads a run moment by moment, a moment being a nanosecond: at each it is told which of its letters hold, and takes the edge of its state whose guard does,
//! or stays. So neither the order of what happens at an instant nor how often a signal is sampled matters, as is true of formulas. Whoever executes it skips
//! the moments at which neither a letter nor the answer of a clock changes.

mod ahead;
mod condition;
mod data;
mod explore;
mod guard;
mod network;
mod parts;

use hrdsl_ir::formula::MonitorFormula;

pub use data::{
    AutomatonObstacle, FormulaAutomaton, FormulaEdge, FormulaLetter, FormulaState, GuardQuestion, GuardTest,
    LetterKind,
};

/// The automaton that a formula is.
///
/// # Errors
/// It is none, or not one of a size that anybody would look at.
pub fn automaton_of(formula: &MonitorFormula) -> Result<FormulaAutomaton, AutomatonObstacle> {
    let network = network::network(formula)?;
    explore::explored(network)
}
