//! hrdsl-ta: a model checker for networks of timed automata, and a player of single ones.
//!
//! # Steps
//! 1. [`Model::new`] compiles a [`Network`](hrdsl_ir::ta::Network) with its counters and limits: one discrete vector, one
//!    set of clocks, constants in their greatest common unit.
//! 2. [`explore`] searches its zone graph breadth first for many [`Goal`]s at once; [`check`] does both steps.
//! 3. Each goal ends as an [`Outcome`]: reached with a [`Witness`], proved unreachable, or open.
//! 4. A witness gets earliest concrete times and is replayed by an interpreter of its own before it is believed.
//!
//! A [`Player`] runs one automaton in virtual time with the same interpreter.
//!
//! # Semantics
//! UPPAAL's, with broadcast only. A sender never waits. Each other automaton with an enabled receiving edge for the event
//! takes part, by any one of them; guards are evaluated before any update, updates run the sender's first, then the
//! receivers' in the network's order. Invariants must hold after the updates, or the transition is not possible. No time
//! passes while an automaton is in an urgent or committed location; from a committed one, the next transition must involve
//! an automaton in a committed location. A variable that leaves its range is a fault of the model, not a guard.
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

pub use answer::{Answer, Manner, Verdict, answer, answers};
pub use code::Medium;
pub use error::{EdgeName, Error, ModelError};
pub use extrapolation::Abstraction;
pub use extremum::{Extremum, Quantity, RAISES, Reach};
pub use fastest::fastest;
pub use federation::Federation;
pub use network::{Model, Observe, slot_names};
pub use player::Player;
pub use query::{Budget, Counter, Goal, GoalKind, Limit, StateFormula};
pub use schedule::{DAWDLE, Timing};
pub use search::{Exhausted, Options, Order, Outcome, Progress, Report, Subsumption, check, explore};
pub use semantics::{Binders, Move};
pub use story::{Over, Part, Scene, Story};
pub use witness::{Ending, Witness, WitnessStep, retimed};
