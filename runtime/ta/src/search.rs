//! Breadth-first search of the zone graph for many goals at once, with one list of passed and waiting states.
//!
//! A symbolic state is stored unless one of the same discrete part includes its zone, and it drives out those whose zones
//! it includes: of these only the way to them is kept, for witnesses. When nothing waits any more, a goal that was not met
//! is proved unreachable.

use std::{collections::VecDeque, rc::Rc};

use hrdsl_ir::{
    Program, Value,
    expr::EvalError,
    ta::{LocationId, Network},
};
use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use crate::{
    Budget, Counter, Error, Goal, GoalKind, Limit, Model, ModelError, StateFormula, Witness,
    dbm::Dbm,
    query::View,
    semantics::{Candidate, Move},
    witness, zone,
};

/// How a goal ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// The witness was replayed under concrete clocks.
    Reached(Box<Witness>),
    /// All that can be reached was seen.
    Unreachable,
    /// The budget was used up first.
    Open(Exhausted),
}

/// Which part of the budget was used up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exhausted {
    States,
    Memory,
}

/// What a search found.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// One for each goal, in the order of the question.
    pub goals: Vec<Outcome>,
    /// Symbolic states kept at the end.
    pub states_stored: usize,
    /// Symbolic states whose successors were computed.
    pub states_visited: usize,
    /// Discrete states.
    pub discrete_states: usize,
    /// Symbolic transitions computed.
    pub transitions: usize,
    /// Nothing was left to explore. Without goals a search goes on to this end or to that of its budget.
    pub complete: bool,
}

/// Compiles a network and searches it.
///
/// # Errors
/// If the model is malformed, or a fault of it is met, or the engine contradicts itself.
pub fn check(
    program: &Program,
    network: &Network,
    goals: &[Goal],
    counters: &[Counter],
    limits: &[Limit],
    budget: Budget,
) -> Result<Report, Error> {
    let model = Model::new(program, network, counters, limits)?;
    explore(&model, goals, budget)
}

/// Searches a compiled network. It ends when each goal is met, all is explored, or the budget is used up.
///
/// A fault of the model is met only if it comes before that end.
///
/// # Errors
/// If a fault of the model is met, or the engine contradicts itself.
pub fn explore(model: &Model, goals: &[Goal], budget: Budget) -> Result<Report, Error> {
    let mut search = Search::new(model, goals)?;
    let exhausted = search.run(budget)?;
    let mut outcomes = Vec::new();
    for (goal, hit) in goals.iter().zip(&search.hits) {
        outcomes.push(match (hit, exhausted) {
            (Some(path), _) => Outcome::Reached(Box::new(search.witness(path, Some(goal))?)),
            (None, Some(what)) => Outcome::Open(what),
            (None, None) => Outcome::Unreachable,
        });
    }
    Ok(Report {
        goals: outcomes,
        states_stored: search.stored,
        states_visited: search.visited,
        discrete_states: search.discrete.len(),
        transitions: search.transitions,
        complete: exhausted.is_none() && search.waiting.is_empty(),
    })
}

const ROOT: u32 = u32::MAX;

/// A symbolic state.
struct Node {
    discrete: u32,
    parent: u32,
    /// Which of the parent's candidates led here.
    choice: u32,
    /// `None`: a greater one of the same discrete state drove it out.
    zone: Option<Dbm>,
}

/// A way to a goal: a node, then perhaps one candidate more. The root of no node is the initial state.
#[derive(Clone, Copy)]
struct Path {
    node: u32,
    last: Option<u32>,
}

struct Discrete {
    packed: Rc<[u64]>,
    nodes: SmallVec<[u32; 2]>,
}

struct Search<'m, 'p> {
    model: &'m Model<'p>,
    goals: &'m [Goal],
    hits: Vec<Option<Path>>,
    open: usize,
    nodes: Vec<Node>,
    discrete: Vec<Discrete>,
    numbers: FxHashMap<Rc<[u64]>, u32>,
    waiting: VecDeque<u32>,
    packed: Vec<u64>,
    bytes: usize,
    stored: usize,
    visited: usize,
    transitions: usize,
    /// Which goals are edges: they are looked at for each transition, the others for each discrete state.
    edge_goals: FxHashMap<(usize, usize), Vec<usize>>,
    state_goals: Vec<usize>,
}

