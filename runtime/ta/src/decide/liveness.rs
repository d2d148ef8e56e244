//! Liveness: whether there is a maximal run on which a formula never holds.
//!
//! A depth-first search of the zone graph, of the part where the formula does not hold, with an abstraction that is a
//! bisimulation (ExtraM+). A run that never meets the formula goes round for ever, ends where nothing more can happen, or
//! waits for ever:
//!
//! - a *loop* is a node whose zone includes that of an earlier node on the search's path with the same discrete state: each
//!   valuation of the later zone comes from one of the earlier, so going back round and round never ends, and as there are
//!   finitely many classes of valuations there is a run that goes forward for ever. Inclusion the other way round proves
//!   nothing (Laarman, Olesen, Dalsgaard, Larsen, van de Pol, "Multi-Core Emptiness Checking of Timed Büchi Automata using
//!   Inclusion Abstraction", CAV 2013), but a node that a finished one includes needs no second look;
//! - a run *ends* at a valuation from which no transition is possible, now or after any delay, and time cannot pass into a
//!   cell where the formula holds;
//! - a run *waits* for ever where no invariant bounds time.
//!
//! A loop in which time does not pass beyond some bound (a Zeno run) counts as an infinite run, as it does in UPPAAL.
//!
//! Formulas with clocks: zones are split into [cells](crate::decide::cells), and time passes from cell to cell.

use std::rc::Rc;

use rustc_hash::FxHashMap;

use crate::{
    decide::cells::{CellCuts, ClockCell, within},
    network::{
        actions::{DelayCondition, EnabledTransition},
        error::ModelError,
        graph::ZoneGraph,
        query::{SearchBudget, StateFormula},
    },
    search::report::SearchCutoff,
    witness::{
        build::{PathSegment, bounds_of, fault},
        error::SearchError,
        run::RunEnding,
    },
    zone::{
        constraint::{DifferenceConstraint, keep},
        dbm::Dbm,
        federation::{Federation, past},
    },
};

/// A maximal run, or the beginning of one.
#[derive(Debug)]
pub(crate) struct MaximalRun {
    pub stops: Vec<PathSegment>,
    pub ending: RunEnding,
    /// For a loop: the stops before it.
    pub from: usize,
    /// The discrete state at the end.
    pub state: Vec<i64>,
}

/// What a search found.
#[derive(Debug)]
pub(crate) enum MaximalRunSearchResult {
    Found(Box<MaximalRun>),
    /// There is none.
    Nothing,
    Inconclusive(SearchCutoff),
}

/// A part of a symbolic state in one cell.
#[derive(Clone)]
struct CellNode {
    state: Rc<[i64]>,
    cell: ClockCell,
    zone: Dbm,
}

type ClockCellKey = (Rc<[i64]>, ClockCell);

/// A node with how it was come to.
struct EnteredNode {
    node: CellNode,
    parent: Option<usize>,
    stop: Option<PathSegment>,
}

/// A node whose successors are gone through.
struct LivenessFrame {
    entered: usize,
    next: Vec<(PathSegment, CellNode)>,
}

/// A search for maximal runs.
pub(crate) struct LivenessSearch<'g, 'm, 'p> {
    graph: &'g ZoneGraph<'m, 'p>,
    /// What cuts zones into cells.
    formulas: Vec<&'g StateFormula>,
    budget: SearchBudget,
    entered: Vec<EnteredNode>,
    /// Nodes from which there is no run that avoids the formula.
    safe: FxHashMap<ClockCellKey, Vec<Dbm>>,
    bytes: usize,
}

/// What is known of the discrete state of a node.
struct DiscreteStateInfo {
    stay: DelayCondition,
    cuts: CellCuts,
    actions: Vec<EnabledTransition>,
}

