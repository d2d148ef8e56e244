//! Cells: the parts of clock space in which the comparisons of a formula have the same values, and how time leads from one
//! to the next.
//!
//! A formula's comparisons of a clock with c₁ < … < cₘ cut the clock's values into points and open intervals; a comparison of
//! two clocks is constant while time passes. Time leaves a point at once into the open interval after it, and an open
//! interval into the point at its end: no cell is skipped.

use hrdsl_ir::ta::ClockConstraint;

use crate::{
    network::{
        error::ModelError,
        graph::DiscreteStateView,
        query::{StateFormula, StateViewScope, SymbolicView, nanos, no_value},
    },
    zone::{
        constraint::{DifferenceConstraint, keep},
        dbm::{Dbm, DbmBound},
    },
};

/// What the comparisons of some formulas cut clock space along, in one discrete state.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct CellCuts {
    /// For each clock that is compared: the constants, in order.
    singles: Vec<(u16, Vec<i64>)>,
    /// `x - y` against a constant.
    doubles: Vec<(u16, u16, i64)>,
}

/// One cell: for each clock its interval (even: open; odd: a point), for each comparison of two clocks its side.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct ClockCell {
    singles: Vec<u16>,
    doubles: Vec<u8>,
}

impl CellCuts {
    /// # Errors
    /// If a bound has no value in the state, or is finer than the network's unit.
    pub(crate) fn of(formulas: &[&StateFormula], here: &DiscreteStateView) -> Result<Self, ModelError> {
        let mut cuts = Self::default();
        let mut fault = None;
        for f in formulas {
            f.each_clock(&mut |c| {
                if let Err(e) = cuts.add(c, here) {
                    fault = Some(e);
                }
            });
        }
        fault.map_or(Ok(cuts), Err)
    }

    fn add(&mut self, c: &ClockConstraint, here: &DiscreteStateView) -> Result<(), ModelError> {
        let time = nanos(&c.bound, &StateViewScope(here)).map_err(no_value)?;
        if time % here.unit() != 0 {
            return Err(ModelError::Question(
                "a time in the formula is finer than the network's unit".into(),
            ));
        }
        let (n, x) = (time / here.unit(), c.clock.0 + 1);
        match c.minus {
            Some(y) => {
                let cut = (x, y.0 + 1, n);
                if !self.doubles.contains(&cut) {
                    self.doubles.push(cut);
                }
            }
            None => {
                let at = self.singles.iter().position(|(y, _)| *y == x).unwrap_or_else(|| {
                    self.singles.push((x, Vec::new()));
                    self.singles.len() - 1
                });
                let list = &mut self.singles[at].1;
                if let Err(place) = list.binary_search(&n) {
                    list.insert(place, n);
                }
            }
        }
        Ok(())
    }

    /// The bounds of a cell.
    pub(crate) fn bounds(&self, cell: &ClockCell) -> Vec<DifferenceConstraint> {
        let mut out = Vec::new();
        for ((x, at), &interval) in self.singles.iter().zip(&cell.singles) {
            out.extend(interval_bounds(*x, at, interval));
        }
        for (&(x, y, n), &side) in self.doubles.iter().zip(&cell.doubles) {
            out.extend(side_bounds(x, y, n, side));
        }
        out
    }

    /// The parts of a zone in each cell.
    pub(crate) fn parts(&self, zone: &Dbm) -> Vec<(ClockCell, Dbm)> {
        let mut parts = vec![(ClockCell::default(), zone.clone())];
        for (x, at) in &self.singles {
            let count = u16::try_from(2 * at.len() + 1).unwrap_or(u16::MAX);
            let cut = |(cell, zone): (ClockCell, Dbm)| {
                (0..count).filter_map(move |k| {
                    let part = within(&zone, &interval_bounds(*x, at, k))?;
                    let mut cell = cell.clone();
                    cell.singles.push(k);
                    Some((cell, part))
                })
            };
            parts = parts.into_iter().flat_map(cut).collect();
        }
        for &(x, y, n) in &self.doubles {
            let cut = |(cell, zone): (ClockCell, Dbm)| {
                (0..3).filter_map(move |side| {
                    let part = within(&zone, &side_bounds(x, y, n, side))?;
                    let mut cell = cell.clone();
                    cell.doubles.push(side);
                    Some((cell, part))
                })
            };
            parts = parts.into_iter().flat_map(cut).collect();
        }
        parts
    }

