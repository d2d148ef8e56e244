//! HR0404: a belief is tested that never holds.

use hrdsl_source::{Code, Diagnostic, Span};

use super::{
    agent_facts::{AgentFacts, agents, all_steps, any_args, literals},
    dead_plan::never_runs,
    facts::Facts,
};
use crate::{BeliefId, Context, Scenario, StepKind, TriggerOn};

/// A place that tests a belief.
struct Read {
    span: Span,
    /// The name in it, where it is known.
    name: Option<Span>,
    negated: bool,
}

pub(crate) fn check(scenario: &Scenario, _: &Facts, issues: &mut Vec<Diagnostic>) {
    for facts in agents(scenario) {
        let ids = (0..).map(BeliefId).take(facts.agent.beliefs.len());
        for belief in ids.filter(|b| !facts.comes_about(*b)) {
            issues.extend(never_added(&facts, belief, &reads(&facts, belief), false));
        }
        for belief in facts.only_from_themselves() {
            issues.extend(never_added(&facts, belief, &reads(&facts, belief), true));
        }
    }
}

fn reads(facts: &AgentFacts<'_>, belief: BeliefId) -> Vec<Read> {
    let name = &facts.belief(belief).name;
    // A plan for the query may answer it without a fact.
    let answered = facts.plans(TriggerOn::Test(belief)).next().is_some();
    let mut all = Vec::new();
    for plan in facts.agent.plans.iter().filter(|p| !never_runs(facts, p)) {
        let steps = all_steps(&plan.body);
        let conditions = steps.iter().filter_map(|s| s.condition());
        for formula in [&plan.context].into_iter().chain(conditions) {
            all.extend(reads_in(formula, belief, name));
        }
        for step in steps {
            if matches!(&step.kind, StepKind::Query(l) if l.belief == belief) && !answered {
                all.push(Read { span: step.span, name: None, negated: false });
            }
        }
    }
    for rule in &facts.agent.rules {
        all.extend(reads_in(&rule.body, belief, name));
    }
    for condition in facts.choice_conditions() {
        all.extend(reads_in(&condition.context, belief, name));
    }
    all
}

fn reads_in<'c>(formula: &'c Context, belief: BeliefId, name: &'c str) -> impl Iterator<Item = Read> + 'c {
    literals(formula).into_iter().filter(move |l| l.belief == belief).map(move |l| Read {
        span: l.span,
        name: Some(l.name_span(name)),
        negated: l.negated,
    })
}

/// One diagnostic for all places that test the belief. `circular`: plans add it that need it themselves.
fn never_added(
    facts: &AgentFacts<'_>,
    belief: BeliefId,
    reads: &[Read],
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
    let mut issue = Diagnostic::warning(Code::BELIEF_NEVER_ADDED, first.span, message).here(here);
    for read in reads.iter().filter(|r| r.span != first.span) {
        issue = issue.label(read.span, "tested here too");
    }
    let issue = issue.label(declared.span, "declared here, without an initial value");
    if circular {
        return Some(issue.help("give its declaration an initial value, or let a suite choose it"));
    }
    let otherwise = format!(
        "let a plan add it (`+{what}`), a suite choose it, or its declaration give it an initial value"
    );
    Some(facts.near_belief(issue, belief, first.name, otherwise))
}
