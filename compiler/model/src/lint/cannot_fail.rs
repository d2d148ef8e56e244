//! HR0605: a requirement that no run can violate, whatever the code does.

use hrdsl_source::{Diagnostic, DiagnosticCode};
use hrdsl_syntax::{
    CountBound, RequirementPattern, RequirementScope, TemporalJunction, TemporalKind, TemporalLook,
    TemporalWindow,
};

use super::{
    facts::ScenarioFacts,
    plan_terms::same,
    requirements::covers,
    world_range::{cap, truth},
};
use crate::{Scenario, TypedPattern, TypedRequirement, TypedTemporal};

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
            if let RequirementPattern::Formula(formula) = &sentence.pattern {
                issues.extend(in_formula(scenario, requirement, formula));
            } else if closes_itself(sentence) {
                let why = "what closes the scope is not in it, so nothing that is counted ever is";
                issues.push(told(requirement, why));
            }
            continue;
        };
        let why = if truth { "the condition is always true" } else { "the condition is never true" };
        let why = cap(scenario, condition).map_or(why.to_owned(), |cap| format!("{why}: {cap}"));
        issues.push(told(requirement, why));
    }
}

fn in_formula(
    scenario: &Scenario,
    requirement: &TypedRequirement,
    formula: &TypedTemporal,
) -> Option<Diagnostic> {
    if always_holds(scenario, formula) == Some(true) {
        return Some(told(requirement, "it holds at every moment of every run, whatever happens"));
    }
    // `always E implies Q` is `(always E) implies Q`, which nobody means.
    let TemporalKind::Junction(TemporalJunction::Implies, parts) = &formula.kind else { return None };
    let TemporalKind::Look { look: TemporalLook::Always, window: None, of } = &parts[0].kind else {
        return None;
    };
    is_instant(of).then(|| {
        let why = "`always` reaches up to `implies` only, and no event happens at every moment";
        issue(requirement, why).help("write `always (… implies …)`")
    })
}

/// Whether it holds at single instants only, if at all.
fn is_instant(formula: &TypedTemporal) -> bool {
    match &formula.kind {
        TemporalKind::Events(_) => true,
        TemporalKind::Junction(TemporalJunction::And, parts) => parts.iter().any(is_instant),
        TemporalKind::Junction(TemporalJunction::Or, parts) => parts.iter().all(is_instant),
        TemporalKind::Junction(TemporalJunction::Implies, _)
        | TemporalKind::Constant(_)
        | TemporalKind::Condition(_)
        | TemporalKind::Not(_)
        | TemporalKind::Look { .. }
        | TemporalKind::Reach { .. } => false,
    }
}

/// Whether each event that the pattern forbids closes the part of the run that its scope speaks of.
fn closes_itself(sentence: &TypedPattern) -> bool {
    let closing = match &sentence.scope {
        RequirementScope::Before(closing)
        | RequirementScope::Between(_, closing)
        | RequirementScope::AfterUntil(_, closing) => closing,
        RequirementScope::Whole | RequirementScope::After(_) | RequirementScope::While(_) => return false,
    };
    match &sentence.pattern {
        RequirementPattern::NeverWhile { events, .. }
        | RequirementPattern::Counts { events, bound: CountBound::AtMost, .. } => covers(closing, events),
        RequirementPattern::Forbids { forbidden, .. } => covers(closing, forbidden),
        RequirementPattern::Counts { .. }
        | RequirementPattern::Causes { .. }
        | RequirementPattern::Precedes { .. }
        | RequirementPattern::Eventually { .. }
        | RequirementPattern::Globally(_)
        | RequirementPattern::Lasts { .. }
        | RequirementPattern::Formula(_) => false,
    }
}

/// Whether two formulas without windows are written alike, wherever they stand.
fn alike(a: &TypedTemporal, b: &TypedTemporal) -> bool {
    match (&a.kind, &b.kind) {
        (TemporalKind::Constant(a), TemporalKind::Constant(b)) => a == b,
        (TemporalKind::Events(a), TemporalKind::Events(b)) => covers(a, b) && covers(b, a),
        (TemporalKind::Condition(a), TemporalKind::Condition(b)) => same(a, b),
        (TemporalKind::Not(a), TemporalKind::Not(b)) => alike(a, b),
        (TemporalKind::Junction(j, a), TemporalKind::Junction(k, b)) => {
            j == k && alike(&a[0], &b[0]) && alike(&a[1], &b[1])
        }
        (
            TemporalKind::Constant(_)
            | TemporalKind::Events(_)
            | TemporalKind::Condition(_)
            | TemporalKind::Not(_)
            | TemporalKind::Junction(..)
            | TemporalKind::Look { .. }
            | TemporalKind::Reach { .. },
            _,
        ) => false,
    }
}

/// The truth of `a junction b` that follows from their being the same, or each other's opposites.
fn by_form(junction: TemporalJunction, a: &TypedTemporal, b: &TypedTemporal) -> Option<bool> {
    let denies =
        |a: &TypedTemporal, b: &TypedTemporal| matches!(&a.kind, TemporalKind::Not(of) if alike(of, b));
    match junction {
        TemporalJunction::Implies => alike(a, b).then_some(true),
        TemporalJunction::Or => (denies(a, b) || denies(b, a)).then_some(true),
        TemporalJunction::And => (denies(a, b) || denies(b, a)).then_some(false),
    }
}

fn told(requirement: &TypedRequirement, why: impl Into<String>) -> Diagnostic {
    issue(requirement, why).help("change the condition: no test can say anything about it")
}

/// Without a help.
fn issue(requirement: &TypedRequirement, why: impl Into<String>) -> Diagnostic {
    let message = format!("the requirement `{}` cannot fail", requirement.name);
    Diagnostic::warning(DiagnosticCode::CANNOT_FAIL, requirement.text, message).here(why)
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
            let known = if a == Some(decides) || b == Some(decides) { Some(decides) } else { a.and(b) };
            known.or_else(|| by_form(*junction, &parts[0], &parts[1]))
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
