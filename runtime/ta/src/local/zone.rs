//! Local zones: sets of local valuations, kept as difference bound matrices without a zero.
//!
//! A local valuation (Bengtsson, Jonsson, Lilius, Yi, CONCUR 1998) gives each process `p` a time `t_p` of its own and each
//! clock `x` the time `x~` of its last reset on the time of its owner; the clock's value is `t_owner - x~`. The variables
//! of a zone are the times of the processes, then the time stamps of the clocks.
//!
//! All operations keep the matrix canonical, and none closes it from scratch: what a transition adds are bounds on one new
//! variable, the common time of those that meet, so that a row, a column and one pass over the matrix suffice.

/// A bound `< c` (as `2c`) or `≤ c` (as `2c + 1`), or [`INF`].
pub(crate) type LocalZoneBound = i32;

/// No bound.
pub(crate) const INF: LocalZoneBound = 1 << 29;
/// `≤ 0`
pub(crate) const ZERO: LocalZoneBound = 1;
/// Finite bounds of times that meet must stay within this, so that no sum of two comes near [`INF`].
const MOST: LocalZoneBound = 1 << 27;

/// `≤ c`; `None`: the number is too large.
pub(crate) fn le(c: i64) -> Option<LocalZoneBound> {
    i32::try_from(c).ok().filter(|c| c.unsigned_abs() < 1 << 25).map(|c| 2 * c + 1)
}

/// `< c`; `None`: the number is too large.
pub(crate) fn lt(c: i64) -> Option<LocalZoneBound> {
    le(c).map(|b| b - 1)
}

/// The bound of a sum of two bounded differences.
pub(crate) fn plus(a: LocalZoneBound, b: LocalZoneBound) -> LocalZoneBound {
    if a >= INF || b >= INF { INF } else { a + b - ((a | b) & 1) }
}

/// A bound on a clock's value: `x ≺ bound`, or from below `-x ≺ bound`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ClockBound {
    /// The clock, from 0.
    pub clock: u16,
    pub upper: bool,
    pub bound: LocalZoneBound,
}

/// A clock becomes another's value, or zero, plus a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ClockAssignment {
    /// The clock, from 0.
    pub clock: u16,
    pub from: Option<u16>,
    /// `≤` the number.
    pub by: LocalZoneBound,
}

/// The numbers of a path have grown too large for the matrices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BoundOverflowError;

/// A canonical set of local valuations that is not empty.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct LocalZone {
    processes: usize,
    n: usize,
    /// Row by row: the bound on `row - column`.
    d: Vec<LocalZoneBound>,
}

/// The bounds on the common time of processes that meet.
#[derive(Default)]
pub(crate) struct MeetingBounds {
    /// On `time - variable`.
    row: Vec<LocalZoneBound>,
    /// On `variable - time`.
    col: Vec<LocalZoneBound>,
}

impl LocalZone {
    /// All times and time stamps are zero.
    pub(crate) fn start(processes: usize, clocks: usize) -> Self {
        let n = processes + clocks;
        Self { processes, n, d: vec![ZERO; n * n] }
    }

    fn row(&self, i: usize) -> &[LocalZoneBound] {
        &self.d[i * self.n..(i + 1) * self.n]
    }

    /// Whether the bound, on a clock of this process, holds anywhere.
    pub(crate) fn meets(&self, b: ClockBound, owner: u16) -> bool {
        let (k, p) = (self.processes + usize::from(b.clock), usize::from(owner));
        let other = if b.upper { self.d[k * self.n + p] } else { self.d[p * self.n + k] };
        plus(other, b.bound) >= ZERO
    }

    pub(crate) fn heap_bytes(&self) -> usize {
        size_of_val(self.d.as_slice())
    }

    /// Becomes `from`, restricted to where the meeting's processes have one time and its clock bounds hold.
    ///
    /// INVARIANT: `from` is canonical, so a shortest path that is new leads through the common time once.
    pub(crate) fn restrict(&mut self, from: &LocalZone, meeting: &MeetingBounds) {
        let n = from.n;
        (self.processes, self.n) = (from.processes, n);
        self.d.resize(n * n, INF);
        let row = &meeting.row;
        for i in 0..n {
            let (old, new) = (&from.d[i * n..(i + 1) * n], &mut self.d[i * n..(i + 1) * n]);
            let c = meeting.col[i];
            if c >= INF {
                new.copy_from_slice(old);
                continue;
            }
            for ((new, &old), &r) in new.iter_mut().zip(old).zip(row) {
                *new = old.min(c + r - ((c | r) & 1));
            }
        }
    }

