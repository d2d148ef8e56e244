//! Search of the local zone graph, with subsumption on the synchronised part of zones.

use std::{rc::Rc, sync::Arc};

use super::{
    batch::{ArrivedZone, LocalArrival, LocalBatch},
    crew::{LocalCrew, LocalWorker, is_simulated, met_by_edges, met_by_state},
    order,
    refusal::{LocalSearchError, NotApplicableError},
    space::{LocalStateSpace, LocalWorkspace},
    waiting::{PackedZone, WaitingZones},
    zone::LocalZoneBound,
};
use crate::{
    network::{
        actions::PathTransition,
        model::CompiledNetwork,
        query::{ReachabilityGoal, SearchBudget},
    },
    search::{
        goals::CompiledGoals,
        options::SearchOrder,
        report::{GoalOutcome, SearchCutoff, SearchProgress, SearchReport, SearchStatistics, WidestVariable},
        slice,
        store::{NIL, PassedList, StateLayout, hash_words, hash_zone},
        waiting::{WaitingList, level, levels},
    },
    witness::{build, error::SearchError, run::WitnessRun, schedule::ScheduleOptions},
};

/// How to search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LocalSearchOptions {
    pub order: SearchOrder,
    /// Of an order that draws.
    pub seed: u64,
    pub budget: SearchBudget,
    /// Shared variables and clocks become processes of their own, so that transitions that use the same do not commute.
    /// Otherwise networks that share any are refused.
    pub media: bool,
    /// Breadth first, so many compute successors. What is found does not depend on it.
    pub threads: usize,
}

impl Default for LocalSearchOptions {
    fn default() -> Self {
        Self {
            order: SearchOrder::default(),
            seed: 0,
            budget: SearchBudget::default(),
            media: true,
            threads: 1,
        }
    }
}

/// A path to a goal: a node, then perhaps one successor more.
#[derive(Clone, Copy)]
pub(super) struct LocalGoalPath {
    pub node: u32,
    pub last: Option<u32>,
}

/// A search with local time, under way.
pub(crate) struct LocalSearch<'m, 'p> {
    pub(super) space: Arc<LocalStateSpace<'m, 'p>>,
    goals: &'m [ReachabilityGoal],
    pub(super) compiled: CompiledGoals,
    hits: Vec<Option<LocalGoalPath>>,
    pub(super) open: Vec<bool>,
    pub(super) left: usize,
    /// Its zones are the stored ones as far as all processes have one time, of the clocks that matter.
    pub(super) store: PassedList<LocalZoneBound>,
    pub(super) zones: WaitingZones,
    pub(super) waiting: WaitingList,
    pub(super) levels: Vec<Vec<u32>>,
    packed: Vec<u64>,
    narrow: Vec<i16>,
    pub(super) met: Vec<usize>,
    driven_out: Vec<u32>,
    peak: usize,
    pub(super) visited: usize,
    pub(super) transitions: usize,
    budget: SearchBudget,
    order: SearchOrder,
    threads: usize,
    memory: LocalWorkMemory,
    started: bool,
    /// After so many states the caller is asked whether to go on.
    ask: usize,
}

/// Memory that the search uses again and again.
#[derive(Default)]
pub(super) struct LocalWorkMemory {
    pub worker: LocalWorker,
    pub crew: Option<LocalCrew>,
    pub batches: Vec<LocalBatch>,
    pub round: Vec<u32>,
    /// Of each state of the round: in which batch it is, and its place there.
    pub order: Vec<(usize, usize)>,
}

/// Why [`LocalSearch::go`] has come back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LocalPause {
    /// All is decided, or explored.
    Ended,
    Cut(SearchCutoff),
    /// So many transitions were computed.
    Paused,
}

/// Searches a network with local time. The report is that of [`crate::explore`] with fewer states. `go_on` is asked now
/// and then whether to.
///
/// # Errors
/// If local time does not serve the network; else as [`crate::explore`].
pub fn explore(
    model: &CompiledNetwork,
    goals: &[ReachabilityGoal],
    options: &LocalSearchOptions,
    go_on: &dyn Fn(&SearchProgress) -> bool,
) -> Result<SearchReport, LocalSearchError> {
    let mut search = LocalSearch::begin(model, goals, options)?;
    let exhausted = match search.go(usize::MAX, go_on)? {
        LocalPause::Cut(what) => Some(what),
        LocalPause::Ended | LocalPause::Paused => None,
    };
    Ok(search.report(exhausted)?)
}

