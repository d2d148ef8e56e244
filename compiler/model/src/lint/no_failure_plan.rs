//! HR0409: a step can fail, and on the way down to the root of its intention no failure plan is found.

use std::{
    cell::OnceCell,
    collections::{BTreeMap, BTreeSet},
};

use hrdsl_source::{Diagnostic, DiagnosticCode, Span};

use super::{
    agent_facts::{AgentFacts, GoalAdoption, agents, any_args},
    applicable::never_stuck,
    dead_plan::never_runs,
    facts::ScenarioFacts,
    plan_terms::{PlanTerm, may_unify, of_args, of_exprs},
    triggers::{achieved, goal_of},
};
use crate::{GoalId, Scenario, TriggerOn, TypedPlan, TypedStep, TypedStepKind};

/// The steps of a goal's plans, or of one other plan, that can fail, and what dies then.
struct UnhandledFailure<'a> {
    plan: &'a TypedPlan,
    steps: Vec<(&'a TypedStep, &'static str)>,
    roots: GoalRoots<'a>,
}

pub(crate) fn check<'a>(scenario: &'a Scenario, all: &'a ScenarioFacts<'a>, issues: &mut Vec<Diagnostic>) {
    for facts in agents(scenario, all) {
        let mut all: Vec<UnhandledFailure<'_>> = Vec::new();
        let mut by_goal: BTreeMap<GoalId, usize> = BTreeMap::new();
        for plan in facts.agent.plans.iter().filter(|p| !never_runs(&facts, p)) {
            let found = in_plan(&facts, plan);
            let group =
                achieved(plan.trigger.on).map_or(all.len(), |goal| *by_goal.entry(goal).or_insert(all.len()));
            match all.get_mut(group) {
                Some(group) => group.join(found),
                None => all.push(found),
            }
        }
        issues.extend(all.iter().filter_map(|u| u.issue(&facts)));
    }
}

fn in_plan<'a>(facts: &AgentFacts<'a>, plan: &'a TypedPlan) -> UnhandledFailure<'a> {
    let mut found = UnhandledFailure { plan, steps: Vec::new(), roots: GoalRoots::default() };
    let (middle, last) = (OnceCell::new(), OnceCell::new());
    for (at, step) in plan.body.iter().enumerate() {
        let lost = is_before_others(plan, at);
        let roots = (if lost { &middle } else { &last }).get_or_init(|| dying(facts, plan, lost));
        if !roots.plans.is_empty()
            && let Some(why) = can_fail(facts, plan, at)
        {
            found.join(UnhandledFailure { plan, steps: vec![(step, why)], roots: roots.clone() });
        }
    }
    found
}

/// Plans, each once, in the order in which they were found.
#[derive(Clone, Default)]
struct GoalRoots<'a> {
    plans: Vec<&'a TypedPlan>,
    spans: BTreeSet<Span>,
}

impl<'a> GoalRoots<'a> {
    fn add(&mut self, plan: &'a TypedPlan) {
        if self.spans.insert(plan.origin) {
            self.plans.push(plan);
        }
    }
}

/// The plan has more to do after this step.
fn is_before_others(plan: &TypedPlan, at: usize) -> bool {
    at + 1 < plan.body.len()
}

/// Why a step can fail, if its goal has no failure plan of its own.
fn can_fail(facts: &AgentFacts<'_>, plan: &TypedPlan, at: usize) -> Option<&'static str> {
    match &plan.body[at].kind {
        TypedStepKind::Await { within: Some(_), .. } => Some("the time may run out"),
        TypedStepKind::Query(literal) => {
            let belief = literal.belief;
            let answered = facts.plans(TriggerOn::TestAdded(belief)).next().is_some();
            // That nothing adds it has been said.
            let stuck = facts.comes_about(belief) && !answered && !never_stuck(facts, plan, at);
            stuck.then_some("there may be no such fact")
        }
        TypedStepKind::Achieve { goal, args, within } => {
            let handled = has_failure_plan(facts, *goal, &of_exprs(args));
            let stuck = !handled && !never_stuck(facts, plan, at);
            let late = (!handled && within.is_some()).then_some("the time may run out");
            stuck.then_some("there may be no plan that fits").or(late)
        }
        TypedStepKind::Ask { within: Some(_), .. } | TypedStepKind::AskAll { within: Some(_), .. } => {
            Some("the time may run out")
        }
        TypedStepKind::Ask { within: None, .. } => Some("there may be no answer"),
        TypedStepKind::AskAll { within: None, .. } | TypedStepKind::Await { within: None, .. } => None,
        // What may have no answer here is meant to end the plan; steps in blocks are not looked into.
        TypedStepKind::Do { .. }
        | TypedStepKind::Spawn { .. }
        | TypedStepKind::Test(_)
        | TypedStepKind::Add(_)
        | TypedStepKind::Remove(_)
        | TypedStepKind::Replace(_)
        | TypedStepKind::Abolish(_)
        | TypedStepKind::Wait { .. }
        | TypedStepKind::If { .. }
        | TypedStepKind::While { .. }
        | TypedStepKind::For { .. }
        | TypedStepKind::Fork { .. }
        | TypedStepKind::Send { .. }
        | TypedStepKind::Print { .. }
        | TypedStepKind::Control { .. }
        | TypedStepKind::Fail => None,
    }
}

fn has_failure_plan(facts: &AgentFacts<'_>, goal: GoalId, args: &[PlanTerm<'_>]) -> bool {
    facts.plans(TriggerOn::GoalFailed(goal)).any(|p| may_unify(args, &of_args(&p.trigger.args), true))
}

