//! `Scenario`: what was written, with every name resolved to an id and every expression typed.
//!
//! Its types are those of the Program ([`hrdsl_ir`]), over typed expressions with the places of the source. What has a form
//! of its own is what lowering takes apart: requirement patterns, measurements in expressions, parts' frames.

use crate::Resolutions;
use std::collections::{BTreeMap, BTreeSet};

use hrdsl_ir::device::DeviceKind;
use hrdsl_source::{Enumeration, Span};
use serde::Serialize;

use crate::{TypedExpr, VariableRef, world::TypedWorld};

pub use hrdsl_ir::{
    Actor, ActorId, ArgPattern, EventId, EventPattern, List, Parameter, Provenance, Role, Symbol, Text, Type,
    Value,
    bdi::{
        AgentId, BeliefAnnotation, BeliefDecl, BeliefId, ContentId, ControlAct, GoalDecl, GoalId,
        InitialFact, MessageContent, MessageSubject, Performative, TriggerOn,
    },
    coverage::{
        BinCondition, CoverBin, CoverCross, Coverpoint as CoverPoint, CoverpointId, CrossBin, CrossId,
    },
    list::ListFunction,
    monitor::{RequirementId, RequirementKind},
    suite::{
        BoundaryStep, ChoiceKind, CombinationKind, DelayChoice, ExploreMode, ModelGoal, PlayerRef,
        WitnessKind,
    },
    system::{SystemProgram, SystemUnderTest},
    ta::{
        AutomatonId, AutomatonVar, Channel, ChannelId, ChannelKind, ChannelParticipant, ClockId, ClockOp,
        FunctionId, LocationId, LocationKind, Network, NetworkId, QueryId, ReceiveArg,
    },
    test::{Test, TestStep},
    world::{
        ArmId, Axis, BaseId, BodyId, BodyMotion, BodyRef, BodyShape, CurrentBody, CurrentId, FigureId,
        GripperId, JointId, LaserId, SignalId, SignalTerm,
    },
};

// The Program's trees over the checker's expressions and variables.
pub type TypedEvent = hrdsl_ir::Event<TypedExpr>;
pub type TypedStimulus = hrdsl_ir::event::Stimulus<TypedExpr>;
pub type TypedStimulusStep = hrdsl_ir::event::StimulusStep<TypedExpr>;
pub type TypedSample = hrdsl_ir::event::StimulusSample<TypedExpr>;
pub type TypedWorldAction = hrdsl_ir::world::WorldAction<TypedExpr>;
pub type TypedPoint = hrdsl_ir::world::WorldPoint<TypedExpr>;
pub type TypedAgent = hrdsl_ir::bdi::Agent<TypedExpr>;
pub type TypedBeliefRule = hrdsl_ir::bdi::BeliefRule<TypedExpr>;
pub type TypedPlan = hrdsl_ir::bdi::Plan<TypedExpr>;
pub type TypedTrigger = hrdsl_ir::bdi::PlanTrigger<TypedExpr>;
pub type TypedTerm = hrdsl_ir::bdi::AgentTerm<TypedExpr>;
pub type TypedLiteral = hrdsl_ir::bdi::BeliefLiteral<TypedExpr>;
pub type TypedAssertion = hrdsl_ir::bdi::Assertion<TypedExpr>;
pub type TypedContext = hrdsl_ir::bdi::PlanContext<TypedExpr>;
pub type TypedInternalAct = hrdsl_ir::bdi::InternalAct<TypedExpr>;
pub type TypedStep = hrdsl_ir::bdi::PlanStep<TypedExpr>;
pub type TypedStepKind = hrdsl_ir::bdi::PlanStepKind<TypedExpr>;
pub type TypedAutomaton = hrdsl_ir::ta::Automaton<TypedExpr, VariableRef>;
pub type TypedLocation = hrdsl_ir::ta::Location<TypedExpr>;
pub type TypedEdge = hrdsl_ir::ta::Edge<TypedExpr, VariableRef>;
pub type TypedSync = hrdsl_ir::ta::SyncLabel<TypedExpr>;
pub type TypedUpdate = hrdsl_ir::ta::EdgeAssignment<TypedExpr, VariableRef>;
pub type TypedClockConstraint = hrdsl_ir::ta::ClockConstraint<TypedExpr>;
pub type TypedTime = hrdsl_ir::ta::TimeSum<TypedExpr>;
pub type TypedTimeTerm = hrdsl_ir::ta::TimeTerm<TypedExpr>;
pub type TypedFunction = hrdsl_ir::ta::AutomatonFunction<TypedExpr, VariableRef>;
pub type TypedStatement = hrdsl_ir::ta::FunctionStatement<TypedExpr, VariableRef>;
/// In its expressions, [`VariableRef::Own`] counts the variables of all automata, in the network's order.
pub type TypedQuery = hrdsl_ir::ta::Query<TypedExpr, Span>;
pub type TypedQueryKind = hrdsl_ir::ta::QueryKind<TypedExpr>;
pub type TypedFormula = hrdsl_ir::ta::QueryFormula<TypedExpr>;
pub type TypedMeasure = hrdsl_ir::ta::QueryMeasure<TypedExpr>;
pub type TypedSuite = hrdsl_ir::suite::Suite<TypedExpr, Span>;
pub type TypedMethod = hrdsl_ir::suite::SuiteMethod<TypedExpr, Span>;
pub type TypedSearchGoal = hrdsl_ir::suite::SearchGoal<TypedExpr, Span>;
pub type TypedCombinations = hrdsl_ir::suite::ValueCombinations<TypedExpr, Span>;
pub type TypedCombinedTerm = hrdsl_ir::suite::CombinedTerm<TypedExpr, Span>;
pub type TypedCombinationCondition = hrdsl_ir::suite::CombinationCondition<TypedExpr, Span>;
pub type TypedChoice = hrdsl_ir::suite::BeliefChoice<TypedExpr>;
pub type TypedChoiceCondition = hrdsl_ir::suite::BeliefCondition<TypedExpr>;
pub type TypedAssumption = hrdsl_ir::monitor::Assumption<Span>;
/// Over terms and signals; which signals it reads is found when it is lowered.
pub type TypedWorldRule = hrdsl_ir::world::WorldRule<TypedExpr>;

