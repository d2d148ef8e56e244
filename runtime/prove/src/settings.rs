//! How networks are searched, and the one place that calls the search.

use std::sync::{
    Mutex, PoisonError,
    atomic::{AtomicBool, AtomicUsize, Ordering},
};

use hrdsl_ir::{
    suite::{DelayChoice, WitnessKind},
    ta::QueryFormula,
};
use hrdsl_ta::{
    CompiledNetwork, EventCounter, EventLimit, GoalKind, GoalOutcome, ObservationOptions, RangeAnswer,
    ReachabilityGoal, ScheduleOptions, SearchBudget, SearchError, SearchOptions, SearchReport,
    UnreadCounters, WitnessRun,
};
pub use hrdsl_ta::{SearchOrder, SearchStatistics, TimeFrame};

use super::observer::ObservedNetwork;

/// How to search.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ProofOptions {
    pub budget: SearchBudget,
    /// In which order states are looked at; `None`: as the witness needs it. Another order than breadth first finds witnesses
    /// that are not the shortest.
    pub order: Option<SearchOrder>,
    /// Whether each automaton has a time of its own; `Chosen`: where that serves, and as few states show. With an order, with committed
    /// states left out, and with exact counters all have one time, unless `Local` is asked for.
    pub time: TimeFrame,
    /// Answers say in a note how they were searched.
    pub explain: bool,
    /// States with a committed location are not stored: often less memory, and less time.
    pub skip_committed: bool,
    /// States that differ in one-way counters alone, or in counters that nothing reads, are kept apart.
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
    /// Set before `stop`, if that is somebody's wish: nothing was used up.
    pub interrupted: AtomicBool,
    /// How many states are stored so far.
    pub stored: AtomicUsize,
    /// How many of them have been expanded, in this search.
    pub visited: AtomicUsize,
    /// How many wait for it.
    pub waiting: AtomicUsize,
    /// The memory that they take.
    pub bytes: AtomicUsize,
    /// Goals that are not met yet.
    pub open: AtomicUsize,
    /// The goals of a question that are met, in that order.
    met: Mutex<GoalsMet>,
}

/// Which goals of a question were met so far.
#[derive(Debug, Default)]
struct GoalsMet {
    /// Only the search that answers says what is met, not those that explain it.
    listening: bool,
    known: Vec<bool>,
    new: Vec<usize>,
}

impl SearchWatch {
    /// The goals that were met since this was asked last, in the order in which they were. A search for several queries tells this of each, by
    /// its place among them.
    pub fn newly_met(&self) -> Vec<usize> {
        std::mem::take(&mut self.goals_met().new)
    }

    fn goals_met(&self) -> std::sync::MutexGuard<'_, GoalsMet> {
        self.met.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// From here on what is met is told, or not any more.
    pub(crate) fn listen(&self, listening: bool) {
        self.goals_met().listening = listening;
    }

    fn note(&self, progress: &hrdsl_ta::SearchProgress<'_>) {
        self.stored.store(progress.stored, Ordering::Relaxed);
        self.visited.store(progress.visited, Ordering::Relaxed);
        self.waiting.store(progress.waiting, Ordering::Relaxed);
        self.bytes.store(progress.bytes, Ordering::Relaxed);
        self.open.store(progress.open, Ordering::Relaxed);
        let mut met = self.goals_met();
        if !met.listening {
            return;
        }
        met.known.resize(progress.unmet.len(), false);
        for (goal, _) in progress.unmet.iter().enumerate().filter(|(_, unmet)| !**unmet) {
            if !std::mem::replace(&mut met.known[goal], true) {
                met.new.push(goal);
            }
        }
    }

    /// Notes how far a search is; whether it goes on.
    pub(crate) fn goes_on(&self, progress: &hrdsl_ta::SearchProgress<'_>) -> bool {
        self.note(progress);
        !self.is_stopped()
    }

