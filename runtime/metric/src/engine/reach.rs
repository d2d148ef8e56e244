//! `since` and `until` in a window that slides along two signals, in constant time for each piece.
//!
//! What a moment makes of the value of what comes after it (of `since`: before it) is r ↦ max(ψ, min(φ, r)). Such maps are closed under composition,
//! so a window is one of them: the composition of those of its pieces. Two stacks keep it while pieces enter at one end and leave at the
//! other (Tangwongsan, Hirzel, Schneider 2017). A piece is the same map however long it is, since the map is its own square.

use hrdsl_ir::Nanos;

use super::{opening::ShiftedOutput, piece::PieceFeed};
use crate::robustness::Robustness;

/// r ↦ max(low, min(high, r)).
#[derive(Clone, Copy, Debug)]
pub(crate) struct ReachMap {
    pub low: Robustness,
    pub high: Robustness,
}

impl ReachMap {
    pub const IDENTITY: Self = Self { low: Robustness::FALSE, high: Robustness::TRUE };

    /// First the inner, then this one.
    pub fn over(self, inner: Self) -> Self {
        Self { low: self.low.max(self.high.min(inner.low)), high: self.high.min(inner.high) }
    }
}

#[derive(Clone, Copy, Debug)]
struct ReachEntry {
    map: ReachMap,
    /// From when on it is in no window.
    expires: Nanos,
}

/// φ since[0, w] ψ; with a negative shift, φ until[0, w] ψ.
#[derive(Clone, Debug)]
pub(crate) struct SlidingReach {
    /// `None`: from the start.
    width: Option<Nanos>,
    past: bool,
    /// Each with the composition from it to the newest here; the oldest is on top.
    front: Vec<ReachEntry>,
    /// Each alone, in order.
    back: Vec<ReachEntry>,
    /// The composition of those in `back`.
    back_map: ReachMap,
    /// That of the piece that goes on.
    open: Option<ReachMap>,
    output: ShiftedOutput,
}

impl SlidingReach {
    pub fn new(start: Nanos, width: Option<Nanos>, shift: Nanos, past: bool) -> Self {
        Self {
            width,
            past,
            front: Vec::new(),
            back: Vec::new(),
            back_map: ReachMap::IDENTITY,
            open: None,
            output: ShiftedOutput::new(start, shift, Robustness::FALSE),
        }
    }

    /// From `time` on, φ is `high` and ψ is `low` of the map.
    pub fn enter(&mut self, time: Nanos, map: ReachMap, out: &mut PieceFeed) {
        self.leave(time, out);
        let before = self.open.replace(map);
        let Some(width) = self.width else {
            // All pieces so far, as one.
            let all = before.map_or(map, |before| join(self.past, before, map));
            self.open = Some(all);
            return self.output.put(time, all.low, out);
        };
        if let Some(before) = before {
            self.back.push(ReachEntry { map: before, expires: time.saturating_add(width) });
            self.back_map = join(self.past, self.back_map, before);
        }
        while self.oldest() <= time {
            self.pop();
        }
        self.output.put(time, self.value(), out);
    }

    /// All that happens before `known` has been told.
    pub fn known(&mut self, known: Nanos, out: &mut PieceFeed) {
        self.leave(known, out);
        self.output.known(known, out);
    }

    fn value(&self) -> Robustness {
        let front = self.front.last().map_or(ReachMap::IDENTITY, |e| e.map);
        let closed = join(self.past, front, self.back_map);
        self.open.map_or(closed, |open| join(self.past, closed, open)).low
    }

    /// When the oldest piece leaves.
    fn oldest(&self) -> Nanos {
        self.front.last().or(self.back.first()).map_or(Nanos::MAX, |e| e.expires)
    }

    fn leave(&mut self, time: Nanos, out: &mut PieceFeed) {
        while self.oldest() < time {
            let expires = self.oldest();
            self.pop();
            self.output.put(expires, self.value(), out);
        }
    }

    fn pop(&mut self) {
        if self.front.is_empty() {
            let mut map = ReachMap::IDENTITY;
            for entry in self.back.drain(..).rev() {
                map = join(self.past, entry.map, map);
                self.front.push(ReachEntry { map, expires: entry.expires });
            }
            self.back_map = ReachMap::IDENTITY;
        }
        self.front.pop();
    }
}

/// What two stretches are together: of `since` the later one is asked first, of `until` the earlier one.
fn join(past: bool, earlier: ReachMap, later: ReachMap) -> ReachMap {
    if past { later.over(earlier) } else { earlier.over(later) }
}
