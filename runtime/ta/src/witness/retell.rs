//! A run of a network without some of its assignments, told as one of the network with all of them.
//!
//! Where the assignments that were left out have no part in what can happen, the same transitions are possible at the same times, as long as
//! none of them is a fault. A loop is gone round as often as the variables that were left out need to come round with it.

use rustc_hash::FxHashMap;

use crate::{
    network::{
        actions::PathTransition, error::ModelError, graph::ZoneGraph, model::CompiledNetwork,
        query::StateFormula,
    },
    witness::{
        build::{concrete, fault_after, path_of, replayed, takes, told_step},
        error::SearchError,
        run::{RunEnding, WitnessRun},
        schedule::ScheduleOptions,
    },
};

/// A loop is gone round until so many transitions at most.
const ROUNDS: usize = 4_000;

/// What a run becomes with all assignments.
pub(crate) enum RetoldRun {
    Run(WitnessRun),
    /// A loop that leads to a fault, if it is gone round often enough: that, with the run to it.
    Fault(SearchError),
    /// A fault comes before its end, or it is not what it was.
    Another,
}

/// Tells a run of the network without some assignments with all of them. `formula`: what holds at its end, if something has to.
///
/// # Errors
/// If the engine contradicts itself.
pub(crate) fn retell(
    model: &CompiledNetwork,
    run: &WitnessRun,
    formula: Option<&StateFormula>,
    is_timed: bool,
    timing: ScheduleOptions,
) -> Result<RetoldRun, SearchError> {
    let (path, None) = path_of(model, run)? else { return Ok(RetoldRun::Another) };
    let graph = ZoneGraph::new(model, &[])?;
    let mut states = vec![graph.initial()];
    for taken in &path {
        let Ok(next) = graph.target(&states[states.len() - 1], taken) else { return Ok(RetoldRun::Another) };
        states.push(next);
    }
    if let RunEnding::Again(from) = run.ending
        && states.get(from) != states.last()
    {
        return if is_timed {
            // Where the formula's clocks are along the loop is known for one round alone.
            Ok(RetoldRun::Another)
        } else {
            rounds(&graph, (&path, from), &states, timing)
        };
    }
    let mut told = run.clone();
    for ((step, taken), states) in told.steps.iter_mut().zip(&path).zip(states.windows(2)) {
        let [before, after] = states else { continue };
        let time = step.time;
        *step = told_step(model, before, after, taken);
        step.time = time;
    }
    let end = replayed(model, &told)?;
    let holds = |f: &StateFormula| matches!(end.meets(f), Ok(true));
    let is_stuck = run.ending != RunEnding::Stuck || holds(&StateFormula::Deadlock);
    Ok(if is_stuck && formula.is_none_or(holds) { RetoldRun::Run(told) } else { RetoldRun::Another })
}

/// Goes round the loop at the end of a path until all variables come round.
fn rounds(
    graph: &ZoneGraph,
    (path, from): (&[PathTransition], usize),
    states: &[Vec<i64>],
    timing: ScheduleOptions,
) -> Result<RetoldRun, SearchError> {
    let (mut all, round) = (path.to_vec(), &path[from..]);
    let mut seen: FxHashMap<Vec<i64>, usize> = FxHashMap::default();
    seen.extend([(states[from].clone(), from), (states[path.len()].clone(), path.len())]);
    let mut state = states[path.len()].clone();
    while all.len() < ROUNDS {
        for taken in round {
            state = match graph.target(&state, taken) {
                Ok(next) => next,
                Err(error) => return Ok(RetoldRun::Fault(overflow(graph.model, all, error))),
            };
            all.push(taken.clone());
        }
        if let Some(&from) = seen.get(&state) {
            let stops = takes(all.into_iter().map(std::rc::Rc::new));
            return concrete(graph, &stops, RunEnding::Again(from), None, timing).map(RetoldRun::Run);
        }
        seen.insert(state.clone(), all.len());
    }
    Ok(RetoldRun::Another)
}

fn overflow(model: &CompiledNetwork, path: Vec<PathTransition>, error: ModelError) -> SearchError {
    fault_after(model, path.into_iter().map(std::rc::Rc::new), error)
}
