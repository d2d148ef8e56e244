//! When the transitions of a path happen, where clocks stand still: an exact linear program over the delays.
//!
//! A clock's value is what it was set to, plus the delays since in which it ran. So a bound on clocks is one on a sum of delays,
//! with factors of 1 and -1. Strict bounds leave some room: it is made as great as can be, at most one unit, and then a thousandth of it is
//! kept, so that the run ends about as early as it can.

use hrdsl_ir::Nanos;

use crate::{
    network::semantics::ClockReset,
    witness::{
        error::SearchError,
        simplex::{LinearBound, LinearOverflow, LinearSolution, greatest},
    },
    zone::constraint::DifferenceConstraint,
};

/// How much of the room that strict bounds leave is kept.
const ROOM: i128 = 1_000;

/// A clock now: the delays in which it ran since it was set, ascending, and what it was set to.
#[derive(Clone, Debug, Default)]
struct RunDelays {
    ran: Vec<usize>,
    plus: i64,
}

/// The delays of a path under construction.
#[derive(Clone, Debug)]
pub(crate) struct DelayProgram {
    delays: usize,
    /// By the number of a time: how many delays are before it.
    before: Vec<usize>,
    clocks: Vec<RunDelays>,
    /// Each once.
    bounds: Vec<DelayBound>,
}

/// A bound on delays.
#[derive(Clone, Debug, PartialEq, Eq)]
struct DelayBound {
    /// The delays by number, ascending, and with which sign each counts.
    signs: Vec<(usize, i8)>,
    most: i64,
    is_strict: bool,
}

/// How far a clock can go along a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ClockExtremum {
    Unbounded,
    /// So many units, as a fraction with a denominator of at least 1; `attained`: some run comes to it, not only as near as one likes.
    At {
        units: i128,
        over: i128,
        attained: bool,
    },
}

/// The clocks at a time of the path.
#[derive(Clone, Debug)]
pub(crate) struct ClocksThen {
    clocks: Vec<RunDelays>,
    delays: usize,
}

/// Times as whole parts of a nanosecond.
pub(crate) struct DelayTimes {
    pub ticks: i64,
    pub at: Vec<i64>,
}

impl DelayBound {
    /// `i - j ≺ most`.
    fn of_difference(i: &RunDelays, j: &RunDelays, most: i64, is_strict: bool) -> Self {
        let mut signs: Vec<(usize, i8)> = i.ran.iter().map(|&k| (k, 1)).collect();
        for k in &j.ran {
            match signs.binary_search_by_key(k, |s| s.0) {
                Ok(at) => drop(signs.remove(at)),
                Err(at) => signs.insert(at, (*k, -1)),
            }
        }
        Self { signs, most: most - i.plus + j.plus, is_strict }
    }

    /// The factors of so many delays, and 0 for the room.
    fn factors(&self, delays: usize, factor: i128) -> Vec<i128> {
        let mut factors = vec![0; delays + 1];
        self.signs.iter().for_each(|&(k, sign)| factors[k] = i128::from(sign) * factor);
        factors
    }
}

impl DelayProgram {
    /// All clocks are zero at the start. `dim` counts the reference clock.
    pub(crate) fn new(dim: usize) -> Self {
        Self { delays: 0, before: vec![0], clocks: vec![RunDelays::default(); dim], bounds: Vec::new() }
    }

    /// The next time; `stopped`: the clocks that stand still until then.
    pub(crate) fn next(&mut self, may_pass: bool, stopped: &[u16]) {
        if may_pass {
            for (x, clock) in self.clocks.iter_mut().enumerate().skip(1) {
                if !stopped.iter().any(|&s| usize::from(s) == x) {
                    clock.ran.push(self.delays);
                }
            }
            self.delays += 1;
        }
        self.before.push(self.delays);
    }

    /// `x_i - x_j ≺ b` now.
    pub(crate) fn require(&mut self, c: DifferenceConstraint) {
        if c.bound.is_infinite() {
            return;
        }
        let (i, j) = (&self.clocks[usize::from(c.i)], &self.clocks[usize::from(c.j)]);
        let bound = DelayBound::of_difference(i, j, c.bound.value(), c.bound.is_strict());
        self.keep(bound);
    }