/// The plans at whose end an intention dies if a step of `plan` fails, and with it something that was still to do: where
/// each plan is at its last step, the intention would end anyhow. The way down is that of the run: only plans selected for
/// `+!g` look for a failure plan, all others pass the failure on.
fn dying<'a>(facts: &AgentFacts<'a>, plan: &'a TypedPlan, lost: bool) -> GoalRoots<'a> {
    let mut roots = GoalRoots::default();
    let mut seen = BTreeSet::new();
    let mut open = vec![(plan, lost)];
    while let Some((plan, lost)) = open.pop() {
        if !seen.insert((plan.origin, lost)) {
            continue;
        }
        if !facts.work(1) {
            return GoalRoots::default();
        }
        let from = open.len();
        match plan.trigger.on {
            TriggerOn::GoalAdded(goal) if has_failure_plan(facts, goal, &of_args(&plan.trigger.args)) => {}
            TriggerOn::GoalAdded(goal) | TriggerOn::GoalFailed(goal) => {
                for adoption in facts.adoptions(goal) {
                    match adoption {
                        GoalAdoption::Root if lost => roots.add(plan),
                        GoalAdoption::Root => {}
                        GoalAdoption::By(by, at) => open.push((by, lost || is_before_others(by, at))),
                    }
                }
            }
            TriggerOn::TestAdded(belief) | TriggerOn::TestFailed(belief) => {
                open.extend(facts.askers(belief).map(|(by, at)| (by, lost || is_before_others(by, at))));
            }
            TriggerOn::BeliefAdded(_) | TriggerOn::BeliefRemoved(_) | TriggerOn::Perceived(_) => {
                if lost {
                    roots.add(plan);
                }
            }
        }
        // In the order of the text, each with all that is above it before the next one.
        open[from..].reverse();
    }
    roots
}

impl<'a> UnhandledFailure<'a> {
    fn join(&mut self, other: UnhandledFailure<'a>) {
        if self.steps.is_empty() {
            self.plan = other.plan;
        }
        self.steps.extend(other.steps);
        other.roots.plans.into_iter().for_each(|root| self.roots.add(root));
    }

    /// One diagnostic for all steps, with all ends.
    fn issue(&self, facts: &AgentFacts<'_>) -> Option<Diagnostic> {
        let ((step, why), more) = self.steps.split_first()?;
        let message = "this can fail, and nothing handles the failure";
        let mut issue = Diagnostic::warning(DiagnosticCode::NO_FAILURE_PLAN, step.origin, message).here(*why);
        for (step, why) in more {
            issue = issue.label(step.origin, format!("here too: {why}"));
        }
        for root in &self.roots.plans {
            let text = goal_of(root.trigger.on).map_or_else(
                || "then this plan dies, with all that it still was to do".to_owned(),
                |goal| {
                    format!("then the goal `!{}` dies, with all that it still was to do", facts.goal(goal))
                },
            );
            issue = issue.label(root.trigger.origin, text);
        }
        Some(self.with_fix(facts, step, issue))
    }

    /// Adds what to type.
    fn with_fix(&self, facts: &AgentFacts<'_>, step: &TypedStep, issue: Diagnostic) -> Diagnostic {
        let mut all = [self.plan].into_iter().chain(self.roots.plans.iter().copied());
        let handler = all.find_map(|p| achieved(p.trigger.on).map(|goal| (shown(facts, goal), p)));
        let say = handler.as_ref().map_or_else(
            || "put it into a goal of its own with a plan `-!goal` that says what then".to_owned(),
            |(head, _)| format!("say what then: `plan -!{head} {{ … }}`"),
        );
        let add = |issue: Diagnostic, head: &str, after: &TypedPlan| {
            let end = Span { start: after.origin.end, ..after.origin };
            issue.fix(format!("add an empty plan `{head}`"), end, format!("\n  plan {head} {{ }}"), false)
        };
        if let TypedStepKind::Achieve { goal, .. } = step.kind
            && let Some(last) = facts.plans(TriggerOn::GoalAdded(goal)).last()
        {
            let head = format!("+!{}", shown(facts, goal));
            let issue =
                issue.help(format!("add a last plan that always fits, `plan {head} {{ … }}`, or {say}"));
            return add(issue, &head, last);
        }
        match handler {
            Some((head, after)) => {
                let help = format!("{say}; if it is empty, whoever wanted the goal goes on");
                add(issue.help(help), &format!("-!{head}"), after)
            }
            None => issue.help(say),
        }
    }
}

fn shown(facts: &AgentFacts<'_>, goal: GoalId) -> String {
    any_args(facts.goal(goal), usize::from(facts.agent.goals[usize::from(goal.0)].arity))
}
