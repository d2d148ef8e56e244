//! Goals with `deadlock`, on the same packed states as other goals.
//!
//! A deadlock is a state that can do *less*, and a search by simulation keeps those that can do most. So the question is put twice:
//!
//! - First the search goes on by simulation (aLU), as for other goals. All that can be reached is simulated by what is kept: where
//!   nothing that a kept zone simulates meets the formula, nothing that can be reached does, and that is a proof. Where something might,
//!   the path tells whether a run along it does: then the goal is met.
//! - If none does, the question is open, and decided by a second search that tells apart whatever can be told apart (aM, a
//!   bisimulation): there a kept zone meets the formula exactly if a run does.
//!
//! Which clock values of a discrete state meet the formula is found once for all its zones: for most states none do.

use std::{
    ops::ControlFlow,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
};

use rustc_hash::FxHashMap;

use crate::{
    decide::{places::each_place, stopwatch},
    network::{
        actions::PathTransition,
        error::ModelError,
        graph::ZoneGraph,
        model::CompiledNetwork,
        query::{ReachabilityGoal, SearchBudget, StateFormula},
    },
    search::{
        expand::arrival,
        options::{SearchOptions, SearchOrder},
        probe::{ProbeFinding, ProbeValue, ProbedState, StateProbe, spread},
        report::{GoalOutcome, SearchCutoff},
        round_search::{SearchAside, SearchCompany},
        start,
    },
    witness::{
        build::{reach_goal, takes, unreal},
        error::SearchError,
        run::WitnessRun,
        schedule::ScheduleOptions,
    },
    zone::{
        constraint::keep,
        dbm::Dbm,
        extrapolation::{ActiveClocks, ExtrapolationAbstraction, simulated_hull},
        federation::Federation,
    },
};

/// How a goal ended, and how many symbolic states were kept.
pub(crate) type DecidedGoal = (GoalOutcome, usize);

/// Looks in each symbolic state for what meets the formulas.
struct FormulaProbe<'a, 'm, 'p> {
    graph: &'a ZoneGraph<'m, 'p>,
    goals: &'a [&'a ReachabilityGoal],
    formulas: &'a [StateFormula],
    open: Vec<AtomicBool>,
    /// Zones are exact as far as formulas can tell; otherwise they stand for all that they simulate.
    exact: bool,
    /// The last clock of zones is the time since the start.
    timed: bool,
    /// By discrete state, where any: the formulas that some clocks meet, and which.
    met: Mutex<FxHashMap<Box<[i64]>, Arc<MeetingZones>>>,
}

/// Formulas, each with the zones that meet it.
type MeetingZones = Vec<(usize, Federation)>;

impl StateProbe for FormulaProbe<'_, '_, '_> {
    fn each_place(&self, model: &CompiledNetwork, f: &mut dyn FnMut(u32)) {
        self.formulas.iter().for_each(|formula| each_place(model, formula, f));
    }

    fn matters(&self, state: &[i64]) -> Result<bool, ModelError> {
        let met = self.meeting(state)?;
        let any = !met.is_empty();
        if any {
            let mut all = self.met.lock().unwrap_or_else(PoisonError::into_inner);
            all.insert(state.into(), Arc::new(met));
        }
        Ok(any)
    }

    fn look(&self, at: &ProbedState, out: &mut Vec<ProbeFinding>) -> Result<(), ModelError> {
        let known = self.met.lock().unwrap_or_else(PoisonError::into_inner).get(at.state).cloned();
        let met = match known {
            Some(met) => met,
            // Another worker asked.
            None => Arc::new(self.meeting(at.state)?),
        };
        let dim = self.graph.dim() + usize::from(self.timed);
        let zone = if self.exact {
            spread(dim, at.frame, at.zone)
        } else {
            spread(dim, at.frame, &simulated_hull(at.frame, at.zone))
        };
        for (question, zones) in met.iter().filter(|(question, _)| self.is_open(*question)) {
            let parts = zones.zones().iter().filter_map(|met| {
                let mut part = if self.timed { with_time(met) } else { met.clone() };
                part.intersect(&zone).then(|| if self.timed { arrival(&part) } else { 0 })
            });
            if let Some(arrival) = parts.min() {
                let value = ProbeValue::Met { arrival };
                out.push(ProbeFinding { node: at.node, question: *question, value });
            }
        }
        Ok(())
    }
}

/// The zone with a clock more, of which nothing is known.
fn with_time(zone: &Dbm) -> Dbm {
    let clocks = (0..zone.dim() as u16).collect();
    spread(zone.dim() + 1, &ActiveClocks { clocks, bounds: Vec::new() }, zone)
}

