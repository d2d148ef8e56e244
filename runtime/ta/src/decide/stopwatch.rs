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
//! All the rest of what makes the usual search fast is left out: `spec/search.md` says why.

use std::rc::Rc;

use rustc_hash::FxHashMap;

use crate::{
    network::{
        actions::{DelayCondition, EnabledTransition, PathTransition},
        error::ModelError,
        graph::ZoneGraph,
        model::CompiledNetwork,
        query::{GoalKind, ReachabilityGoal, SearchBudget, StateFormula},
    },
    search::{
        options::{SearchOptions, TimeFrame},
        report::{GoalOutcome, SearchCutoff, SearchProgress, SearchReport},
    },
    witness::{
        build::{self, PathSegment, takes},
        error::SearchError,
        schedule::ScheduleOptions,
    },
    zone::{
        dbm::{Dbm, DbmBound, dominates},
        extrapolation::{ActiveClocks, ExtrapolationAbstraction, NONE, thresholds},
    },
};

/// Whoever watches is told each time that so many nodes have been looked from.
const LOOKS: usize = 256;
/// So many paths to a goal are tried in the first search.
const TRIES: usize = 64;
/// The most nodes of the second search.
const EXACT_NODES: usize = 100_000;

/// A discrete state.
struct KnownPlace {
    state: Vec<i64>,
    stay: DelayCondition,
    frame: ActiveClocks,
    /// No automaton is in a committed location.
    settled: bool,
    actions: Rc<[EnabledTransition]>,
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
    if asked.iter().any(|f| f.asks_deadlock()) {
        model.refuse_stopped("`deadlock`")?;
    }
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

    /// Before the second search.
    fn again(&mut self) {
        self.second = true;
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
            widest: None,
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
            if next.is_multiple_of(LOOKS) && !self.goes_on(next, go_on) {
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
            frame: self.graph.frame(&state, ExtrapolationAbstraction::LowerUpper),
            settled: !model.any_committed(&state),
            actions: self.graph.actions(&state).into(),
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
            let known = &self.places[place];
            if self.goals[goal].settled && !known.settled {
                continue;
            }
            if !f.part(&self.graph.here(&known.state), zone)?.is_empty() {
                let path = self.path(from.cloned());
                self.tried(goal, path)?;
            }
        }
        Ok(())
    }

    /// Looks for times of a path along which zones reach a goal.
    fn tried(&mut self, goal: usize, path: Vec<PathSegment>) -> Result<(), SearchError> {
        let StoppedGoalProgress::Open(seen) = &mut self.progress[goal] else { return Ok(()) };
        *seen += 1;
        if *seen > TRIES && !self.second {
            return Ok(());
        }
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

/// Forgets the clocks that nothing asks for before they are set: all other bounds stay exact.
fn forget(zone: &mut Dbm, frame: &ActiveClocks) {
    for (x, lu) in frame.bounds.iter().enumerate().skip(1) {
        if lu.lower != NONE || lu.upper != NONE {
            continue;
        }
        for k in (0..zone.dim()).filter(|k| *k != x) {
            let above = zone.at(k, 0);
            zone.put(x, k, DbmBound::INFINITY);
            zone.put(k, x, above);
        }
    }
}

/// Whether the bounds of the zone after a delay say no more than the delays of its valuations.
///
/// INVARIANT: v' comes from some v by a delay d if d ≥ v'ᵣ - v'ₛ - Zᵣₛ and d ≤ Zₛ'ᵣ' + v'ᵣ' - v'ₛ' for all running r, r' and standing s, s' (0
/// among these). There is such a d exactly if no lower bound is above an upper one, which the bounds that are kept, Zᵣᵣ' and Zₛ'ₛ, say
/// themselves where Zᵣₛ + Zₛ'ᵣ' ≥ Zᵣᵣ' + Zₛ'ₛ.
fn delays_exactly(zone: &Dbm, frame: &ActiveClocks, stopped: &[u16]) -> bool {
    let matters = |x: &usize| frame.bounds[*x].lower != NONE || frame.bounds[*x].upper != NONE;
    let (mut stands, mut runs) = (vec![0], Vec::new());
    for x in (1..zone.dim()).filter(matters) {
        if stopped.iter().any(|&s| usize::from(s) == x) { stands.push(x) } else { runs.push(x) }
    }
    if stands.len() == 1 {
        return true;
    }
    let sum = |a: DbmBound, b: DbmBound| a.plus(b);
    runs.iter().all(|&r| {
        runs.iter().filter(|&&r2| r2 != r).all(|&r2| {
            stands.iter().all(|&s| {
                stands
                    .iter()
                    .filter(|&&s2| s2 != s)
                    .all(|&s2| sum(zone.at(r, s), zone.at(s2, r2)) >= sum(zone.at(r, r2), zone.at(s2, s)))
            })
        })
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::zone::extrapolation::LuBounds;

    const DIM: usize = 5;

    fn matters() -> ActiveClocks {
        ActiveClocks { clocks: (0..DIM as u16).collect(), bounds: vec![LuBounds { lower: 9, upper: 9 }; DIM] }
    }

    fn zone(bounds: &[(usize, usize, i64)]) -> Dbm {
        let mut zone = Dbm::universe(DIM);
        for &(i, j, n) in bounds.iter().filter(|(i, j, _)| i != j) {
            zone.constrain(i, j, DbmBound::le(n));
        }
        zone
    }

    /// x stood at up to 2, y at up to 2, while z and w ran to 2 together: the sum of x and z is not known, and zones say more.
    #[test]
    fn a_delay_of_two_that_run_and_two_that_stand_may_say_too_much() {
        let z = zone(&[(1, 0, 2), (2, 0, 2), (3, 0, 2), (4, 0, 2), (1, 3, 0), (4, 2, 0)]);
        assert!(!delays_exactly(&z, &matters(), &[1, 2]));
        assert!(delays_exactly(&z, &matters(), &[]) && delays_exactly(&z, &matters(), &[1, 2, 3]));
        assert!(delays_exactly(&Dbm::zero(DIM), &matters(), &[1, 2]), "a single state");
    }

    proptest! {
        /// What is said to be exact is: each state of the zone after the delay comes from one before it.
        #[test]
        fn exact_delays_are(
            bounds in prop::collection::vec((0..DIM, 0..DIM, -3i64..6), 0..10),
            stopped in prop::collection::vec(1..DIM as u16, 1..3),
            p in prop::collection::vec(0i64..24, DIM - 1),
        ) {
            let before = zone(&bounds);
            prop_assume!(!before.is_empty() && delays_exactly(&before, &matters(), &stopped));
            let mut after = before.clone();
            after.up_but(&stopped);
            let point: Vec<i64> = std::iter::once(0).chain(p).collect();
            prop_assume!(after.contains(&point, 4));
            let runs = |i: usize| i != 0 && !stopped.contains(&(i as u16));
            let most = (1..DIM).filter(|&i| runs(i)).map(|i| point[i]).min().unwrap_or(0);
            // All bounds are whole, and the point's parts are quarters: so is some delay.
            let from = (0..=most).any(|d| {
                let earlier: Vec<i64> = (0..DIM).map(|i| point[i] - if runs(i) { d } else { 0 }).collect();
                before.contains(&earlier, 4)
            });
            prop_assert!(from, "{point:?} of {after:?} from {before:?}");
        }
    }
}
