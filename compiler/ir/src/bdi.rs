//! Belief-desire-intention agents, after AgentSpeak(L).

use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

use crate::{ActorId, EventId, EventPattern, Expr, Param, Span, Symbol, Value, list::ListFunction};

/// Index into [`Program::agents`](crate::Program::agents).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct AgentId(pub u16);

/// Index into [`Agent::beliefs`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct BeliefId(pub u16);

/// Index into [`Agent::goals`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct GoalId(pub u16);

/// Index into [`Program::contents`](crate::Program::contents).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct ContentId(pub u16);

/// An agent program: its beliefs, rules, goals and plan library.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Agent {
    pub name: String,
    /// The actor it plays.
    pub actor: ActorId,
    pub beliefs: Vec<Belief>,
    pub goals: Vec<Goal>,
    /// Rules, in source order: those of a belief are tried after its facts.
    pub rules: Vec<Rule>,
    /// Beliefs held at the start, in source order.
    pub initial_beliefs: Vec<Fact>,
    /// Goals adopted at the start, in source order.
    pub initial_goals: Vec<(GoalId, Vec<Value>)>,
    /// The plan library, in source order: the first applicable plan is chosen.
    pub plans: Vec<Plan>,
    pub origin: Span,
}

/// A declared belief. A strongly negated one, `~b`, is a belief of its own, with `~` in its name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Belief {
    pub name: String,
    pub params: Vec<Param>,
    /// The annotations that its facts may have besides `source`: each a name with one value.
    pub annotations: Vec<Param>,
    /// `belief b(…) on e`: the arguments of the latest such event that the agent perceived, with the source `percept`.
    pub percept: Option<EventId>,
    pub origin: Span,
}

/// A goal that some plan achieves. `arity` arguments; their types, if it is declared.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Goal {
    pub name: String,
    pub arity: u16,
    pub params: Option<Vec<Param>>,
}

/// `rule b(…) when body`: what follows from other beliefs. Once the body has an answer, every variable of the head has a
/// value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rule {
    pub belief: BeliefId,
    pub args: Vec<Term>,
    pub body: Context,
    /// The names of the rule's variables.
    pub vars: Vec<String>,
    pub origin: Span,
}

/// A ground belief.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fact {
    pub belief: BeliefId,
    pub args: Vec<Value>,
    /// Without a source: `self`.
    pub annotations: Vec<(Annotation, Value)>,
}

/// What an annotation says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Annotation {
    /// Who told it: an agent's name, `self` or `percept`.
    Source,
    /// Index into [`Belief::annotations`].
    Declared(u16),
}

/// A plan: `plan trigger when context { body }`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// As written (`plan @label +!g`), or made from the trigger and the plan's place: `table#2`.
    pub label: String,
    /// `@label[atomic]`: while it is not finished, and does not wait, no other intention is executed.
    pub atomic: bool,
    pub trigger: Trigger,
    pub context: Context,
    pub body: Vec<Step>,
    /// The names of the plan's variables; `Expr::Var(i)` and `Term::Var(i)` index it.
    pub vars: Vec<String>,
    pub origin: Span,
}

/// What makes a plan relevant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trigger {
    pub on: TriggerOn,
    pub args: Vec<Term>,
    /// Of a goal `source` only: who asked for it.
    pub annotations: Vec<(Annotation, Term)>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TriggerOn {
    /// `+b(…)`
    BeliefAdded(BeliefId),
    /// `-b(…)`
    BeliefRemoved(BeliefId),
    /// `+!g(…)`
    GoalAdded(GoalId),
    /// `-!g(…)`: the goal failed
    GoalFailed(GoalId),
    /// `+?b(…)`: a test goal that the belief base did not answer
    TestAdded(BeliefId),
    /// `-?b(…)`: the plan for a test goal failed
    TestFailed(BeliefId),
    /// `on e(…)`: an event or stimulus of another actor was perceived
    Perceived(EventId),
}