impl<'a, 'm, 'p> FormulaProbe<'a, 'm, 'p> {
    fn is_open(&self, question: usize) -> bool {
        self.open[question].load(Ordering::Relaxed)
    }

    fn close(&self, question: usize) {
        self.open[question].store(false, Ordering::Relaxed);
    }

    fn any_open(&self) -> bool {
        (0..self.open.len()).any(|question| self.is_open(question))
    }

    /// What meets the formulas in a discrete state, within its invariants.
    fn meeting(&self, state: &[i64]) -> Result<MeetingZones, ModelError> {
        let Some(stay) = self.graph.stay(state)? else { return Ok(Vec::new()) };
        let mut all = Dbm::universe(self.graph.dim());
        stay.invariant.iter().for_each(|c| {
            keep(&mut all, *c);
        });
        let (here, settled) = (self.graph.here(state), !self.graph.model.any_committed(state));
        let mut met = Vec::new();
        for (question, formula) in self.formulas.iter().enumerate() {
            if self.goals[question].settled && !settled {
                continue;
            }
            let part = formula.part(&here, &all)?;
            if !part.is_empty() {
                met.push((question, part));
            }
        }
        Ok(met)
    }
}

/// How a question about deadlocks is asked.
pub(crate) struct DeadlockOptions {
    pub budget: SearchBudget,
    pub threads: usize,
    /// Runs have as few transitions as any.
    pub shortest: bool,
}

/// So many symbolic states at most are kept to make the run to a deadlock a shortest one.
pub const SHORTEST: usize = 50_000;

/// Decides goals over formulas.
///
/// # Errors
/// If the model is at fault, or the engine contradicts itself.
pub(crate) fn deadlocks(
    model: &CompiledNetwork,
    goals: &[&ReachabilityGoal],
    options: &DeadlockOptions,
    company: SearchCompany<'_>,
) -> Result<Vec<DecidedGoal>, SearchError> {
    if model.stops() {
        let asked: Vec<ReachabilityGoal> = goals.iter().map(|goal| (*goal).clone()).collect();
        let options = SearchOptions { budget: options.budget, ..SearchOptions::default() };
        let report = stopwatch::explore(model, &asked, &options, company.go_on)?;
        company.add(report.statistics());
        company.widest.set(report.widest);
        let stored = report.states_stored;
        return Ok(report.goals.into_iter().map(|outcome| (outcome, stored)).collect());
    }
    let formulas: Vec<StateFormula> = goals.iter().filter_map(|g| g.formula()).collect();
    let graph = ZoneGraph::new(model, &[])?;
    let search = DeadlockSearch { graph, goals, formulas: &formulas, options, company };
    let mut all: Vec<Option<DecidedGoal>> = goals.iter().map(|_| None).collect();
    search.go(ExtrapolationAbstraction::LowerUpper, options.budget, &mut all)?;
    // A run that simulation finds may be longer than the one to another deadlock.
    let long = |d: &DecidedGoal| matches!(&d.0, GoalOutcome::Reached(run) if run.steps.len() > 1);
    let again: Vec<bool> =
        all.iter().map(|d| d.as_ref().is_none_or(|d| options.shortest && long(d))).collect();
    if again.contains(&true) {
        let open = all.iter().any(Option::is_none);
        let mut exact: Vec<Option<DecidedGoal>> =
            all.iter().zip(&again).map(|(d, again)| d.clone().filter(|_| !again)).collect();
        let few = SearchBudget { states: options.budget.states.min(SHORTEST), ..options.budget };
        search.go(ExtrapolationAbstraction::Greatest, if open { options.budget } else { few }, &mut exact)?;
        for (d, exact) in all.iter_mut().zip(exact) {
            if d.is_none() || exact.as_ref().is_some_and(|(o, _)| matches!(o, GoalOutcome::Reached(_))) {
                *d = exact;
            }
        }
    }
    let lost = || SearchError::Internal("a question about deadlocks has no answer".into());
    all.into_iter().map(|d| d.ok_or_else(lost)).collect()
}

struct DeadlockSearch<'a, 'm, 'p> {
    graph: ZoneGraph<'m, 'p>,
    goals: &'a [&'a ReachabilityGoal],
    formulas: &'a [StateFormula],
    options: &'a DeadlockOptions,
    company: SearchCompany<'a>,
}

