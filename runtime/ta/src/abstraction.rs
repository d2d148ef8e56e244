//! Extrapolation of zones by bounds that are given, for the searches of this crate that need more of it than reachability
//! does: all of ExtraLU+ and ExtraM+ of Behrmann, Bouyer, Larsen and Pelánek, "Lower and Upper Bounds in Zone-Based
//! Abstractions of Timed Automata" (2006), and where there are comparisons of two clocks, splitting along them and
//! extrapolation by greatest constants (Bengtsson and Yi 2003).

use crate::{
    dbm::{Bound, Dbm},
    network::Constraint,
};

/// No bound: the clock is never compared that way before it is set again.
pub(crate) const NONE: i64 = i64::MIN;
/// The clock's bounds are never lost.
pub(crate) const KEEP: i64 = 1 << 58;

/// The greatest constants that each clock is compared with, from below and from above; clock 0 is the reference.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Bounds {
    pub lower: Vec<i64>,
    pub upper: Vec<i64>,
}

impl Bounds {
    pub(crate) fn none(dim: usize) -> Self {
        let mut bounds = Self { lower: vec![NONE; dim], upper: vec![NONE; dim] };
        (bounds.lower[0], bounds.upper[0]) = (0, 0);
        bounds
    }

    /// At least these.
    pub(crate) fn raise(&mut self, other: &Bounds) {
        for (mine, theirs) in [(&mut self.lower, &other.lower), (&mut self.upper, &other.upper)] {
            mine.iter_mut().zip(theirs).for_each(|(a, b)| *a = (*a).max(*b));
        }
    }

    /// Compared with `most` both ways.
    pub(crate) fn note(&mut self, clock: usize, most: i64) {
        self.lower[clock] = self.lower[clock].max(most);
        self.upper[clock] = self.upper[clock].max(most);
    }

    /// The greater of both for both: what keeps apart what can be told apart (a bisimulation), not only what can do more.
    pub(crate) fn level(&mut self) {
        for (l, u) in self.lower.iter_mut().zip(&mut self.upper) {
            *l = (*l).max(*u);
            *u = *l;
        }
    }
}

/// ExtraLU+; with level bounds ExtraM+. For zones without negative clocks.
pub(crate) fn extra(zone: &mut Dbm, bounds: &Bounds) {
    let dim = zone.dim();
    let (lower, upper) = (&bounds.lower, &bounds.upper);
    // The least value of each clock, before anything changes.
    let least: Vec<i64> = (0..dim).map(|i| -zone.at(0, i).value()).collect();
    let mut changed = false;
    for i in 0..dim {
        for j in (0..dim).filter(|&j| j != i) {
            let b = zone.at(i, j);
            let new = if b.is_infinite() || (i > 0 && (b.value() > lower[i] || least[i] > lower[i])) {
                Bound::INFINITY
            } else if least[j] <= upper[j] {
                b
            } else if i > 0 {
                Bound::INFINITY
            } else if upper[j] == NONE {
                Bound::LE_ZERO
            } else {
                Bound::lt(-upper[j])
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

/// The pieces of a zone along comparisons of clocks, each extrapolated by greatest constants and kept on its sides.
pub(crate) fn split(zone: &Dbm, diagonals: &[Constraint], greatest: &[i64], out: &mut dyn FnMut(Dbm)) {
    sides(zone.clone(), diagonals, &mut |piece| out(normalise(&piece, diagonals, greatest)));
}

fn sides(zone: Dbm, diagonals: &[Constraint], out: &mut dyn FnMut(Dbm)) {
    let Some((c, rest)) = diagonals.split_first() else { return out(zone) };
    for side in [*c, c.negated()] {
        let mut part = zone.clone();
        if part.constrain(usize::from(side.i), usize::from(side.j), side.bound) {
            sides(part, rest, out);
        }
    }
}

fn normalise(piece: &Dbm, diagonals: &[Constraint], greatest: &[i64]) -> Dbm {
    let mut wide = piece.clone();
    let dim = wide.dim();
    for i in 0..dim {
        for j in (0..dim).filter(|&j| j != i) {
            let b = piece.at(i, j);
            if b.is_infinite() {
                continue;
            }
            if i > 0 && b.value() > greatest[i] {
                wide.put(i, j, Bound::INFINITY);
            } else if -b.value() > greatest[j] {
                wide.put(i, j, Bound::lt(-greatest[j]));
            }
        }
    }
    wide.close();
    for c in diagonals {
        for side in [*c, c.negated()] {
            let other = side.negated();
            if !piece.meets(usize::from(other.i), usize::from(other.j), other.bound) {
                wide.constrain(usize::from(side.i), usize::from(side.j), side.bound);
            }
        }
    }
    wide
}