/// A term that is matched: in a trigger, in a belief literal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Term {
    /// `_`
    Any,
    /// A variable: bound here if it is not yet, compared otherwise.
    Var(u16),
    /// A ground or computed value; its variables are bound before.
    Expr(Expr),
    /// `[A, B | Rest]`: a list that begins so; without a rest, of just these elements.
    List(Vec<Term>, Option<Box<Term>>),
}

/// A belief that is matched. Each annotation must be one of the fact's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Literal {
    pub belief: BeliefId,
    pub args: Vec<Term>,
    pub annotations: Vec<(Annotation, Term)>,
}

/// A belief that is made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Assertion {
    pub belief: BeliefId,
    pub args: Vec<Expr>,
    /// Without a source: `self`.
    pub annotations: Vec<(Annotation, Expr)>,
}

/// A plan's context, a rule's body, a condition of a step: a formula over the belief base. Its answers are searched
/// depth first, facts from the oldest, then rules; mostly the first is taken.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Context {
    True,
    Belief(Literal),
    /// Negation as failure; binds nothing.
    Not(Box<Context>),
    And(Vec<Context>),
    Or(Vec<Context>),
    /// A boolean expression over variables bound before it.
    Test(Expr),
    /// `X = e`, `[H | T] = e`
    Unify(Term, Expr),
    /// An internal action that asks, in the place of a belief.
    Internal(Box<Internal>),
}

/// An internal action that asks: it has answers, and changes nothing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Internal {
    /// `.findall(X, F, L)`, and `.setof`: sorted, without duplicates. F binds nothing outside.
    FindAll { template: Expr, formula: Context, set: bool, out: Term },
    /// `.count(F, N)`
    Count { formula: Context, out: Term },
    /// `.member(X, L)`: an answer for each element, in order
    Member { element: Term, list: Expr },
    /// A function of lists and strings; no answer if it has no value.
    Apply { function: ListFunction, args: Vec<Expr>, out: Term },
    /// `.empty(L)`, `.prefix(A, B)`, …: a function that yields a bool.
    Holds { function: ListFunction, args: Vec<Expr> },
    /// `.intend(g(…))`: an intention has the goal
    Intend { goal: GoalId, args: Vec<Term> },
    /// `.desire(g(…))`: an intention, or an event not yet handled, has the goal
    Desire { goal: GoalId, args: Vec<Term> },
    /// `.suspended(g(…))`
    Suspended { goal: GoalId, args: Vec<Term> },
    /// `.random(X)`: evenly in [0, 1); `.random(L, X)`: an element; no answer from an empty list
    Random { from: Option<Expr>, out: Term },
    /// `.shuffle(L, M)`
    Shuffle { list: Expr, out: Term },
    /// `.time(T)`: the virtual time, in seconds
    Time { out: Term },
    /// `.my_name(A)`
    MyName { out: Term },
    /// `.all_names(L)`: of the agents of this run, in their order
    AllNames { out: Term },
}

/// One formula of a plan's body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Step {
    pub kind: StepKind,
    pub origin: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StepKind {
    /// Do a stimulus, or make an event, of the actor that the agent plays.
    Do { event: EventId, args: Vec<Expr> },
    /// `!g(…) within D`: achieve it before going on, before the time in seconds is over
    Achieve { goal: GoalId, args: Vec<Expr>, within: Option<Expr> },
    /// `!!g(…)`: achieve it in an intention of its own
    Spawn { goal: GoalId, args: Vec<Expr> },
    /// `?b(…)`: query the belief base, then the plans for the test goal; fails without an answer
    Query(Literal),
    /// `?(F)`, `X = e`, an internal action that asks: fails without an answer
    Test(Context),
    /// `+b(…)`
    Add(Assertion),
    /// `-b(…)`: takes the first belief that matches from one source, `self` unless it is said; none: nothing happens
    Remove(Literal),
    /// `-+b(…)`: removes every belief of that name, then adds
    Replace(Assertion),
    /// `.abolish(b(…))`: removes every belief that matches, whatever its source
    Abolish(Literal),
    /// `await e1 | e2 within D`: waits for an event; fails when the time in seconds is over
    Await { events: Vec<EventPattern>, within: Option<Expr> },
    /// `wait D`: an expression in seconds
    Wait { seconds: Expr },
    /// `if F { … } else { … }`
    If { condition: Context, then: Vec<Step>, otherwise: Vec<Step> },
    /// `while F { … }`: what F and the body bind is open again each time
    While { condition: Context, body: Vec<Step> },
    /// `for F { … }`: once for each answer that F has at the start
    For { condition: Context, body: Vec<Step> },
    /// `fork { … } and { … }`: all at once, until all are done; with `or` until one is
    Fork { branches: Vec<Vec<Step>>, all: bool },
    /// `.send(A, tell, b(…))`, `.broadcast(tell, b(…))`
    Send { to: Option<Expr>, performative: Performative, content: ContentId, args: Vec<Term> },
    /// `.ask(A, b(…), D)`: waits for the answer, which binds variables; fails if there is none, or after D
    Ask { to: Expr, content: ContentId, args: Vec<Term>, within: Option<Expr> },
    /// `.ask_all(A, X, b(X), L, D)`: waits for the list of the template's values for all answers
    AskAll { to: Expr, template: Expr, content: ContentId, args: Vec<Term>, out: Term, within: Option<Expr> },
    /// `.print(…)`: into the log
    Print { args: Vec<Expr> },
    /// Changes what is intended; without a goal of all, or of this intention.
    Control { what: Control, goal: Option<(GoalId, Vec<Term>)> },
    /// `.fail`
    Fail,
}

