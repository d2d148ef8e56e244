//! The seam to time: the harness owns it, or the outside does.

use hrdsl_ir::Nanos;

/// What lets time pass.
pub trait TimeSource {
    /// Lets time pass from `now` to `due`, when the next thing is known to happen (`None`: nothing is), but not beyond
    /// `limit`. Where the outside owns time, it may come to stand earlier, because something came from there.
    ///
    /// The time then, at least `now` and at most `limit`; `None`: nothing will happen any more.
    fn advance(&mut self, now: Nanos, due: Option<Nanos>, limit: Nanos) -> Option<Nanos>;
}

/// The harness owns time: it passes at once, and where nothing is due the run is over.
#[derive(Clone, Copy, Debug, Default)]
pub struct VirtualClock;

impl TimeSource for VirtualClock {
    fn advance(&mut self, now: Nanos, due: Option<Nanos>, limit: Nanos) -> Option<Nanos> {
        due.map(|due| due.clamp(now, limit.max(now)))
    }
}
