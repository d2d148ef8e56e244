//! Time, interrupts, and what is told while a search goes on.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicUsize, Ordering},
        mpsc::{self, RecvTimeoutError},
    },
    thread,
    time::{Duration, Instant},
};

use hrdsl_runtime::prove::SearchWatch;
use hrdsl_source::printable_line;
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

use super::table::{PropertyKind, PropertyVerdict};
use crate::{fault::CommandFault, interrupt, terminal};

#[allow(clippy::disallowed_methods, reason = "how long it took is shown, and decides nothing but a time-out")]
pub fn now() -> Instant {
    Instant::now()
}

/// Time, and a line on the terminal for long work.
pub struct ProofClock {
    started: Instant,
    until: Option<Instant>,
    interrupted: Arc<AtomicBool>,
    /// Answers are printed as lines of JSON.
    stream: bool,
    bar: ProgressBar,
}

/// How long a search is waited for that was told to stop. Not all of them listen.
const GRACE: Duration = Duration::from_millis(500);
/// The same after an interrupt: whoever interrupts is waiting.
const INTERRUPTED_GRACE: Duration = Duration::from_millis(60);
/// How often is looked whether it is over.
const LOOKS: Duration = Duration::from_millis(20);
/// Whoever waits no longer than this sees the answers all at once.
const PATIENCE: Duration = Duration::from_secs(1);
const STACK: usize = 64 << 20;

/// An answer as a line.
#[derive(Serialize)]
struct EarlyAnswer<'a> {
    network: &'a str,
    kind: PropertyKind,
    name: &'a str,
    verdict: String,
}

impl ProofClock {
    /// # Errors
    /// If nobody can listen for interrupts.
    pub fn start(timeout: Option<Duration>, stream: bool) -> Result<Self, CommandFault> {
        let bar = ProgressBar::new_spinner();
        if let Ok(style) = ProgressStyle::with_template("{spinner} {msg}  {elapsed}") {
            bar.set_style(style);
        }
        let (started, interrupted) = (now(), interrupt::flag(false)?);
        let until = timeout.and_then(|t| started.checked_add(t));
        Ok(Self { started, until, interrupted, stream, bar })
    }

    pub fn is_interrupted(&self) -> bool {
        self.interrupted.load(Ordering::Relaxed)
    }

    /// Why something was not decided at all.
    pub fn late(&self) -> &'static str {
        if self.is_interrupted() { "it was interrupted" } else { "the time was over" }
    }

    fn is_over(&self) -> bool {
        self.is_interrupted() || self.until.is_some_and(|until| now() >= until)
    }

    /// Tells an answer as soon as it is known: as a line of JSON, or above the line of the terminal, if somebody has waited for it.
    ///
    /// # Errors
    /// What is wrong with stdout.
    pub fn tell(
        &self,
        network: &str,
        kind: PropertyKind,
        name: &str,
        verdict: PropertyVerdict,
    ) -> Result<(), CommandFault> {
        if self.stream {
            let line = serde_json::to_string(&EarlyAnswer { network, kind, name, verdict: verdict.key() });
            return terminal::print_data(&(line.map_err(|e| e.to_string())? + "\n"));
        }
        if self.started.elapsed() >= PATIENCE {
            let (network, name) = (printable_line(network), printable_line(name));
            self.bar.println(format!("{network}: {name} {}", verdict.words()));
        }
        Ok(())
    }

    /// Runs something while its progress is shown, and tells it when its time is over. `early` is given what is met meanwhile. `None`: it
    /// did not end in time, and is left behind, until the process ends.
    ///
    /// # Errors
    /// Those of the work, and of `early`.
    pub fn watched<T: Send + 'static>(
        &self,
        name: &str,
        work: impl FnOnce(&SearchWatch) -> Result<T, CommandFault> + Send + 'static,
        early: &mut dyn FnMut(usize) -> Result<(), CommandFault>,
    ) -> Result<Option<T>, CommandFault> {
        if self.is_over() {
            return Ok(None);
        }
        let watch = Arc::new(SearchWatch::default());
        let (done, result) = mpsc::channel();
        let watching = Arc::clone(&watch);
        // Searches recurse little, but expressions are as deep as they are written.
        let search = thread::Builder::new().stack_size(STACK);
        let search = search.spawn(move || {
            // Nobody may wait any more.
            let _ = done.send(work(&watching));
        });
        search.map_err(|e| format!("cannot start a thread: {e}"))?;
        let (mut waited, mut stopped) = (Duration::from_millis(1), None);
        let mut pace = SearchPace::new();
        loop {
            match result.recv_timeout(waited) {
                Ok(found) => {
                    watch.newly_met().into_iter().try_for_each(&mut *early)?;
                    return found.map(Some);
                }
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(format!("internal error: the search for `{name}` broke off"));
                }
                Err(RecvTimeoutError::Timeout) => {}
            }
            watch.newly_met().into_iter().try_for_each(&mut *early)?;
            // Short work ends soon; long work is looked at now and then.
            waited = (waited * 2).min(LOOKS);
            if self.is_over() {
                watch.interrupted.store(self.is_interrupted(), Ordering::Relaxed);
                watch.stop.store(true, Ordering::Relaxed);
                let since = *stopped.get_or_insert_with(now);
                let grace = if self.is_interrupted() { INTERRUPTED_GRACE } else { GRACE };
                if since.elapsed() >= grace {
                    return Ok(None);
                }
            }
            self.bar.set_message(format!("{}: {}", printable_line(name), pace.told(&watch)));
            self.bar.tick();
        }
    }

    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// How fast a search goes, and where to.
