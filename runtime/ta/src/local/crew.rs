//! The threads that compute successors of many states at once, each with what it uses again and again.
//!
//! What is stored is only looked at meanwhile; what they find is stored afterwards, in the order in which one thread finds it. So
//! nothing depends on their number.

use std::{
    ops::ControlFlow,
    sync::{Mutex, PoisonError},
};

use rayon::prelude::*;

use super::{
    refusal::LocalSearchError,
    space::{LocalStateSpace, LocalWorkspace, LocalZoneFilter},
    waiting::WaitingZones,
    zone::{self, LocalLuBounds, LocalZone, LocalZoneBound},
};
use crate::{
    network::semantics::{EnumerationScratch, FiringOrError, TransitionFiring},
    search::{
        goals::CompiledGoals,
        store::{NIL, PassedList, hash_words},
    },
    witness::error::SearchError,
};

/// States that one thread expands in one go.
const CHUNK: usize = 16;

/// What an expansion may look at.
pub(super) struct LocalContext<'a, 'm, 'p> {
    pub space: &'a LocalStateSpace<'m, 'p>,
    pub store: &'a PassedList<LocalZoneBound>,
    pub zones: &'a WaitingZones,
    pub goals: &'a CompiledGoals,
    /// The goals that are not met yet.
    pub open: &'a [bool],
}

/// Computes successors, with memory that it uses again and again.
#[derive(Default)]
pub(super) struct LocalWorker {
    pub work: LocalWorkspace,
    scratch: EnumerationScratch,
    /// The state whose successors are computed.
    pub state: Vec<i64>,
    pub zone: LocalZone,
    packed: Vec<u64>,
}

/// Workers, and their threads.
pub(super) struct LocalCrew {
    workers: Vec<LocalWorker>,
    pool: rayon::ThreadPool,
}

/// A successor that something comes of: it meets goals by its transition, or nothing stored simulates it.
#[derive(Clone, Copy)]
pub(super) struct LocalSuccessor {
    /// Its number among those of its node.
    pub number: u32,
    hits: (usize, usize),
    /// Where its state, its synchronised zone and its bounds begin, with the number of clocks that matter; and its zone.
    found: Option<(usize, usize, usize, usize, usize)>,
}

/// What one state leads to.
pub(super) struct LocalExpansion {
    pub node: u32,
    pub transitions: usize,
    /// Where its successors end in those of the batch.
    pub end: usize,
    /// Its last transition fails.
    pub failure: Option<LocalSearchError>,
}

/// What the states of a chunk lead to.
#[derive(Default)]
pub(super) struct LocalBatch {
    pub nodes: Vec<LocalExpansion>,
    pub successors: Vec<LocalSuccessor>,
    hits: Vec<usize>,
    states: Vec<i64>,
    together: Vec<LocalZoneBound>,
    lu: Vec<LocalLuBounds>,
    zones: Vec<LocalZoneBound>,
}

