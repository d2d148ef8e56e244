//! Well-formedness of an agent program: every index that the cycle follows is in range. A compiled program always is;
//! one that was read from elsewhere is refused instead of followed.

use std::fmt;

use hrdsl_ir::{
    EventId, Expr, Program,
    bdi::{
        Agent, AgentId, AgentTerm, Assertion, BeliefAnnotation, BeliefId, BeliefLiteral, BeliefRule,
        ContentId, GoalId, InternalAct, Plan, PlanContext, PlanStep, PlanStepKind, TriggerOn, each_step,
    },
};

use crate::code::compile;

/// Why an agent cannot be run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MalformedAgentError {
    NoSuchAgent,
    /// More plans, or more steps in a plan, than an index can count.
    TooLong,
    /// A belief, goal, event or variable that is not declared, or the wrong number of arguments.
    Plan {
        label: String,
        what: &'static str,
    },
    Rule {
        index: usize,
    },
    InitialGoal {
        index: usize,
    },
}

impl fmt::Display for MalformedAgentError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            MalformedAgentError::NoSuchAgent => f.write_str("no such agent"),
            MalformedAgentError::TooLong => f.write_str("too many plans, or too long a plan"),
            MalformedAgentError::Plan { label, what } => {
                write!(f, "plan {label}: undeclared or ill-formed {what}")
            }
            MalformedAgentError::Rule { index } => write!(f, "rule {index} is ill-formed"),
            MalformedAgentError::InitialGoal { index } => write!(f, "initial goal {index} is ill-formed"),
        }
    }
}

impl std::error::Error for MalformedAgentError {}

/// The agent, if it can be run.
pub(crate) fn agent(program: &Program, id: AgentId) -> Result<&Agent, MalformedAgentError> {
    let agent = program.agents.get(id.0 as usize).ok_or(MalformedAgentError::NoSuchAgent)?;
    let limit = usize::from(u16::MAX);
    if agent.plans.len() >= limit || agent.plans.iter().any(|p| compile(&p.body).is_none()) {
        return Err(MalformedAgentError::TooLong);
    }
    let check = AgentCheck { program, agent };
    for plan in &agent.plans {
        check.plan(plan).map_err(|what| MalformedAgentError::Plan { label: plan.label.clone(), what })?;
    }
    if let Some(index) = agent.rules.iter().position(|r| !check.rule(r)) {
        return Err(MalformedAgentError::Rule { index });
    }
    let bad = agent.initial_goals.iter().position(|(goal, args)| !check.goal(*goal, args.len()));
    bad.map_or(Ok(agent), |index| Err(MalformedAgentError::InitialGoal { index }))
}

/// Whether a formula of the agent's, with so many variables, can be asked.
pub(crate) fn formula(program: &Program, agent: &Agent, formula: &PlanContext, vars: usize) -> bool {
    AgentCheck { program, agent }.context(formula, vars)
}

struct AgentCheck<'a> {
    program: &'a Program,
    agent: &'a Agent,
}

