//! Difference bound matrices: conjunctions of bounds on differences of clocks.
//!
//! After Dill (1989) and Bengtsson and Yi, "Timed Automata: Semantics, Algorithms and Tools" (2004). Clock 0 is the
//! reference, which is always zero.

use smallvec::SmallVec;

pub use super::bound::{DbmBound, DbmNumber};

/// A set of clock valuations, given by `x_i - x_j ≺ m[i][j]` for all `i`, `j`.
///
/// Rows are padded to whole lanes; the padding has no bounds.
///
/// INVARIANT: canonical (each entry is the tightest that follows from all), unless the set is empty; then the first
/// entry is less than `≤ 0`.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Dbm<N = i64> {
    dim: usize,
    stride: usize,
    m: Vec<N>,
}

/// Upper bounds of clocks, which a zone takes all at once.
#[derive(Clone, Debug)]
pub(crate) struct ClockUpperBounds<N> {
    each: Vec<(usize, N)>,
    /// By clock, padded as rows are: the addends of the bounds, if there are so many that going through whole rows is quicker.
    base: Vec<N>,
    mask: Vec<N>,
}

impl<N: DbmNumber> ClockUpperBounds<N> {
    pub(crate) fn new() -> Self {
        Self { each: Vec::new(), base: Vec::new(), mask: Vec::new() }
    }

    /// Becomes these bounds of clocks of a zone with `dim` clocks.
    pub(crate) fn set(&mut self, dim: usize, bounds: impl Iterator<Item = (usize, N)>) {
        self.each.clear();
        self.each.extend(bounds);
        let stride = padded::<N>(dim);
        self.base.clear();
        self.mask.clear();
        if self.each.len() * N::LANES <= 2 * stride {
            return;
        }
        self.base.resize(stride, N::INFINITY);
        for &(clock, bound) in &self.each {
            self.base[clock] = bound.min(self.base[clock]);
        }
        self.mask.extend(self.base.iter_mut().map(|base| {
            let (addend, mask) = base.addend();
            *base = addend;
            mask
        }));
    }

    /// The bound of the clock of this row that follows from those of others; no bound if none does.
    #[inline]
    fn through(&self, row: &[N]) -> N {
        if self.base.is_empty() {
            self.each.iter().map(|&(j, b)| row[j].plus(b)).min().unwrap_or(N::INFINITY)
        } else {
            N::least_sum(row, &self.base, &self.mask)
        }
    }
}

/// The length of a row with its padding.
fn padded<N: DbmNumber>(dim: usize) -> usize {
    dim.div_ceil(N::LANES) * N::LANES
}

/// A row, copied.
type DbmRow<N> = SmallVec<[N; 32]>;

impl<N: DbmNumber> Dbm<N> {
    /// All clocks are zero. `dim` counts the reference clock.
    #[must_use]
    pub fn zero(dim: usize) -> Self {
        let mut all = Self { dim: 0, stride: 0, m: Vec::new() };
        all.resize(dim);
        for i in 0..dim {
            let row = i * all.stride;
            all.m[row..row + dim].fill(N::LE_ZERO);
        }
        all
    }

    /// All valuations without negative clocks.
    #[must_use]
    pub fn universe(dim: usize) -> Self {
        let mut all = Self { dim: 0, stride: 0, m: Vec::new() };
        all.resize(dim);
        for i in 0..dim {
            all.put(i, i, DbmBound::LE_ZERO);
            all.put(0, i, DbmBound::LE_ZERO);
        }
        all
    }

    /// Makes room for so many clocks; the entries are without bounds afterwards.
    pub(crate) fn resize(&mut self, dim: usize) {
        self.dim = dim;
        self.stride = padded::<N>(dim);
        self.m.clear();
        self.m.resize(self.stride * dim, N::INFINITY);
    }

    /// The number of clocks, the reference included.
    #[must_use]
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// The bound of `x_i - x_j`.
    #[must_use]
    pub fn at(&self, i: usize, j: usize) -> DbmBound {
        self.entry(i, j).bound()
    }

    #[inline]
    pub(crate) fn entry(&self, i: usize, j: usize) -> N {
        self.m[i * self.stride + j]
    }

