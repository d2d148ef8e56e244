//! The abstract syntax tree: what was written, with spans, before any name is looked up.
//!
//! Every node that can be broken has an `Error` form, so that one bad declaration or statement costs that one alone.

use hrdsl_source::Span;

pub use hrdsl_source::{BinaryOp, LocationKind, UnaryOp};
use serde::Serialize;

/// An identifier where it was written.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Name {
    pub text: String,
    pub span: Span,
}

/// `a.b.c`
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Path {
    /// At least one.
    pub names: Vec<Name>,
    pub span: Span,
}

/// A string literal, without its quotes and with escapes resolved.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Text {
    pub text: String,
    pub span: Span,
}

/// One file: a scenario, a stdlib module (no `scenario` line), or a file of tests.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct File {
    pub scenario: Option<Name>,
    pub items: Vec<Item>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Item {
    /// The `///` lines before it, joined by newlines.
    pub doc: String,
    pub kind: ItemKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ItemKind {
    /// `use std.person`, `use "people.hri"`
    Use(Module),
    /// `allow HR0107 "why"`: the next declaration may be so
    Allow(Allow),
    /// `enum Order { feed, clean }`
    Enum {
        name: Name,
        values: Vec<Name>,
    },
    /// `record Pose { x: length, y: length }`
    Record {
        name: Name,
        fields: Vec<Param>,
    },
    /// `actor person : environment`
    Actor {
        name: Name,
        role: Name,
    },
    /// `const LEGS = 4`
    Const {
        name: Name,
        value: Expr,
    },
    Event(Event),
    Stimulus(Stimulus),
    Agent(Agent),
    /// `var away: bool = false`: shared by all automata
    Var(Var),
    Automaton(Automaton),
    /// `channel take(fork: 0..4), free : urgent`
    Channel(Channel),
    /// `fn front() -> 0..5 { return queue[0] }`
    Function(Function),
    /// `query live of table = Person.asked --> Person.shown`
    Query(Query),
    /// `network table = Person | Robot`
    Network {
        name: Name,
        automata: Vec<Name>,
    },
    Require(Require),
    Assume(Assume),
    Cover(Cover),
    Cross(Cross),
    Suite(Suite),
    Part(Part),
    Device(Device),
    World(World),
    System(System),
    Test(Test),
    /// `agent Human = Visitor(10 s)`: a template with its arguments
    Instance(Instance),
    /// Could not be read; the diagnostic has been made.
    Error,
}

/// What `use` names.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Module {
    /// A module of the library.
    Library(Path),
    /// A file, relative to the one that uses it.
    File(Text),
}

/// `allow HR0107 "why"`
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Allow {
    pub code: Name,
    pub reason: Text,
}

/// What a template makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Sort {
    Agent,
    Automaton,
    Require,
    Cover,
    Cross,
}

/// `agent Human = Visitor(10 s)`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Instance {
    pub sort: Sort,
    pub name: Name,
    pub of: Name,
    pub args: Vec<Expr>,
    /// The template's name with the arguments.
    pub span: Span,
}

// ── Types and expressions ──

/// `bool`, `0..LEGS`, `length`, `Pose`, `bool[4]`, …; of a template's parameter also `event`, `actor`, `cover`, …
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TypeExpr {
    Named(Name),
    Range(Expr, Expr),
    /// `bool[4]`
    Array(Box<TypeExpr>, Expr),
    /// `[0..4]`: a list
    List(Box<TypeExpr>),
    /// Could not be read.
    Error,
}

/// `name: type`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Param {
    pub name: Name,
    pub ty: TypeExpr,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Expr {
    pub kind: ExprKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ExprKind {
    Bool(bool),
    Int(i64),
    Float(f64),
    /// `10 cm`: the number as written and the unit, not yet looked up.
    Quantity {
        number: f64,
        unit: Name,
    },
    /// `_`
    Any,
    /// A constant, variable, parameter, belief without arguments, or `person.hand.x`.
    Path(Path),
    /// `wants(M)`, `distance(person.hand, robot.palm)`, `abs(x)`
    Call {
        callee: Path,
        args: Vec<Expr>,
    },
    /// `a[i]`
    Index {
        of: Box<Expr>,
        index: Box<Expr>,
    },
    /// `a[i].x`
    Field {
        of: Box<Expr>,
        name: Name,
    },
    /// `not a` / `!a`, `-a`
    Unary {
        op: UnaryOp,
        operand: Box<Expr>,
    },
    Binary {
        op: BinaryOp,
        left: Box<Expr>,
        right: Box<Expr>,
    },
    /// `if c { a } else { b }`
    If {
        condition: Box<Expr>,
        then: Box<Expr>,
        otherwise: Box<Expr>,
    },
    /// `(a, b, c)`: a vector; always two or more
    Tuple(Vec<Expr>),
    /// `"leg"`
    Text(String),
    /// `[a, b | rest]`
    List {
        items: Vec<Expr>,
        rest: Option<Box<Expr>>,
    },
    /// `~b(X)`
    Strong(Box<Expr>),
    /// `b(X)[source(S), sure(9)]`. A single annotation of a name without arguments is an `Index`.
    Annotated {
        of: Box<Expr>,
        annotations: Vec<Expr>,
    },
    /// `.count(b(_), N)`
    Internal(Call),
    /// `X = e`
    Unify {
        left: Box<Expr>,
        right: Box<Expr>,
    },
    /// Could not be read.
    Error,
}

/// `name` or `name(args)`: an event, stimulus, belief or goal with arguments.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Call {
    pub name: Name,
    /// `None`: no parentheses were written.
    pub args: Option<Vec<Expr>>,
    pub span: Span,
}

