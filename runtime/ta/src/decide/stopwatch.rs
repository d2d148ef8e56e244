//! Reachability where clocks stand still in some locations.
//!
//! A zone of clocks that are not all equally fast is more than can happen (Cassez and Larsen, "The Impressive Power of Stopwatches",
//! CONCUR 2000). So what no zone reaches is proved unreachable, and what one reaches is believed only when its path is timed by an exact
//! linear program over the delays, and replayed.
//!
//! 1. A search breadth first, in which a zone is left out if a known one simulates it (aLU: clocks are compared one by one, so that a
//!    valuation simulates another however long which clocks stand). Each path to a goal is tried.
//! 2. For goals that zones reach and no path that was tried does: once more, and a zone is left out only if one that is *exact* simulates it.
//!    A zone is exact until a delay says too much; from then on each path is kept only if it can be timed. What this
//!    second search comes to the end of, it has decided; otherwise the zones cannot tell.
//!
//! A deadlock is a state that can do less than those that simulate it. So the first search looks for it in all that a zone simulates, and the
//! second leaves a zone out only for one in which the same can happen (aM: clocks have the same values, or are both beyond all bounds).
//!
//! All the rest of what makes the usual search fast is left out: `spec/search.md` says why.

use std::rc::Rc;

use rustc_hash::FxHashMap;

use crate::{
    decide::standing_delays::{delays_exactly, forget},
    network::{
        actions::{DelayCondition, EnabledTransition, PathTransition},
        error::ModelError,
        graph::ZoneGraph,
        model::CompiledNetwork,
        query::{GoalKind, ReachabilityGoal, SearchBudget, StateFormula},
    },
    search::{
        options::{SearchOptions, TimeFrame},
        report::{GoalOutcome, SearchCutoff, SearchProgress, SearchReport, WidestVariable},
    },
    witness::{
        build::{self, PathSegment, takes},
        error::SearchError,
        schedule::ScheduleOptions,
    },
    zone::{
        constraint::keep,
        dbm::{Dbm, dominates},
        extrapolation::{ActiveClocks, ExtrapolationAbstraction, simulated_hull, thresholds},
        federation::Federation,
    },
};

/// Whoever watches is told each time that so many nodes have been looked from.
const LOOKS: usize = 256;
/// So many paths to a goal are tried in the first search.
const TRIES: usize = 64;
/// The most nodes of the second search.
const EXACT_NODES: usize = 100_000;
/// The most that its paths may cost: a linear program takes about the cube of its path's length.
const EXACT_EFFORT: u64 = 300_000_000;
/// In the second search, whoever watches is told more often, since paths are timed.
const EXACT_LOOKS: usize = 8;

/// A discrete state.
struct KnownPlace {
    state: Vec<i64>,
    stay: DelayCondition,
    frame: ActiveClocks,
    /// No automaton is in a committed location.
    settled: bool,
    actions: Rc<[EnabledTransition]>,
    /// By goal: the clocks that meet a formula with `deadlock`, once they were asked for.
    met: FxHashMap<usize, Rc<Federation>>,
}

/// A symbolic state, with how it was come to.
struct StopwatchNode {
    place: usize,
    /// After time has passed.
    zone: Dbm,
    /// Each of its valuations can be reached along its path.
    exact: bool,
    from: Option<(usize, Rc<PathTransition>)>,
}

/// What is known of a goal.
enum StoppedGoalProgress {
    /// Zones have reached it so many times, and no run was found.
    Open(usize),
    Ended(GoalOutcome),
}

struct StopwatchSearch<'g, 'm, 'p> {
    graph: &'g ZoneGraph<'m, 'p>,
    goals: &'g [ReachabilityGoal],
    formulas: Vec<Option<StateFormula>>,
    progress: Vec<StoppedGoalProgress>,
    places: Vec<KnownPlace>,
    numbers: FxHashMap<Vec<i64>, usize>,
    nodes: Vec<StopwatchNode>,
    /// By place: the nodes that others may be left out for.
    known: Vec<Vec<usize>>,
    /// The second search.
    second: bool,
    /// Zones met a fault to which no run was found.
    doubt: bool,
    /// What the paths that were timed cost.
    effort: u64,
    /// Local time was asked for.
    local_time: bool,
    stored: usize,
    visited: usize,
    transitions: usize,
    bytes: usize,
    peak: usize,
}