    pub(crate) fn row(&self, i: usize) -> &[N] {
        &self.m[i * self.stride..i * self.stride + self.dim]
    }

    /// With the padding.
    pub(crate) fn row_mut(&mut self, i: usize) -> &mut [N] {
        &mut self.m[i * self.stride..(i + 1) * self.stride]
    }

    fn copied(&self, i: usize) -> DbmRow<N> {
        SmallVec::from_slice(&self.m[i * self.stride..(i + 1) * self.stride])
    }

    /// Sets one entry, whatever it was; [`close`](Self::close) must follow before anything else.
    pub(crate) fn put(&mut self, i: usize, j: usize, b: DbmBound) {
        self.set(i, j, N::of(b));
    }

    pub(crate) fn set(&mut self, i: usize, j: usize, n: N) {
        self.m[i * self.stride + j] = n;
    }

    /// Becomes a copy, without allocation if there is room.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.dim = other.dim;
        self.stride = other.stride;
        self.m.clear();
        self.m.extend_from_slice(&other.m);
    }

    /// The entries row by row, without padding.
    pub(crate) fn store(&self, out: &mut Vec<N>) {
        for i in 0..self.dim {
            out.extend_from_slice(self.row(i));
        }
    }

    /// From entries as [`store`](Self::store) gives them.
    pub(crate) fn load(&mut self, dim: usize, flat: &[N]) {
        self.resize(dim);
        let stride = self.stride;
        for (row, from) in self.m.chunks_exact_mut(stride.max(1)).zip(flat.chunks_exact(dim.max(1))) {
            row[..dim].copy_from_slice(from);
        }
    }

    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.m[0] < N::LE_ZERO
    }

    pub(crate) fn make_empty(&mut self) {
        self.m[0] = N::of(DbmBound::LT_ZERO);
    }

    /// The bytes it takes on the heap.
    #[must_use]
    pub fn heap_bytes(&self) -> usize {
        size_of_val(&*self.m)
    }

    /// Makes it canonical (Floyd, Warshall). Returns whether it is not empty.
    pub fn close(&mut self) -> bool {
        let stride = self.stride.max(1);
        for k in 0..self.dim {
            // No path leads on from a clock whose row has its own entry only; one that is less than zero makes the set empty.
            let row = self.row(k);
            if row[k] >= N::LE_ZERO && row.iter().filter(|&&b| b != N::INFINITY).count() <= 1 {
                continue;
            }
            let through = self.copied(k);
            let mut negative = false;
            for (i, row) in self.m.chunks_exact_mut(stride).enumerate() {
                let to = row[k];
                if to != N::INFINITY {
                    N::relax(row, to, &through);
                    negative |= row[i] < N::LE_ZERO;
                }
            }
            if negative {
                self.make_empty();
                return false;
            }
        }
        true
    }

    /// Whether some valuation keeps `x_i - x_j ≺ b`.
    #[must_use]
    pub fn meets(&self, i: usize, j: usize, b: DbmBound) -> bool {
        N::of(b).plus(self.entry(j, i)) >= N::LE_ZERO
    }

    /// Adds `x_i - x_j ≺ b` and closes again, in quadratic time. Returns whether it is not empty.
    pub fn constrain(&mut self, i: usize, j: usize, b: DbmBound) -> bool {
        if self.is_empty() {
            return false;
        }
        let b = N::of(b);
        if b >= self.entry(i, j) {
            return true;
        }
        if b.plus(self.entry(j, i)) < N::LE_ZERO {
            self.make_empty();
            return false;
        }
        self.set(i, j, b);
        let through = self.copied(j);
        let stride = self.stride.max(1);
        for row in self.m.chunks_exact_mut(stride) {
            let to = row[i];
            if to != N::INFINITY {
                N::relax(row, to.plus(b), &through);
            }
        }
        true
    }

    /// Adds upper bounds of several clocks at once, and closes again. Returns whether it is not empty.
    ///
    /// INVARIANT: a shortest path uses one bound `x_j ≺ b` at most, since all of them end at the reference clock.
    pub(crate) fn constrain_above(&mut self, bounds: &ClockUpperBounds<N>) -> bool {
        if self.is_empty() {
            return false;
        }
        if bounds.each.iter().all(|&(j, b)| self.entry(j, 0) <= b) {
            return true;
        }
        if bounds.each.iter().any(|&(j, b)| b.plus(self.entry(0, j)) < N::LE_ZERO) {
            self.make_empty();
            return false;
        }
        let through = self.copied(0);
        let stride = self.stride.max(1);
        for row in self.m.chunks_exact_mut(stride) {
            let new = bounds.through(row);
            if new < row[0] {
                N::relax(row, new, &through);
            }
        }
        true
    }

    /// Lets time pass as far as upper bounds of clocks let it, which hold already.
    ///
    /// INVARIANT: the bounds that new upper bounds of clocks would tighten are those of before, and these were as tight.
    pub(crate) fn up_within(&mut self, bounds: &ClockUpperBounds<N>) {
        if self.is_empty() {
            return;
        }
        let stride = self.stride.max(1);
        for row in self.m.chunks_exact_mut(stride).skip(1) {
            row[0] = bounds.through(row);
        }
    }

    /// Lets any time pass.
    pub fn up(&mut self) {
        if self.is_empty() {
            return;
        }
        for i in 1..self.dim {
            self.set(i, 0, N::INFINITY);
        }
    }

    /// Lets any time pass, in which these clocks stand still: the least zone that has all that it leads to.
    pub fn up_but(&mut self, stopped: &[u16]) {
        if self.is_empty() {
            return;
        }
        let stands = |x: usize| x == 0 || stopped.iter().any(|&s| usize::from(s) == x);
        for i in (1..self.dim).filter(|&i| !stands(i)) {
            for j in (0..self.dim).filter(|&j| stands(j)) {
                self.set(i, j, N::INFINITY);
            }
        }
    }

    /// Sets a clock to zero.
    pub fn reset(&mut self, x: usize) {
        if self.is_empty() {
            return;
        }
        for k in 0..self.dim {
            let (row, column) = (self.entry(0, k), self.entry(k, 0));
            self.set(x, k, row);
            self.set(k, x, column);
        }
        self.set(x, x, N::LE_ZERO);
    }

    /// Becomes a zone of other clocks: clock `k` of it has the value of clock `from[k].0` of `old`, plus `from[k].1`.
    ///
    /// Clock 0 of `old` stands for zero; `from[0]` must be `(0, 0)`.
    pub fn gather(&mut self, old: &Self, from: &[(u16, i64)]) {
        if old.dim == from.len() && self.gather_few(old, from) {
            return;
        }
        self.resize(from.len());
        let shifted = from.iter().any(|f| f.1 != 0);
        for (i, &(x, a)) in from.iter().enumerate() {
            let source = &old.m[usize::from(x) * old.stride..usize::from(x) * old.stride + old.dim];
            let row = &mut self.m[i * self.stride..];
            for (to, &(y, b)) in row.iter_mut().zip(from) {
                let n = source[usize::from(y)];
                *to = if shifted && n != N::INFINITY { n.shifted(a - b) } else { n };
            }
        }
    }

    /// As [`gather`](Self::gather) into as many clocks, where most are what they were; `false`: too few are.
    fn gather_few(&mut self, old: &Self, from: &[(u16, i64)]) -> bool {
        let others = || from.iter().enumerate().filter(|&(k, f)| *f != (k as u16, 0));
        if others().count() * 4 > from.len() {
            return false;
        }
        self.copy_from(old);
        let shifted = |n: N, by: i64| if by != 0 && n != N::INFINITY { n.shifted(by) } else { n };
        for (c, &(x, a)) in others() {
            for (k, &(y, b)) in from.iter().enumerate() {
                self.set(c, k, shifted(old.entry(usize::from(x), usize::from(y)), a - b));
                self.set(k, c, shifted(old.entry(usize::from(y), usize::from(x)), b - a));
            }
        }
        true
    }

    /// Whether each valuation of `other` is one of this.
    #[must_use]
    pub fn includes(&self, other: &Self) -> bool {
        other.is_empty() || (!self.is_empty() && self.m.iter().zip(&other.m).all(|(a, b)| a >= b))
    }

    /// Keeps what both have. Returns whether it is not empty.
    pub fn intersect(&mut self, other: &Self) -> bool {
        if self.is_empty() || other.is_empty() {
            self.make_empty();
            return false;
        }
        for (a, b) in self.m.iter_mut().zip(&other.m) {
            *a = (*a).min(*b);
        }
        self.close()
    }

    /// Whether it has the valuation whose clock `i` is `point[i] / scale`; `point[0]` must be 0.
    #[must_use]
    pub fn contains(&self, point: &[i64], scale: i64) -> bool {
        !self.is_empty()
            && (0..self.dim).all(|i| {
                (0..self.dim).all(|j| {
                    let b = self.at(i, j);
                    let difference = i128::from(point[i]) - i128::from(point[j]);
                    let limit = i128::from(b.value()) * i128::from(scale);
                    b.is_infinite() || difference < limit || (difference == limit && !b.is_strict())
                })
            })
    }
}

