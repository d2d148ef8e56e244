//! When the transitions of a path happen: a solution of the difference constraints that the path puts on their times.
//!
//! A clock's value is the time since a transition that set it, plus what it was set to; so a bound on clocks is one on the
//! difference of two times. A strict bound counts as one infinitely small step ε more, so that a time is `a` units and `b` ε.
//! Then ε is made one tick. A tick is a nanosecond, unless the unit of the network is so small that the path's ε would add up
//! to a unit; then it is a fraction of one. In ticks all constraints are closed and whole, so that greatest and sampled
//! times, too, are those of a network of whole differences: what a prefix allows of the next time is an interval.

use hrdsl_ir::{Nanos, suite::DelayChoice, value::SECOND};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::{
    network::{number::gcd, semantics::ClockReset},
    witness::{
        error::SearchError,
        standing::{DelayProgram, DelayTimes},
    },
    zone::constraint::DifferenceConstraint,
};

/// How long a transition waits beyond its earliest time if nothing bounds it, with delays that are not the earliest.
pub const DAWDLE: Nanos = SECOND;

/// How the times are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ScheduleOptions {
    /// `Latest`: each as late as the whole path allows, [`DAWDLE`] after its earliest time if nothing bounds it. `Sampled`:
    /// one after the other, evenly in the interval that the times before it leave (at most `DAWDLE` long if it has no end).
    pub delays: DelayChoice,
    /// For sampled delays.
    pub seed: u64,
    /// The last time stays the least possible.
    pub prompt: bool,
}

/// A time: units, then infinitely small steps.
type ScheduleTime = (i64, i64);

/// `later ≥ earlier + (units, ε)`, of the times with these numbers.
#[derive(Clone, Copy, Debug)]
struct TimeSeparation {
    later: usize,
    earlier: usize,
    by: ScheduleTime,
}

/// The times of a path under construction; time 0 is the start.
#[derive(Clone, Debug)]
pub(crate) struct PathSchedule {
    now: usize,
    constraints: Vec<TimeSeparation>,
    /// For each clock of the network: the time at which it was set, and to how many units.
    set: Vec<(usize, i64)>,
    /// Where clocks stand still somewhere: instead of all this.
    standing: Option<DelayProgram>,
}

/// Times in ticks.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ScheduledTimes {
    /// Ticks in a nanosecond.
    pub ticks: i64,
    /// From the start's 0 on.
    pub at: Vec<i64>,
    /// Whether time can pass between the time of this number and the last: the greatest difference is not 0.
    spans: Vec<bool>,
}

impl ScheduledTimes {
    /// Whether time can pass from the time of this number to the end.
    pub(crate) fn can_last(&self, from: usize) -> bool {
        self.spans.get(from).copied().unwrap_or(false)
    }
}

impl PathSchedule {
    /// All clocks are zero at the start. `dim` counts the reference clock.
    pub(crate) fn new(dim: usize) -> Self {
        Self { now: 0, constraints: Vec::new(), set: vec![(0, 0); dim], standing: None }
    }

    /// The same for a network in which clocks stand still.
    pub(crate) fn with_standing_clocks(dim: usize) -> Self {
        Self { standing: Some(DelayProgram::new(dim)), ..Self::new(dim) }
    }

    /// Whether there are times that keep all constraints. `None`: the numbers are too large to tell.
    pub(crate) fn feasible(&self) -> Option<bool> {
        match &self.standing {
            Some(program) => program.feasible(),
            None => Some(least(self.now + 1, &self.constraints).is_some()),
        }
    }

    /// The delays, where clocks stand still.
    pub(crate) fn standing(&self) -> Option<&DelayProgram> {
        self.standing.as_ref()
    }

    /// As [`standing`](Self::standing), to be bounded further.
    pub(crate) fn standing_mut(&mut self) -> Option<&mut DelayProgram> {
        self.standing.as_mut()
    }

    /// As [`solve`](Self::solve). Where clocks stand still, the times are those with the least end, whatever else was asked for.
    ///
    /// # Errors
    /// The numbers are too large.
    pub(crate) fn timed(
        &self,
        unit: Nanos,
        timing: ScheduleOptions,
    ) -> Result<Option<ScheduledTimes>, SearchError> {
        let Some(program) = &self.standing else { return Ok(self.solve(unit, timing)) };
        let times = program.solve(unit)?;
        Ok(times.map(|DelayTimes { ticks, at }| ScheduledTimes { ticks, spans: vec![false; at.len()], at }))
    }

