//! Well-formedness of an agent program: every index that the cycle follows is in range. A compiled program always is;
//! one that was read from elsewhere is refused instead of followed.

use std::fmt;

use hrdsl_ir::{
    EventId, Expr, Program,
    bdi::{Agent, AgentId, BeliefId, Context, GoalId, Plan, StepKind, Term, TriggerOn},
};

/// Why an agent cannot be run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Malformed {
    NoSuchAgent,
    /// More plans, or more steps in a plan, than an index can count.
    TooLong,
    /// A belief, goal, event or variable that is not declared, or the wrong number of arguments.
    Plan {
        label: String,
        what: &'static str,
    },
    InitialGoal {
        index: usize,
    },
}

impl fmt::Display for Malformed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Malformed::NoSuchAgent => f.write_str("no such agent"),
            Malformed::TooLong => f.write_str("too many plans, or too long a plan"),
            Malformed::Plan { label, what } => write!(f, "plan {label}: undeclared or ill-formed {what}"),
            Malformed::InitialGoal { index } => write!(f, "initial goal {index} is ill-formed"),
        }
    }
}

impl std::error::Error for Malformed {}

/// The agent, if it can be run.
pub(crate) fn agent(program: &Program, id: AgentId) -> Result<&Agent, Malformed> {
    let agent = program.agents.get(id.0 as usize).ok_or(Malformed::NoSuchAgent)?;
    let limit = usize::from(u16::MAX);
    if agent.plans.len() > limit || agent.plans.iter().any(|p| p.body.len() > limit) {
        return Err(Malformed::TooLong);
    }
    let check = Check { program, agent };
    for plan in &agent.plans {
        check.plan(plan).map_err(|what| Malformed::Plan { label: plan.label.clone(), what })?;
    }
    let bad = agent.initial_goals.iter().position(|(goal, args)| !check.goal(*goal, args.len()));
    bad.map_or(Ok(agent), |index| Err(Malformed::InitialGoal { index }))
}

struct Check<'a> {
    program: &'a Program,
    agent: &'a Agent,
}

fn sound(holds: bool, what: &'static str) -> Result<(), &'static str> {
    if holds { Ok(()) } else { Err(what) }
}

impl Check<'_> {
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
            TriggerOn::BeliefAdded(b) | TriggerOn::BeliefRemoved(b) | TriggerOn::TestAdded(b) => {
                self.belief(b, args)
            }
            TriggerOn::GoalAdded(g) | TriggerOn::GoalFailed(g) => self.goal(g, args),
            TriggerOn::Perceived(e) => self.event(e, args),
        };
        let vars = plan.vars.len();
        sound(trigger && terms(&plan.trigger.args, vars), "trigger")?;
        sound(self.context(&plan.context, vars), "context")?;
        plan.body.iter().try_for_each(|step| sound(self.step(&step.kind, vars), "step"))
    }

    fn context(&self, context: &Context, vars: usize) -> bool {
        match context {
            Context::True => true,
            Context::Belief { belief, args } => self.belief(*belief, args.len()) && terms(args, vars),
            Context::Not(inner) => self.context(inner, vars),
            Context::And(all) | Context::Or(all) => all.iter().all(|c| self.context(c, vars)),
            Context::Test(expr) => variables(expr, vars),
        }
    }

    fn step(&self, step: &StepKind, vars: usize) -> bool {
        let exprs = |args: &[Expr]| args.iter().all(|e| variables(e, vars));
        match step {
            StepKind::Do { event, args } => self.event(*event, args.len()) && exprs(args),
            StepKind::Achieve { goal, args } | StepKind::Spawn { goal, args } => {
                self.goal(*goal, args.len()) && exprs(args)
            }
            StepKind::Query { belief, args } | StepKind::Remove { belief, args } => {
                self.belief(*belief, args.len()) && terms(args, vars)
            }
            StepKind::Add { belief, args } | StepKind::Replace { belief, args } => {
                self.belief(*belief, args.len()) && exprs(args)
            }
            StepKind::Await { events, .. } => events.iter().all(|e| self.event(e.event, e.args.len())),
            StepKind::Wait { seconds } => variables(seconds, vars),
        }
    }
}

fn terms(terms: &[Term], vars: usize) -> bool {
    terms.iter().all(|term| match term {
        Term::Any => true,
        Term::Var(var) => usize::from(*var) < vars,
        Term::Expr(expr) => variables(expr, vars),
    })
}

fn variables(expr: &Expr, vars: usize) -> bool {
    let mut sound = true;
    expr.each_var(&mut |var| sound &= usize::from(var) < vars);
    sound
}
