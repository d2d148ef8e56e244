//! Belief-desire-intention agents: a deterministic interpreter of AgentSpeak(L) in virtual time.
//!
//! The language is Rao's AgentSpeak(L) (1996); the reasoning cycle is that of Jason (Bordini, Hübner, Wooldridge,
//! *Programming Multi-Agent Systems in AgentSpeak using Jason*, 2007), with every choice fixed: events are taken first in,
//! first out; the first applicable plan in source order is selected; intentions take turns. `spec/agents-semantics.md`
//! says it to the letter, and where it departs from Jason.
//!
//! # Steps
//!
//! 1. [`choose::factors`] and [`choose::explore`] choose the sets of beliefs that agents start with;
//! 2. [`AgentSociety::new`] makes the running agents from their programs and the chosen beliefs;
//! 3. [`AgentSociety::perceive`] and [`AgentSociety::stimulus_done`] tell them what happened;
//! 4. [`AgentSociety::run`] lets them reason, in rounds, until all wait, and says what they do;
//! 5. [`AgentSociety::log`] says why, [`AgentSociety::measured`] what that took of the programs, and [`coverage`] what it leaves out.
//!
//! # The engine, by the way of an event
//!
//! `society` (rounds, messages delivered) → `cycle` (one agent: inbox, events, ready intentions) → `select` (a plan for an
//! event) → `query` (answers of a formula in `belief`s and rules, with `unify`) → `step` (a line of `code`; `block`, `control`,
//! `mail`) → `recover` (plans that end or fail, on the stacks of `intention`). `repeat` finds livelocks, `bounds` agents that hold too much; `log`, `describe`, `show` and
//! `measure` tell.
#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod belief;
mod block;
mod bounds;
mod change;
mod check;
pub mod choose;
mod code;
mod control;
pub mod coverage;
mod cycle;
mod describe;
mod dice;
mod event;
mod holding;
mod intention;
mod log;
mod mail;
pub mod measure;
mod mind;
mod plan;
mod print;
mod query;
mod recover;
mod repeat;
mod select;
pub mod show;
mod society;
mod standing;
mod state;
mod step;
mod turn;
mod unify;

pub use belief::FactAnnotations;
pub use check::MalformedAgentError;
pub use cycle::{CYCLE_LIMIT, RunStatus};
pub use event::{ActionToken, AgentAction, EventArguments};
pub use holding::HoldingKind;
pub use log::{
    ApplicabilityVerdict, FailureCause, IntentionFailure, LogDetail, LogEntry, LogItem, PlanIndex,
    StepOutcome,
};
pub use measure::AgentCounts;
pub use query::BeliefQueryError;
pub use society::AgentSociety;
pub use standing::IntentionSummary;
