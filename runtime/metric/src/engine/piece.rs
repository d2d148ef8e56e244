//! Signals in time as they come: pieces of constant value, and up to when they are known.

use hrdsl_ir::Nanos;

use crate::robustness::Robustness;

/// From `start` on, up to the next piece, the signal has this value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SignalPiece {
    pub start: Nanos,
    pub value: Robustness,
}

/// Pieces of a signal on their way from who makes them to who reads them.
#[derive(Clone, Debug)]
pub(crate) struct PieceFeed {
    pieces: Vec<SignalPiece>,
    /// How many of them were read.
    read: usize,
    /// The value up to `known`, of those that were written.
    written: Option<Robustness>,
    /// The value of the last piece that was read.
    current: Robustness,
    /// There are no more pieces that start before this.
    known: Nanos,
}

impl PieceFeed {
    pub fn new(start: Nanos) -> Self {
        Self { pieces: Vec::new(), read: 0, written: None, current: Robustness::FALSE, known: start }
    }

    /// Pieces come in order. One that has the value of the one before it is none.
    #[inline]
    pub fn write(&mut self, start: Nanos, value: Robustness) {
        if self.written != Some(value) {
            self.written = Some(value);
            self.pieces.push(SignalPiece { start, value });
        }
    }

    pub fn set_known(&mut self, known: Nanos) {
        self.known = self.known.max(known);
    }

    pub fn known(&self) -> Nanos {
        self.known
    }

    /// What was written since the last call of [`Self::clear`], for who reads all of it.
    pub fn all(&self) -> &[SignalPiece] {
        &self.pieces
    }

    pub fn clear(&mut self) {
        self.pieces.clear();
        self.read = 0;
    }

    #[inline]
    fn next_start(&self) -> Nanos {
        self.pieces.get(self.read).map_or(Nanos::MAX, |p| p.start)
    }

    #[inline]
    fn take(&mut self) {
        if let Some(piece) = self.pieces.get(self.read) {
            self.current = piece.value;
            self.read += 1;
        }
    }

    /// Lets go of what was read, once that is most of it.
    fn trim(&mut self) {
        if self.read == self.pieces.len() {
            self.clear();
        } else if self.read > 64 && self.read * 2 > self.pieces.len() {
            self.pieces.drain(..self.read);
            self.read = 0;
        }
    }
}

/// Goes through two signals side by side, as far as both are known and before `limit`: a call for each moment at which one of them changes.
pub(crate) fn side_by_side(
    left: &mut PieceFeed,
    right: &mut PieceFeed,
    limit: Nanos,
    mut each: impl FnMut(Nanos, Robustness, Robustness),
) -> Nanos {
    let known = left.known.min(right.known).min(limit);
    loop {
        let (a, b) = (left.next_start(), right.next_start());
        let time = a.min(b);
        if time >= known {
            break;
        }
        if a == time {
            left.take();
        }
        if b == time {
            right.take();
        }
        each(time, left.current, right.current);
    }
    left.trim();
    right.trim();
    known
}

/// Goes through one signal, as far as it is known and before `limit`.
pub(crate) fn one_by_one(
    feed: &mut PieceFeed,
    limit: Nanos,
    mut each: impl FnMut(Nanos, Robustness),
) -> Nanos {
    let known = feed.known.min(limit);
    while feed.next_start() < known {
        let time = feed.next_start();
        feed.take();
        each(time, feed.current);
    }
    feed.trim();
    known
}
