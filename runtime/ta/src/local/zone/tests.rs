//! Local zones against sets of local valuations, one by one.

use std::collections::BTreeSet;

use proptest::prelude::*;

use super::*;

/// Clocks 0 and 1 are of process 0, clock 2 of process 1, clock 3 of process 2.
const OWNER: [usize; 4] = [0, 0, 1, 2];
const PROCESSES: usize = 3;

/// One transition of random processes.
#[derive(Clone, Debug)]
struct Shot {
    who: Vec<u16>,
    bounds: Vec<ClockBound>,
    sets: Vec<ClockAssignment>,
    /// Upper bounds that hold from then on; those on clocks that are set are not below what they are set to.
    invariant: Vec<ClockBound>,
    /// Time passes for these afterwards.
    elapse: Vec<u16>,
}

fn clock_bound(strict: bool) -> impl Strategy<Value = ClockBound> {
    (0..4u16, any::<bool>(), 0..5i64, any::<bool>()).prop_map(move |(clock, upper, c, less)| {
        let c = if upper { c } else { -c };
        let bound = if less && strict { lt(c) } else { le(c) }.unwrap();
        ClockBound { clock, upper, bound }
    })
}

fn shot(strict: bool) -> impl Strategy<Value = Shot> {
    let who = proptest::collection::btree_set(0..PROCESSES as u16, 1..=3);
    let bounds = proptest::collection::vec(clock_bound(strict), 0..3);
    let sets = proptest::collection::btree_map(0..4u16, (proptest::option::of(0..4u16), 0..2i64), 0..3);
    let invariant = proptest::collection::vec((0..4u16, 1..6i64), 0..2);
    let elapse = proptest::collection::btree_set(0..PROCESSES as u16, 0..=3);
    (who, bounds, sets, invariant, elapse).prop_map(|(who, mut bounds, sets, invariant, elapse)| {
        let of = |clock: u16| who.contains(&(OWNER[usize::from(clock)] as u16));
        bounds.retain(|b| of(b.clock));
        let upper = |&(clock, c): &(u16, i64)| ClockBound { clock, upper: true, bound: le(c).unwrap() };
        let invariant: Vec<_> = invariant.iter().filter(|i| of(i.0)).map(upper).collect();
        let set = |(clock, (from, by)): (u16, (Option<u16>, i64))| ClockAssignment {
            clock,
            from: from.filter(|y| of(*y)),
            by: le(by).unwrap(),
        };
        let sets: Vec<ClockAssignment> = sets.into_iter().filter(|s| of(s.0)).map(set).collect();
        // Where a clock's value is from must meet the invariant that it enters.
        for i in &invariant {
            let (clock, by) = match sets.iter().find(|s| s.clock == i.clock) {
                None => (i.clock, ZERO),
                Some(ClockAssignment { from: Some(y), by, .. }) => (*y, *by),
                Some(ClockAssignment { from: None, .. }) => continue,
            };
            bounds.push(ClockBound { clock, upper: true, bound: plus(i.bound, 2 - by) });
        }
        let elapse = elapse.intersection(&who).copied().collect();
        Shot { who: who.into_iter().collect(), bounds, sets, invariant, elapse }
    })
}

fn own(invariant: &[ClockBound], process: u16) -> Vec<ClockBound> {
    invariant.iter().filter(|b| OWNER[usize::from(b.clock)] == usize::from(process)).copied().collect()
}

fn fire(zone: &LocalZone, shot: &Shot) -> Option<LocalZone> {
    let mut meeting = MeetingBounds::default();
    if !meeting.of(zone, &shot.who, &shot.bounds).unwrap() {
        return None;
    }
    let mut next = LocalZone::default();
    next.restrict(zone, &meeting);
    next.assign(&shot.sets, usize::from(shot.who[0]));
    for &p in &shot.elapse {
        next.elapse(usize::from(p), &own(&shot.invariant, p));
    }
    Some(next)
}

/// The bounds of a zone, without the padding of its rows.
fn unpadded(zone: &LocalZone) -> Vec<LocalZoneBound> {
    zone.rows().flat_map(|row| row[..zone.n].to_vec()).collect()
}

fn padded(d: &[LocalZoneBound], n: usize) -> LocalZone {
    let mut zone = LocalZone::start(PROCESSES, n - PROCESSES);
    for (i, row) in d.chunks_exact(n).enumerate() {
        zone.row_mut(i)[..n].copy_from_slice(row);
    }
    zone
}

/// The same operations, each with a closure from scratch.
fn close(d: &mut [LocalZoneBound], n: usize) -> bool {
    for k in 0..n {
        for i in 0..n {
            for j in 0..n {
                d[i * n + j] = d[i * n + j].min(plus(d[i * n + k], d[k * n + j]));
            }
        }
    }
    (0..n).all(|i| d[i * n + i] >= ZERO)
}

