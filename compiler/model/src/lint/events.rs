//! HR0304 and HR0305: events that nobody makes, and events that nobody takes. HR0405: a wait for what nobody makes.

use hrdsl_ir::known_name;
use hrdsl_source::{Diagnostic, DiagnosticCode, FileId, Span};

use super::facts::ScenarioFacts;
use crate::{EventId, Scenario};

/// The events and stimuli of the scenario itself, with the place of their names.
pub(super) fn own_events(scenario: &Scenario) -> impl Iterator<Item = (EventId, &crate::TypedEvent, Span)> {
    let events = (0..=u16::MAX).map(EventId).zip(&scenario.events);
    let place = |i: EventId, e: &crate::TypedEvent| {
        scenario.places.events.get(usize::from(i.0)).copied().unwrap_or(e.origin)
    };
    events.map(move |(i, e)| (i, e, place(i, e))).filter(|(_, _, span)| span.file == FileId(0))
}

/// HR0304
pub(crate) fn not_made<'a>(
    scenario: &'a Scenario,
    facts: &'a ScenarioFacts<'a>,
    issues: &mut Vec<Diagnostic>,
) {
    for (id, event, span) in own_events(scenario) {
        if facts.made(id) || !facts.read(id) || facts.told(id) {
            continue;
        }
        let actor =
            known_name("actor", scenario.actors.get(usize::from(event.from.0)).map(|a| a.name.as_str()));
        let (message, help) = if event.stimulus.is_some() {
            let message = format!("nobody does the stimulus `{}`, and something counts on it", event.name);
            (message, "let an agent, an automaton, a random suite or a test do it".to_owned())
        } else {
            let message = format!("nobody makes the event `{}`, and something counts on it", event.name);
            (
                message,
                format!("let a stimulus, an agent or automaton of `{actor}`, or a rule of the world make it"),
            )
        };
        issues.push(Diagnostic::warning(DiagnosticCode::EVENT_NOT_MADE, span, message).help(help));
    }
}

/// HR0305
pub(crate) fn not_taken<'a>(
    scenario: &'a Scenario,
    facts: &'a ScenarioFacts<'a>,
    issues: &mut Vec<Diagnostic>,
) {
    for (id, event, span) in own_events(scenario) {
        let idle = event.stimulus.is_none() && facts.made(id) && !facts.read(id) && !facts.perceived(id);
        if idle {
            let message = format!("nobody takes the event `{}`", event.name);
            issues.push(
                Diagnostic::warning(DiagnosticCode::EVENT_NOT_TAKEN, span, message)
                    .help("let a plan, an edge, a requirement or a coverpoint read it, or delete it"),
            );
        }
    }
}

/// HR0405
pub(crate) fn awaits_nothing<'a>(
    scenario: &'a Scenario,
    facts: &'a ScenarioFacts<'a>,
    issues: &mut Vec<Diagnostic>,
) {
    for wait in &facts.waits {
        if !facts.in_vain(&wait.any_of) {
            continue;
        }
        let mut names: Vec<&str> = Vec::new();
        let mut others = false;
        for wanted in &wait.any_of {
            let event = scenario.events.get(usize::from(wanted.event.0));
            names.extend(event.map(|e| e.name.as_str()));
            others |= facts.made(wanted.event);
        }
        names.dedup();
        let names = names.join("` or `");
        let issue = if others {
            let message = format!("nobody makes `{names}` with these arguments");
            Diagnostic::warning(DiagnosticCode::AWAITS_NOTHING, wait.span, message)
                .help("wait for arguments that it is made with, or write `_` for any")
        } else {
            let message = format!("this waits for `{names}`, which nobody makes");
            Diagnostic::warning(DiagnosticCode::AWAITS_NOTHING, wait.span, message)
                .help("wait for another event, or let somebody make this one")
        };
        issues.push(issue);
    }
}
