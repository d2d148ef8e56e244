//! Least upper and greatest lower bounds of clocks and numbers, over all states in which a formula holds.
//!
//! All zones are looked at. What extrapolation keeps of a clock is exact up to the clock's bound, so if a value comes out beyond
//! it, the bound is doubled and the search begins again. It ends when the value is within the bound; when some state of the
//! formula lets time pass for ever, so that the clock is unbounded; or, inconclusive, after [`RAISES`] doublings or when the
//! budget is used up. The last can only happen for a clock that grows in a loop of states each of which bounds time.

use std::ops::ControlFlow;

use hrdsl_ir::{
    Expr, Nanos, Value,
    expr::EvalError,
    ta::{ClockId, QueryMeasure},
};
use serde::Serialize;

use crate::{
    decide::plain::{ReachabilityGraph, ReachedState},
    network::{
        actions::DelayCondition,
        graph::{ZoneDetail, ZoneGraph},
        model::CompiledNetwork,
        query::{SearchBudget, StateFormula, StateViewScope, SymbolicView, no_value},
    },
    witness::{
        build::{PathSegment, reach_formula},
        error::SearchError,
        run::WitnessRun,
        schedule::ScheduleOptions,
    },
    zone::{
        constraint::DifferenceConstraint,
        dbm::{Dbm, DbmBound},
    },
};

/// How often a clock's bound is doubled.
pub const RAISES: u32 = 14;

/// A bound of one measure.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MeasureExtremum {
    pub limit: ExtremumLimit,
    /// A run to a state in which the measure has the value, or one less than a unit of time from it.
    pub run: Option<Box<WitnessRun>>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ExtremumLimit {
    /// `attained`: some state has the value (`<=`); otherwise states come as near as one likes (`<`).
    At { value: ExtremumValue, attained: bool },
    /// It grows without bound.
    Unbounded,
    /// The formula holds nowhere.
    Nowhere,
    /// The search ended too early; this value is not beyond the bound.
    Inconclusive { seen: Option<ExtremumValue> },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ExtremumValue {
    Nanos(Nanos),
    Number(i64),
}

/// Upper or lower.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ExtremumSide {
    Sup,
    Inf,
}

/// The best value so far: in units or as a number, whether it is attained, and the node.
#[derive(Clone, Copy)]
struct BestValue {
    value: i64,
    attained: bool,
    node: u32,
}

enum MeasureTracker {
    Clock { clock: usize, bound: i64, best: Option<BestValue>, beyond: bool, unbounded: Option<u32> },
    Number { of: Expr, best: Option<BestValue> },
}

/// The bounds of each measure.
///
/// # Errors
/// If the model is at fault, or a measure has no value where the formula holds.
pub(crate) fn extrema(
    model: &CompiledNetwork,
    side: ExtremumSide,
    of: &[QueryMeasure],
    when: &StateFormula,
    budget: SearchBudget,
    timing: ScheduleOptions,
) -> Result<Vec<MeasureExtremum>, SearchError> {
    let mut graph = ZoneGraph::new(model, ZoneDetail::Reach, &[when], 0)?;
    let mut tracks: Vec<MeasureTracker> = of.iter().map(|m| MeasureTracker::of(m, &graph)).collect();
    let mut raised = 0;
    loop {
        for t in &tracks {
            if let MeasureTracker::Clock { clock, bound, .. } = t {
                graph.keep_up_to(*clock, *bound);
            }
        }
        let mut plain = ReachabilityGraph::new(&graph);
        let exhausted = plain.explore(budget, &mut |at, seen, stay| {
            look(&graph, side, when, &mut tracks, at, seen, stay)?;
            Ok(ControlFlow::Continue(()))
        })?;
        let again = exhausted.is_none() && raised < RAISES && tracks.iter().any(|t| t.is_beyond(side));
        if !again {
            let finish =
                |t: &MeasureTracker| t.finish(&plain, &graph, side, when, exhausted.is_some(), timing);
            return tracks.iter().map(finish).collect();
        }
        raised += 1;
        tracks.iter_mut().for_each(|t| t.raise(side));
    }
}

