//! A search that has several threads compute the successors of many states, and stores them as one thread would.

use super::{
    crew::{LocalBatch, LocalContext},
    refusal::LocalSearchError,
    search::{FEW, LocalGoalPath, LocalPause, LocalSearch, LocalWorkMemory},
    space::LocalWorkspace,
};
use crate::search::report::SearchProgress;

/// States that are taken at once.
const AT_ONCE: usize = 512;

impl LocalSearch<'_, '_> {
    /// Takes many states and has all threads compute what they lead to, which is then stored as one thread would.
    pub(super) fn go_at_once(
        &mut self,
        memory: &mut LocalWorkMemory,
        go_on: &dyn Fn(&SearchProgress) -> bool,
    ) -> Result<Option<LocalPause>, LocalSearchError> {
        let LocalWorkMemory { worker, crew: Some(crew), batches, round } = memory else { return Ok(None) };
        self.waiting.take(&self.store.nodes, AT_ONCE, round);
        let context = LocalContext {
            space: &self.space,
            store: &self.store,
            zones: &self.zones,
            goals: &self.compiled,
            open: &self.open,
        };
        let chunks = crew.expand(&context, round, batches);
        // One thread takes a few that still wait at a time, and looks up in between: so does this.
        let (mut done, mut end) = (0, 0);
        for batch in &mut batches[..chunks] {
            let mut first = 0;
            for at in 0..batch.nodes.len() {
                if done == end {
                    let pause = if done > 0 { self.pause(usize::MAX, true, go_on) } else { None };
                    let few = self.few_that_wait(&round[done..]);
                    if pause.is_some() || (few.is_none() && self.waiting.len() > 0) {
                        self.waiting.give_back(&round[done..]);
                        return Ok(pause);
                    }
                    end = few.map_or(round.len(), |few| done + few);
                }
                done += 1;
                let expansion = &mut batch.nodes[at];
                let (node, next, failure) = (expansion.node, expansion.end, expansion.failure.take());
                // Another of the round may have driven it out.
                if self.zones.forget(node) {
                    self.visited += 1;
                    self.transitions += expansion.transitions;
                    for successor in first..next {
                        self.store_successor(node, batch, successor, &mut worker.work)?;
                    }
                    if let Some(failure) = failure {
                        return Err(self.led_to(node, failure));
                    }
                }
                first = next;
            }
        }
        Ok(None)
    }

    /// How many of these nodes have [`FEW`] that are not driven out, at the least; `None`: all have fewer.
    fn few_that_wait(&self, nodes: &[u32]) -> Option<usize> {
        let waits = |(_, n): &(usize, &u32)| !self.store.nodes[**n as usize].covered;
        nodes.iter().enumerate().filter(waits).nth(FEW - 1).map(|(at, _)| at + 1)
    }

    fn store_successor(
        &mut self,
        node: u32,
        batch: &LocalBatch,
        successor: usize,
        w: &mut LocalWorkspace,
    ) -> Result<(), LocalSearchError> {
        let successor = &batch.successors[successor];
        self.met.clear();
        self.met.extend_from_slice(batch.hits(successor));
        self.hit(LocalGoalPath { node, last: Some(successor.number) });
        if batch.get(successor, w) { self.insert(w, node, successor.number) } else { Ok(()) }
    }
}
