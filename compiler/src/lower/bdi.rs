//! Agents.

use hrdsl_ir::{
    Expr,
    bdi::{
        Agent, Annotation, Assertion, Belief, Content, Context, Fact, Goal, Internal, Literal, Plan, Rule,
        Step, StepKind, Term, Trigger, TriggerOn,
    },
};
use hrdsl_model as model;

use super::{expr, vocabulary};

pub(crate) fn agent(a: &model::Agent) -> Agent {
    let belief = |b: &model::Belief| Belief {
        name: b.name.clone(),
        params: expr::params(&b.params),
        annotations: expr::params(&b.annotations),
        percept: b.percept,
        origin: b.span,
    };
    let goal = |g: &model::Goal| Goal {
        name: g.name.clone(),
        arity: g.arity,
        params: g.params.as_deref().map(expr::params),
    };
    let fact = |f: &model::Fact| Fact {
        belief: f.belief,
        args: expr::values(&f.args),
        annotations: f.annotations.iter().map(|(a, v)| (*a, expr::value(*v))).collect(),
    };
    Agent {
        name: a.name.clone(),
        actor: a.actor,
        beliefs: a.beliefs.iter().map(belief).collect(),
        goals: a.goals.iter().map(goal).collect(),
        rules: a.rules.iter().map(rule).collect(),
        initial_beliefs: a.initial_beliefs.iter().map(fact).collect(),
        initial_goals: a.initial_goals.iter().map(|(g, args)| (*g, expr::values(args))).collect(),
        plans: a.plans.iter().map(plan).collect(),
        origin: a.span,
    }
}

pub(crate) fn content(c: &model::Content) -> Content {
    Content { name: c.name.clone(), of: c.of.clone() }
}

fn rule(r: &model::Rule) -> Rule {
    Rule {
        belief: r.belief,
        args: terms(&r.args),
        body: context(&r.body),
        vars: r.vars.clone(),
        origin: r.span,
    }
}

fn plan(p: &model::Plan) -> Plan {
    let on = match p.trigger {
        model::TriggerOn::Added(b) => TriggerOn::BeliefAdded(b),
        model::TriggerOn::Removed(b) => TriggerOn::BeliefRemoved(b),
        model::TriggerOn::Achieve(g) => TriggerOn::GoalAdded(g),
        model::TriggerOn::Failed(g) => TriggerOn::GoalFailed(g),
        model::TriggerOn::Test(b) => TriggerOn::TestAdded(b),
        model::TriggerOn::TestFailed(b) => TriggerOn::TestFailed(b),
        model::TriggerOn::Perceived(e) => TriggerOn::Perceived(e),
    };
    Plan {
        label: p.label.clone(),
        atomic: p.atomic,
        trigger: Trigger { on, args: terms(&p.args), annotations: annotations(&p.annotations) },
        context: context(&p.context),
        body: steps(&p.body),
        vars: p.vars.clone(),
        origin: p.span,
    }
}

// ── terms and formulas ──

fn term(arg: &model::Arg) -> Term {
    match arg {
        model::Arg::Any => Term::Any,
        model::Arg::Var(i) => Term::Var(*i),
        model::Arg::Expr(e) => Term::Expr(expr::local(e)),
        model::Arg::List(items, rest) => {
            Term::List(terms(items), rest.as_ref().map(|rest| Box::new(term(rest))))
        }
    }
}

fn terms(args: &[model::Arg]) -> Vec<Term> {
    args.iter().map(term).collect()
}

fn annotations(all: &[(Annotation, model::Arg)]) -> Vec<(Annotation, Term)> {
    all.iter().map(|(a, arg)| (*a, term(arg))).collect()
}

fn literal(l: &model::Literal) -> Literal {
    Literal { belief: l.belief, args: terms(&l.args), annotations: annotations(&l.annotations) }
}

fn assertion(a: &model::Assertion) -> Assertion {
    Assertion {
        belief: a.belief,
        args: expr::locals(&a.args),
        annotations: a.annotations.iter().map(|(a, e)| (*a, expr::local(e))).collect(),
    }
}

