//! Least upper and greatest lower bounds of clocks and numbers, over all states in which a formula holds.
//!
//! All zones are looked at. What extrapolation keeps of a clock is exact up to the clock's bound, so if a value comes out beyond
//! it, the bound is doubled and the search begins again. It ends when the value is within the bound; when some state of the
//! formula lets time pass for ever, so that the clock is unbounded; or, still open, after [`RAISES`] doublings or when the
//! budget is used up. The last can only happen for a clock that grows in a loop of states each of which bounds time.

use std::ops::ControlFlow;

use hrdsl_ir::{
    Expr, Nanos, Value,
    expr::EvalError,
    ta::{ClockId, Measure},
};
use serde::Serialize;

use crate::{
    Budget, Error, Model, StateFormula, Timing, Witness,
    dbm::{Bound, Dbm},
    graph::{Detail, Graph, Stay},
    network::Constraint,
    plain::{Plain, Seen},
    query::{Slots, Symbolic, no_value},
    witness::{Stop, reach_formula},
};

/// How often a clock's bound is doubled.
pub const RAISES: u32 = 14;

/// A bound of one measure.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Extremum {
    pub limit: Reach,
    /// A run to a state in which the measure has the value, or one less than a unit of time from it.
    pub run: Option<Box<Witness>>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Reach {
    /// `attained`: some state has the value (`<=`); otherwise states come as near as one likes (`<`).
    At { value: Quantity, attained: bool },
    /// It grows without bound.
    Unbounded,
    /// The formula holds nowhere.
    Nowhere,
    /// The search ended too early; this value is not beyond the bound.
    Open { seen: Option<Quantity> },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    Nanos(Nanos),
    Number(i64),
}

/// Upper or lower.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Sup,
    Inf,
}

/// The best value so far: in units or as a number, whether it is attained, and the node.
#[derive(Clone, Copy)]
struct Best {
    value: i64,
    attained: bool,
    node: u32,
}

enum Track {
    Clock { clock: usize, bound: i64, best: Option<Best>, beyond: bool, unbounded: Option<u32> },
    Number { of: Expr, best: Option<Best> },
}

/// The bounds of each measure.
///
/// # Errors
/// If the model is at fault, or a measure has no value where the formula holds.
pub(crate) fn extrema(
    model: &Model,
    side: Side,
    of: &[Measure],
    when: &StateFormula,
    budget: Budget,
    timing: Timing,
) -> Result<Vec<Extremum>, Error> {
    let mut graph = Graph::new(model, Detail::Reach, &[when], 0)?;
    let mut tracks: Vec<Track> = of.iter().map(|m| Track::of(m, &graph)).collect();
    let mut raised = 0;
    loop {
        for t in &tracks {
            if let Track::Clock { clock, bound, .. } = t {
                graph.keep_up_to(*clock, *bound);
            }
        }
        let mut plain = Plain::new(&graph);
        let exhausted = plain.explore(budget, &mut |at, seen, stay| {
            look(&graph, side, when, &mut tracks, at, seen, stay)?;
            Ok(ControlFlow::Continue(()))
        })?;
        let again = exhausted.is_none() && raised < RAISES && tracks.iter().any(|t| t.is_beyond(side));
        if !again {
            let finish = |t: &Track| t.finish(&plain, &graph, side, when, exhausted.is_some(), timing);
            return tracks.iter().map(finish).collect();
        }
        raised += 1;
        tracks.iter_mut().for_each(|t| t.raise(side));
    }
}

fn look(
    graph: &Graph,
    side: Side,
    when: &StateFormula,
    tracks: &mut [Track],
    at: u32,
    seen: &Seen,
    stay: &Stay,
) -> Result<(), Error> {
    let here = graph.here(&seen.state);
    let parts = when.part(&here, &seen.zone)?;
    if parts.is_empty() {
        return Ok(());
    }
    for t in tracks.iter_mut() {
        match t {
            Track::Number { of, best } => {
                let value = of.eval_in(&Slots(&here)).map_err(no_value)?;
                let n = number(value).ok_or_else(|| no_value(EvalError::Type))?;
                improve(best, Best { value: n, attained: true, node: at }, side);
            }
            Track::Clock { clock, best, beyond, unbounded, .. } => {
                for part in parts.zones() {
                    let b = match side {
                        Side::Sup => part.at(*clock, 0),
                        Side::Inf => part.at(0, *clock),
                    };
                    if !b.is_infinite() {
                        let value = if side == Side::Sup { b.value() } else { -b.value() };
                        improve(best, Best { value, attained: !b.is_strict(), node: at }, side);
                    } else if stay.for_ever() && lasts(when, &here, part)? {
                        unbounded.get_or_insert(at);
                    } else {
                        *beyond = true;
                    }
                }
            }
        }
    }
    Ok(())
}