impl<'m, 'p> LocalSearch<'m, 'p> {
    fn new(
        space: LocalStateSpace<'m, 'p>,
        goals: &'m [ReachabilityGoal],
        options: &LocalSearchOptions,
    ) -> Result<Self, LocalSearchError> {
        let model = space.model;
        let compiled = CompiledGoals::new(model, goals).map_err(SearchError::from)?;
        if !compiled.symbolic.is_empty() {
            return Err(NotApplicableError::ClockGoal.into());
        }
        let layout = StateLayout::new(model.ranges(), &slice::relevant(model, &compiled, None));
        Ok(Self {
            space: Arc::new(space),
            goals,
            compiled,
            hits: vec![None; goals.len()],
            open: vec![true; goals.len()],
            left: goals.len(),
            store: PassedList::new(layout, 0, false),
            zones: WaitingZones::new(if options.threads > 1 { options.threads } else { 0 }),
            waiting: WaitingList::new(options.order, options.seed),
            levels: levels(model),
            packed: Vec::new(),
            narrow: Vec::new(),
            met: Vec::new(),
            driven_out: Vec::new(),
            peak: 0,
            visited: 0,
            transitions: 0,
            budget: options.budget,
            order: options.order,
            threads: options.threads,
            memory: LocalWorkMemory::default(),
            started: false,
            ask: 0,
        })
    }

    /// # Errors
    /// If local time does not serve the network or the goals.
    pub(crate) fn begin(
        model: &'m CompiledNetwork<'p>,
        goals: &'m [ReachabilityGoal],
        options: &LocalSearchOptions,
    ) -> Result<Self, LocalSearchError> {
        Self::new(LocalStateSpace::new(model, options.media)?, goals, options)
    }

    /// Goes on until so many transitions were computed, in all. `go_on` is asked now and then whether to.
    ///
    /// # Errors
    /// As [`explore`]; then the search is of no more use.
    pub(crate) fn go(
        &mut self,
        until: usize,
        go_on: &dyn Fn(&SearchProgress) -> bool,
    ) -> Result<LocalPause, LocalSearchError> {
        let mut memory = std::mem::take(&mut self.memory);
        let pause = self.run(&mut memory, until, go_on);
        self.memory = memory;
        pause
    }

    fn run(
        &mut self,
        memory: &mut LocalWorkMemory,
        until: usize,
        go_on: &dyn Fn(&SearchProgress) -> bool,
    ) -> Result<LocalPause, LocalSearchError> {
        if !std::mem::replace(&mut self.started, true) {
            let LocalWorker { work, zone, .. } = &mut memory.worker;
            self.space.start(work)?;
            zone.clone_from(&work.zone);
            if self.threads > 1 {
                memory.crew = Some(LocalCrew::new(self.threads));
            }
            self.insert(work, NIL, 0)?;
        }
        loop {
            self.waiting.settle();
            if let Some(pause) = self.pause(until, false, go_on) {
                return Ok(pause);
            }
            // One transition more than asked for could decide which search goes on: so only what has no end to keep is done at once.
            if until == usize::MAX
                && self.order == SearchOrder::Breadth
                && self.waiting.len() > FEW
                && memory.crew.is_some()
            {
                if let Some(pause) = self.go_at_once(memory, go_on)? {
                    return Ok(pause);
                }
                continue;
            }
            let LocalWorkMemory { worker, round, .. } = memory;
            self.waiting.take(&self.store.covered, FEW, round);
            for &id in &*round {
                self.expand_stored(id, worker)?;
            }
        }
    }

    /// Whether the search ends here, or for now. `more`: states were taken that were not looked at.
    pub(super) fn pause(
        &mut self,
        until: usize,
        more: bool,
        go_on: &dyn Fn(&SearchProgress) -> bool,
    ) -> Option<LocalPause> {
        let empty = !more && self.waiting.is_empty(&self.store.covered, None);
        if (!self.goals.is_empty() && self.left == 0) || empty {
            return Some(LocalPause::Ended);
        }
        if self.transitions >= until {
            return Some(LocalPause::Paused);
        }
        let bytes = self.store.bytes() + self.zones.bytes();
        self.peak = self.peak.max(bytes);
        if self.store.nodes.len() >= self.budget.states || !self.store.has_room(self.space.room()) {
            return Some(LocalPause::Cut(SearchCutoff::States));
        }
        if bytes >= self.budget.bytes {
            return Some(LocalPause::Cut(SearchCutoff::Memory));
        }
        if self.visited >= self.ask {
            self.ask = self.visited + ROUND;
            if !go_on(&self.progress(bytes)) {
                return Some(LocalPause::Cut(SearchCutoff::Stopped));
            }
        }
        None
    }

