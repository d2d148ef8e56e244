//! Belief-desire-intention agents, after AgentSpeak(L).

use std::sync::LazyLock;

use hrdsl_source::{Span, Symbol};
use serde::{Deserialize, Serialize};

use crate::{
    event::{ActorId, EventId, EventPattern, Parameter},
    expr::Expr,
    list::ListFunction,
    plan_steps::PlanBlock,
    value::Value,
};

pub use crate::plan_steps::each_step;

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
pub struct Agent<E = Expr> {
    pub name: String,
    /// The actor it plays.
    pub actor: ActorId,
    /// `[jason]`: facts are asked newest first, atomic plans exclude every other, and plans for changes of beliefs run
    /// before the next step.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub jason: bool,
    pub beliefs: Vec<BeliefDecl>,
    pub goals: Vec<GoalDecl>,
    /// Rules, in source order: those of a belief are tried after its facts.
    pub rules: Vec<BeliefRule<E>>,
    /// Beliefs held at the start, in source order.
    pub initial_beliefs: Vec<InitialFact>,
    /// Goals adopted at the start, in source order.
    pub initial_goals: Vec<(GoalId, Vec<Value>)>,
    /// The plan library, in source order: the first applicable plan is chosen.
    pub plans: Vec<Plan<E>>,
    pub origin: Span,
}

/// A declared belief. A strongly negated one, `~b`, is a belief of its own, with `~` in its name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BeliefDecl {
    pub name: String,
    pub params: Vec<Parameter>,
    /// The annotations that its facts may have besides `source`: each a name with one value.
    pub annotations: Vec<Parameter>,
    /// `belief b(…) on e`: the arguments of the latest such event that the agent perceived, with the source `percept`.
    pub percept: Option<EventId>,
    /// It is the strong negation of this one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub negates: Option<BeliefId>,
    pub origin: Span,
}

/// A goal that some plan achieves. `arity` arguments; their types, if it is declared.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GoalDecl {
    pub name: String,
    pub arity: u16,
    pub params: Option<Vec<Parameter>>,
}

/// `rule b(…) when body`: what follows from other beliefs. Once the body has an answer, every variable of the head has a
/// value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BeliefRule<E = Expr> {
    pub belief: BeliefId,
    pub args: Vec<AgentTerm<E>>,
    pub body: PlanContext<E>,
    /// The names of the rule's variables.
    pub vars: Vec<String>,
    /// `b(…)`
    pub head: Span,
    pub origin: Span,
}

/// A ground belief.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct InitialFact {
    pub belief: BeliefId,
    pub args: Vec<Value>,
    /// Without a source: `self`.
    pub annotations: Vec<(BeliefAnnotation, Value)>,
}

/// What an annotation says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BeliefAnnotation {
    /// Who told it: an agent's name, `self` or `percept`.
    Source,
    /// Index into [`BeliefDecl::annotations`].
    Declared(u16),
}

/// A plan: `plan trigger when context { body }`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan<E = Expr> {
    /// As written (`plan @label +!g`), or made from the trigger and the plan's place: `table#2`.
    pub label: String,
    /// `@label[atomic]`: while it is not finished, and does not wait, no other intention is executed.
    pub atomic: bool,
    pub trigger: PlanTrigger<E>,
    pub context: PlanContext<E>,
    pub body: Vec<PlanStep<E>>,
    /// The names of the plan's variables; `Expr::Var(i)` and `Term::Var(i)` index it.
    pub vars: Vec<String>,
    pub origin: Span,
}

/// What makes a plan relevant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlanTrigger<E = Expr> {
    pub on: TriggerOn,
    pub args: Vec<AgentTerm<E>>,
    /// Of a goal `source` only: who asked for it.
    pub annotations: Vec<(BeliefAnnotation, AgentTerm<E>)>,
    pub origin: Span,
    /// The name in it.
    pub name: Span,
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

