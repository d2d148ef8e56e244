//! `Program`: what a scenario says, resolved and typed, as plain data.
//!
//! This is the waist between the compiler, which makes it, and the runtime, which executes it. It has no behaviour but
//! the evaluation of expressions ([`expr`]) and functions ([`exec`]), so that every engine means the same by `+`.
//!
//! All quantities are in SI units (metre, second, radian, kilogram, newton and what is made of them) as `f64`; all times that an engine counts
//! with are integer nanoseconds ([`Nanos`]).
#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

pub mod abstract_test;
pub mod bdi;
pub mod binding;
pub mod cover_item;
pub mod coverage;
mod declared;
pub mod device;
mod device_sort;
pub mod device_state;
mod eval_error;
pub mod event;
pub mod exec;
pub mod expr;
pub mod formula;
mod known;
pub mod list;
mod located;
pub mod lowering;
pub mod monitor;
mod plan_steps;
pub mod real;
pub mod sensor;
pub mod shape;
pub mod solid;
pub mod suite;
mod suite_lowering;
mod sync_label;
pub mod system;
pub mod ta;
pub mod test;
pub mod value;
pub mod world;
mod world_ids;
mod world_point;
mod world_posture;

use serde::{Deserialize, Serialize};

pub use event::{Actor, ActorId, ArgPattern, Event, EventId, EventPattern, Parameter, Provenance, Role};
pub use expr::Expr;
pub use hrdsl_source::{Enumeration, Span, Symbol};
pub use known::known_name;
pub use list::{List, Text};
pub use plan_steps::PlanBlock;
pub use value::{ListOf, Nanos, Type, Unit, Value};

/// A whole scenario, ready to generate tests from and to run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Program {
    pub name: String,
    pub actors: Vec<Actor>,
    /// Events and stimuli, in source order; a stimulus is an event that carries a body.
    pub events: Vec<Event>,
    /// By event: whose word it is.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub provenance: Vec<Provenance>,
    pub agents: Vec<bdi::Agent>,
    /// What the agents' messages are about.
    pub contents: Vec<bdi::MessageContent>,
    /// Variables that all automata share.
    pub shared: Vec<ta::AutomatonVar>,
    /// Clocks that all automata share.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub clocks: Vec<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub channels: Vec<ta::Channel>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub functions: Vec<ta::AutomatonFunction>,
    pub automata: Vec<ta::Automaton>,
    pub networks: Vec<ta::Network>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub queries: Vec<ta::Query>,
    /// Sensors and every numeric or boolean term over the world that a requirement reads.
    pub signals: Vec<world::Signal>,
    pub monitors: Vec<monitor::Monitor>,
    pub assumptions: Vec<monitor::Assumption>,
    pub coverage: coverage::Coverage,
    pub suites: Vec<suite::Suite>,
    pub tests: Vec<test::Test>,
    pub world: Option<world::World>,
    /// What tests can be run against; the first is meant where none is named.
    pub systems: Vec<system::SystemUnderTest>,
}

impl Program {
    /// The event or stimulus of this name.
    #[must_use]
    pub fn event_named(&self, name: &str) -> Option<EventId> {
        let at = self.events.iter().position(|e| e.name == name)?;
        u16::try_from(at).ok().map(EventId)
    }

    /// The actors of a role, in source order.
    pub fn actors_of(&self, role: Role) -> impl Iterator<Item = ActorId> {
        let numbered = self.actors.iter().zip(0u16..);
        numbered.filter(move |(a, _)| a.role == role).map(|(_, i)| ActorId(i))
    }

    #[must_use]
    pub fn actor_named(&self, name: &str) -> Option<ActorId> {
        let at = self.actors.iter().position(|a| a.name == name)?;
        u16::try_from(at).ok().map(ActorId)
    }
}
