//! Extrapolation: makes the number of zones finite without changing which locations can be reached.
//!
//! Without diagonal constraints: ExtraLU+ of Behrmann, Bouyer, Larsen and Pelánek, "Lower and Upper Bounds in Zone-Based
//! Abstractions of Timed Automata" (2004/2006), with the bounds of each location from a static analysis of guards
//! (Behrmann, Bouyer, Fleury, Larsen, TACAS 2003), or ExtraM+ where a bisimulation is needed. With diagonal constraints
//! every such abstraction is unsound (Bouyer 2004); then zones are split along them and extrapolated by greatest constants,
//! as Bengtsson and Yi do.
//!
//! A clock without any bound in a location does not matter there: zones leave it out (Daws and Yovine 1996).

use smallvec::SmallVec;

use crate::zone::dbm::{Dbm, DbmBound, DbmNumber};

/// No bound: the clock is never compared that way before it is reset.
pub(crate) const NONE: i64 = i64::MIN;

/// The greatest constants that a clock is compared with, from below and from above.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct LuBounds {
    pub lower: i64,
    pub upper: i64,
}

pub(crate) const NEVER: LuBounds = LuBounds { lower: NONE, upper: NONE };

impl LuBounds {
    pub(crate) fn join(self, other: LuBounds) -> LuBounds {
        LuBounds { lower: self.lower.max(other.lower), upper: self.upper.max(other.upper) }
    }

    /// Of a clock that becomes the one with these bounds when `by` is added.
    pub(crate) fn before(self, by: i64) -> LuBounds {
        let one = |n: i64| if n == NONE { NONE } else { n.saturating_sub(by).max(0) };
        LuBounds { lower: one(self.lower), upper: one(self.upper) }
    }
}

/// Which bounds an extrapolation uses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ExtrapolationAbstraction {
    /// Lower and upper bounds apart: keeps what can be reached.
    #[default]
    LowerUpper,
    /// The greater of the two for both: keeps what can be reached from where (a bisimulation).
    Greatest,
}

/// The clocks that matter in a discrete state, and their bounds. The first is the reference clock.
#[derive(Clone, Debug, Default)]
pub(crate) struct ActiveClocks {
    /// Numbers of the network's clocks, ascending.
    pub clocks: Vec<u16>,
    pub bounds: Vec<LuBounds>,
}

impl ActiveClocks {
    /// The zone's index of a clock of the network.
    #[inline]
    pub(crate) fn index(&self, clock: u16) -> Option<usize> {
        if clock == 0 {
            return Some(0);
        }
        self.clocks.iter().position(|c| *c == clock)
    }

    /// As [`index`](Self::index), but looks from this index on first.
    pub(crate) fn index_from(&self, first: usize, clock: u16) -> Option<usize> {
        let behind = self.clocks[first..].iter().position(|c| *c == clock);
        behind.map_or_else(|| self.index(clock), |i| Some(first + i))
    }

    pub(crate) fn dim(&self) -> usize {
        self.clocks.len()
    }
}

/// Extrapolates by lower and upper bounds, and closes again if anything changed.
pub(crate) fn extra_lu<N: DbmNumber>(frame: &ActiveClocks, zone: &mut Dbm<N>, most: &mut Vec<N>) {
    let dim = zone.dim();
    let least = |zone: &Dbm<N>, i: usize| -zone.at(0, i).value();
    // By column: what a bound must not exceed. Of clocks whose least value is above what they are compared with from above, none stays.
    most.clear();
    most.extend(
        (0..dim).map(|j| if least(zone, j) > frame.bounds[j].upper { N::LEAST } else { N::INFINITY }),
    );
    most.resize(zone.row(0).len().next_multiple_of(N::LANES), N::INFINITY);
    let mut changed = false;
    for i in 1..dim {
        let lower = frame.bounds[i].lower;
        let all = lower == NONE || least(zone, i) > lower;
        let row = zone.row_mut(i);
        row[i] = N::INFINITY;
        changed |= N::drop_above(row, if all { N::LEAST } else { N::of(DbmBound::le(lower)) }, most);
        row[i] = N::LE_ZERO;
    }
    let row = zone.row_mut(0);
    for j in (1..dim).filter(|&j| most[j] == N::LEAST) {
        let upper = frame.bounds[j].upper;
        let new = if upper == NONE { N::LE_ZERO } else { N::of(DbmBound::lt(-upper)) };
        changed |= row[j] != new;
        row[j] = new;
    }
    if changed {
        zone.close();
    }
}

