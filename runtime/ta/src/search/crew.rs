//! The threads that expand the states of a round, which the caller can end in between.

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use crate::{
    network::model::CompiledNetwork,
    search::{
        batch::ExpansionBatch,
        expand::{ExpansionContext, ExpansionWorker},
        stepper::ZoneClocks,
    },
    witness::error::SearchError,
    zone::dbm::DbmNumber,
};

/// States that one thread expands in one go.
const CHUNK: usize = 16;
/// Chunks of each thread after which the caller is asked again whether to go on: a round may last for seconds.
const UNASKED: usize = 8;

/// Workers, and the threads that they work on; for a single one that is the caller's.
pub(super) struct ExpansionCrew<'m, 'p, N> {
    workers: Vec<ExpansionWorker<'m, 'p, N>>,
    pool: Option<rayon::ThreadPool>,
}

impl<'m, 'p, N: DbmNumber> ExpansionCrew<'m, 'p, N> {
    pub(super) fn new(
        model: &'m CompiledNetwork<'p>,
        clocks: ZoneClocks,
        threads: usize,
    ) -> Result<Self, SearchError> {
        let build = || rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = (threads > 1).then(build).transpose();
        let pool = pool.map_err(|e| SearchError::Internal(format!("no threads: {e}")))?;
        Ok(Self { workers: (0..threads.max(1)).map(|_| ExpansionWorker::new(model, clocks)).collect(), pool })
    }

    /// The worker for what is not done by all.
    pub(super) fn first(&mut self) -> &mut ExpansionWorker<'m, 'p, N> {
        // INVARIANT: there is one at least.
        &mut self.workers[0]
    }

    /// Expands the states of a round, each chunk of them into a batch. `false`: the caller has ended it, and some were not expanded.
    pub(super) fn expand(
        &mut self,
        context: &ExpansionContext<N>,
        round: &[u32],
        batches: &mut Vec<ExpansionBatch<N>>,
        go_on: &dyn Fn() -> bool,
    ) -> bool {
        let chunks = round.len().div_ceil(CHUNK);
        batches.resize_with(batches.len().max(chunks), ExpansionBatch::default);
        batches.iter_mut().for_each(ExpansionBatch::clear);
        let at_once = UNASKED * self.workers.len();
        let parts = round.chunks(CHUNK * at_once).zip(batches.chunks_mut(at_once));
        for (number, (nodes, batches)) in parts.enumerate() {
            if number > 0 && !go_on() {
                return false;
            }
            self.expand_part(context, nodes, batches);
        }
        true
    }

    fn expand_part(
        &mut self,
        context: &ExpansionContext<N>,
        nodes: &[u32],
        batches: &mut [ExpansionBatch<N>],
    ) {
        let work = |worker: &mut ExpansionWorker<'m, 'p, N>, nodes: &[u32], batch: &mut ExpansionBatch<N>| {
            for &node in nodes {
                if worker.expand(context, node, batch).is_err() {
                    break;
                }
            }
        };
        match &self.pool {
            Some(pool) if nodes.len() > CHUNK => {
                // Whoever is free takes the next chunk: which worker does it makes no difference.
                let workers: Vec<Mutex<&mut ExpansionWorker<'m, 'p, N>>> =
                    self.workers.iter_mut().map(Mutex::new).collect();
                let batches = batches[..nodes.len().div_ceil(CHUNK)].par_iter_mut().with_max_len(1);
                pool.install(|| {
                    batches.zip(nodes.par_chunks(CHUNK)).for_each(|(batch, nodes)| {
                        let me = rayon::current_thread_index().unwrap_or(0) % workers.len();
                        let mut worker = workers[me].lock().unwrap_or_else(PoisonError::into_inner);
                        work(&mut worker, nodes, batch);
                    });
                });
            }
            Some(_) | None => {
                for (batch, nodes) in batches.iter_mut().zip(nodes.chunks(CHUNK)) {
                    work(&mut self.workers[0], nodes, batch);
                }
            }
        }
    }
}
