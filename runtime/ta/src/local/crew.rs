//! The threads that compute successors of many states at once, each with what it uses again and again.
//!
//! What is stored is only looked at meanwhile; what they find is stored afterwards, in the order in which one thread finds it. So
//! nothing depends on their number.

use std::ops::ControlFlow;

use super::{
    batch::LocalBatch,
    refusal::LocalSearchError,
    space::{LocalStateSpace, LocalWorkspace, LocalZoneFilter},
    waiting::{WaitingZones, ZoneSlab},
    zone::{self, LocalLuBounds, LocalZone, LocalZoneBound},
};
use crate::{
    network::{
        error::ModelError,
        model::CompiledNetwork,
        semantics::{EnumerationScratch, FiringOrError, TransitionFiring},
    },
    search::{
        goals::CompiledGoals,
        store::{NIL, PassedList},
        threads::CrewThreads,
    },
};

/// States that one thread expands in one go.
const CHUNK: usize = 32;
/// Fewer zones are written before another thread is awake.
const FEW: usize = 64;

/// What an expansion may look at.
pub(super) struct LocalContext<'a, 'm, 'p> {
    pub space: &'a LocalStateSpace<'m, 'p>,
    pub store: &'a PassedList<LocalZoneBound>,
    pub zones: &'a WaitingZones,
    pub goals: &'a CompiledGoals,
    /// The goals that are not met yet; empty if there are none.
    pub open: &'a [bool],
    /// By member and location: its place in a topological order.
    pub levels: &'a [Vec<u32>],
}

impl LocalContext<'_, '_, '_> {
    /// Adds the open goals that the state in the workspace meets.
    ///
    /// # Errors
    /// A condition that cannot be evaluated there.
    pub(super) fn look(&self, w: &mut LocalWorkspace, met: &mut Vec<usize>) -> Result<(), ModelError> {
        if self.open.is_empty() {
            return Ok(());
        }
        met_by_state(self.space.model, self.goals, self.open, (&mut w.effect.target, &mut w.stack), met)
    }
}

/// Computes successors, with memory that it uses again and again.
#[derive(Default)]
pub(super) struct LocalWorker {
    pub work: LocalWorkspace,
    scratch: EnumerationScratch,
    /// The state whose successors are computed.
    pub state: Vec<i64>,
    pub zone: LocalZone,
    driven_out: Vec<u32>,
}

/// A worker for each thread.
pub(super) struct LocalCrew {
    /// Each is made by the thread that needs it.
    workers: Vec<Option<Box<LocalWorker>>>,
    threads: CrewThreads,
}

impl LocalWorker {
    /// Calls `f` with each successor of the state, which is then in the workspace, with its transition and number.
    ///
    /// # Errors
    /// That of the first transition that fails, or of `f`.
    pub(super) fn successors(
        &mut self,
        space: &LocalStateSpace,
        store: Option<&PassedList<LocalZoneBound>>,
        mut f: impl FnMut(&mut LocalWorkspace, &[i64], &TransitionFiring, u32) -> Result<(), LocalSearchError>,
    ) -> Result<(), LocalSearchError> {
        let Self { work, scratch, state, zone, .. } = self;
        let before = state.clone();
        let may = LocalZoneFilter { zone, processes: &space.processes };
        let (mut number, mut end) = (0, Ok(()));
        let _ = space.model.enumerate(state, &may, scratch, &mut |found| {
            let next = space.found(work, &before, zone, &found, store);
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
        let mut driven_out = std::mem::take(&mut self.driven_out);
        let end = self.successors(c.space, Some(c.store), |w, before, firing, number| {
            transitions += 1;
            if !c.open.is_empty() {
                met_by_edges(c.space, c.goals, before, firing, &mut |goal| {
                    if c.open[goal] {
                        batch.hit(goal);
                    }
                });
            }
            driven_out.clear();
            let simulated = w.packed.known.is_some_and(|discrete| {
                is_simulated(c.store, discrete, 0, (&w.together, &w.lu), &mut driven_out)
            });
            if !simulated {
                batch.found(c, w, &driven_out);
            }
            batch.end_successor(number);
            Ok(())
        });
        self.driven_out = driven_out;
        batch.end_node(node, transitions, end.err());
    }
}

/// Whether a stored state of this discrete one, from node `first` on, simulates that in the workspace; otherwise those that it simulates
/// are added to `driven_out`.
pub(super) fn is_simulated(
    store: &PassedList<LocalZoneBound>,
    discrete: u32,
    first: u32,
    (together, lu): (&[LocalZoneBound], &[LocalLuBounds]),
    driven_out: &mut Vec<u32>,
) -> bool {
    let mut at = store.head(discrete);
    // The newest stands first.
    while at != NIL && at >= first {
        let node = &store.nodes[at as usize];
        let old = store.zone(node, lu.len() + 1);
        if zone::is_simulated(together, old, lu) {
            return true;
        }
        if zone::is_simulated(old, together, lu) {
            driven_out.push(at);
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

/// The open goals that a discrete state meets: all have one time in it.
///
/// # Errors
/// A condition that cannot be evaluated there.
pub(super) fn met_by_state(
    model: &CompiledNetwork,
    goals: &CompiledGoals,
    open: &[bool],
    (state, stack): (&mut [i64], &mut Vec<i64>),
    met: &mut Vec<usize>,
) -> Result<(), ModelError> {
    let settled = !model.any_committed(state);
    goals.states(state, None, stack, model, settled, open, met)
}

impl LocalCrew {
    pub(super) fn new(threads: usize) -> Self {
        Self { workers: (0..threads).map(|_| None).collect(), threads: CrewThreads::new(threads) }
    }

    pub(super) fn threads(&mut self) -> &mut CrewThreads {
        &mut self.threads
    }

    /// Computes what these states lead to, each worker into a batch of its own. `like`: a zone of the network.
    pub(super) fn expand(
        &mut self,
        c: &LocalContext,
        round: &[u32],
        like: &LocalZone,
        batches: &mut Vec<LocalBatch>,
    ) {
        batches.resize_with(self.workers.len(), LocalBatch::default);
        batches.iter_mut().for_each(LocalBatch::clear);
        let new = || Box::new(LocalWorker { zone: like.clone(), ..LocalWorker::default() });
        let workers = self.workers.iter_mut().zip(batches).map(|(worker, slot)| {
            |(number, nodes): (usize, &[u32])| {
                let worker = worker.get_or_insert_with(new);
                // On the stack, since those of other workers stand beside its slot.
                let mut batch = std::mem::take(slot);
                batch.begin_chunk(number);
                // Synchronised zones are looked at by those that come to them, later.
                c.store.prefetch(nodes, 0);
                c.zones.prefetch(nodes);
                // On after a failure, too: what fails may have been driven out when its turn comes.
                nodes.iter().for_each(|&node| worker.expand(c, node, &mut batch));
                *slot = batch;
            }
        });
        self.threads.share(workers, round.chunks(CHUNK).enumerate(), &|| true);
    }

    /// Writes the zones of the batches that are waited with: each worker its own, which it has at hand.
    pub(super) fn write(&mut self, batches: &[LocalBatch], zones: &mut WaitingZones) {
        let few = zones.unwritten() < FEW;
        let all = zones.of_workers().iter_mut().zip(batches);
        let write = |(slot, batch): (&mut ZoneSlab<i16>, &LocalBatch)| {
            // On the stack, as a batch is.
            let mut slab = std::mem::take(slot);
            batch.write(&mut slab);
            *slot = slab;
        };
        if few { all.for_each(write) } else { self.threads.each(all, &write) }
    }
}