    /// Which goals no run meets, after the end.
    pub(crate) fn unmet(&self) -> Vec<usize> {
        (0..self.goals.len()).filter(|&goal| self.open[goal]).collect()
    }

    pub(crate) fn statistics(&self) -> SearchStatistics {
        SearchStatistics {
            stored: self.store.stored,
            visited: self.visited,
            transitions: self.transitions,
            discrete_states: self.store.discrete_states(),
            bytes: self.peak,
        }
    }

    /// # Errors
    /// If the engine contradicts itself.
    pub(crate) fn report(mut self, exhausted: Option<SearchCutoff>) -> Result<SearchReport, SearchError> {
        let mut outcomes = Vec::new();
        for (goal, hit) in self.goals.iter().zip(&self.hits) {
            outcomes.push(match (hit, exhausted) {
                (Some(path), _) => GoalOutcome::Reached(Box::new(self.witness(path, Some(goal))?)),
                (None, Some(what)) => GoalOutcome::Inconclusive(what),
                (None, None) => GoalOutcome::Unreachable,
            });
        }
        Ok(SearchReport {
            goals: outcomes,
            states_stored: self.store.stored,
            states_visited: self.visited,
            discrete_states: self.store.discrete_states(),
            transitions: self.transitions,
            peak_bytes: self.peak,
            complete: exhausted.is_none() && self.waiting.is_empty(&self.store.covered, None),
            global_because: None,
            chosen: None,
            widest: exhausted.and_then(|_| WidestVariable::of(self.space.model, &self.store.extremes())),
        })
    }