fn number(value: Value) -> Option<i64> {
    value.as_int().or_else(|| value.as_bool().map(i64::from))
}

/// Whether the formula goes on to hold while time passes.
fn lasts(when: &StateFormula, here: &dyn Symbolic, part: &Dbm) -> Result<bool, Error> {
    let mut later = part.clone();
    later.up();
    Ok(when.part(here, &later)?.includes(&later))
}

fn improve(best: &mut Option<Best>, new: Best, side: Side) {
    let better = best.is_none_or(|old| {
        let beyond = match side {
            Side::Sup => new.value > old.value,
            Side::Inf => new.value < old.value,
        };
        beyond || (new.value == old.value && new.attained && !old.attained)
    });
    if better {
        *best = Some(new);
    }
}

impl Track {
    fn of(measure: &Measure, graph: &Graph) -> Self {
        match measure {
            Measure::Clock(ClockId(c)) => {
                let clock = usize::from(*c) + 1;
                let bound = graph.most(clock).max(1);
                Track::Clock { clock, bound, best: None, beyond: false, unbounded: None }
            }
            Measure::Data(e) => Track::Number { of: e.clone(), best: None },
        }
    }

    /// Whether the value may be one that extrapolation has made.
    fn is_beyond(&self, side: Side) -> bool {
        match self {
            Track::Number { .. } => false,
            Track::Clock { bound, best, beyond, unbounded, .. } => match side {
                Side::Sup => unbounded.is_none() && *beyond,
                // A lower bound beyond the clock's is weakened to "greater than it".
                Side::Inf => best.is_some_and(|b| b.value >= *bound && !b.attained),
            },
        }
    }

    fn raise(&mut self, side: Side) {
        let more = self.is_beyond(side);
        match self {
            // The nodes have other numbers next time.
            Track::Number { best, .. } => *best = None,
            Track::Clock { bound, best, beyond, unbounded, .. } => {
                if more {
                    *bound = bound.saturating_mul(2).min(1 << 50);
                }
                (*best, *beyond, *unbounded) = (None, false, None);
            }
        }
    }

    fn finish(
        &self,
        plain: &Plain,
        graph: &Graph,
        side: Side,
        when: &StateFormula,
        exhausted: bool,
        timing: Timing,
    ) -> Result<Extremum, Error> {
        let unit = graph.model.unit;
        let (best, open, endless, clock) = match self {
            Track::Number { best, .. } => (*best, exhausted, None, None),
            Track::Clock { best, unbounded, clock, .. } => {
                (*best, exhausted || self.is_beyond(side), *unbounded, Some(*clock))
            }
        };
        let quantity = |value: i64| match clock {
            Some(_) => Quantity::Nanos(value.saturating_mul(unit)),
            None => Quantity::Number(value),
        };
        if let Some(node) = endless {
            let run = reach_formula(graph, plain.path(node), when, &[], timing)?;
            return Ok(Extremum { limit: Reach::Unbounded, run: Some(Box::new(run)) });
        }
        let Some(b) = best else {
            let limit = if open { Reach::Open { seen: None } } else { Reach::Nowhere };
            return Ok(Extremum { limit, run: None });
        };
        if open {
            return Ok(Extremum { limit: Reach::Open { seen: Some(quantity(b.value)) }, run: None });
        }
        let near = clock.map(|x| near(x, b, side)).into_iter().collect::<Vec<_>>();
        let stops: Vec<Stop> = plain.path(b.node);
        let run = reach_formula(graph, stops, when, &near, timing)?;
        let limit = Reach::At { value: quantity(b.value), attained: b.attained };
        Ok(Extremum { limit, run: Some(Box::new(run)) })
    }
}

/// That the clock has the value, or is less than a unit from it.
fn near(clock: usize, b: Best, side: Side) -> Constraint {
    let x = clock as u16;
    match (side, b.attained) {
        (Side::Sup, true) => Constraint { i: 0, j: x, bound: Bound::le(-b.value) },
        (Side::Sup, false) => Constraint { i: 0, j: x, bound: Bound::lt(1 - b.value) },
        (Side::Inf, true) => Constraint { i: x, j: 0, bound: Bound::le(b.value) },
        (Side::Inf, false) => Constraint { i: x, j: 0, bound: Bound::lt(b.value + 1) },
    }
}