impl<'g, 'm, 'p> LivenessSearch<'g, 'm, 'p> {
    pub(crate) fn new(
        graph: &'g ZoneGraph<'m, 'p>,
        formulas: &[&'g StateFormula],
        budget: SearchBudget,
    ) -> Self {
        let formulas = formulas.to_vec();
        Self { graph, formulas, budget, entered: Vec::new(), safe: FxHashMap::default(), bytes: 0 }
    }

    /// A maximal run on which `avoid` never holds.
    ///
    /// # Errors
    /// If the model is at fault.
    pub(crate) fn avoiding(&mut self, avoid: &StateFormula) -> Result<MaximalRunSearchResult, SearchError> {
        for node in self.starts()? {
            let at = self.enter(node, None, None);
            match self.search(at, avoid)? {
                MaximalRunSearchResult::Nothing => {}
                found @ (MaximalRunSearchResult::Found(_) | MaximalRunSearchResult::Inconclusive(_)) => {
                    return Ok(found);
                }
            }
        }
        Ok(MaximalRunSearchResult::Nothing)
    }

    /// A run that comes to where `first` holds, and a maximal run from there on which `then` never holds.
    ///
    /// # Errors
    /// If the model is at fault.
    pub(crate) fn after(
        &mut self,
        first: &StateFormula,
        then: &StateFormula,
    ) -> Result<MaximalRunSearchResult, SearchError> {
        let mut seen: FxHashMap<ClockCellKey, Vec<Dbm>> = FxHashMap::default();
        let mut waiting: std::collections::VecDeque<usize> = std::collections::VecDeque::new();
        for node in self.starts()? {
            waiting.push_back(self.enter(node, None, None));
        }
        while let Some(at) = waiting.pop_front() {
            if let Some(what) = self.used_up() {
                return Ok(MaximalRunSearchResult::Inconclusive(what));
            }
            let node = self.entered[at].node.clone();
            let zones = seen.entry((node.state.clone(), node.cell.clone())).or_default();
            if zones.iter().any(|z| z.includes(&node.zone)) {
                continue;
            }
            zones.push(node.zone.clone());
            if self.holds(first, &node)? {
                match self.search(at, then)? {
                    MaximalRunSearchResult::Nothing => {}
                    found @ (MaximalRunSearchResult::Found(_) | MaximalRunSearchResult::Inconclusive(_)) => {
                        return Ok(found);
                    }
                }
            }
            let spot = self.spot(&node.state)?;
            for (stop, next) in self.successors(&node, &spot, at)? {
                waiting.push_back(self.enter(next, Some(at), Some(stop)));
            }
        }
        Ok(MaximalRunSearchResult::Nothing)
    }

    fn used_up(&self) -> Option<SearchCutoff> {
        if self.entered.len() >= self.budget.states {
            return Some(SearchCutoff::States);
        }
        (self.bytes >= self.budget.bytes).then_some(SearchCutoff::Memory)
    }

    fn enter(&mut self, node: CellNode, parent: Option<usize>, stop: Option<PathSegment>) -> usize {
        // The zone is kept twice, once among the finished ones.
        self.bytes += 2 * node.zone.heap_bytes() + size_of_val(&*node.state) + size_of::<EnteredNode>();
        self.entered.push(EnteredNode { node, parent, stop });
        self.entered.len() - 1
    }

    fn spot(&self, state: &[i64]) -> Result<DiscreteStateInfo, ModelError> {
        let stay = self.graph.stay(state)?.ok_or(ModelError::Initial)?;
        let cuts = CellCuts::of(&self.formulas, &self.graph.here(state))?;
        Ok(DiscreteStateInfo { stay, cuts, actions: self.graph.actions(state) })
    }

    fn starts(&self) -> Result<Vec<CellNode>, SearchError> {
        let (state, stay, zone) = self.graph.start()?;
        let state: Rc<[i64]> = state.into();
        let cuts = CellCuts::of(&self.formulas, &self.graph.here(&state))?;
        let mut out = Vec::new();
        self.nodes(&state, &stay, &cuts, &zone, &mut |node| out.push(node));
        Ok(out)
    }

    /// The nodes of a zone right after a transition: its parts in cells, after time has passed within them.
    fn nodes(
        &self,
        state: &Rc<[i64]>,
        stay: &DelayCondition,
        cuts: &CellCuts,
        zone: &Dbm,
        out: &mut dyn FnMut(CellNode),
    ) {
        for (cell, part) in cuts.parts(zone) {
            self.node(state, stay, cuts, &cell, part, out);
        }
    }

    fn node(
        &self,
        state: &Rc<[i64]>,
        stay: &DelayCondition,
        cuts: &CellCuts,
        cell: &ClockCell,
        mut part: Dbm,
        out: &mut dyn FnMut(CellNode),
    ) {
        self.graph.wait(stay, &mut part);
        let Some(part) = within(&part, &cuts.bounds(cell)) else { return };
        self.graph.widen(state, part, &mut |zone| {
            out(CellNode { state: state.clone(), cell: cell.clone(), zone });
        });
    }

    /// Where time or a transition leads from a node.
    fn successors(
        &self,
        node: &CellNode,
        spot: &DiscreteStateInfo,
        at: usize,
    ) -> Result<Vec<(PathSegment, CellNode)>, SearchError> {
        let mut out = Vec::new();
        if spot.stay.waits {
            for cell in spot.cuts.next(&node.cell) {
                let mut later = node.zone.clone();
                self.graph.wait(&spot.stay, &mut later);
                let bounds = spot.cuts.bounds(&cell);
                let Some(part) = within(&later, &bounds) else { continue };
                self.node(&node.state, &spot.stay, &spot.cuts, &cell, part, &mut |next| {
                    out.push((PathSegment::Wait(bounds.clone()), next));
                });
            }
        }
        let before = spot.cuts.bounds(&node.cell);
        for action in &spot.actions {
            let followed = self.graph.follow(action, &node.zone).map_err(|e| self.fault(at, &e))?;
            let Some((target, there, zone)) = followed else { continue };
            let target: Rc<[i64]> = target.into();
            let cuts = CellCuts::of(&self.formulas, &self.graph.here(&target))?;
            for (cell, part) in cuts.parts(&zone) {
                let after = cuts.bounds(&cell);
                self.node(&target, &there, &cuts, &cell, part, &mut |next| {
                    let (taken, before, after) = (action.taken.clone(), before.clone(), after.clone());
                    out.push((PathSegment::Take { taken, before, after }, next));
                });
            }
        }
        Ok(out)
    }

    /// A fault of the model, with the path to it if that can be made concrete.
    fn fault(&self, at: usize, error: &ModelError) -> SearchError {
        fault(self.graph, self.path(at), error.clone())
    }

    fn path(&self, mut at: usize) -> Vec<PathSegment> {
        let mut stops = Vec::new();
        while let EnteredNode { parent: Some(parent), stop: Some(stop), .. } = &self.entered[at] {
            stops.push(stop.clone());
            at = *parent;
        }
        stops.reverse();
        stops
    }

    /// INVARIANT: the comparisons of the formula have one value in a cell, so it holds in all of a node or in nothing of it.
    fn holds(&self, formula: &StateFormula, node: &CellNode) -> Result<bool, ModelError> {
        Ok(!formula.part(&self.graph.here(&node.state), &node.zone)?.is_empty())
    }

    fn search(&mut self, root: usize, avoid: &StateFormula) -> Result<MaximalRunSearchResult, SearchError> {
        let mut stack: Vec<LivenessFrame> = Vec::new();
        let mut on_stack: FxHashMap<ClockCellKey, Vec<usize>> = FxHashMap::default();
        if let Some(trap) = self.visit(root, avoid, &mut stack, &mut on_stack)? {
            return Ok(MaximalRunSearchResult::Found(Box::new(trap)));
        }
        while let Some(frame) = stack.last_mut() {
            let parent = frame.entered;
            let Some((stop, node)) = frame.next.pop() else {
                stack.pop();
                self.finish(parent, &mut on_stack);
                continue;
            };
            if let Some(what) = self.used_up() {
                return Ok(MaximalRunSearchResult::Inconclusive(what));
            }
            if self.is_safe(&node) || self.holds(avoid, &node)? {
                continue;
            }
            let key = (node.state.clone(), node.cell.clone());
            let ancestors = on_stack.get(&key).map_or(&[] as &[usize], Vec::as_slice);
            let back = ancestors.iter().rev().find(|&&a| node.zone.includes(&self.entered[a].node.zone));
            if let Some(&back) = back {
                let from = self.path(back).len();
                let mut stops = self.path(parent);
                stops.push(stop);
                let again = stops[..from].iter().filter(|s| matches!(s, PathSegment::Take { .. })).count();
                let state = node.state.to_vec();
                let trap = MaximalRun { stops, ending: RunEnding::Again(again), from, state };
                return Ok(MaximalRunSearchResult::Found(Box::new(trap)));
            }
            let at = self.enter(node, Some(parent), Some(stop));
            if let Some(trap) = self.visit(at, avoid, &mut stack, &mut on_stack)? {
                return Ok(MaximalRunSearchResult::Found(Box::new(trap)));
            }
        }
        Ok(MaximalRunSearchResult::Nothing)
    }

    fn is_safe(&self, node: &CellNode) -> bool {
        let key = (node.state.clone(), node.cell.clone());
        self.safe.get(&key).is_some_and(|zones| zones.iter().any(|z| z.includes(&node.zone)))
    }

    fn finish(&mut self, at: usize, on_stack: &mut FxHashMap<ClockCellKey, Vec<usize>>) {
        let node = &self.entered[at].node;
        let key = (node.state.clone(), node.cell.clone());
        if let Some(list) = on_stack.get_mut(&key) {
            list.retain(|&n| n != at);
        }
        let zone = node.zone.clone();
        let zones = self.safe.entry(key).or_default();
        zones.retain(|z| !zone.includes(z));
        zones.push(zone);
    }

    /// Looks whether a run can end in a node, and puts it on the stack.
    fn visit(
        &mut self,
        at: usize,
        avoid: &StateFormula,
        stack: &mut Vec<LivenessFrame>,
        on_stack: &mut FxHashMap<ClockCellKey, Vec<usize>>,
    ) -> Result<Option<MaximalRun>, SearchError> {
        let node = self.entered[at].node.clone();
        if self.is_safe(&node) || self.holds(avoid, &node)? {
            return Ok(None);
        }
        let spot = self.spot(&node.state)?;
        let trap = |stops: Vec<PathSegment>, ending| {
            let from = stops.len();
            Some(MaximalRun { stops, ending, from, state: node.state.to_vec() })
        };
        if spot.stay.for_ever() && spot.cuts.is_last(&node.cell) {
            return Ok(trap(self.path(at), RunEnding::Waits));
        }
        if let Some(stuck) = self.stuck(&node, &spot)? {
            let mut stops = self.path(at);
            stops.push(PathSegment::Wait(stuck));
            return Ok(trap(stops, RunEnding::Stuck));
        }
        let next = self.successors(&node, &spot, at)?;
        on_stack.entry((node.state.clone(), node.cell.clone())).or_default().push(at);
        // The last is taken first.
        stack.push(LivenessFrame { entered: at, next: next.into_iter().rev().collect() });
        Ok(None)
    }

    /// Bounds of valuations of the node at which a run ends: no transition is possible now or later, and time cannot
    /// pass into another cell.
    fn stuck(
        &self,
        node: &CellNode,
        spot: &DiscreteStateInfo,
    ) -> Result<Option<Vec<DifferenceConstraint>>, ModelError> {
        // The whole cell, so that the bounds are those of the model and not of the abstraction.
        let mut all = Dbm::universe(self.graph.dim());
        let bounds = spot.cuts.bounds(&node.cell);
        if !bounds.iter().chain(&spot.stay.invariant).all(|c| keep(&mut all, *c)) {
            return Ok(None);
        }
        let mut left: Federation = self.graph.deadlocked_by(&spot.actions, &spot.stay, &all);
        if left.is_empty() {
            return Ok(None);
        }
        if spot.stay.waits {
            for cell in spot.cuts.next(&node.cell) {
                let mut there = Dbm::universe(self.graph.dim());
                let bounds = spot.cuts.bounds(&cell);
                if bounds.iter().chain(&spot.stay.invariant).all(|c| keep(&mut there, *c)) {
                    left = left.minus(&past(&there));
                }
            }
        }
        let here = left.into_zones().into_iter().find(|z| {
            let mut both = z.clone();
            both.intersect(&node.zone)
        });
        Ok(here.map(|z| bounds_of(&z)))
    }
}