impl TriggerOn {
    /// The belief that it is about.
    #[must_use]
    pub fn belief(self) -> Option<BeliefId> {
        match self {
            TriggerOn::BeliefAdded(b)
            | TriggerOn::BeliefRemoved(b)
            | TriggerOn::TestAdded(b)
            | TriggerOn::TestFailed(b) => Some(b),
            TriggerOn::GoalAdded(_) | TriggerOn::GoalFailed(_) | TriggerOn::Perceived(_) => None,
        }
    }
}

/// A term that is matched: in a trigger, in a belief literal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AgentTerm<E = Expr> {
    /// `_`
    Any,
    /// A variable: bound here if it is not yet, compared otherwise.
    Var(u16),
    /// A ground or computed value; its variables are bound before.
    Expr(E),
    /// `[A, B | Rest]`: a list that begins so; without a rest, of just these elements.
    List(Vec<AgentTerm<E>>, Option<Box<AgentTerm<E>>>),
}

impl<E> AgentTerm<E> {
    /// Calls `f` with each variable that is bound or compared as a whole.
    pub fn each_var(&self, f: &mut dyn FnMut(u16)) {
        match self {
            AgentTerm::Any | AgentTerm::Expr(_) => {}
            AgentTerm::Var(i) => f(*i),
            AgentTerm::List(items, rest) => {
                items.iter().for_each(|t| t.each_var(f));
                rest.iter().for_each(|t| t.each_var(f));
            }
        }
    }
}

/// A belief that is matched. Each annotation must be one of the fact's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BeliefLiteral<E = Expr> {
    pub belief: BeliefId,
    pub args: Vec<AgentTerm<E>>,
    pub annotations: Vec<(BeliefAnnotation, AgentTerm<E>)>,
    pub origin: Span,
}

/// A belief that is made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Assertion<E = Expr> {
    pub belief: BeliefId,
    pub args: Vec<E>,
    /// Without a source: `self`.
    pub annotations: Vec<(BeliefAnnotation, E)>,
}

/// A plan's context, a rule's body, a condition of a step: a formula over the belief base. Its answers are searched
/// depth first, facts from the oldest, then rules; mostly the first is taken.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PlanContext<E = Expr> {
    True,
    Belief(BeliefLiteral<E>),
    /// Negation as failure; binds nothing.
    Not(Box<PlanContext<E>>),
    And(Vec<PlanContext<E>>),
    Or(Vec<PlanContext<E>>),
    /// A boolean expression over variables bound before it.
    Test(E),
    /// `X = e`, `[H | T] = e`
    Unify(AgentTerm<E>, E),
    /// An internal action that asks, in the place of a belief.
    Internal(Box<InternalAct<E>>, Span),
}

impl<E> PlanContext<E> {
    /// Calls `f` with the formula and each formula in it, the whole first.
    pub fn each<'a>(&'a self, f: &mut dyn FnMut(&'a PlanContext<E>)) {
        f(self);
        match self {
            PlanContext::Not(inner) => inner.each(f),
            PlanContext::And(all) | PlanContext::Or(all) => all.iter().for_each(|c| c.each(f)),
            PlanContext::Internal(action, _) => action.formula().iter().for_each(|c| c.each(f)),
            PlanContext::True | PlanContext::Belief(_) | PlanContext::Test(_) | PlanContext::Unify(..) => {}
        }
    }

    /// The parts that must all hold: of a conjunction its own, otherwise the whole.
    #[must_use]
    pub fn conjuncts(&self) -> &[PlanContext<E>] {
        if let PlanContext::And(parts) = self { parts } else { std::slice::from_ref(self) }
    }

