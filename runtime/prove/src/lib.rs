//! Requirements on the model: whether what a network can do violates a requirement of the scenario.
//!
//! # Steps
//! 1. [`ObservedNetwork`] puts the requirement's monitor into the network as an automaton that only listens;
//! 2. the network with it is searched for the violation, and for the trigger: without one, that nothing is violated says
//!    little;
//! 3. a witness is made concrete, and its trace judged by the monitor itself: only what fails there is a violation.
//!
//! [Assumptions](hrdsl_ir::monitor::Assumption) restrict the model. Those about the whole test are limits of the search. Those
//! with a window are first left out: what cannot happen without them cannot happen with them, and a witness that keeps them
//! counts. Only if neither decides are they added as automata of their own ([`ObservedNetwork::restrict`]).
#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod goals;
pub mod held;
mod matching;
mod observer;
mod query;
mod run;
mod settings;
mod window;

use hrdsl_ir::{Program, monitor::Monitor, ta::Network};
use hrdsl_monitor::MonitorRunner;
pub use hrdsl_ta::{
    EdgeSource, FollowDeparture, FollowOutcome, ModelError, MomentRange, NetworkWalk, RecordedPart,
    RecordedStep, RecordedTime, RecordedWalk, RunEnding, WalkOption, WalkSession, WitnessTrace,
    WitnessTransition, follow,
};
use hrdsl_ta::{SearchError, WitnessRun};
use hrdsl_trace::{Trace, TraceObserver as _};

use held::TimedHolds;

pub use goals::{GoalDecision, GoalFate, decide, of_formula};
pub use observer::{ObservedNetwork, ObserverFormulas};
pub use query::{
    QueryFinding, QueryResult, RangeResult, RangeVerdict, answer, answers, is_decided_with_others,
};
pub use run::ObservedRun;
pub use settings::{ProofOptions, SearchOrder, SearchStatistics, SearchWatch, TimeFrame};

/// What became of a requirement.
#[derive(Clone, Debug)]
pub struct RequirementProof {
    /// Index into [`Program::monitors`].
    pub monitor: usize,
    pub status: ProofStatus,
    /// Of all searches that it took; `None`: it was not searched.
    pub statistics: Option<SearchStatistics>,
    /// Why nothing triggers it, if that is known.
    pub note: Option<String>,
}

#[derive(Clone, Debug)]
pub enum ProofStatus {
    /// Some run violates it.
    Violated(Box<ObservedRun>),
    /// No run does.
    Holds {
        /// Whether some run triggers it. `None`: inconclusive within the budget.
        triggered: Option<bool>,
    },
    /// Inconclusive: why.
    Inconclusive(String),
    /// It cannot be judged on a model: why.
    NotOnTheModel(String),
    /// The model is at fault, and where.
    Fault { what: String, run: Option<Box<ObservedRun>> },
}