/// A whole scenario, resolved. If there were errors, what they concern is missing from it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Scenario {
    pub name: String,
    pub actors: Vec<Actor>,
    pub enums: Vec<EnumDecl>,
    pub events: Vec<TypedEvent>,
    /// By event: whose word it is.
    pub provenance: Vec<Provenance>,
    pub agents: Vec<TypedAgent>,
    pub contents: Vec<MessageContent>,
    /// How the contents are used, by their ids.
    pub speech: Vec<AgentSpeech>,
    pub shared: Vec<AutomatonVar>,
    pub functions: Vec<TypedFunction>,
    /// What the functions read and assign, by their ids.
    pub effects: Vec<FunctionEffects>,
    /// Clocks that all automata share.
    pub clocks: Vec<String>,
    pub channels: Vec<Channel>,
    pub automata: Vec<TypedAutomaton>,
    pub networks: Vec<Network>,
    pub queries: Vec<TypedQuery>,
    pub requirements: Vec<TypedRequirement>,
    pub assumptions: Vec<TypedAssumption>,
    pub points: Vec<CoverPoint>,
    pub crosses: Vec<CoverCross>,
    pub suites: Vec<TypedSuite>,
    pub tests: Vec<Test>,
    pub device_kinds: Vec<DeviceKind>,
    pub world: Option<TypedWorld>,
    pub systems: Vec<SystemUnderTest<TypedExpr>>,
    #[serde(skip)]
    pub places: DeclarationPlaces,
    #[serde(skip)]
    pub names: Resolutions,
}

impl Scenario {
    /// The automata of a network, in its order.
    pub(crate) fn members(&self, network: &Network) -> impl Iterator<Item = &TypedAutomaton> {
        network.automata.iter().filter_map(|id| self.automata.get(usize::from(id.0)))
    }

    /// A location of a network in which a clock stands still, with its automaton's name.
    pub(crate) fn stopping_location(&self, network: &Network) -> Option<String> {
        self.members(network).find_map(|automaton| {
            let location = automaton.locations.iter().find(|l| !l.stopped.is_empty())?;
            Some(format!("{}.{}", automaton.name, location.name))
        })
    }
}

/// Where names stand that a diagnostic points at; each list is by the id of its elements.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct DeclarationPlaces {
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
    /// By kind of device and name: the states.
    pub states: BTreeMap<(&'static str, String), Span>,
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
    pub participants: Vec<Span>,
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
pub struct EnumDecl {
    pub of: Enumeration,
    pub span: Span,
}

/// How messages use a content.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct AgentSpeech {
    pub is_goal: bool,
    pub arity: usize,
    /// What it is sent with, and by whom; `None` is a question that waits for its answer.
    pub uses: BTreeSet<(Option<Performative>, AgentId)>,
}

/// What a function of automata may do to variables, itself or by what it calls.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FunctionEffects {
    pub reads: Vec<VariableRef>,
    /// None, if it is pure.
    pub assigns: Vec<VariableRef>,
}

// ── Requirements ──

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TypedRequirement {
    pub name: String,
    pub kind: RequirementKind,
    pub title: String,
    /// Its doc comment: where it comes from, such as a standard's clause.
    pub doc: String,
    pub pattern: TypedPattern,
    /// The formal part.
    pub text: Span,
    pub span: Span,
}

impl TypedRequirement {
    /// Whether it speaks of more than events.
    #[must_use]
    pub fn reads_the_world(&self) -> bool {
        let mut conditions = self.pattern.conditions();
        conditions.next().is_some() || self.pattern.events().any(|e| e.as_edge().is_some())
    }
}

/// Times in seconds.
pub type TypedPattern = hrdsl_syntax::RequirementSentence<TypedOccurrence, TypedExpr, f64, u32>;

/// Times in seconds.
pub type TypedTemporal = hrdsl_syntax::TemporalFormula<TypedOccurrence, TypedExpr, f64>;

/// What a requirement takes for an event.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum TypedOccurrence {
    Event(EventPattern),
    /// `rising(P)`, `falling(P)`
    Edge {
        rising: bool,
        condition: TypedExpr,
    },
}

impl TypedOccurrence {
    #[must_use]
    pub fn as_event(&self) -> Option<&EventPattern> {
        if let Self::Event(pattern) = self { Some(pattern) } else { None }
    }

    #[must_use]
    pub fn as_edge(&self) -> Option<(bool, &TypedExpr)> {
        if let Self::Edge { rising, condition } = self { Some((*rising, condition)) } else { None }
    }
}
