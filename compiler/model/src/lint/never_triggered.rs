//! HR0602: a requirement that nothing can ever put to the test.

use hrdsl_ir::known_name;
use hrdsl_source::{Diagnostic, DiagnosticCode};

use super::facts::ScenarioFacts;
use crate::Scenario;

pub(crate) fn check<'a>(scenario: &'a Scenario, facts: &'a ScenarioFacts<'a>, issues: &mut Vec<Diagnostic>) {
    for (i, requirement) in scenario.requirements.iter().enumerate() {
        let Some(trigger) = facts.untested(i) else { continue };
        let event = trigger.first().and_then(|w| scenario.events.get(usize::from(w.event.0)));
        let name = known_name("event", event.map(|e| e.name.as_str()));
        let made = trigger.iter().any(|w| facts.made(w.event));
        let how = if made { "with these arguments nobody makes" } else { "nobody makes" };
        let message = format!("the requirement `{}` can never be triggered", requirement.name);
        let issue = Diagnostic::warning(DiagnosticCode::NEVER_TRIGGERED, requirement.text, message);
        issues.push(issue.here(format!("{how} `{name}`")).help("name an event that somebody makes"));
    }
}
