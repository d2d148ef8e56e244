//! A search that has several threads compute the successors of many states, and stores them as one thread would.

use super::{
    batch::{LocalBatch, LocalExpansion, in_order},
    crew::{LocalContext, LocalWorker},
    refusal::LocalSearchError,
    search::{FEW, LocalGoalPath, LocalPause, LocalSearch, LocalWorkMemory},
};
use crate::search::report::SearchProgress;

/// States that are taken at once.
const AT_ONCE: usize = 1024;

impl LocalSearch<'_, '_> {
    /// Takes many states and has all threads compute what they lead to, which is then stored as one thread would.
    pub(super) fn go_at_once(
        &mut self,
        memory: &mut LocalWorkMemory,
        go_on: &dyn Fn(&SearchProgress) -> bool,
    ) -> Result<Option<LocalPause>, LocalSearchError> {
        let LocalWorkMemory { worker, crew: Some(crew), batches, round, order } = memory else {
            return Ok(None);
        };
        self.waiting.take(&self.store.covered, AT_ONCE, round);
        let context = LocalContext {
            space: &self.space,
            store: &self.store,
            zones: &self.zones,
            goals: &self.compiled,
            open: if self.left > 0 { &self.open } else { &[] },
            levels: &self.levels,
        };
        crew.expand(&context, round, &worker.zone, batches);
        in_order(batches, order);
        self.store.begin_round();
        let pause = self.store_round(worker, batches, round, order, go_on);
        self.store.end_round(crew.threads());
        crew.write(batches, &mut self.zones);
        pause
    }

    /// Stores what a round led to, in order.
    fn store_round(
        &mut self,
        worker: &mut LocalWorker,
        batches: &mut [LocalBatch],
        round: &[u32],
        order: &[(usize, usize)],
        go_on: &dyn Fn(&SearchProgress) -> bool,
    ) -> Result<Option<LocalPause>, LocalSearchError> {
        let first = self.store.nodes.len() as u32;
        // One thread takes a few that still wait at a time, and looks up in between: so does this.
        let mut end = 0;
        for (done, &(number, at)) in order.iter().enumerate() {
            if done == end {
                let pause = if done > 0 { self.pause(usize::MAX, true, go_on) } else { None };
                let few = self.few_that_wait(&round[done..]);
                if pause.is_some() || (few.is_none() && self.waiting.len() > 0) {
                    self.waiting.give_back(&round[done..]);
                    return Ok(pause);
                }
                end = few.map_or(round.len(), |few| done + few);
            }
            let batch = &mut batches[number];
            let successors = batch.first_successor(at)..batch.nodes[at].end;
            let LocalExpansion { node, transitions, failure, .. } = &mut batch.nodes[at];
            let (node, transitions, failure) = (*node, *transitions, failure.take());
            if !batch.is_whole(at) {
                self.expand_stored(node, worker)?;
            } else if self.zones.forget(node) {
                batch.nodes[at].done = true;
                self.visited += 1;
                self.transitions += transitions;
                for successor in successors {
                    self.store_successor(node, batch, successor, (number, first));
                }
                if let Some(failure) = failure {
                    return Err(self.led_to(node, failure));
                }
            }
        }
        Ok(None)
    }

    /// How many of these nodes have [`FEW`] that are not driven out, at the least; `None`: all have fewer.
    fn few_that_wait(&self, nodes: &[u32]) -> Option<usize> {
        let waits = |(_, n): &(usize, &u32)| !self.store.covered.has(**n);
        nodes.iter().enumerate().filter(waits).nth(FEW - 1).map(|(at, _)| at + 1)
    }

    fn store_successor(&mut self, node: u32, batch: &LocalBatch, successor: usize, compared: (usize, u32)) {
        let number = batch.successors[successor].number;
        self.met.clear();
        self.met.extend_from_slice(batch.hits(successor));
        self.hit(LocalGoalPath { node, last: Some(number) });
        let Some(arrival) = batch.arrival(successor, self.store.layout.words, compared) else { return };
        if let Some((new, true)) = self.arrive(arrival, node, number)
            && self.left > 0
        {
            self.met.clear();
            self.met.extend_from_slice(batch.met(successor));
            self.hit(LocalGoalPath { node: new, last: None });
        }
    }
}