fn look(
    graph: &ZoneGraph,
    side: ExtremumSide,
    when: &StateFormula,
    tracks: &mut [MeasureTracker],
    at: u32,
    seen: &ReachedState,
    stay: &DelayCondition,
) -> Result<(), SearchError> {
    let here = graph.here(&seen.state);
    let parts = when.part(&here, &seen.zone)?;
    if parts.is_empty() {
        return Ok(());
    }
    for t in tracks.iter_mut() {
        match t {
            MeasureTracker::Number { of, best } => {
                let value = of.eval_in(&StateViewScope(&here)).map_err(no_value)?;
                let n = number(value).ok_or_else(|| no_value(EvalError::Type))?;
                improve(best, BestValue { value: n, attained: true, node: at }, side);
            }
            MeasureTracker::Clock { clock, best, beyond, unbounded, .. } => {
                for part in parts.zones() {
                    let b = match side {
                        ExtremumSide::Sup => part.at(*clock, 0),
                        ExtremumSide::Inf => part.at(0, *clock),
                    };
                    if !b.is_infinite() {
                        let value = if side == ExtremumSide::Sup { b.value() } else { -b.value() };
                        improve(best, BestValue { value, attained: !b.is_strict(), node: at }, side);
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
fn lasts(when: &StateFormula, here: &dyn SymbolicView, part: &Dbm) -> Result<bool, SearchError> {
    let mut later = part.clone();
    later.up();
    Ok(when.part(here, &later)?.includes(&later))
}

fn improve(best: &mut Option<BestValue>, new: BestValue, side: ExtremumSide) {
    let better = best.is_none_or(|old| {
        let beyond = match side {
            ExtremumSide::Sup => new.value > old.value,
            ExtremumSide::Inf => new.value < old.value,
        };
        beyond || (new.value == old.value && new.attained && !old.attained)
    });
    if better {
        *best = Some(new);
    }
}

impl MeasureTracker {
    fn of(measure: &QueryMeasure, graph: &ZoneGraph) -> Self {
        match measure {
            QueryMeasure::Clock(ClockId(c)) => {
                let clock = usize::from(*c) + 1;
                let bound = graph.most(clock).max(1);
                MeasureTracker::Clock { clock, bound, best: None, beyond: false, unbounded: None }
            }
            QueryMeasure::Data(e) => MeasureTracker::Number { of: e.clone(), best: None },
        }
    }

    /// Whether the value may be one that extrapolation has made.
    fn is_beyond(&self, side: ExtremumSide) -> bool {
        match self {
            MeasureTracker::Number { .. } => false,
            MeasureTracker::Clock { bound, best, beyond, unbounded, .. } => match side {
                ExtremumSide::Sup => unbounded.is_none() && *beyond,
                // A lower bound beyond the clock's is weakened to "greater than it".
                ExtremumSide::Inf => best.is_some_and(|b| b.value >= *bound && !b.attained),
            },
        }
    }

    fn raise(&mut self, side: ExtremumSide) {
        let more = self.is_beyond(side);
        match self {
            // The nodes have other numbers next time.
            MeasureTracker::Number { best, .. } => *best = None,
            MeasureTracker::Clock { bound, best, beyond, unbounded, .. } => {
                if more {
                    *bound = bound.saturating_mul(2).min(1 << 50);
                }
                (*best, *beyond, *unbounded) = (None, false, None);
            }
        }
    }

    fn finish(
        &self,
        plain: &ReachabilityGraph,
        graph: &ZoneGraph,
        side: ExtremumSide,
        when: &StateFormula,
        exhausted: bool,
        timing: ScheduleOptions,
    ) -> Result<MeasureExtremum, SearchError> {
        let unit = graph.model.unit;
        let (best, open, endless, clock) = match self {
            MeasureTracker::Number { best, .. } => (*best, exhausted, None, None),
            MeasureTracker::Clock { best, unbounded, clock, .. } => {
                (*best, exhausted || self.is_beyond(side), *unbounded, Some(*clock))
            }
        };
        let quantity = |value: i64| match clock {
            Some(_) => ExtremumValue::Nanos(value.saturating_mul(unit)),
            None => ExtremumValue::Number(value),
        };
        if let Some(node) = endless {
            let run = reach_formula(graph, plain.path(node), when, &[], timing)?;
            return Ok(MeasureExtremum { limit: ExtremumLimit::Unbounded, run: Some(Box::new(run)) });
        }
        let Some(b) = best else {
            let limit =
                if open { ExtremumLimit::Inconclusive { seen: None } } else { ExtremumLimit::Nowhere };
            return Ok(MeasureExtremum { limit, run: None });
        };
        if open {
            return Ok(MeasureExtremum {
                limit: ExtremumLimit::Inconclusive { seen: Some(quantity(b.value)) },
                run: None,
            });
        }
        let near = clock.map(|x| near(x, b, side)).into_iter().collect::<Vec<_>>();
        let stops: Vec<PathSegment> = plain.path(b.node);
        let run = reach_formula(graph, stops, when, &near, timing)?;
        let limit = ExtremumLimit::At { value: quantity(b.value), attained: b.attained };
        Ok(MeasureExtremum { limit, run: Some(Box::new(run)) })
    }
}

/// That the clock has the value, or is less than a unit from it.
fn near(clock: usize, b: BestValue, side: ExtremumSide) -> DifferenceConstraint {
    let x = clock as u16;
    match (side, b.attained) {
        (ExtremumSide::Sup, true) => DifferenceConstraint { i: 0, j: x, bound: DbmBound::le(-b.value) },
        (ExtremumSide::Sup, false) => DifferenceConstraint { i: 0, j: x, bound: DbmBound::lt(1 - b.value) },
        (ExtremumSide::Inf, true) => DifferenceConstraint { i: x, j: 0, bound: DbmBound::le(b.value) },
        (ExtremumSide::Inf, false) => DifferenceConstraint { i: x, j: 0, bound: DbmBound::lt(b.value + 1) },
    }
}
