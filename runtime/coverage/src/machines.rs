//! One test's coverage of the system's state machines: which of their states were entered, and which transitions taken.

use std::collections::{BTreeMap, BTreeSet};

use hrdsl_trace::{MachineDeclaration, MachineEdge, MachineStep};

/// So many states, and so many transitions, of a machine are looked at: more is no state machine any more.
const MOST: usize = 10_000;

/// A state machine in one test.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MachineHits {
    /// What it consists of. What it entered or took without having declared it is a part of it, too.
    pub declared: MachineDeclaration,
    pub entered: BTreeSet<String>,
    pub taken: BTreeSet<MachineEdge>,
}

/// Watches the state machines of one trace.
#[derive(Clone, Debug, Default)]
pub struct MachineCollector {
    /// In the order in which they were first heard of.
    machines: Vec<MachineHits>,
    places: BTreeMap<String, MachinePlaces>,
}

/// What is known of a machine already.
#[derive(Clone, Debug, Default)]
struct MachinePlaces {
    at: usize,
    states: BTreeSet<String>,
    edges: BTreeSet<MachineEdge>,
    outcomes: BTreeSet<String>,
}

impl MachineCollector {
    /// A step of a machine.
    pub fn step(&mut self, step: &MachineStep) {
        match step {
            MachineStep::Declared(MachineDeclaration { machine, states, transitions, outcomes }) => {
                let Some((hits, known)) = self.machine(machine) else { return };
                for outcome in outcomes {
                    if known.outcomes.len() < MOST && known.outcomes.insert(outcome.clone()) {
                        hits.declared.outcomes.push(outcome.clone());
                    }
                }
                states.iter().for_each(|state| has_state(hits, known, state));
                transitions.iter().for_each(|edge| has_edge(hits, known, edge));
            }
            MachineStep::Begun { machine, state } => {
                let Some((hits, known)) = self.machine(machine) else { return };
                enter(hits, known, state);
            }
            MachineStep::Moved { machine, edge } => {
                let Some((hits, known)) = self.machine(machine) else { return };
                // Whoever leaves a state was in it.
                enter(hits, known, &edge.from);
                if known.states.contains(&edge.to) || !known.outcomes.contains(&edge.to) {
                    enter(hits, known, &edge.to);
                }
                has_edge(hits, known, edge);
                if known.edges.contains(edge) {
                    hits.taken.insert(edge.clone());
                }
            }
        }
    }

    fn machine(&mut self, name: &str) -> Option<(&mut MachineHits, &mut MachinePlaces)> {
        if !self.places.contains_key(name) {
            if self.machines.len() >= MOST {
                return None;
            }
            let places = MachinePlaces { at: self.machines.len(), ..MachinePlaces::default() };
            self.places.insert(name.to_owned(), places);
            let declared = MachineDeclaration { machine: name.to_owned(), ..MachineDeclaration::default() };
            self.machines.push(MachineHits { declared, ..MachineHits::default() });
        }
        let places = self.places.get_mut(name)?;
        Some((self.machines.get_mut(places.at)?, places))
    }

    /// The machines, in the order in which they were first heard of.
    #[must_use]
    pub fn finish(self) -> Vec<MachineHits> {
        self.machines
    }
}

fn has_state(hits: &mut MachineHits, known: &mut MachinePlaces, state: &str) {
    if known.states.len() < MOST && known.states.insert(state.to_owned()) {
        hits.declared.states.push(state.to_owned());
    }
}

fn has_edge(hits: &mut MachineHits, known: &mut MachinePlaces, edge: &MachineEdge) {
    if known.edges.len() < MOST && known.edges.insert(edge.clone()) {
        hits.declared.transitions.push(edge.clone());
    }
}

fn enter(hits: &mut MachineHits, known: &mut MachinePlaces, state: &str) {
    has_state(hits, known, state);
    if known.states.contains(state) {
        hits.entered.insert(state.to_owned());
    }
}