impl<'m, 'p> Search<'m, 'p> {
    fn new(model: &'m Model<'p>, goals: &'m [Goal]) -> Result<Self, Error> {
        let mut edge_goals: FxHashMap<(usize, usize), Vec<usize>> = FxHashMap::default();
        let mut state_goals = Vec::new();
        for (i, goal) in goals.iter().enumerate() {
            model.check_goal(goal)?;
            match &goal.what {
                GoalKind::Edge { automaton, edge } => {
                    edge_goals.entry((*automaton, *edge)).or_default().push(i);
                }
                GoalKind::Location { .. } | GoalKind::Condition(_) => state_goals.push(i),
            }
        }
        Ok(Self {
            model,
            goals,
            hits: vec![None; goals.len()],
            open: goals.len(),
            nodes: Vec::new(),
            discrete: Vec::new(),
            numbers: FxHashMap::default(),
            waiting: VecDeque::new(),
            packed: Vec::new(),
            bytes: 0,
            stored: 0,
            visited: 0,
            transitions: 0,
            edge_goals,
            state_goals,
        })
    }

    fn run(&mut self, budget: Budget) -> Result<Option<Exhausted>, Error> {
        let mut scratch = Dbm::zero(self.model.dim);
        let mut state = self.model.initial();
        if !zone::initial(self.model, &state, &mut scratch) {
            return Err(ModelError::Initial.into());
        }
        self.insert(&state, &mut scratch, ROOT, 0)?;
        while let Some(id) = self.waiting.pop_front() {
            if !self.goals.is_empty() && self.open == 0 {
                // So that the report does not claim to be complete.
                self.waiting.push_front(id);
                return Ok(None);
            }
            let used_up = if self.nodes.len() >= budget.states.min(ROOT as usize) {
                Some(Exhausted::States)
            } else {
                (self.bytes >= budget.bytes).then_some(Exhausted::Memory)
            };
            let node = &self.nodes[id as usize];
            let Some(zone) = node.zone.clone() else { continue };
            if used_up.is_some() {
                return Ok(used_up);
            }
            self.model.unpack(&self.discrete[node.discrete as usize].packed, &mut state);
            self.visited += 1;
            self.expand(id, &state, &zone, &mut scratch)?;
        }
        Ok(None)
    }

    fn expand(&mut self, id: u32, state: &[i64], zone: &Dbm, scratch: &mut Dbm) -> Result<(), Error> {
        let model = self.model;
        for (choice, candidate) in (0..).zip(model.candidates(state)) {
            if !zone::may_pass(zone, &candidate) {
                continue;
            }
            scratch.copy_from(zone);
            if !zone::guard(scratch, &candidate) {
                continue;
            }
            let target = match &candidate.target {
                Ok(target) => target,
                Err(error) => return Err(self.fault(id, error)),
            };
            if !zone::advance(model, &candidate.resets, target, scratch) {
                continue;
            }
            self.transitions += 1;
            self.edges_taken(id, choice, &candidate);
            self.insert(target, scratch, id, choice)?;
        }
        Ok(())
    }

    fn fault(&self, id: u32, error: &ModelError) -> Error {
        match self.witness(&Path { node: id, last: None }, None) {
            Ok(witness) => Error::Model { error: error.clone(), witness: Some(Box::new(witness)) },
            Err(internal) => internal,
        }
    }