fn fire_slowly(zone: &LocalZone, shot: &Shot) -> Option<LocalZone> {
    let (n, now) = (zone.n, usize::from(shot.who[0]));
    let mut d = unpadded(zone);
    for &p in &shot.who {
        for &q in &shot.who {
            let at = usize::from(p) * n + usize::from(q);
            d[at] = d[at].min(ZERO);
        }
    }
    for b in &shot.bounds {
        let k = PROCESSES + usize::from(b.clock);
        let at = if b.upper { now * n + k } else { k * n + now };
        d[at] = d[at].min(b.bound);
    }
    if !close(&mut d, n) {
        return None;
    }
    // New variables with new names, then the old ones go.
    let m = n + 4;
    let mut wide = vec![INF; m * m];
    (0..m).for_each(|i| wide[i * m + i] = ZERO);
    (0..n * n).for_each(|at| wide[at / n * m + at % n] = d[at]);
    for s in &shot.sets {
        let (k, from) = (n + usize::from(s.clock), s.from.map_or(now, |y| PROCESSES + usize::from(y)));
        (wide[from * m + k], wide[k * m + from]) = (s.by, 2 - s.by);
    }
    assert!(close(&mut wide, m));
    let is_set = |clock: usize| shot.sets.iter().any(|s| usize::from(s.clock) == clock);
    let name = |i: usize| if i >= PROCESSES && is_set(i - PROCESSES) { n + i - PROCESSES } else { i };
    (0..n * n).for_each(|at| d[at] = wide[name(at / n) * m + name(at % n)]);
    for &p in &shot.elapse {
        let p = usize::from(p);
        d[p * n..(p + 1) * n].fill(INF);
        d[p * n + p] = ZERO;
    }
    for &p in &shot.elapse {
        for b in own(&shot.invariant, p) {
            let at = usize::from(p) * n + PROCESSES + usize::from(b.clock);
            d[at] = d[at].min(b.bound);
        }
    }
    close(&mut d, n).then_some(padded(&d, n))
}

fn synchronise_slowly(zone: &LocalZone) -> Option<Vec<LocalZoneBound>> {
    let n = zone.n;
    let mut d = unpadded(zone);
    for p in 0..PROCESSES {
        for q in 0..PROCESSES {
            d[p * n + q] = d[p * n + q].min(ZERO);
        }
    }
    let of: Vec<usize> = std::iter::once(0).chain(PROCESSES..n).collect();
    close(&mut d, n)
        .then(|| of.iter().flat_map(|i| of.iter().map(|j| d[i * n + j]).collect::<Vec<_>>()).collect())
}

/// Whole-numbered valuations up to a last time: `t_0, t_1, t_2`, then the four time stamps.
type Points = BTreeSet<[i8; 7]>;
const LAST: i8 = 4;

fn value(p: &[i8; 7], clock: usize) -> i32 {
    i32::from(p[OWNER[clock]]) - i32::from(p[PROCESSES + clock])
}

fn keeps(p: &[i8; 7], b: &ClockBound) -> bool {
    let v = value(p, usize::from(b.clock));
    2 * (if b.upper { v } else { -v }) < b.bound
}

fn fire_points(points: &Points, shot: &Shot) -> Points {
    let now = usize::from(shot.who[0]);
    let mut out = Points::new();
    for p in points {
        if !shot.who.iter().all(|&q| p[usize::from(q)] == p[now]) || !shot.bounds.iter().all(|b| keeps(p, b))
        {
            continue;
        }
        let mut after = *p;
        for s in &shot.sets {
            let from = s.from.map_or(p[now], |y| p[PROCESSES + usize::from(y)]);
            after[PROCESSES + usize::from(s.clock)] = from - (s.by >> 1) as i8;
        }
        out.insert(after);
    }
    for &q in &shot.elapse {
        let invariant = own(&shot.invariant, q);
        let later = |p: &[i8; 7]| {
            let mut p = *p;
            p[usize::from(q)] += 1;
            (p[usize::from(q)] <= LAST && invariant.iter().all(|b| keeps(&p, b))).then_some(p)
        };
        let mut new: Vec<_> = out.iter().copied().collect();
        while let Some(p) = new.pop() {
            if let Some(next) = later(&p)
                && out.insert(next)
            {
                new.push(next);
            }
        }
    }
    out
}