/// Whether no entry of the one is less than that of the other: inclusion of zones without padding.
#[must_use]
pub(crate) fn dominates<N: DbmNumber>(greater: &[N], less: &[N]) -> bool {
    // Blocks of a length that is known become instructions on vectors.
    const BLOCK: usize = 32;
    let (a, b) = (greater.chunks_exact(BLOCK), less.chunks_exact(BLOCK));
    let rest = a.remainder().iter().zip(b.remainder());
    let less_somewhere = |bad: bool, (a, b): (&N, &N)| bad | (a < b);
    a.zip(b).all(|(a, b)| !a.iter().zip(b).fold(false, less_somewhere)) && !rest.fold(false, less_somewhere)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const DIM: usize = 4;

    fn bound() -> impl Strategy<Value = DbmBound> {
        prop_oneof![
            2 => Just(DbmBound::INFINITY),
            3 => (-4i64..8).prop_map(DbmBound::le),
            3 => (-4i64..8).prop_map(DbmBound::lt),
        ]
    }

    /// Constraints, in order.
    fn constraints() -> impl Strategy<Value = Vec<(usize, usize, DbmBound)>> {
        prop::collection::vec((0..DIM, 0..DIM, bound()), 0..8)
            .prop_map(|cs| cs.into_iter().filter(|(i, j, _)| i != j).collect())
    }

    fn zone(cs: &[(usize, usize, DbmBound)]) -> Dbm {
        let mut z = Dbm::universe(DIM);
        for &(i, j, b) in cs {
            z.constrain(i, j, b);
        }
        z
    }

    /// A valuation in quarters.
    fn point() -> impl Strategy<Value = Vec<i64>> {
        prop::collection::vec(0i64..36, DIM - 1).prop_map(|mut p| {
            p.insert(0, 0);
            p
        })
    }

    fn keeps(p: &[i64], (i, j, b): (usize, usize, DbmBound)) -> bool {
        let d = p[i] - p[j];
        b.is_infinite() || d < b.value() * 4 || (d == b.value() * 4 && !b.is_strict())
    }

    #[test]
    fn bounds_add_and_negate() {
        assert_eq!(DbmBound::le(2).plus(DbmBound::le(3)), DbmBound::le(5));
        assert_eq!(DbmBound::le(2).plus(DbmBound::lt(3)), DbmBound::lt(5));
        assert_eq!(DbmBound::lt(-2).plus(DbmBound::lt(3)), DbmBound::lt(1));
        assert_eq!(DbmBound::le(2).plus(DbmBound::INFINITY), DbmBound::INFINITY);
        assert_eq!(DbmBound::le(3).negated(), DbmBound::lt(-3));
        assert_eq!(DbmBound::lt(3).negated(), DbmBound::le(-3));
        assert!(DbmBound::lt(3) < DbmBound::le(3) && DbmBound::le(3) < DbmBound::lt(4));
    }

    #[test]
    fn strict_bounds_meet_nowhere() {
        let mut z = Dbm::<i64>::universe(2);
        assert!(z.constrain(1, 0, DbmBound::lt(3)));
        assert!(!z.constrain(0, 1, DbmBound::le(-3)));
        assert!(z.is_empty());
    }

    proptest! {
        #[test]
        fn incremental_closure_is_canonical(cs in constraints()) {
            let z = zone(&cs);
            let mut full = Dbm::universe(DIM);
            for &(i, j, b) in &cs {
                let b = b.min(full.at(i, j));
                full.put(i, j, b);
            }
            let nonempty = full.close();
            prop_assert_eq!(nonempty, !z.is_empty());
            if nonempty {
                prop_assert_eq!(&full, &z);
                let mut again = z.clone();
                again.close();
                prop_assert_eq!(&again, &z);
            }
        }

        #[test]
        fn constraining_filters_points(cs in constraints(), p in point()) {
            let all = cs.iter().all(|&c| keeps(&p, c));
            prop_assert_eq!(zone(&cs).contains(&p, 4), all);
        }

        #[test]
        fn intersection_is_conjunction(a in constraints(), b in constraints(), p in point()) {
            let mut z = zone(&a);
            z.intersect(&zone(&b));
            prop_assert_eq!(z.contains(&p, 4), zone(&a).contains(&p, 4) && zone(&b).contains(&p, 4));
        }

        #[test]
        fn up_holds_what_a_delay_gives(cs in constraints(), p in point()) {
            let z = zone(&cs);
            let mut later = z.clone();
            later.up();
            // Strict bounds in quarters of quarters: a finer grid finds the predecessor if there is one.
            let fine: Vec<i64> = p.iter().map(|v| v * 4).collect();
            let least = fine[1..].iter().copied().min().unwrap_or(0);
            let reached = (0..=least).any(|d| {
                let earlier: Vec<i64> =
                    fine.iter().enumerate().map(|(i, v)| if i == 0 { 0 } else { v - d }).collect();
                z.contains(&earlier, 16)
            });
            prop_assert_eq!(later.contains(&p, 4), reached);
            if !z.is_empty() {
                let mut closed = later.clone();
                closed.close();
                prop_assert_eq!(closed, later);
            }
        }

        #[test]
        fn up_but_holds_what_a_delay_gives(cs in constraints(), p in point(), d in 0i64..20, stopped in 0..DIM) {
            let z = zone(&cs);
            let (mut later, mut all) = (z.clone(), z.clone());
            later.up_but(&[stopped as u16]);
            all.up();
            if stopped == 0 {
                prop_assert_eq!(&later, &all);
            }
            let there: Vec<i64> =
                p.iter().enumerate().map(|(i, v)| if i == 0 || i == stopped { *v } else { v + d }).collect();
            prop_assert!(!z.contains(&p, 4) || later.contains(&there, 4));
            if !z.is_empty() {
                let mut closed = later.clone();
                closed.close();
                prop_assert_eq!(closed, later);
            }
        }

        #[test]
        fn reset_holds_what_a_reset_gives(cs in constraints(), p in point(), x in 1..DIM) {
            let z = zone(&cs);
            let mut after = z.clone();
            after.reset(x);
            let mut there = p.clone();
            there[x] = 0;
            if z.contains(&p, 4) {
                prop_assert!(after.contains(&there, 4));
            }
            // The other way: some value of the clock leads there.
            let fine: Vec<i64> = there.iter().map(|v| v * 4).collect();
            let from = (0..16 * 40).any(|v| {
                let mut q = fine.clone();
                q[x] = v;
                z.contains(&q, 16)
            });
            prop_assert_eq!(after.contains(&there, 4), from);
            prop_assert!(p[x] == 0 || !after.contains(&p, 4));
        }

        #[test]
        fn inclusion_is_a_partial_order(a in constraints(), b in constraints(), c in constraints(), p in point()) {
            let (x, mut y) = (zone(&a), zone(&b));
            prop_assert!(x.includes(&x));
            if x.includes(&y) && y.includes(&x) && !x.is_empty() {
                prop_assert_eq!(&x, &y);
            }
            if x.includes(&y) && y.contains(&p, 4) {
                prop_assert!(x.contains(&p, 4));
            }
            y.intersect(&x);
            prop_assert!(x.includes(&y));
            let mut w = zone(&c);
            w.intersect(&y);
            prop_assert!(y.includes(&w) && x.includes(&w));
        }

        #[test]
        fn narrow_entries_do_as_wide_ones(cs in constraints(), x in 1..DIM, above in prop::collection::vec((1..DIM, -2i64..9), 0..8)) {
            let wide = |z: &Dbm<i64>| (0..DIM).map(|i| (0..DIM).map(|j| z.at(i, j)).collect::<Vec<_>>()).collect::<Vec<_>>();
            let narrow = |z: &Dbm<i16>| (0..DIM).map(|i| (0..DIM).map(|j| z.at(i, j)).collect::<Vec<_>>()).collect::<Vec<_>>();
            let (mut a, mut b) = (Dbm::<i64>::universe(DIM), Dbm::<i16>::universe(DIM));
            for &(i, j, c) in &cs {
                prop_assert_eq!(a.constrain(i, j, c), b.constrain(i, j, c));
            }
            a.reset(x);
            b.reset(x);
            a.up();
            b.up();
            // All at once is as one after the other.
            let mut one = a.clone();
            let each = above.iter().all(|&(j, c)| one.constrain(j, 0, DbmBound::le(c)));
            let (mut wides, mut narrows) = (ClockUpperBounds::<i64>::new(), ClockUpperBounds::<i16>::new());
            wides.set(DIM, above.iter().map(|&(j, c)| (j, i64::of(DbmBound::le(c)))));
            narrows.set(DIM, above.iter().map(|&(j, c)| (j, i16::of(DbmBound::le(c)))));
            let empty = a.is_empty();
            prop_assert_eq!(a.constrain_above(&wides), each && !empty);
            prop_assert_eq!(b.constrain_above(&narrows), each && !empty);
            // And so is time that passes within them.
            let (mut free, mut within) = (a.clone(), a.clone());
            free.up();
            free.constrain_above(&wides);
            within.up_within(&wides);
            prop_assert!(a.is_empty() || free == within);
            prop_assert_eq!(a.is_empty(), b.is_empty());
            if !a.is_empty() {
                prop_assert_eq!(&one, &a);
                prop_assert_eq!(wide(&a), narrow(&b));
                let mut flat = Vec::new();
                b.store(&mut flat);
                let mut back = Dbm::<i16>::zero(1);
                back.load(DIM, &flat);
                prop_assert_eq!(back, b);
            }
        }

        #[test]
        fn gathering_is_to_set_clocks_and_forget_others(cs in constraints(), from in prop::collection::vec((0u16..DIM as u16, 0i64..3), 1..4), p in point()) {
            let z = zone(&cs);
            prop_assume!(!z.is_empty());
            let from: Vec<(u16, i64)> = std::iter::once((0, 0)).chain(from).collect();
            let mut after = Dbm::<i64>::zero(1);
            after.gather(&z, &from);
            // Where most clocks are what they were, another way leads there.
            let mut few: Vec<(u16, i64)> = (0..DIM as u16).map(|k| (k, 0)).collect();
            few[1] = from[1];
            let mut quick = Dbm::<i64>::zero(1);
            quick.gather(&z, &few);
            for (i, &(x, a)) in few.iter().enumerate() {
                for (j, &(y, b)) in few.iter().enumerate() {
                    let (old, by) = (z.at(usize::from(x), usize::from(y)), a - b);
                    let moved = |old: DbmBound| {
                        let to = old.value() + by;
                        if old.is_strict() { DbmBound::lt(to) } else { DbmBound::le(to) }
                    };
                    prop_assert_eq!(quick.at(i, j), if old.is_infinite() { old } else { moved(old) });
                }
            }
            let mut closed = after.clone();
            prop_assert!(closed.close());
            prop_assert_eq!(&closed, &after);
            // What a point becomes is there.
            if z.contains(&p, 4) {
                let image: Vec<i64> = from.iter().map(|&(x, by)| p[usize::from(x)] + 4 * by).collect();
                prop_assert!(after.contains(&image, 4));
            }
            // And each bound is the least: that of the clocks it comes from.
            for (i, &(x, a)) in from.iter().enumerate() {
                for (j, &(y, b)) in from.iter().enumerate() {
                    let old = z.at(usize::from(x), usize::from(y));
                    let new = if old.is_infinite() { old } else { old.plus(DbmBound::le(a - b)) };
                    prop_assert_eq!(after.at(i, j), new);
                }
            }
        }
    }
}
