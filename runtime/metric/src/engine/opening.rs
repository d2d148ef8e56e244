//! Where what an operator finds goes: moved in time, and not before the start.

use hrdsl_ir::Nanos;

use super::piece::PieceFeed;
use crate::robustness::Robustness;

/// Writes values that are found at one time as those of another.
#[derive(Clone, Debug)]
pub(crate) struct ShiftedOutput {
    start: Nanos,
    shift: Nanos,
    /// The value at the start, which is not written before it is certain.
    opening: Option<Robustness>,
    last: Option<Robustness>,
}

impl ShiftedOutput {
    /// `empty` is the value from the start on, as long as a window that is moved into the past has not come to the start.
    pub fn new(start: Nanos, shift: Nanos, empty: Robustness) -> Self {
        let opening = (shift > 0).then_some(empty);
        Self { start, shift, opening, last: opening }
    }

    /// The value from `time` on, before it is moved.
    #[inline]
    pub fn put(&mut self, time: Nanos, value: Robustness, out: &mut PieceFeed) {
        if self.last == Some(value) {
            return;
        }
        self.last = Some(value);
        let time = time.saturating_add(self.shift);
        if time <= self.start {
            self.opening = Some(value);
            return;
        }
        if let Some(opening) = self.opening.take() {
            out.write(self.start, opening);
        }
        out.write(time, value);
    }

    /// Values before `known` are all there.
    pub fn known(&mut self, known: Nanos, out: &mut PieceFeed) {
        let known = known.saturating_add(self.shift);
        if known > self.start {
            if let Some(opening) = self.opening.take() {
                out.write(self.start, opening);
            }
            out.set_known(known);
        }
    }
}
