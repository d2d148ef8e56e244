//! Model coverage: what there is of an agent's program to be reached, what runs reached of it, and why not the rest.
//!
//! # Steps
//!
//! 1. [`universe`] lists the [`AgentCoverItem`]s of an agent that its program does not rule out;
//! 2. [`AgentCoverItem::is_reached`] looks for one in the counts of a run ([`AgentCounts`](crate::measure::AgentCounts));
//! 3. [`name`] says which one it is;
//! 4. [`AgentTeam::why`] says from the counts of all runs why it was not reached.

mod text;
mod universe;
mod why;

pub use text::{name, trigger};
pub use universe::{AgentCoverItem, ApplicableCount, items, sites, universe};
pub use why::{AgentTeam, times};

#[cfg(test)]
pub(crate) mod fixture;