/// Searches a network for a violation of a requirement.
///
/// # Errors
/// The engine or the observer contradicts the monitor, or the network does not exist.
pub fn prove(
    program: &Program,
    network: &Network,
    monitor: usize,
    settings: &ProofOptions,
    watch: &SearchWatch,
) -> Result<RequirementProof, String> {
    let Some(requirement) = program.monitors.get(monitor) else {
        return Err(format!("there is no requirement {monitor}"));
    };
    let unsearched = |status| RequirementProof { monitor, status, statistics: None, note: None };
    let mut observed = ObservedNetwork::new(program, network);
    let verdicts = match observed.add(requirement) {
        Ok(verdicts) => verdicts,
        Err(why) => return Ok(unsearched(ProofStatus::NotOnTheModel(why))),
    };
    let formulas: Vec<_> = verdicts.violated.iter().chain([&verdicts.triggered]).collect();
    let questions: Vec<_> = formulas.into_iter().map(goals::of_formula).collect();
    let decided = match decide(program, &observed, &questions, &[], settings, watch) {
        Ok(decided) => decided,
        Err(SearchError::Model { error, witness }) => {
            let what = error.to_string();
            let run = witness.map(|witness| Box::new(ObservedRun { observed, witness: *witness }));
            return Ok(unsearched(ProofStatus::Fault { what, run }));
        }
        Err(SearchError::Internal(what)) => {
            return Err(format!("requirement `{}`: {what}", requirement.name));
        }
    };
    let (states, statistics) = (decided.states, Some(decided.statistics));
    let mut fates = decided.fates.into_iter();
    let violated = if verdicts.violated.is_some() { fates.next() } else { Some(GoalFate::Unreachable) };
    let triggered = match fates.next() {
        Some(GoalFate::Reached(_)) => Some(true),
        Some(GoalFate::Unreachable) => Some(false),
        Some(GoalFate::Inconclusive(_)) | None => None,
    };
    let status = match violated {
        Some(GoalFate::Reached(run)) => {
            judged(program, requirement, monitor, &run.witness)?;
            ProofStatus::Violated(run)
        }
        Some(GoalFate::Unreachable) => ProofStatus::Holds { triggered },
        Some(GoalFate::Inconclusive(why)) => ProofStatus::Inconclusive(why),
        None => ProofStatus::Inconclusive("it was not searched".to_owned()),
    };
    let note = match status {
        ProofStatus::Holds { triggered: Some(false) } => {
            held_back(program, network, requirement, settings, states, watch)
        }
        ProofStatus::Holds { .. }
        | ProofStatus::Violated(_)
        | ProofStatus::Inconclusive(_)
        | ProofStatus::NotOnTheModel(_)
        | ProofStatus::Fault { .. } => None,
    };
    Ok(RequirementProof { monitor, status, statistics, note })
}

/// Why nothing triggers a requirement, if it is that holds take no time.
fn held_back(
    program: &Program,
    network: &Network,
    requirement: &Monitor,
    settings: &ProofOptions,
    states: usize,
    watch: &SearchWatch,
) -> Option<String> {
    let held = TimedHolds::of(program, network)?;
    let mut observed = ObservedNetwork::new(&held.program, network);
    let triggered = observed.add(requirement).ok()?.triggered;
    let (goal, settings) = (of_formula(&triggered), TimedHolds::settings(settings, states));
    let decided = decide(&held.program, &observed, &[goal], &[], &settings, watch).ok()?;
    match decided.fates.first()? {
        GoalFate::Reached(run) => held.because(&run.witness),
        GoalFate::Unreachable | GoalFate::Inconclusive(_) => None,
    }
}

/// The monitor itself must see the violation.
fn judged(
    program: &Program,
    requirement: &Monitor,
    monitor: usize,
    witness: &WitnessRun,
) -> Result<(), String> {
    let verdicts = verdicts(program, &trace(witness));
    match verdicts.get(monitor) {
        Some(v) if v.outcome == hrdsl_monitor::MonitorOutcome::Fail => Ok(()),
        Some(v) => Err(format!(
            "internal error: the search violates `{}`, and the monitor says of the same run: {}",
            requirement.name, v.outcome
        )),
        None => Err(format!("internal error: no verdict on `{}`", requirement.name)),
    }
}

/// What the monitors say of a trace.
pub fn verdicts(program: &Program, trace: &Trace) -> Vec<hrdsl_monitor::MonitorVerdict> {
    let mut checker = MonitorRunner::new(program);
    for (index, step) in trace.steps.iter().enumerate() {
        checker.step(index, step);
    }
    checker.end(trace.end);
    checker.verdicts()
}

/// The events of a run, and its end: what it shows may need time after the last of them.
pub fn trace(witness: &WitnessRun) -> Trace {
    let mut trace = witness.trace();
    trace.end = trace.end.max(witness.end.div_euclid(witness.ticks.max(1)));
    trace
}
