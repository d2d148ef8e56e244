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

/// Times as whole parts of a nanosecond.
pub(crate) struct DelayTimes {
    pub ticks: i64,
    pub at: Vec<i64>,
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
        let mut signs: Vec<(usize, i8)> = i.ran.iter().map(|&k| (k, 1)).collect();
        for k in &j.ran {
            match signs.binary_search_by_key(k, |s| s.0) {
                Ok(at) => drop(signs.remove(at)),
                Err(at) => signs.insert(at, (*k, -1)),
            }
        }
        let most = c.bound.value() - i.plus + j.plus;
        let bound = DelayBound { signs, most, is_strict: c.bound.is_strict() };
        if !self.bounds.contains(&bound) {
            self.bounds.push(bound);
        }
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
        let large =
            || SearchError::Internal("the times of a run need numbers of more than 128 bits".to_owned());
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

    /// The delays, in units, as numerators over one denominator.
    fn vertex(&self, earliest: bool) -> Result<Option<(Vec<i128>, i128)>, LinearOverflow> {
        let room = self.delays;
        let row = |signs: &[(usize, i8)], factor: i128| {
            let mut factors = vec![0; self.delays + 1];
            signs.iter().for_each(|&(k, sign)| factors[k] = i128::from(sign) * factor);
            factors
        };
        let mut bounds: Vec<LinearBound> = Vec::with_capacity(self.bounds.len() + 1);
        for DelayBound { signs, most, is_strict } in &self.bounds {
            let mut factors = row(signs, 1);
            factors[room] = i128::from(*is_strict);
            bounds.push(LinearBound { factors, most: i128::from(*most) });
        }
        let mut most = row(&[], 1);
        most[room] = 1;
        bounds.push(LinearBound { factors: most.clone(), most: 1 });
        let LinearSolution::Vertex { mut values, over } = greatest(&bounds, &most)? else { return Ok(None) };
        let width = values.pop().unwrap_or(0);
        if width == 0 {
            return Ok(None);
        }
        if !earliest {
            return Ok(Some((values, over)));
        }
        let shared = gcd(width, over.checked_mul(ROOM).ok_or(LinearOverflow)?);
        let (part, of) = (width / shared, over.checked_mul(ROOM).ok_or(LinearOverflow)? / shared);
        let mut kept = Vec::with_capacity(self.bounds.len());
        for DelayBound { signs, most, is_strict } in &self.bounds {
            let (factor, less) = if *is_strict { (of, part) } else { (1, 0) };
            let most = i128::from(*most).checked_mul(factor).and_then(|m| m.checked_sub(less));
            kept.push(LinearBound { factors: row(signs, factor), most: most.ok_or(LinearOverflow)? });
        }
        let mut sum = vec![-1; self.delays + 1];
        sum[room] = 0;
        let LinearSolution::Vertex { mut values, over } = greatest(&kept, &sum)? else { return Ok(None) };
        values.pop();
        Ok(Some((values, over)))
    }
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
