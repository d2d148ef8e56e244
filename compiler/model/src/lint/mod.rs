//! What is well formed and yet cannot be meant: a second look at a whole [`Scenario`] without errors.
//!
//! Each rule is one small file with one code; all are warnings unless the rule says that the text can never work.

mod agent_facts;
mod agent_index;
mod applicable;
mod belief_never_added;
mod cannot_fail;
mod channels;
mod clocks_compared;
mod committed_cycle;
mod contradiction;
mod cross_bins;
mod dead_plan;
mod drops_anothers_belief;
mod events;
mod facts;
mod flow;
mod interval;
mod never_triggered;
mod no_failure_plan;
mod nothing_carries;
mod overflow;
mod plan_terms;
mod query_reads;
mod recursion_without_time;
mod removes_nothing;
mod requirements;
mod said_discharges;
mod shadowed_plan;
mod simple;
mod time_stops;
mod triggers;
mod unreachable_location;
mod unused;
mod world_range;

use indexmap::IndexSet;

use hrdsl_source::Diagnostic;

use crate::Scenario;
use facts::ScenarioFacts;

/// A rule: reads the scenario and says what it finds.
type LintRule = for<'a> fn(&'a Scenario, &'a ScenarioFacts<'a>, &mut Vec<Diagnostic>);

/// All rules, by code.
const RULES: &[LintRule] = &[
    unused::check,
    overflow::check,
    events::not_made,
    events::not_taken,
    belief_never_added::check,
    events::awaits_nothing,
    drops_anothers_belief::check,
    shadowed_plan::check,
    dead_plan::check,
    no_failure_plan::check,
    recursion_without_time::check,
    removes_nothing::check,
    unreachable_location::check,
    time_stops::check,
    committed_cycle::check,
    clocks_compared::check,
    channels::check,
    never_triggered::check,
    cannot_fail::check,
    requirements::contradicting,
    said_discharges::check,
    cross_bins::empty,
    cross_bins::equal,
    nothing_carries::check,
];

/// Looks for what cannot be meant in a scenario that has no errors.
#[must_use]
pub fn lint(scenario: &Scenario) -> Vec<Diagnostic> {
    let facts = ScenarioFacts::of(scenario);
    let mut issues = Vec::new();
    for rule in RULES {
        rule(scenario, &facts, &mut issues);
    }
    // What is wrong in a template is found in each of its instances.
    let mut seen = IndexSet::new();
    let is_new: Vec<bool> =
        issues.iter().map(|i| seen.insert((i.span(), i.code, i.message.as_str()))).collect();
    let mut is_new = is_new.into_iter();
    issues.retain(|_| is_new.next().unwrap_or(true));
    issues
}