    /// The cells into which time can lead at once from a cell, while these clocks stand still.
    pub(crate) fn next(&self, cell: &ClockCell, stopped: &[u16]) -> Vec<ClockCell> {
        let stands = |x: &u16| stopped.contains(x);
        let leaves = |x: &u16, k: u16| k % 2 == 1 && !stands(x);
        if self.singles.iter().zip(&cell.singles).any(|((x, _), k)| leaves(x, *k)) {
            let singles =
                self.singles.iter().zip(&cell.singles).map(|((x, _), k)| k + u16::from(leaves(x, *k)));
            return vec![ClockCell { singles: singles.collect(), doubles: cell.doubles.clone() }];
        }
        // Some of the clocks come to the end of their intervals, at the same time.
        let mut all = vec![Vec::new()];
        for ((x, at), &k) in self.singles.iter().zip(&cell.singles) {
            let ends = usize::from(k) < 2 * at.len() && !stands(x);
            let with = |list: &Vec<u16>, k: u16| list.iter().copied().chain([k]).collect::<Vec<u16>>();
            all = all
                .iter()
                .flat_map(|list| std::iter::once(with(list, k)).chain(ends.then(|| with(list, k + 1))))
                .collect();
        }
        all.retain(|singles| *singles != cell.singles);
        all.into_iter().map(|singles| ClockCell { singles, doubles: cell.doubles.clone() }).collect()
    }

    /// Whether a cell goes on for ever, while these clocks stand still.
    pub(crate) fn is_last(&self, cell: &ClockCell, stopped: &[u16]) -> bool {
        let last = |x: &u16, at: &[i64], k: u16| stopped.contains(x) || usize::from(k) == 2 * at.len();
        self.singles.iter().zip(&cell.singles).all(|((x, at), &k)| last(x, at, k))
    }
}

/// The part of a zone within some bounds.
pub(crate) fn within(zone: &Dbm, bounds: &[DifferenceConstraint]) -> Option<Dbm> {
    let mut part = zone.clone();
    bounds.iter().all(|c| keep(&mut part, *c)).then_some(part)
}

fn interval_bounds(x: u16, at: &[i64], interval: u16) -> Vec<DifferenceConstraint> {
    let (i, exact) = (usize::from(interval / 2), interval % 2 == 1);
    let upper = |bound| DifferenceConstraint { i: x, j: 0, bound };
    let lower = |bound| DifferenceConstraint { i: 0, j: x, bound };
    if exact {
        return vec![upper(DbmBound::le(at[i])), lower(DbmBound::le(-at[i]))];
    }
    let end = at.get(i).map(|n| upper(DbmBound::lt(*n)));
    let start = i.checked_sub(1).and_then(|i| at.get(i)).map(|n| lower(DbmBound::lt(-n)));
    end.into_iter().chain(start).collect()
}

fn side_bounds(x: u16, y: u16, n: i64, side: u8) -> Vec<DifferenceConstraint> {
    let upper = |bound| DifferenceConstraint { i: x, j: y, bound };
    let lower = |bound| DifferenceConstraint { i: y, j: x, bound };
    match side {
        0 => vec![upper(DbmBound::lt(n))],
        1 => vec![upper(DbmBound::le(n)), lower(DbmBound::le(-n))],
        _ => vec![lower(DbmBound::lt(-n))],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cuts() -> CellCuts {
        CellCuts { singles: vec![(1, vec![2, 5]), (2, vec![3])], doubles: Vec::new() }
    }

    #[test]
    fn a_zone_falls_into_its_cells() {
        let parts = cuts().parts(&Dbm::universe(3));
        assert_eq!(parts.len(), 15);
        for (cell, part) in &parts {
            assert_eq!(within(&Dbm::universe(3), &cuts().bounds(cell)).as_ref(), Some(part));
        }
    }

    #[test]
    fn a_clock_that_stands_stays_in_its_interval() {
        let cell = |a, b| ClockCell { singles: vec![a, b], doubles: Vec::new() };
        assert_eq!(cuts().next(&cell(1, 0), &[1]), [cell(1, 1)]);
        assert_eq!(cuts().next(&cell(1, 1), &[1]), [cell(1, 2)]);
        assert_eq!(cuts().next(&cell(0, 0), &[2]), [cell(1, 0)]);
        assert!(cuts().is_last(&cell(1, 2), &[1]) && !cuts().is_last(&cell(1, 2), &[2]));
    }

    #[test]
    fn time_skips_no_cell() {
        let cell = |a, b| ClockCell { singles: vec![a, b], doubles: Vec::new() };
        assert_eq!(cuts().next(&cell(0, 0), &[]), [cell(0, 1), cell(1, 0), cell(1, 1)]);
        assert_eq!(cuts().next(&cell(1, 0), &[]), [cell(2, 0)]);
        assert_eq!(cuts().next(&cell(1, 1), &[]), [cell(2, 2)]);
        assert_eq!(cuts().next(&cell(4, 0), &[]), [cell(4, 1)]);
        assert_eq!(cuts().next(&cell(4, 2), &[]), []);
        assert!(cuts().is_last(&cell(4, 2), &[]) && !cuts().is_last(&cell(4, 1), &[]));
    }
}
