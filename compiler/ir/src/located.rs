//! Locations as variables of queries.

/// What stands in a query's expressions for the location of the network's automaton of this index, as its number. They are counted
/// from the last number down, so that a variable more or less leaves them what they are.
#[must_use]
pub fn location_variable(automaton: u16) -> u16 {
    u16::MAX - automaton
}

/// The automaton, of so many, whose location a variable of a query stands for.
#[must_use]
pub fn located_automaton(variable: u16, automata: usize) -> Option<u16> {
    Some(u16::MAX - variable).filter(|a| usize::from(*a) < automata)
}
