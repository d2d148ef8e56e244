//! Belief-desire-intention agents, after AgentSpeak(L).

use serde::{Deserialize, Serialize};

use crate::{ActorId, EventId, EventPattern, Expr, Nanos, Param, Span, Value};

/// Index into [`Program::agents`](crate::Program::agents).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct AgentId(pub u16);

/// Index into [`Agent::beliefs`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct BeliefId(pub u16);

/// Index into [`Agent::goals`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct GoalId(pub u16);

/// An agent program: its beliefs, goals and plan library.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Agent {
    pub name: String,
    /// The actor it plays.
    pub actor: ActorId,
    pub beliefs: Vec<Belief>,
    pub goals: Vec<Goal>,
    /// Beliefs held at the start, in source order.
    pub initial_beliefs: Vec<Fact>,
    /// Goals adopted at the start, in source order.
    pub initial_goals: Vec<(GoalId, Vec<Value>)>,
    /// The plan library, in source order: the first applicable plan is chosen.
    pub plans: Vec<Plan>,
    pub origin: Span,
}

/// A declared belief.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Belief {
    pub name: String,
    pub params: Vec<Param>,
    pub origin: Span,
}

/// A goal that some plan achieves. `arity` arguments, untyped so far.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Goal {
    pub name: String,
    pub arity: u16,
}

/// A ground belief.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fact {
    pub belief: BeliefId,
    pub args: Vec<Value>,
}

/// A plan: `plan trigger when context { body }`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// As written (`plan @label +!g`), or made from the trigger and the plan's place: `table#2`.
    pub label: String,
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
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
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
}

/// A plan's context: a formula over the belief base; its answers are searched depth first, in belief order (oldest
/// belief first), and the first is taken.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Context {
    True,
    Belief {
        belief: BeliefId,
        args: Vec<Term>,
    },
    /// Negation as failure; binds nothing.
    Not(Box<Context>),
    And(Vec<Context>),
    Or(Vec<Context>),
    /// A boolean expression over variables bound before it.
    Test(Expr),
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
    /// `!g(…)`: achieve it before going on
    Achieve { goal: GoalId, args: Vec<Expr> },
    /// `!!g(…)`: achieve it in an intention of its own
    Spawn { goal: GoalId, args: Vec<Expr> },
    /// `?b(…)`: query the belief base; fails without an answer
    Query { belief: BeliefId, args: Vec<Term> },
    /// `+b(…)`
    Add { belief: BeliefId, args: Vec<Expr> },
    /// `-b(…)`: removes the first belief that matches; none: nothing happens
    Remove { belief: BeliefId, args: Vec<Term> },
    /// `-+b(…)`: removes every belief of that name, then adds
    Replace { belief: BeliefId, args: Vec<Expr> },
    /// `await e1 | e2 within D`: waits for an event; fails when the time is over
    Await { events: Vec<EventPattern>, within: Option<Nanos> },
    /// `wait D`: an expression in seconds
    Wait { seconds: Expr },
}
