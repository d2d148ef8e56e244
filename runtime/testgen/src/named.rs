//! Goals with names for people, and what edges are called.

use hrdsl_ir::ta::{Automaton, LocationId};
use hrdsl_results::SuiteGoalId;
use hrdsl_ta::{GoalKind, ReachabilityGoal};

use crate::covers::WitnessedGoal;

/// A goal of a suite, and what the search has to reach for it. It is reached if one of its alternatives is.
pub struct NamedGoal {
    pub id: SuiteGoalId,
    pub alternatives: Vec<ReachabilityGoal>,
    /// Each with the alternative of the same place.
    pub shown: Vec<WitnessedGoal>,
    /// Index of the requirement whose observer it needs.
    pub monitor: Option<usize>,
}

impl NamedGoal {
    pub(super) fn one(id: SuiteGoalId, what: GoalKind, settled: bool, shown: WitnessedGoal) -> Self {
        Self { id, alternatives: vec![ReachabilityGoal { what, settled }], shown: vec![shown], monitor: None }
    }

    /// Whether one state of a run meets it, whatever comes before and after; a bin is met by the whole run.
    pub(super) fn is_of_states(&self) -> bool {
        self.shown.iter().all(|shown| match shown {
            WitnessedGoal::Location(..) | WitnessedGoal::State(_) => true,
            WitnessedGoal::Edge(..)
            | WitnessedGoal::Pair(..)
            | WitnessedGoal::Bin(_)
            | WitnessedGoal::Violation(_)
            | WitnessedGoal::Trigger(_)
            | WitnessedGoal::Nothing => false,
        })
    }
}

/// Edges that were written, with their numbers in the source from 1.
pub(super) fn declared(automaton: &Automaton) -> Vec<(usize, usize)> {
    let name = |id: LocationId| automaton.locations[usize::from(id.0)].name.as_str();
    let written = automaton.edges.iter().enumerate().filter(|(_, e)| !is_generated(name(e.from)));
    (1..).zip(written.map(|(edge, _)| edge)).collect()
}

/// `sense -> decide (edge 3)`
pub(super) fn edge_name(automaton: &Automaton, number: usize, edge: usize) -> String {
    let name = |id: LocationId| automaton.locations[usize::from(id.0)].name.as_str();
    let e = &automaton.edges[edge];
    format!("{} -> {} (edge {number})", name(e.from), name(final_target(automaton, e.to)))
}

/// Locations that the compiler put into an edge have a `~` in their name; so have variables.
pub(super) fn is_generated(name: &str) -> bool {
    name.contains('~')
}

/// Where an edge leads to in the source: through generated locations.
fn final_target(automaton: &Automaton, mut to: LocationId) -> LocationId {
    for _ in 0..automaton.locations.len() {
        if !is_generated(&automaton.locations[to.0 as usize].name) {
            break;
        }
        let Some(next) = automaton.edges.iter().find(|e| e.from == to) else { break };
        to = next.to;
    }
    to
}
