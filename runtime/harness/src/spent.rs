//! Processor time that was measured, and by which clock.

use std::{ops::AddAssign, time::Duration};

/// Reads the processor time of the calling thread.
pub type ThreadClock = fn() -> Duration;

/// Processor time, and in how many intervals it was measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SpentTime {
    pub time: Duration,
    pub intervals: u32,
}

impl SpentTime {
    /// Measures what something takes.
    pub fn measure<T>(&mut self, clock: ThreadClock, act: impl FnOnce() -> T) -> T {
        let begun = clock();
        let result = act();
        self.time += clock().saturating_sub(begun);
        self.intervals = self.intervals.saturating_add(1);
        result
    }

    /// The time without that of reading the clock, which takes so long.
    #[must_use]
    pub fn net(&self, reading: Duration) -> Duration {
        self.time.saturating_sub(reading.saturating_mul(self.intervals))
    }
}

impl AddAssign for SpentTime {
    fn add_assign(&mut self, other: Self) {
        self.time += other.time;
        self.intervals = self.intervals.saturating_add(other.intervals);
    }
}