fn sound(holds: bool, what: &'static str) -> Result<(), &'static str> {
    if holds { Ok(()) } else { Err(what) }
}

impl AgentCheck<'_> {
    fn belief(&self, id: BeliefId, args: usize) -> bool {
        self.agent.beliefs.get(id.0 as usize).is_some_and(|b| b.params.len() == args)
    }

    fn goal(&self, id: GoalId, args: usize) -> bool {
        self.agent.goals.get(id.0 as usize).is_some_and(|g| usize::from(g.arity) == args)
    }

    fn event(&self, id: EventId, args: usize) -> bool {
        self.program.events.get(id.0 as usize).is_some_and(|e| e.params.len() == args)
    }

    fn plan(&self, plan: &Plan) -> Result<(), &'static str> {
        let args = plan.trigger.args.len();
        let trigger = match plan.trigger.on {
            TriggerOn::BeliefAdded(b)
            | TriggerOn::BeliefRemoved(b)
            | TriggerOn::TestAdded(b)
            | TriggerOn::TestFailed(b) => self.belief(b, args),
            TriggerOn::GoalAdded(g) | TriggerOn::GoalFailed(g) => self.goal(g, args),
            TriggerOn::Perceived(e) => self.event(e, args),
        };
        let vars = plan.vars.len();
        let annotations = plan.trigger.annotations.iter().all(|(_, t)| term(t, vars));
        sound(trigger && annotations && terms(&plan.trigger.args, vars), "trigger")?;
        sound(self.context(&plan.context, vars), "context")?;
        self.steps(&plan.body, vars)
    }

    fn rule(&self, rule: &BeliefRule) -> bool {
        let vars = rule.vars.len();
        self.belief(rule.belief, rule.args.len()) && terms(&rule.args, vars) && self.context(&rule.body, vars)
    }

    fn literal(&self, literal: &BeliefLiteral, vars: usize) -> bool {
        let annotations = literal.annotations.iter();
        self.belief(literal.belief, literal.args.len())
            && terms(&literal.args, vars)
            && annotations
                .into_iter()
                .all(|(what, t)| self.annotation(literal.belief, *what) && term(t, vars))
    }

    fn annotation(&self, belief: BeliefId, what: BeliefAnnotation) -> bool {
        match what {
            BeliefAnnotation::Source => true,
            BeliefAnnotation::Declared(at) => {
                let declared = self.agent.beliefs.get(usize::from(belief.0)).map(|b| b.annotations.len());
                declared.is_some_and(|n| usize::from(at) < n)
            }
        }
    }

    fn assertion(&self, assertion: &Assertion, vars: usize) -> bool {
        let mut annotations = assertion.annotations.iter();
        self.belief(assertion.belief, assertion.args.len())
            && exprs(&assertion.args, vars)
            && annotations.all(|(what, e)| self.annotation(assertion.belief, *what) && variables(e, vars))
    }

    fn context(&self, context: &PlanContext, vars: usize) -> bool {
        match context {
            PlanContext::True => true,
            PlanContext::Belief(literal) => self.literal(literal, vars),
            PlanContext::Not(inner) => self.context(inner, vars),
            PlanContext::And(all) | PlanContext::Or(all) => all.iter().all(|c| self.context(c, vars)),
            PlanContext::Test(expr) => variables(expr, vars),
            PlanContext::Unify(t, expr) => term(t, vars) && variables(expr, vars),
            PlanContext::Internal(internal, _) => self.internal(internal, vars),
        }
    }

    fn internal(&self, internal: &InternalAct, vars: usize) -> bool {
        match internal {
            InternalAct::FindAll { template, formula, out, .. } => {
                variables(template, vars) && self.context(formula, vars) && term(out, vars)
            }
            InternalAct::Count { formula, out } => self.context(formula, vars) && term(out, vars),
            InternalAct::Member { element, list } => term(element, vars) && variables(list, vars),
            InternalAct::Apply { args, out, .. } => exprs(args, vars) && term(out, vars),
            InternalAct::Holds { args, .. } => exprs(args, vars),
            InternalAct::Intend { goal, args }
            | InternalAct::Desire { goal, args }
            | InternalAct::Suspended { goal, args } => self.goal(*goal, args.len()) && terms(args, vars),
            InternalAct::Random { from, out } => from.iter().all(|e| variables(e, vars)) && term(out, vars),
            InternalAct::Shuffle { list, out } => variables(list, vars) && term(out, vars),
            InternalAct::Time { out } | InternalAct::MyName { out } | InternalAct::AllNames { out } => {
                term(out, vars)
            }
        }
    }

    fn steps(&self, steps: &[PlanStep], vars: usize) -> Result<(), &'static str> {
        let mut all = true;
        each_step(steps, &mut |step| all = all && self.step(&step.kind, vars));
        sound(all, "step")
    }

    /// A step by itself; those in its blocks are seen to one by one.
    fn step(&self, step: &PlanStepKind, vars: usize) -> bool {
        let maybe = |e: &Option<Expr>| e.iter().all(|e| variables(e, vars));
        let content = |id: ContentId| usize::from(id.0) < self.program.contents.len();
        match step {
            PlanStepKind::Do { event, args } => self.event(*event, args.len()) && exprs(args, vars),
            PlanStepKind::Achieve { goal, args, within } => {
                self.goal(*goal, args.len()) && exprs(args, vars) && maybe(within)
            }
            PlanStepKind::Spawn { goal, args } => self.goal(*goal, args.len()) && exprs(args, vars),
            PlanStepKind::Query(l) | PlanStepKind::Remove(l) | PlanStepKind::Abolish(l) => {
                self.literal(l, vars)
            }
            PlanStepKind::Add(a) | PlanStepKind::Replace(a) => self.assertion(a, vars),
            PlanStepKind::Await { events, within } => {
                events.iter().all(|e| self.event(e.event, e.args.len())) && maybe(within)
            }
            PlanStepKind::Wait { seconds } => variables(seconds, vars),
            PlanStepKind::Test(condition)
            | PlanStepKind::If { condition, .. }
            | PlanStepKind::While { condition, .. }
            | PlanStepKind::For { condition, .. } => self.context(condition, vars),
            PlanStepKind::Fork { branches, .. } => !branches.is_empty(),
            PlanStepKind::Send { to, content: c, args, annotations, .. } => {
                content(*c)
                    && maybe(to)
                    && terms(args, vars)
                    && annotations.iter().all(|(_, e)| variables(e, vars))
            }
            PlanStepKind::Ask { to, content: c, args, within } => {
                content(*c) && variables(to, vars) && terms(args, vars) && maybe(within)
            }
            PlanStepKind::AskAll { to, template, content: c, args, out, within } => {
                content(*c)
                    && variables(to, vars)
                    && variables(template, vars)
                    && terms(args, vars)
                    && term(out, vars)
                    && maybe(within)
            }
            PlanStepKind::Print { args } => exprs(args, vars),
            PlanStepKind::Control { goal, .. } => {
                goal.iter().all(|(g, args)| self.goal(*g, args.len()) && terms(args, vars))
            }
            PlanStepKind::Fail => true,
        }
    }
}

fn exprs(all: &[Expr], vars: usize) -> bool {
    all.iter().all(|e| variables(e, vars))
}

fn terms(terms: &[AgentTerm], vars: usize) -> bool {
    terms.iter().all(|t| term(t, vars))
}

fn term(of: &AgentTerm, vars: usize) -> bool {
    match of {
        AgentTerm::Any => true,
        AgentTerm::Var(var) => usize::from(*var) < vars,
        AgentTerm::Expr(expr) => variables(expr, vars),
        AgentTerm::List(items, rest) => terms(items, vars) && rest.iter().all(|t| term(t, vars)),
    }
}

fn variables(expr: &Expr, vars: usize) -> bool {
    let mut sound = true;
    expr.each_var(&mut |var| sound &= usize::from(var) < vars);
    sound
}
