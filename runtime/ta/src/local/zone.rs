//! Local zones: sets of local valuations, kept as difference bound matrices without a zero.
//!
//! A local valuation (Bengtsson, Jonsson, Lilius, Yi, CONCUR 1998) gives each process `p` a time `t_p` of its own and each
//! clock `x` the time `x~` of its last reset on the time of its owner; the clock's value is `t_owner - x~`. The variables
//! of a zone are the times of the processes, then the time stamps of the clocks.
//!
//! All operations keep the matrix canonical, and none closes it from scratch: what a transition adds are bounds on one new
//! variable, the common time of those that meet, so that a row, a column and one pass over the matrix suffice.

use crate::zone::extrapolation::{LuBounds, NONE};

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

/// The same, of bounds that are none as twice [`INF`], and in no sum come near it.
fn sum(a: LocalZoneBound, b: LocalZoneBound) -> LocalZoneBound {
    a + b - ((a | b) & 1)
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

/// Bounds that are worked on at once: rows are padded to whole ones, so that all of a row is instructions on vectors.
const LANES: usize = 4;

/// A row, by lanes.
fn lanes(row: &[LocalZoneBound]) -> &[[LocalZoneBound; LANES]] {
    row.as_chunks().0
}

fn lanes_mut(row: &mut [LocalZoneBound]) -> &mut [[LocalZoneBound; LANES]] {
    row.as_chunks_mut().0
}

/// A canonical set of local valuations that is not empty.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct LocalZone {
    processes: usize,
    n: usize,
    /// The length of a row, with its padding, which has no bounds.
    stride: usize,
    /// Row by row: the bound on `row - column`.
    d: Vec<LocalZoneBound>,
}

/// The bounds on the common time of processes that meet.
#[derive(Default)]
pub(crate) struct MeetingBounds {
    /// On `time - variable`, padded as rows of zones are.
    row: Vec<LocalZoneBound>,
    /// On `variable - time`.
    col: Vec<LocalZoneBound>,
    /// Some valuation of the zone does not meet.
    narrows: bool,
}

impl LocalZone {
    /// All times and time stamps are zero.
    pub(crate) fn start(processes: usize, clocks: usize) -> Self {
        let n = processes + clocks;
        let stride = n.next_multiple_of(LANES);
        let mut d = vec![INF; n * stride];
        for row in d.chunks_exact_mut(stride.max(1)) {
            row[..n].fill(ZERO);
        }
        Self { processes, n, stride, d }
    }

    /// With its padding.
    fn row(&self, i: usize) -> &[LocalZoneBound] {
        &self.d[i * self.stride..][..self.stride]
    }

    fn row_mut(&mut self, i: usize) -> &mut [LocalZoneBound] {
        &mut self.d[i * self.stride..][..self.stride]
    }

    fn rows(&self) -> impl Iterator<Item = &[LocalZoneBound]> {
        self.d.chunks_exact(self.stride.max(1))
    }

    /// Whether the bound, on a clock of this process, holds anywhere.
    pub(crate) fn meets(&self, b: ClockBound, owner: u16) -> bool {
        let (k, p) = (self.processes + usize::from(b.clock), usize::from(owner));
        let other = if b.upper { self.row(k)[p] } else { self.row(p)[k] };
        plus(other, b.bound) >= ZERO
    }

    /// All bounds, row by row, with the padding.
    pub(crate) fn bounds(&self) -> &[LocalZoneBound] {
        &self.d
    }

    pub(crate) fn bounds_mut(&mut self) -> &mut [LocalZoneBound] {
        &mut self.d
    }

    /// Becomes `from`, restricted to where the meeting's processes have one time and its clock bounds hold.
    ///
    /// INVARIANT: `from` is canonical, so a shortest path that is new leads through the common time once.
    pub(crate) fn restrict(&mut self, from: &LocalZone, meeting: &MeetingBounds) {
        (self.processes, self.n, self.stride) = (from.processes, from.n, from.stride);
        if !meeting.narrows {
            self.d.clone_from(&from.d);
            return;
        }
        self.d.resize(from.d.len(), INF);
        let rows = self.d.chunks_exact_mut(from.stride.max(1)).zip(from.rows());
        for ((new, old), &c) in rows.zip(&meeting.col) {
            if c >= INF {
                new.copy_from_slice(old);
                continue;
            }
            lesser_sums(new, old, c, &meeting.row);
        }
    }

