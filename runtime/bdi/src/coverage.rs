//! Model coverage: what there is of an agent's program to be reached, what runs reached of it, and why not the rest.
//!
//! # Steps
//!
//! 1. [`universe`] lists the [`AgentCoverItem`](hrdsl_ir::cover_item::AgentCoverItem)s of an agent that its program does not rule out;
//! 2. [`AgentCounts::reaches`](crate::measure::AgentCounts::reaches) looks for one in the counts of a run;
//! 3. [`place`] says where it is;
//! 4. [`AgentTeam::why`] says from the counts of all runs why it was not reached.

mod text;
mod universe;
mod why;

pub use text::{place, trigger};
pub use universe::{items, sites, universe};
pub use why::{AgentTeam, times};

#[cfg(test)]
pub(crate) mod fixture;
