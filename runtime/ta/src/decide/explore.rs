//! The search for goals, with one time for all or with local time: as it is asked for, or as it serves.

use hrdsl_ir::{Program, ta::Network};

use crate::{
    decide::{chosen, stopwatch},
    local,
    network::{
        model::{CompiledNetwork, ObservationOptions},
        query::{EventCounter, EventLimit, ReachabilityGoal, SearchBudget},
    },
    search::{
        options::{SearchOptions, TimeFrame},
        report::{SearchProgress, SearchReport},
        start,
    },
    witness::error::SearchError,
};

/// Compiles a network and searches it breadth first for shortest witnesses.
///
/// # Errors
/// If the model is malformed, or a fault of it is met, or the engine contradicts itself.
pub fn check(
    program: &Program,
    network: &Network,
    goals: &[ReachabilityGoal],
    counters: &[EventCounter],
    limits: &[EventLimit],
    budget: SearchBudget,
) -> Result<SearchReport, SearchError> {
    let observe = ObservationOptions {
        counters: counters.to_vec(),
        limits: limits.to_vec(),
        ..ObservationOptions::default()
    };
    let model = CompiledNetwork::new(program, network, &observe)?;
    explore(&model, goals, &SearchOptions { budget, ..SearchOptions::shortest() }, &|_| true)
}

/// Searches a compiled network. It ends when each goal is met, all is explored, the budget is used up, or `go_on` (asked
/// once a round) says so.
///
/// A fault of the model is met only if it comes before that end.
///
/// # Errors
/// If a fault of the model is met, or the engine contradicts itself.
pub fn explore(
    model: &CompiledNetwork,
    goals: &[ReachabilityGoal],
    options: &SearchOptions,
    go_on: &dyn Fn(&SearchProgress) -> bool,
) -> Result<SearchReport, SearchError> {
    if model.stops() {
        return stopwatch::explore(model, goals, options, go_on);
    }
    match options.time {
        TimeFrame::Common => return start::explore(model, goals, options, go_on),
        TimeFrame::Chosen if goals.is_empty() => return start::explore(model, goals, options, go_on),
        TimeFrame::Chosen => return chosen::explore(model, goals, options, go_on),
        TimeFrame::Local => {}
    }
    let SearchOptions { order, seed, budget, .. } = *options;
    let alone = local::LocalSearchOptions {
        order,
        seed,
        budget,
        threads: options.threads,
        ..local::LocalSearchOptions::default()
    };
    match local::explore(model, goals, &alone, go_on) {
        Ok(report) => Ok(report),
        Err(local::LocalSearchError::Search(error)) => Err(error),
        Err(local::LocalSearchError::NotApplicable(reason)) => {
            let report = start::explore(model, goals, options, go_on)?;
            Ok(SearchReport { global_because: Some(reason.to_string()), ..report })
        }
    }
}
