//! HR0408: a plan whose trigger never happens, or whose context never holds.

use hrdsl_source::{Diagnostic, DiagnosticCode};

use super::{
    agent_facts::{AgentFacts, agents},
    contradiction,
    facts::ScenarioFacts,
};
use crate::{BeliefId, Scenario, TriggerOn, TypedPlan};

pub(crate) fn check<'a>(scenario: &'a Scenario, all: &'a ScenarioFacts<'a>, issues: &mut Vec<Diagnostic>) {
    for facts in agents(scenario, all) {
        for plan in facts.agent.plans.iter().filter(|p| !facts.is_unadopted(p)) {
            if facts.is_dead_trigger(plan) {
                issues.push(dead_trigger(&facts, plan));
            } else if let Some(found) = contradiction::of(&facts, plan) {
                let message = "this plan never runs: its context cannot hold";
                let mut issue =
                    Diagnostic::warning(DiagnosticCode::DEAD_PLAN, found.span, message).here(found.why);
                if let Some((span, text)) = found.with {
                    issue = issue.label(span, text);
                }
                issues.push(issue.help("fix the context, or remove the plan"));
            }
        }
    }
}

/// A plan that has a diagnostic for that, here or as one that nothing adopts.
pub(crate) fn never_runs(facts: &AgentFacts<'_>, plan: &TypedPlan) -> bool {
    facts.is_unadopted(plan) || facts.is_dead_trigger(plan) || contradiction::of(facts, plan).is_some()
}

fn dead_trigger(facts: &AgentFacts<'_>, plan: &TypedPlan) -> Diagnostic {
    let warning = |why: &str| {
        Diagnostic::warning(
            DiagnosticCode::DEAD_PLAN,
            plan.trigger.origin,
            format!("this plan never runs: {why}"),
        )
    };
    let of = |belief: BeliefId| facts.belief(belief).name.as_str();
    match plan.trigger.on {
        TriggerOn::BeliefAdded(b) | TriggerOn::BeliefRemoved(b) if !facts.comes_about(b) => {
            let issue = warning(&format!("nothing adds the belief `{}`", of(b)))
                .label(facts.belief(b).origin, "declared here, without an initial value");
            let otherwise = "add the belief somewhere, or remove the plan".to_owned();
            facts.near_belief(issue, b, Some(plan.trigger.name), otherwise)
        }
        TriggerOn::BeliefAdded(b) => warning(&format!("nothing adds such a `{}`", of(b)))
            .help("the arguments match none that is added: fix them, or remove the plan"),
        TriggerOn::BeliefRemoved(b) => warning(&format!("nothing removes or replaces such a `{}`", of(b)))
            .help(format!("remove the belief somewhere (`-{}`), or remove the plan", of(b))),
        TriggerOn::TestAdded(b) | TriggerOn::TestFailed(b) => {
            warning(&format!("no plan asks for such a `{}`", of(b)))
                .help(format!("ask for the belief somewhere (`?{}`), or remove the plan", of(b)))
        }
        TriggerOn::GoalAdded(_) | TriggerOn::GoalFailed(_) | TriggerOn::Perceived(_) => {
            warning("what it waits for never happens")
        }
    }
}
