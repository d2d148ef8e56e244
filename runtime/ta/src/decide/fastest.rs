//! Fastest witnesses: a run to a goal that ends as early as any; and shortest ones, with as few transitions as any.
//!
//! A best-first search of the zone graph with one more clock, which is never set and so tells how much time has passed. The
//! node with the least time that is possible goes first; no transition makes it less, so the first goal that is taken off is
//! met as early as any. Of the additional clock only lower bounds are kept: who comes later can do no more. They are vectors
//! of whole numbers that only matter where they are less, so that there are finitely many (Dickson's lemma), whether the goal
//! is reached or not.

use std::{cmp::Reverse, collections::BinaryHeap, rc::Rc};

use rustc_hash::FxHashMap;

use crate::{
    network::{
        actions::{DelayCondition, EnabledTransition, PathTransition},
        error::ModelError,
        graph::{ZoneDetail, ZoneGraph},
        model::CompiledNetwork,
        query::{GoalKind, ReachabilityGoal, SearchBudget, StateFormula},
        semantics::CompiledMove,
    },
    witness::{
        build::{concrete, fault_after, reach_goal, takes},
        error::SearchError,
        run::{RunEnding, WitnessRun},
        schedule::ScheduleOptions,
    },
    zone::dbm::Dbm,
};

/// A time: units, and whether it must be exceeded.
type TimeLowerBound = (i64, bool);

struct FastestNode {
    state: Rc<[i64]>,
    zone: Dbm,
    steps: i64,
    parent: Option<(usize, Rc<PathTransition>)>,
}

/// Something to look at: a node to go on from, or one at which the goal is met.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum FastestQueueEntry {
    Met(usize),
    Open(usize),
}

struct FastestSearch<'g, 'm, 'p> {
    graph: ZoneGraph<'m, 'p>,
    goal: &'g ReachabilityGoal,
    aim: FastestObjective,
    formula: Option<StateFormula>,
    nodes: Vec<FastestNode>,
    of: FxHashMap<Rc<[i64]>, Vec<usize>>,
    queue: BinaryHeap<Reverse<(TimeLowerBound, FastestQueueEntry)>>,
    bytes: usize,
}

/// A run that meets the goal (no pair or use) as early as any; the model must have observed the goal's formula. `None`: the goal cannot be met, or the budget is used up first.
///
/// # Errors
/// If the model is at fault, or the engine contradicts itself.
pub fn fastest(
    model: &CompiledNetwork,
    goal: &ReachabilityGoal,
    budget: SearchBudget,
    timing: ScheduleOptions,
) -> Result<Option<Box<WitnessRun>>, SearchError> {
    if matches!(goal.what, GoalKind::Pair { .. } | GoalKind::Use { .. }) {
        let what = "edge pairs and def-use pairs are not looked for by time";
        return Err(ModelError::Question(what.into()).into());
    }
    let formula = goal.formula();
    run(model, goal, formula, FastestObjective::Time, budget, timing)
}

/// A run that meets the goal with as few transitions as any; `None`: as for [`fastest`].
///
/// A breadth-first search that drives states out where others cover them may come upon a longer run first.
///
/// # Errors
/// If the model is at fault, or the engine contradicts itself.
pub fn shortest(
    model: &CompiledNetwork,
    goal: &ReachabilityGoal,
    budget: SearchBudget,
    timing: ScheduleOptions,
) -> Result<Option<Box<WitnessRun>>, SearchError> {
    match goal.what {
        GoalKind::Pair { .. } | GoalKind::Use { .. } => Ok(None),
        GoalKind::Edge { .. } | GoalKind::Location { .. } | GoalKind::Condition(_) | GoalKind::Formula(_) => {
            run(model, goal, goal.formula(), FastestObjective::Steps, budget, timing)
        }
    }
}

/// What is to be little.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FastestObjective {
    Time,
    Steps,
}

