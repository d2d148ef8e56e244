//! Federations: finite unions of zones, with what zones alone lack: difference.
//!
//! After Bengtsson and Yi, "Timed Automata: Semantics, Algorithms and Tools" (2004), and David, Håkansson, Larsen and
//! Pettersson, "Model Checking Timed Automata with Priorities Using DBM Subtraction" (FORMATS 2006).

use crate::zone::dbm::{Dbm, DbmBound};

/// A union of zones of one dimension; none of them is empty.
#[derive(Clone, Debug, Default)]
pub struct Federation {
    zones: Vec<Dbm>,
}

impl Federation {
    /// No valuation.
    #[must_use]
    pub fn empty() -> Self {
        Self::default()
    }

    /// The valuations of one zone.
    #[must_use]
    pub fn from_zone(zone: Dbm) -> Self {
        let mut all = Self::empty();
        all.add(zone);
        all
    }

    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.zones.is_empty()
    }

    #[must_use]
    pub fn zones(&self) -> &[Dbm] {
        &self.zones
    }

    #[must_use]
    pub fn into_zones(self) -> Vec<Dbm> {
        self.zones
    }

    /// Adds a zone's valuations; zones that it includes go.
    pub fn add(&mut self, zone: Dbm) {
        if zone.is_empty() || self.zones.iter().any(|z| z.includes(&zone)) {
            return;
        }
        self.zones.retain(|z| !zone.includes(z));
        self.zones.push(zone);
    }

    /// The valuations of either.
    #[must_use]
    pub fn union(mut self, other: Federation) -> Self {
        other.zones.into_iter().for_each(|z| self.add(z));
        self
    }

    /// The valuations of both.
    #[must_use]
    pub fn intersection(&self, other: &Federation) -> Self {
        let mut out = Self::empty();
        for a in &self.zones {
            for b in &other.zones {
                let mut both = a.clone();
                if both.intersect(b) {
                    out.add(both);
                }
            }
        }
        out
    }

    /// What is left without a zone's valuations.
    #[must_use]
    pub fn minus(&self, zone: &Dbm) -> Self {
        let mut out = Self::empty();
        for z in &self.zones {
            difference(z, zone, &mut out.zones);
        }
        out
    }

    /// What is left without another federation's valuations.
    #[must_use]
    pub fn without(&self, other: &Federation) -> Self {
        other.zones.iter().fold(self.clone(), |left, z| left.minus(z))
    }

    /// Whether each valuation of the zone is in some zone of this.
    #[must_use]
    pub fn includes(&self, zone: &Dbm) -> bool {
        self.zones.iter().any(|z| z.includes(zone))
            || self.zones.iter().fold(Federation::from_zone(zone.clone()), |left, z| left.minus(z)).is_empty()
    }

    /// Whether it has the valuation whose clock `i` is `point[i] / scale`; `point[0]` must be 0.
    #[must_use]
    pub fn contains(&self, point: &[i64], scale: i64) -> bool {
        self.zones.iter().any(|z| z.contains(point, scale))
    }
}

/// Adds what `zone` has and `gone` has not, as zones without common valuations.
///
/// INVARIANT: at each bound of `gone` that cuts what is left, the part beyond it is put aside; what is left at the end is
/// the intersection.
fn difference(zone: &Dbm, gone: &Dbm, out: &mut Vec<Dbm>) {
    if zone.is_empty() || gone.includes(zone) {
        return;
    }
    let mut common = zone.clone();
    if gone.is_empty() || !common.intersect(gone) {
        out.push(zone.clone());
        return;
    }
    let mut left = zone.clone();
    for i in 0..zone.dim() {
        for j in (0..zone.dim()).filter(|&j| j != i) {
            let b = gone.at(i, j);
            if left.at(i, j) <= b {
                continue;
            }
            let mut beyond = left.clone();
            if beyond.constrain(j, i, b.negated()) {
                out.push(beyond);
            }
            left.constrain(i, j, b);
        }
    }
}

