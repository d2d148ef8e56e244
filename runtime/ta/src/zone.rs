//! The timed half of the transition relation: a zone before and after a transition, and the delay that follows.

use crate::{
    dbm::Dbm,
    network::{Constraint, Model},
    semantics::Candidate,
};

fn constrain(zone: &mut Dbm, c: Constraint) -> bool {
    zone.constrain(usize::from(c.i), usize::from(c.j), c.bound)
}

/// The initial zone, with the delay; `false`: the invariants do not hold at the start.
pub(crate) fn initial(model: &Model, state: &[i64], zone: &mut Dbm) -> bool {
    *zone = Dbm::zero(model.dim);
    enter(model, state, zone)
}

/// Keeps the valuations in which the transition is possible; `false`: there are none.
pub(crate) fn guard(zone: &mut Dbm, candidate: &Candidate) -> bool {
    candidate.guard.iter().all(|&c| constrain(zone, c))
}

/// Whether a transition is possible as far as each of its constraints alone tells: quick, and wrong in one direction only.
pub(crate) fn may_pass(zone: &Dbm, candidate: &Candidate) -> bool {
    candidate.guard.iter().all(|c| zone.meets(usize::from(c.i), usize::from(c.j), c.bound))
}

/// Resets, enters the target, and delays there; `false`: the target's invariants forbid it.
pub(crate) fn advance(model: &Model, resets: &[u16], target: &[i64], zone: &mut Dbm) -> bool {
    for &x in resets {
        zone.reset(usize::from(x));
    }
    enter(model, target, zone)
}

fn enter(model: &Model, state: &[i64], zone: &mut Dbm) -> bool {
    if !model.invariant(state).all(|c| constrain(zone, c)) {
        return false;
    }
    if model.may_delay(state) {
        zone.up();
        // Not empty: it has what was there before the delay.
        model.invariant(state).for_each(|c| {
            constrain(zone, c);
        });
    }
    true
}