    /// The variables that it may bind.
    #[must_use]
    pub fn binds(&self) -> Vec<u16> {
        let mut vars = Vec::new();
        let mut add = |var| vars.push(var);
        match self {
            PlanContext::True | PlanContext::Not(_) | PlanContext::Test(_) => {}
            PlanContext::And(all) | PlanContext::Or(all) => {
                return all.iter().flat_map(PlanContext::binds).collect();
            }
            PlanContext::Belief(literal) => {
                literal.args.iter().for_each(|a| a.each_var(&mut add));
                literal.annotations.iter().for_each(|(_, a)| a.each_var(&mut add));
            }
            PlanContext::Unify(term, _) => term.each_var(&mut add),
            PlanContext::Internal(action, _) => action.terms().into_iter().for_each(|a| a.each_var(&mut add)),
        }
        vars
    }
}

/// An internal action that asks: it has answers, and changes nothing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum InternalAct<E = Expr> {
    /// `.findall(X, F, L)`, and `.setof`: sorted, without duplicates. F binds nothing outside.
    FindAll { template: E, formula: PlanContext<E>, set: bool, out: AgentTerm<E> },
    /// `.count(F, N)`
    Count { formula: PlanContext<E>, out: AgentTerm<E> },
    /// `.member(X, L)`: an answer for each element, in order
    Member { element: AgentTerm<E>, list: E },
    /// A function of lists and strings; no answer if it has no value.
    Apply { function: ListFunction, args: Vec<E>, out: AgentTerm<E> },
    /// `.empty(L)`, `.prefix(A, B)`, …: a function that yields a bool.
    Holds { function: ListFunction, args: Vec<E> },
    /// `.intend(g(…))`: an intention has the goal
    Intend { goal: GoalId, args: Vec<AgentTerm<E>> },
    /// `.desire(g(…))`: an intention, or an event not yet handled, has the goal
    Desire { goal: GoalId, args: Vec<AgentTerm<E>> },
    /// `.suspended(g(…))`
    Suspended { goal: GoalId, args: Vec<AgentTerm<E>> },
    /// `.random(X)`: evenly in [0, 1); `.random(L, X)`: an element; no answer from an empty list
    Random { from: Option<E>, out: AgentTerm<E> },
    /// `.shuffle(L, M)`
    Shuffle { list: E, out: AgentTerm<E> },
    /// `.time(T)`: the virtual time, in seconds
    Time { out: AgentTerm<E> },
    /// `.my_name(A)`
    MyName { out: AgentTerm<E> },
    /// `.all_names(L)`: of the agents of this run, in their order
    AllNames { out: AgentTerm<E> },
}

impl<E> InternalAct<E> {
    /// The formula that it asks.
    #[must_use]
    pub fn formula(&self) -> Option<&PlanContext<E>> {
        if let InternalAct::FindAll { formula, .. } | InternalAct::Count { formula, .. } = self {
            Some(formula)
        } else {
            None
        }
    }

    /// The goal that it asks for, with its arguments.
    #[must_use]
    pub fn goal(&self) -> Option<(GoalId, &[AgentTerm<E>])> {
        if let InternalAct::Intend { goal, args }
        | InternalAct::Desire { goal, args }
        | InternalAct::Suspended { goal, args } = self
        {
            Some((*goal, args))
        } else {
            None
        }
    }

    /// What it matches.
    #[must_use]
    pub fn terms(&self) -> Vec<&AgentTerm<E>> {
        match self {
            InternalAct::FindAll { out, .. }
            | InternalAct::Count { out, .. }
            | InternalAct::Member { element: out, .. }
            | InternalAct::Apply { out, .. }
            | InternalAct::Random { out, .. }
            | InternalAct::Shuffle { out, .. }
            | InternalAct::Time { out }
            | InternalAct::MyName { out }
            | InternalAct::AllNames { out } => vec![out],
            InternalAct::Holds { .. } => Vec::new(),
            InternalAct::Intend { args, .. }
            | InternalAct::Desire { args, .. }
            | InternalAct::Suspended { args, .. } => args.iter().collect(),
        }
    }
}

