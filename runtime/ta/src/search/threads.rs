//! Work shared out among threads, of which the caller's is one.

use std::sync::{Mutex, PoisonError};

/// Pieces of work of the caller's after which it is asked again whether to go on: a round may last for seconds.
const UNASKED: usize = 8;
/// Fewer pieces are done before another thread is awake.
const FEW: usize = 4;

/// The threads beside the caller's.
///
/// Cache lines that two cores write to are slow for both, even where they write to different parts. So each worker makes what it
/// writes to by itself, in memory of its own; and the caller's thread works along instead of waiting.
pub(crate) struct CrewThreads {
    others: usize,
    /// Small searches never need it.
    pool: Option<rayon::ThreadPool>,
}

impl CrewThreads {
    /// So many, with the caller's.
    pub(crate) fn new(threads: usize) -> Self {
        Self { others: threads.saturating_sub(1), pool: None }
    }

    /// Gives each of the pieces to one of the workers: whoever is free takes the next. The first worker is the caller's thread; there are
    /// no more of them than threads. Now and then `go_on` is asked whether to: `false`, it was not, and some pieces are not done.
    pub(crate) fn share<P: Send>(
        &mut self,
        mut workers: impl Iterator<Item = impl FnMut(P) + Send>,
        pieces: impl ExactSizeIterator<Item = P> + Send,
        go_on: &dyn Fn() -> bool,
    ) -> bool {
        let Some(mine) = workers.next() else { return false };
        let pool = if pieces.len() < FEW { None } else { self.pool() };
        let pieces = Mutex::new(Some(pieces));
        // Locked while a piece is taken, not while it is worked on.
        let next = || pieces.lock().unwrap_or_else(PoisonError::into_inner).as_mut()?.next();
        let Some(pool) = pool else { return do_all(next, mine, go_on) };
        pool.in_place_scope(|scope| {
            for other in workers {
                let next = &next;
                scope.spawn(move |_| {
                    do_all(next, other, &|| true);
                });
            }
            let whole = do_all(next, mine, go_on);
            if !whole {
                *pieces.lock().unwrap_or_else(PoisonError::into_inner) = None;
            }
            whole
        })
    }

    /// Does each of the pieces, of which there are no more than threads, on a thread of its own: the first on the caller's.
    pub(crate) fn each<P: Send>(&mut self, mut pieces: impl Iterator<Item = P>, work: &(impl Fn(P) + Sync)) {
        let Some(pool) = self.pool() else { return pieces.for_each(work) };
        let mine = pieces.next();
        pool.in_place_scope(|scope| {
            pieces.for_each(|piece| scope.spawn(move |_| work(piece)));
            mine.into_iter().for_each(work);
        });
    }

    /// Where there can be no more threads, the caller's does all.
    fn pool(&mut self) -> Option<&rayon::ThreadPool> {
        if self.pool.is_none() && self.others > 0 {
            self.pool = rayon::ThreadPoolBuilder::new().num_threads(self.others).build().ok();
            self.others = if self.pool.is_some() { self.others } else { 0 };
        }
        self.pool.as_ref()
    }
}

fn do_all<P>(next: impl Fn() -> Option<P>, mut work: impl FnMut(P), go_on: &dyn Fn() -> bool) -> bool {
    let mut done = 0;
    while let Some(piece) = next() {
        if done == UNASKED {
            if !go_on() {
                return false;
            }
            done = 0;
        }
        work(piece);
        done += 1;
    }
    true
}
