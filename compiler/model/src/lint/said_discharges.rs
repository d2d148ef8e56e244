//! HR0604: a requirement that the code's own word is enough to meet.

use hrdsl_source::{Diagnostic, DiagnosticCode};
use hrdsl_syntax::{CountBound, RequirementPattern, RequirementScope};

use super::facts::ScenarioFacts;
use crate::{
    EventPattern, Provenance, Scenario, TypedOccurrence, TypedPattern,
    provenance::{is_the_systems, of_pattern},
    world::TypedWorld,
};

/// What in a requirement the code decides by what it says.
struct WeakEvidence<'a> {
    /// The part that these events play.
    role: &'static str,
    events: Vec<(&'a EventPattern, Provenance)>,
}

pub(crate) fn check<'a>(scenario: &'a Scenario, facts: &'a ScenarioFacts<'a>, issues: &mut Vec<Diagnostic>) {
    // Without devices there is nothing that the code does but talk.
    let Some(instead) = scenario.world.as_ref().and_then(observations) else { return };
    for (i, requirement) in scenario.requirements.iter().enumerate() {
        if facts.untested(i).is_some() {
            continue;
        }
        let Some(weak) = weak(scenario, &requirement.pattern) else { continue };
        let message = format!("the requirement `{}` takes the code at its word", requirement.name);
        let issue = Diagnostic::warning(DiagnosticCode::SAID_DISCHARGES, requirement.text, message);
        issues.push(issue.here(told(scenario, &weak)).help(format!(
            "ask for what the world shows: let an actor of the environment have an event that a rule makes, \
             such as {instead}; `allow` this where the word itself is what counts"
        )));
    }
}

/// What is weakest in a requirement: what it asks for, if the code's word or command is enough for it; what it forbids, if nothing
/// but the code's word would tell. Where each event that it names is a trigger, who keeps silent gets a vacuous verdict, and no pass.
fn weak<'a>(scenario: &Scenario, sentence: &'a TypedPattern) -> Option<WeakEvidence<'a>> {
    in_pattern(scenario, sentence).or_else(|| match &sentence.scope {
        RequirementScope::AfterUntil(_, until) => {
            asked(scenario, "has a scope that is closed by", until.iter())
        }
        // What does not begin, or is to end and does not, is not passed.
        RequirementScope::Whole
        | RequirementScope::Before(_)
        | RequirementScope::After(_)
        | RequirementScope::Between(..)
        | RequirementScope::While(_) => None,
    })
}

fn in_pattern<'a>(scenario: &Scenario, sentence: &'a TypedPattern) -> Option<WeakEvidence<'a>> {
    match &sentence.pattern {
        RequirementPattern::Causes { response, .. } => asked(scenario, "is answered by", response.iter()),
        RequirementPattern::Forbids { forbidden, until, .. } => forbidden_events(scenario, forbidden)
            .or_else(|| asked(scenario, "has a ban that is lifted by", until.iter())),
        RequirementPattern::Precedes { first, .. } => {
            asked(scenario, "allows what comes after", first.iter())
        }
        RequirementPattern::Eventually { events, .. } => asked(scenario, "waits for", events.iter()),
        RequirementPattern::Counts { events, bound: CountBound::AtLeast | CountBound::Exactly, .. } => {
            asked(scenario, "counts", events.iter())
        }
        RequirementPattern::Formula(formula) => asked(scenario, "is met by", formula.met_by().into_iter())
            .or_else(|| forbidden_events(scenario, formula.kept_by_silence_of())),
        // Its scope alone triggers it: who keeps silent passes.
        RequirementPattern::NeverWhile { events, condition: None }
        | RequirementPattern::Counts { events, bound: CountBound::AtMost, .. }
            if !sentence.scope.is_whole() =>
        {
            forbidden_events(scenario, events)
        }
        RequirementPattern::NeverWhile { .. }
        | RequirementPattern::Counts { bound: CountBound::AtMost, .. }
        | RequirementPattern::Globally(_)
        | RequirementPattern::Lasts { .. } => None,
    }
}

