//! What is well formed and yet cannot be meant: a second look at a whole [`Scenario`] without errors.
//!
//! Each rule is one small file with one code; all are warnings unless the rule says that the text can never work.

mod agent_facts;
mod applicable;
mod belief_never_added;
mod contradiction;
mod dead_plan;
mod drops_anothers_belief;
mod facts;
mod no_failure_plan;
mod no_time_passes;
mod plan_terms;
mod shadowed_plan;

use hrdsl_source::Diagnostic;

use crate::Scenario;
use facts::Facts;

/// A rule: reads the scenario and says what it finds.
type Rule = fn(&Scenario, &Facts, &mut Vec<Diagnostic>);

/// All rules, by code.
const RULES: &[Rule] = &[
    belief_never_added::check,
    drops_anothers_belief::check,
    shadowed_plan::check,
    dead_plan::check,
    no_failure_plan::check,
    no_time_passes::check,
];

/// Looks for what cannot be meant in a scenario that has no errors.
#[must_use]
pub fn lint(scenario: &Scenario) -> Vec<Diagnostic> {
    let facts = Facts::of(scenario);
    let mut issues = Vec::new();
    for rule in RULES {
        rule(scenario, &facts, &mut issues);
    }
    issues
}
