//! What is well formed and yet cannot be meant: a second look at a whole [`Scenario`] without errors.
//!
//! Each rule is one small file with one code; all are warnings unless the rule says that the text can never work.

mod cross_bins;
mod events;
mod facts;
mod flow;
mod interval;
mod never_triggered;
mod no_time_passes;
mod overflow;
mod time_stops;
mod unreachable_location;
mod unused;

use hrdsl_source::Diagnostic;

use crate::Scenario;
use facts::Facts;

/// A rule: reads the scenario and says what it finds.
type Rule = fn(&Scenario, &Facts, &mut Vec<Diagnostic>);

/// All rules, by code.
const RULES: &[Rule] = &[
    unused::check,
    overflow::check,
    events::not_made,
    events::not_taken,
    events::awaits_nothing,
    unreachable_location::check,
    time_stops::check,
    no_time_passes::check,
    never_triggered::check,
    cross_bins::empty,
    cross_bins::equal,
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