    /// Sets clocks at the time of process `now`, all at once.
    pub(crate) fn assign(&mut self, sets: &[ClockAssignment], now: usize) {
        if sets.iter().any(|s| s.from.is_some()) {
            return self.copy(sets, now);
        }
        let n = self.n;
        for s in sets {
            let k = self.processes + usize::from(s.clock);
            // `≤ -by`
            let back = 2 - s.by;
            for i in 0..n {
                self.d[k * n + i] = plus(self.d[now * n + i], back);
                self.d[i * n + k] = plus(self.d[i * n + now], s.by);
            }
            self.d[k * n + k] = ZERO;
        }
    }

    /// As [`assign`](Self::assign), where clocks become others.
    fn copy(&mut self, sets: &[ClockAssignment], now: usize) {
        let (n, p, old) = (self.n, self.processes, self.d.clone());
        // Each variable after it is one before it, less a number.
        let mut from: Vec<(usize, LocalZoneBound)> = (0..n).map(|i| (i, ZERO)).collect();
        for s in sets {
            let source = s.from.map_or(now, |y| p + usize::from(y));
            from[p + usize::from(s.clock)] = (source, s.by);
        }
        for (i, &(a, less)) in from.iter().enumerate() {
            for (j, &(b, more)) in from.iter().enumerate() {
                self.d[i * n + j] = plus(plus(old[a * n + b], 2 - less), more);
            }
        }
    }

    /// Forgets the clocks that are not in `keep`, which is in order.
    pub(crate) fn forget(&mut self, keep: &[u16]) {
        let (p, n) = (self.processes, self.n);
        let mut keep = keep.iter().copied().peekable();
        for k in p..n {
            if keep.next_if(|&c| usize::from(c) + p == k).is_some() {
                continue;
            }
            // A clock that is known was set before now, by somebody's time.
            if self.row(k)[..p].iter().all(|&b| b >= INF) {
                continue;
            }
            self.d[k * n..(k + 1) * n].fill(INF);
            for i in 0..n {
                self.d[i * n + k] = INF;
            }
            self.d[k * n + k] = ZERO;
        }
    }

    /// The process's time passes, as far as the upper bounds on its own clocks let it.
    ///
    /// INVARIANT: they hold already, so that they bound nothing but this time.
    pub(crate) fn elapse(&mut self, process: usize, invariant: &[ClockBound]) {
        let n = self.n;
        self.d[process * n..(process + 1) * n].fill(INF);
        for b in invariant.iter().filter(|b| b.upper) {
            let k = self.processes + usize::from(b.clock);
            for j in 0..n {
                let via = plus(b.bound, self.d[k * n + j]);
                let at = &mut self.d[process * n + j];
                *at = via.min(*at);
            }
        }
        self.d[process * n + process] = ZERO;
    }

    /// The valuations in which all processes have the same time, as a zone of the values of `clocks`: `x_j - x_i ≺
    /// out[i][j]`, with these clocks from 1 and zero as 0. `false`: there are none.
    pub(crate) fn synchronised(
        &self,
        clocks: &[u16],
        meeting: &mut MeetingBounds,
        out: &mut Vec<LocalZoneBound>,
    ) -> Result<bool, BoundOverflowError> {
        if !meeting.gather_all(self, clocks) {
            return Ok(false);
        }
        meeting.finish()?;
        let p = self.processes;
        out.clear();
        out.push(ZERO);
        out.extend(clocks.iter().map(|&x| meeting.row[p + usize::from(x)].min(INF)));
        let whole = clocks.len() == self.n - p;
        for (&x, &c) in clocks.iter().zip(&meeting.col) {
            out.push(c);
            let row = self.row(p + usize::from(x));
            if whole && c < INF {
                let sums = row[p..].iter().zip(&meeting.row[p..]);
                // No bound of the meeting is one that no sum comes near: see `finish`.
                out.extend(sums.map(|(&old, &r)| old.min(c + r - ((c | r) & 1))));
                continue;
            }
            // INVARIANT: if `c` is no bound, the sum is none, either.
            out.extend(clocks.iter().map(|&y| {
                let (old, r) = (row[p + usize::from(y)], meeting.row[p + usize::from(y)]);
                old.min(plus(c, r))
            }));
        }
        Ok(true)
    }
}

impl MeetingBounds {
    /// Restricts the times of `processes`, at least one, to a common one, at which the clock bounds hold. Clocks must be
    /// those of these processes. `false`: there is no such time.
    pub(crate) fn of(
        &mut self,
        zone: &LocalZone,
        processes: &[u16],
        bounds: &[ClockBound],
    ) -> Result<bool, BoundOverflowError> {
        if !self.gather(zone, processes.iter().map(|&p| usize::from(p))) {
            return Ok(false);
        }
        for b in bounds {
            self.bound(zone, *b);
        }
        if bounds.iter().any(|b| self.is_cyclic(zone.processes + usize::from(b.clock))) {
            return Ok(false);
        }
        self.finish()?;
        Ok(true)
    }