/// For each entry of a zone Z the least number that the entry of a zone Z' must have so that Z ⊆ aLU(Z').
///
/// INVARIANT: Z ⊈ aLU(Z') exactly if there are x, y with Z₀ₓ ≥ (≤, -Uₓ), Z'ᵧₓ < Zᵧₓ and Z'ᵧₓ + (<, -Lᵧ) < Z₀ₓ (Herbreteau,
/// Srivathsan, Walukiewicz, "Better Abstractions for Timed Automata", LICS 2012, Theorem 32). With whole bounds the last is
/// Z'ᵧₓ < Z₀ₓ + 2 Lᵧ in packed numbers, rounded up to an even one.
pub(crate) fn thresholds<N: DbmNumber>(frame: &ActiveClocks, zone: &Dbm<N>, out: &mut Vec<N>) {
    out.clear();
    let dim = zone.dim();
    // By clock x: Z₀ₓ as a strict bound, rounded up; and what takes a column out that asks for nothing.
    let (mut strict, mut most) = (ThresholdRow::<N>::new(), ThresholdRow::<N>::new());
    for (&least, lu) in zone.row(0).iter().zip(&frame.bounds) {
        let packed: i64 = least.into();
        strict.push(N::of(DbmBound::lt((packed + 1).div_euclid(2))));
        let free = lu.upper == NONE || least < N::of(DbmBound::le(-lu.upper));
        most.push(if free { N::LEAST } else { N::INFINITY });
    }
    for y in 0..dim {
        let lower = frame.bounds[y].lower;
        if lower == NONE {
            out.resize(out.len() + dim, N::LEAST);
        } else {
            N::least_of(zone.row(y), &strict, &most, N::of(DbmBound::lt(lower)), out);
        }
    }
}

type ThresholdRow<N> = SmallVec<[N; 32]>;

/// A zone that has all that the zone simulates: a convex hull of aLU(Z), not always the least.
///
/// INVARIANT: if v is simulated by v' in Z, then v(x) ≤ v'(x) where v'(x) ≤ Lₓ, which holds in all of Z or is not relied upon, and
/// v(y) ≥ v'(y) or v(y) > U_y.
pub(crate) fn simulated_hull(frame: &ActiveClocks, zone: &Dbm) -> Dbm {
    let mut hull = zone.clone();
    for x in 0..zone.dim() {
        let (lower, most) = (frame.bounds[x].lower, zone.at(x, 0));
        let held = x == 0 || (lower != NONE && most <= DbmBound::le(lower));
        for y in (0..zone.dim()).filter(|&y| y != x) {
            let upper = frame.bounds[y].upper;
            let beyond = if upper == NONE { DbmBound::LE_ZERO } else { DbmBound::lt(-upper) };
            let bound = match (held, y) {
                (false, _) => DbmBound::INFINITY,
                (true, 0) => most,
                (true, _) => zone.at(x, y).max(if x == 0 { beyond } else { most.plus(beyond) }),
            };
            hull.put(x, y, bound);
        }
    }
    hull.close();
    hull
}

/// The clock's bounds are never lost.
pub(crate) const KEEP: i64 = 1 << 58;

/// The greatest constants that each clock is compared with, from below and from above; clock 0 is the reference.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct MaximalConstants {
    pub lower: Vec<i64>,
    pub upper: Vec<i64>,
}

impl MaximalConstants {
    pub(crate) fn none(dim: usize) -> Self {
        let mut bounds = Self { lower: vec![NONE; dim], upper: vec![NONE; dim] };
        (bounds.lower[0], bounds.upper[0]) = (0, 0);
        bounds
    }
}

