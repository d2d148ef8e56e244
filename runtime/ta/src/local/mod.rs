//! Reachability with local time: each process has a time of its own, so that independent transitions commute.
//!
//! # Method
//! Local time is from Bengtsson, Jonsson, Lilius and Yi, "Partial order reductions for timed systems" (CONCUR 1998), the
//! search from Govind, Herbreteau, Srivathsan and Walukiewicz, "Revisiting local time semantics for networks of timed
//! automata" (CONCUR 2019). Time passes for each process by itself; those that a transition depends on must have one time
//! when it is taken. Transitions without a process in common can then be taken in either order with the same zone, where
//! standard zones remember the order. A zone is kept only if all processes can reach one time in it, and it is dropped if a
//! kept zone of the same discrete state simulates it under aLU, both taken as far as all processes have one time. Discrete
//! states are those of the standard search, each of them; what becomes fewer is their zones.
//!
//! # What it rests on
//! The processes are the automata and the *media*: one for each shared variable or clock (or group of them that the same
//! edges use). A transition *involves* those whose location, variables or clocks it reads or changes, or that decide
//! whether it is there.
//!
//! - *Sound.* Take a local run at the end of which all have one time, and sort its transitions by their times, those of one
//!   time as they come. Two transitions with a process in common keep their order, since the time of a process does not
//!   fall. So each process does what it did, at the same times, and the sorted run is one of the network. Witnesses are
//!   made in this way and replayed.
//! - *Complete.* A run of the network is a local run, and after each of its steps all can have one time: so zones in which
//!   they cannot may be dropped. aLU is a simulation on runs of the network, and the next step of such a run needs no more
//!   than the synchronised part of a zone: so comparing these parts is enough.
//! - *Finite.* There are finitely many sets aLU(Z) of standard zones Z (Herbreteau, Srivathsan, Walukiewicz, LICS 2012).
//!
//! # When it serves a network
//! - *Binary synchronisations and multi-way channels without optional participants* involve those that move. Nothing else matters to them.
//! - *Events, broadcast channels, multi-way channels with optional participants* also involve everybody who has an edge for them
//!   anywhere, with the media of these edges: that somebody stays away is a step of its own, from its location to itself,
//!   under the guard that it cannot take part. So they are synchronisations of many, sound but with little to commute.
//! - *Shared variables and clocks.* A variable is an automaton with one location that takes part in each transition that
//!   reads or writes it; so is a clock. With [`LocalSearchOptions::media`] off, a network that shares any is refused instead, for there
//!   is little to gain. What nobody writes, or one automaton alone uses, is not shared. Goals may read everything: they are
//!   asked of states in which all have one time.
//! - *Invariants* must speak of what their automaton alone changes, so that time may pass for it without a look at others.
//!   A clock of an invariant must not be used by others.
//! - *Urgent locations*: the time of the automaton that is there stands still, the others' need not: before all have one
//!   time they must come back to it, since times do not fall, or it must leave.
//! - *Committed locations* are urgent, and a transition that involves none of them is not taken while there is one. What
//!   happens from the entry of the first to the exit of the last has one time, since each of the automata in one was moved
//!   at that time; it comes in one piece in the local run, so it does in the sorted run, too.
//! - *Counters and limits* count without regard to order, so that they involve nobody.
//! - *Urgent channels* forbid time to pass as long as some automata are somewhere: refused.
//! - *Differences of clocks* in guards or invariants: aLU is not sound with them: refused.
//! - *Goals over clocks*: refused. Where zones say that they hold, they do; but the order of the witness is found from the
//!   path alone, and another order of it may be needed to meet them.
//! - *Faults* of a transition are met if all others can reach its time, then by a run of the network up to that time.

mod access;
mod at_once;
mod batch;
mod crew;
mod order;
mod refusal;
mod search;
mod space;
mod waiting;
mod zone;

pub use refusal::{LocalSearchError, NotApplicableError};
pub(crate) use search::{LocalPause, LocalSearch};
pub use search::{LocalSearchOptions, explore};
