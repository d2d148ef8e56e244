//! Goals decided under the assumptions of a program, by up to three searches.

use hrdsl_ir::{Program, ta::QueryFormula};
use hrdsl_ta::{
    EventCounter, EventLimit, GoalKind, GoalOutcome, ReachabilityGoal, SearchCutoff, SearchError,
    SearchReport, WidestVariable,
};

use super::{
    observer::ObservedNetwork,
    run::{ObservedRun, keeps_assumptions},
    settings::{ProofOptions, SearchStatistics, SearchWatch, search},
};

/// How a goal ended.
#[derive(Clone, Debug)]
pub enum GoalFate {
    Reached(Box<ObservedRun>),
    /// No run that keeps the assumptions reaches it.
    Unreachable,
    /// Inconclusive: why.
    Inconclusive(String),
}

/// What became of several goals.
#[derive(Clone, Debug, Default)]
pub struct GoalDecision {
    /// One for each goal.
    pub fates: Vec<GoalFate>,
    /// Symbolic states stored, of all searches.
    pub states: usize,
    /// Symbolic states whose successors were computed, of all searches.
    pub visited: usize,
    pub searches: usize,
    pub statistics: SearchStatistics,
}

/// How assumptions with a window restrict a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum WindowTreatment {
    /// Not at all: what cannot be reached is proved.
    Ignored,
    /// As if the window were the whole test: what is reached keeps them.
    Whole,
    /// As they are.
    Exact,
}

/// The goal that a formula holds.
#[must_use]
pub fn of_formula(formula: &QueryFormula) -> ReachabilityGoal {
    ReachabilityGoal { what: GoalKind::Formula(formula.clone()), settled: false }
}

/// Decides goals about a network: each is reached by a run that keeps the assumptions, or by none, or the search is inconclusive.
///
/// # Errors
/// If a run that keeps the assumptions meets a fault of the model, or the engine contradicts itself.
pub fn decide(
    program: &Program,
    observed: &ObservedNetwork,
    goals: &[ReachabilityGoal],
    counters: &[EventCounter],
    settings: &ProofOptions,
    watch: &SearchWatch,
) -> Result<GoalDecision, SearchError> {
    let windowed = program.assumptions.iter().any(|a| a.within.is_some());
    let treatments: &[WindowTreatment] = match (windowed, settings.keep_first) {
        (false, _) => &[WindowTreatment::Exact],
        (true, false) => &[WindowTreatment::Ignored, WindowTreatment::Whole, WindowTreatment::Exact],
        (true, true) => &[WindowTreatment::Whole, WindowTreatment::Ignored, WindowTreatment::Exact],
    };
    let mut decided = GoalDecision::default();
    let mut fates: Vec<Option<GoalFate>> = vec![None; goals.len()];
    let mut why = String::new();
    for treatment in treatments {
        let open: Vec<usize> = (0..goals.len()).filter(|g| fates[*g].is_none()).collect();
        if open.is_empty() {
            break;
        }
        let questions: Vec<ReachabilityGoal> = open.iter().map(|g| goals[*g].clone()).collect();
        let (restricted, limits) = match restricted(program, observed, *treatment) {
            Ok(made) => made,
            Err(reason) => {
                why = reason;
                continue;
            }
        };
        let report = match search(&restricted, &questions, counters, &limits, settings, watch) {
            Ok(report) => report,
            // Only a run that breaks the assumptions: another search tells.
            Err(SearchError::Model { witness: Some(witness), .. })
                if *treatment == WindowTreatment::Ignored && !keeps_assumptions(program, &witness) =>
            {
                continue;
            }
            Err(error) => return Err(error),
        };
        decided.states += report.states_stored;
        decided.visited += report.states_visited;
        decided.searches += 1;
        decided.statistics = decided.statistics.and(report.statistics());
        for (goal, fate) in
            open.iter().zip(settled(program, &restricted, &report, *treatment, (watch, &mut why)))
        {
            fates[*goal] = fate;
        }
    }
    let left = |fate: Option<GoalFate>| fate.unwrap_or_else(|| GoalFate::Inconclusive(why.clone()));
    decided.fates = fates.into_iter().map(left).collect();
    Ok(decided)
}

/// The fates that a search settles.
fn settled(
    program: &Program,
    observed: &ObservedNetwork,
    report: &SearchReport,
    treatment: WindowTreatment,
    (watch, why): (&SearchWatch, &mut String),
) -> Vec<Option<GoalFate>> {
    let mut fates = Vec::new();
    for outcome in &report.goals {
        fates.push(match outcome {
            GoalOutcome::Reached(witness) => keeps_assumptions(program, witness).then(|| {
                GoalFate::Reached(Box::new(ObservedRun {
                    observed: observed.clone(),
                    witness: (**witness).clone(),
                }))
            }),
            GoalOutcome::Unreachable => {
                (treatment != WindowTreatment::Whole).then_some(GoalFate::Unreachable)
            }
            GoalOutcome::Inconclusive(what) => {
                *why = exhausted(*what, report, watch);
                None
            }
        });
    }
    fates
}

pub(super) fn exhausted(what: SearchCutoff, report: &SearchReport, watch: &SearchWatch) -> String {
    cut_off(what, report.widest.as_ref(), watch)
}

/// Why a search has not decided, and which variable may be the cause.
pub(super) fn cut_off(what: SearchCutoff, widest: Option<&WidestVariable>, watch: &SearchWatch) -> String {
    let why = match what {
        SearchCutoff::States => "the budget of states was used up",
        SearchCutoff::Memory => "the budget of memory was used up",
        SearchCutoff::Stopped => watch.stopped(),
        SearchCutoff::Zones => "clocks stand still, and the zones cannot tell",
    };
    widest.map_or_else(|| why.to_owned(), |widest| format!("{why}; {widest}"))
}

/// The network and the limits of one search.
fn restricted(
    program: &Program,
    observed: &ObservedNetwork,
    treatment: WindowTreatment,
) -> Result<(ObservedNetwork, Vec<EventLimit>), String> {
    let mut restricted = observed.clone();
    let mut limits = Vec::new();
    for assumption in &program.assumptions {
        let limit =
            EventLimit { patterns: assumption.events.clone(), at_most: i64::from(assumption.at_most) };
        match (assumption.within, treatment) {
            (None, _) | (Some(_), WindowTreatment::Whole) => limits.push(limit),
            (Some(_), WindowTreatment::Ignored) => {}
            (Some(within), WindowTreatment::Exact) => restricted.restrict(assumption, within)?,
        }
    }
    Ok((restricted, limits))
}
