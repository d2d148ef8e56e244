//! The least or greatest value in a window that slides along a signal (Lemire 2006), for pieces of any length: each enters and leaves a queue once.

use std::collections::VecDeque;

use hrdsl_ir::Nanos;

use super::{
    opening::ShiftedOutput,
    piece::{PieceFeed, SignalPiece},
};
use crate::robustness::Robustness;

#[derive(Clone, Copy, Debug)]
struct WindowEntry {
    /// The value, or its opposite where the least is looked for.
    value: Robustness,
    /// From when on it is in no window.
    expires: Nanos,
}

/// `once`, `historically`, and with a negative shift `eventually`, `always`.
#[derive(Clone, Debug)]
pub(crate) struct SlidingExtremum {
    /// The window at s is from s − width to s; `None`: from the start.
    width: Option<Nanos>,
    /// −1: the least; 0: the greatest.
    mask: i64,
    /// Values that fall, the greatest in front. The last is that of the piece that goes on.
    queue: VecDeque<WindowEntry>,
    output: ShiftedOutput,
}

impl SlidingExtremum {
    pub fn new(start: Nanos, width: Option<Nanos>, shift: Nanos, least: bool) -> Self {
        let mask = if least { -1 } else { 0 };
        let empty = Robustness::FALSE.masked(mask);
        Self { width, mask, queue: VecDeque::new(), output: ShiftedOutput::new(start, shift, empty) }
    }

    /// `pieces` are the next ones, and all that start before `known`.
    pub fn advance(&mut self, pieces: &[SignalPiece], known: Nanos, out: &mut PieceFeed) {
        match self.width {
            None => self.run(pieces, out),
            Some(width) => {
                for piece in pieces {
                    self.enter(piece.start, piece.value.masked(self.mask), width, out);
                }
                self.leave(known, out);
            }
        }
        self.output.known(known, out);
    }

    /// The extremum of all so far is the only entry.
    fn run(&mut self, pieces: &[SignalPiece], out: &mut PieceFeed) {
        for piece in pieces {
            let value = piece.value.masked(self.mask);
            let value = self.queue.pop_back().map_or(value, |e| e.value.max(value));
            self.queue.push_back(WindowEntry { value, expires: Nanos::MAX });
            self.output.put(piece.start, value.masked(self.mask), out);
        }
    }

    fn enter(&mut self, time: Nanos, value: Robustness, width: Nanos, out: &mut PieceFeed) {
        if let Some(open) = self.queue.back_mut() {
            open.expires = time.saturating_add(width);
        }
        self.leave(time, out);
        while self.queue.back().is_some_and(|e| e.value <= value) {
            self.queue.pop_back();
        }
        self.queue.push_back(WindowEntry { value, expires: Nanos::MAX });
        while self.queue.front().is_some_and(|e| e.expires <= time) {
            self.queue.pop_front();
        }
        self.tell(time, out);
    }

    /// Entries that expire before `time` leave.
    fn leave(&mut self, time: Nanos, out: &mut PieceFeed) {
        while let Some(expires) = self.queue.front().map(|e| e.expires).filter(|e| *e < time) {
            self.queue.pop_front();
            self.tell(expires, out);
        }
    }

    fn tell(&mut self, time: Nanos, out: &mut PieceFeed) {
        if let Some(front) = self.queue.front() {
            self.output.put(time, front.value.masked(self.mask), out);
        }
    }
}
