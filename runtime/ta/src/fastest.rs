//! Fastest witnesses: a run to a goal that ends as early as any.
//!
//! A best-first search of the zone graph with one more clock, which is never set and so tells how much time has passed. The
//! node with the least time that is possible goes first; no transition makes it less, so the first goal that is taken off is
//! met as early as any. Of the additional clock only lower bounds are kept: who comes later can do no more. They are vectors
//! of whole numbers that only matter where they are less, so that there are finitely many (Dickson's lemma), whether the goal
//! is reached or not.

use std::{cmp::Reverse, collections::BinaryHeap, rc::Rc};

use rustc_hash::FxHashMap;

use crate::{
    Budget, Error, Goal, GoalKind, Model, StateFormula, Timing, Witness,
    dbm::Dbm,
    graph::{Action, Detail, Graph, Stay},
    witness::{Ending, concrete, reach_goal, takes},
};

/// A time: units, and whether it must be exceeded.
type Cost = (i64, bool);

struct Node {
    state: Rc<[i64]>,
    zone: Dbm,
    parent: Option<usize>,
    choice: u32,
}

/// Something to look at: a node to go on from, or one at which the goal is met.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Turn {
    Met(usize),
    Open(usize),
}

struct Race<'g, 'm, 'p> {
    graph: Graph<'m, 'p>,
    goal: &'g Goal,
    formula: Option<StateFormula>,
    nodes: Vec<Node>,
    of: FxHashMap<Rc<[i64]>, Vec<usize>>,
    queue: BinaryHeap<Reverse<(Cost, Turn)>>,
    bytes: usize,
}

/// A run that meets the goal as early as any; `None`: the goal cannot be met, or the budget is used up first.
///
/// # Errors
/// If the model is at fault, or the engine contradicts itself.
pub fn fastest(
    model: &Model,
    goal: &Goal,
    budget: Budget,
    timing: Timing,
) -> Result<Option<Box<Witness>>, Error> {
    let formula = match &goal.what {
        GoalKind::Edge { .. } => None,
        GoalKind::Location { automaton, location } => {
            Some(StateFormula::At { automaton: *automaton, location: *location })
        }
        GoalKind::Condition(f) => Some(f.clone()),
    };
    let timed: Vec<&StateFormula> = formula.iter().collect();
    let graph = Graph::new(model, Detail::Reach, &timed, 1)?;
    let mut race = Race {
        graph,
        goal,
        formula: formula.clone(),
        nodes: Vec::new(),
        of: FxHashMap::default(),
        queue: BinaryHeap::new(),
        bytes: 0,
    };
    let Some(choices) = race.run(budget)? else { return Ok(None) };
    let own = Graph::new(model, Detail::Tell, &[], 0)?;
    let timing = Timing { prompt: true, ..timing };
    let stops = takes(&choices);
    let witness = match formula {
        Some(f) if f.is_timed() => reach_goal(&own, stops, &f, goal, timing)?,
        Some(_) | None => concrete(&own, &stops, Ending::Reached, Some(goal), timing)?,
    };
    Ok(Some(Box::new(witness)))
}

impl Race<'_, '_, '_> {
    fn run(&mut self, budget: Budget) -> Result<Option<Vec<u32>>, Error> {
        let (state, stay, zone) = self.graph.start()?;
        self.insert(state.into(), &stay, zone, None, 0, false)?;
        while let Some(Reverse((_, turn))) = self.queue.pop() {
            if self.nodes.len() >= budget.states || self.bytes >= budget.bytes {
                return Ok(None);
            }
            match turn {
                Turn::Met(at) => return Ok(Some(self.path(at))),
                Turn::Open(at) => self.expand(at)?,
            }
        }
        Ok(None)
    }

    fn expand(&mut self, at: usize) -> Result<(), Error> {
        let (state, zone) = (self.nodes[at].state.clone(), self.nodes[at].zone.clone());
        for (choice, action) in (0u32..).zip(self.graph.actions(&state)) {
            let mut next = zone.clone();
            if !action.guard.iter().all(|c| crate::federation::keep(&mut next, *c)) {
                continue;
            }
            let target = match &action.target {
                Ok(target) => target,
                Err(e) => return Err(Error::Model { error: (**e).clone(), witness: None }),
            };
            let Some(there) = self.graph.stay(target)? else { continue };
            if self.graph.take(&action, &there, &mut next) {
                let met = self.takes_goal(&action);
                self.insert(target.as_slice().into(), &there, next, Some(at), choice, met)?;
            }
        }
        Ok(())
    }

    fn takes_goal(&self, action: &Action) -> bool {
        match &self.goal.what {
            GoalKind::Edge { automaton, edge } => {
                action.moves.iter().any(|m| m.automaton == *automaton && m.edge == *edge)
            }
            GoalKind::Location { .. } | GoalKind::Condition(_) => false,
        }
    }

    fn insert(
        &mut self,
        state: Rc<[i64]>,
        stay: &Stay,
        mut zone: Dbm,
        parent: Option<usize>,
        choice: u32,
        met: bool,
    ) -> Result<(), Error> {
        self.graph.wait(stay, &mut zone);
        let mut pieces = Vec::new();
        self.graph.widen(&state, zone, &mut |piece| pieces.push(piece));
        for zone in pieces {
            let at = self.nodes.len();
            let known = self.of.entry(state.clone()).or_default();
            let covered = known.iter().any(|&n| self.nodes[n].zone.includes(&zone));
            if covered && !met {
                continue;
            }
            if !covered {
                known.push(at);
            }
            let cost = self.cost(&zone);
            self.bytes += zone.heap_bytes() + size_of_val(&*state) + size_of::<Node>();
            let goal = if met { Some(cost) } else { self.goal_cost(&state, &zone)? };
            self.nodes.push(Node { state: state.clone(), zone, parent, choice });
            if let Some(cost) = goal {
                self.queue.push(Reverse((cost, Turn::Met(at))));
            }
            if !covered {
                self.queue.push(Reverse((cost, Turn::Open(at))));
            }
        }
        Ok(())
    }

    /// The least time of a zone.
    fn cost(&self, zone: &Dbm) -> Cost {
        let b = zone.at(0, self.graph.dim() - 1);
        (-b.value(), b.is_strict())
    }

    fn goal_cost(&self, state: &[i64], zone: &Dbm) -> Result<Option<Cost>, Error> {
        let Some(formula) = &self.formula else { return Ok(None) };
        if self.goal.settled && self.graph.model.any_committed(state) {
            return Ok(None);
        }
        let here = self.graph.here(state);
        let parts = formula.part(&here, zone)?;
        Ok(parts.zones().iter().map(|z| self.cost(z)).min())
    }

    fn path(&self, mut at: usize) -> Vec<u32> {
        let mut choices = Vec::new();
        while let Some(parent) = self.nodes[at].parent {
            choices.push(self.nodes[at].choice);
            at = parent;
        }
        choices.reverse();
        choices
    }
}
