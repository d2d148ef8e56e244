//! `Scenario`: what was written, with every name resolved to an id and every expression typed.
//!
//! Its types are those of the Program ([`hrdsl_ir`]), over typed expressions with the places of the source. What has a form
//! of its own is what lowering takes apart: requirement patterns, measurements in expressions, parts' frames.

use crate::Resolutions;
use std::collections::{BTreeMap, BTreeSet};

use hrdsl_ir::device::DeviceKind;
use hrdsl_source::{Enumeration, Span};
use serde::Serialize;

use crate::{Expr, Leaf, world::World};

pub use hrdsl_ir::{
    Actor, ActorId, ArgPattern, EventId, EventPattern, List, Param, Role, Symbol, Text, Type, Value,
    bdi::{
        AgentId, Annotation, Belief, BeliefId, Content, ContentId, Control, Fact, Goal, GoalId, Performative,
        Subject, TriggerOn,
    },
    coverage::{Bin, Condition, Cross, CrossBin, CrossId, Point as CoverPoint, PointId},
    list::ListFunction,
    monitor::{RequirementId, RequirementKind},
    suite::{ChoiceKind, Delays, Explore, ModelGoal, PlayerRef, SearchGoal, WitnessKind},
    system::System,
    ta::{
        AutomatonId, Channel, ChannelId, ChannelKind, ClockId, ClockOp, FunctionId, LocationId, LocationKind,
        Network, NetworkId, Party, QueryId, ReceiveArg, Var,
    },
    test::{Test, TestStep},
    world::{
        ArmId, Axis, BodyId, BodyRef, Current, CurrentId, GripperId, JointId, Motion, Shape, SignalId, Term,
    },
};

// The Program's trees over the checker's expressions and variables.
pub type Event = hrdsl_ir::Event<Expr>;
pub type Stimulus = hrdsl_ir::event::Stimulus<Expr>;
pub type StimulusStep = hrdsl_ir::event::StimulusStep<Expr>;
pub type Sample = hrdsl_ir::event::Sample<Expr>;
pub type WorldAction = hrdsl_ir::world::WorldAction<Expr>;
pub type Point = hrdsl_ir::world::Point<Expr>;
pub type Agent = hrdsl_ir::bdi::Agent<Expr>;
pub type Rule = hrdsl_ir::bdi::Rule<Expr>;
pub type Plan = hrdsl_ir::bdi::Plan<Expr>;
pub type Trigger = hrdsl_ir::bdi::Trigger<Expr>;
pub type Arg = hrdsl_ir::bdi::Term<Expr>;
pub type Literal = hrdsl_ir::bdi::Literal<Expr>;
pub type Assertion = hrdsl_ir::bdi::Assertion<Expr>;
pub type Context = hrdsl_ir::bdi::Context<Expr>;
pub type Internal = hrdsl_ir::bdi::Internal<Expr>;
pub type Step = hrdsl_ir::bdi::Step<Expr>;
pub type StepKind = hrdsl_ir::bdi::StepKind<Expr>;
pub type Automaton = hrdsl_ir::ta::Automaton<Expr, Leaf>;
pub type Location = hrdsl_ir::ta::Location<Expr>;
pub type Edge = hrdsl_ir::ta::Edge<Expr, Leaf>;
pub type Sync = hrdsl_ir::ta::Sync<Expr>;
pub type Update = hrdsl_ir::ta::Update<Expr, Leaf>;
pub type ClockConstraint = hrdsl_ir::ta::ClockConstraint<Expr>;
pub type Time = hrdsl_ir::ta::Time<Expr>;
pub type TimeTerm = hrdsl_ir::ta::TimeTerm<Expr>;
pub type Function = hrdsl_ir::ta::Function<Expr, Leaf>;
pub type Statement = hrdsl_ir::ta::Statement<Expr, Leaf>;
pub type Ask = hrdsl_ir::ta::Ask<Expr>;
pub type Formula = hrdsl_ir::ta::Formula<Expr>;
pub type Measure = hrdsl_ir::ta::Measure<Expr>;
pub type Suite = hrdsl_ir::suite::Suite<Expr>;
pub type Method = hrdsl_ir::suite::Method<Expr>;
pub type Choice = hrdsl_ir::suite::Choice<Expr>;
pub type ChoiceCondition = hrdsl_ir::suite::Condition<Expr>;