    /// The next time, later than the last one or, if time may not pass, the same. Gives its number.
    #[cfg(test)]
    pub(crate) fn next(&mut self, may_pass: bool) -> usize {
        self.next_but(may_pass, &[])
    }

    /// As [`next`](Self::next); meanwhile these clocks stand still.
    pub(crate) fn next_but(&mut self, may_pass: bool, stopped: &[u16]) -> usize {
        let before = self.now;
        self.now += 1;
        if let Some(program) = &mut self.standing {
            program.next(may_pass, stopped);
            return self.now;
        }
        self.constraints.push(TimeSeparation { later: self.now, earlier: before, by: (0, 0) });
        if !may_pass {
            self.constraints.push(TimeSeparation { later: before, earlier: self.now, by: (0, 0) });
        }
        self.now
    }

    /// `x_i - x_j ≺ b` now.
    ///
    /// INVARIANT: a clock is `now - t + c` if it was set to c at t, and the reference clock is `now - now + 0`; so the bound
    /// is `t_j - t_i ≺ b - c_i + c_j`.
    pub(crate) fn require(&mut self, c: DifferenceConstraint) {
        if let Some(program) = &mut self.standing {
            return program.require(c);
        }
        let set = |x: u16| if x == 0 { (self.now, 0) } else { self.set[usize::from(x)] };
        if c.bound.is_infinite() {
            return;
        }
        let (i, j) = (set(c.i), set(c.j));
        let by = (-(c.bound.value() - i.1 + j.1), i64::from(c.bound.is_strict()));
        self.constraints.push(TimeSeparation { later: i.0, earlier: j.0, by });
    }

    /// Sets clocks now, all at once.
    pub(crate) fn set(&mut self, sets: &[ClockReset]) {
        if let Some(program) = &mut self.standing {
            return program.set(sets);
        }
        let before = self.set.clone();
        for s in sets {
            let (at, value) = if s.from == 0 { (self.now, 0) } else { before[usize::from(s.from)] };
            self.set[usize::from(s.clock)] = (at, value + s.by);
        }
    }

    /// Times that keep all constraints; `None`: there are none. `unit` is in nanoseconds.
    pub(crate) fn solve(&self, unit: Nanos, timing: ScheduleOptions) -> Option<ScheduledTimes> {
        let count = self.now + 1;
        let least = least(count, &self.constraints)?;
        let most = least.iter().map(|t| t.1).max().unwrap_or(0);
        // What all times of the path are whole multiples of, but for their small steps.
        let grain = self.constraints.iter().fold(0, |g, c| gcd(g, c.by.0.unsigned_abs()));
        let ticks = match i64::try_from(grain) {
            // Small steps alone: any tick will do.
            Ok(0) => 1,
            Ok(grain) => most / unit.saturating_mul(grain) + 1,
            Err(_) => most / unit + 1,
        };
        let scale = i128::from(unit) * i128::from(ticks);
        let mut net = DifferenceSystem::new(count, scale, &self.constraints);
        if !net.settle_all() {
            return None;
        }
        if timing.prompt {
            net.fix(self.now, net.least[self.now]);
        }
        let spans = net.spans(self.now);
        match timing.delays {
            DelayChoice::Earliest => {}
            DelayChoice::Latest => net.choose(|least, most| most.unwrap_or(least + dawdle(ticks))),
            DelayChoice::Sampled => {
                let mut rng = ChaCha8Rng::seed_from_u64(timing.seed);
                net.choose(|least, most| {
                    let most = most.unwrap_or(least + dawdle(ticks));
                    let width = u64::try_from(most - least).unwrap_or(u64::MAX);
                    least + i128::from(rng.random_range(0..=width))
                });
            }
        }
        let at: Result<Vec<i64>, _> = net.least.iter().map(|t| i64::try_from(*t)).collect();
        Some(ScheduledTimes { ticks, at: at.ok()?, spans })
    }
}

fn dawdle(ticks: i64) -> i128 {
    i128::from(DAWDLE) * i128::from(ticks)
}

/// The least times that keep all constraints, from 0 for the start; `None`: there are none.
fn least(count: usize, constraints: &[TimeSeparation]) -> Option<Vec<ScheduleTime>> {
    let mut times = vec![(0, 0); count];
    for _ in 0..=count {
        let mut changed = false;
        for c in constraints {
            let from: ScheduleTime = times[c.earlier];
            let at = (from.0 + c.by.0, from.1 + c.by.1);
            if at > times[c.later] {
                if c.later == 0 {
                    return None;
                }
                times[c.later] = at;
                changed = true;
            }
        }
        if !changed {
            return Some(times);
        }
    }
    None
}