/// A belief as it is matched or made: `~near(X)[source(S)]`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Literal {
    /// `~`: strong negation
    pub negated: bool,
    pub call: Call,
    pub annotations: Vec<Expr>,
    pub span: Span,
}

/// `lo .. hi` or `lo ..`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Range {
    pub lo: Expr,
    pub hi: Option<Expr>,
    pub span: Span,
}

// ── Vocabulary ──

/// `event asked, sensed(gaze: bool) from sensors to robot, person`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Event {
    pub names: Vec<EventName>,
    pub from: Name,
    pub to: Vec<Name>,
}

/// One of the events of a line.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EventName {
    pub name: Name,
    pub params: Vec<Param>,
}

/// `stimulus look(ok: bool) by person { … }`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stimulus {
    pub name: Name,
    pub params: Vec<Param>,
    pub by: Name,
    pub body: Vec<StimulusStep>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StimulusStep {
    pub kind: StimulusStepKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StimulusStepKind {
    /// `sample offset in a .. b`, or `in if ok { a .. b } else { c .. d }`
    Sample {
        name: Name,
        range: SampleRange,
    },
    /// `emit leg_request`
    Emit(Call),
    /// `hold 5 s`
    Hold(Expr),
    /// `person.hand.move_to(leg + (dx, dy, dz), 1 s)`: the last name of the path is the action
    Act {
        path: Path,
        args: Vec<Expr>,
    },
    If {
        condition: Expr,
        then: Vec<StimulusStep>,
        otherwise: Vec<StimulusStep>,
    },
    Error,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SampleRange {
    Plain(Range),
    If { condition: Expr, then: Box<SampleRange>, otherwise: Box<SampleRange> },
}

// ── Agents ──

/// `agent Human plays person { … }`; with parameters, a template
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Agent {
    pub name: Name,
    /// `Some`: a template.
    pub params: Option<Vec<Param>>,
    pub plays: Name,
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
        name: Name,
        params: Vec<Param>,
        annotations: Vec<Param>,
        on: Option<Name>,
        initial: Vec<Literal>,
    },
    /// `rule near(X) when at(X, D) && D < 3 m`
    Rule {
        head: Literal,
        body: Option<Expr>,
    },
    /// `goal deliver(leg: 1..4)`: the types of its arguments
    GoalType {
        name: Name,
        params: Vec<Param>,
    },
    /// `goal !table`: adopted at the start
    Goal(Call),
    Plan(Plan),
    Allow(Allow),
    Error,
}

/// `plan @label +!table when context { body }`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Plan {
    pub label: Option<Label>,
    pub trigger: Trigger,
    pub context: Option<Expr>,
    pub body: Vec<Step>,
}