/// A whole scenario, resolved. If there were errors, what they concern is missing from it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Scenario {
    pub name: String,
    pub actors: Vec<Actor>,
    pub enums: Vec<Enum>,
    pub events: Vec<Event>,
    pub agents: Vec<Agent>,
    pub contents: Vec<Content>,
    /// How the contents are used, by their ids.
    pub speech: Vec<Speech>,
    pub shared: Vec<Var>,
    pub functions: Vec<Function>,
    /// What the functions read and assign, by their ids.
    pub effects: Vec<Effects>,
    /// Clocks that all automata share.
    pub clocks: Vec<String>,
    pub channels: Vec<Channel>,
    pub automata: Vec<Automaton>,
    pub networks: Vec<Network>,
    pub queries: Vec<Query>,
    pub requirements: Vec<Requirement>,
    pub assumptions: Vec<Assumption>,
    pub points: Vec<CoverPoint>,
    pub crosses: Vec<Cross>,
    pub suites: Vec<Suite>,
    pub tests: Vec<Test>,
    pub device_kinds: Vec<DeviceKind>,
    pub world: Option<World>,
    pub system: Option<System>,
    pub declared: Vec<Named>,
    #[serde(skip)]
    pub places: Places,
    #[serde(skip)]
    pub names: Resolutions,
}

/// A declaration of which nothing is left where it is used: a constant, a type, a template, a part.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Named {
    /// `the constant`
    pub noun: &'static str,
    pub name: String,
    /// The name's.
    pub place: Span,
    pub span: Span,
    /// Something reads it.
    pub used: bool,
}

/// Where names stand that a diagnostic points at; each list is by the id of its elements.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Places {
    pub events: Vec<Span>,
    pub agents: Vec<AgentPlaces>,
    pub shared: Vec<VarPlace>,
    /// Of clocks that all automata share.
    pub clocks: Vec<VarPlace>,
    pub channels: Vec<ChannelPlaces>,
    pub functions: Vec<FunctionPlaces>,
    pub automata: Vec<AutomatonPlaces>,
    pub networks: Vec<Span>,
    /// By coverpoint: the names of its bins.
    pub bins: Vec<Vec<Span>>,
    /// By kind of device and name: the commands.
    pub commands: BTreeMap<(&'static str, String), Span>,
    /// By suite: what it awaits.
    pub awaits: Vec<Vec<Span>>,
    pub signals: Vec<Span>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct AgentPlaces {
    pub name: Span,
    pub beliefs: Vec<Span>,
    /// By plan: the trigger without its operator.
    pub triggers: Vec<Span>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct AutomatonPlaces {
    pub name: Span,
    pub clocks: Vec<Span>,
    pub vars: Vec<VarPlace>,
    pub locations: Vec<Span>,
    /// By edge: the event after `on`, or without it the edge.
    pub waits: Vec<Span>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ChannelPlaces {
    pub name: Span,
    /// Of a joint one's participants.
    pub parties: Vec<Span>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FunctionPlaces {
    pub name: Span,
    /// The names of the locals.
    pub locals: Vec<Span>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct VarPlace {
    pub name: Span,
    /// The whole declaration.
    pub whole: Span,
}

/// An enumeration.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Enum {
    pub of: Enumeration,
    pub span: Span,
}

/// How messages use a content.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Speech {
    pub is_goal: bool,
    pub arity: usize,
    /// What it is sent with, and by whom; `None` is a question that waits for its answer.
    pub uses: BTreeSet<(Option<Performative>, AgentId)>,
}

/// What a function of automata may do to variables, itself or by what it calls.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Effects {
    pub reads: Vec<Leaf>,
    /// None, if it is pure.
    pub assigns: Vec<Leaf>,
}

// ── Requirements ──

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Requirement {
    pub name: String,
    pub kind: RequirementKind,
    pub title: String,
    pub pattern: Pattern,
    /// The formal part.
    pub text: Span,
    pub span: Span,
}

/// Times in seconds.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Pattern {
    Causes { trigger: Vec<EventPattern>, response: Vec<EventPattern>, within: Option<f64> },
    Forbids { trigger: Vec<EventPattern>, forbidden: Vec<EventPattern>, until: Vec<EventPattern> },
    NeverWhile { events: Vec<EventPattern>, condition: Option<Expr> },
    Globally(Expr),
}

/// `assume at most N e within D`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Assumption {
    pub events: Vec<EventPattern>,
    pub at_most: u32,
    /// Seconds.
    pub within: Option<f64>,
    pub span: Span,
}

/// A question about a network. In its expressions, [`Leaf::Own`] counts the variables of all automata, in the network's order.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Query {
    pub name: String,
    pub title: String,
    /// The formal part.
    pub text: Span,
    pub network: NetworkId,
    pub ask: Ask,
    pub span: Span,
}
