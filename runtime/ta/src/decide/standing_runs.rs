//! Whether a maximal run that zones show is one, where clocks stand still.
//!
//! A run that ends or waits for ever is one if its path has times. Of a loop of zones nothing follows by itself: there must be times with
//! which it comes back to the very clocks with which it began, or to some beyond all that they are compared with. Then it can be gone round
//! for ever with the same delays.

use std::collections::BTreeSet;

use crate::{
    decide::{liveness::MaximalRun, zeno::LoopPace},
    network::graph::ZoneGraph,
    witness::{
        build::{PathSegment, finish, walk_noting},
        error::SearchError,
        run::{RunEnding, WitnessRun},
        schedule::ScheduleOptions,
    },
    zone::{
        constraint::DifferenceConstraint,
        dbm::DbmBound,
        extrapolation::{ExtrapolationAbstraction, NONE},
    },
};

/// The run with its times, and how time passes in its loop; `None`: no such run was found.
///
/// # Errors
/// If the engine contradicts itself.
pub(super) fn confirm(
    graph: &ZoneGraph,
    shown: &MaximalRun,
    timing: ScheduleOptions,
) -> Result<Option<(WitnessRun, LoopPace)>, SearchError> {
    match shown.ending {
        RunEnding::Again(_) => {
            // First as it was; then again as if what the loop never sets were as late as one likes.
            let same = lasso(graph, shown, &BTreeSet::new(), timing)?;
            if same.is_some() { Ok(same) } else { lasso(graph, shown, &never_set(graph, shown), timing) }
        }
        RunEnding::Reached | RunEnding::Stuck | RunEnding::Waits | RunEnding::Fault => {
            let w = walk_noting(graph, &shown.stops, shown.stops.len())?;
            let Some(times) = w.schedule.timed(graph.model.unit, timing)? else { return Ok(None) };
            let run = finish(graph, w, &times, shown.ending, None)?;
            Ok(Some((run, LoopPace::Free)))
        }
    }
}

/// The clocks that no transition of the loop sets.
fn never_set(graph: &ZoneGraph, shown: &MaximalRun) -> BTreeSet<u16> {
    let mut all: BTreeSet<u16> = (1..graph.dim() as u16).collect();
    for stop in shown.stops.iter().skip(shown.from) {
        if let PathSegment::Take { taken, .. } = stop {
            taken.resets.iter().for_each(|reset| {
                all.remove(&reset.clock);
            });
        }
    }
    all
}

/// A run that goes round with the same clocks, but for those that are beyond all bounds at both ends of the loop.
fn lasso(
    graph: &ZoneGraph,
    shown: &MaximalRun,
    beyond: &BTreeSet<u16>,
    timing: ScheduleOptions,
) -> Result<Option<(WitnessRun, LoopPace)>, SearchError> {
    let mut w = walk_noting(graph, &shown.stops, shown.from)?;
    let frame = graph.frame(&shown.state, ExtrapolationAbstraction::Greatest);
    let (Some(then), Some(program)) = (w.then.clone(), w.schedule.standing_mut()) else { return Ok(None) };
    for (clock, lu) in frame.bounds.iter().enumerate().skip(1) {
        let most = lu.lower.max(lu.upper);
        if most == NONE {
            continue;
        }
        if beyond.contains(&(clock as u16)) {
            program.require_beyond_then(&then, clock, most);
            let later = DifferenceConstraint { i: 0, j: clock as u16, bound: DbmBound::lt(-most) };
            program.require(later);
        } else {
            program.require_as_then(&then, clock);
        }
    }
    if program.feasible() != Some(true) {
        return Ok(None);
    }
    let pace = if program.can_pass_since(&then) == Some(false) { LoopPace::Still } else { LoopPace::Free };
    let Some(times) = w.schedule.timed(graph.model.unit, timing)? else { return Ok(None) };
    Ok(Some((finish(graph, w, &times, shown.ending, None)?, pace)))
}
