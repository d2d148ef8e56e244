//! The abstract syntax tree: what was written, with spans, before any name is looked up.
//!
//! Every node that can be broken has an `Error` form, so that one bad declaration or statement costs that one alone.

use hrdsl_source::Span;

pub use hrdsl_source::{BinaryOp, LocationKind, UnaryOp};
use serde::Serialize;

pub use crate::binding::{
    BindingEntry, BindingEntryKind, BindingMember, BindingMemberKind, ElementSyntax, FieldSyntax,
    GroupSyntax, InterfaceSyntax, MiddlewareSyntax, ServedSyntax, TopicInSyntax, TopicOutSyntax,
};
pub use crate::expr::{
    AllowSyntax, CallSyntax, ExprSyntax, ExprSyntaxKind, LiteralSyntax, NameSyntax, ParamSyntax, PathSyntax,
    RangeSyntax, TextSyntax, TypeExpr,
};
use crate::scope::RequirementSentence;
pub use crate::system::{ProgramSyntax, SystemMember, SystemMemberKind, SystemSyntax};
pub use crate::world::*;

/// One file: a scenario, a stdlib module (no `scenario` line), or a file of tests.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FileSyntax {
    pub scenario: Option<NameSyntax>,
    pub items: Vec<ItemSyntax>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ItemSyntax {
    /// The `///` lines before it, joined by newlines.
    pub doc: String,
    pub kind: ItemSyntaxKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ItemSyntaxKind {
    /// `use std.person`, `use "people.hri"`
    Use(ModuleSyntax),
    /// `allow HR0107 "why"`: the next declaration may be so
    Allow(AllowSyntax),
    /// `enum Order { feed, clean }`
    Enum {
        name: NameSyntax,
        values: Vec<NameSyntax>,
    },
    /// `record Pose { x: length, y: length }`
    Record {
        name: NameSyntax,
        fields: Vec<ParamSyntax>,
    },
    /// `actor person : environment`
    Actor {
        name: NameSyntax,
        role: NameSyntax,
    },
    /// `const LEGS = 4`
    Const {
        name: NameSyntax,
        value: ExprSyntax,
    },
    Event(EventSyntax),
    Stimulus(StimulusSyntax),
    Agent(AgentSyntax),
    /// `var away: bool = false`: shared by all automata
    Var(VarSyntax),
    Automaton(AutomatonSyntax),
    /// `channel take(fork: 0..4), free : urgent`
    Channel(ChannelSyntax),
    /// `fn front() -> 0..5 { return queue[0] }`
    Function(FunctionSyntax),
    /// `query live of table = Person.asked --> Person.shown`
    Query(QuerySyntax),
    /// `network table = Person | Robot`
    Network {
        name: NameSyntax,
        automata: Vec<NameSyntax>,
    },
    Require(RequireSyntax),
    Assume(AssumeSyntax),
    Cover(CoverSyntax),
    Cross(CrossSyntax),
    Suite(SuiteSyntax),
    Part(PartSyntax),
    Device(DeviceSyntax),
    World(WorldSyntax),
    System(SystemSyntax),
    Test(TestSyntax),
    /// `agent Human = Visitor(10 s)`: a template with its arguments
    Instance(InstanceSyntax),
    /// Could not be read; the diagnostic has been made.
    Error,
}

/// What `use` names.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ModuleSyntax {
    /// A module of the library.
    Library(PathSyntax),
    /// A file, relative to the one that uses it.
    File(TextSyntax),
}

/// What a template makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TemplateSyntaxKind {
    Agent,
    Automaton,
    Require,
    Cover,
    Cross,
}

/// `agent Human = Visitor(10 s)`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct InstanceSyntax {
    pub sort: TemplateSyntaxKind,
    pub name: NameSyntax,
    pub of: NameSyntax,
    pub args: Vec<ExprSyntax>,
    /// The template's name with the arguments.
    pub span: Span,
}

// ── Vocabulary ──

/// `event asked, sensed(gaze: bool) from sensors to robot, person`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EventSyntax {
    pub names: Vec<EventName>,
    pub from: NameSyntax,
    pub to: Vec<NameSyntax>,
}

/// One of the events of a line.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EventName {
    pub name: NameSyntax,
    pub params: Vec<ParamSyntax>,
}

