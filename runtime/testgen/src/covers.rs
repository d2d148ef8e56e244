//! Which goals of a suite by search a witness reaches besides its own: what is covered needs no test of its own.

use std::collections::BTreeSet;

use hrdsl_ir::{Program, coverage::BinName, ta::LocationId};
use hrdsl_ta::WitnessRun;

use hrdsl_prove as prove;

/// What happened in a run, as goals ask for it.
pub struct ReachedItems {
    /// Automaton and location.
    locations: BTreeSet<(usize, LocationId)>,
    /// Automaton and edge.
    edges: BTreeSet<(usize, usize)>,
    /// Automaton and two edges that it took one after the other.
    pairs: BTreeSet<(usize, usize, usize)>,
    bins: Vec<BinName>,
    violated: Vec<bool>,
    triggered: Vec<bool>,
}

/// A goal of which a run shows by itself whether it reaches it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum WitnessedGoal {
    Location(usize, LocationId),
    Edge(usize, usize),
    Pair(usize, usize, usize),
    Bin(BinName),
    Violation(usize),
    Trigger(usize),
    /// Only the search knows.
    Nothing,
}

impl ReachedItems {
    /// `initial`: where the automata start, in the network's order.
    #[must_use]
    pub fn of(program: &Program, initial: &[LocationId], witness: &WitnessRun, bins: Vec<BinName>) -> Self {
        let mut seen = Self {
            locations: initial.iter().copied().enumerate().collect(),
            edges: BTreeSet::new(),
            pairs: BTreeSet::new(),
            bins,
            violated: Vec::new(),
            triggered: Vec::new(),
        };
        let mut last: Vec<Option<usize>> = vec![None; initial.len()];
        for step in &witness.steps {
            seen.locations.extend(step.locations.iter().map(|(a, _, to)| (*a, *to)));
            for m in &step.moves {
                seen.edges.insert((m.automaton, m.edge));
                let Some(last) = last.get_mut(m.automaton) else { continue };
                if let Some(before) = last.replace(m.edge) {
                    seen.pairs.insert((m.automaton, before, m.edge));
                }
            }
        }
        for verdict in prove::verdicts(program, &prove::trace(witness)) {
            seen.violated.push(verdict.failures > 0);
            seen.triggered.push(verdict.triggered > 0);
        }
        seen
    }

    #[must_use]
    pub fn has(&self, goal: &WitnessedGoal) -> bool {
        match goal {
            WitnessedGoal::Location(a, l) => self.locations.contains(&(*a, *l)),
            WitnessedGoal::Edge(a, e) => self.edges.contains(&(*a, *e)),
            WitnessedGoal::Pair(a, first, second) => self.pairs.contains(&(*a, *first, *second)),
            WitnessedGoal::Bin(name) => self.bins.contains(name),
            WitnessedGoal::Violation(monitor) => self.violated.get(*monitor) == Some(&true),
            WitnessedGoal::Trigger(monitor) => self.triggered.get(*monitor) == Some(&true),
            WitnessedGoal::Nothing => false,
        }
    }
}
