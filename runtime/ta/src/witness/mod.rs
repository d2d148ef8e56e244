//! Runs under concrete clocks: an interpreter of automata, who plays with it, and witnesses that it replays and that are told
//! to people.

pub(crate) mod build;
pub(crate) mod concrete;
pub(crate) mod error;
mod memory;
mod outcomes;
pub(crate) mod player;
mod replay;
pub(crate) mod retell;
pub(crate) mod run;
pub(crate) mod schedule;
mod sequence;
mod simplex;
pub(crate) mod standing;
pub(crate) mod trace;
