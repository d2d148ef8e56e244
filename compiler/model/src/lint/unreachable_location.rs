//! HR0505: locations and edges of an automaton that nothing ever comes to.

use hrdsl_ir::known_name;
use hrdsl_source::{Diagnostic, DiagnosticCode, Span};

use super::{
    facts::ScenarioFacts,
    flow::{ValueFlow, clash},
    time_stops::{barred, stopping, violates},
};
use crate::{AutomatonPlaces, LocationId, Scenario, TypedAutomaton, TypedEdge};

pub(crate) fn check<'a>(scenario: &'a Scenario, facts: &'a ScenarioFacts<'a>, issues: &mut Vec<Diagnostic>) {
    for (index, flow) in facts.flows.iter().enumerate() {
        let automaton = &scenario.automata[index];
        let dead = dead_edges(automaton, flow);
        for (i, why) in &dead {
            issues.push(never_taken(automaton, &automaton.edges[*i], why));
        }
        // What lies behind such an edge is explained by it.
        let mut explained = vec![false; automaton.locations.len()];
        let behind = dead.iter().map(|(i, _)| usize::from(automaton.edges[*i].to.0)).collect();
        follow(automaton, flow, behind, &mut explained);
        locations(automaton, flow, scenario.places.automata.get(index), &mut explained, issues);
    }
}

/// The edges from reached locations that are never taken, with the reason.
fn dead_edges(automaton: &TypedAutomaton, flow: &ValueFlow) -> Vec<(usize, &'static str)> {
    let (barred, stopping) = (barred(automaton, flow), stopping(automaton, flow));
    let dead = |edge: &TypedEdge| {
        if !flow.reached(edge.from) {
            return None;
        }
        if flow.taken(edge).is_none() {
            return Some("its guard is never true here");
        }
        let from = automaton.locations.get(usize::from(edge.from.0))?;
        let late = edge.clock_guard.iter().any(|g| from.invariant.iter().any(|i| clash(g, i)));
        if late {
            // If it was the only way out, time stops there: that is HR0506.
            let said = stopping.get(usize::from(edge.from.0)).copied().unwrap_or(false);
            return (!said).then_some("its guard needs more time than the invariant allows");
        }
        let said = barred.get(usize::from(edge.to.0)).copied().unwrap_or(true);
        let why = "it would enter a location whose invariant does not hold then";
        (!said && violates(automaton, flow, edge)).then_some(why)
    };
    automaton.edges.iter().enumerate().filter_map(|(i, e)| Some((i, dead(e)?))).collect()
}

fn never_taken(automaton: &TypedAutomaton, edge: &TypedEdge, why: &str) -> Diagnostic {
    let name = |l: LocationId| {
        known_name("location", automaton.locations.get(usize::from(l.0)).map(|l| l.name.as_str()))
    };
    let message = format!("the edge from `{}` to `{}` is never taken", name(edge.from), name(edge.to));
    Diagnostic::warning(DiagnosticCode::UNREACHABLE_LOCATION, edge.origin, message)
        .here(why)
        .help("change the guard, or delete the edge")
        .fix("delete the edge", edge.origin, "", false)
}

/// Marks the locations that edges lead to from these, as far as they are not reached.
fn follow(automaton: &TypedAutomaton, flow: &ValueFlow, mut from: Vec<usize>, explained: &mut [bool]) {
    while let Some(location) = from.pop() {
        let id = LocationId(u16::try_from(location).unwrap_or(u16::MAX));
        if flow.reached(id) || explained.get(location).copied().unwrap_or(true) {
            continue;
        }
        explained[location] = true;
        from.extend(flow.out[location].iter().map(|e| usize::from(automaton.edges[*e].to.0)));
    }
}

/// Of locations that follow each other the first is named.
fn locations(
    automaton: &TypedAutomaton,
    flow: &ValueFlow,
    places: Option<&AutomatonPlaces>,
    explained: &mut [bool],
    issues: &mut Vec<Diagnostic>,
) {
    let mut entered = vec![false; automaton.locations.len()];
    for edge in automaton.edges.iter().filter(|e| e.from != e.to) {
        if let Some(e) = entered.get_mut(usize::from(edge.to.0)) {
            *e = true;
        }
    }
    for roots in [true, false] {
        for (i, location) in automaton.locations.iter().enumerate() {
            let id = LocationId(u16::try_from(i).unwrap_or(u16::MAX));
            if flow.reached(id) || explained[i] || roots && entered[i] {
                continue;
            }
            follow(automaton, flow, vec![i], explained);
            let span: Span = places.and_then(|p| p.locations.get(i)).copied().unwrap_or(location.origin);
            let message = format!("no edge leads to `{}` from the initial location", location.name);
            let issue = Diagnostic::warning(DiagnosticCode::UNREACHABLE_LOCATION, span, message);
            let untouched = flow.out[i].is_empty() && !entered[i];
            issues.push(if untouched {
                issue.help("add an edge to it, or delete it").fix(
                    "delete the location",
                    location.origin,
                    "",
                    true,
                )
            } else {
                issue.help("add an edge to it, or delete it with its edges")
            });
        }
    }
}
