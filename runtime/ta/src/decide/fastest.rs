//! Fastest witnesses: a run to a goal that ends as early as any.
//!
//! The time since the start is a clock more of the search for goals: it is never set, and only its lower bound matters, since who comes
//! later can do no more. States are taken by that bound, which no transition makes less. A witness that is known says by when the goal
//! is met, so that what comes later is left out.

use crate::{
    decide::{deadlock, standing_fastest},
    network::{
        error::ModelError,
        model::CompiledNetwork,
        query::{GoalKind, ReachabilityGoal, SearchBudget},
    },
    search::{options::SearchOptions, round_search::SearchAside, start},
    witness::{build, error::SearchError, run::WitnessRun, schedule::ScheduleOptions},
};

/// A run that meets the goal (no pair or use) as early as any, given one that meets it; the model must have observed the goal's
/// formula. `None`: the budget is used up first.
///
/// # Errors
/// If the model is at fault, or the engine contradicts itself.
pub fn fastest(
    model: &CompiledNetwork,
    goal: &ReachabilityGoal,
    known: &WitnessRun,
    budget: SearchBudget,
    timing: ScheduleOptions,
) -> Result<Option<Box<WitnessRun>>, SearchError> {
    if matches!(goal.what, GoalKind::Pair { .. } | GoalKind::Use { .. }) {
        let what = "edge pairs and def-use pairs are not looked for by time";
        return Err(ModelError::Question(what.into()).into());
    }
    if model.stops() {
        return standing_fastest::fastest(model, goal, known, budget);
    }
    let unit = i128::from(model.unit) * i128::from(known.ticks);
    let within = (i128::from(known.end) + unit - 1) / unit;
    let within = i64::try_from(within).map_err(|_| SearchError::Internal("a run has no end".into()))?;
    let path = match goal.formula().filter(|f| f.asks_deadlock()) {
        Some(formula) => deadlock::earliest(model, goal, &formula, within, budget)?,
        None => earliest(model, goal, within, budget)?,
    };
    let Some(path) = path else { return Ok(None) };
    let timing = ScheduleOptions { prompt: true, ..timing };
    build::witness(model, path, Some(goal), timing).map(|run| Some(Box::new(run)))
}

type GoalTransitions = Vec<crate::network::actions::PathTransition>;

fn earliest(
    model: &CompiledNetwork,
    goal: &ReachabilityGoal,
    within: i64,
    budget: SearchBudget,
) -> Result<Option<GoalTransitions>, SearchError> {
    let options = SearchOptions { budget, ..SearchOptions::default() };
    let goals = std::slice::from_ref(goal);
    let beside = SearchAside { within: Some(within), ..SearchAside::default() };
    let mut search = start::begin(model, goals, &options, beside)?;
    loop {
        match search.round(&mut Vec::new())? {
            std::ops::ControlFlow::Continue(()) => {}
            std::ops::ControlFlow::Break(Some(_)) => return Ok(None),
            std::ops::ControlFlow::Break(None) => return search.path_to_goal(0),
        }
    }
}