fn run(
    model: &CompiledNetwork,
    goal: &ReachabilityGoal,
    formula: Option<StateFormula>,
    aim: FastestObjective,
    budget: SearchBudget,
    timing: ScheduleOptions,
) -> Result<Option<Box<WitnessRun>>, SearchError> {
    let timed: Vec<&StateFormula> = formula.iter().collect();
    let graph = ZoneGraph::new(model, ZoneDetail::Reach, &timed, usize::from(aim == FastestObjective::Time))?;
    let mut race = FastestSearch {
        graph,
        goal,
        aim,
        formula: formula.clone(),
        nodes: Vec::new(),
        of: FxHashMap::default(),
        queue: BinaryHeap::new(),
        bytes: 0,
    };
    let Some(path) = race.run(budget)? else { return Ok(None) };
    let own = ZoneGraph::new(model, ZoneDetail::Tell, &[], 0)?;
    let timing = ScheduleOptions { prompt: timing.prompt || aim == FastestObjective::Time, ..timing };
    let stops = takes(path);
    let witness = match formula {
        Some(f) if f.is_timed() => reach_goal(&own, stops, &f, goal, timing)?,
        Some(_) | None => concrete(&own, &stops, RunEnding::Reached, Some(goal), timing)?,
    };
    Ok(Some(Box::new(witness)))
}

impl FastestSearch<'_, '_, '_> {
    fn run(&mut self, budget: SearchBudget) -> Result<Option<Vec<Rc<PathTransition>>>, SearchError> {
        let (state, stay, zone) = self.graph.start()?;
        self.insert(state.into(), &stay, zone, None, false)?;
        while let Some(Reverse((_, turn))) = self.queue.pop() {
            if self.nodes.len() >= budget.states || self.bytes >= budget.bytes {
                return Ok(None);
            }
            match turn {
                FastestQueueEntry::Met(at) => return Ok(Some(self.path(at))),
                FastestQueueEntry::Open(at) => self.expand(at)?,
            }
        }
        Ok(None)
    }

    fn expand(&mut self, at: usize) -> Result<(), SearchError> {
        let (state, zone) = (self.nodes[at].state.clone(), self.nodes[at].zone.clone());
        for action in self.graph.actions(&state) {
            let followed = self.graph.follow(&action, &zone);
            let followed = followed.map_err(|error| fault_after(self.graph.model, self.path(at), error))?;
            if let Some((target, there, next)) = followed {
                let met = self.takes_goal(&action);
                self.insert(target.into(), &there, next, Some((at, action.taken.clone())), met)?;
            }
        }
        Ok(())
    }

    fn takes_goal(&self, action: &EnabledTransition) -> bool {
        match &self.goal.what {
            GoalKind::Edge { automaton, edge } => {
                let is =
                    |t: &CompiledMove| usize::from(t.member) == *automaton && usize::from(t.edge) == *edge;
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
        stay: &DelayCondition,
        mut zone: Dbm,
        parent: Option<(usize, Rc<PathTransition>)>,
        met: bool,
    ) -> Result<(), SearchError> {
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
            let steps = parent.as_ref().map_or(0, |(p, _)| self.nodes[*p].steps + 1);
            let cost = self.cost(&zone, steps);
            self.bytes += zone.heap_bytes() + size_of_val(&*state) + size_of::<FastestNode>();
            let goal = if met { Some(cost) } else { self.goal_cost(&state, &zone, steps)? };
            self.nodes.push(FastestNode { state: state.clone(), zone, steps, parent: parent.clone() });
            if let Some(cost) = goal {
                self.queue.push(Reverse((cost, FastestQueueEntry::Met(at))));
            }
            if !covered {
                self.queue.push(Reverse((cost, FastestQueueEntry::Open(at))));
            }
        }
        Ok(())
    }

    /// The least time of a zone, or the transitions so far.
    fn cost(&self, zone: &Dbm, steps: i64) -> TimeLowerBound {
        if self.aim == FastestObjective::Steps {
            return (steps, false);
        }
        let b = zone.at(0, self.graph.dim() - 1);
        (-b.value(), b.is_strict())
    }

    fn goal_cost(
        &self,
        state: &[i64],
        zone: &Dbm,
        steps: i64,
    ) -> Result<Option<TimeLowerBound>, SearchError> {
        let Some(formula) = &self.formula else { return Ok(None) };
        if self.goal.settled && self.graph.model.any_committed(state) {
            return Ok(None);
        }
        let here = self.graph.here(state);
        let parts = formula.part(&here, zone)?;
        Ok(parts.zones().iter().map(|z| self.cost(z, steps)).min())
    }

    fn path(&self, mut at: usize) -> Vec<Rc<PathTransition>> {
        let mut path = Vec::new();
        while let Some((parent, taken)) = &self.nodes[at].parent {
            path.push(taken.clone());
            at = *parent;
        }
        path.reverse();
        path
    }
}