fn contains(zone: &LocalZone, p: &[i8; 7]) -> bool {
    let all = (0..7).flat_map(|i| (0..7).map(move |j| (i, j)));
    all.into_iter().all(|(i, j)| 2 * (i32::from(p[i]) - i32::from(p[j])) < zone.row(i)[j])
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    /// Strict bounds included: what the operations make is canonical and what bounds with a full closure make.
    #[test]
    fn transitions_need_no_closure(shots in proptest::collection::vec(shot(true), 1..10)) {
        let mut zone = LocalZone::start(PROCESSES, 4);
        let mut out = Vec::new();
        for s in &shots {
            let next = fire(&zone, s);
            prop_assert_eq!(&next, &fire_slowly(&zone, s));
            zone = next.unwrap_or(zone);
            let any = zone.synchronised(&[0, 1, 2, 3], &mut MeetingBounds::default(), &mut out).unwrap();
            prop_assert_eq!(any.then(|| out.clone()), synchronise_slowly(&zone));
            // What is forgotten leaves the rest as it is.
            let mut less = zone.clone();
            less.forget(&[0, 2]);
            let mut two = Vec::new();
            prop_assert_eq!(less.synchronised(&[0, 2], &mut MeetingBounds::default(), &mut two).unwrap(), any);
            let all = [0, 1, 3].into_iter().flat_map(|i| [0, 1, 3].map(|j| i * 5 + j));
            prop_assert!(!any || all.zip(&two).all(|(at, b)| out[at] == *b));
            let closed = { let mut d = unpadded(&less); close(&mut d, 7); padded(&d, 7) };
            prop_assert_eq!(closed, less);
        }
    }

    /// aLU with the greatest constants simulates at least what inclusion does, and without any it sees no difference.
    #[test]
    fn simulation_widens_inclusion(a in proptest::collection::vec(shot(true), 1..8), b in proptest::collection::vec(shot(true), 1..8)) {
        let zone = |shots: &[Shot]| {
            let start = LocalZone::start(PROCESSES, 4);
            let end = shots.iter().fold(start, |z, s| fire(&z, s).unwrap_or(z));
            let mut out = Vec::new();
            end.synchronised(&[0, 1, 2, 3], &mut MeetingBounds::default(), &mut out).unwrap().then_some(out)
        };
        let (Some(a), Some(b)) = (zone(&a), zone(&b)) else { return Ok(()) };
        let lu = |lower, upper| [LocalLuBounds { lower, upper }; 4];
        let includes = a.iter().zip(&b).all(|(a, b)| a <= b);
        let far = lu(lt(-1000).unwrap(), le(-1000).unwrap());
        prop_assert_eq!(is_simulated(&a, &b, &far), includes);
        if includes {
            prop_assert!(is_simulated(&a, &b, &lu(lt(-3).unwrap(), le(-2).unwrap())));
        }
        prop_assert!(is_simulated(&a, &b, &lu(INF, INF)));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    /// Bounds that are not strict: the zone has exactly the whole-numbered valuations that runs have.
    #[test]
    fn zones_are_sets_of_valuations(shots in proptest::collection::vec(shot(false), 1..6)) {
        let mut zone = LocalZone::start(PROCESSES, 4);
        let mut points = Points::from([[0; 7]]);
        for s in &shots {
            // Copies as they are, so that time stamps stay where they are looked for.
            let mut s = s.clone();
            let lasts = |s: &ClockAssignment| s.clock == 3 || s.from == Some(3);
            s.invariant.retain(|b| s.sets.iter().all(|s| s.clock != b.clock || !lasts(s)));
            s.sets.retain(|s| !lasts(s));
            s.sets.iter_mut().filter(|s| s.from.is_some()).for_each(|s| s.by = ZERO);
            let s = &s;
            let next = fire_points(&points, s);
            let Some(z) = fire(&zone, s) else {
                prop_assert!(next.is_empty());
                break;
            };
            (zone, points) = (z, next);
            let mut members = Points::new();
            let mut at = [-1i8; 7];
            at[..PROCESSES].fill(0);
            // Zones do not know when a run started: clock 3, which keeps its time stamp, says it.
            at[6] = 0;
            loop {
                if contains(&zone, &at) {
                    members.insert(at);
                }
                let Some(i) = (0..7).find(|&i| i < 6 && at[i] < LAST) else { break };
                at[i] += 1;
                (0..i).for_each(|j| at[j] = if j < PROCESSES { 0 } else { -1 });
            }
            prop_assert_eq!(&members, &points);
            let mut out = Vec::new();
            let any = zone.synchronised(&[0, 1, 2, 3], &mut MeetingBounds::default(), &mut out).unwrap();
            for p in points.iter().filter(|p| p[0] == p[1] && p[1] == p[2]) {
                prop_assert!(any);
                let v = |i: usize| if i == 0 { 0 } else { value(p, i - 1) };
                let inside = (0..5).all(|i| (0..5).all(|j| 2 * (v(j) - v(i)) < out[i * 5 + j]));
                prop_assert!(inside);
            }
        }
    }
}