    /// Sets clocks at the time of process `now`, all at once.
    pub(crate) fn assign(&mut self, sets: &[ClockAssignment], now: usize) {
        if sets.iter().any(|s| s.from.is_some()) {
            return self.copy(sets, now);
        }
        let (n, stride) = (self.n, self.stride);
        for s in sets {
            let k = self.processes + usize::from(s.clock);
            // `≤ -by`
            let back = 2 - s.by;
            self.d.copy_within(now * stride..(now + 1) * stride, k * stride);
            if s.by == ZERO {
                for row in self.d.chunks_exact_mut(stride) {
                    row[k] = row[now];
                }
            } else {
                for to in &mut self.row_mut(k)[..n] {
                    *to = plus(*to, back);
                }
                for row in self.d.chunks_exact_mut(stride) {
                    row[k] = plus(row[now], s.by);
                }
            }
            self.row_mut(k)[k] = ZERO;
        }
    }

    /// As [`assign`](Self::assign), where clocks become others.
    fn copy(&mut self, sets: &[ClockAssignment], now: usize) {
        let (n, p, stride, old) = (self.n, self.processes, self.stride, self.d.clone());
        // Each variable after it is one before it, less a number.
        let mut from: Vec<(usize, LocalZoneBound)> = (0..n).map(|i| (i, ZERO)).collect();
        for s in sets {
            let source = s.from.map_or(now, |y| p + usize::from(y));
            from[p + usize::from(s.clock)] = (source, s.by);
        }
        for (i, &(a, less)) in from.iter().enumerate() {
            for (j, &(b, more)) in from.iter().enumerate() {
                self.d[i * stride + j] = plus(plus(old[a * stride + b], 2 - less), more);
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
            self.row_mut(k).fill(INF);
            let stride = self.stride;
            for row in self.d.chunks_exact_mut(stride) {
                row[k] = INF;
            }
            self.row_mut(k)[k] = ZERO;
        }
    }

    /// The process's time passes, as far as the upper bounds on its own clocks let it.
    ///
    /// INVARIANT: they hold already, so that they bound nothing but this time.
    pub(crate) fn elapse(&mut self, process: usize, invariant: &[ClockBound]) {
        let stride = self.stride;
        // A clock's row lies behind those of all processes.
        let (before, clocks) = self.d.split_at_mut(self.processes * stride);
        let time = &mut before[process * stride..][..stride];
        time.fill(INF);
        for b in invariant.iter().filter(|b| b.upper) {
            relax(time, b.bound, &clocks[usize::from(b.clock) * stride..][..stride]);
        }
        time[process] = ZERO;
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
        let (p, dim) = (self.processes, clocks.len() + 1);
        let whole = clocks.len() == self.n - p;
        out.clear();
        out.resize(dim * dim, INF);
        let mut rows = out.chunks_exact_mut(dim);
        let times = &meeting.row[p..self.n];
        if let Some(zero) = rows.next() {
            zero[0] = ZERO;
            for (to, &x) in zero[1..].iter_mut().zip(clocks) {
                *to = times[usize::from(x)].min(INF);
            }
        }
        for ((to, &x), &c) in rows.zip(clocks).zip(&meeting.col) {
            to[0] = c;
            let (to, row) = (&mut to[1..], &self.row(p + usize::from(x))[p..self.n]);
            let each = to.iter_mut().zip(clocks.iter().map(|&y| usize::from(y)));
            match (whole, c < INF) {
                (true, true) => lesser_sums(to, row, c, times),
                (false, true) => each.for_each(|(to, y)| *to = row[y].min(sum(c, times[y]))),
                // Where `c` is no bound, the sum is none, either.
                (true, false) => to.copy_from_slice(row),
                (false, false) => each.for_each(|(to, y)| *to = row[y]),
            }
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
        self.narrows = processes.len() > 1;
        for b in bounds {
            self.narrows |= self.bound(zone, *b);
        }
        if bounds.iter().any(|b| self.is_cyclic(zone.processes + usize::from(b.clock))) {
            return Ok(false);
        }
        self.finish()?;
        Ok(true)
    }

    fn gather(&mut self, zone: &LocalZone, processes: impl Iterator<Item = usize> + Clone) -> bool {
        let mut others = processes.clone();
        let first = others.next().unwrap_or(0);
        self.row.clear();
        self.row.extend_from_slice(zone.row(first));
        for p in others.clone() {
            lower(&mut self.row, zone.row(p));
        }
        if processes.clone().any(|p| self.row[p] < ZERO) {
            return false;
        }
        self.col.clear();
        self.col.extend(zone.rows().map(|row| others.clone().fold(row[first], |least, p| row[p].min(least))));
        true
    }

    /// As [`gather`](Self::gather) of all processes, but the columns of these clocks only.
    fn gather_all(&mut self, zone: &LocalZone, clocks: &[u16]) -> bool {
        let p = zone.processes;
        self.row.clear();
        self.row.resize(zone.stride, INF);
        let times = &zone.d[..p * zone.stride];
        for (lane, to) in lanes_mut(&mut self.row).iter_mut().enumerate() {
            let rows = times.chunks_exact(zone.stride).map(|row| &lanes(row)[lane]);
            *to = rows.fold(*to, |to, row| std::array::from_fn(|l| to[l].min(row[l])));
        }
        if self.row[..p].iter().any(|&b| b < ZERO) {
            return false;
        }
        self.col.clear();
        let least = |row: &[LocalZoneBound]| row[..p].iter().fold(INF, |least, &b| b.min(least));
        self.col.extend(clocks.iter().map(|&x| least(zone.row(p + usize::from(x)))));
        true
    }

    /// Whether the bound is tighter than what was known.
    fn bound(&mut self, zone: &LocalZone, b: ClockBound) -> bool {
        let k = zone.processes + usize::from(b.clock);
        let tighter = b.bound < if b.upper { self.row[k] } else { self.col[k] };
        if tighter && b.upper {
            relax(&mut self.row, b.bound, zone.row(k));
        } else if tighter {
            for (at, row) in self.col.iter_mut().zip(zone.rows()) {
                *at = plus(row[k], b.bound).min(*at);
            }
        }
        tighter
    }

    /// Whether the bounds on the time and one variable contradict each other. A bound that is new is part of any new
    /// contradiction, so it is enough to ask for its variable.
    fn is_cyclic(&self, variable: usize) -> bool {
        plus(self.row[variable], self.col[variable]) < ZERO
    }

    /// Makes the bounds ready to be added without looking for [`INF`] in rows.
    fn finish(&mut self) -> Result<(), BoundOverflowError> {
        // Whether it is out of bounds: as long as it is below both ends, as a number without a sign.
        let far = |at: LocalZoneBound| (at < INF) & ((at + MOST) as u32 > 2 * MOST as u32);
        let mut any = self.col.iter().fold(false, |any, &at| any | far(at));
        for row in lanes_mut(&mut self.row) {
            any |= row.iter().fold(false, |any, &at| any | far(at));
            *row = row.map(|at| if at < INF { at } else { 2 * INF });
        }
        if any { Err(BoundOverflowError) } else { Ok(()) }
    }
}

/// Each bound becomes the lesser of the two.
fn lower(row: &mut [LocalZoneBound], other: &[LocalZoneBound]) {
    for (to, other) in lanes_mut(row).iter_mut().zip(lanes(other)) {
        *to = std::array::from_fn(|l| to[l].min(other[l]));
    }
}

/// Each bound becomes the lesser of the old one and the [`sum`] of `bound` and that of `through`.
fn lesser_sums(
    to: &mut [LocalZoneBound],
    old: &[LocalZoneBound],
    bound: LocalZoneBound,
    through: &[LocalZoneBound],
) {
    let rest = to.len() / LANES * LANES;
    let others = lanes(old).iter().zip(lanes(through));
    for (to, (old, through)) in lanes_mut(to).iter_mut().zip(others) {
        *to = std::array::from_fn(|l| old[l].min(sum(bound, through[l])));
    }
    for ((to, &old), &through) in to[rest..].iter_mut().zip(&old[rest..]).zip(&through[rest..]) {
        *to = old.min(sum(bound, through));
    }
}

/// Each bound becomes the lesser of it and the sum of `bound` and that of `through`.
fn relax(row: &mut [LocalZoneBound], bound: LocalZoneBound, through: &[LocalZoneBound]) {
    for (to, through) in lanes_mut(row).iter_mut().zip(lanes(through)) {
        *to = std::array::from_fn(|l| to[l].min(plus(bound, through[l])));
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

impl LocalLuBounds {
    /// The clock is never compared before it is set.
    pub(crate) const NEVER: Self = Self { lower: INF, upper: INF };

    /// `None`: a number is too large.
    pub(crate) fn of(lu: LuBounds) -> Option<Self> {
        let lower = if lu.lower == NONE { Some(INF) } else { lt(-lu.lower) };
        let upper = if lu.upper == NONE { Some(INF) } else { le(-lu.upper) };
        Some(Self { lower: lower?, upper: upper? })
    }

    /// Of a clock that both are known of: the greater numbers are the lesser bounds.
    pub(crate) fn join(self, other: Self) -> Self {
        Self { lower: self.lower.min(other.lower), upper: self.upper.min(other.upper) }
    }
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
