//! Belief-desire-intention agents: a deterministic interpreter of AgentSpeak(L) in virtual time.
//!
//! The language is Rao's AgentSpeak(L) (1996); the reasoning cycle is that of Jason (Bordini, Hübner, Wooldridge,
//! *Programming Multi-Agent Systems in AgentSpeak using Jason*, 2007), with every choice fixed: events are taken first in,
//! first out; the first applicable plan in source order is selected; intentions take turns.
//!
//! # Steps
//!
//! 1. [`choose::factors`] and [`choose::explore`] choose the sets of beliefs that agents start with;
//! 2. [`Machine::new`] makes a running agent from its program and the chosen beliefs;
//! 3. [`Machine::perceive`] and [`Machine::stimulus_done`] tell it what happened;
//! 4. [`Machine::run`] lets it reason until it waits, and says what it does;
//! 5. [`Machine::log`] and [`Machine::selections`] say why.
//!
//! # Where this departs from Jason
//!
//! - A belief that a plan's body adds or removes gives an event of its own, for an intention of its own (Jason's `++b`).
//! - An event that no plan is relevant to never enters the queue, so that it takes no cycle.
//! - A message is taken in when everything before it has settled, not one in each cycle: two events that are delivered
//!   together cannot overtake an `await` that the first one leads to.
//! - A failure is handled at once, in the step that fails, by the first *applicable* failure plan from the innermost
//!   goal outwards; a failure plan that fails passes the failure on to the goal below.
//! - A plan whose body is finished leaves its intention before its last sub-goal's plan enters, unless a failure plan
//!   could still need it.

mod belief;
mod check;
pub mod choose;
mod cycle;
mod event;
mod intention;
mod log;
mod plan;
mod recover;
mod select;
mod step;
mod unify;

pub use check::Malformed;
pub use cycle::{CYCLE_LIMIT, Machine, Status};
pub use event::{Action, ActionToken, Args};
pub use log::{Cause, Failure, LogEntry, Logged, PlanIndex};
