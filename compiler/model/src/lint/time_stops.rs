//! HR0506: a location whose invariant ends without a way out, so that no run of the model can go on.

use hrdsl_source::{Diagnostic, DiagnosticCode};
use hrdsl_syntax::ast::LocationKind;

use super::{
    facts::ScenarioFacts,
    flow::{ValueFlow, clash},
};
use crate::{
    ClockOp, LocationId, Scenario, TypedAutomaton, TypedClockConstraint, TypedEdge, TypedLocation,
    TypedUpdate,
};

pub(crate) fn check<'a>(scenario: &'a Scenario, facts: &'a ScenarioFacts<'a>, issues: &mut Vec<Diagnostic>) {
    for (index, flow) in facts.flows.iter().enumerate() {
        let automaton = &scenario.automata[index];
        let (barred, stopping) = (barred(automaton, flow), stopping(automaton, flow));
        for (i, location) in automaton.locations.iter().enumerate() {
            let id = LocationId(u16::try_from(i).unwrap_or(u16::MAX));
            if location.invariant.is_empty() || !flow.reached(id) {
                continue;
            }
            let places = scenario.places.automata.get(index);
            let span = places.and_then(|p| p.locations.get(i)).copied().unwrap_or(location.origin);
            let name = &location.name;
            let warning = |message: String| Diagnostic::warning(DiagnosticCode::TIME_STOPS, span, message);
            if barred[i] {
                issues.push(
                    warning(format!("the invariant of `{name}` is violated on every path in"))
                        .here("the clock is past its bound before it comes here")
                        .help("reset the clock on the edges that lead here"),
                );
            } else if stopping[i] {
                let listens = flow.out[i].iter().any(|e| flow.only_hears(&automaton.edges[*e]));
                let help = if listens {
                    "add an edge without `on` that is taken by then: the event may not come"
                } else {
                    "add an edge that can be taken by then, or drop the invariant"
                };
                issues.push(
                    warning(format!("time stops in `{name}`: nothing leads out by the end of its invariant"))
                        .help(help),
                );
            }
        }
    }
}

/// By location: it has an invariant that ends, and no edge that the automaton can take by then. An edge over a channel
/// counts as one: whether its partner is ready only a search can tell.
pub(super) fn stopping(automaton: &TypedAutomaton, flow: &ValueFlow) -> Vec<bool> {
    let stops = |(i, location): (usize, &TypedLocation)| {
        let leaves = |e: &TypedEdge| {
            let late = e.clock_guard.iter().any(|g| location.invariant.iter().any(|i| clash(g, i)));
            let stays = usize::from(e.to.0) == i && !location.invariant.iter().any(|i| sets(e, i));
            !flow.only_hears(e) && !late && !stays && flow.taken(e).is_some()
        };
        let ends = |i: &TypedClockConstraint| {
            // What other automata may set back need not end.
            let stands = location.stopped.contains(&i.clock);
            i.minus.is_none() && !stands && flow.is_own(i) && !matches!(i.op, ClockOp::Ge | ClockOp::Gt)
        };
        let ends = location.kind == LocationKind::Normal && location.invariant.iter().any(ends);
        ends && !flow.out[i].iter().any(|e| leaves(&automaton.edges[*e]))
    };
    automaton.locations.iter().enumerate().map(stops).collect()
}

/// Whether an edge would enter its target past the end of the target's invariant.
pub(super) fn violates(automaton: &TypedAutomaton, flow: &ValueFlow, edge: &TypedEdge) -> bool {
    let invariant: &[TypedClockConstraint] =
        automaton.locations.get(usize::from(edge.to.0)).map_or(&[], |l| &l.invariant);
    let past = |i: &TypedClockConstraint| {
        flow.is_own(i) && !sets(edge, i) && edge.clock_guard.iter().any(|g| clash(g, i))
    };
    invariant.iter().any(past)
}

/// By location: it is not the initial one, and every edge that leads there violates its invariant.
pub(super) fn barred(automaton: &TypedAutomaton, flow: &ValueFlow) -> Vec<bool> {
    let mut ways = vec![(false, false); automaton.locations.len()];
    for edge in automaton.edges.iter().filter(|e| e.from != e.to && flow.taken(e).is_some()) {
        if let Some((good, bad)) = ways.get_mut(usize::from(edge.to.0)) {
            let violates = violates(automaton, flow, edge);
            *good |= !violates;
            *bad |= violates;
        }
    }
    if let Some(way) = ways.get_mut(usize::from(automaton.initial.0)) {
        way.0 = true;
    }
    ways.into_iter().map(|(good, bad)| bad && !good).collect()
}

/// Whether an edge sets a clock of a bound.
fn sets(edge: &TypedEdge, bound: &TypedClockConstraint) -> bool {
    edge.updates.iter().any(|u| match u {
        TypedUpdate::Reset { clock, .. } => bound.clocks().any(|c| c == *clock),
        TypedUpdate::Assign { .. } | TypedUpdate::Call { .. } => false,
    })
}