struct SearchPace {
    since: Instant,
    visited: usize,
    waiting: usize,
    /// States a second, and how many more wait each second.
    rates: Option<(f64, f64)>,
}

impl SearchPace {
    fn new() -> Self {
        Self { since: now(), visited: 0, waiting: 0, rates: None }
    }

    /// `12000 states, 340 waiting, 5 open, 9000/s, 45 MB, about 3 s left`
    fn told(&mut self, watch: &SearchWatch) -> String {
        let load = |n: &AtomicUsize| n.load(Ordering::Relaxed);
        let (visited, waiting) = (load(&watch.visited), load(&watch.waiting));
        let passed = self.since.elapsed().as_secs_f64();
        // Another search of the same question begins anew.
        if visited < self.visited {
            *self = Self { visited, waiting, ..Self::new() };
        } else if passed >= 1.0 && visited > self.visited {
            // A round of many states may last for seconds, in which nothing is told.
            let each = |n: usize, before: usize| (n as f64 - before as f64) / passed;
            let rates = (each(visited, self.visited), each(waiting, self.waiting));
            *self = Self { since: now(), visited, waiting, rates: Some(rates) };
        }
        let stored = load(&watch.stored);
        let mut parts = vec![format!("{stored} {}", if stored == 1 { "state" } else { "states" })];
        parts.push(format!("{waiting} waiting"));
        parts.push(format!("{} open", load(&watch.open)));
        if let Some((rate, growth)) = self.rates {
            parts.push(format!("{rate:.0}/s"));
            parts.push(megabytes(load(&watch.bytes)));
            parts.push(estimate(waiting, growth));
        }
        parts.join(", ")
    }
}

/// When nothing will wait any more, if it goes on so.
fn estimate(waiting: usize, growth: f64) -> String {
    if growth < -1.0 {
        format!("about {:.0} s left", (waiting as f64 / -growth).ceil())
    } else {
        "no end in sight yet".to_owned()
    }
}

/// `1.2 MB`
pub fn megabytes(bytes: usize) -> String {
    format!("{:.1} MB", bytes as f64 / 1e6)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_is_estimated_when_less_and_less_waits() {
        assert_eq!(estimate(1000, -250.0), "about 4 s left");
        assert_eq!(estimate(1000, 250.0), "no end in sight yet");
        assert_eq!(megabytes(45_040_000), "45.0 MB");
    }
}
