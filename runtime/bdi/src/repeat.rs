//! Livelocks: a state that comes again, with nothing from outside between, comes for ever.
//!
//! In the manner of Brent's cycle detection (*BIT* 20, 1980): the state is kept at cycles that are powers of two, and for
//! a sixteenth of the way to the next one each state is compared with it. So a cycle of length p is found at 32 · p
//! cycles at the latest, and the comparison costs little. States are compared whole; a cheap fingerprint is compared first.

/// The first cycle at which a state is kept.
const FIRST: u64 = 1024;

/// Words of states that may be compared for each cycle: large states that only look alike must not cost more than the
/// run itself.
const WORK: u64 = 16;

/// A state that was kept, and until which cycle it is compared.
#[derive(Debug, Default)]
pub(crate) struct RepetitionDetector {
    kept: Option<(u64, Vec<u64>)>,
    until: u64,
    /// Words of states that were compared since.
    work: u64,
}

/// What has a state that can repeat.
pub(crate) trait FingerprintedState {
    /// Different for different states, most often.
    fn fingerprint(&self) -> u64;
    /// The whole state, but for counters and the log; times count from now.
    fn state(&self) -> Vec<u64>;
}

impl RepetitionDetector {
    /// Something came from outside, or time has passed.
    pub fn forget(&mut self) {
        self.kept = None;
    }

    /// Whether there is nothing to compare or to keep at this cycle.
    #[inline]
    pub fn is_idle(&self, cycle: u64) -> bool {
        self.kept.is_none() && (cycle < FIRST || !cycle.is_power_of_two())
    }

    /// Whether the state at this cycle is the one that was kept.
    pub fn seen(&mut self, cycle: u64, of: &impl FingerprintedState) -> bool {
        if let Some((fingerprint, state)) = &self.kept {
            if cycle > self.until {
                self.kept = None;
            } else if self.work <= cycle * WORK && *fingerprint == of.fingerprint() {
                let now = of.state();
                self.work += now.len() as u64;
                if now == *state {
                    return true;
                }
            }
        }
        if cycle >= FIRST && cycle.is_power_of_two() {
            self.kept = Some((of.fingerprint(), of.state()));
            self.until = cycle + cycle / 16;
            self.work = 0;
        }
        false
    }
}
