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
    Budget, Error, Goal, GoalKind, Model, ModelError, StateFormula, Timing, Witness,
    dbm::Dbm,
    expand::Taken,
    graph::{Action, Detail, Graph, Stay},
    semantics::Take,
    witness::{Ending, concrete, reach_goal, takes},
};

/// A time: units, and whether it must be exceeded.
type Cost = (i64, bool);

struct Node {
    state: Rc<[i64]>,
    zone: Dbm,
    parent: Option<(usize, Rc<Taken>)>,
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

/// A run that meets the goal (no pair or use) as early as any; the model must have observed the goal's formula. `None`: the goal cannot be met, or the budget is used up first.
///
/// # Errors
/// If the model is at fault, or the engine contradicts itself.
pub fn fastest(
    model: &Model,
    goal: &Goal,
    budget: Budget,
    timing: Timing,
) -> Result<Option<Box<Witness>>, Error> {
    if matches!(goal.what, GoalKind::Pair { .. } | GoalKind::Use { .. }) {
        let what = "a pair of edges is not looked for by time";
        return Err(ModelError::Question(what.into()).into());
    }
    let formula = goal.formula();
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
    let Some(path) = race.run(budget)? else { return Ok(None) };
    let own = Graph::new(model, Detail::Tell, &[], 0)?;
    let timing = Timing { prompt: true, ..timing };
    let stops = takes(path);
    let witness = match formula {
        Some(f) if f.is_timed() => reach_goal(&own, stops, &f, goal, timing)?,
        Some(_) | None => concrete(&own, &stops, Ending::Reached, Some(goal), timing)?,
    };
    Ok(Some(Box::new(witness)))
}

impl Race<'_, '_, '_> {
    fn run(&mut self, budget: Budget) -> Result<Option<Vec<Rc<Taken>>>, Error> {
        let (state, stay, zone) = self.graph.start()?;
        self.insert(state.into(), &stay, zone, None, false)?;
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
        for action in self.graph.actions(&state) {
            let followed = self.graph.follow(&action, &zone);
            let followed = followed.map_err(|error| Error::Model { error, witness: None })?;
            if let Some((target, there, next)) = followed {
                let met = self.takes_goal(&action);
                self.insert(target.into(), &there, next, Some((at, action.taken.clone())), met)?;
            }
        }
        Ok(())
    }

    fn takes_goal(&self, action: &Action) -> bool {
        match &self.goal.what {
            GoalKind::Edge { automaton, edge } => {
                let is = |t: &Take| usize::from(t.member) == *automaton && usize::from(t.edge) == *edge;
                action.taken.parts.iter().any(is)
            }
            GoalKind::Pair { .. }
            | GoalKind::Use { .. }
            | GoalKind::Location { .. }
            | GoalKind::Condition(_)
            | GoalKind::Formula(_) => false,
        }
    }

    fn insert(
        &mut self,
        state: Rc<[i64]>,
        stay: &Stay,
        mut zone: Dbm,
        parent: Option<(usize, Rc<Taken>)>,
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
            self.nodes.push(Node { state: state.clone(), zone, parent: parent.clone() });
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

    fn path(&self, mut at: usize) -> Vec<Rc<Taken>> {
        let mut path = Vec::new();
        while let Some((parent, taken)) = &self.nodes[at].parent {
            path.push(taken.clone());
            at = *parent;
        }
        path.reverse();
        path
    }
}