/// All valuations from which some time leads into the zone.
#[must_use]
pub fn past(zone: &Dbm) -> Dbm {
    let mut before = zone.clone();
    if before.is_empty() {
        return before;
    }
    for i in 1..zone.dim() {
        let least = (1..zone.dim()).map(|j| zone.at(j, i)).filter(|b| *b < DbmBound::LE_ZERO).min();
        before.put(0, i, least.unwrap_or(DbmBound::LE_ZERO));
    }
    before
}

/// All valuations that some value of the clock brings into the zone.
#[must_use]
pub fn forget(zone: &Dbm, clock: usize) -> Dbm {
    let mut free = zone.clone();
    if free.is_empty() {
        return free;
    }
    for i in (0..zone.dim()).filter(|&i| i != clock) {
        free.put(clock, i, DbmBound::INFINITY);
        free.put(i, clock, zone.at(i, 0));
    }
    free
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const DIM: usize = 4;

    fn zone() -> impl Strategy<Value = Dbm> {
        let bound = prop_oneof![(-3i64..6).prop_map(DbmBound::le), (-3i64..6).prop_map(DbmBound::lt)];
        prop::collection::vec((0..DIM, 0..DIM, bound), 0..7).prop_map(|cs| {
            let mut z = Dbm::universe(DIM);
            for (i, j, b) in cs.into_iter().filter(|(i, j, _)| i != j) {
                z.constrain(i, j, b);
            }
            z
        })
    }

    fn federation() -> impl Strategy<Value = Federation> {
        prop::collection::vec(zone(), 0..4).prop_map(|zones| {
            let mut all = Federation::empty();
            zones.into_iter().for_each(|z| all.add(z));
            all
        })
    }

    /// A valuation in quarters.
    fn point() -> impl Strategy<Value = Vec<i64>> {
        prop::collection::vec(0i64..28, DIM - 1).prop_map(|mut p| {
            p.insert(0, 0);
            p
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]
        #[test]
        fn set_operations_are_those_of_points(a in federation(), b in federation(), p in point()) {
            let (x, y) = (a.contains(&p, 4), b.contains(&p, 4));
            prop_assert_eq!(a.without(&b).contains(&p, 4), x && !y);
            prop_assert_eq!(a.intersection(&b).contains(&p, 4), x && y);
            prop_assert_eq!(a.clone().union(b.clone()).contains(&p, 4), x || y);
        }

        #[test]
        fn a_difference_has_disjoint_canonical_parts(a in zone(), b in zone(), p in point()) {
            let left = Federation::from_zone(a.clone()).minus(&b);
            prop_assert!(left.zones().iter().filter(|z| z.contains(&p, 4)).count() <= 1);
            for z in left.zones() {
                let mut again = z.clone();
                prop_assert!(again.close());
                prop_assert_eq!(&again, z);
            }
            // Nothing more is left of a part that was in both.
            let common = left.intersection(&Federation::from_zone(b.clone()));
            prop_assert!(common.is_empty());
        }

        #[test]
        fn inclusion_in_a_union_sees_all_points(a in federation(), z in zone(), p in point()) {
            if a.includes(&z) {
                prop_assert!(!z.contains(&p, 4) || a.contains(&p, 4));
            } else {
                prop_assert!(!Federation::from_zone(z).without(&a).is_empty());
            }
        }

        #[test]
        fn the_past_is_what_a_delay_leads_from(z in zone(), p in point()) {
            let before = past(&z);
            let fine: Vec<i64> = p.iter().map(|v| v * 4).collect();
            let reaches = (0..16 * 12).any(|d| {
                let later: Vec<i64> =
                    fine.iter().enumerate().map(|(i, v)| if i == 0 { 0 } else { v + d }).collect();
                z.contains(&later, 16)
            });
            prop_assert_eq!(before.contains(&p, 4), reaches);
            if !z.is_empty() {
                let mut closed = before.clone();
                closed.close();
                prop_assert_eq!(closed, before);
            }
        }

        #[test]
        fn a_forgotten_clock_may_have_had_any_value(z in zone(), p in point(), x in 1..DIM) {
            let free = forget(&z, x);
            let fine: Vec<i64> = p.iter().map(|v| v * 4).collect();
            let some = (0..16 * 16).any(|v| {
                let mut q = fine.clone();
                q[x] = v;
                z.contains(&q, 16)
            });
            prop_assert_eq!(free.contains(&p, 4), some);
        }
    }
}
