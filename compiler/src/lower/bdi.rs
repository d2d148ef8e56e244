//! Agents.

use hrdsl_ir::{
    ActorId, EventId,
    bdi::{
        Agent, Belief, BeliefId, Context, Fact, Goal, GoalId, Plan, Step, StepKind, Term, Trigger, TriggerOn,
    },
    value::nanos,
};
use hrdsl_model as model;

use super::{expr, vocabulary};

pub(crate) fn agent(a: &model::Agent) -> Agent {
    let belief =
        |b: &model::Belief| Belief { name: b.name.clone(), params: expr::params(&b.params), origin: b.span };
    let fact = |(belief, args): &(model::BeliefId, Vec<model::Value>)| Fact {
        belief: BeliefId(belief.0),
        args: expr::values(args),
    };
    Agent {
        name: a.name.clone(),
        actor: ActorId(a.actor.0),
        beliefs: a.beliefs.iter().map(belief).collect(),
        goals: a.goals.iter().map(|g| Goal { name: g.name.clone(), arity: g.arity }).collect(),
        initial_beliefs: a.initial_beliefs.iter().map(fact).collect(),
        initial_goals: a.initial_goals.iter().map(|(g, args)| (GoalId(g.0), expr::values(args))).collect(),
        plans: a.plans.iter().map(plan).collect(),
        origin: a.span,
    }
}

fn plan(p: &model::Plan) -> Plan {
    let on = match p.trigger {
        model::TriggerOn::Added(b) => TriggerOn::BeliefAdded(BeliefId(b.0)),
        model::TriggerOn::Removed(b) => TriggerOn::BeliefRemoved(BeliefId(b.0)),
        model::TriggerOn::Achieve(g) => TriggerOn::GoalAdded(GoalId(g.0)),
        model::TriggerOn::Failed(g) => TriggerOn::GoalFailed(GoalId(g.0)),
        model::TriggerOn::Test(b) => TriggerOn::TestAdded(BeliefId(b.0)),
        model::TriggerOn::Perceived(e) => TriggerOn::Perceived(EventId(e.0)),
    };
    Plan {
        label: p.label.clone(),
        trigger: Trigger { on, args: terms(&p.args) },
        context: context(&p.context),
        body: p.body.iter().map(|s| Step { kind: step(&s.kind), origin: s.span }).collect(),
        vars: p.vars.clone(),
        origin: p.span,
    }
}

fn terms(args: &[model::Arg]) -> Vec<Term> {
    let term = |arg: &model::Arg| match arg {
        model::Arg::Any => Term::Any,
        model::Arg::Var(i) => Term::Var(*i),
        model::Arg::Expr(e) => Term::Expr(expr::local(e)),
    };
    args.iter().map(term).collect()
}

fn context(c: &model::Context) -> Context {
    match c {
        model::Context::True => Context::True,
        model::Context::Belief(b, args, _) => Context::Belief { belief: BeliefId(b.0), args: terms(args) },
        model::Context::Not(c) => Context::Not(Box::new(context(c))),
        model::Context::And(cs) => Context::And(cs.iter().map(context).collect()),
        model::Context::Or(cs) => Context::Or(cs.iter().map(context).collect()),
        model::Context::Test(e) => Context::Test(expr::local(e)),
    }
}

fn step(s: &model::StepKind) -> StepKind {
    let belief = |b: &model::BeliefId| BeliefId(b.0);
    match s {
        model::StepKind::Do(e, args) => StepKind::Do { event: EventId(e.0), args: expr::locals(args) },
        model::StepKind::Achieve(g, args) => {
            StepKind::Achieve { goal: GoalId(g.0), args: expr::locals(args) }
        }
        model::StepKind::Spawn(g, args) => StepKind::Spawn { goal: GoalId(g.0), args: expr::locals(args) },
        model::StepKind::Query(b, args) => StepKind::Query { belief: belief(b), args: terms(args) },
        model::StepKind::Remove(b, args) => StepKind::Remove { belief: belief(b), args: terms(args) },
        model::StepKind::Add(b, args) => StepKind::Add { belief: belief(b), args: expr::locals(args) },
        model::StepKind::Replace(b, args) => {
            StepKind::Replace { belief: belief(b), args: expr::locals(args) }
        }
        model::StepKind::Await { events, within } => {
            StepKind::Await { events: vocabulary::patterns(events), within: within.map(nanos) }
        }
        model::StepKind::Wait(time) => StepKind::Wait { seconds: expr::local(time) },
    }
}
