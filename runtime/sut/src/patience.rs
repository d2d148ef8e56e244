//! How long the harness waits for a program: by the program's own time.

use std::time::{Duration, Instant};

use crate::{cell::message::CellUsage, limits::LimitOverrun};

/// Between looks at what the program uses.
pub(crate) const LOOK: Duration = Duration::from_millis(100);

/// How long a wait has lasted, as the program experiences it: load on the machine does not count.
pub(crate) struct WaitBudget {
    /// Of processor time, or of sleep.
    budget: Duration,
    /// The cell's processor time when the wait began, and when it was last looked at.
    cpu: Option<(Duration, Duration)>,
    looked: Instant,
    /// How long all of the cell was asleep.
    asleep: Duration,
}

impl WaitBudget {
    pub(crate) fn new(budget: Duration) -> Self {
        Self { budget, cpu: None, looked: Instant::now(), asleep: Duration::ZERO }
    }

    /// Takes in what the cell has used, and says whether the wait has been too long.
    pub(crate) fn look(&mut self, usage: CellUsage) -> Option<LimitOverrun> {
        // A wait between two looks that was longer than planned was a wait of our own.
        let passed = self.looked.elapsed().min(2 * LOOK);
        self.looked = Instant::now();
        let (first, last) = self.cpu.unwrap_or((usage.cpu, usage.cpu));
        self.cpu = Some((first, usage.cpu));
        if usage.asleep && last == usage.cpu {
            self.asleep += passed;
        }
        if usage.cpu.saturating_sub(first) >= self.budget {
            Some(LimitOverrun::Budget(self.budget))
        } else if self.asleep >= self.budget {
            Some(LimitOverrun::Asleep(self.budget))
        } else {
            None
        }
    }
}
