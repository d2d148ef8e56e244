//! Liveness: whether there is a maximal run on which a formula never holds.
//!
//! A depth-first search of the zone graph, of the part where the formula does not hold. A run that never meets the formula goes
//! round for ever, ends where nothing more can happen, or waits for ever:
//!
//! - a *loop* is a node whose zone includes that of an earlier node on the search's path with the same discrete state: each
//!   valuation of the later zone is simulated by one that comes from the earlier, so there are runs that have gone round any number of
//!   times, and as there are finitely many regions there is one that goes round for ever. Inclusion the other way round proves
//!   nothing (Laarman, Olesen, Dalsgaard, Larsen, van de Pol, "Multi-Core Emptiness Checking of Timed Büchi Automata using
//!   Inclusion Abstraction", CAV 2013), but a node that a finished one simulates needs no second look;
//! - a run *ends* at a valuation from which no transition is possible, now or after any delay, and time cannot pass into a
//!   cell where the formula holds;
//! - a run *waits* for ever where no invariant bounds time.
//!
//! Loops and waits are kept by simulation (ExtraLU+, aLU), ends are not: they are states that can do less. So the search goes by simulation
//! first, and looks for ends in all that a zone simulates. If there may be one to which no run along the path comes, it gives up,
//! and [begins again](MaximalRunSearchResult::Doubtful) with greatest constants (ExtraM+, aM), a bisimulation.
//!
//! Where clocks stand still, zones are more than can happen: that no run was found is a proof as before, and what was found has to be
//! [confirmed](crate::decide::standing_runs).
//!
//! A loop in which time does not pass beyond some bound (a Zeno run) counts as an infinite run, as it does in UPPAAL.
//!
//! Formulas with clocks: zones are split into [cells](crate::decide::cells), and time passes from cell to cell.

use std::{cell::Cell, rc::Rc};

use rustc_hash::FxHashMap;

use crate::{
    decide::{
        cells::{ClockCell, within},
        known_states::{KnownState, KnownStates},
    },
    network::{
        error::ModelError,
        graph::ZoneGraph,
        query::{SearchBudget, StateFormula},
    },
    search::{
        report::{SearchCutoff, SearchProgress, SearchStatistics, WidestVariable},
        round_search::GoOn,
    },
    witness::{
        build::{PathSegment, bounds_of, fault, times},
        error::SearchError,
        run::RunEnding,
        schedule::ScheduleOptions,
    },
    zone::{
        dbm::{Dbm, dominates},
        extrapolation::{ExtrapolationAbstraction, simulated_hull, thresholds},
    },
};

/// Whoever watches is told each time that so many nodes have been looked from.
const LOOKS: usize = 256;

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
    /// There may be one that ends: the abstraction cannot tell.
    Doubtful,
    Inconclusive(SearchCutoff),
}

/// A part of a symbolic state in one cell, after time has passed within it.
#[derive(Clone)]
struct CellNode {
    known: Rc<KnownState>,
    cell: ClockCell,
    zone: Dbm,
}

/// The number of a discrete state, and a cell.
type ClockCellKey = (u32, ClockCell);

impl CellNode {
    fn key(&self) -> ClockCellKey {
        (self.known.number, self.cell.clone())
    }
}

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
    states: KnownStates<'g, 'm, 'p>,
    /// Zones are exact as far as can be told: they do not stand for what they simulate.
    exact: bool,
    budget: SearchBudget,
    go_on: GoOn<'g>,
    /// How many nodes were looked from.
    visited: Cell<usize>,
    transitions: Cell<usize>,
    entered: Vec<EnteredNode>,
    /// Nodes from which there is no run that avoids the formula.
    safe: FxHashMap<ClockCellKey, Vec<usize>>,
    bytes: usize,
    demands: Vec<i64>,
}