    fn gather(&mut self, zone: &LocalZone, processes: impl Iterator<Item = usize> + Clone) -> bool {
        let n = zone.n;
        self.row.clear();
        self.row.resize(n, INF);
        self.col.clear();
        self.col.resize(n, INF);
        for p in processes.clone() {
            for (at, &b) in self.row.iter_mut().zip(zone.row(p)) {
                *at = b.min(*at);
            }
        }
        if processes.clone().any(|p| self.row[p] < ZERO) {
            return false;
        }
        for (i, at) in self.col.iter_mut().enumerate() {
            let row = zone.row(i);
            for p in processes.clone() {
                *at = row[p].min(*at);
            }
        }
        true
    }

    /// As [`gather`](Self::gather) of all processes, but the columns of these clocks only.
    fn gather_all(&mut self, zone: &LocalZone, clocks: &[u16]) -> bool {
        let (p, n) = (zone.processes, zone.n);
        self.row.clear();
        self.row.resize(n, INF);
        for row in zone.d[..p * n].chunks_exact(n) {
            for (at, &b) in self.row.iter_mut().zip(row) {
                *at = b.min(*at);
            }
        }
        if self.row[..p].iter().any(|&b| b < ZERO) {
            return false;
        }
        self.col.clear();
        let least = |row: &[LocalZoneBound]| row[..p].iter().fold(INF, |least, &b| b.min(least));
        self.col.extend(clocks.iter().map(|&x| least(zone.row(p + usize::from(x)))));
        true
    }

    fn bound(&mut self, zone: &LocalZone, b: ClockBound) {
        let k = zone.processes + usize::from(b.clock);
        if b.upper && b.bound < self.row[k] {
            for (at, &more) in self.row.iter_mut().zip(zone.row(k)) {
                *at = plus(b.bound, more).min(*at);
            }
        } else if !b.upper && b.bound < self.col[k] {
            for (i, at) in self.col.iter_mut().enumerate() {
                *at = plus(zone.d[i * zone.n + k], b.bound).min(*at);
            }
        }
    }

    /// Whether the bounds on the time and one variable contradict each other. A bound that is new is part of any new
    /// contradiction, so it is enough to ask for its variable.
    fn is_cyclic(&self, variable: usize) -> bool {
        plus(self.row[variable], self.col[variable]) < ZERO
    }

    /// Makes the bounds ready to be added without looking for [`INF`] in rows.
    fn finish(&mut self) -> Result<(), BoundOverflowError> {
        let mut most = 0;
        for at in &mut self.row {
            let there = *at < INF;
            most = most.max(if there { at.abs() } else { 0 });
            *at = if there { *at } else { 2 * INF };
        }
        for &at in &self.col {
            most = most.max(if at < INF { at.abs() } else { 0 });
        }
        if most > MOST { Err(BoundOverflowError) } else { Ok(()) }
    }
}

/// The greatest constants that a clock is compared with, encoded as bounds, for the abstraction aLU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct LocalLuBounds {
    /// `< -L`; without a lower bound, [`INF`].
    pub lower: LocalZoneBound,
    /// `≤ -U`; without an upper bound, [`INF`].
    pub upper: LocalZoneBound,
}

/// Whether each valuation of the synchronised zone `a` is simulated by one of `b`: `a ⊆ aLU(b)`.
///
/// Theorem of Herbreteau, Srivathsan and Walukiewicz, "Better abstractions for timed automata" (LICS 2012): it is not so
/// iff for some x and y, `a_x0 ≥ (≤, -U_x)`, `b_xy < a_xy` and `b_xy + (<, -L_y) < a_x0`, where `z_xy` bounds `y - x`.
pub(crate) fn is_simulated(a: &[LocalZoneBound], b: &[LocalZoneBound], lu: &[LocalLuBounds]) -> bool {
    let dim = lu.len() + 1;
    for x in 0..dim {
        let low = a[x * dim];
        if x > 0 && low < lu[x - 1].upper {
            continue;
        }
        let rows = a[x * dim..(x + 1) * dim].iter().zip(&b[x * dim..(x + 1) * dim]);
        for (y, (&a_xy, &b_xy)) in rows.enumerate() {
            // Of zero, L is 0.
            let lower = if y == 0 { 0 } else { lu[y - 1].lower };
            if b_xy < a_xy && plus(b_xy, lower) < low {
                return false;
            }
        }
    }
    true
}

#[cfg(test)]
mod tests;
