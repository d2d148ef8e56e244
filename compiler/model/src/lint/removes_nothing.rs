//! HR0413: `-b` takes the agent's own source away, of a belief that only others add.

use hrdsl_source::{Diagnostic, DiagnosticCode};

use super::{
    agent_facts::{AgentFacts, agents, all_steps, any_args},
    facts::ScenarioFacts,
};
use crate::{BeliefAnnotation, BeliefId, Scenario, TypedStepKind};

pub(crate) fn check<'a>(scenario: &'a Scenario, all: &'a ScenarioFacts<'a>, issues: &mut Vec<Diagnostic>) {
    for facts in agents(scenario, all) {
        for step in facts.agent.plans.iter().flat_map(|p| all_steps(&p.body)) {
            let TypedStepKind::Remove(literal) = &step.kind else { continue };
            let sourced = literal.annotations.iter().any(|(a, _)| *a == BeliefAnnotation::Source);
            if let Some(who) = others(&facts, literal.belief).filter(|_| !sourced) {
                let belief = facts.belief(literal.belief);
                let message = format!("this takes nothing away: only {who} the belief `{}`", belief.name);
                let what = any_args(&belief.name, belief.params.len());
                issues.push(
                    Diagnostic::warning(DiagnosticCode::REMOVES_NOTHING, step.origin, message)
                        .here("this takes the source `self` away alone")
                        .help(format!("write `-{what}[source(_)]` for any source")),
                );
            }
        }
    }
}

/// Who adds a belief, if the agent itself never does.
fn others(facts: &AgentFacts<'_>, belief: BeliefId) -> Option<&'static str> {
    if facts.is_given(belief) || facts.is_added(belief) {
        return None;
    }
    if facts.is_told(belief) {
        Some("messages of others add")
    } else if facts.is_percept(belief) {
        Some("perception adds")
    } else {
        facts.is_derived(belief).then_some("rules derive")
    }
}
