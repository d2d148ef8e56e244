//! Goals decided under the assumptions of a program, by up to three searches.

use hrdsl_ir::{Program, ta::Formula};
use hrdsl_ta::{Counter, Error, Exhausted, Goal, GoalKind, Limit, Outcome, Report};

use super::{Observed, Run, Settings, Watch, keeps_assumptions, settings::search};

/// How a goal ended.
#[derive(Clone, Debug)]
pub enum Fate {
    Reached(Box<Run>),
    /// No run that keeps the assumptions reaches it.
    Unreachable,
    /// Not decided: why.
    Open(String),
}

/// What became of several goals.
#[derive(Clone, Debug)]
pub struct Decided {
    /// One for each goal.
    pub fates: Vec<Fate>,
    /// Symbolic states stored, of all searches.
    pub states: usize,
    /// Symbolic states whose successors were computed, of all searches.
    pub visited: usize,
    pub searches: usize,
}

/// How assumptions with a window restrict a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Windows {
    /// Not at all: what cannot be reached is proved.
    Ignored,
    /// As if the window were the whole test: what is reached keeps them.
    Whole,
    /// As they are.
    Exact,
}

/// The goal that a formula holds.
#[must_use]
pub fn of_formula(formula: &Formula) -> Goal {
    Goal { what: GoalKind::Formula(formula.clone()), settled: false }
}

/// Decides goals about a network: each is reached by a run that keeps the assumptions, or by none, or open.
///
/// # Errors
/// If a run that keeps the assumptions meets a fault of the model, or the engine contradicts itself.
pub fn decide(
    program: &Program,
    observed: &Observed,
    goals: &[Goal],
    counters: &[Counter],
    settings: &Settings,
    watch: &Watch,
) -> Result<Decided, Error> {
    let windowed = program.assumptions.iter().any(|a| a.within.is_some());
    let ways: &[Windows] = match (windowed, settings.keep_first) {
        (false, _) => &[Windows::Exact],
        (true, false) => &[Windows::Ignored, Windows::Whole, Windows::Exact],
        (true, true) => &[Windows::Whole, Windows::Ignored, Windows::Exact],
    };
    let mut decided = Decided { fates: Vec::new(), states: 0, visited: 0, searches: 0 };
    let mut fates: Vec<Option<Fate>> = vec![None; goals.len()];
    let mut why = String::new();
    for way in ways {
        let open: Vec<usize> = (0..goals.len()).filter(|g| fates[*g].is_none()).collect();
        if open.is_empty() {
            break;
        }
        let questions: Vec<Goal> = open.iter().map(|g| goals[*g].clone()).collect();
        let (restricted, limits) = match restricted(program, observed, *way) {
            Ok(made) => made,
            Err(reason) => {
                why = reason;
                continue;
            }
        };
        let report = match search(&restricted, &questions, counters, &limits, settings, watch) {
            Ok(report) => report,
            // Only a run that breaks the assumptions: another search tells.
            Err(Error::Model { witness: Some(witness), .. })
                if *way == Windows::Ignored && !keeps_assumptions(program, &witness) =>
            {
                continue;
            }
            Err(error) => return Err(error),
        };
        decided.states += report.states_stored;
        decided.visited += report.states_visited;
        decided.searches += 1;
        for (goal, fate) in open.iter().zip(settled(program, &restricted, &report, *way, &mut why)) {
            fates[*goal] = fate;
        }
    }
    let left = |fate: Option<Fate>| fate.unwrap_or_else(|| Fate::Open(why.clone()));
    decided.fates = fates.into_iter().map(left).collect();
    Ok(decided)
}

/// The fates that a search settles.
fn settled(
    program: &Program,
    observed: &Observed,
    report: &Report,
    way: Windows,
    why: &mut String,
) -> Vec<Option<Fate>> {
    let mut fates = Vec::new();
    for outcome in &report.goals {
        fates.push(match outcome {
            Outcome::Reached(witness) => keeps_assumptions(program, witness).then(|| {
                Fate::Reached(Box::new(Run { observed: observed.clone(), witness: (**witness).clone() }))
            }),
            Outcome::Unreachable => (way != Windows::Whole).then_some(Fate::Unreachable),
            Outcome::Open(what) => {
                *why = exhausted(*what);
                None
            }
        });
    }
    fates
}

pub(super) fn exhausted(what: Exhausted) -> String {
    match what {
        Exhausted::States => "the budget of states was used up".to_owned(),
        Exhausted::Memory => "the budget of memory was used up".to_owned(),
        Exhausted::Stopped => "the time was over".to_owned(),
    }
}

/// The network and the limits of one search.
fn restricted(
    program: &Program,
    observed: &Observed,
    way: Windows,
) -> Result<(Observed, Vec<Limit>), String> {
    let mut restricted = observed.clone();
    let mut limits = Vec::new();
    for assumption in &program.assumptions {
        let limit = Limit { patterns: assumption.events.clone(), at_most: i64::from(assumption.at_most) };
        match (assumption.within, way) {
            (None, _) | (Some(_), Windows::Whole) => limits.push(limit),
            (Some(_), Windows::Ignored) => {}
            (Some(within), Windows::Exact) => restricted.restrict(assumption, within)?,
        }
    }
    Ok((restricted, limits))
}