impl LocalWorker {
    /// Calls `f` with each successor of the state, which is then in the workspace, with its transition and number.
    ///
    /// # Errors
    /// That of the first transition that fails, or of `f`.
    pub(super) fn successors(
        &mut self,
        space: &LocalStateSpace,
        mut f: impl FnMut(&mut LocalWorkspace, &[i64], &TransitionFiring, u32) -> Result<(), LocalSearchError>,
    ) -> Result<(), LocalSearchError> {
        let Self { work, scratch, state, zone, .. } = self;
        let before = state.clone();
        let may = LocalZoneFilter { zone, processes: &space.processes };
        let (mut number, mut end) = (0, Ok(()));
        let _ = space.model.enumerate(state, &may, scratch, &mut |found| {
            let next = space.found(work, &before, zone, &found);
            end = match (next, &found) {
                (Ok(true), FiringOrError::Firing(firing)) => {
                    number += 1;
                    f(work, &before, firing, number - 1)
                }
                (Ok(_), _) => Ok(()),
                (Err(failure), _) => Err(failure),
            };
            if end.is_ok() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
        end
    }

    /// Adds to the batch what a stored state leads to.
    fn expand(&mut self, c: &LocalContext, node: u32, batch: &mut LocalBatch) {
        // INVARIANT: it waits.
        c.zones.read(node, &mut self.zone);
        c.store.layout.unpack(c.store.packed(c.store.nodes[node as usize].discrete), &mut self.state);
        let mut transitions = 0;
        let mut packed = std::mem::take(&mut self.packed);
        let end = self.successors(c.space, |w, before, firing, number| {
            transitions += 1;
            let first = batch.hits.len();
            met_by_edges(c.space, c.goals, before, firing, &mut |goal| {
                if c.open[goal] {
                    batch.hits.push(goal);
                }
            });
            c.store.layout.pack(&w.effect.target, &mut packed);
            let known = c.store.find(hash_words(&packed), &packed);
            let new = !known.is_some_and(|discrete| is_simulated(c.store, discrete, w));
            let found = new.then(|| batch.put(w));
            if new || batch.hits.len() > first {
                let hits = (first, batch.hits.len());
                batch.successors.push(LocalSuccessor { number, hits, found });
            }
            Ok(())
        });
        self.packed = packed;
        let expansion = LocalExpansion { node, transitions, end: batch.successors.len(), failure: end.err() };
        batch.nodes.push(expansion);
    }
}

/// Whether a stored state of this discrete one simulates that in the workspace.
fn is_simulated(store: &PassedList<LocalZoneBound>, discrete: u32, w: &LocalWorkspace) -> bool {
    let mut at = store.head(discrete);
    while at != NIL {
        let node = &store.nodes[at as usize];
        if zone::is_simulated(&w.together, store.zone(node, w.lu.len() + 1), &w.lu) {
            return true;
        }
        at = node.next;
    }
    false
}

/// The goals that taking these edges meets.
pub(super) fn met_by_edges(
    space: &LocalStateSpace,
    goals: &CompiledGoals,
    before: &[i64],
    firing: &TransitionFiring,
    met: &mut dyn FnMut(usize),
) {
    let model = space.model;
    for part in firing.parts {
        let m = usize::from(part.member);
        let edge = model.members[m].edges[usize::from(part.edge)].number;
        let last = model.pairs.then(|| model.last_edge_at(m));
        goals.taken(edge, before, last, met);
    }
}

impl LocalBatch {
    fn clear(&mut self) {
        self.nodes.clear();
        self.successors.clear();
        self.hits.clear();
        self.states.clear();
        self.together.clear();
        self.lu.clear();
        self.zones.clear();
    }

    /// Keeps what is in the workspace.
    fn put(&mut self, w: &LocalWorkspace) -> (usize, usize, usize, usize, usize) {
        let at = (self.states.len(), self.together.len(), self.lu.len(), w.lu.len(), self.zones.len());
        self.states.extend_from_slice(&w.effect.target);
        self.together.extend_from_slice(&w.together);
        self.lu.extend_from_slice(&w.lu);
        self.zones.extend_from_slice(w.zone.bounds());
        at
    }

    /// The goals that the transition to the successor meets.
    pub(super) fn hits(&self, successor: &LocalSuccessor) -> &[usize] {
        &self.hits[successor.hits.0..successor.hits.1]
    }

    /// Puts the successor into a workspace that has had one of the same network; `false`: a stored one simulates it.
    pub(super) fn get(&self, successor: &LocalSuccessor, w: &mut LocalWorkspace) -> bool {
        let Some((state, together, lu, clocks, zone)) = successor.found else { return false };
        let size = w.effect.target.len();
        w.effect.target.copy_from_slice(&self.states[state..state + size]);
        w.together.clear();
        w.together.extend_from_slice(&self.together[together..together + (clocks + 1) * (clocks + 1)]);
        w.lu.clear();
        w.lu.extend_from_slice(&self.lu[lu..lu + clocks]);
        let bounds = w.zone.bounds_mut();
        let length = bounds.len();
        bounds.copy_from_slice(&self.zones[zone..zone + length]);
        true
    }
}

impl LocalCrew {
    /// # Errors
    /// If there are no threads.
    pub(super) fn new(threads: usize, zone: &LocalZone) -> Result<Self, SearchError> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.map_err(|e| SearchError::Internal(format!("no threads: {e}")))?;
        let worker = || LocalWorker { zone: zone.clone(), ..LocalWorker::default() };
        Ok(Self { workers: (0..threads).map(|_| worker()).collect(), pool })
    }

    /// Computes what these states lead to, each chunk of them into a batch: so many batches are in use afterwards.
    pub(super) fn expand(&mut self, c: &LocalContext, round: &[u32], batches: &mut Vec<LocalBatch>) -> usize {
        let chunks = round.len().div_ceil(CHUNK);
        batches.resize_with(batches.len().max(chunks), LocalBatch::default);
        // Whoever is free takes the next chunk: which worker does it makes no difference.
        let workers: Vec<Mutex<&mut LocalWorker>> = self.workers.iter_mut().map(Mutex::new).collect();
        let batches = batches[..chunks].par_iter_mut().with_max_len(1);
        self.pool.install(|| {
            batches.zip(round.par_chunks(CHUNK)).for_each(|(batch, nodes)| {
                let me = rayon::current_thread_index().unwrap_or(0) % workers.len();
                let mut worker = workers[me].lock().unwrap_or_else(PoisonError::into_inner);
                batch.clear();
                // On after a failure, too: what fails may have been driven out when its turn comes.
                nodes.iter().for_each(|&node| worker.expand(c, node, batch));
            });
        });
        chunks
    }
}
