//! HR0404: a belief is tested that never holds.

use hrdsl_source::{Diagnostic, DiagnosticCode, Span};

use super::{
    agent_facts::{AgentFacts, agents, all_steps, any_args, literals},
    dead_plan::never_runs,
    facts::ScenarioFacts,
};
use crate::{BeliefId, Scenario, TriggerOn, TypedStepKind};

/// A place that tests a belief.
struct BeliefRead {
    span: Span,
    /// The name in it, where it is known.
    name: Option<Span>,
    negated: bool,
}

pub(crate) fn check<'a>(scenario: &'a Scenario, all: &'a ScenarioFacts<'a>, issues: &mut Vec<Diagnostic>) {
    for facts in agents(scenario, all) {
        let ids = (0..).map(BeliefId).take(facts.agent.beliefs.len());
        let never: Vec<BeliefId> = ids.filter(|b| !facts.comes_about(*b)).collect();
        let circular = facts.only_from_themselves();
        if never.is_empty() && circular.is_empty() {
            continue;
        }
        let reads = reads(&facts);
        for belief in never {
            issues.extend(never_added(&facts, belief, &reads[usize::from(belief.0)], false));
        }
        for belief in circular {
            issues.extend(never_added(&facts, belief, &reads[usize::from(belief.0)], true));
        }
    }
}

/// By belief, the places that test it.
fn reads(facts: &AgentFacts<'_>) -> Vec<Vec<BeliefRead>> {
    let mut all: Vec<Vec<BeliefRead>> = facts.agent.beliefs.iter().map(|_| Vec::new()).collect();
    let mut read_in = |formula| {
        for l in literals(formula) {
            let name = Some(l.name_span(&facts.belief(l.belief).name));
            all[usize::from(l.belief.0)].push(BeliefRead { span: l.span, name, negated: l.negated });
        }
    };
    let mut queries = Vec::new();
    for plan in facts.agent.plans.iter().filter(|p| !never_runs(facts, p)) {
        let steps = all_steps(&plan.body);
        [&plan.context].into_iter().chain(steps.iter().filter_map(|s| s.condition())).for_each(&mut read_in);
        for step in steps {
            // A plan for the query may answer it without a fact.
            if let TypedStepKind::Query(l) = &step.kind
                && facts.plans(TriggerOn::TestAdded(l.belief)).next().is_none()
            {
                queries.push((l.belief, BeliefRead { span: step.origin, name: None, negated: false }));
            }
        }
    }
    facts.agent.rules.iter().for_each(|rule| read_in(&rule.body));
    facts.choice_conditions().for_each(|condition| read_in(&condition.context));
    for (belief, read) in queries {
        all[usize::from(belief.0)].push(read);
    }
    all.iter_mut().for_each(|reads| reads.sort_by_key(|r| r.span));
    all
}

/// One diagnostic for all places that test the belief. `circular`: plans add it that need it themselves.
fn never_added(
    facts: &AgentFacts<'_>,
    belief: BeliefId,
    reads: &[BeliefRead],
    circular: bool,
) -> Option<Diagnostic> {
    let first = reads.iter().find(|r| !r.negated).or(reads.first())?;
    let declared = facts.belief(belief);
    let (name, what) = (&declared.name, any_args(&declared.name, declared.params.len()));
    let why = if circular {
        format!("only plans that never run without the belief `{name}` add it")
    } else {
        format!("nothing adds the belief `{name}`")
    };
    let (message, here) = if first.negated {
        (format!("`not {name}` always holds: {why}"), "this is always true")
    } else {
        (why, "this never holds")
    };
    let mut issue = Diagnostic::warning(DiagnosticCode::BELIEF_NEVER_ADDED, first.span, message).here(here);
    for read in reads.iter().filter(|r| r.span != first.span) {
        issue = issue.label(read.span, "tested here too");
    }
    let issue = issue.label(declared.origin, "declared here, without an initial value");
    if circular {
        return Some(issue.help("give its declaration an initial value, or let a suite choose it"));
    }
    let otherwise = format!(
        "let a plan add it (`+{what}`), a suite choose it, or its declaration give it an initial value"
    );
    Some(facts.near_belief(issue, belief, first.name, otherwise))
}
