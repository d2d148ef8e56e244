//! Automata: locations, edges, clocks, channels, functions, and queries on their networks.

pub(super) mod assign;
pub(super) mod automaton;
pub(super) mod channel;
pub(super) mod clock;
mod combination;
pub(super) mod edge;
pub(super) mod function;
pub(super) mod phase;
pub(super) mod query;
pub(super) mod statement;