    /// Extrapolates and stores a symbolic state, unless it is included in a stored one.
    fn insert(&mut self, state: &[i64], zone: &mut Dbm, parent: u32, choice: u32) -> Result<(), Error> {
        let model = self.model;
        model.pack(state, &mut self.packed);
        let (discrete, new) = match self.numbers.get(self.packed.as_slice()) {
            Some(&n) => (n, false),
            None => (self.number(), true),
        };
        let first = self.nodes.len();
        model.extrapolation.apply(&state[..model.members.len()], zone, &mut |piece| {
            let known = &mut self.discrete[discrete as usize].nodes;
            let covered = known
                .iter()
                .any(|&n| self.nodes[n as usize].zone.as_ref().is_some_and(|old| old.includes(piece)));
            if covered {
                return;
            }
            known.retain(|n| {
                let old = &mut self.nodes[*n as usize].zone;
                let keep = old.as_ref().is_some_and(|old| !piece.includes(old));
                if !keep && let Some(gone) = old.take() {
                    self.stored -= 1;
                    self.bytes -= gone.heap_bytes();
                }
                keep
            });
            // INVARIANT: the budget keeps the number of nodes below the root's mark.
            let id = self.nodes.len() as u32;
            known.push(id);
            self.bytes += piece.heap_bytes() + size_of::<Node>() + size_of::<u32>();
            self.stored += 1;
            self.nodes.push(Node { discrete, parent, choice, zone: Some(piece.clone()) });
            self.waiting.push_back(id);
        });
        if new && self.nodes.len() > first {
            self.state_reached(state, first as u32)?;
        }
        Ok(())
    }

    /// Gives the packed state its number.
    fn number(&mut self) -> u32 {
        let n = self.discrete.len() as u32;
        let packed: Rc<[u64]> = Rc::from(self.packed.as_slice());
        self.bytes += size_of_val(&*packed) + 2 * size_of::<Discrete>();
        self.numbers.insert(packed.clone(), n);
        self.discrete.push(Discrete { packed, nodes: SmallVec::new() });
        n
    }

    fn edges_taken(&mut self, node: u32, choice: u32, candidate: &Candidate) {
        if self.edge_goals.is_empty() {
            return;
        }
        for Move { automaton, edge, .. } in &candidate.moves {
            for goal in self.edge_goals.remove(&(*automaton, *edge)).unwrap_or_default() {
                self.hits[goal] = Some(Path { node, last: Some(choice) });
                self.open -= 1;
            }
        }
    }

    fn state_reached(&mut self, state: &[i64], node: u32) -> Result<(), Error> {
        let settled = !self.model.any_committed(state);
        let view = StateView { model: self.model, state };
        let mut left = Vec::with_capacity(self.state_goals.len());
        for &i in &self.state_goals {
            let goal = &self.goals[i];
            let holds = (settled || !goal.settled)
                && goal_holds(goal, &view)
                    .map_err(|e| ModelError::Question(format!("goal {i} has no value: {e}")))?;
            if holds {
                self.hits[i] = Some(Path { node, last: None });
                self.open -= 1;
            } else {
                left.push(i);
            }
        }
        self.state_goals = left;
        Ok(())
    }

    fn witness(&self, path: &Path, goal: Option<&Goal>) -> Result<Witness, Error> {
        let mut choices: Vec<u32> = path.last.into_iter().collect();
        let mut at = path.node;
        while self.nodes[at as usize].parent != ROOT {
            choices.push(self.nodes[at as usize].choice);
            at = self.nodes[at as usize].parent;
        }
        choices.reverse();
        witness::build(self.model, &choices, goal, crate::Timing::default())
    }
}

/// Whether a state meets a goal; of edges it cannot tell.
pub(crate) fn goal_holds(goal: &Goal, view: &dyn View) -> Result<bool, EvalError> {
    match &goal.what {
        GoalKind::Edge { .. } => Ok(false),
        GoalKind::Location { automaton, location } => {
            StateFormula::At { automaton: *automaton, location: *location }.holds(view)
        }
        GoalKind::Condition(f) => f.holds(view),
    }
}

struct StateView<'a, 'p> {
    model: &'a Model<'p>,
    state: &'a [i64],
}

impl View for StateView<'_, '_> {
    fn location(&self, automaton: usize) -> Option<LocationId> {
        self.model.members.get(automaton)?;
        u16::try_from(self.state[automaton]).ok().map(LocationId)
    }

    fn slot(&self, slot: u16) -> Option<Value> {
        let slot = usize::from(slot);
        if slot < self.model.slots.len() { self.model.slot_value(self.state, slot) } else { None }
    }

    fn counter(&self, counter: usize) -> i64 {
        self.state[self.model.counter_at(counter)]
    }
}