impl DeadlockSearch<'_, '_, '_> {
    /// Decides what is open, as far as the abstraction can.
    fn go(
        &self,
        abstraction: ExtrapolationAbstraction,
        budget: SearchBudget,
        all: &mut [Option<DecidedGoal>],
    ) -> Result<(), SearchError> {
        let model = self.graph.model;
        let exact =
            abstraction == ExtrapolationAbstraction::Greatest || model.extrapolation.diagonals.is_some();
        let probe = self.probe(exact, all);
        let options = SearchOptions {
            order: SearchOrder::Breadth,
            abstraction,
            keep_shorter: self.options.shortest,
            threads: self.options.threads.max(1),
            budget,
            ..SearchOptions::default()
        };
        let beside = SearchAside { probe: Some(&probe), within: None, go_on: Some(self.company.go_on) };
        let mut search = start::begin(model, &[], &options, beside)?;
        let mut found = Vec::new();
        loop {
            let flow = search.round(&mut found)?;
            for finding in found.drain(..).filter(|f| probe.is_open(f.question)).collect::<Vec<_>>() {
                if !probe.is_open(finding.question) {
                    continue;
                }
                probe.close(finding.question);
                let path = search.path_to(finding.node)?;
                match self.run(path, finding.question)? {
                    Some(run) => {
                        let reached = GoalOutcome::Reached(Box::new(run));
                        all[finding.question] = Some((reached, search.stored()));
                    }
                    None if exact => return Err(unreal()),
                    // Left to the search that tells more apart.
                    None => {}
                }
            }
            let end = if probe.any_open() { flow } else { ControlFlow::Break(None) };
            if let ControlFlow::Break(end) = end {
                self.close(&probe, end, search.stored(), all);
                if end.is_some() {
                    self.company.widest.set(search.widest());
                }
                self.company.add(search.statistics());
                return Ok(());
            }
        }
    }

    fn probe(&self, exact: bool, all: &[Option<DecidedGoal>]) -> FormulaProbe<'_, '_, '_> {
        FormulaProbe {
            graph: &self.graph,
            goals: self.goals,
            formulas: self.formulas,
            open: all.iter().map(|d| AtomicBool::new(d.is_none())).collect(),
            exact,
            timed: false,
            met: Mutex::default(),
        }
    }

    /// What is still open was nowhere.
    fn close(
        &self,
        probe: &FormulaProbe,
        end: Option<SearchCutoff>,
        stored: usize,
        all: &mut [Option<DecidedGoal>],
    ) {
        for (question, decided) in all.iter_mut().enumerate() {
            if probe.is_open(question) {
                let outcome = end.map_or(GoalOutcome::Unreachable, GoalOutcome::Inconclusive);
                *decided = Some((outcome, stored));
            }
        }
    }

    /// A run along the path that meets the goal; `None`: there is none.
    fn run(&self, path: Vec<PathTransition>, question: usize) -> Result<Option<WitnessRun>, SearchError> {
        let stops = takes(path.into_iter().map(std::rc::Rc::new));
        let formula = &self.formulas[question];
        reach_goal(&self.graph, stops, formula, self.goals[question], ScheduleOptions::default())
    }
}

/// The path to where a formula with `deadlock` holds as early as anywhere; `None`: nowhere within so many units, or the budget was used up.
///
/// # Errors
/// If the model is at fault, or the engine contradicts itself.
pub(crate) fn earliest(
    model: &CompiledNetwork,
    goal: &ReachabilityGoal,
    formula: &StateFormula,
    within: i64,
    budget: SearchBudget,
) -> Result<Option<Vec<PathTransition>>, SearchError> {
    let graph = ZoneGraph::new(model, &[])?;
    let probe = FormulaProbe {
        graph: &graph,
        goals: &[goal],
        formulas: std::slice::from_ref(formula),
        open: vec![AtomicBool::new(true)],
        exact: true,
        timed: true,
        met: Mutex::default(),
    };
    let options =
        SearchOptions { abstraction: ExtrapolationAbstraction::Greatest, budget, ..SearchOptions::default() };
    let beside = SearchAside { probe: Some(&probe), within: Some(within), go_on: None };
    let mut search = start::begin(model, &[], &options, beside)?;
    let (mut found, mut best) = (Vec::new(), None);
    loop {
        let flow = search.round(&mut found)?;
        for finding in found.drain(..) {
            let ProbeValue::Met { arrival } = finding.value else { continue };
            if best.is_none_or(|(old, _)| arrival < old) {
                best = Some((arrival, finding.node));
                search.only_until(arrival - 1);
            }
        }
        match flow {
            ControlFlow::Continue(()) => {}
            ControlFlow::Break(Some(_)) => return Ok(None),
            ControlFlow::Break(None) => {
                return best.map(|(_, node)| search.path_to(node)).transpose();
            }
        }
    }
}