    fn progress(&self, bytes: usize) -> SearchProgress<'_> {
        SearchProgress {
            stored: self.store.stored,
            visited: self.visited,
            waiting: self.waiting.len(),
            bytes,
            open: self.left,
            unmet: &self.open,
        }
    }

    /// Stores what a state leads to, unless it was driven out.
    pub(super) fn expand_stored(
        &mut self,
        id: u32,
        worker: &mut LocalWorker,
    ) -> Result<(), LocalSearchError> {
        if !self.zones.take(id, &mut worker.zone) {
            return Ok(());
        }
        let node = self.store.nodes[id as usize];
        self.store.layout.unpack(self.store.packed(node.discrete), &mut worker.state);
        self.visited += 1;
        // INVARIANT: the space is not changed by what is stored.
        let space = Arc::clone(&self.space);
        let end = worker.successors(&space, None, |w, before, firing, number| {
            self.transitions += 1;
            if self.left > 0 {
                self.met.clear();
                met_by_edges(&space, &self.compiled, before, firing, &mut |goal| self.met.push(goal));
                self.hit(LocalGoalPath { node: id, last: Some(number) });
            }
            self.insert(w, id, number)
        });
        end.map_err(|failure| self.led_to(id, failure))
    }

    /// The goals that were met are so by this path, unless they were met before.
    pub(super) fn hit(&mut self, path: LocalGoalPath) {
        for &goal in &self.met {
            if std::mem::replace(&mut self.open[goal], false) {
                self.hits[goal] = Some(path);
                self.left -= 1;
            }
        }
    }

    /// Stores the symbolic state in `w`, unless a stored one simulates it.
    fn insert(&mut self, w: &mut LocalWorkspace, parent: u32, number: u32) -> Result<(), LocalSearchError> {
        self.store.layout.pack(&w.effect.target, &mut self.packed);
        let hash = hash_words(&self.packed);
        let known = self.store.find(hash, &self.packed);
        self.driven_out.clear();
        let zone = (w.together.as_slice(), w.lu.as_slice());
        if known.is_some_and(|discrete| is_simulated(&self.store, discrete, 0, zone, &mut self.driven_out)) {
            return Ok(());
        }
        let (packed, driven_out) = (std::mem::take(&mut self.packed), std::mem::take(&mut self.driven_out));
        let mut narrow = std::mem::take(&mut self.narrow);
        let arrival = LocalArrival {
            packed: &packed,
            hash,
            discrete: known.unwrap_or(NIL),
            level: level(&self.levels, &w.effect.target, &[]),
            together: ArrivedZone::New { bounds: &w.together, hash: hash_zone(&w.together) },
            lu: &w.lu,
            zone: PackedZone::of(&w.zone, &mut narrow),
            compared: self.store.nodes.len() as u32,
            driven_out: &driven_out,
        };
        let stored = self.arrive(arrival, parent, number);
        (self.packed, self.driven_out, self.narrow) = (packed, driven_out, narrow);
        match stored {
            Some((node, true)) if self.left > 0 => self.look(&mut w.effect.target, &mut w.stack, node),
            Some(_) | None => Ok(()),
        }
    }

    /// Stores a symbolic state, unless a stored one simulates it: its node, and whether its discrete state is new.
    pub(super) fn arrive(&mut self, a: LocalArrival, parent: u32, number: u32) -> Option<(u32, bool)> {
        let since = (a.compared as usize) < self.store.nodes.len();
        let known = match a.discrete {
            NIL if since => self.store.find_recent(a.hash, a.packed),
            NIL => None,
            discrete => Some(discrete),
        };
        let mut lost = false;
        let discrete = match known {
            None => self.store.add_discrete(a.hash, a.packed),
            Some(discrete) => {
                self.driven_out.clear();
                let zone = match a.together {
                    ArrivedZone::Stored(at) => self.store.zone_at(at, (a.lu.len() + 1).pow(2)),
                    ArrivedZone::New { bounds, .. } => bounds,
                };
                if is_simulated(&self.store, discrete, a.compared, (zone, a.lu), &mut self.driven_out) {
                    return None;
                }
                self.driven_out.extend_from_slice(a.driven_out);
                lost = self.drive_out(discrete);
                discrete
            }
        };
        let zone = match a.together {
            ArrivedZone::Stored(at) => at,
            ArrivedZone::New { bounds, hash } => self.store.intern(bounds, hash),
        };
        let id = self.store.add(parent, number, discrete, zone, &[]);
        self.zones.push(a.zone);
        self.waiting.push(id, lost, a.level, 0);
        Some((id, known.is_none()))
    }

    /// Forgets the states that the new one simulates; those that wait need not be explored. Whether there are any.
    fn drive_out(&mut self, discrete: u32) -> bool {
        let mut any = false;
        for &n in &self.driven_out {
            // One that came in between may have driven it out before.
            if !self.store.covered.has(n) {
                self.waiting.covered(n);
                self.store.cover(n);
                self.zones.forget(n);
                any = true;
            }
        }
        if any {
            self.store.unlink(discrete);
        }
        any
    }

    /// Looks at the goals that a new discrete state meets.
    fn look(&mut self, state: &mut [i64], stack: &mut Vec<i64>, node: u32) -> Result<(), LocalSearchError> {
        self.met.clear();
        met_by_state(self.space.model, &self.compiled, &self.open, (state, stack), &mut self.met)
            .map_err(SearchError::from)?;
        self.hit(LocalGoalPath { node, last: None });
        Ok(())
    }

    /// A fault of the model with the path to it.
    pub(super) fn led_to(&self, id: u32, failure: LocalSearchError) -> LocalSearchError {
        if let LocalSearchError::Search(SearchError::Model { error, witness: None }) = failure {
            match self.path(&LocalGoalPath { node: id, last: None }) {
                Ok(taken) => {
                    build::fault_after(self.space.model, taken.into_iter().map(Rc::new), error).into()
                }
                Err(internal) => internal.into(),
            }
        } else {
            failure
        }
    }

    fn witness(
        &self,
        path: &LocalGoalPath,
        goal: Option<&ReachabilityGoal>,
    ) -> Result<WitnessRun, SearchError> {
        build::witness(self.space.model, self.path(path)?, goal, ScheduleOptions::default())
    }

    fn path(&self, path: &LocalGoalPath) -> Result<Vec<PathTransition>, SearchError> {
        let mut numbers: Vec<u32> = path.last.into_iter().collect();
        let mut at = self.store.nodes[path.node as usize];
        while at.parent != NIL {
            numbers.push(at.via);
            at = self.store.nodes[at.parent as usize];
        }
        numbers.reverse();
        order::by_time(&self.space, &numbers, path.last.is_some())
    }
}

/// After how many states the caller is asked whether to go on.
const ROUND: usize = 1024;
/// States that are taken at once: orders other than breadth first take a quarter of it.
pub(super) const FEW: usize = 4;
