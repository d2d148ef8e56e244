//! Bounds on a clock or a difference of two, as networks have them.

use hrdsl_ir::ta::ClockOp;

use crate::zone::dbm::{Dbm, DbmBound};

/// `x_i - x_j ≺ bound`
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct DifferenceConstraint {
    pub i: u16,
    pub j: u16,
    pub bound: DbmBound,
}

impl DifferenceConstraint {
    /// What holds exactly where this does not.
    pub(crate) fn negated(self) -> Self {
        Self { i: self.j, j: self.i, bound: self.bound.negated() }
    }
}

/// The bounds that say `x_i - x_j op n`.
pub(crate) fn constraints(i: u16, j: u16, op: ClockOp, n: i64, out: &mut dyn FnMut(DifferenceConstraint)) {
    let upper = |bound| DifferenceConstraint { i, j, bound };
    let lower = |bound| DifferenceConstraint { i: j, j: i, bound };
    match op {
        ClockOp::Lt => out(upper(DbmBound::lt(n))),
        ClockOp::Le => out(upper(DbmBound::le(n))),
        ClockOp::Eq => {
            out(upper(DbmBound::le(n)));
            out(lower(DbmBound::le(-n)));
        }
        ClockOp::Ge => out(lower(DbmBound::le(-n))),
        ClockOp::Gt => out(lower(DbmBound::lt(-n))),
    }
}

/// A zone from which only the parts within a constraint are kept; `false`: there are none.
pub(crate) fn keep(zone: &mut Dbm, c: DifferenceConstraint) -> bool {
    zone.constrain(usize::from(c.i), usize::from(c.j), c.bound)
}
