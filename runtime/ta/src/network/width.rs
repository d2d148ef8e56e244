//! How many bits the bounds of a network's zones need.

use crate::network::{
    code::CodeLibrary,
    error::ModelError,
    model::BoundWidth,
    parts::{ClockConstraints, CompiledAutomaton, EdgeUpdate},
};

/// The least width in which no sum can overflow.
///
/// INVARIANT: entries of an extrapolated zone lie within the greatest constant M. Guards on single clocks leave all within
/// 2M, each update adds M at most, invariants and delays give 2M more; a sum has three of them. Constraints on differences
/// may lengthen a path by one constant for each clock.
pub(super) fn width(
    members: &[CompiledAutomaton],
    formulas: &ClockConstraints,
    dim: usize,
    library: &CodeLibrary,
) -> Result<BoundReach, ModelError> {
    let (mut most, mut differences, mut updates) = (1, false, 0);
    let mut note = |c: &ClockConstraints| {
        for f in &c.fixed {
            most = most.max(f.bound.value().abs());
            differences |= f.i != 0 && f.j != 0;
        }
        for m in &c.moving {
            most = most.max(m.span.0.abs()).max(m.span.1.abs());
            differences |= m.j != 0;
        }
    };
    note(formulas);
    for m in members {
        m.locations.iter().for_each(|l| note(&l.invariant));
        m.edges.iter().for_each(|e| note(&e.guard));
    }
    let mut set = 0;
    for m in members {
        let mut worst = 0;
        for e in &m.edges {
            let mut here = 0;
            for u in &e.updates {
                let EdgeUpdate::Reset { to, .. } = u else { continue };
                let locals: Vec<(i64, i64)> = e.locals(library);
                let (lo, hi) = to.span(library, &locals);
                set = set.max(lo.abs()).max(hi.abs());
                here += i64::from((lo, hi) != (0, 0));
            }
            worst = worst.max(here);
        }
        updates += worst;
    }
    let most = most.max(set);
    let far = 3 * (4 + updates + if differences { 2 * dim as i64 } else { 0 });
    let reach = BoundReach(i128::from(most) * i128::from(far));
    if reach.width(0).is_some() {
        Ok(reach)
    } else {
        Err(ModelError::Constants {
            automaton: members.first().map_or(String::new(), |m| m.automaton.name.clone()),
        })
    }
}

/// No sum of bounds of a network goes beyond this.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BoundReach(i128);

impl BoundReach {
    /// The least width, with a clock beside those of the network that is never set and comes to so many units at most.
    pub(crate) fn width(self, time: i64) -> Option<BoundWidth> {
        // Three bounds in a sum, each of which may have the time in it.
        let reach = self.0 + 4 * i128::from(time);
        if reach < 1 << 14 {
            Some(BoundWidth::Bits16)
        } else if reach < 1 << 30 {
            Some(BoundWidth::Bits32)
        } else if reach < 1 << 61 {
            Some(BoundWidth::Bits64)
        } else {
            None
        }
    }
}