/// Speech acts, after KQML as Jason has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Performative {
    Tell,
    Untell,
    Achieve,
    Unachieve,
    /// The answer is told.
    AskOne,
    /// All answers are told.
    AskAll,
}

/// What an internal action does to goals.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Control {
    /// `.drop_intention(g)`, `.drop_all_intentions`: removes whole intentions that have the goal, without failure
    DropIntention,
    /// `.drop_desire(g)`, `.drop_all_desires`: intentions, and events not yet handled
    DropDesire,
    /// `.drop_event(g)`, `.drop_all_events`: events not yet handled
    DropEvent,
    /// `.succeed_goal(g)`: the goal counts as achieved
    SucceedGoal,
    /// `.fail_goal(g)`: the goal fails
    FailGoal,
    /// `.suspend(g)`, `.suspend` of this intention
    Suspend,
    /// `.resume(g)`
    Resume,
}

/// What messages are about: the name, and what it is to each agent of the program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Content {
    pub name: String,
    /// By agent; `None`: the agent has nothing of this name.
    pub of: Vec<Option<Subject>>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Subject {
    Belief(BeliefId),
    Goal(GoalId),
}

/// The source of what an agent adds itself.
#[must_use]
pub fn source_self() -> Symbol {
    static SELF: LazyLock<Symbol> = LazyLock::new(|| Symbol::intern("self"));
    *SELF
}

/// The source of what it perceived.
#[must_use]
pub fn source_percept() -> Symbol {
    static PERCEPT: LazyLock<Symbol> = LazyLock::new(|| Symbol::intern("percept"));
    *PERCEPT
}

/// Calls `f` with each step, those within blocks too, in the order of the text.
pub fn each_step<'p>(steps: &'p [Step], f: &mut dyn FnMut(&'p Step)) {
    for step in steps {
        f(step);
        match &step.kind {
            StepKind::If { then, otherwise, .. } => {
                each_step(then, f);
                each_step(otherwise, f);
            }
            StepKind::While { body, .. } | StepKind::For { body, .. } => each_step(body, f),
            StepKind::Fork { branches, .. } => branches.iter().for_each(|b| each_step(b, f)),
            StepKind::Do { .. }
            | StepKind::Achieve { .. }
            | StepKind::Spawn { .. }
            | StepKind::Query(_)
            | StepKind::Test(_)
            | StepKind::Add(_)
            | StepKind::Remove(_)
            | StepKind::Replace(_)
            | StepKind::Abolish(_)
            | StepKind::Await { .. }
            | StepKind::Wait { .. }
            | StepKind::Send { .. }
            | StepKind::Ask { .. }
            | StepKind::AskAll { .. }
            | StepKind::Print { .. }
            | StepKind::Control { .. }
            | StepKind::Fail => {}
        }
    }
}
