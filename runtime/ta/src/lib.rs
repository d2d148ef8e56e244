//! hrdsl-ta: a model checker for networks of timed automata, and a player of single ones.
//!
//! # Steps
//! 1. [`Model::new`] compiles a [`Network`](hrdsl_ir::ta::Network) with what it [observes](Observe): one discrete vector, one
//!    set of clocks, constants in their greatest common unit.
//! 2. [`explore`] searches its zone graph for many [`Goal`]s at once; [`check`] does both steps.
//! 3. Each goal ends as an [`Outcome`]: reached with a [`Witness`], proved unreachable, or open.
//! 4. A witness gets concrete times (the earliest, the latest or sampled ones) and is replayed by an interpreter of its own
//!    before it is believed. A [`Story`] tells it to people.
//!
//! [`answers`] does all that for queries, and decides those that reachability does not: `A<>`, `E[]`, `-->`, `deadlock`, `sup`
//! and `inf`. A [`Player`] runs one automaton in virtual time with the same interpreter.
//!
//! # Semantics
//! UPPAAL's. A sender of an event, or of a broadcast channel, never waits: each other automaton with an enabled edge for it
//! takes part, by any one of them. A hand-shake is of two, a joint channel of all its parties (of optional ones if they can).
//! Guards are evaluated before any update; updates run the sender's first, then those of who takes part, in the network's
//! order (of a joint channel in the order of its parties). Invariants must hold after the updates, or the transition is not
//! possible. No time passes while an automaton is in an urgent or committed location, or a transition over an urgent channel
//! is possible; from a committed location, the next transition must involve an automaton in one. A variable that leaves its
//! range is a fault of the model, not a guard.
//!
//! An event is one occurrence: the body of a stimulus is not executed, so a model that speaks of a stimulus's events
//! sends them itself.

mod abstraction;
mod answer;
mod cells;
mod check;
mod code;
mod compile;
mod concrete;
pub mod dbm;
mod error;
mod expand;
#[cfg(test)]
mod explicit;
mod extrapolation;
mod extremum;
mod fastest;
pub mod federation;
mod goals;
mod graph;
mod liveness;
mod network;
mod order;
mod plain;
mod player;
pub mod query;
mod replay;
mod schedule;
mod search;
mod semantics;
mod sequence;
mod slice;
mod store;
mod story;
mod witness;
mod zone;

pub use answer::{Answer, Manner, SHORTEST, Verdict, answer, answers};
pub use code::Medium;
pub use error::{EdgeName, Error, ModelError};
pub use extrapolation::Abstraction;
pub use extremum::{Extremum, Quantity, RAISES, Reach};
pub use fastest::{fastest, shortest};
pub use federation::Federation;
pub use network::{Model, Observe, slot_names};
pub use player::Player;
pub use query::{Budget, Counter, Goal, GoalKind, Limit, StateFormula, clock_names};
pub use schedule::{DAWDLE, Timing};
pub use search::{Exhausted, Options, Order, Outcome, Progress, Report, Subsumption, check, explore};
pub use semantics::{Binders, Move};
pub use story::{Over, Part, Scene, Story};
pub use witness::{Ending, Witness, WitnessStep, retimed};
