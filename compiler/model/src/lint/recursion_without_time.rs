//! HR0410: a goal that comes back to itself at the same instant, with nothing changed.

use std::collections::{BTreeMap, BTreeSet};

use hrdsl_source::{Diagnostic, DiagnosticCode, Span};

use super::{
    agent_facts::{AgentFacts, agents, all_steps, is_quiet},
    dead_plan::never_runs,
    facts::ScenarioFacts,
    plan_terms::{PlanTerm, of_args, of_exprs, same_value},
    triggers::achieved,
};
use crate::{
    GoalId, Scenario, TriggerOn, TypedContext, TypedInternalAct, TypedPlan, TypedStep, TypedStepKind,
    TypedTerm, Value,
};

/// Longer ways back are not looked for.
const DEEP: usize = 8;

/// So many triggers are followed from one step.
const FAR: usize = 400;

/// So many adoptions are followed in one agent.
const MANY: usize = 20_000;

pub(crate) fn check<'a>(scenario: &'a Scenario, all: &'a ScenarioFacts<'a>, issues: &mut Vec<Diagnostic>) {
    for facts in agents(scenario, all) {
        for plan in facts.agent.plans.iter().filter(|p| !never_runs(&facts, p)) {
            let endless = all_steps(&plan.body).into_iter().filter(|step| is_endless(&facts, step));
            issues.extend(endless.map(|step| endless_loop(step.origin)));
        }
        let (mut left, mut progress, mut said) = (MANY, BTreeMap::new(), BTreeSet::new());
        for start in &facts.agent.plans {
            if let TriggerOn::GoalAdded(goal) = start.trigger.on
                && !never_runs(&facts, start)
            {
                let args: Vec<PassedTime> =
                    start.trigger.args.iter().enumerate().map(PassedTime::at_start).collect();
                let (left, progress, said) = (&mut left, &mut progress, &mut said);
                let way = Vec::new();
                let mut search =
                    RecursionSearch { facts, start, goal, args: &args, way, left, progress, said, issues };
                search.from(start, &args);
            }
        }
    }
}

/// What a goal's argument is, in terms of those at the start of the cycle.
#[derive(Clone, Debug, PartialEq)]
enum PassedTime {
    /// The argument with this number.
    Same(usize),
    Const(Value),
    /// Computed or looked up on the way.
    New,
}

impl PassedTime {
    fn at_start((i, arg): (usize, &TypedTerm)) -> Self {
        match PlanTerm::of_arg(arg) {
            PlanTerm::Const(value) => PassedTime::Const(value),
            PlanTerm::Any | PlanTerm::Var(_) | PlanTerm::Other(_) | PlanTerm::Part => PassedTime::Same(i),
        }
    }

    fn may_match(&self, term: PlanTerm<'_>) -> bool {
        match (self, term) {
            (PassedTime::Const(a), PlanTerm::Const(b)) => same_value(*a, b),
            (PassedTime::Same(_) | PassedTime::Const(_) | PassedTime::New, _) => true,
        }
    }
}

struct RecursionSearch<'a, 'i> {
    facts: AgentFacts<'a>,
    /// The first plan of the cycle in the text: so each cycle is found once.
    start: &'a TypedPlan,
    goal: GoalId,
    args: &'i [PassedTime],
    /// The plans and adoptions on the way.
    way: Vec<(&'a TypedPlan, Span)>,
    /// How many adoptions are still followed.
    left: &'i mut usize,
    /// By goal: whether its plans let time pass or change a belief.
    progress: &'i mut BTreeMap<GoalId, bool>,
    /// The cycles that are said already, by their places.
    said: &'i mut BTreeSet<Vec<Span>>,
    issues: &'i mut Vec<Diagnostic>,
}

impl<'a> RecursionSearch<'a, '_> {
    /// Follows the adoptions of a plan that are reached at the same instant with the same beliefs.
    fn from(&mut self, plan: &'a TypedPlan, passed: &[PassedTime]) {
        self.follow(plan, passed, &plan.body);
    }

    /// Whether something may change on the way through the steps.
    fn follow(&mut self, plan: &'a TypedPlan, passed: &[PassedTime], steps: &'a [TypedStep]) -> bool {
        for step in steps {
            if let TypedStepKind::Achieve { goal, args, within: _ } = &step.kind {
                let args: Vec<PassedTime> =
                    of_exprs(args).into_iter().map(|t| given(plan, passed, t)).collect();
                self.way.push((plan, step.origin));
                self.adopted(*goal, &args, step.origin);
                self.way.pop();
            }
            for block in step.blocks() {
                self.follow(plan, passed, block);
            }
            if self.progresses(step) {
                return true;
            }
        }
        false
    }

    fn progresses(&mut self, step: &TypedStep) -> bool {
        let TypedStepKind::Achieve { goal, .. } = &step.kind else {
            return progresses(&self.facts, step, &mut BTreeSet::new());
        };
        if let Some(known) = self.progress.get(goal) {
            return *known;
        }
        let found = progresses(&self.facts, step, &mut BTreeSet::new());
        self.progress.insert(*goal, found);
        found
    }

