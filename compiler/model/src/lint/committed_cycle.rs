//! HR0507: a cycle of committed and urgent locations that an automaton can go round for ever at one instant.

use hrdsl_source::{Diagnostic, DiagnosticCode};
use hrdsl_syntax::ast::LocationKind;

use super::facts::ScenarioFacts;
use crate::{LocationId, Scenario, TypedAutomaton, TypedEdge, TypedSync, TypedTime, TypedUpdate};

pub(crate) fn check<'a>(scenario: &'a Scenario, facts: &'a ScenarioFacts<'a>, issues: &mut Vec<Diagnostic>) {
    for (index, flow) in facts.flows.iter().enumerate() {
        let automaton = &scenario.automata[index];
        let instant = |l: LocationId| {
            let location = automaton.locations.get(usize::from(l.0));
            location.is_some_and(|l| l.kind != LocationKind::Normal && l.holds.is_none())
        };
        let mut next: Vec<Vec<usize>> = vec![Vec::new(); automaton.locations.len()];
        for edge in automaton.edges.iter().filter(|e| is_free(e) && flow.reached(e.from)) {
            if instant(edge.from) && instant(edge.to) {
                next[usize::from(edge.from.0)].push(usize::from(edge.to.0));
            }
        }
        for cycle in cycles(&next) {
            issues.push(said(scenario, index, automaton, &cycle));
        }
    }
}

/// Nothing holds the edge up, and nothing is another afterwards.
fn is_free(edge: &TypedEdge) -> bool {
    edge.sync == TypedSync::Internal
        && edge.guard.is_none()
        && edge.clock_guard.is_empty()
        && edge
            .updates
            .iter()
            .all(|u| matches!(u, TypedUpdate::Reset { from: None, to, .. } if *to == TypedTime::default()))
}

fn said(scenario: &Scenario, index: usize, automaton: &TypedAutomaton, cycle: &[usize]) -> Diagnostic {
    let names: Vec<&str> =
        cycle.iter().chain(&cycle[..1]).map(|l| automaton.locations[*l].name.as_str()).collect();
    let places = scenario.places.automata.get(index);
    let first = cycle[0];
    let span =
        places.and_then(|p| p.locations.get(first)).copied().unwrap_or(automaton.locations[first].origin);
    let message = format!("no time passes in the cycle `{}`", names.join(" -> "));
    Diagnostic::warning(DiagnosticCode::NO_TIME_PASSES_HERE, span, message)
        .here("it can be gone round for ever at one instant")
        .help("let one of its locations be a plain `location`, or guard an edge")
}

/// Disjoint cycles of a graph: each as its nodes, the first in the text at the front.
fn cycles(next: &[Vec<usize>]) -> Vec<Vec<usize>> {
    #[derive(Clone, Copy, PartialEq)]
    enum VisitMark {
        New,
        Open,
        Done,
    }
    let mut marks = vec![VisitMark::New; next.len()];
    let mut in_cycle = vec![false; next.len()];
    let mut found = Vec::new();
    for root in 0..next.len() {
        if marks[root] != VisitMark::New {
            continue;
        }
        marks[root] = VisitMark::Open;
        // The way from the root, each node with how many of its edges have been followed.
        let mut path = vec![(root, 0)];
        while let Some((node, followed)) = path.last_mut() {
            let (from, edge) = (*node, *followed);
            *followed += 1;
            match next[from].get(edge) {
                None => {
                    marks[from] = VisitMark::Done;
                    path.pop();
                }
                Some(&to) if marks[to] == VisitMark::New => {
                    marks[to] = VisitMark::Open;
                    path.push((to, 0));
                }
                Some(&to) if marks[to] == VisitMark::Open => {
                    if in_cycle[from] || in_cycle[to] {
                        continue;
                    }
                    let start = path.iter().rposition(|(n, _)| *n == to).unwrap_or(0);
                    let mut cycle: Vec<usize> = path[start..].iter().map(|(n, _)| *n).collect();
                    cycle.iter().for_each(|n| in_cycle[*n] = true);
                    let least = (0..cycle.len()).min_by_key(|i| cycle[*i]).unwrap_or(0);
                    cycle.rotate_left(least);
                    found.push(cycle);
                }
                Some(_) => {}
            }
        }
    }
    found
}
