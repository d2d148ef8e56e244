//! hrdsl-ta: a model checker for networks of timed automata, and a player of single ones.
//!
//! # Steps
//! 1. [`Model::new`] compiles a [`Network`](hrdsl_ir::ta::Network) with what [`Observe`] asks for: expressions to trees over
//!    whole numbers, one discrete vector, one set of clocks, constants in their greatest common unit.
//! 2. [`explore`] searches its zone graph for many [`Goal`]s at once, as [`Options`] say; [`check`] does both steps, breadth
//!    first.
//! 3. Each goal ends as an [`Outcome`]: reached with a [`Witness`], proved unreachable, or open.
//! 4. A witness gets concrete times (the earliest, the latest or sampled ones) and is replayed by an interpreter of its own
//!    before it is believed. A [`Story`] tells it to people.
//!
//! [`answers`] does all that for queries, and decides those that reachability does not: `A<>`, `E[]`, `-->`, `deadlock`, `sup`
//! and `inf`. A [`Player`] runs one automaton in virtual time with the same interpreter.
//!
//! # Parts of the search
//! - `compile` makes the `network`; `code` evaluates; `semantics` enumerates what may happen; `zone` makes it symbolic, with
//!   matrices ([`dbm`]) of the clocks that matter, as narrow as the constants allow; `extrapolation` keeps them finite.
//! - `expand` makes the successors of one state, `search` goes in rounds over the waiting ones (`order`), `store` keeps what
//!   is new, `slice` says which variables matter, `goals` looks at what is asked.
//!
//! # Semantics
//! UPPAAL's, and joint channels after TChecker's synchronisation vectors. Guards are evaluated before any update. Who sends
//! or offers updates first, then the others in the network's order; the parties of a joint channel in its order. A sender of
//! an event or broadcast never waits: each other automaton with an enabled receiving edge takes part, by any one of them.
//! Invariants must hold after the updates, or the transition is not possible. No time passes while an automaton is in an
//! urgent or committed location, or a transition over an urgent channel is possible; from a committed one, the next
//! transition must involve an automaton in a committed location. A variable that leaves its range is a fault of the model,
//! not a guard.
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
pub mod local;
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
