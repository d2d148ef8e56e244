//! HR0605: a requirement that no run can violate, whatever the code does.

use hrdsl_source::{Diagnostic, DiagnosticCode};

use super::{
    facts::ScenarioFacts,
    world_range::{cap, truth},
};
use crate::Scenario;

pub(crate) fn check<'a>(scenario: &'a Scenario, facts: &'a ScenarioFacts<'a>, issues: &mut Vec<Diagnostic>) {
    for (requirement, trigger) in scenario.requirements.iter().zip(&facts.triggers) {
        let Some(condition) = requirement.pattern.condition().filter(|_| !facts.in_vain(trigger)) else {
            continue;
        };
        let harmless = requirement.pattern.harmless();
        if truth(scenario, condition, 0) != Some(harmless) {
            continue;
        }
        let why = if harmless { "the condition is always true" } else { "the condition is never true" };
        let why = cap(scenario, condition).map_or(why.to_owned(), |cap| format!("{why}: {cap}"));
        let message = format!("the requirement `{}` cannot fail", requirement.name);
        let issue = Diagnostic::warning(DiagnosticCode::CANNOT_FAIL, requirement.text, message);
        issues.push(issue.here(why).help("change the condition: no test can say anything about it"));
    }
}