/// `@label`, `@label[atomic]`
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Label {
    pub name: Name,
    /// What is in the brackets: `atomic`, or a mistake.
    pub atomic: Option<Name>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Trigger {
    pub kind: TriggerKind,
    pub literal: Literal,
    pub span: Span,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TriggerKind {
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
pub struct Step {
    pub kind: StepKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StepKind {
    /// a stimulus or event of the agent's actor
    Do(Call),
    /// `!g within 10 s`
    Achieve {
        call: Call,
        within: Option<Expr>,
    },
    /// `!!g`
    Spawn(Call),
    /// `?b`
    Query(Literal),
    /// `?(F)`
    Test(Expr),
    /// `X = e`
    Unify {
        left: Expr,
        right: Expr,
    },
    /// `+b`
    Add(Literal),
    /// `-b`
    Remove(Literal),
    /// `-+b`
    Replace(Literal),
    /// `await a | b within 10 s`
    Await {
        events: Vec<Call>,
        within: Option<Expr>,
    },
    /// `wait 10 s`
    Wait(Expr),
    /// `.send(A, tell, b(X))`
    Internal(Call),
    /// `if F { … } else { … }`
    If {
        condition: Expr,
        then: Vec<Step>,
        otherwise: Vec<Step>,
    },
    /// `while F { … }`
    While {
        condition: Expr,
        body: Vec<Step>,
    },
    /// `for F { … }`
    For {
        condition: Expr,
        body: Vec<Step>,
    },
    /// `fork { … } and { … }`, or with `or`: two branches at least
    Fork {
        all: bool,
        branches: Vec<Vec<Step>>,
    },
    Error,
}

// ── Automata ──

/// `var left: 0..LEGS = 0`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Var {
    pub name: Name,
    pub ty: TypeExpr,
    /// Without: `false`, or the range's value nearest to 0.
    pub init: Option<Expr>,
}

/// `automaton Person plays person { … }`; with parameters, a template
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Automaton {
    pub name: Name,
    pub params: Option<Vec<Param>>,
    /// `None`: it knows no events, only channels.
    pub plays: Option<Name>,
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
    Clock(Vec<Name>),
    Var(Var),
    /// `init committed location start { invariant x <= 3 s }`
    Location {
        init: bool,
        kind: LocationKind,
        name: Name,
        invariant: Option<Expr>,
    },
    Edge(Edge),
    /// A function that knows the automaton's variables.
    Function(Function),
    Allow(Allow),
    Error,
}

/// `a -> b select n: 0..4 when x >= 3 s && n > 0 on e(p) do left = n; x = 0`; each part may be absent, the order is free for
/// `select`, `when`, `on`; `do` comes last.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Edge {
    pub from: Name,
    pub to: Name,
    pub selects: Vec<Param>,
    pub guard: Option<Expr>,
    pub on: Option<Call>,
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
    Send(Call),
    /// `left = left - 1`, `x = 0` (a clock), `left -= 1`, `seen[i].ok = true`
    Assign { target: Name, access: Vec<Access>, op: Option<BinaryOp>, value: Expr },
}

/// A step into a variable that has parts.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Access {
    /// `[i]`
    Index(Expr),
    /// `.x`
    Field(Name),
}

/// `channel take(fork: 0..4), free : urgent broadcast`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Channel {
    pub names: Vec<EventName>,
    pub urgent: bool,
    pub kind: ChannelKind,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ChannelKind {
    HandShake,
    /// `: broadcast`
    Broadcast,
    /// `: joint P | Q | R?`
    Joint(Vec<Party>),
}

/// An automaton that has a part in a multi-way channel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Party {
    pub automaton: Name,
    /// `?`: takes part if it can
    pub optional: bool,
}

