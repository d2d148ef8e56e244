//! Work shared out among threads, of which the caller's is one.

use std::{
    hint::spin_loop,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    thread::yield_now,
};

/// Pieces of work of the caller's after which it is asked again whether to go on: a round may last for seconds.
const UNASKED: usize = 8;
/// Fewer pieces are done before another thread is awake.
const FEW: usize = 4;

/// Looks at whether another thread is done before a thread is put to sleep. Rounds are so short that waking it up takes as long as a good
/// part of one; after some looks other programs may go first.
const LOOKS: usize = 200;
const LOOKS_IN_ONE_GO: usize = 50;

/// The threads beside the caller's.
///
/// Cache lines that two cores write to are slow for both, even where they write to different parts. So each worker makes what it
/// writes to by itself, in memory of its own; and the caller's thread works along instead of waiting.
pub(crate) struct CrewThreads {
    others: usize,
    /// Small searches never need it.
    pool: Option<rayon::ThreadPool>,
    /// How often work was given out.
    given: Arc<AtomicUsize>,
}

impl CrewThreads {
    /// So many, with the caller's.
    pub(crate) fn new(threads: usize) -> Self {
        Self { others: threads.saturating_sub(1), pool: None, given: Arc::default() }
    }

    /// How many there are, with the caller's.
    pub(crate) fn count(&self) -> usize {
        self.others + 1
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
        let others = workers.map(|other| {
            || {
                do_all(next, other, &|| true);
            }
        });
        pool.beside(others, || {
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
        pool.beside(pieces.map(|piece| || work(piece)), || mine.into_iter().for_each(work));
    }

    /// Where there can be no more threads, the caller's does all.
    fn pool(&mut self) -> Option<AwakeThreads<'_>> {
        if self.pool.is_none() && self.others > 0 {
            self.pool = rayon::ThreadPoolBuilder::new().num_threads(self.others).build().ok();
            self.others = if self.pool.is_some() { self.others } else { 0 };
        }
        Some(AwakeThreads { pool: self.pool.as_ref()?, given: &self.given })
    }
}

/// Threads that stay awake for a while after their work.
#[derive(Clone, Copy)]
struct AwakeThreads<'a> {
    pool: &'a rayon::ThreadPool,
    given: &'a Arc<AtomicUsize>,
}

impl AwakeThreads<'_> {
    /// Does `mine` on the caller's thread, and each of the others on one of these.
    fn beside<R>(self, others: impl Iterator<Item = impl FnOnce() + Send>, mine: impl FnOnce() -> R) -> R {
        let (mut begun, ended) = (0, &AtomicUsize::new(0));
        let result = self.pool.in_place_scope(|scope| {
            for other in others {
                begun += 1;
                scope.spawn(move |_| {
                    other();
                    ended.fetch_add(1, Ordering::Release);
                });
            }
            self.given.fetch_add(1, Ordering::Release);
            let result = mine();
            look_until(|| ended.load(Ordering::Acquire) == begun);
            result
        });
        let now = self.given.load(Ordering::Acquire);
        for _ in 0..begun {
            let given = Arc::clone(self.given);
            self.pool.spawn(move || look_until(|| given.load(Ordering::Acquire) != now));
        }
        result
    }
}

/// Returns when it is `true`, or after some time.
fn look_until(done: impl Fn() -> bool) {
    for _ in 0..LOOKS {
        for _ in 0..LOOKS_IN_ONE_GO {
            if done() {
                return;
            }
            spin_loop();
        }
        yield_now();
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
