//! How networks are searched, and the one place that calls the search.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use hrdsl_ir::{
    suite::{DelayChoice, WitnessKind},
    ta::QueryFormula,
};
pub use hrdsl_ta::SearchOrder;
use hrdsl_ta::{
    CompiledNetwork, EventCounter, EventLimit, GoalKind, GoalOutcome, ObservationOptions, ReachabilityGoal,
    ScheduleOptions, SearchBudget, SearchError, SearchOptions, SearchReport, WitnessRun,
};

use super::observer::ObservedNetwork;

/// How to search.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ProofOptions {
    pub budget: SearchBudget,
    /// In which order states are looked at; `None`: as the witness needs it. Another order than breadth first finds witnesses
    /// that are not the shortest.
    pub order: Option<SearchOrder>,
    /// Each automaton has a time of its own, where that serves.
    pub local_time: bool,
    /// States with a committed location are not stored: often less memory, and less time.
    pub skip_committed: bool,
    /// States that differ in one-way counters alone are kept apart.
    pub exact_counters: bool,
    /// Threads that search at once; 0 is 1.
    pub threads: usize,
    pub witness: WitnessKind,
    pub delays: DelayChoice,
    /// Of what is drawn: sampled delays, a random order.
    pub seed: u64,
    /// First look for what keeps windowed assumptions for certain: better for tests. Otherwise first for what cannot be
    /// reached even without them: better for proofs.
    pub keep_first: bool,
}

/// For watching a search from another thread.
#[derive(Debug, Default)]
pub struct SearchWatch {
    /// Set: the search ends soon, and what is not decided is inconclusive.
    pub stop: AtomicBool,
    /// How many states are stored so far.
    pub stored: AtomicUsize,
}

impl ProofOptions {
    pub(super) fn options(&self) -> SearchOptions {
        let usual = match self.witness {
            // For tests short ones will do, of which a search finds many at once.
            WitnessKind::Shortest => {
                SearchOptions { keep_shorter: !self.keep_first, ..SearchOptions::shortest() }
            }
            WitnessKind::Any | WitnessKind::Fastest => SearchOptions::default(),
        };
        SearchOptions {
            order: self.order.unwrap_or(usual.order),
            threads: self.threads.max(1),
            local_time: self.local_time,
            keep_committed: !self.skip_committed,
            counters: !self.exact_counters,
            budget: self.budget,
            seed: self.seed,
            ..usual
        }
    }

    pub(super) fn timing(&self) -> ScheduleOptions {
        ScheduleOptions { delays: self.delays, seed: self.seed, prompt: false }
    }
}

fn formula(goal: &ReachabilityGoal) -> Option<QueryFormula> {
    if let GoalKind::Formula(f) = &goal.what { Some(f.clone()) } else { None }
}

pub(crate) fn search(
    observed: &ObservedNetwork,
    goals: &[ReachabilityGoal],
    counters: &[EventCounter],
    limits: &[EventLimit],
    settings: &ProofOptions,
    watch: &SearchWatch,
) -> Result<SearchReport, SearchError> {
    let observe = ObservationOptions {
        counters: counters.to_vec(),
        limits: limits.to_vec(),
        pairs: goals.iter().any(|g| matches!(g.what, GoalKind::Pair { .. })),
        uses: goals.iter().any(|g| matches!(g.what, GoalKind::Use { .. })),
        formulas: goals.iter().filter_map(formula).collect(),
        ..ObservationOptions::default()
    };
    let model = CompiledNetwork::new(&observed.program, &observed.network, &observe)?;
    let go_on = |p: &hrdsl_ta::SearchProgress| {
        watch.stored.store(p.stored, Ordering::Relaxed);
        !watch.stop.load(Ordering::Relaxed)
    };
    let mut report = hrdsl_ta::explore(&model, goals, &settings.options(), &go_on)?;
    for (goal, outcome) in goals.iter().zip(&mut report.goals) {
        if let GoalOutcome::Reached(found) = outcome
            && let Some(run) = chosen(&model, goal, found, settings)?
        {
            *found = run;
        }
    }
    Ok(report)
}

/// The run that the settings ask for, instead of the one that was found; `None`: that one.
fn chosen(
    model: &CompiledNetwork<'_>,
    goal: &ReachabilityGoal,
    found: &WitnessRun,
    settings: &ProofOptions,
) -> Result<Option<Box<WitnessRun>>, SearchError> {
    let by_time = !matches!(goal.what, GoalKind::Pair { .. } | GoalKind::Use { .. });
    if settings.witness == WitnessKind::Fastest
        && by_time
        && let Some(run) = hrdsl_ta::fastest(model, goal, found, settings.budget, settings.timing())?
    {
        return Ok(Some(run));
    }
    if settings.delays == DelayChoice::Earliest {
        return Ok(None);
    }
    hrdsl_ta::retimed(model, found, goal, settings.timing()).map(|run| Some(Box::new(run)))
}