/// `fn front() -> 0..5 { return queue[0] }`; without a result, an update function
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Function {
    pub name: Name,
    pub params: Vec<Param>,
    pub result: Option<TypeExpr>,
    pub body: Vec<Statement>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Statement {
    pub kind: StatementKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StatementKind {
    /// `var i: 0..5 = 0`
    Var(Var),
    /// `queue[len] = e`
    Assign {
        target: Name,
        access: Vec<Access>,
        op: Option<BinaryOp>,
        value: Expr,
    },
    /// An update function.
    Call(Call),
    If {
        condition: Expr,
        then: Vec<Statement>,
        otherwise: Vec<Statement>,
    },
    While {
        condition: Expr,
        body: Vec<Statement>,
    },
    /// `for i in 0..5 { … }`: both ends included
    For {
        name: Name,
        range: Range,
        body: Vec<Statement>,
    },
    Return(Option<Expr>),
    Error,
}

/// `query live "title" of table = formula`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Query {
    pub name: Name,
    pub title: Option<Text>,
    pub network: Name,
    pub ask: Ask,
    /// Of the formula.
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Ask {
    /// `E<> f`
    Possibly(Expr),
    /// `A[] f`
    Invariantly(Expr),
    /// `E[] f`
    PotentiallyAlways(Expr),
    /// `A<> f`
    Eventually(Expr),
    /// `f --> g`
    LeadsTo(Expr, Expr),
    /// `sup{f}: x, n`
    Sup { when: Option<Expr>, of: Vec<Expr> },
    /// `inf{f}: x, n`
    Inf { when: Option<Expr>, of: Vec<Expr> },
}

// ── Requirements ──

/// `require R1 functional "title" pattern`; with parameters, a template
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Require {
    pub name: Name,
    pub params: Option<Vec<Param>>,
    /// `safety` or `functional`
    pub kind: Name,
    pub title: Option<Text>,
    pub pattern: Pattern,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pattern {
    pub kind: PatternKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PatternKind {
    /// `after T: R within D` and `T causes R within D` (they mean the same)
    Causes {
        trigger: Vec<Call>,
        response: Vec<Call>,
        within: Option<Expr>,
    },
    /// `T forbids E until U`
    Forbids {
        trigger: Vec<Call>,
        forbidden: Vec<Call>,
        until: Vec<Call>,
    },
    /// `never E while P`
    NeverWhile {
        events: Vec<Call>,
        condition: Option<Expr>,
    },
    /// `globally P`
    Globally(Expr),
    Error,
}

/// `assume at most 4 leg_request within 300 s`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Assume {
    pub at_most: Expr,
    pub events: Vec<Call>,
    pub within: Option<Expr>,
}

// ── Coverage ──

/// `cover legs = count(leg_request) bins none = 0, four = 4..`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cover {
    pub name: Name,
    /// `Some`: a template.
    pub params: Option<Vec<Param>>,
    pub count: Vec<Call>,
    pub bins: Vec<Bin>,
}

/// `one = 1`, `few = 1..3`, `many = 4..`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bin {
    pub name: Name,
    pub lo: Expr,
    /// `None`: the same as `lo` if `open` is not set.
    pub hi: Option<Expr>,
    /// `4..`
    pub open: bool,
    pub span: Span,
}

/// `cross c = a * b { bin "…" when a.x && b.y  ignore when … }`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cross {
    pub name: Name,
    /// `Some`: a template.
    pub params: Option<Vec<Param>>,
    pub points: Vec<Name>,
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
    Bin { name: Text, when: Expr },
    Ignore { when: Expr },
    Allow(Allow),
    Error,
}

// ── Suites and tests ──

/// `suite s by agents A, B { … }`, `by search of n { … }`, `by random { … }`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Suite {
    pub name: Name,
    pub method: Method,
    pub members: Vec<SuiteMember>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// agents and automata that play the actors
    Agents(Vec<Name>),
    Search(Name),
    Random,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SuiteMember {
    pub kind: SuiteMemberKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SuiteMemberKind {
    /// `choose one b of A`, `choose any b of A`, `choose one b of A per p`; `where F`, which A's beliefs must answer
    Choose {
        any: bool,
        belief: Name,
        agent: Name,
        per: Option<Name>,
        condition: Option<Expr>,
    },
    /// `explore pairwise`, `explore wise(3)`
    Explore(Call),
    /// `stop after 20`: when so many belief sets in a row added nothing
    StopAfter(Expr),
    /// `minimise`: only the tests that are needed for what all of them reach
    Minimise,
    /// `reach each plan`, `context`, `message`, `path`
    ReachEach(Name),
    /// `tests 160`
    Tests(Expr),
    /// `horizon 300 s`: a model run ends at this virtual time
    Horizon(Expr),
    /// `patience 60 s`: the bound of an await that the model gives none
    Patience(Expr),
    /// `reach each bin of c`
    ReachBins(Name),
    /// `reach each location`
    ReachLocations,
    /// `reach each edge`
    ReachEdges,
    /// `reach violation of R1, R2`, `reach trigger of R1`
    ReachOf {
        what: Name,
        names: Vec<Name>,
    },
    /// `reach query q`
    ReachQueries(Vec<Name>),
    /// `witness shortest`
    Witness(Name),
    /// `delays earliest`
    Delays(Name),
    /// `stimuli a, b`
    Stimuli(Vec<Name>),
    /// `await a`: a wait for an event, drawn like a stimulus
    Await(Vec<Call>),
    /// `length 5..20`
    Length(Range),
    /// `pause 0 s .. 10 s`
    Pause(Range),
    Error,
}

/// `test bdi_tests.t017 { … }`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Test {
    pub name: Path,
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
    Seed(Expr),
    /// `method agents`
    Method(Name),
    /// `because "wants(2)"`
    Because(Text),
    /// `predicts "human_robot.2 legs, bored"`
    Predicts(Text),
    /// `look(true) with offset = 15 cm, distance = 55 cm`
    Do {
        call: Call,
        with: Vec<(Name, Expr)>,
    },
    /// `await a | b within 30 s`
    Await {
        events: Vec<Call>,
        within: Expr,
    },
    /// `wait 10 s`
    Wait(Expr),
    Error,
}

// ── World and system ──

/// `part bert2 { … }`: a reusable piece of world, in its own coordinates.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Part {
    pub name: Name,
    pub params: Option<Vec<Param>>,
    pub members: Vec<WorldMember>,
}