/// What is asked for must be shown: one event that is only said, or only commanded, is enough to get away with.
fn asked<'a>(
    scenario: &Scenario,
    role: &'static str,
    asked: impl Iterator<Item = &'a TypedOccurrence>,
) -> Option<WeakEvidence<'a>> {
    let patterns = asked.filter_map(TypedOccurrence::as_event);
    let events: Vec<_> = patterns.map(|p| (p, evidence(scenario, p))).collect();
    let events: Vec<_> = events.into_iter().filter(|(_, p)| *p < Provenance::Played).collect();
    (!events.is_empty()).then_some(WeakEvidence { role, events })
}

/// What is forbidden may be commanded: without the command the device does nothing. Only silence must not be enough.
fn forbidden_events<'a>(
    scenario: &Scenario,
    forbidden: impl IntoIterator<Item = &'a TypedOccurrence>,
) -> Option<WeakEvidence<'a>> {
    let forbidden: Vec<&TypedOccurrence> = forbidden.into_iter().collect();
    let patterns = forbidden.iter().filter_map(|o| o.as_event());
    let events: Vec<_> = patterns.map(|p| (p, of_pattern(scenario, p))).collect();
    let silent = !events.is_empty()
        && events.len() == forbidden.len()
        && events.iter().all(|(_, p)| *p == Provenance::Said);
    silent.then_some(WeakEvidence { role: "looks for nothing but", events })
}

/// What there is to show for an event that is asked for. That of a system's actor can always be made by its code, too.
fn evidence(scenario: &Scenario, pattern: &EventPattern) -> Provenance {
    let shown = of_pattern(scenario, pattern);
    if is_the_systems(scenario, pattern.event) { shown.min(Provenance::Commanded) } else { shown }
}

/// `is answered by `released`, which the code says`
fn told(scenario: &Scenario, weak: &WeakEvidence<'_>) -> String {
    let name = |p: &EventPattern| scenario.events.get(usize::from(p.event.0)).map_or("", |e| e.name.as_str());
    let mut names: Vec<&str> = weak.events.iter().map(|(p, _)| name(p)).collect();
    names.dedup();
    let least = weak.events.iter().map(|(p, _)| of_pattern(scenario, p)).min().unwrap_or(Provenance::Said);
    let whose = match least {
        Provenance::Said => "which comes about when the code says so",
        Provenance::Commanded => "which the code commands, whatever comes of it",
        Provenance::Played | Provenance::Seen => "which the code may say, too, since it comes from its actor",
    };
    format!("{} `{}`, {whose}", weak.role, names.join("` or `"))
}

/// What could be seen of the scenario's own devices: of a gripper, or else of a base, or else of an arm.
fn observations(world: &TypedWorld) -> Option<String> {
    let body = |id: crate::BodyId| world.bodies.get(usize::from(id.0)).map_or("", |b| b.name.as_str());
    if let Some((i, gripper)) = world.grippers.iter().enumerate().find(|(_, g)| commanded(world, g.palm)) {
        let current = world.currents.iter().find(|c| usize::from(c.by.0) == i);
        let held = current
            .map(|c| c.name.as_str())
            .or_else(|| gripper.holds.first().map(|id| body(*id)).filter(|_| gripper.holds.len() == 1));
        let what = held.map_or_else(|| gripper.name.clone(), |held| format!("{}, {held}", gripper.name));
        let touch = held.map(|held| format!("`on falling(touches({}, {held})) emit …`", body(gripper.palm)));
        let first = format!("`on falling(holds({what})) emit …`");
        return Some(std::iter::once(first).chain(touch).collect::<Vec<_>>().join(" or "));
    }
    if let Some(base) = world.bases.first() {
        return Some(format!("`on falling(speed({}) > 1 cm/s, 500 ms) emit …`", body(base.body)));
    }
    let arm = world.arms.first()?;
    Some(format!("`on falling(joint_speed({}) > 0.01 rad/s, 500 ms) emit …`", arm.name))
}

/// Whether a palm is a robot's: people's hands are led, or alive.
fn commanded(world: &TypedWorld, palm: crate::BodyId) -> bool {
    use crate::BodyMotion::{Dynamic, Fixed, Guided, Kinematic};
    world.bodies.get(usize::from(palm.0)).is_some_and(|b| match b.motion {
        Fixed | Dynamic => true,
        Kinematic => world.bases.iter().any(|base| base.body == palm),
        Guided => false,
    })
}