/// One formula of a plan's body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlanStep<E = Expr> {
    pub kind: PlanStepKind<E>,
    pub origin: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PlanStepKind<E = Expr> {
    /// Do a stimulus, or make an event, of the actor that the agent plays.
    Do { event: EventId, args: Vec<E> },
    /// `!g(…) within D`: achieve it before going on, before the time in seconds is over
    Achieve { goal: GoalId, args: Vec<E>, within: Option<E> },
    /// `!!g(…)`: achieve it in an intention of its own
    Spawn { goal: GoalId, args: Vec<E> },
    /// `?b(…)`: query the belief base, then the plans for the test goal; fails without an answer
    Query(BeliefLiteral<E>),
    /// `?(F)`, `X = e`, an internal action that asks: fails without an answer
    Test(PlanContext<E>),
    /// `+b(…)`
    Add(Assertion<E>),
    /// `-b(…)`: takes the first belief that matches from one source, `self` unless it is said; none: nothing happens
    Remove(BeliefLiteral<E>),
    /// `-+b(…)`: removes every belief of that name, then adds
    Replace(Assertion<E>),
    /// `.abolish(b(…))`: removes every belief that matches, whatever its source
    Abolish(BeliefLiteral<E>),
    /// `await e1 | e2 within D`: waits for an event; fails when the time in seconds is over
    Await { events: Vec<EventPattern>, within: Option<E> },
    /// `wait D`: an expression in seconds
    Wait { seconds: E },
    /// `if F { … } else { … }`
    If { condition: PlanContext<E>, then: Vec<PlanStep<E>>, otherwise: Vec<PlanStep<E>> },
    /// `while F { … }`: what F and the body bind is open again each time
    While { condition: PlanContext<E>, body: Vec<PlanStep<E>> },
    /// `for F { … }`: once for each answer that F has at the start
    For { condition: PlanContext<E>, body: Vec<PlanStep<E>> },
    /// `fork { … } and { … }`: all at once, until all are done; with `or` until one is
    Fork { branches: Vec<Vec<PlanStep<E>>>, all: bool },
    /// `.send(A, tell, b(…))`, `.broadcast(tell, b(…))`
    Send {
        to: Option<E>,
        performative: Performative,
        content: ContentId,
        args: Vec<AgentTerm<E>>,
        /// Of what is told, besides its source: each by the name that the receivers' belief declares.
        #[serde(default = "Vec::new", skip_serializing_if = "Vec::is_empty")]
        annotations: Vec<(String, E)>,
    },
    /// `.ask(A, b(…), D)`: waits for the answer, which binds variables; fails if there is none, or after D
    Ask { to: E, content: ContentId, args: Vec<AgentTerm<E>>, within: Option<E> },
    /// `.ask_all(A, X, b(X), L, D)`: waits for the list of the template's values for all answers
    AskAll {
        to: E,
        template: E,
        content: ContentId,
        args: Vec<AgentTerm<E>>,
        out: AgentTerm<E>,
        within: Option<E>,
    },
    /// `.print(…)`: into the log
    Print { args: Vec<E> },
    /// Changes what is intended; without a goal of all, or of this intention.
    Control { what: ControlAct, goal: Option<(GoalId, Vec<AgentTerm<E>>)> },
    /// `.fail`
    Fail,
}

impl<E> PlanStep<E> {
    /// The steps within it.
    #[must_use]
    pub fn blocks(&self) -> Vec<&[PlanStep<E>]> {
        self.kind.as_block().map_or_else(Vec::new, PlanBlock::bodies)
    }

    /// The formula that it asks.
    #[must_use]
    pub fn condition(&self) -> Option<&PlanContext<E>> {
        self.kind.as_test().or_else(|| self.kind.as_block()?.condition())
    }
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
pub enum ControlAct {
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
pub struct MessageContent {
    pub name: String,
    /// By agent; `None`: the agent has nothing of this name.
    pub of: Vec<Option<MessageSubject>>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MessageSubject {
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
