//! The tightest bounds with which recordings conform: times are tried, and the recordings followed with each.

use hrdsl_ir::{Nanos, Program, ta::ClockOp};

use crate::{
    bounds::{ModelBound, replaced},
    model::limit,
};

/// Times that are proposed are whole multiples of this, or of a tenth of it and so on, if the model's own times are finer.
const COARSEST_STEP: Nanos = 10_000_000;

/// By how many steps one side of a bound is loosened; none: that side is gone.
pub(crate) type Loosening = Option<i64>;

/// One side of a bound: an equality has two.
#[derive(Clone, Copy, Debug)]
struct LoosenedSide {
    /// Which of the bounds.
    bound: usize,
    is_upper: bool,
    time: Nanos,
    /// Loosened by so many steps, it excludes nothing in a recording.
    widest: i64,
}

/// Bounds that may be loosened.
pub(crate) struct BoundFitting<'a> {
    program: &'a Program,
    bounds: &'a [ModelBound],
    sides: Vec<LoosenedSide>,
    step: Nanos,
}

impl<'a> BoundFitting<'a> {
    /// `all` are the bounds of the model, `bounds` those that may be loosened, `end` is the last time of the recordings.
    pub(crate) fn new(
        program: &'a Program,
        all: &[ModelBound],
        bounds: &'a [ModelBound],
        end: Nanos,
    ) -> Self {
        let mut step = COARSEST_STEP;
        while step > 1 && all.iter().any(|bound| bound.time % step != 0) {
            step /= 10;
        }
        let end = limit(program).map_or(end, |limit| limit.max(end));
        let mut sides = Vec::new();
        for (number, bound) in bounds.iter().enumerate() {
            let (lower, upper) = match bound.op {
                ClockOp::Lt | ClockOp::Le => (false, true),
                ClockOp::Eq => (true, true),
                ClockOp::Ge | ClockOp::Gt => (true, false),
            };
            let side = |is_upper, distance: Nanos| LoosenedSide {
                bound: number,
                is_upper,
                time: bound.time,
                widest: (distance.max(0) + step - 1) / step + 1,
            };
            if lower {
                sides.push(side(false, bound.time - step));
            }
            if upper {
                sides.push(side(true, end - bound.time));
            }
        }
        Self { program, bounds, sides, step }
    }

    /// The time of a side that is loosened by so many steps.
    fn time(&self, side: &LoosenedSide, steps: i64) -> Nanos {
        let below = side.time.div_euclid(self.step) * self.step;
        let above = (side.time + self.step - 1).div_euclid(self.step) * self.step;
        match (steps, side.is_upper) {
            (0, _) => side.time,
            (_, true) => below + steps * self.step,
            (_, false) => (above - steps * self.step).max(0),
        }
    }

    /// Whether nothing of a bound is loosened.
    pub(crate) fn is_kept(&self, bound: usize, loosened: &[Loosening]) -> bool {
        let of = self.sides.iter().zip(loosened).filter(|(side, _)| side.bound == bound);
        of.into_iter().all(|(_, steps)| *steps == Some(0))
    }

    /// What stands in the place of a bound.
    pub(crate) fn comparisons(&self, bound: usize, loosened: &[Loosening]) -> Vec<(ClockOp, Nanos)> {
        let own = self.bounds.get(bound).map(|bound| (bound.op, bound.time));
        if self.is_kept(bound, loosened) {
            return own.into_iter().collect();
        }
        let of = self.sides.iter().zip(loosened).filter(|(side, _)| side.bound == bound);
        let comparison = |(side, steps): (&LoosenedSide, &Loosening)| {
            let op = if side.is_upper { ClockOp::Le } else { ClockOp::Ge };
            steps.map(|steps| (op, self.time(side, steps)))
        };
        of.filter_map(comparison).collect()
    }

    /// The program with the bounds loosened so.
    pub(crate) fn applied(&self, loosened: &[Loosening]) -> Program {
        let bounds = self.bounds.iter().cloned().enumerate();
        let all: Vec<_> = bounds.map(|(at, bound)| (bound, self.comparisons(at, loosened))).collect();
        replaced(self.program, &all)
    }

    /// These bounds gone, and all others as they stand.
    pub(crate) fn without(&self, gone: &[ModelBound]) -> Vec<Loosening> {
        let is_gone = |side: &LoosenedSide| self.bounds.get(side.bound).is_some_and(|b| gone.contains(b));
        self.sides.iter().map(|side| (!is_gone(side)).then_some(0)).collect()
    }

    /// Each side loosened as far as it is in one of the two.
    pub(crate) fn looser(a: &[Loosening], b: &[Loosening]) -> Vec<Loosening> {
        a.iter().zip(b).map(|(a, b)| a.zip(*b).map(|(a, b)| a.max(b))).collect()
    }

    /// Tightens one side after the other as far as what conforms still does. What is given conforms, and so does what is returned; none of
    /// its sides could be tighter by a step while the others stay.
    pub(crate) fn tightened(
        &self,
        mut loosened: Vec<Loosening>,
        conforms: &dyn Fn(&Program) -> bool,
    ) -> Vec<Loosening> {
        for (at, side) in self.sides.iter().enumerate() {
            let before = loosened.get(at).copied().flatten();
            if before == Some(0) {
                continue;
            }
            let mut fits = |steps: i64| {
                let mut tried = loosened.clone();
                tried.get_mut(at).into_iter().for_each(|side| *side = Some(steps));
                let is_fit = conforms(&self.applied(&tried));
                if is_fit {
                    loosened = tried;
                }
                is_fit
            };
            let widest = before.unwrap_or(side.widest);
            if fits(0) || (before.is_none() && !fits(widest)) {
                continue;
            }
            let (mut fails, mut fit) = (0, widest);
            while fit - fails > 1 {
                let between = fails + (fit - fails) / 2;
                if fits(between) {
                    fit = between;
                } else {
                    fails = between;
                }
            }
        }
        loosened
    }
}
