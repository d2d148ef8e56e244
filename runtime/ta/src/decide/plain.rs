//! A plain exploration of the zone graph, breadth first, of all that can be reached: for questions that need to look at each
//! zone, not at goals.

use std::{ops::ControlFlow, rc::Rc};

use rustc_hash::FxHashMap;

use crate::{
    network::{
        actions::{DelayCondition, PathTransition},
        error::ModelError,
        graph::ZoneGraph,
        query::SearchBudget,
    },
    search::report::SearchCutoff,
    witness::{
        build::{self, PathSegment, takes},
        error::SearchError,
    },
    zone::dbm::Dbm,
};

/// A symbolic state, after time has passed.
pub(crate) struct ReachedState {
    pub state: Rc<[i64]>,
    pub zone: Dbm,
    parent: Option<(u32, Rc<PathTransition>)>,
}

/// All symbolic states that were seen.
pub(crate) struct ReachabilityGraph<'g, 'm, 'p> {
    graph: &'g ZoneGraph<'m, 'p>,
    pub nodes: Vec<ReachedState>,
    of: FxHashMap<Rc<[i64]>, Vec<u32>>,
    bytes: usize,
}

/// What is done with each symbolic state.
pub(crate) type StateVisitor<'a> =
    dyn FnMut(u32, &ReachedState, &DelayCondition) -> Result<ControlFlow<()>, SearchError> + 'a;

impl<'g, 'm, 'p> ReachabilityGraph<'g, 'm, 'p> {
    pub(crate) fn new(graph: &'g ZoneGraph<'m, 'p>) -> Self {
        Self { graph, nodes: Vec::new(), of: FxHashMap::default(), bytes: 0 }
    }

    /// Shows each symbolic state once, until the look has seen enough.
    ///
    /// # Errors
    /// If the model is at fault, or the look finds one.
    pub(crate) fn explore(
        &mut self,
        budget: SearchBudget,
        look: &mut StateVisitor,
    ) -> Result<Option<SearchCutoff>, SearchError> {
        let (state, stay, zone) = self.graph.start()?;
        self.insert(state.into(), &stay, zone, None);
        let mut at = 0;
        while at < self.nodes.len() {
            if self.nodes.len() >= budget.states {
                return Ok(Some(SearchCutoff::States));
            }
            if self.bytes >= budget.bytes {
                return Ok(Some(SearchCutoff::Memory));
            }
            // INVARIANT: the budget, or memory, keeps the number of nodes below 2³².
            if self.step(at as u32, look)?.is_break() {
                return Ok(None);
            }
            at += 1;
        }
        Ok(None)
    }

    fn step(&mut self, at: u32, look: &mut StateVisitor) -> Result<ControlFlow<()>, SearchError> {
        let node = &self.nodes[at as usize];
        let (state, zone) = (node.state.clone(), node.zone.clone());
        let Some(stay) = self.graph.stay(&state)? else { return Ok(ControlFlow::Continue(())) };
        if look(at, node, &stay)?.is_break() {
            return Ok(ControlFlow::Break(()));
        }
        for action in self.graph.actions(&state) {
            match self.graph.follow(&action, &zone) {
                Ok(None) => {}
                Ok(Some((target, there, next))) => {
                    self.insert(target.into(), &there, next, Some((at, action.taken.clone())));
                }
                Err(e) => return Err(self.fault(at, &e)),
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    fn fault(&self, at: u32, error: &ModelError) -> SearchError {
        build::fault(self.graph, self.path(at), error.clone())
    }

    fn insert(
        &mut self,
        state: Rc<[i64]>,
        stay: &DelayCondition,
        mut zone: Dbm,
        parent: Option<(u32, Rc<PathTransition>)>,
    ) {
        self.graph.wait(stay, &mut zone);
        let ReachabilityGraph { graph, nodes, of, bytes } = self;
        let known = of.entry(state.clone()).or_default();
        graph.widen(&state, zone, &mut |zone| {
            if known.iter().any(|&n| nodes[n as usize].zone.includes(&zone)) {
                return;
            }
            *bytes += zone.heap_bytes() + size_of_val(&*state) + size_of::<ReachedState>();
            known.push(nodes.len() as u32);
            nodes.push(ReachedState { state: state.clone(), zone, parent: parent.clone() });
        });
    }

    /// The path to a symbolic state.
    pub(crate) fn path(&self, mut at: u32) -> Vec<PathSegment> {
        let mut path = Vec::new();
        while let Some((parent, taken)) = &self.nodes[at as usize].parent {
            path.push(taken.clone());
            at = *parent;
        }
        path.reverse();
        takes(path)
    }
}
