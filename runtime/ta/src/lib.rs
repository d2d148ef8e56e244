//! hrdsl-ta: a model checker for networks of timed automata, and a player of single ones.
//!
//! # Steps
//! 1. [`CompiledNetwork::new`] compiles a [`Network`](hrdsl_ir::ta::Network) with what [`ObservationOptions`] asks for: expressions to trees over
//!    whole numbers, one discrete vector, one set of clocks, constants in their greatest common unit.
//! 2. [`explore`] searches its zone graph for many [`ReachabilityGoal`]s at once, as [`SearchOptions`] say; [`check`] does both steps, breadth
//!    first.
//! 3. Each goal ends as a [`GoalOutcome`]: reached with a [`WitnessRun`], proved unreachable, or inconclusive.
//! 4. A witness gets concrete times (the earliest, the latest or sampled ones) and is replayed by an interpreter of its own
//!    before it is believed. A [`WitnessTrace`] tells it to people.
//!
//! [`answers`] does all that for queries, and decides those that reachability does not: `A<>`, `E[]`, `-->`, `deadlock`, `sup`
//! and `inf`. A [`VirtualTimePlayer`] runs one automaton in virtual time with the same interpreter.
//!
//! # Folders
//! Each uses only those above it.
//! - `zone`: matrices ([`dbm`]) and [`federation`]s of them, and the extrapolation that keeps them finite.
//! - `network`: `compile` makes the `model` and `bounds` what its clocks are compared with; `code` evaluates; `semantics`
//!   enumerates what may happen; `graph` makes it symbolic; `open` takes events from outside; [`query`] has the questions.
//! - `witness`: the interpreter (`concrete`), and the runs that it replays and plays.
//! - `search`: `rounds` goes over the waiting states (`waiting`), `expand` makes the successors of one with zones of the clocks
//!   that matter (`stepper`), as narrow as the constants allow; `store` keeps what is new, `slice` says which variables
//!   matter, `monotone` which are read one way, `goals` looks at what is asked.
//! - [`local`]: the same search with a time for each automaton.
//! - `walk`: a network gone through transition by transition, by hand or along a recorded run.
//! - `decide`: the answers, by these searches, with probes that look at their states; for runs without end by a walk of the plain zone graph.
//!
//! # Semantics
//! UPPAAL's, and multi-way channels after TChecker's synchronisation vectors. Guards are evaluated before any update. Who sends
//! or offers updates first, then the others in the network's order; the participants of a multi-way channel in its order. A sender of
//! an event or broadcast never waits: each other automaton with an enabled receiving edge takes part, by any one of them.
//! Invariants must hold after the updates, or the transition is not possible. No time passes while an automaton is in an
//! urgent or committed location, or a transition over an urgent channel is possible; from a committed one, the next
//! transition must involve an automaton in a committed location. A variable that leaves its range is a fault of the model,
//! not a guard.
//!
//! An event is one occurrence: the body of a stimulus is not executed, so a model that speaks of a stimulus's events
//! sends them itself.
#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod decide;
pub mod local;
mod network;
mod search;
mod walk;
mod witness;
mod zone;

pub use decide::answer::{QueryAnswer, QueryOptions, QueryVerdict, answer, answer_watched, answers};
pub use decide::deadlock::SHORTEST;
pub use decide::explore::{check, explore};
pub use decide::extremum::{ExtremumLimit, ExtremumValue, MeasureExtremum, RAISES};
pub use decide::fastest::fastest;
pub use decide::unread::{RangeAnswer, RangeFinding, UnreadCounters};
pub use network::code::SyncMedium;
pub use network::error::{EdgeName, ModelError};
pub use network::model::{CompiledNetwork, ObservationOptions, OverflowTreatment, OverflowWatch, slot_names};
pub use network::open::{OpenNetwork, OpenTransition, StateStay};
pub use network::query::{
    self, EventCounter, EventLimit, GoalKind, ReachabilityGoal, SearchBudget, StateFormula, clock_names,
};
pub use network::{selects::BinderValues, semantics::AutomatonMove};
pub use search::options::{SearchOptions, SearchOrder, SubsumptionRelation, TimeFrame};
pub use search::report::{
    GoalOutcome, SearchCutoff, SearchProgress, SearchReport, SearchStatistics, WidestVariable,
};
pub use walk::follow::{
    FollowDeparture, FollowOutcome, RecordedPart, RecordedStep, RecordedTime, RecordedWalk, follow,
};
pub use walk::session::WalkSession;
pub use walk::state::{ClockView, MomentRange, NetworkWalk, WalkOption, WalkState};
pub use witness::build::retimed;
pub use witness::error::SearchError;
pub use witness::player::VirtualTimePlayer;
pub use witness::run::{RunEnding, WitnessRun, WitnessRunStep};
pub use witness::schedule::{DAWDLE, ScheduleOptions};
pub use witness::trace::{
    EdgeSource, TransitionMedium, TransitionParticipant, WitnessTrace, WitnessTransition,
};
pub use zone::extrapolation::ExtrapolationAbstraction;
pub use zone::federation::Federation;
pub use zone::{dbm, federation};