/// Difference constraints over whole times, with the interval of each time.
///
/// INVARIANT: when it is settled, and the constraints have a solution, each value between `least` and `most` of one time
/// belongs to a solution (the shortest and longest paths from the times that are fixed).
#[derive(Clone)]
struct DifferenceSystem {
    least: Vec<i128>,
    /// `None`: no upper bound.
    most: Vec<Option<i128>>,
    /// For each time: the later ones that are bounded from below by it.
    after: Vec<Vec<(usize, i128)>>,
    /// For each time: the earlier ones that are bounded from above by it.
    before: Vec<Vec<(usize, i128)>>,
}

impl DifferenceSystem {
    fn new(count: usize, scale: i128, constraints: &[TimeSeparation]) -> Self {
        let mut most = vec![None; count];
        most[0] = Some(0);
        let (mut after, mut before) = (vec![Vec::new(); count], vec![Vec::new(); count]);
        for c in constraints {
            let by = i128::from(c.by.0) * scale + i128::from(c.by.1);
            after[c.earlier].push((c.later, by));
            before[c.later].push((c.earlier, by));
        }
        Self { least: vec![0; count], most, after, before }
    }

    fn settle_all(&mut self) -> bool {
        (0..self.least.len()).all(|k| self.spread(k))
    }

    /// Passes on what a time's interval says of the others; `false`: there is no solution.
    fn spread(&mut self, from: usize) -> bool {
        let mut waiting = vec![from];
        let mut left = self.least.len().saturating_mul(self.least.len()).saturating_mul(4).max(64);
        while let Some(k) = waiting.pop() {
            // A cycle of constraints without a solution would go on for ever.
            left -= 1;
            if left == 0 {
                return false;
            }
            let DifferenceSystem { least, most, after, before } = self;
            for &(later, by) in &after[k] {
                let at = least[k] + by;
                if at > least[later] {
                    if later == 0 {
                        return false;
                    }
                    least[later] = at;
                    waiting.push(later);
                }
            }
            let Some(end) = most[k] else { continue };
            for &(earlier, by) in &before[k] {
                let at = end - by;
                if most[earlier].is_none_or(|m| at < m) {
                    most[earlier] = Some(at);
                    waiting.push(earlier);
                }
            }
        }
        true
    }

    fn fix(&mut self, k: usize, at: i128) {
        self.least[k] = at;
        self.most[k] = Some(at);
        self.spread(k);
    }

    /// Fixes each time in turn, at what is chosen of its interval.
    fn choose(&mut self, mut pick: impl FnMut(i128, Option<i128>) -> i128) {
        for k in 1..self.least.len() {
            let at = pick(self.least[k], self.most[k]);
            self.fix(k, at);
        }
    }