/// Searches a network in which clocks stand still.
///
/// # Errors
/// If a fault of the model is met, or a goal asks for what is not decided of such networks.
pub(crate) fn explore(
    model: &CompiledNetwork,
    goals: &[ReachabilityGoal],
    options: &SearchOptions,
    go_on: &dyn Fn(&SearchProgress) -> bool,
) -> Result<SearchReport, SearchError> {
    let formulas: Vec<Option<StateFormula>> = goals.iter().map(ReachabilityGoal::formula).collect();
    let asked: Vec<&StateFormula> = formulas.iter().flatten().collect();
    goals.iter().try_for_each(|goal| model.check_goal(goal))?;
    let graph = ZoneGraph::new(model, &asked)?;
    if graph.splits() {
        model.refuse_stopped("a comparison of two clocks with each other")?;
    }
    let progress = goals.iter().map(|_| StoppedGoalProgress::Open(0)).collect();
    let mut search = StopwatchSearch {
        graph: &graph,
        goals,
        formulas,
        progress,
        places: Vec::new(),
        numbers: FxHashMap::default(),
        nodes: Vec::new(),
        known: Vec::new(),
        second: false,
        doubt: false,
        effort: 0,
        local_time: options.time == TimeFrame::Local,
        stored: 0,
        visited: 0,
        transitions: 0,
        bytes: 0,
        peak: 0,
    };
    let mut cutoff = search.go(options.budget, go_on)?;
    search.settle(cutoff);
    if cutoff.is_none() && search.open() > 0 {
        search.again();
        let states = options.budget.states.min(EXACT_NODES);
        cutoff = search.go(SearchBudget { states, ..options.budget }, go_on)?;
        search.settle(cutoff);
    }
    Ok(search.report(cutoff))
}

