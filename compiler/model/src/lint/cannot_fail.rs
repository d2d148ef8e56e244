//! HR0605: a requirement that no run can violate, whatever the code does.

use hrdsl_source::{Diagnostic, DiagnosticCode};

use super::{
    facts::ScenarioFacts,
    world_range::{cap, truth},
};
use crate::Scenario;

pub(crate) fn check<'a>(scenario: &'a Scenario, facts: &'a ScenarioFacts<'a>, issues: &mut Vec<Diagnostic>) {
    for (i, requirement) in scenario.requirements.iter().enumerate() {
        if facts.untested(i).is_some() {
            continue;
        }
        let sentence = &requirement.pattern;
        let harmless = |condition, is: &dyn Fn(bool) -> bool| {
            truth(scenario, condition, 0).filter(|truth| is(*truth)).map(|truth| (condition, truth))
        };
        let in_pattern =
            sentence.pattern.condition().and_then(|c| harmless(c, &|truth| sentence.is_harmless(truth)));
        // A part of a run that never comes.
        let in_scope = || sentence.scope.condition().and_then(|c| harmless(c, &|truth| !truth));
        let Some((condition, truth)) = in_pattern.or_else(in_scope) else { continue };
        let why = if truth { "the condition is always true" } else { "the condition is never true" };
        let why = cap(scenario, condition).map_or(why.to_owned(), |cap| format!("{why}: {cap}"));
        let message = format!("the requirement `{}` cannot fail", requirement.name);
        let issue = Diagnostic::warning(DiagnosticCode::CANNOT_FAIL, requirement.text, message);
        issues.push(issue.here(why).help("change the condition: no test can say anything about it"));
    }
}