    fn keep(&mut self, bound: DelayBound) {
        if !self.bounds.contains(&bound) {
            self.bounds.push(bound);
        }
    }

    /// The clocks now, to be compared with later.
    pub(crate) fn clocks_now(&self) -> ClocksThen {
        ClocksThen { clocks: self.clocks.clone(), delays: self.delays }
    }

    /// The clock has the value that it had then.
    pub(crate) fn require_as_then(&mut self, then: &ClocksThen, clock: usize) {
        let (now, then) = (&self.clocks[clock], &then.clocks[clock]);
        let both =
            [DelayBound::of_difference(now, then, 0, false), DelayBound::of_difference(then, now, 0, false)];
        both.into_iter().for_each(|bound| self.keep(bound));
    }

    /// The clock had more than so many units then.
    pub(crate) fn require_beyond_then(&mut self, then: &ClocksThen, clock: usize, units: i64) {
        self.keep(DelayBound::of_difference(&RunDelays::default(), &then.clocks[clock], -units, true));
    }

    /// Whether time can pass between then and now. `None`: the numbers are too large to tell.
    pub(crate) fn can_pass_since(&self, then: &ClocksThen) -> Option<bool> {
        let signs: Vec<(usize, i8)> = (then.delays..self.delays).map(|k| (k, -1)).collect();
        let some = DelayBound { signs, most: 0, is_strict: true };
        let mut program = self.clone();
        program.keep(some);
        program.feasible()
    }

    /// The greatest or least value of a clock now, of those that keep all bounds; `None`: there are none.
    ///
    /// # Errors
    /// The numbers are too large.
    pub(crate) fn extremum(
        &self,
        clock: usize,
        is_greatest: bool,
    ) -> Result<Option<ClockExtremum>, SearchError> {
        self.found_extremum(clock, is_greatest).map_err(|LinearOverflow| large())
    }

    fn found_extremum(
        &self,
        clock: usize,
        is_greatest: bool,
    ) -> Result<Option<ClockExtremum>, LinearOverflow> {
        if self.room(None)?.is_none() {
            return Ok(None);
        }
        let (of, sign) = (&self.clocks[clock], if is_greatest { 1 } else { -1 });
        let mut goal = vec![0; self.delays + 1];
        of.ran.iter().for_each(|&k| goal[k] = sign);
        // What strict bounds leave out makes no difference to how near one comes.
        let closed: Vec<LinearBound> = self.bounds.iter().map(|b| self.row(b, 0)).collect();
        let (values, over) = match greatest(&closed, &goal)? {
            LinearSolution::Infeasible => return Ok(None),
            LinearSolution::Unbounded => return Ok(Some(ClockExtremum::Unbounded)),
            LinearSolution::Vertex { values, over } => (values, over),
        };
        let ran: i128 = of.ran.iter().map(|&k| values[k]).sum();
        let there = goal.iter().map(|&sign| -sign * over).collect();
        let attained = self.room(Some(LinearBound { factors: there, most: -sign * ran }))?.is_some();
        let units = i128::from(of.plus).checked_mul(over).and_then(|plus| plus.checked_add(ran));
        let units = units.ok_or(LinearOverflow)?;
        let shared = gcd(units, over);
        Ok(Some(ClockExtremum::At { units: units / shared, over: over / shared, attained }))
    }

    /// Sets clocks now, all at once.
    pub(crate) fn set(&mut self, sets: &[ClockReset]) {
        let before = self.clocks.clone();
        for s in sets {
            let from = &before[usize::from(s.from)];
            let ran = if s.from == 0 { Vec::new() } else { from.ran.clone() };
            let plus = if s.from == 0 { s.by } else { from.plus + s.by };
            self.clocks[usize::from(s.clock)] = RunDelays { ran, plus };
        }
    }