    pub(crate) fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Why a search that was stopped has not decided.
    pub(crate) fn stopped(&self) -> &'static str {
        if self.interrupted.load(Ordering::Relaxed) { "it was interrupted" } else { "the time was over" }
    }
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
            time: match self.time {
                TimeFrame::Chosen if self.is_particular() => TimeFrame::Common,
                TimeFrame::Chosen => TimeFrame::Chosen,
                TimeFrame::Common => TimeFrame::Common,
                TimeFrame::Local => TimeFrame::Local,
            },
            keep_committed: !self.skip_committed,
            counters: !self.exact_counters,
            budget: self.budget,
            seed: self.seed,
            ..usual
        }
    }

    /// The search is one that was asked for.
    fn is_particular(&self) -> bool {
        self.order.is_some() || self.skip_committed || self.exact_counters
    }

    /// How a search was done, and why so.
    pub(crate) fn explanation(&self, report: &SearchReport) -> Option<String> {
        if !self.explain {
            return None;
        }
        let options = self.options();
        let time = match (&report.chosen, options.time) {
            (Some(chosen), _) => chosen.clone(),
            (None, TimeFrame::Local) if report.global_because.is_none() => "local time: asked for".to_owned(),
            (None, TimeFrame::Local | TimeFrame::Common | TimeFrame::Chosen) => {
                "one time for all automata".to_owned()
            }
        };
        let order = match options.order {
            SearchOrder::Breadth if options.keep_shorter => "breadth first, for the shortest runs",
            SearchOrder::Breadth => "breadth first",
            SearchOrder::RandomBreadth => "breadth first, drawn",
            SearchOrder::Depth => "depth first",
            SearchOrder::RandomDepth => "depth first, drawn",
            SearchOrder::Topological => "in the order of the locations, for few states",
        };
        let committed = if options.keep_committed { "stored" } else { "not stored" };
        let threads = options.threads;
        Some(format!("searched with {time}; {order}; committed states {committed}; threads: {threads}"))
    }

    /// How what reachability alone does not decide was searched, and why so.
    pub(crate) fn explanation_in_general(&self) -> Option<String> {
        let why = "deadlocks, bounds and what holds along runs are not decided by zones of local times";
        let threads = self.threads;
        self.explain.then(|| format!("searched with one time for all automata: {why}; threads: {threads}"))
    }

    pub(super) fn timing(&self) -> ScheduleOptions {
        ScheduleOptions { delays: self.delays, seed: self.seed, prompt: false }
    }
}

fn formula(goal: &ReachabilityGoal) -> Option<QueryFormula> {
    if let GoalKind::Formula(f) = &goal.what { Some(f.clone()) } else { None }
}

fn observed_by(
    goals: &[ReachabilityGoal],
    counters: &[EventCounter],
    limits: &[EventLimit],
) -> ObservationOptions {
    ObservationOptions {
        counters: counters.to_vec(),
        limits: limits.to_vec(),
        pairs: goals.iter().any(|g| matches!(g.what, GoalKind::Pair { .. })),
        uses: goals.iter().any(|g| matches!(g.what, GoalKind::Use { .. })),
        formulas: goals.iter().filter_map(formula).collect(),
        ..ObservationOptions::default()
    }
}

pub(crate) fn search(
    observed: &ObservedNetwork,
    goals: &[ReachabilityGoal],
    counters: &[EventCounter],
    limits: &[EventLimit],
    settings: &ProofOptions,
    watch: &SearchWatch,
) -> Result<SearchReport, SearchError> {
    let observe = observed_by(goals, counters, limits);
    let model = CompiledNetwork::new(&observed.program, &observed.network, &observe)?;
    let go_on = |p: &hrdsl_ta::SearchProgress<'_>| watch.goes_on(p);
    let mut report = hrdsl_ta::explore(&model, goals, &settings.options(), &go_on)?;
    choose(goals, &mut report, &|goal, found| chosen(&model, goal, found, settings))?;
    Ok(report)
}

/// As [`search`], of queries: goals that are told as soon as they are met. Variables that nothing reads are searched apart, if they may
/// leave their ranges and the settings allow it.
pub(crate) fn search_queries(
    observed: &ObservedNetwork,
    goals: &[ReachabilityGoal],
    settings: &ProofOptions,
    watch: &SearchWatch,
) -> Result<(SearchReport, Vec<RangeAnswer>), SearchError> {
    let observe = observed_by(goals, &[], &[]);
    let unread = if settings.exact_counters {
        None
    } else {
        UnreadCounters::find(&observed.program, &observed.network, &observe, goals)?
    };
    let Some(unread) = unread else {
        watch.listen(true);
        let report = search(observed, goals, &[], &[], settings, watch);
        watch.listen(false);
        return Ok((report?, Vec::new()));
    };
    // What is met without these variables may be met beyond a fault alone, so that nothing is told early.
    let go_on = |p: &hrdsl_ta::SearchProgress<'_>| watch.goes_on(p);
    let (mut report, ranges) = unread.explore(goals, &settings.options(), &go_on)?;
    choose(goals, &mut report, &|goal, found| match settings.witness {
        WitnessKind::Fastest => unread.fastest(goal, found, settings.budget, settings.timing()),
        WitnessKind::Any | WitnessKind::Shortest => chosen(unread.model(), goal, found, settings),
    })?;
    Ok((report, ranges))
}

/// A run to a goal that the settings ask for, instead of one that was found; `None`: that one.
type ChosenRun<'a> =
    dyn Fn(&ReachabilityGoal, &WitnessRun) -> Result<Option<Box<WitnessRun>>, SearchError> + 'a;

/// The runs that the settings ask for, instead of those that were found.
fn choose(
    goals: &[ReachabilityGoal],
    report: &mut SearchReport,
    chosen: &ChosenRun<'_>,
) -> Result<(), SearchError> {
    for (goal, outcome) in goals.iter().zip(&mut report.goals) {
        if let GoalOutcome::Reached(found) = outcome
            && let Some(run) = chosen(goal, found)?
        {
            *found = run;
        }
    }
    Ok(())
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
