//! The threads that expand the states of a round, which the caller can end in between.

use crate::{
    network::model::CompiledNetwork,
    search::{
        batch::ExpansionBatch,
        expand::{ExpansionContext, ExpansionWorker},
        stepper::ZoneClocks,
        threads::CrewThreads,
    },
    zone::dbm::DbmNumber,
};

/// States that one thread expands in one go.
const CHUNK: usize = 16;

/// Entries of a zone that are fetched ahead: the rest comes by itself, as they are read in order.
const AHEAD: usize = 64;

/// A worker for each thread.
pub(super) struct ExpansionCrew<'m, 'p, N> {
    model: &'m CompiledNetwork<'p>,
    clocks: ZoneClocks,
    /// Each is made by the thread that needs it.
    workers: Vec<Option<Box<ExpansionWorker<'m, 'p, N>>>>,
    threads: CrewThreads,
}

impl<'m, 'p, N: DbmNumber> ExpansionCrew<'m, 'p, N> {
    pub(super) fn new(model: &'m CompiledNetwork<'p>, clocks: ZoneClocks, threads: usize) -> Self {
        let workers = (0..threads.max(1)).map(|_| None).collect();
        Self { model, clocks, workers, threads: CrewThreads::new(threads) }
    }

    /// The worker for what is not done by all.
    pub(super) fn first(&mut self) -> &mut ExpansionWorker<'m, 'p, N> {
        // INVARIANT: there is one at least.
        self.workers[0].get_or_insert_with(|| Box::new(ExpansionWorker::new(self.model, self.clocks)))
    }

    pub(super) fn threads(&mut self) -> &mut CrewThreads {
        &mut self.threads
    }

    /// Expands the states of a round, each worker into a batch of its own. `false`: the caller has ended it, and some were not expanded.
    pub(super) fn expand(
        &mut self,
        context: &ExpansionContext<N>,
        round: &[u32],
        batches: &mut Vec<ExpansionBatch<N>>,
        go_on: &dyn Fn() -> bool,
    ) -> bool {
        batches.resize_with(self.workers.len(), ExpansionBatch::default);
        batches.iter_mut().for_each(ExpansionBatch::clear);
        let (model, clocks) = (self.model, self.clocks);
        let workers = self.workers.iter_mut().zip(batches).map(|(worker, slot)| {
            move |(number, nodes): (usize, &[u32])| {
                let worker = worker.get_or_insert_with(|| Box::new(ExpansionWorker::new(model, clocks)));
                // On the stack, since those of other workers stand beside its slot.
                let mut batch = std::mem::take(slot);
                context.store.prefetch(nodes, AHEAD);
                let fault = nodes.iter().find_map(|&node| worker.expand(context, node, &mut batch).err());
                batch.end_chunk(number, fault);
                *slot = batch;
            }
        });
        self.threads.share(workers, round.chunks(CHUNK).enumerate(), go_on)
    }
}