/// `stimulus look(ok: bool) by person { … }`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StimulusSyntax {
    pub name: NameSyntax,
    pub params: Vec<ParamSyntax>,
    pub by: NameSyntax,
    pub body: Vec<StimulusStepSyntax>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StimulusStepSyntax {
    pub kind: StimulusStepKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StimulusStepKind {
    /// `sample offset in a .. b`, or `in if ok { a .. b } else { c .. d }`
    Sample {
        name: NameSyntax,
        range: SampleRange,
    },
    /// `emit leg_request`
    Emit(CallSyntax),
    /// `hold 5 s`
    Hold(ExprSyntax),
    /// `person.hand.move_to(leg + (dx, dy, dz), 1 s)`: the last name of the path is the action
    Act {
        path: PathSyntax,
        args: Vec<ExprSyntax>,
    },
    If {
        condition: ExprSyntax,
        then: Vec<StimulusStepSyntax>,
        otherwise: Vec<StimulusStepSyntax>,
    },
    Error,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SampleRange {
    Plain(RangeSyntax),
    If { condition: ExprSyntax, then: Box<SampleRange>, otherwise: Box<SampleRange> },
}

// ── Agents ──

/// `agent Human plays person { … }`; with parameters, a template
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AgentSyntax {
    pub name: NameSyntax,
    /// `Some`: a template.
    pub params: Option<Vec<ParamSyntax>>,
    pub plays: NameSyntax,
    /// What is in the brackets after it: `jason`, or a mistake.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub annotation: Option<NameSyntax>,
    pub members: Vec<AgentMember>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AgentMember {
    pub doc: String,
    pub kind: AgentMemberKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum AgentMemberKind {
    /// `belief had(legs: 0..LEGS) [sure: 0..9] on counted = had(0)`: its annotations; the event whose arguments it holds;
    /// the initial beliefs, if any, separated by commas
    Belief {
        name: NameSyntax,
        params: Vec<ParamSyntax>,
        annotations: Vec<ParamSyntax>,
        on: Option<NameSyntax>,
        initial: Vec<LiteralSyntax>,
    },
    /// `rule near(X) when at(X, D) && D < 3 m`
    Rule {
        head: LiteralSyntax,
        body: Option<ExprSyntax>,
    },
    /// `goal deliver(leg: 1..4)`: the types of its arguments
    GoalType {
        name: NameSyntax,
        params: Vec<ParamSyntax>,
    },
    /// `goal !table`: adopted at the start
    Goal(CallSyntax),
    Plan(PlanSyntax),
    Allow(AllowSyntax),
    Error,
}

/// `plan @label +!table when context { body }`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlanSyntax {
    pub label: Option<LabelSyntax>,
    pub trigger: TriggerSyntax,
    pub context: Option<ExprSyntax>,
    pub body: Vec<StepSyntax>,
}

/// `@label`, `@label[atomic]`
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LabelSyntax {
    pub name: NameSyntax,
    /// What is in the brackets: `atomic`, or a mistake.
    pub atomic: Option<NameSyntax>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TriggerSyntax {
    pub kind: TriggerSyntaxKind,
    pub literal: LiteralSyntax,
    pub span: Span,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TriggerSyntaxKind {
    /// `+b`
    Added,
    /// `-b`
    Removed,
    /// `+!g`
    Achieve,
    /// `-!g`
    Failed,
    /// `+?b`
    Test,
    /// `-?b`
    TestFailed,
    /// `on e`
    On,
}

/// One formula of a plan's body; they are separated by `;`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StepSyntax {
    pub kind: StepSyntaxKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StepSyntaxKind {
    /// a stimulus or event of the agent's actor
    Do(CallSyntax),
    /// `!g within 10 s`
    Achieve {
        call: CallSyntax,
        within: Option<ExprSyntax>,
    },
    /// `!!g`
    Spawn(CallSyntax),
    /// `?b`
    Query(LiteralSyntax),
    /// `?(F)`
    Test(ExprSyntax),
    /// `X = e`
    Unify {
        left: ExprSyntax,
        right: ExprSyntax,
    },
    /// `+b`
    Add(LiteralSyntax),
    /// `-b`
    Remove(LiteralSyntax),
    /// `-+b`
    Replace(LiteralSyntax),
    /// `await a | b within 10 s`
    Await {
        events: Vec<CallSyntax>,
        within: Option<ExprSyntax>,
    },
    /// `wait 10 s`
    Wait(ExprSyntax),
    /// `.send(A, tell, b(X))`
    Internal(CallSyntax),
    /// `if F { … } else { … }`
    If {
        condition: ExprSyntax,
        then: Vec<StepSyntax>,
        otherwise: Vec<StepSyntax>,
    },
    /// `while F { … }`
    While {
        condition: ExprSyntax,
        body: Vec<StepSyntax>,
    },
    /// `for F { … }`
    For {
        condition: ExprSyntax,
        body: Vec<StepSyntax>,
    },
    /// `fork { … } and { … }`, or with `or`: two branches at least
    Fork {
        all: bool,
        branches: Vec<Vec<StepSyntax>>,
    },
    Error,
}

// ── Automata ──

/// `var left: 0..LEGS = 0`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VarSyntax {
    pub name: NameSyntax,
    pub ty: TypeExpr,
    /// Without: `false`, or the range's value nearest to 0.
    pub init: Option<ExprSyntax>,
}

/// `automaton Person plays person { … }`; with parameters, a template
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AutomatonSyntax {
    pub name: NameSyntax,
    pub params: Option<Vec<ParamSyntax>>,
    /// `None`: it knows no events, only channels.
    pub plays: Option<NameSyntax>,
    pub members: Vec<AutomatonMember>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AutomatonMember {
    pub doc: String,
    pub kind: AutomatonMemberKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum AutomatonMemberKind {
    /// `clock x, y`
    Clock(Vec<NameSyntax>),
    Var(VarSyntax),
    /// `init committed location start { invariant x <= 3 s }`
    Location {
        init: bool,
        kind: LocationKind,
        name: NameSyntax,
        invariant: Option<ExprSyntax>,
    },
    Edge(EdgeSyntax),
    /// A function that knows the automaton's variables.
    Function(FunctionSyntax),
    Allow(AllowSyntax),
    Error,
}

/// `a -> b select n: 0..4 when x >= 3 s && n > 0 on e(p) do left = n; x = 0`; each part may be absent, the order is free for
/// `select`, `when`, `on`; `do` comes last.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EdgeSyntax {
    pub from: NameSyntax,
    pub to: NameSyntax,
    pub selects: Vec<ParamSyntax>,
    pub guard: Option<ExprSyntax>,
    pub on: Option<CallSyntax>,
    pub actions: Vec<EdgeAction>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EdgeAction {
    pub kind: EdgeActionKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum EdgeActionKind {
    /// An event or stimulus of the automaton's actor, or a channel; at most one for an edge. Or an update function.
    Send(CallSyntax),
    /// `left = left - 1`, `x = 0` (a clock), `left -= 1`, `seen[i].ok = true`
    Assign { target: NameSyntax, access: Vec<AccessSyntax>, op: Option<BinaryOp>, value: ExprSyntax },
}

/// A step into a variable that has parts.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum AccessSyntax {
    /// `[i]`
    Index(ExprSyntax),
    /// `.x`
    Field(NameSyntax),
}

/// `channel take(fork: 0..4), free : urgent broadcast`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChannelSyntax {
    pub names: Vec<EventName>,
    pub urgent: bool,
    pub kind: ChannelSyntaxKind,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ChannelSyntaxKind {
    Binary,
    /// `: broadcast`
    Broadcast,
    /// `: joint P | Q | R?`
    MultiWay(Vec<ParticipantSyntax>),
}

/// An automaton that has a part in a multi-way channel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParticipantSyntax {
    pub automaton: NameSyntax,
    /// `?`: takes part if it can
    pub optional: bool,
}

/// `fn front() -> 0..5 { return queue[0] }`; without a result, an update function
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FunctionSyntax {
    pub name: NameSyntax,
    pub params: Vec<ParamSyntax>,
    pub result: Option<TypeExpr>,
    pub body: Vec<StatementSyntax>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StatementSyntax {
    pub kind: StatementSyntaxKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StatementSyntaxKind {
    /// `var i: 0..5 = 0`
    Var(VarSyntax),
    /// `queue[len] = e`
    Assign {
        target: NameSyntax,
        access: Vec<AccessSyntax>,
        op: Option<BinaryOp>,
        value: ExprSyntax,
    },
    /// An update function.
    Call(CallSyntax),
    If {
        condition: ExprSyntax,
        then: Vec<StatementSyntax>,
        otherwise: Vec<StatementSyntax>,
    },
    While {
        condition: ExprSyntax,
        body: Vec<StatementSyntax>,
    },
    /// `for i in 0..5 { … }`: both ends included
    For {
        name: NameSyntax,
        range: RangeSyntax,
        body: Vec<StatementSyntax>,
    },
    Return(Option<ExprSyntax>),
    Error,
}

/// `query live "title" of table = formula`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct QuerySyntax {
    pub name: NameSyntax,
    pub title: Option<TextSyntax>,
    pub network: NameSyntax,
    pub ask: FormulaSyntax,
    /// Of the formula.
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FormulaSyntax {
    /// `E<> f`
    Possibly(ExprSyntax),
    /// `A[] f`
    Invariantly(ExprSyntax),
    /// `E[] f`
    PotentiallyAlways(ExprSyntax),
    /// `A<> f`
    Eventually(ExprSyntax),
    /// `f --> g`
    LeadsTo(ExprSyntax, ExprSyntax),
    /// `sup{f}: x, n`
    Sup { when: Option<ExprSyntax>, of: Vec<ExprSyntax> },
    /// `inf{f}: x, n`
    Inf { when: Option<ExprSyntax>, of: Vec<ExprSyntax> },
}

// ── Requirements ──

/// `require R1 functional "title" pattern`; with parameters, a template
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RequireSyntax {
    pub name: NameSyntax,
    pub params: Option<Vec<ParamSyntax>>,
    /// `safety` or `functional`
    pub kind: NameSyntax,
    pub title: Option<TextSyntax>,
    pub pattern: PatternSyntax,
}

/// What a requirement says, as it is written.
pub type ParsedPattern = RequirementSentence<CallSyntax, ExprSyntax, ExprSyntax, ExprSyntax>;

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PatternSyntax {
    /// `None`: it could not be read.
    pub kind: Option<ParsedPattern>,
    pub span: Span,
}

/// `assume at most 4 leg_request within 300 s`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AssumeSyntax {
    pub at_most: ExprSyntax,
    pub events: Vec<CallSyntax>,
    pub within: Option<ExprSyntax>,
}

// ── Coverage ──

/// `cover legs = count(leg_request) bins none = 0, four = 4..`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CoverSyntax {
    pub name: NameSyntax,
    /// `Some`: a template.
    pub params: Option<Vec<ParamSyntax>>,
    pub count: Vec<CallSyntax>,
    pub bins: Vec<BinSyntax>,
}

/// `one = 1`, `few = 1..3`, `many = 4..`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BinSyntax {
    pub name: NameSyntax,
    pub lo: ExprSyntax,
    /// `None`: the same as `lo` if `open` is not set.
    pub hi: Option<ExprSyntax>,
    /// `4..`
    pub open: bool,
    pub span: Span,
}

/// `cross c = a * b { bin "…" when a.x && b.y  ignore when … }`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CrossSyntax {
    pub name: NameSyntax,
    /// `Some`: a template.
    pub params: Option<Vec<ParamSyntax>>,
    pub points: Vec<NameSyntax>,
    pub members: Vec<CrossMember>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CrossMember {
    pub kind: CrossMemberKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum CrossMemberKind {
    Bin { name: TextSyntax, when: ExprSyntax },
    Ignore { when: ExprSyntax },
    Allow(AllowSyntax),
    Error,
}

// ── Suites and tests ──

pub use crate::suites::{MethodSyntax, SuiteMember, SuiteMemberKind, SuiteSetting, SuiteSyntax};

/// `test bdi_tests.t017 { … }`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TestSyntax {
    pub name: PathSyntax,
    pub members: Vec<TestMember>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TestMember {
    pub kind: TestMemberKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TestMemberKind {
    /// `seed 17`
    Seed(ExprSyntax),
    /// `method agents`
    Method(NameSyntax),
    /// `because "wants(2)"`
    Because(TextSyntax),
    /// `predicts "human_robot.2 legs, bored"`
    Predicts(TextSyntax),
    /// `look(true) with offset = 15 cm, distance = 55 cm`
    Do {
        call: CallSyntax,
        with: Vec<(NameSyntax, ExprSyntax)>,
        /// `meanwhile look(true)`: the next step begins at once
        meanwhile: bool,
    },
    /// `await a | b within 30 s`
    Await {
        events: Vec<CallSyntax>,
        within: ExprSyntax,
    },
    /// `wait 10 s`
    Wait(ExprSyntax),
    /// `person { ask; wait 10 s }`
    Script {
        actor: NameSyntax,
        members: Vec<TestMember>,
    },
    Error,
}