impl StopwatchSearch<'_, '_, '_> {
    fn open(&self) -> usize {
        self.progress.iter().filter(|p| matches!(p, StoppedGoalProgress::Open(_))).count()
    }

    /// What the end of a search says of the goals that are open.
    fn settle(&mut self, cutoff: Option<SearchCutoff>) {
        let (second, doubt) = (self.second, self.doubt);
        for progress in &mut self.progress {
            let StoppedGoalProgress::Open(seen) = progress else { continue };
            let outcome = match cutoff {
                None if second || (*seen == 0 && !doubt) => GoalOutcome::Unreachable,
                None => continue,
                Some(SearchCutoff::Stopped) => GoalOutcome::Inconclusive(SearchCutoff::Stopped),
                Some(_) if second => GoalOutcome::Inconclusive(SearchCutoff::Zones),
                Some(what) => GoalOutcome::Inconclusive(what),
            };
            *progress = StoppedGoalProgress::Ended(outcome);
        }
    }

    /// What a zone may be left out for must be able to do.
    fn abstraction(&self) -> ExtrapolationAbstraction {
        if self.second && self.formulas.iter().flatten().any(StateFormula::asks_deadlock) {
            ExtrapolationAbstraction::Greatest
        } else {
            ExtrapolationAbstraction::LowerUpper
        }
    }

    /// Before the second search.
    fn again(&mut self) {
        (self.second, self.effort) = (true, 0);
        let (graph, abstraction) = (self.graph, self.abstraction());
        self.places.iter_mut().for_each(|place| place.frame = graph.frame(&place.state, abstraction));
        self.stored += self.nodes.len();
        self.nodes.clear();
        self.known.iter_mut().for_each(Vec::clear);
        self.bytes = 0;
    }

    fn report(self, cutoff: Option<SearchCutoff>) -> SearchReport {
        let ended = |p: StoppedGoalProgress| match p {
            StoppedGoalProgress::Ended(outcome) => outcome,
            StoppedGoalProgress::Open(_) => GoalOutcome::Inconclusive(SearchCutoff::Zones),
        };
        SearchReport {
            states_stored: self.stored + self.nodes.len(),
            states_visited: self.visited,
            discrete_states: self.places.len(),
            transitions: self.transitions,
            peak_bytes: self.peak,
            complete: cutoff.is_none(),
            global_because: self.local_time.then(|| "clocks stand still".to_owned()),
            chosen: None,
            widest: cutoff.and_then(|_| {
                WidestVariable::among(self.graph.model, self.places.iter().map(|p| p.state.as_slice()))
            }),
            goals: self.progress.into_iter().map(ended).collect(),
        }
    }

    /// `Some`: the budget was used up first.
    fn go(
        &mut self,
        budget: SearchBudget,
        go_on: &dyn Fn(&SearchProgress) -> bool,
    ) -> Result<Option<SearchCutoff>, SearchError> {
        let (state, stay, zone) = self.graph.start()?;
        let place = self.place(state, stay);
        self.arrive(place, zone, true, None)?;
        let mut next = 0;
        while next < self.nodes.len() {
            if !self.goals.is_empty() && self.open() == 0 {
                return Ok(None);
            }
            if self.nodes.len() >= budget.states {
                return Ok(Some(SearchCutoff::States));
            }
            if self.bytes >= budget.bytes {
                return Ok(Some(SearchCutoff::Memory));
            }
            if self.second && self.effort >= EXACT_EFFORT {
                return Ok(Some(SearchCutoff::Zones));
            }
            let looks = if self.second { EXACT_LOOKS } else { LOOKS };
            if next.is_multiple_of(looks) && !self.goes_on(next, go_on) {
                return Ok(Some(SearchCutoff::Stopped));
            }
            self.visited += 1;
            self.expand(next)?;
            next += 1;
        }
        Ok(None)
    }

    fn goes_on(&self, next: usize, go_on: &dyn Fn(&SearchProgress) -> bool) -> bool {
        let unmet: Vec<bool> =
            self.progress.iter().map(|p| matches!(p, StoppedGoalProgress::Open(_))).collect();
        go_on(&SearchProgress {
            stored: self.stored + self.nodes.len(),
            visited: self.visited,
            waiting: self.nodes.len() - next,
            bytes: self.bytes,
            open: self.open(),
            unmet: &unmet,
        })
    }

    /// The number of a discrete state.
    fn place(&mut self, state: Vec<i64>, stay: DelayCondition) -> usize {
        if let Some(&known) = self.numbers.get(&state) {
            return known;
        }
        let model = self.graph.model;
        let place = KnownPlace {
            stay,
            frame: self.graph.frame(&state, self.abstraction()),
            settled: !model.any_committed(&state),
            actions: self.graph.actions(&state).into(),
            met: FxHashMap::default(),
            state: state.clone(),
        };
        self.bytes += 2 * size_of_val(state.as_slice()) + size_of::<KnownPlace>();
        self.places.push(place);
        self.known.push(Vec::new());
        self.numbers.insert(state, self.places.len() - 1);
        self.places.len() - 1
    }

    fn expand(&mut self, at: usize) -> Result<(), SearchError> {
        let place = self.nodes[at].place;
        let actions = Rc::clone(&self.places[place].actions);
        for action in actions.iter() {
            let guarded = self.graph.guarded(action, &self.nodes[at].zone);
            let (target, mut zone) = match guarded {
                Ok(None) => continue,
                Err(fault) => {
                    self.fault(at, fault)?;
                    continue;
                }
                Ok(Some((target, zone))) => (target.to_vec(), zone),
            };
            let stay = match self.graph.stay(&target) {
                Ok(None) => continue,
                Err(fault) => {
                    self.fault(at, fault)?;
                    continue;
                }
                Ok(Some(stay)) => stay,
            };
            if !self.graph.take(action, &stay, &mut zone) {
                continue;
            }
            self.transitions += 1;
            self.taken(at, &action.taken)?;
            let there = self.place(target, stay);
            let exact = self.nodes[at].exact;
            self.arrive(there, zone, exact, Some((at, Rc::clone(&action.taken))))?;
        }
        Ok(())
    }

    /// Goals over edges that a transition meets.
    fn taken(&mut self, at: usize, taken: &Rc<PathTransition>) -> Result<(), SearchError> {
        for goal in 0..self.goals.len() {
            if self.formulas[goal].is_none()
                && matches!(self.progress[goal], StoppedGoalProgress::Open(_))
                && self.meets_edge(&self.goals[goal].what, &self.places[self.nodes[at].place].state, taken)
            {
                let path = self.path(Some((at, Rc::clone(taken))));
                self.tried(goal, path)?;
            }
        }
        Ok(())
    }

    fn meets_edge(&self, goal: &GoalKind, before: &[i64], taken: &PathTransition) -> bool {
        let model = self.graph.model;
        let number = |m: usize, e: usize| i64::from(model.members[m].edges[e].number);
        let takes = |m: usize, e: usize| {
            taken.parts.iter().any(|p| usize::from(p.member) == m && usize::from(p.edge) == e)
        };
        match goal {
            GoalKind::Edge { automaton, edge } => takes(*automaton, *edge),
            GoalKind::Pair { automaton, first, second } => {
                let last = before[model.last_edge_at(*automaton)];
                takes(*automaton, *second) && last == number(*automaton, *first)
            }
            GoalKind::Use { slot, definition, user } => {
                let last = before[model.last_definition_at(*slot)];
                takes(user.0, user.1) && last == definition.map_or(0, |(m, e)| number(m, e))
            }
            GoalKind::Location { .. } | GoalKind::Condition(_) | GoalKind::Formula(_) => false,
        }
    }

    /// Looks at a symbolic state before time passes, and keeps it if it is new.
    fn arrive(
        &mut self,
        place: usize,
        mut zone: Dbm,
        mut exact: bool,
        from: Option<(usize, Rc<PathTransition>)>,
    ) -> Result<(), SearchError> {
        let (stay, frame) = (&self.places[place].stay, &self.places[place].frame);
        forget(&mut zone, frame);
        exact &= !stay.waits || delays_exactly(&zone, frame, &stay.stopped);
        self.graph.wait(stay, &mut zone);
        if self.second && !exact {
            let path = self.path(from.clone());
            self.note_effort(&path);
            if build::feasible(self.graph, &path)? == Some(false) {
                return Ok(());
            }
        }
        self.state_goals(place, &zone, from.as_ref())?;
        if self.simulated(place, &zone) {
            return Ok(());
        }
        self.bytes += zone.heap_bytes() + size_of::<StopwatchNode>();
        self.peak = self.peak.max(self.bytes);
        if exact || !self.second {
            self.known[place].push(self.nodes.len());
        }
        self.nodes.push(StopwatchNode { place, zone, exact, from });
        Ok(())
    }

    /// Whether a node that is known stands for this zone.
    fn simulated(&self, place: usize, zone: &Dbm) -> bool {
        let dim = zone.dim();
        let mut demands = Vec::new();
        thresholds(&self.places[place].frame, zone, &mut demands);
        self.known[place].iter().any(|&n| {
            let old = &self.nodes[n].zone;
            (0..dim).all(|i| dominates(old.row(i), &demands[i * dim..(i + 1) * dim]))
        })
    }

    fn state_goals(
        &mut self,
        place: usize,
        zone: &Dbm,
        from: Option<&(usize, Rc<PathTransition>)>,
    ) -> Result<(), SearchError> {
        for goal in 0..self.goals.len() {
            let (Some(f), StoppedGoalProgress::Open(_)) = (&self.formulas[goal], &self.progress[goal]) else {
                continue;
            };
            if self.goals[goal].settled && !self.places[place].settled {
                continue;
            }
            let meets = if f.asks_deadlock() {
                self.may_be_met(goal, place, zone)?
            } else {
                !f.part(&self.graph.here(&self.places[place].state), zone)?.is_empty()
            };
            if meets {
                let path = self.path(from.cloned());
                self.tried(goal, path)?;
            }
        }
        Ok(())
    }

    /// Whether a formula with `deadlock` may hold in a state that a zone stands for.
    fn may_be_met(&mut self, goal: usize, place: usize, zone: &Dbm) -> Result<bool, ModelError> {
        let known = &mut self.places[place];
        let met = match (known.met.get(&goal), &self.formulas[goal]) {
            (Some(met), _) => Rc::clone(met),
            (None, None) => return Ok(false),
            (None, Some(formula)) => {
                let mut all = Dbm::universe(self.graph.dim());
                known.stay.invariant.iter().for_each(|c| {
                    keep(&mut all, *c);
                });
                let met = Rc::new(formula.part(&self.graph.here(&known.state), &all)?);
                known.met.insert(goal, Rc::clone(&met));
                met
            }
        };
        let hull = if self.second { zone.clone() } else { simulated_hull(&known.frame, zone) };
        Ok(met.zones().iter().any(|part| part.clone().intersect(&hull)))
    }

    fn note_effort(&mut self, path: &[PathSegment]) {
        self.effort = self.effort.saturating_add((path.len() as u64).saturating_pow(3));
    }

    /// Looks for times of a path along which zones reach a goal.
    fn tried(&mut self, goal: usize, path: Vec<PathSegment>) -> Result<(), SearchError> {
        let StoppedGoalProgress::Open(seen) = &mut self.progress[goal] else { return Ok(()) };
        *seen += 1;
        if *seen > TRIES && !self.second {
            return Ok(());
        }
        self.note_effort(&path);
        let (asked, timing) = (&self.goals[goal], ScheduleOptions::default());
        let run = match &self.formulas[goal] {
            Some(f) => build::reach_goal(self.graph, path, f, asked, timing)?,
            None => build::timed(self.graph, &path, asked, timing)?,
        };
        if let Some(run) = run {
            self.progress[goal] = StoppedGoalProgress::Ended(GoalOutcome::Reached(Box::new(run)));
        }
        Ok(())
    }

    /// A fault that zones meet: an error, if a run meets it, too.
    fn fault(&mut self, at: usize, error: ModelError) -> Result<(), SearchError> {
        match build::fault(self.graph, self.path(self.nodes[at].from.clone()), error) {
            SearchError::Internal(_) if !self.nodes[at].exact => {
                self.doubt = true;
                Ok(())
            }
            found @ (SearchError::Internal(_) | SearchError::Model { .. }) => Err(found),
        }
    }

    /// All transitions up to a last one.
    fn path(&self, last: Option<(usize, Rc<PathTransition>)>) -> Vec<PathSegment> {
        let mut all = Vec::new();
        let mut next = last;
        while let Some((at, taken)) = next {
            all.push(taken);
            next = self.nodes[at].from.clone();
        }
        all.reverse();
        takes(all)
    }
}