    /// Whether some delays keep all bounds. `None`: the numbers are too large to tell.
    pub(crate) fn feasible(&self) -> Option<bool> {
        self.vertex(false).ok().map(|found| found.is_some())
    }

    /// Times that keep all bounds, with the least end; `Ok(None)`: there are none. `unit` is in nanoseconds.
    ///
    /// # Errors
    /// The numbers are too large.
    pub(crate) fn solve(&self, unit: Nanos) -> Result<Option<DelayTimes>, SearchError> {
        let Some((values, over)) = self.vertex(true).map_err(|LinearOverflow| large())? else {
            return Ok(None);
        };
        let unit = i128::from(unit);
        let mut sums = vec![0i128];
        for value in &values {
            let length = value.checked_mul(unit).ok_or_else(large)?;
            let last = sums.last().copied().unwrap_or(0);
            sums.push(last.checked_add(length).ok_or_else(large)?);
        }
        let shared = sums.iter().fold(over, |g, n| gcd(g, *n));
        let narrow = |n: i128| i64::try_from(n / shared).map_err(|_| large());
        let at = self.before.iter().map(|&k| narrow(sums[k]));
        Ok(Some(DelayTimes { ticks: narrow(over)?, at: at.collect::<Result<_, _>>()? }))
    }

    /// A bound's row, with the room that it must leave as its last variable.
    fn row(&self, bound: &DelayBound, room: i128) -> LinearBound {
        let mut factors = bound.factors(self.delays, 1);
        factors[self.delays] = room;
        LinearBound { factors, most: i128::from(bound.most) }
    }

    /// Delays that keep all bounds, those and another one, with as much room as can be; the room is the last. `None`: there is none.
    fn room(&self, besides: Option<LinearBound>) -> Result<Option<(Vec<i128>, i128)>, LinearOverflow> {
        let mut bounds: Vec<LinearBound> =
            self.bounds.iter().map(|b| self.row(b, i128::from(b.is_strict))).collect();
        let mut most = vec![0; self.delays + 1];
        most[self.delays] = 1;
        bounds.push(LinearBound { factors: most.clone(), most: 1 });
        bounds.extend(besides);
        match greatest(&bounds, &most)? {
            LinearSolution::Vertex { values, over } => {
                let some = values.last().is_some_and(|room| *room != 0);
                Ok(some.then_some((values, over)))
            }
            LinearSolution::Infeasible | LinearSolution::Unbounded => Ok(None),
        }
    }

    /// The delays, in units, as numerators over one denominator.
    fn vertex(&self, earliest: bool) -> Result<Option<(Vec<i128>, i128)>, LinearOverflow> {
        let Some((mut values, over)) = self.room(None)? else { return Ok(None) };
        let width = values.pop().unwrap_or(0);
        if !earliest {
            return Ok(Some((values, over)));
        }
        let shared = gcd(width, over.checked_mul(ROOM).ok_or(LinearOverflow)?);
        let (part, of) = (width / shared, over.checked_mul(ROOM).ok_or(LinearOverflow)? / shared);
        let mut kept = Vec::with_capacity(self.bounds.len());
        for bound in &self.bounds {
            let (factor, less) = if bound.is_strict { (of, part) } else { (1, 0) };
            let most = i128::from(bound.most).checked_mul(factor).and_then(|m| m.checked_sub(less));
            let factors = bound.factors(self.delays, factor);
            kept.push(LinearBound { factors, most: most.ok_or(LinearOverflow)? });
        }
        let mut sum = vec![-1; self.delays + 1];
        sum[self.delays] = 0;
        let LinearSolution::Vertex { mut values, over } = greatest(&kept, &sum)? else { return Ok(None) };
        values.pop();
        Ok(Some((values, over)))
    }
}

fn large() -> SearchError {
    SearchError::Internal("the times of a run need numbers of more than 128 bits".to_owned())
}

