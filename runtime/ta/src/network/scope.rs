//! What the variables of an expression stand for.

use hrdsl_ir::ta::located_automaton;

use crate::network::number::NumberType;

/// Where a variable of an expression lives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum VariablePlace {
    /// An index into the state's vector.
    State(u32),
    /// Of the frame: selects and bound arguments of an edge, or parameters and locals of a function.
    Local(u32),
}

/// What the variables of an expression are.
#[derive(Clone, Debug, Default)]
pub(crate) struct VariableScope {
    pub vars: Vec<(VariablePlace, NumberType)>,
    /// The automaton (index in the network) whose functions may be called.
    pub member: Option<u16>,
    /// Of the network's formulas: so many automata, whose locations have numbers.
    pub located: usize,
}

impl VariableScope {
    /// Of an automaton or its functions.
    pub(crate) fn own(vars: Vec<(VariablePlace, NumberType)>, member: Option<u16>) -> Self {
        Self { vars, member, located: 0 }
    }

    /// Of formulas over a network of so many automata.
    pub(crate) fn of_network(vars: Vec<(VariablePlace, NumberType)>, located: usize) -> Self {
        Self { vars, member: None, located }
    }

    /// Where a variable is, and its type.
    pub(crate) fn variable(&self, slot: u16) -> Option<(VariablePlace, NumberType)> {
        let location = || {
            let automaton = located_automaton(slot, self.located)?;
            Some((VariablePlace::State(u32::from(automaton)), NumberType::Int))
        };
        self.vars.get(usize::from(slot)).copied().or_else(location)
    }
}