pub(crate) fn context(c: &model::Context) -> Context {
    match c {
        model::Context::True => Context::True,
        model::Context::Belief(l) => Context::Belief(literal(l)),
        model::Context::Not(c) => Context::Not(Box::new(context(c))),
        model::Context::And(cs) => Context::And(cs.iter().map(context).collect()),
        model::Context::Or(cs) => Context::Or(cs.iter().map(context).collect()),
        model::Context::Test(e) => Context::Test(expr::local(e)),
        model::Context::Unify(arg, e) => Context::Unify(term(arg), expr::local(e)),
        model::Context::Internal(action, _) => Context::Internal(Box::new(internal(action))),
    }
}

fn internal(action: &model::Internal) -> Internal {
    use model::Internal as From;
    match action {
        From::FindAll { template, formula, set, out } => Internal::FindAll {
            template: expr::local(template),
            formula: context(formula),
            set: *set,
            out: term(out),
        },
        From::Count { formula, out } => Internal::Count { formula: context(formula), out: term(out) },
        From::Member { element, list } => {
            Internal::Member { element: term(element), list: expr::local(list) }
        }
        From::Apply { function: f, args, out } => {
            Internal::Apply { function: *f, args: expr::locals(args), out: term(out) }
        }
        From::Holds { function: f, args } => Internal::Holds { function: *f, args: expr::locals(args) },
        From::Intend { goal, args } => Internal::Intend { goal: *goal, args: terms(args) },
        From::Desire { goal, args } => Internal::Desire { goal: *goal, args: terms(args) },
        From::Suspended { goal, args } => Internal::Suspended { goal: *goal, args: terms(args) },
        From::Random { from, out } => {
            Internal::Random { from: from.as_ref().map(expr::local), out: term(out) }
        }
        From::Shuffle { list, out } => Internal::Shuffle { list: expr::local(list), out: term(out) },
        From::Time { out } => Internal::Time { out: term(out) },
        From::MyName { out } => Internal::MyName { out: term(out) },
        From::AllNames { out } => Internal::AllNames { out: term(out) },
    }
}

// ── steps ──

fn steps(all: &[model::Step]) -> Vec<Step> {
    all.iter().map(|s| Step { kind: step(&s.kind), origin: s.span }).collect()
}

fn optional(e: &Option<model::Expr>) -> Option<Expr> {
    e.as_ref().map(expr::local)
}

fn step(s: &model::StepKind) -> StepKind {
    use model::StepKind as From;
    match s {
        From::Do(e, args) => StepKind::Do { event: *e, args: expr::locals(args) },
        From::Achieve(g, args, within) => {
            StepKind::Achieve { goal: *g, args: expr::locals(args), within: optional(within) }
        }
        From::Spawn(g, args) => StepKind::Spawn { goal: *g, args: expr::locals(args) },
        From::Query(l) => StepKind::Query(literal(l)),
        From::Test(c) => StepKind::Test(context(c)),
        From::Add(a) => StepKind::Add(assertion(a)),
        From::Remove(l) => StepKind::Remove(literal(l)),
        From::Replace(a) => StepKind::Replace(assertion(a)),
        From::Abolish(l) => StepKind::Abolish(literal(l)),
        From::Await { events, within } => {
            StepKind::Await { events: vocabulary::patterns(events), within: optional(within) }
        }
        From::Wait(time) => StepKind::Wait { seconds: expr::local(time) },
        From::If { condition, then, otherwise } => {
            StepKind::If { condition: context(condition), then: steps(then), otherwise: steps(otherwise) }
        }
        From::While { condition, body } => {
            StepKind::While { condition: context(condition), body: steps(body) }
        }
        From::For { condition, body } => StepKind::For { condition: context(condition), body: steps(body) },
        From::Fork { branches, all } => {
            StepKind::Fork { branches: branches.iter().map(|b| steps(b)).collect(), all: *all }
        }
        From::Send { to, performative: p, content, args } => {
            StepKind::Send { to: optional(to), performative: *p, content: *content, args: terms(args) }
        }
        From::Ask { to, content, args, within } => StepKind::Ask {
            to: expr::local(to),
            content: *content,
            args: terms(args),
            within: optional(within),
        },
        From::AskAll { to, template, content, args, out, within } => StepKind::AskAll {
            to: expr::local(to),
            template: expr::local(template),
            content: *content,
            args: terms(args),
            out: term(out),
            within: optional(within),
        },
        From::Print(args) => StepKind::Print { args: expr::locals(args) },
        From::Control(what, goal) => {
            StepKind::Control { what: *what, goal: goal.as_ref().map(|(g, args)| (*g, terms(args))) }
        }
        From::Fail => StepKind::Fail,
    }
}
