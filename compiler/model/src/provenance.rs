//! Whose word an event is: said by the code, commanded of a device, played by the environment, or seen in the world.

use hrdsl_ir::world::RuleTrigger;

use crate::{
    ArgPattern, EventId, EventPattern, Provenance, Role, Scenario, TypedExpr, TypedExprKind, TypedWorldRule,
    VariableRef,
};

/// Of all events, by their ids.
pub(crate) fn of_events(scenario: &Scenario) -> Vec<Provenance> {
    let any = |i: usize| {
        let event = EventId(u16::try_from(i).unwrap_or(u16::MAX));
        let args = scenario.events.get(i).map_or(0, |e| e.params.len());
        of_pattern(scenario, &EventPattern { event, args: vec![ArgPattern::Any; args] })
    };
    (0..scenario.events.len()).map(any).collect()
}

/// Of the events that fit a pattern: that of the weakest way in which one comes about.
pub(crate) fn of_pattern(scenario: &Scenario, pattern: &EventPattern) -> Provenance {
    weakest(scenario, pattern, &mut Vec::new())
}

/// Whether the code that plays the event's actor may make it itself, whatever rules do so, too.
pub(crate) fn is_the_systems(scenario: &Scenario, event: EventId) -> bool {
    let from = scenario.events.get(usize::from(event.0)).map(|e| usize::from(e.from.0));
    from.and_then(|from| scenario.actors.get(from)).is_some_and(|actor| actor.role == Role::System)
}

/// `above` are the events whose rules wait for this one; rules in a circle make nothing by themselves.
fn weakest(scenario: &Scenario, pattern: &EventPattern, above: &mut Vec<EventId>) -> Provenance {
    let rules = scenario.world.iter().flat_map(|world| &world.rules);
    let mut ways = Vec::new();
    above.push(pattern.event);
    for rule in rules.filter(|rule| fits(rule, pattern)) {
        ways.extend(of_rule(scenario, rule, pattern, above));
    }
    above.pop();
    let without_rules =
        if is_the_systems(scenario, pattern.event) { Provenance::Said } else { Provenance::Played };
    ways.into_iter().min().unwrap_or(without_rules)
}

fn of_rule(
    scenario: &Scenario,
    rule: &TypedWorldRule,
    pattern: &EventPattern,
    above: &mut Vec<EventId>,
) -> Option<Provenance> {
    match &rule.on {
        RuleTrigger::Edge { .. } => Some(Provenance::Seen),
        // What the world is like when the command begins shows nothing of what comes of it.
        RuleTrigger::Commanded { .. } => Some(Provenance::Commanded),
        RuleTrigger::Event(_) if looks(rule, pattern) => Some(Provenance::Seen),
        RuleTrigger::Event(on) if above.contains(&on.event) => None,
        RuleTrigger::Event(on) => Some(weakest(scenario, on, above)),
    }
}

/// Whether the rule can make an event that fits.
fn fits(rule: &TypedWorldRule, pattern: &EventPattern) -> bool {
    let mut pinned = rule.args.iter().zip(&pattern.args);
    rule.event == pattern.event
        && pinned.all(|(arg, want)| match (arg.constant(), want) {
            (Some(value), ArgPattern::Is(want)) => value.key() == want.key(),
            (Some(_) | None, ArgPattern::Any) | (None, ArgPattern::Is(_)) => true,
        })
}

/// Whether what the world is like decides if a fitting event happens.
fn looks(rule: &TypedWorldRule, pattern: &EventPattern) -> bool {
    let pinned = rule.args.iter().zip(&pattern.args).filter(|(_, want)| **want != ArgPattern::Any);
    rule.guard.iter().chain(pinned.map(|(arg, _)| arg)).any(reads_the_world)
}

fn reads_the_world(e: &TypedExpr) -> bool {
    let mut reads = false;
    e.each(&mut |e| {
        reads |= matches!(&e.kind, TypedExprKind::Term(_) | TypedExprKind::Leaf(VariableRef::Signal(_)));
    });
    reads
}
