//! What zones keep of their states where clocks stand still: which clocks may be forgotten, and when a delay says too much.

use crate::zone::{
    dbm::{Dbm, DbmBound},
    extrapolation::{ActiveClocks, NONE},
};

/// Forgets the clocks that nothing asks for before they are set: all other bounds stay exact.
pub(super) fn forget(zone: &mut Dbm, frame: &ActiveClocks) {
    for (x, lu) in frame.bounds.iter().enumerate().skip(1) {
        if lu.lower != NONE || lu.upper != NONE {
            continue;
        }
        for k in (0..zone.dim()).filter(|k| *k != x) {
            let above = zone.at(k, 0);
            zone.put(x, k, DbmBound::INFINITY);
            zone.put(k, x, above);
        }
    }
}

/// Whether the bounds of the zone after a delay say no more than the delays of its valuations.
///
/// INVARIANT: v' comes from some v by a delay d if d ≥ v'ᵣ - v'ₛ - Zᵣₛ and d ≤ Zₛ'ᵣ' + v'ᵣ' - v'ₛ' for all running r, r' and standing s, s' (0
/// among these). There is such a d exactly if no lower bound is above an upper one, which the bounds that are kept, Zᵣᵣ' and Zₛ'ₛ, say
/// themselves where Zᵣₛ + Zₛ'ᵣ' ≥ Zᵣᵣ' + Zₛ'ₛ.
pub(super) fn delays_exactly(zone: &Dbm, frame: &ActiveClocks, stopped: &[u16]) -> bool {
    let matters = |x: &usize| frame.bounds[*x].lower != NONE || frame.bounds[*x].upper != NONE;
    let (mut stands, mut runs) = (vec![0], Vec::new());
    for x in (1..zone.dim()).filter(matters) {
        if stopped.iter().any(|&s| usize::from(s) == x) { stands.push(x) } else { runs.push(x) }
    }
    if stands.len() == 1 {
        return true;
    }
    let sum = |a: DbmBound, b: DbmBound| a.plus(b);
    runs.iter().all(|&r| {
        runs.iter().filter(|&&r2| r2 != r).all(|&r2| {
            stands.iter().all(|&s| {
                stands
                    .iter()
                    .filter(|&&s2| s2 != s)
                    .all(|&s2| sum(zone.at(r, s), zone.at(s2, r2)) >= sum(zone.at(r, r2), zone.at(s2, s)))
            })
        })
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::zone::extrapolation::LuBounds;

    const DIM: usize = 5;

    fn matters() -> ActiveClocks {
        ActiveClocks { clocks: (0..DIM as u16).collect(), bounds: vec![LuBounds { lower: 9, upper: 9 }; DIM] }
    }

    fn zone(bounds: &[(usize, usize, i64)]) -> Dbm {
        let mut zone = Dbm::universe(DIM);
        for &(i, j, n) in bounds.iter().filter(|(i, j, _)| i != j) {
            zone.constrain(i, j, DbmBound::le(n));
        }
        zone
    }

    /// x stood at up to 2, y at up to 2, while z and w ran to 2 together: the sum of x and z is not known, and zones say more.
    #[test]
    fn a_delay_of_two_that_run_and_two_that_stand_may_say_too_much() {
        let z = zone(&[(1, 0, 2), (2, 0, 2), (3, 0, 2), (4, 0, 2), (1, 3, 0), (4, 2, 0)]);
        assert!(!delays_exactly(&z, &matters(), &[1, 2]));
        assert!(delays_exactly(&z, &matters(), &[]) && delays_exactly(&z, &matters(), &[1, 2, 3]));
        assert!(delays_exactly(&Dbm::zero(DIM), &matters(), &[1, 2]), "a single state");
    }

    proptest! {
        /// What is said to be exact is: each state of the zone after the delay comes from one before it.
        #[test]
        fn exact_delays_are(
            bounds in prop::collection::vec((0..DIM, 0..DIM, -3i64..6), 0..10),
            stopped in prop::collection::vec(1..DIM as u16, 1..3),
            p in prop::collection::vec(0i64..24, DIM - 1),
        ) {
            let before = zone(&bounds);
            prop_assume!(!before.is_empty() && delays_exactly(&before, &matters(), &stopped));
            let mut after = before.clone();
            after.up_but(&stopped);
            let point: Vec<i64> = std::iter::once(0).chain(p).collect();
            prop_assume!(after.contains(&point, 4));
            let runs = |i: usize| i != 0 && !stopped.contains(&(i as u16));
            let most = (1..DIM).filter(|&i| runs(i)).map(|i| point[i]).min().unwrap_or(0);
            // All bounds are whole, and the point's parts are quarters: so is some delay.
            let from = (0..=most).any(|d| {
                let earlier: Vec<i64> = (0..DIM).map(|i| point[i] - if runs(i) { d } else { 0 }).collect();
                before.contains(&earlier, 4)
            });
            prop_assert!(from, "{point:?} of {after:?} from {before:?}");
        }
    }
}