/// ExtraLU+; with level bounds ExtraM+. For zones without negative clocks.
pub(crate) fn extra(zone: &mut Dbm, bounds: &MaximalConstants) {
    let dim = zone.dim();
    let (lower, upper) = (&bounds.lower, &bounds.upper);
    // The least value of each clock, before anything changes.
    let least: Vec<i64> = (0..dim).map(|i| -zone.at(0, i).value()).collect();
    let mut changed = false;
    for i in 0..dim {
        for j in (0..dim).filter(|&j| j != i) {
            let b = zone.at(i, j);
            let new = if b.is_infinite() || (i > 0 && (b.value() > lower[i] || least[i] > lower[i])) {
                DbmBound::INFINITY
            } else if least[j] <= upper[j] {
                b
            } else if i > 0 {
                DbmBound::INFINITY
            } else if upper[j] == NONE {
                DbmBound::LE_ZERO
            } else {
                DbmBound::lt(-upper[j])
            };
            if new != b {
                zone.put(i, j, new);
                changed = true;
            }
        }
    }
    if changed {
        zone.close();
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::zone::dbm::dominates;

    const DIM: usize = 3;

    fn bound() -> impl Strategy<Value = DbmBound> {
        prop_oneof![(-3i64..4).prop_map(DbmBound::le), (-3i64..4).prop_map(DbmBound::lt)]
    }

    fn zone() -> impl Strategy<Value = Dbm<i16>> {
        prop::collection::vec((0..DIM, 0..DIM, bound()), 0..5).prop_map(|cs| {
            let mut z = Dbm::universe(DIM);
            for (i, j, b) in cs {
                if i != j {
                    z.constrain(i, j, b);
                }
            }
            z
        })
    }

    fn frame() -> impl Strategy<Value = ActiveClocks> {
        let one = || prop_oneof![Just(NONE), 0i64..4];
        prop::collection::vec((one(), one()), DIM - 1).prop_map(|all| {
            let own = all.into_iter().map(|(lower, upper)| LuBounds { lower, upper });
            let bounds = std::iter::once(LuBounds { lower: 0, upper: 0 }).chain(own).collect();
            ActiveClocks { clocks: (0..DIM as u16).collect(), bounds }
        })
    }

    /// In sixths.
    fn simulated(frame: &ActiveClocks, v: &[i64], by: &[i64]) -> bool {
        (1..DIM).all(|x| {
            let above = |n: i64, bound: i64| bound == NONE || n > 6 * bound;
            let lu = frame.bounds[x];
            v[x] == by[x]
                || (by[x] < v[x] && above(by[x], lu.lower))
                || (v[x] < by[x] && above(v[x], lu.upper))
        })
    }

    fn grid(step: usize, most: i64) -> impl Iterator<Item = [i64; DIM]> {
        let line = move || (0..=6 * most).step_by(step);
        line().flat_map(move |a| line().map(move |b| [0, a, b]))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(96))]

        /// Clocks in thirds meet all orders of two fractions; sixths lie between them. Zones begin at 6 at most, and go on beyond.
        #[test]
        fn simulation_is_as_it_is_defined(small in zone(), great in zone(), frame in frame()) {
            prop_assume!(!small.is_empty() && !great.is_empty());
            let mut demands = Vec::new();
            thresholds(&frame, &small, &mut demands);
            let mut flat = Vec::new();
            great.store(&mut flat);
            let targets: Vec<_> = grid(1, 11).filter(|p| great.contains(p, 6)).collect();
            let defined = grid(2, 8).filter(|p| small.contains(p, 6)).all(|v| {
                targets.iter().any(|by| simulated(&frame, &v, by))
            });
            prop_assert_eq!(dominates(&flat, &demands), defined);
        }

        #[test]
        fn the_hull_has_all_that_is_simulated(z in zone(), frame in frame()) {
            prop_assume!(!z.is_empty());
            let mut wide = Dbm::zero(1);
            wide.resize(DIM);
            for (i, j) in (0..DIM).flat_map(|i| (0..DIM).map(move |j| (i, j))) {
                wide.put(i, j, z.at(i, j));
            }
            let hull = simulated_hull(&frame, &wide);
            prop_assert!(hull.includes(&wide));
            for by in grid(2, 8).filter(|p| z.contains(p, 6)) {
                for v in grid(3, 8).filter(|v| simulated(&frame, v, &by)) {
                    prop_assert!(hull.contains(&v, 6), "{v:?} by {by:?}");
                }
            }
        }

        #[test]
        fn extrapolation_keeps_what_it_had_and_is_simulated(z in zone(), frame in frame()) {
            prop_assume!(!z.is_empty());
            let mut wide = z.clone();
            extra_lu(&frame, &mut wide, &mut Vec::new());
            prop_assert!(wide.includes(&z));
            let mut closed = wide.clone();
            prop_assert!(closed.close());
            prop_assert_eq!(&closed, &wide);
            let (mut demands, mut flat) = (Vec::new(), Vec::new());
            thresholds(&frame, &wide, &mut demands);
            z.store(&mut flat);
            prop_assert!(dominates(&flat, &demands));
        }
    }
}
