//! HR0605: a requirement that no run can violate, whatever the code does.

use hrdsl_source::{Diagnostic, DiagnosticCode};
use hrdsl_syntax::{RequirementPattern, TemporalJunction, TemporalKind, TemporalLook, TemporalWindow};

use super::{
    facts::ScenarioFacts,
    world_range::{cap, truth},
};
use crate::{Scenario, TypedRequirement, TypedTemporal};

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
        let Some((condition, truth)) = in_pattern.or_else(in_scope) else {
            if let RequirementPattern::Formula(formula) = &sentence.pattern
                && always_holds(scenario, formula) == Some(true)
            {
                issues.push(told(requirement, "it holds at every moment of every run, whatever happens"));
            }
            continue;
        };
        let why = if truth { "the condition is always true" } else { "the condition is never true" };
        let why = cap(scenario, condition).map_or(why.to_owned(), |cap| format!("{why}: {cap}"));
        issues.push(told(requirement, why));
    }
}

fn told(requirement: &TypedRequirement, why: impl Into<String>) -> Diagnostic {
    let message = format!("the requirement `{}` cannot fail", requirement.name);
    let issue = Diagnostic::warning(DiagnosticCode::CANNOT_FAIL, requirement.text, message);
    issue.here(why).help("change the condition: no test can say anything about it")
}

/// The truth of a formula at every moment, if it is the same at all of them in every run. Windows into the past may lie before the first moment,
/// where `once` is false and `historically` true.
fn always_holds(scenario: &Scenario, formula: &TypedTemporal) -> Option<bool> {
    let of = |formula: &TypedTemporal| always_holds(scenario, formula);
    let is_now = |window: &Option<TemporalWindow<f64>>| window.as_ref().is_none_or(|w| w.from <= 0.0);
    match &formula.kind {
        TemporalKind::Constant(truth) => Some(*truth),
        TemporalKind::Events(_) => None,
        TemporalKind::Condition(condition) => truth(scenario, condition, 0),
        TemporalKind::Not(a) => of(a).map(|truth| !truth),
        TemporalKind::Junction(junction, parts) => {
            let (a, b) = (of(&parts[0]), of(&parts[1]));
            let (a, decides) = match junction {
                TemporalJunction::And => (a, false),
                TemporalJunction::Or => (a, true),
                TemporalJunction::Implies => (a.map(|truth| !truth), true),
            };
            if a == Some(decides) || b == Some(decides) { Some(decides) } else { a.and(b) }
        }
        TemporalKind::Look { look, window, of: a } => {
            let (truth, is_safe) = (of(a)?, is_now(window));
            let holds = match look {
                TemporalLook::Eventually | TemporalLook::Always => true,
                // Whether there was a moment so long ago decides nothing here.
                TemporalLook::Once => !truth || is_safe,
                TemporalLook::Historically => truth || is_safe,
            };
            holds.then_some(truth)
        }
        TemporalKind::Reach { window, of: parts, .. } => match of(&parts[1])? {
            true => is_now(window).then_some(true),
            false => Some(false),
        },
    }
}