impl<'g, 'm, 'p> LivenessSearch<'g, 'm, 'p> {
    pub(crate) fn new(
        graph: &'g ZoneGraph<'m, 'p>,
        formulas: &[&'g StateFormula],
        (budget, go_on): (SearchBudget, GoOn<'g>),
        abstraction: ExtrapolationAbstraction,
    ) -> Self {
        Self {
            graph,
            states: KnownStates::new(graph, formulas, abstraction),
            exact: !graph.model.stops()
                && (abstraction == ExtrapolationAbstraction::Greatest || graph.splits()),
            budget,
            go_on,
            visited: Cell::new(0),
            transitions: Cell::new(0),
            entered: Vec::new(),
            safe: FxHashMap::default(),
            bytes: 0,
            demands: Vec::new(),
        }
    }

    /// A maximal run on which `avoid` never holds.
    ///
    /// # Errors
    /// If the model is at fault.
    pub(crate) fn avoiding(&mut self, avoid: &StateFormula) -> Result<MaximalRunSearchResult, SearchError> {
        for at in self.starts()? {
            match self.search(at, avoid)? {
                MaximalRunSearchResult::Nothing => {}
                found @ (MaximalRunSearchResult::Found(_)
                | MaximalRunSearchResult::Doubtful
                | MaximalRunSearchResult::Inconclusive(_)) => return Ok(found),
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
        let mut seen: FxHashMap<ClockCellKey, Vec<usize>> = FxHashMap::default();
        let mut waiting = std::collections::VecDeque::new();
        for at in self.starts()? {
            seen.entry(self.entered[at].node.key()).or_default().push(at);
            waiting.push_back(at);
        }
        while let Some(at) = waiting.pop_front() {
            if let Some(what) = self.used_up() {
                return Ok(MaximalRunSearchResult::Inconclusive(what));
            }
            if self.holds(first, &self.entered[at].node)? {
                match self.search(at, then)? {
                    MaximalRunSearchResult::Nothing => {}
                    found @ (MaximalRunSearchResult::Found(_)
                    | MaximalRunSearchResult::Doubtful
                    | MaximalRunSearchResult::Inconclusive(_)) => return Ok(found),
                }
            }
            for (stop, next) in self.successors(at)? {
                let known = seen.entry(next.key()).or_default();
                if self.simulates(known, &next) {
                    continue;
                }
                for piece in self.widened(next) {
                    // What spans several pieces is in none of those that are known, but its pieces may be.
                    if self.graph.splits() && self.simulates(known, &piece) {
                        continue;
                    }
                    let new = self.enter(piece, Some(at), Some(stop.clone()));
                    known.push(new);
                    waiting.push_back(new);
                }
            }
        }
        Ok(MaximalRunSearchResult::Nothing)
    }

    fn used_up(&self) -> Option<SearchCutoff> {
        if self.entered.len() >= self.budget.states {
            return Some(SearchCutoff::States);
        }
        let bytes = self.bytes + self.states.bytes();
        if bytes >= self.budget.bytes {
            return Some(SearchCutoff::Memory);
        }
        let stored = self.entered.len();
        let visited = self.visited.get();
        if !visited.is_multiple_of(LOOKS) {
            return None;
        }
        let waiting = stored.saturating_sub(visited);
        let progress = SearchProgress { stored, visited, waiting, bytes, open: 1, unmet: &[] };
        (!(self.go_on)(&progress)).then_some(SearchCutoff::Stopped)
    }

    /// The int with the most values so far.
    pub(crate) fn widest(&self) -> Option<WidestVariable> {
        self.states.widest()
    }

    /// What it took so far.
    pub(crate) fn statistics(&self) -> SearchStatistics {
        SearchStatistics {
            stored: self.entered.len(),
            visited: self.visited.get(),
            transitions: self.transitions.get(),
            discrete_states: self.states.count(),
            bytes: self.bytes + self.states.bytes(),
        }
    }

    fn enter(&mut self, node: CellNode, parent: Option<usize>, stop: Option<PathSegment>) -> usize {
        self.bytes += node.zone.heap_bytes() + size_of::<EnteredNode>() + size_of::<usize>();
        self.entered.push(EnteredNode { node, parent, stop });
        self.entered.len() - 1
    }

    /// Whether one of the nodes simulates this one; all are of one discrete state and cell.
    fn simulates(&mut self, nodes: &[usize], node: &CellNode) -> bool {
        let (zone, dim) = (&node.zone, node.zone.dim());
        if nodes.is_empty() || self.graph.splits() {
            return nodes.iter().any(|&n| self.entered[n].node.zone.includes(zone));
        }
        thresholds(&node.known.frame, zone, &mut self.demands);
        nodes.iter().any(|&n| {
            let old = &self.entered[n].node.zone;
            (0..dim).all(|i| dominates(old.row(i), &self.demands[i * dim..(i + 1) * dim]))
        })
    }

    /// The nodes of the start, entered.
    fn starts(&mut self) -> Result<Vec<usize>, SearchError> {
        let (state, _, zone) = self.graph.start()?;
        let known = self.states.find(&state)?.ok_or(ModelError::Initial)?;
        let mut out = Vec::new();
        for (cell, part) in known.cuts.parts(&zone) {
            let Some(node) = self.node(&known, cell, part) else { continue };
            out.extend(self.widened(node).into_iter().map(|piece| self.enter(piece, None, None)));
        }
        Ok(out)
    }

    /// A part of a zone after time has passed in its cell.
    fn node(&self, known: &Rc<KnownState>, cell: ClockCell, mut part: Dbm) -> Option<CellNode> {
        self.graph.wait(&known.stay, &mut part);
        let zone = within(&part, &known.cuts.bounds(&cell))?;
        Some(CellNode { known: Rc::clone(known), cell, zone })
    }

    /// The node as one of finitely many, in one or several pieces.
    fn widened(&self, node: CellNode) -> Vec<CellNode> {
        let mut pieces = Vec::new();
        let CellNode { known, cell, zone } = node;
        self.graph.widen(&known.frame, zone, &mut |zone| {
            pieces.push(CellNode { known: Rc::clone(&known), cell: cell.clone(), zone });
        });
        pieces
    }

    /// Where time or a transition leads from a node, not extrapolated.
    fn successors(&self, at: usize) -> Result<Vec<(PathSegment, CellNode)>, SearchError> {
        let node = &self.entered[at].node;
        let known = &node.known;
        let mut out = Vec::new();
        if known.stay.waits {
            for cell in known.cuts.next(&node.cell, &known.stay.stopped) {
                let mut later = node.zone.clone();
                self.graph.wait(&known.stay, &mut later);
                let bounds = known.cuts.bounds(&cell);
                let Some(part) = within(&later, &bounds) else { continue };
                let next = self.node(known, cell, part);
                out.extend(next.map(|next| (PathSegment::Wait(bounds), next)));
            }
        }
        let before = known.cuts.bounds(&node.cell);
        for step in &known.moves {
            let followed = self.states.follow(step, &node.zone).map_err(|e| self.fault(at, &e))?;
            let Some((target, zone)) = followed else { continue };
            for (cell, part) in target.cuts.parts(&zone) {
                let after = target.cuts.bounds(&cell);
                let Some(next) = self.node(&target, cell, part) else { continue };
                let (taken, before) = (step.action.taken.clone(), before.clone());
                out.push((PathSegment::Take { taken, before, after }, next));
            }
        }
        self.visited.set(self.visited.get() + 1);
        self.transitions.set(self.transitions.get() + out.len());
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
        Ok(!formula.part(&self.graph.here(&node.known.state), &node.zone)?.is_empty())
    }

    fn search(&mut self, root: usize, avoid: &StateFormula) -> Result<MaximalRunSearchResult, SearchError> {
        let mut stack: Vec<LivenessFrame> = Vec::new();
        let mut on_stack: FxHashMap<ClockCellKey, Vec<usize>> = FxHashMap::default();
        let node = self.entered[root].node.clone();
        if self.is_safe(&node) || self.holds(avoid, &node)? {
            return Ok(MaximalRunSearchResult::Nothing);
        }
        if let Some(end) = self.visit(root, &mut stack, &mut on_stack)? {
            return Ok(end);
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
            let mut pieces = self.widened(node);
            let Some(piece) = pieces.pop() else { continue };
            // The others come later, so that nothing is on the stack but the path: of a piece there is one piece only.
            if let Some(frame) = stack.last_mut() {
                frame.next.extend(pieces.into_iter().map(|other| (stop.clone(), other)));
            }
            if self.graph.splits() && self.is_safe(&piece) {
                continue;
            }
            if let Some(trap) = self.closes_loop(&piece, parent, &stop, &on_stack) {
                return Ok(MaximalRunSearchResult::Found(Box::new(trap)));
            }
            let at = self.enter(piece, Some(parent), Some(stop));
            if let Some(end) = self.visit(at, &mut stack, &mut on_stack)? {
                return Ok(end);
            }
        }
        Ok(MaximalRunSearchResult::Nothing)
    }

    /// The loop that a node closes, which comes from the last of the path.
    fn closes_loop(
        &self,
        node: &CellNode,
        parent: usize,
        stop: &PathSegment,
        on_stack: &FxHashMap<ClockCellKey, Vec<usize>>,
    ) -> Option<MaximalRun> {
        let ancestors = on_stack.get(&node.key())?;
        let back = ancestors.iter().rev().find(|&&a| node.zone.includes(&self.entered[a].node.zone))?;
        let from = self.path(*back).len();
        let mut stops = self.path(parent);
        stops.push(stop.clone());
        let again = stops[..from].iter().filter(|s| matches!(s, PathSegment::Take { .. })).count();
        let state = node.known.state.clone();
        Some(MaximalRun { stops, ending: RunEnding::Again(again), from, state })
    }

    fn is_safe(&mut self, node: &CellNode) -> bool {
        let Some(nodes) = self.safe.get_mut(&node.key()) else { return false };
        let nodes = std::mem::take(nodes);
        let safe = self.simulates(&nodes, node);
        self.safe.insert(node.key(), nodes);
        safe
    }

    fn finish(&mut self, at: usize, on_stack: &mut FxHashMap<ClockCellKey, Vec<usize>>) {
        let node = &self.entered[at].node;
        let key = node.key();
        if let Some(list) = on_stack.get_mut(&key) {
            list.retain(|&n| n != at);
        }
        let entered = &self.entered;
        let nodes = self.safe.entry(key).or_default();
        nodes.retain(|&n| !node.zone.includes(&entered[n].node.zone));
        nodes.push(at);
    }

    /// Looks whether a run can end in a node, and puts it on the stack.
    fn visit(
        &mut self,
        at: usize,
        stack: &mut Vec<LivenessFrame>,
        on_stack: &mut FxHashMap<ClockCellKey, Vec<usize>>,
    ) -> Result<Option<MaximalRunSearchResult>, SearchError> {
        let node = &self.entered[at].node;
        let stay = &node.known.stay;
        if stay.for_ever() && node.known.cuts.is_last(&node.cell, &stay.stopped) {
            let trap = self.trap(at, self.path(at), RunEnding::Waits);
            return Ok(Some(MaximalRunSearchResult::Found(Box::new(trap))));
        }
        let end = self.stuck(at)?;
        if end.is_some() {
            return Ok(end);
        }
        let next = self.successors(at)?;
        on_stack.entry(self.entered[at].node.key()).or_default().push(at);
        // The last is taken first.
        stack.push(LivenessFrame { entered: at, next: next.into_iter().rev().collect() });
        Ok(None)
    }

    fn trap(&self, at: usize, stops: Vec<PathSegment>, ending: RunEnding) -> MaximalRun {
        let from = stops.len();
        MaximalRun { stops, ending, from, state: self.entered[at].node.known.state.clone() }
    }

    /// A run that ends in a node: no transition is possible now or later, and time cannot pass into another cell.
    fn stuck(&self, at: usize) -> Result<Option<MaximalRunSearchResult>, SearchError> {
        let node = &self.entered[at].node;
        let ends = self.states.ends(&node.known, &node.cell);
        if ends.is_empty() {
            return Ok(None);
        }
        let hull;
        let zone = if self.exact {
            &node.zone
        } else {
            hull = simulated_hull(&node.known.frame, &node.zone);
            &hull
        };
        let mut doubtful = false;
        for end in ends.zones() {
            let mut both = end.clone();
            if !both.intersect(zone) {
                continue;
            }
            let mut stops = self.path(at);
            stops.push(PathSegment::Wait(bounds_of(end)));
            if self.exact || times(self.graph, &stops, ScheduleOptions::default())?.is_some() {
                let trap = self.trap(at, stops, RunEnding::Stuck);
                return Ok(Some(MaximalRunSearchResult::Found(Box::new(trap))));
            }
            doubtful = true;
        }
        Ok(doubtful.then_some(MaximalRunSearchResult::Doubtful))
    }
}