    /// For each time whether the last can be later than it: the shortest path of upper bounds from the last.
    fn spans(&self, last: usize) -> Vec<bool> {
        let mut slack: Vec<Option<i128>> = vec![None; self.least.len()];
        slack[last] = Some(0);
        let mut waiting = vec![last];
        while let Some(k) = waiting.pop() {
            let Some(far) = slack[k] else { continue };
            // INVARIANT: `later ≥ k + by`, so `last - later ≤ (last - k) - by`; no cycle gets shorter, for there is a solution.
            for &(later, by) in &self.after[k] {
                let bound = far - by;
                if slack[later].is_none_or(|s| bound < s) {
                    slack[later] = Some(bound);
                    waiting.push(later);
                }
            }
        }
        slack.iter().map(|s| s.is_none_or(|s| s > 0)).collect()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::zone::dbm::DbmBound;

    #[test]
    fn least_times_count_strict_bounds_in_small_steps() {
        // t1 > 2, t2 > t1, t2 < 3, t3 ≥ t2 + 1
        let constraints = [
            TimeSeparation { later: 1, earlier: 0, by: (2, 1) },
            TimeSeparation { later: 2, earlier: 1, by: (0, 1) },
            TimeSeparation { later: 0, earlier: 2, by: (-3, 1) },
            TimeSeparation { later: 3, earlier: 2, by: (1, 0) },
        ];
        assert_eq!(least(4, &constraints), Some(vec![(0, 0), (2, 1), (2, 2), (3, 2)]));
    }

    #[test]
    fn contradiction_has_no_times() {
        let constraints = [
            TimeSeparation { later: 1, earlier: 0, by: (2, 0) },
            TimeSeparation { later: 0, earlier: 1, by: (-2, 1) },
        ];
        assert_eq!(least(2, &constraints), None);
    }

    fn timing(delays: DelayChoice, seed: u64) -> ScheduleOptions {
        ScheduleOptions { delays, seed, prompt: false }
    }

    /// x ≥ 2 at the first, x < 7 at the second, which comes at least 1 after y was set to 3 at the first.
    fn two() -> PathSchedule {
        let mut s = PathSchedule::new(3);
        s.next(true);
        s.require(DifferenceConstraint { i: 0, j: 1, bound: DbmBound::le(-2) });
        s.set(&[ClockReset { clock: 2, from: 0, by: 3 }]);
        s.next(true);
        s.require(DifferenceConstraint { i: 1, j: 0, bound: DbmBound::lt(7) });
        s.require(DifferenceConstraint { i: 0, j: 2, bound: DbmBound::le(-4) });
        s
    }

    #[test]
    fn times_are_earliest_or_latest() {
        let at = |delays| two().solve(10, timing(delays, 0)).unwrap().at;
        assert_eq!(at(DelayChoice::Earliest), [0, 20, 30]);
        assert_eq!(at(DelayChoice::Latest), [0, 59, 69]);
    }

    #[test]
    fn what_nothing_bounds_waits_a_little() {
        let mut s = PathSchedule::new(1);
        s.next(true);
        s.next(false);
        let times = s.solve(SECOND, timing(DelayChoice::Latest, 0)).unwrap();
        assert_eq!(
            (times.at.as_slice(), times.can_last(1), times.can_last(0)),
            ([0, DAWDLE, DAWDLE].as_slice(), false, true)
        );
    }

    #[test]
    fn a_copied_clock_keeps_its_age() {
        let mut s = PathSchedule::new(3);
        s.next(true);
        s.set(&[ClockReset { clock: 2, from: 1, by: 1 }]);
        s.next(true);
        // y = x + 1, so y == 6 when x == 5.
        s.require(DifferenceConstraint { i: 0, j: 2, bound: DbmBound::le(-6) });
        s.require(DifferenceConstraint { i: 2, j: 0, bound: DbmBound::le(6) });
        assert_eq!(s.solve(1, timing(DelayChoice::Earliest, 0)).unwrap().at, [0, 0, 5]);
    }

    proptest! {
        #[test]
        fn all_times_keep_all_constraints(
            cs in prop::collection::vec((0usize..6, 0usize..6, -6i64..6, 0i64..2), 0..14),
            seed in 0u64..1000,
        ) {
            let mut s = PathSchedule::new(1);
            (0..5).for_each(|_| { s.next(true); });
            s.constraints.extend(cs.iter().filter(|c| c.0 != c.1).map(|&(later, earlier, n, e)| TimeSeparation {
                later,
                earlier,
                by: (n, e),
            }));
            let earliest = s.solve(5, timing(DelayChoice::Earliest, seed));
            prop_assert_eq!(earliest.is_some(), least(6, &s.constraints).is_some());
            let Some(earliest) = earliest else { return Ok(()) };
            for delays in [DelayChoice::Earliest, DelayChoice::Latest, DelayChoice::Sampled] {
                for prompt in [false, true] {
                    let t = s.solve(5, ScheduleOptions { delays, seed, prompt }).unwrap();
                    for c in &s.constraints {
                        let by = c.by.0 * 5 * t.ticks;
                        prop_assert!(t.at[c.later] - t.at[c.earlier] >= by + c.by.1, "{:?} {:?}", c, t);
                    }
                    prop_assert_eq!(t.at[0], 0);
                    prop_assert!(t.at.iter().zip(&earliest.at).all(|(a, b)| a >= b));
                    prop_assert!(!prompt || t.at[5] == earliest.at[5]);
                }
            }
            let latest = s.solve(5, timing(DelayChoice::Latest, 0)).unwrap();
            let sampled = s.solve(5, timing(DelayChoice::Sampled, seed)).unwrap();
            // Where the path bounds a time, no sample is later than the latest.
            let mut net = DifferenceSystem::new(6, i128::from(5 * latest.ticks), &s.constraints);
            prop_assert!(net.settle_all());
            for k in 0..6 {
                if let Some(most) = net.most[k] {
                    prop_assert_eq!(i128::from(latest.at[k]), most);
                    prop_assert!(i128::from(sampled.at[k]) <= most);
                }
            }
        }
    }
}
