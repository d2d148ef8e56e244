//! Comparisons of two clocks: zones are split along them, and the pieces extrapolated by greatest constants (Bengtsson and
//! Yi, "On Clock Difference Constraints and Termination in Reachability Analysis of Timed Automata", 2003).

use crate::zone::{
    constraint::DifferenceConstraint,
    dbm::{Dbm, DbmBound, DbmNumber},
};

/// The pieces of a zone along comparisons of clocks, each extrapolated by greatest constants and kept on its sides.
pub(crate) fn split<N: DbmNumber>(
    zone: &Dbm<N>,
    diagonals: &[DifferenceConstraint],
    greatest: &[i64],
    out: &mut dyn FnMut(Dbm<N>),
) {
    sides(zone.clone(), diagonals, &mut |piece| out(normalise(&piece, diagonals, greatest)));
}

fn sides<N: DbmNumber>(zone: Dbm<N>, diagonals: &[DifferenceConstraint], out: &mut dyn FnMut(Dbm<N>)) {
    let Some((c, rest)) = diagonals.split_first() else { return out(zone) };
    for side in [*c, c.negated()] {
        let mut part = zone.clone();
        if part.constrain(usize::from(side.i), usize::from(side.j), side.bound) {
            sides(part, rest, out);
        }
    }
}

fn normalise<N: DbmNumber>(piece: &Dbm<N>, diagonals: &[DifferenceConstraint], greatest: &[i64]) -> Dbm<N> {
    let mut wide = piece.clone();
    let dim = wide.dim();
    for i in 0..dim {
        for j in (0..dim).filter(|&j| j != i) {
            let b = piece.at(i, j);
            if b.is_infinite() {
                continue;
            }
            if i > 0 && b.value() > greatest[i] {
                wide.put(i, j, DbmBound::INFINITY);
            } else if -b.value() > greatest[j] {
                wide.put(i, j, DbmBound::lt(-greatest[j]));
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
