//! `Scenario`: what was written, with every name resolved to an id and every expression typed.
//!
//! It still has the language's own constructs (requirement patterns, stimuli on edges, parts' frames); lowering turns
//! them into what the engines execute.

use std::collections::BTreeSet;

use hrdsl_source::{Enumeration, Span};
use hrdsl_syntax::ast::LocationKind;
use serde::Serialize;

use crate::{
    Expr, Leaf, Place, Type, Value,
    world::{Action, World},
};

pub use hrdsl_ir::{
    ActorId, EventId, Role,
    bdi::{AgentId, Annotation, BeliefId, ContentId, Control, GoalId, Performative, Subject},
    coverage::{Bin, Condition, Cross, CrossBin, PointId},
    list::ListFunction,
    monitor::RequirementKind,
    suite::{ChoiceKind, Delays, Explore, PlayerRef, WitnessKind},
    ta::{AutomatonId, ChannelId, ClockId, ClockOp, FunctionId, LocationId},
    world::{ArmId, BodyId, BodyRef, CurrentId, GripperId, JointId, Motion, SignalId},
};

macro_rules! ids {
    ($($(#[$doc:meta])* $name:ident),* $(,)?) => { $(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
        pub struct $name(pub u16);
    )* };
}

ids! {
    /// Index into [`Scenario::networks`].
    NetworkId,
    /// Index into [`Scenario::queries`].
    QueryId,
    /// Index into [`Scenario::requirements`].
    RequirementId,
    /// Index into [`Scenario::crosses`].
    CrossId,
}

/// A whole scenario, resolved. If there were errors, what they concern is missing from it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Scenario {
    pub name: String,
    pub actors: Vec<Actor>,
    pub enums: Vec<Enum>,
    pub events: Vec<Event>,
    pub agents: Vec<Agent>,
    pub contents: Vec<Content>,
    pub shared: Vec<Var>,
    pub functions: Vec<Routine>,
    /// Clocks that all automata share.
    pub clocks: Vec<SharedClock>,
    pub channels: Vec<Channel>,
    pub automata: Vec<Automaton>,
    pub networks: Vec<Network>,
    pub queries: Vec<crate::Query>,
    pub requirements: Vec<Requirement>,
    pub assumptions: Vec<Assumption>,
    pub points: Vec<CoverPoint>,
    pub crosses: Vec<Cross>,
    pub suites: Vec<Suite>,
    pub tests: Vec<Test>,
    pub world: Option<World>,
    pub system: Option<System>,
    pub declared: Vec<Named>,
    #[serde(skip)]
    pub places: Places,
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
    pub automata: Vec<AutomatonPlaces>,
    pub networks: Vec<Span>,
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

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct VarPlace {
    pub name: Span,
    /// The whole declaration.
    pub whole: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Actor {
    pub name: String,
    pub role: Role,
    pub span: Span,
}

/// An enumeration.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Enum {
    pub of: Enumeration,
    pub span: Span,
}

/// A parameter of one value. One of a record or array is as many as it has parts, `to.x` and `to.y`, `a[0]` and `a[1]`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Param {
    pub name: String,
    pub ty: Type,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Event {
    pub name: String,
    pub params: Vec<Param>,
    pub from: ActorId,
    /// Empty: everybody else.
    pub to: Vec<ActorId>,
    pub stimulus: Option<Stimulus>,
    pub span: Span,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Stimulus {
    pub samples: Vec<Sample>,
    pub steps: Vec<StimulusStep>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sample {
    pub name: String,
    pub ty: Type,
    pub lo: Expr,
    pub hi: Expr,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StimulusStep {
    Emit { event: EventId, args: Vec<Expr> },
    Hold(Expr),
    Act(Action),
    If { condition: Expr, then: Vec<StimulusStep>, otherwise: Vec<StimulusStep> },
}

/// What an event must look like; an argument that is `None` may be anything.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EventPattern {
    pub event: EventId,
    pub args: Vec<Option<Value>>,
}

// ── Agents ──

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Agent {
    pub name: String,
    pub actor: ActorId,
    /// Those declared, then the strong negations of some of them.
    pub beliefs: Vec<Belief>,
    pub goals: Vec<Goal>,
    pub rules: Vec<Rule>,
    pub initial_beliefs: Vec<Fact>,
    pub initial_goals: Vec<(GoalId, Vec<Value>)>,
    pub plans: Vec<Plan>,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Belief {
    /// A strong negation's begins with `~`.
    pub name: String,
    pub params: Vec<Param>,
    /// What its facts may have besides `source`, each with one value.
    pub annotations: Vec<Param>,
    /// It holds the arguments of the latest such event that was perceived.
    pub percept: Option<EventId>,
    /// It is the strong negation of this one.
    pub negates: Option<BeliefId>,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Goal {
    pub name: String,
    pub arity: u16,
    /// If its arguments' types are declared.
    pub params: Option<Vec<Param>>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Rule {
    pub belief: BeliefId,
    pub args: Vec<Arg>,
    pub body: Context,
    pub vars: Vec<String>,
    pub span: Span,
    pub head: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fact {
    pub belief: BeliefId,
    pub args: Vec<Value>,
    pub annotations: Vec<(Annotation, Value)>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Plan {
    pub label: String,
    pub atomic: bool,
    pub trigger: TriggerOn,
    pub args: Vec<Arg>,
    pub annotations: Vec<(Annotation, Arg)>,
    pub context: Context,
    pub body: Vec<Step>,
    pub vars: Vec<String>,
    pub span: Span,
    /// The trigger, and the name in it.
    pub head: Span,
    pub name: Span,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TriggerOn {
    Added(BeliefId),
    Removed(BeliefId),
    Achieve(GoalId),
    Failed(GoalId),
    Test(BeliefId),
    TestFailed(BeliefId),
    Perceived(EventId),
}

impl TriggerOn {
    /// The belief that it is about.
    #[must_use]
    pub fn belief(self) -> Option<BeliefId> {
        match self {
            TriggerOn::Added(b) | TriggerOn::Removed(b) | TriggerOn::Test(b) | TriggerOn::TestFailed(b) => {
                Some(b)
            }
            TriggerOn::Achieve(_) | TriggerOn::Failed(_) | TriggerOn::Perceived(_) => None,
        }
    }
}

/// A term that is matched.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Arg {
    Any,
    /// Bound here, or compared if it has a value already.
    Var(u16),
    Expr(Expr),
    /// `[A, _ | Rest]`
    List(Vec<Arg>, Option<Box<Arg>>),
}

impl Arg {
    /// Calls `f` with each variable that is bound or compared as a whole.
    pub fn each_var(&self, f: &mut dyn FnMut(u16)) {
        match self {
            Arg::Any | Arg::Expr(_) => {}
            Arg::Var(i) => f(*i),
            Arg::List(items, rest) => {
                items.iter().for_each(|a| a.each_var(f));
                rest.iter().for_each(|a| a.each_var(f));
            }
        }
    }
}

/// A belief that is matched.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Literal {
    pub belief: BeliefId,
    pub args: Vec<Arg>,
    pub annotations: Vec<(Annotation, Arg)>,
    pub span: Span,
}

/// A belief that is made.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Assertion {
    pub belief: BeliefId,
    pub args: Vec<Expr>,
    pub annotations: Vec<(Annotation, Expr)>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Context {
    True,
    Belief(Literal),
    Not(Box<Context>),
    And(Vec<Context>),
    Or(Vec<Context>),
    Test(Expr),
    /// `X = e`
    Unify(Arg, Expr),
    Internal(Box<Internal>, Span),
}

impl Context {
    /// Calls `f` with the formula and each formula in it, the whole first.
    pub fn each<'a>(&'a self, f: &mut dyn FnMut(&'a Context)) {
        f(self);
        match self {
            Context::Not(inner) => inner.each(f),
            Context::And(all) | Context::Or(all) => all.iter().for_each(|c| c.each(f)),
            Context::Internal(action, _) => action.formula().iter().for_each(|c| c.each(f)),
            Context::True | Context::Belief(_) | Context::Test(_) | Context::Unify(..) => {}
        }
    }

    /// The variables that it may bind.
    #[must_use]
    pub fn binds(&self) -> Vec<u16> {
        let mut vars = Vec::new();
        let mut add = |var| vars.push(var);
        match self {
            Context::True | Context::Not(_) | Context::Test(_) => {}
            Context::And(all) | Context::Or(all) => return all.iter().flat_map(Context::binds).collect(),
            Context::Belief(literal) => {
                literal.args.iter().for_each(|a| a.each_var(&mut add));
                literal.annotations.iter().for_each(|(_, a)| a.each_var(&mut add));
            }
            Context::Unify(term, _) => term.each_var(&mut add),
            Context::Internal(action, _) => action.terms().into_iter().for_each(|a| a.each_var(&mut add)),
        }
        vars
    }
}

/// An internal action that asks.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Internal {
    FindAll { template: Expr, formula: Context, set: bool, out: Arg },
    Count { formula: Context, out: Arg },
    Member { element: Arg, list: Expr },
    Apply { function: ListFunction, args: Vec<Expr>, out: Arg },
    Holds { function: ListFunction, args: Vec<Expr> },
    Intend { goal: GoalId, args: Vec<Arg> },
    Desire { goal: GoalId, args: Vec<Arg> },
    Suspended { goal: GoalId, args: Vec<Arg> },
    Random { from: Option<Expr>, out: Arg },
    Shuffle { list: Expr, out: Arg },
    Time { out: Arg },
    MyName { out: Arg },
    AllNames { out: Arg },
}

impl Internal {
    /// The formula that it asks.
    #[must_use]
    pub fn formula(&self) -> Option<&Context> {
        match self {
            Internal::FindAll { formula, .. } | Internal::Count { formula, .. } => Some(formula),
            Internal::Member { .. }
            | Internal::Apply { .. }
            | Internal::Holds { .. }
            | Internal::Intend { .. }
            | Internal::Desire { .. }
            | Internal::Suspended { .. }
            | Internal::Random { .. }
            | Internal::Shuffle { .. }
            | Internal::Time { .. }
            | Internal::MyName { .. }
            | Internal::AllNames { .. } => None,
        }
    }

    /// What it matches.
    #[must_use]
    pub fn terms(&self) -> Vec<&Arg> {
        match self {
            Internal::FindAll { out, .. }
            | Internal::Count { out, .. }
            | Internal::Member { element: out, .. }
            | Internal::Apply { out, .. }
            | Internal::Random { out, .. }
            | Internal::Shuffle { out, .. }
            | Internal::Time { out }
            | Internal::MyName { out }
            | Internal::AllNames { out } => vec![out],
            Internal::Holds { .. } => Vec::new(),
            Internal::Intend { args, .. }
            | Internal::Desire { args, .. }
            | Internal::Suspended { args, .. } => args.iter().collect(),
        }
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Step {
    pub kind: StepKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StepKind {
    Do(EventId, Vec<Expr>),
    /// The time is in seconds.
    Achieve(GoalId, Vec<Expr>, Option<Expr>),
    Spawn(GoalId, Vec<Expr>),
    Query(Literal),
    /// `?(F)`, `X = e`, an internal action that asks
    Test(Context),
    Add(Assertion),
    Remove(Literal),
    Replace(Assertion),
    Abolish(Literal),
    /// `within` in seconds
    Await {
        events: Vec<EventPattern>,
        within: Option<Expr>,
    },
    Wait(Expr),
    If {
        condition: Context,
        then: Vec<Step>,
        otherwise: Vec<Step>,
    },
    While {
        condition: Context,
        body: Vec<Step>,
    },
    For {
        condition: Context,
        body: Vec<Step>,
    },
    Fork {
        branches: Vec<Vec<Step>>,
        all: bool,
    },
    /// Without `to`: to all others.
    Send {
        to: Option<Expr>,
        performative: Performative,
        content: ContentId,
        args: Vec<Arg>,
    },
    Ask {
        to: Expr,
        content: ContentId,
        args: Vec<Arg>,
        within: Option<Expr>,
    },
    AskAll {
        to: Expr,
        template: Expr,
        content: ContentId,
        args: Vec<Arg>,
        out: Arg,
        within: Option<Expr>,
    },
    Print(Vec<Expr>),
    Control(Control, Option<(GoalId, Vec<Arg>)>),
    Fail,
}

/// Calls `f` with each step, those within blocks too, in the order of the text.
pub fn each_step<'a>(steps: &'a [Step], f: &mut dyn FnMut(&'a Step)) {
    for step in steps {
        f(step);
        step.blocks().into_iter().for_each(|block| each_step(block, f));
    }
}

impl Step {
    /// The steps within it.
    #[must_use]
    pub fn blocks(&self) -> Vec<&[Step]> {
        match &self.kind {
            StepKind::If { then, otherwise, .. } => vec![then, otherwise],
            StepKind::While { body, .. } | StepKind::For { body, .. } => vec![body],
            StepKind::Fork { branches, .. } => branches.iter().map(Vec::as_slice).collect(),
            StepKind::Do(..)
            | StepKind::Achieve(..)
            | StepKind::Spawn(..)
            | StepKind::Query(_)
            | StepKind::Test(_)
            | StepKind::Add(_)
            | StepKind::Remove(_)
            | StepKind::Replace(_)
            | StepKind::Abolish(_)
            | StepKind::Await { .. }
            | StepKind::Wait(_)
            | StepKind::Send { .. }
            | StepKind::Ask { .. }
            | StepKind::AskAll { .. }
            | StepKind::Print(_)
            | StepKind::Control(..)
            | StepKind::Fail => Vec::new(),
        }
    }

    /// The formula that it asks.
    #[must_use]
    pub fn condition(&self) -> Option<&Context> {
        match &self.kind {
            StepKind::Test(condition)
            | StepKind::If { condition, .. }
            | StepKind::While { condition, .. }
            | StepKind::For { condition, .. } => Some(condition),
            StepKind::Do(..)
            | StepKind::Achieve(..)
            | StepKind::Spawn(..)
            | StepKind::Query(_)
            | StepKind::Add(_)
            | StepKind::Remove(_)
            | StepKind::Replace(_)
            | StepKind::Abolish(_)
            | StepKind::Await { .. }
            | StepKind::Wait(_)
            | StepKind::Fork { .. }
            | StepKind::Send { .. }
            | StepKind::Ask { .. }
            | StepKind::AskAll { .. }
            | StepKind::Print(_)
            | StepKind::Control(..)
            | StepKind::Fail => None,
        }
    }
}

/// What messages are about: a belief or a goal by name and number of arguments.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Content {
    pub name: String,
    pub is_goal: bool,
    pub arity: usize,
    /// By agent.
    pub of: Vec<Option<Subject>>,
    /// What it is sent with, and by whom; `None` is a question that waits for its answer.
    pub uses: BTreeSet<(Option<Performative>, AgentId)>,
}

// ── Automata ──

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Var {
    pub name: String,
    /// Finite.
    pub ty: Type,
    pub init: Value,
    /// Its name, where it is declared.
    pub span: Span,
}

/// A clock that all automata share, or one of an array of them: `t[0]`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SharedClock {
    pub name: String,
    /// Where the variable is declared.
    pub place: VarPlace,
}

/// A medium between automata: for each combination of arguments one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Channel {
    pub name: String,
    pub kind: ChannelKind,
    /// Time does not pass while a transition over it is possible.
    pub urgent: bool,
    /// Finite types.
    pub params: Vec<Param>,
    pub place: Span,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ChannelKind {
    HandShake,
    Broadcast,
    Joint(Vec<Party>),
}

/// An automaton that has a part in a joint channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Party {
    pub automaton: AutomatonId,
    pub optional: bool,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Automaton {
    pub name: String,
    /// `None`: it knows channels only.
    pub actor: Option<ActorId>,
    pub clocks: Vec<String>,
    pub vars: Vec<Var>,
    pub locations: Vec<Location>,
    pub initial: LocationId,
    pub edges: Vec<Edge>,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Location {
    pub name: String,
    pub kind: LocationKind,
    pub invariant: Vec<ClockConstraint>,
    /// The part of the invariant over variables.
    pub holds: Option<Expr>,
    pub span: Span,
}

/// `clock - minus op bound`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClockConstraint {
    pub clock: ClockId,
    pub minus: Option<ClockId>,
    pub op: ClockOp,
    pub bound: Time,
}

impl ClockConstraint {
    /// Its clocks.
    pub fn clocks(&self) -> impl Iterator<Item = ClockId> {
        std::iter::once(self.clock).chain(self.minus)
    }
}

/// A time that variables may have a part in, in nanoseconds: `nanos + Σ factor · value`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Time {
    pub nanos: i64,
    /// Each value is a whole number.
    pub terms: Vec<(i64, Expr)>,
}

impl Time {
    #[must_use]
    pub fn constant(nanos: i64) -> Self {
        Self { nanos, terms: Vec::new() }
    }

    /// The nanoseconds, if no variable has a part in it.
    #[must_use]
    pub fn fixed(&self) -> Option<i64> {
        self.terms.is_empty().then_some(self.nanos)
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Edge {
    pub from: LocationId,
    pub to: LocationId,
    /// Finite types.
    pub selects: Vec<Param>,
    pub clock_guard: Vec<ClockConstraint>,
    pub guard: Option<Expr>,
    pub sync: Sync,
    pub updates: Vec<Update>,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Sync {
    Internal,
    Send {
        event: EventId,
        args: Vec<Expr>,
    },
    Receive {
        event: EventId,
        args: Vec<ReceiveArg>,
    },
    /// `do c(…)`
    Offer {
        channel: ChannelId,
        args: Vec<Expr>,
    },
    /// `on c(…)`
    Accept {
        channel: ChannelId,
        args: Vec<ReceiveArg>,
    },
    /// `on c` of a joint channel
    Join {
        channel: ChannelId,
    },
}

impl Sync {
    /// The channel that it is a part in.
    #[must_use]
    pub fn channel(&self) -> Option<ChannelId> {
        match self {
            Sync::Internal | Sync::Send { .. } | Sync::Receive { .. } => None,
            Sync::Offer { channel, .. } | Sync::Accept { channel, .. } | Sync::Join { channel } => {
                Some(*channel)
            }
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ReceiveArg {
    Any,
    Is(Value),
    /// The next local of the edge, after the selects.
    Bind,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Update {
    Shared(u16, Expr),
    Own(u16, Expr),
    /// The clock becomes `from + to`; without `from`, just `to`.
    Reset {
        clock: ClockId,
        from: Option<ClockId>,
        to: Time,
    },
    /// An element that is chosen at run time.
    Element(Place, Expr),
    /// A function for its effect.
    Call(FunctionId, Vec<Expr>),
}

/// A function of automata.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Routine {
    pub name: String,
    /// The automaton whose variables it knows, too.
    pub owner: Option<AutomatonId>,
    /// Of finite types. They are the first locals of the body's expressions.
    pub params: Vec<Param>,
    /// The locals after them.
    pub locals: Vec<Var>,
    /// `None`: it is for its effect.
    pub result: Option<Type>,
    pub body: Vec<Statement>,
    /// The variables that it may read, or what it calls.
    pub reads: Vec<Leaf>,
    /// The variables that it may assign, or what it calls: none, if it is pure.
    pub assigns: Vec<Leaf>,
    /// Its name, where it is declared.
    pub place: Span,
    pub span: Span,
}

impl Routine {
    /// It assigns nothing but its parameters and locals.
    #[must_use]
    pub fn pure(&self) -> bool {
        self.assigns.is_empty()
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Statement {
    Assign(Place, Expr),
    Call(FunctionId, Vec<Expr>),
    If {
        condition: Expr,
        then: Vec<Statement>,
        otherwise: Vec<Statement>,
    },
    While {
        condition: Expr,
        body: Vec<Statement>,
    },
    /// For each number from `lo` to `hi`, kept in this local.
    For {
        local: u16,
        lo: Expr,
        hi: Expr,
        body: Vec<Statement>,
    },
    Return(Option<Expr>),
}

impl Statement {
    /// Calls `f` with this statement and each one in it, the outer one first.
    pub fn each<'a>(&'a self, f: &mut dyn FnMut(&'a Statement)) {
        f(self);
        match self {
            Statement::Assign(..) | Statement::Call(..) | Statement::Return(_) => {}
            Statement::If { then, otherwise, .. } => {
                then.iter().chain(otherwise).for_each(|s| s.each(f));
            }
            Statement::While { body, .. } | Statement::For { body, .. } => {
                body.iter().for_each(|s| s.each(f));
            }
        }
    }

    /// The expressions of the statement itself, not of those in it; the indices of what it assigns are not among them.
    #[must_use]
    pub fn expressions(&self) -> Vec<&Expr> {
        match self {
            Statement::Assign(_, e) | Statement::Return(Some(e)) => vec![e],
            Statement::Call(_, args) => args.iter().collect(),
            Statement::If { condition, .. } | Statement::While { condition, .. } => vec![condition],
            Statement::For { lo, hi, .. } => vec![lo, hi],
            Statement::Return(None) => Vec::new(),
        }
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Network {
    pub name: String,
    pub automata: Vec<AutomatonId>,
    pub span: Span,
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

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Assumption {
    pub events: Vec<EventPattern>,
    pub at_most: u32,
    /// Seconds.
    pub within: Option<f64>,
    pub span: Span,
}

// ── Coverage ──

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CoverPoint {
    pub name: String,
    pub count: Vec<EventPattern>,
    pub bins: Vec<Bin>,
    pub span: Span,
}

// ── Suites and tests ──

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Suite {
    pub name: String,
    pub method: Method,
    pub tests: u32,
    /// Seconds.
    pub horizon: f64,
    pub patience: f64,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    Agents {
        players: Vec<PlayerRef>,
        choose: Vec<Choice>,
        explore: Explore,
        /// End when so many belief sets in a row reached nothing new.
        stop_after: Option<u32>,
        goals: Vec<ModelGoal>,
        minimise: bool,
    },
    Search {
        network: NetworkId,
        goals: Vec<SearchGoal>,
        witness: WitnessKind,
        delays: Delays,
    },
    Random {
        stimuli: Vec<EventId>,
        awaits: Vec<EventPattern>,
        length: (u32, u32),
        pause: (f64, f64),
    },
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Choice {
    pub agent: AgentId,
    pub belief: BeliefId,
    pub how: ChoiceKind,
    pub condition: Option<ChoiceCondition>,
}

/// `where F` of a choice: what the beliefs that the agent starts with must answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChoiceCondition {
    pub context: Context,
    pub vars: Vec<String>,
    pub span: Span,
}

/// What a suite by agents reaches each of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ModelGoal {
    Bins(CrossId),
    Plans,
    Contexts,
    Edges,
    Messages,
    Paths,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SearchGoal {
    Bins(CrossId),
    Locations,
    Edges,
    Pairs,
    Uses,
    Violation(RequirementId),
    Trigger(RequirementId),
    /// One that asks `E<>`.
    Query(QueryId),
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Test {
    /// As written: `bdi_tests.t017`
    pub name: String,
    /// The names before the last, joined.
    pub suite: String,
    pub seed: u64,
    pub method: String,
    pub because: Vec<String>,
    pub predicts: Vec<String>,
    pub steps: Vec<TestStep>,
    pub span: Span,
}

/// Times in seconds.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TestStep {
    Do { event: EventId, args: Vec<Value>, samples: Vec<Value> },
    Await { events: Vec<EventPattern>, within: f64 },
    Wait(f64),
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct System {
    pub actor: ActorId,
    pub run: String,
    pub coverage: Vec<String>,
    /// Seconds.
    pub limit: f64,
    pub budget: f64,
    /// Seconds.
    pub cpu: Option<f64>,
    pub wall: Option<f64>,
    /// Bytes.
    pub memory: Option<f64>,
    pub output: Option<f64>,
    /// Names of variables.
    pub env: Vec<String>,
    pub online: bool,
    pub span: Span,
}