    fn adopted(&mut self, goal: GoalId, args: &[PassedTime], span: Span) {
        if goal == self.goal && args == self.args {
            let issue = self.issue(span);
            if self.said.insert(issue.labels.iter().map(|l| l.span).collect()) {
                self.issues.push(issue);
            }
            return;
        }
        if self.way.len() > DEEP || *self.left == 0 {
            return;
        }
        *self.left -= 1;
        let facts = self.facts;
        for plan in facts.plans(TriggerOn::GoalAdded(goal)) {
            let later = plan.origin.start > self.start.origin.start;
            let again = self.way.iter().any(|(p, _)| std::ptr::eq(*p, plan));
            let fits = args.iter().zip(of_args(&plan.trigger.args)).all(|(a, t)| a.may_match(t));
            if later && !again && fits {
                self.from(plan, args);
            }
        }
    }

    fn issue(&self, span: Span) -> Diagnostic {
        let name = self.facts.goal(self.goal);
        let message = format!("the goal `!{name}` comes back to itself, and no time passes");
        let mut issue = Diagnostic::warning(DiagnosticCode::NO_TIME_PASSES, span, message)
            .here("adopted again, at the same instant and with nothing changed");
        issue = issue.label(self.start.trigger.origin, "the cycle begins here");
        for (_, through) in self.way.iter().filter(|(_, at)| *at != span) {
            issue = issue.label(*through, "and goes on here");
        }
        issue.help(
            "let something happen on the path: a stimulus, an `await`, a `wait`, or a change of a belief",
        )
    }
}

/// A `while` whose body does nothing that could change the answer of its condition, nor fails.
fn is_endless(facts: &AgentFacts<'_>, step: &TypedStep) -> bool {
    let TypedStepKind::While { condition, body } = &step.kind else { return false };
    let quiet = |step: &&TypedStep| {
        let may_be = matches!(step.kind, TypedStepKind::Print { .. } | TypedStepKind::Do { .. });
        (may_be || !step.blocks().is_empty()) && !progresses(facts, step, &mut BTreeSet::new())
    };
    !draws(condition) && all_steps(body).iter().all(quiet)
}

fn endless_loop(span: Span) -> Diagnostic {
    let message = "this loop never ends once it has begun, and no time passes";
    Diagnostic::warning(DiagnosticCode::NO_TIME_PASSES, span, message)
        .here("nothing in it changes what its condition asks")
        .help("let the body change a belief, or let time pass: a stimulus, an `await`, a `wait`")
}

/// Whether a formula's answer may be another one each time.
fn draws(condition: &TypedContext) -> bool {
    let mut draws = false;
    condition.each(&mut |part| {
        if let TypedContext::Internal(action, _) = part {
            draws |= matches!(
                **action,
                TypedInternalAct::Random { .. }
                    | TypedInternalAct::Shuffle { .. }
                    | TypedInternalAct::Intend { .. }
                    | TypedInternalAct::Desire { .. }
                    | TypedInternalAct::Suspended { .. }
            );
        }
    });
    draws
}

/// What an argument of an adoption is, in a plan whose goal has these arguments.
fn given(plan: &TypedPlan, passed: &[PassedTime], term: PlanTerm<'_>) -> PassedTime {
    match term {
        PlanTerm::Const(value) => PassedTime::Const(value),
        PlanTerm::Var(var) => {
            let at = plan.trigger.args.iter().position(|arg| *arg == TypedTerm::Var(var));
            at.and_then(|at| passed.get(at)).cloned().unwrap_or(PassedTime::New)
        }
        PlanTerm::Any | PlanTerm::Other(_) | PlanTerm::Part => PassedTime::New,
    }
}

/// Whether time may pass in a step, or a belief change.
fn progresses(facts: &AgentFacts<'_>, step: &TypedStep, seen: &mut BTreeSet<TriggerOn>) -> bool {
    let (kind, blocks) = (&step.kind, step.blocks());
    if let Some((event, _)) = kind.as_do() {
        return facts.scenario.events[usize::from(event.0)].stimulus.is_some();
    }
    // What is drawn at random may be another thing each time.
    if !blocks.is_empty() || matches!(kind, TypedStepKind::Test(_)) {
        return step.condition().is_some_and(draws)
            || blocks.into_iter().flatten().any(|inner| progresses(facts, inner, seen));
    }
    if is_quiet(step) {
        return false;
    }
    let goal = kind.as_achieve().map(|(goal, _)| TriggerOn::GoalAdded(goal));
    // All others wait, or change a belief; a message may be answered by another; what is dropped or suspended may be this goal.
    let Some(on) = goal.or_else(|| kind.as_query().map(|l| TriggerOn::TestAdded(l.belief))) else {
        return true;
    };
    // Where there is that much on the way, something may well change.
    if seen.len() == FAR || !facts.work(1) {
        return true;
    }
    if !seen.insert(on) {
        return false;
    }
    let failed = achieved(on).map(TriggerOn::GoalFailed);
    [Some(on), failed]
        .into_iter()
        .flatten()
        .any(|on| facts.plans(on).any(|p| p.body.iter().any(|step| progresses(facts, step, seen))))
}