/// `world { … }`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct World {
    pub members: Vec<WorldMember>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WorldMember {
    pub doc: String,
    pub kind: WorldMemberKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum WorldMemberKind {
    /// `step 10 ms`
    Step(Expr),
    /// `sample 50 ms`
    Sample(Expr),
    /// `gravity (0, 0, -9.81)`: m/s², bare numbers
    Gravity(Expr),
    /// `part robot = bert2 at (0 m, 0 m, 0 m)`; turned about z by `rotated (0 deg, 0 deg, 90 deg)`
    Part {
        name: Name,
        of: Name,
        args: Option<Vec<Expr>>,
        at: Expr,
        rotated: Option<Expr>,
    },
    Body(Body),
    /// `joint j: parent -> child at (…) axis (0, 0, 1) limits -60 deg .. 60 deg`
    Joint {
        name: Name,
        parent: Name,
        child: Name,
        at: Expr,
        axis: Expr,
        limits: Range,
    },
    /// `arm a: j1, j2 tip palm tool (8 cm, 0 m, 0 m) speed 0.2 rad/s`
    Arm {
        name: Name,
        joints: Vec<Name>,
        tip: Name,
        tool: Expr,
        speed: Expr,
    },
    /// `gripper g: palm tool (8 cm, 0 m, 0 m) reach 4 cm delay 500 ms`
    Gripper {
        name: Name,
        palm: Name,
        tool: Expr,
        reach: Expr,
        delay: Expr,
    },
    /// `current leg in leg1, leg2 by robot.grip`
    Current {
        name: Name,
        of: Vec<Path>,
        by: Path,
    },
    /// `signal gaze: bool to robot = …`
    Signal {
        name: Name,
        ty: TypeExpr,
        to: Vec<Name>,
        value: Expr,
    },
    Rule(Rule),
    Allow(Allow),
    Error,
}

/// `body palm: dynamic box(4 cm, 8 cm, 8 cm) at (…) rotated (…) mass 0.4 kg ghost graspable`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Body {
    pub name: Name,
    /// `fixed`, `dynamic`, `kinematic`
    pub motion: Name,
    /// `box`, `sphere`, `capsule`, `cylinder`
    pub shape: Name,
    pub sizes: Vec<Expr>,
    pub at: Expr,
    pub rotated: Option<Expr>,
    pub mass: Option<Expr>,
    pub ghost: bool,
    pub graspable: bool,
}

/// `on e(args) when c emit f(args)`, `on close robot.grip emit f`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Rule {
    pub on: RuleOn,
    pub when: Option<Expr>,
    pub emit: Call,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RuleOn {
    Event(Call),
    /// The system told a device to do this.
    Commanded {
        command: Name,
        device: Path,
    },
}

/// `device gripper { … }`: what all devices of a kind can be told
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Device {
    pub kind: Name,
    pub members: Vec<DeviceMember>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DeviceMember {
    pub doc: String,
    pub kind: DeviceMemberKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum DeviceMemberKind {
    Command(DeviceCommand),
    Error,
}

/// `command close do close_fingers expect holds else "the gripper closed on nothing"`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DeviceCommand {
    pub name: Name,
    pub params: Vec<CommandParam>,
    pub primitive: Name,
    pub expect: Option<Expectation>,
}

/// `speed: angular_speed?`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CommandParam {
    pub param: Param,
    /// `?`: may be left out
    pub optional: bool,
}

/// `expect not holds else "the gripper still holds something"`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Expectation {
    pub negated: bool,
    pub measure: Name,
    pub otherwise: Text,
}

/// `system robot { run "python3 robot.py" … }`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct System {
    pub actor: Name,
    pub members: Vec<SystemMember>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SystemMember {
    pub kind: SystemMemberKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SystemMemberKind {
    /// `run "python3 robot.py"`
    Run(Text),
    /// `coverage "robot.py", "fsm.py"`
    Coverage(Vec<Text>),
    /// `limit 300 s`: simulated time
    Limit(Expr),
    /// `budget 10 s`: processor time, or sleep, for one request
    Budget(Expr),
    /// `cpu 5 min`: processor time for a test
    Cpu(Expr),
    /// `wall 1 h`: wall time for a test
    Wall(Expr),
    /// `memory 2 GB`: for each process
    Memory(Expr),
    /// `output 10 MB`: for a test
    Output(Expr),
    /// `env ROBOT_NAME, ROS_DOMAIN_ID`: variables of the environment that are handed on
    Env(Vec<Name>),
    /// `online`: it uses the machine's network
    Online,
    Error,
}