fn gcd(mut a: i128, mut b: i128) -> i128 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a.abs().max(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::zone::dbm::DbmBound;

    fn at_least(clock: u16, n: i64) -> DifferenceConstraint {
        DifferenceConstraint { i: 0, j: clock, bound: DbmBound::le(-n) }
    }

    fn at_most(clock: u16, n: i64) -> DifferenceConstraint {
        DifferenceConstraint { i: clock, j: 0, bound: DbmBound::le(n) }
    }

    /// Clock 2 stands through the second of three delays.
    fn three() -> DelayProgram {
        let mut p = DelayProgram::new(3);
        p.next(true, &[]);
        p.next(true, &[2]);
        p.require(at_least(1, 5));
        p.next(true, &[]);
        p
    }

    #[test]
    fn a_clock_that_stands_needs_longer() {
        let mut p = three();
        p.require(at_least(2, 7));
        let times = p.solve(10).unwrap().unwrap();
        // The end is least if the second delay is nothing.
        assert_eq!((times.ticks, times.at.last().copied()), (1, Some(70)));
        p.require(at_most(2, 7));
        p.require(at_least(1, 9));
        let times = p.solve(10).unwrap().unwrap();
        assert_eq!((times.ticks, times.at.last().copied()), (1, Some(90)));
        assert_eq!(times.at[2] - times.at[1], 20);
    }

    #[test]
    fn what_zones_of_stopped_clocks_allow_may_have_no_times() {
        let mut p = three();
        p.require(at_most(1, 9));
        p.require(at_least(2, 10));
        assert!(p.solve(10).unwrap().is_none());
        assert_eq!(p.feasible(), Some(false));
    }

    #[test]
    fn how_far_a_clock_goes_is_a_fraction_and_attained_or_not() {
        // x runs in the first and second of three delays, y in the second and third, z in the first and third; t in all.
        let mut p = DelayProgram::new(5);
        for stands in [2, 3, 1] {
            p.next(true, &[stands]);
        }
        let at = |units, over, attained| Ok(Some(ClockExtremum::At { units, over, attained }));
        assert_eq!(p.found_extremum(4, true), Ok(Some(ClockExtremum::Unbounded)));
        [1, 2, 3].into_iter().for_each(|clock| p.require(at_most(clock, 1)));
        assert_eq!(p.found_extremum(4, true), at(3, 2, true));
        assert_eq!(p.found_extremum(4, false), at(0, 1, true));
        p.require(DifferenceConstraint { i: 1, j: 0, bound: DbmBound::lt(1) });
        assert_eq!(p.found_extremum(4, true), at(3, 2, false));
        assert_eq!(p.found_extremum(2, true), at(1, 1, true));
        p.require(at_least(1, 1));
        assert_eq!(p.found_extremum(2, true), Ok(None));
    }

    #[test]
    fn clocks_come_round_only_if_they_were_set_or_stood() {
        let mut p = DelayProgram::new(3);
        p.next(true, &[]);
        let then = p.clocks_now();
        p.next(true, &[2]);
        let mut again = p.clone();
        again.require_as_then(&then, 2);
        assert_eq!((again.feasible(), again.can_pass_since(&then)), (Some(true), Some(true)));
        again.require_as_then(&then, 1);
        assert_eq!((again.feasible(), again.can_pass_since(&then)), (Some(true), Some(false)));
        p.require_beyond_then(&then, 1, 4);
        p.require(at_most(2, 4));
        assert_eq!(p.feasible(), Some(false));
    }

    #[test]
    fn strict_bounds_keep_a_little_room() {
        let mut p = DelayProgram::new(2);
        p.next(true, &[]);
        p.require(DifferenceConstraint { i: 0, j: 1, bound: DbmBound::lt(-2) });
        p.require(DifferenceConstraint { i: 1, j: 0, bound: DbmBound::lt(3) });
        let times = p.solve(1).unwrap().unwrap();
        let time = times.at[1];
        assert!(time > 2 * times.ticks && time * 100 < 201 * times.ticks, "{time}/{}", times.ticks);
        p.require(DifferenceConstraint { i: 1, j: 0, bound: DbmBound::le(2) });
        assert!(p.solve(1).unwrap().is_none());
    }
}
