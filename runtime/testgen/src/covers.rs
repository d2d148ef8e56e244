//! Which goals of a suite by search a witness reaches besides its own: what is covered needs no test of its own.

use std::collections::BTreeSet;

use hrdsl_ir::{
    Program, Value,
    coverage::BinName,
    ta::{LocationId, Network, QueryFormula, located_automaton},
};
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
    states: Vec<RunState>,
}

/// Where a run was: the automata's locations and the values of the network's slots.
#[derive(Clone)]
struct RunState {
    locations: Vec<LocationId>,
    values: Vec<Option<Value>>,
}

/// A goal of which a run shows by itself whether it reaches it.
#[derive(Clone, Debug, PartialEq)]
pub enum WitnessedGoal {
    Location(usize, LocationId),
    Edge(usize, usize),
    Pair(usize, usize, usize),
    Bin(BinName),
    Violation(usize),
    Trigger(usize),
    /// A state in which this holds. Over clocks only the search knows.
    State(Box<QueryFormula>),
    /// Only the search knows.
    Nothing,
}

impl ReachedItems {
    /// `network`: the one that was asked about. The run may be one of it with observers behind its automata.
    #[must_use]
    pub fn of(program: &Program, network: &Network, witness: &WitnessRun, bins: Vec<BinName>) -> Self {
        let start = RunState::first(program, network);
        let initial = start.locations.clone();
        let mut seen = Self {
            locations: initial.iter().copied().enumerate().collect(),
            edges: BTreeSet::new(),
            pairs: BTreeSet::new(),
            bins,
            violated: Vec::new(),
            triggered: Vec::new(),
            states: vec![start.clone()],
        };
        let mut state = start;
        let mut last: Vec<Option<usize>> = vec![None; initial.len()];
        for step in &witness.steps {
            seen.locations.extend(step.locations.iter().map(|(a, _, to)| (*a, *to)));
            state.locations.iter_mut().enumerate().for_each(|(at, location)| {
                let moved = step.locations.iter().find(|(a, ..)| *a == at);
                *location = moved.map_or(*location, |(_, _, to)| *to);
            });
            for (slot, _, to) in &step.variables {
                state.values.get_mut(*slot).into_iter().for_each(|value| *value = Some(*to));
            }
            seen.states.push(state.clone());
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
            WitnessedGoal::State(formula) => {
                self.states.iter().any(|state| state.meets(formula) == Some(true))
            }
            WitnessedGoal::Nothing => false,
        }
    }

    /// Along which edges the run went.
    pub fn flow(&self) -> RunFlow<'_> {
        RunFlow { edges: &self.edges, pairs: &self.pairs }
    }
}

/// The edges that a run took.
pub struct RunFlow<'a> {
    /// Automaton, edge.
    pub edges: &'a BTreeSet<(usize, usize)>,
    /// Those one after the other: automaton, edge, edge.
    pub pairs: &'a BTreeSet<(usize, usize, usize)>,
}

impl RunState {
    fn first(program: &Program, network: &Network) -> Self {
        let members = || network.automata.iter().map(|id| program.automaton(*id));
        let vars = program.shared.iter().chain(members().flat_map(|a| &a.vars));
        Self {
            locations: members().map(|a| a.initial).collect(),
            values: vars.map(|var| var.value(var.init)).collect(),
        }
    }

    /// `None`: it depends on clocks, or has no value.
    fn meets(&self, formula: &QueryFormula) -> Option<bool> {
        Some(match formula {
            QueryFormula::At { automaton, location } => {
                self.locations.get(usize::from(*automaton))? == location
            }
            QueryFormula::Data(condition) => {
                let value = condition.eval(&|variable| self.value(variable)).ok()?;
                value == Value::Bool(true)
            }
            QueryFormula::Not(f) => !self.meets(f)?,
            QueryFormula::And(fs) => fs.iter().try_fold(true, |all, f| Some(self.meets(f)? && all))?,
            QueryFormula::Or(fs) => fs.iter().try_fold(false, |any, f| Some(self.meets(f)? || any))?,
            QueryFormula::Clock(_) | QueryFormula::Deadlock => return None,
        })
    }

    fn value(&self, variable: u16) -> Option<Value> {
        match located_automaton(variable, self.locations.len()) {
            Some(automaton) => {
                let location = self.locations.get(usize::from(automaton))?;
                Some(Value::Int(i64::from(location.0)))
            }
            None => self.values.get(usize::from(variable)).copied().flatten(),
        }
    }
}
