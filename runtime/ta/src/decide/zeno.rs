//! Loops in which time does not pass beyond a bound: a run that goes round in one for ever is a Zeno run.

use std::collections::BTreeSet;

use crate::{
    decide::liveness::MaximalRun,
    network::{error::ModelError, graph::ZoneGraph},
    witness::{
        build::{PathSegment, times},
        error::SearchError,
        run::RunEnding,
        schedule::ScheduleOptions,
    },
    zone::constraint::DifferenceConstraint,
};

/// How time passes in a loop.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum LoopPace {
    /// Nothing that is looked at here bounds it.
    Free,
    /// Not at all.
    Still,
    /// Not beyond some bound, for this clock is never set and never more than a constant.
    Bounded(String),
}

impl LoopPace {
    /// The end of a sentence about the loop.
    pub(crate) fn told(&self) -> String {
        match self {
            LoopPace::Free => String::new(),
            LoopPace::Still => ", in which no time passes (a Zeno run)".to_owned(),
            LoopPace::Bounded(clock) => {
                format!(
                    ", in which time does not pass beyond a bound, since `{clock}` is bounded and never set (a Zeno run)"
                )
            }
        }
    }
}

/// How time passes in the loop of a run; free, if it has none.
///
/// # Errors
/// If the run is none of the network.
pub(crate) fn pace(graph: &ZoneGraph, run: &MaximalRun) -> Result<LoopPace, SearchError> {
    match run.ending {
        RunEnding::Again(_) => {}
        RunEnding::Reached | RunEnding::Stuck | RunEnding::Waits | RunEnding::Fault => {
            return Ok(LoopPace::Free);
        }
    }
    if times(graph, &run.stops, ScheduleOptions::default())?.is_some_and(|t| !t.can_last(run.from)) {
        return Ok(LoopPace::Still);
    }
    Ok(bounded_clock(graph, run)?.map_or(LoopPace::Free, LoopPace::Bounded))
}

/// A clock that is bounded from above somewhere in the loop and never set in it: however often the loop is gone round, no more time passes
/// than that.
fn bounded_clock(graph: &ZoneGraph, run: &MaximalRun) -> Result<Option<String>, ModelError> {
    let (mut bounded, mut set) = (BTreeSet::new(), BTreeSet::new());
    let mut note = |constraints: &[DifferenceConstraint]| {
        let above = |c: &&DifferenceConstraint| c.i != 0 && c.j == 0 && !c.bound.is_infinite();
        bounded.extend(constraints.iter().filter(above).map(|c| c.i));
    };
    // INVARIANT: the loop ends in the discrete state in which it begins.
    let mut state = run.state.clone();
    for stop in run.stops.iter().skip(run.from) {
        let PathSegment::Take { taken, .. } = stop else { continue };
        note(&taken.guard);
        set.extend(taken.resets.iter().map(|r| r.clock));
        state = graph.target(&state, taken)?;
        if let Some(stay) = graph.stay(&state)? {
            note(&stay.invariant);
        }
    }
    Ok(bounded.difference(&set).next().map(|clock| graph.model.clock_name(usize::from(*clock))))
}
