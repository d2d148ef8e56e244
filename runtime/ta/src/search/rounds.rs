//! The search of the zone graph for many goals at once, with one list of passed and waiting states.
//!
//! It goes in rounds: some of the waiting states are expanded, each on its own and against what is stored when the round
//! begins; then what they lead to is stored, in their order. So nothing depends on the number of threads. A symbolic state
//! is stored unless one of the same discrete part covers its zone, and it drives out those that it covers: of these only
//! the path to them is kept, for witnesses. When nothing waits any more, a goal that was not met is proved unreachable.

use std::{ops::ControlFlow, rc::Rc};

use crate::{
    network::{actions::PathTransition, error::ModelError, model::CompiledNetwork, query::ReachabilityGoal},
    search::{
        batch::{ChunkPlace, ExpansionBatch, GoalHit, GoalPath, in_order},
        crew::ExpansionCrew,
        expand::ExpansionContext,
        goals::CompiledGoals,
        monotone::{self, OneWayCounter},
        options::{SearchOptions, SubsumptionRelation},
        probe::{ProbeFinding, StateProbe},
        report::{GoalOutcome, SearchCutoff, SearchProgress, SearchReport, SearchStatistics, WidestVariable},
        round_search::{GoOn, RoundSearch, SearchAside},
        slice,
        stepper::ZoneClocks,
        store::{NIL, PassedList, StateLayout},
        waiting::WaitingList,
    },
    witness::{build, error::SearchError, run::WitnessRun, schedule::ScheduleOptions},
    zone::dbm::DbmNumber,
};

/// A search with one time for all.
pub(super) struct ZoneGraphSearch<'m, 'p, N> {
    model: &'m CompiledNetwork<'p>,
    goals: &'m [ReachabilityGoal],
    options: SearchOptions,
    compiled: CompiledGoals,
    counters: Vec<OneWayCounter>,
    probe: Option<&'m dyn StateProbe>,
    go_on: Option<GoOn<'m>>,
    /// What arrives later is left out, if the time is a clock.
    latest: Option<i64>,
    started: bool,
    hits: Vec<Option<GoalPath>>,
    open: Vec<bool>,
    left: usize,
    store: PassedList<N>,
    waiting: WaitingList,
    crew: ExpansionCrew<'m, 'p, N>,
    /// What each worker has found in it.
    batches: Vec<ExpansionBatch<N>>,
    /// The states of the round.
    round: Vec<u32>,
    visited: usize,
    transitions: usize,
    peak: usize,
}

/// States of one round.
const ROUND: usize = 4096;

impl<'m, 'p, N: DbmNumber> ZoneGraphSearch<'m, 'p, N> {
    pub(super) fn new(
        model: &'m CompiledNetwork<'p>,
        goals: &'m [ReachabilityGoal],
        options: &SearchOptions,
        beside: SearchAside<'m>,
    ) -> Result<Self, SearchError> {
        let compiled = CompiledGoals::new(model, goals)?;
        let mut matters = if options.reduce {
            slice::relevant(model, &compiled, beside.probe)
        } else {
            vec![true; model.size()]
        };
        // A probe tells states apart by what they are, not by what they can do.
        let mergeable = beside.probe.is_none() && options.subsumption != SubsumptionRelation::Equality;
        let counters = if options.counters && mergeable {
            monotone::counters(model, &compiled, &matters)
        } else {
            Vec::new()
        };
        counters.iter().for_each(|c| matters[c.place] = false);
        let mut options = *options;
        // With differences of clocks a simulation by bounds of single clocks is none.
        if model.extrapolation.diagonals.is_some() && options.subsumption == SubsumptionRelation::Simulation {
            options.subsumption = SubsumptionRelation::Inclusion;
        }
        let clocks = ZoneClocks { abstraction: options.abstraction, time: beside.within };
        Ok(Self {
            model,
            goals,
            compiled,
            hits: vec![None; goals.len()],
            open: vec![true; goals.len()],
            left: goals.len(),
            store: PassedList::new(
                StateLayout::new(model.ranges(), &matters),
                counters.len(),
                options.keep_shorter,
            ),
            counters,
            probe: beside.probe,
            go_on: beside.go_on,
            latest: beside.within.map(|most| 2 * most - 1),
            started: false,
            waiting: match beside.within {
                Some(_) => WaitingList::by_time(),
                None => WaitingList::new(options.order, options.seed),
            },
            crew: ExpansionCrew::new(model, clocks, options.threads),
            batches: Vec::new(),
            round: Vec::new(),
            options,
            visited: 0,
            transitions: 0,
            peak: 0,
        })
    }

    pub(super) fn explore(
        mut self,
        go_on: &dyn Fn(&SearchProgress) -> bool,
    ) -> Result<SearchReport, SearchError> {
        let exhausted = self.run(go_on)?;
        self.told(exhausted)
    }

    fn told(&mut self, exhausted: Option<SearchCutoff>) -> Result<SearchReport, SearchError> {
        let mut outcomes = Vec::new();
        for i in 0..self.goals.len() {
            outcomes.push(match (self.hits[i], exhausted) {
                (Some(path), _) => GoalOutcome::Reached(Box::new(self.witness(path, i)?)),
                (None, Some(what)) if self.open[i] => GoalOutcome::Inconclusive(what),
                (None, _) => GoalOutcome::Unreachable,
            });
        }
        Ok(SearchReport {
            goals: outcomes,
            states_stored: self.store.stored,
            states_visited: self.visited,
            discrete_states: self.store.discrete_states(),
            transitions: self.transitions,
            peak_bytes: self.peak,
            complete: exhausted.is_none() && self.waiting.is_empty(&self.store.covered, self.latest),
            global_because: None,
            chosen: None,
            widest: exhausted.and_then(|_| WidestVariable::of(self.model, &self.extremes())),
        })
    }

    /// The least and greatest of each number of the states.
    fn extremes(&self) -> Vec<(i64, i64)> {
        let mut all = self.store.extremes();
        for (i, counter) in self.counters.iter().enumerate() {
            let seen = (0..self.store.nodes.len() as u32).map(|n| counter.value(self.store.ranks(n)[i]));
            all[counter.place] = seen.fold((i64::MAX, i64::MIN), |(lo, hi), n| (lo.min(n), hi.max(n)));
        }
        all
    }

    fn decided(&self) -> bool {
        !self.goals.is_empty() && self.left == 0
    }

    fn run(&mut self, go_on: &dyn Fn(&SearchProgress) -> bool) -> Result<Option<SearchCutoff>, SearchError> {
        loop {
            if let ControlFlow::Break(end) = self.next_round(go_on)? {
                return Ok(end);
            }
        }
    }

    /// The first time the initial state is stored, then some of those that wait are expanded.
    fn next_round(
        &mut self,
        go_on: &dyn Fn(&SearchProgress) -> bool,
    ) -> Result<ControlFlow<Option<SearchCutoff>>, SearchError> {
        if !std::mem::replace(&mut self.started, true) {
            self.begin()?;
        }
        self.measure();
        if self.decided() || self.waiting.is_empty(&self.store.covered, self.latest) {
            return Ok(ControlFlow::Break(None));
        }
        let bytes = self.store.bytes() + self.waiting.bytes();
        let budget = self.options.budget;
        if self.store.nodes.len() >= budget.states || !self.store.has_room(0) {
            return Ok(ControlFlow::Break(Some(SearchCutoff::States)));
        }
        if bytes >= budget.bytes {
            return Ok(ControlFlow::Break(Some(SearchCutoff::Memory)));
        }
        let progress = SearchProgress {
            stored: self.store.stored,
            visited: self.visited,
            waiting: self.waiting.len(),
            bytes,
            open: self.left,
            unmet: &self.open,
        };
        if !go_on(&progress) {
            return Ok(ControlFlow::Break(Some(SearchCutoff::Stopped)));
        }
        let mut round = std::mem::take(&mut self.round);
        self.waiting.take(&self.store.covered, ROUND, &mut round);
        let context = ExpansionContext {
            store: &self.store,
            goals: &self.compiled,
            open: &self.open,
            options: &self.options,
            counters: &self.counters,
            probe: self.probe,
            latest: self.latest,
        };
        let whole = self.crew.expand(&context, &round, &mut self.batches, &|| go_on(&progress));
        self.round = round;
        Ok(match self.merge()? {
            Some(what) => ControlFlow::Break(Some(what)),
            // States that were taken and not expanded are lost: nothing may be proved by what follows.
            None if !whole => ControlFlow::Break(Some(SearchCutoff::Stopped)),
            None => ControlFlow::Continue(()),
        })
    }

    fn measure(&mut self) {
        let batches: usize = self.batches.iter().map(ExpansionBatch::bytes).sum();
        self.peak = self.peak.max(self.store.bytes() + self.waiting.bytes() + batches);
    }

    /// The initial state.
    fn begin(&mut self) -> Result<(), SearchError> {
        let mut batch = ExpansionBatch::default();
        let context = ExpansionContext {
            store: &self.store,
            goals: &self.compiled,
            open: &self.open,
            options: &self.options,
            counters: &self.counters,
            probe: self.probe,
            latest: self.latest,
        };
        self.crew.first().begin(&context, &mut batch).map_err(SearchError::from)?;
        batch.end_chunk(0, None);
        self.batches = vec![batch];
        self.merge()?;
        Ok(())
    }

    /// Stores what a round led to, in order.
    fn merge(&mut self) -> Result<Option<SearchCutoff>, SearchError> {
        self.measure();
        let first = self.store.nodes.len() as u32;
        let mut batches = std::mem::take(&mut self.batches);
        let mut end = None;
        self.store.begin_round();
        for ChunkPlace { batch, chunk } in in_order(&batches) {
            let batch = &mut batches[batch];
            let (visited, transitions) = batch.work(chunk);
            self.visited += visited;
            self.transitions += transitions;
            for hit in batch.hits(chunk) {
                self.hit(hit);
            }
            if end.is_none() {
                end = self.absorb(batch, chunk, first);
            }
            if let Some((error, path)) = batch.take_fault(chunk)
                && !self.decided()
            {
                return Err(self.fault(error, path));
            }
            if self.decided() {
                break;
            }
        }
        self.batches = batches;
        self.store.end_round(self.crew.threads());
        self.waiting.settle();
        Ok(end)
    }

    fn hit(&mut self, hit: &GoalHit) {
        match self.latest {
            // Others may come to it earlier.
            Some(latest) if hit.arrival <= latest => {
                self.latest = Some(hit.arrival - 1);
                self.hits[hit.goal] = Some(hit.path);
            }
            None if self.open[hit.goal] => {
                self.open[hit.goal] = false;
                self.left -= 1;
                self.hits[hit.goal] = Some(hit.path);
            }
            Some(_) | None => {}
        }
    }

    fn absorb(&mut self, batch: &ExpansionBatch<N>, chunk: usize, first: u32) -> Option<SearchCutoff> {
        let simulates = self.options.subsumption == SubsumptionRelation::Simulation;
        let worker = self.crew.first();
        for number in batch.items(chunk) {
            let item = batch.item(number);
            if simulates && item.parent != NIL && self.store.covered.has(item.parent) {
                continue;
            }
            let arrival = self.latest.map_or(0, |_| {
                let least: i64 = batch.zone(item, &self.store)[item.dim as usize - 1].into();
                -least
            });
            if self.latest.is_some_and(|latest| arrival > latest) {
                continue;
            }
            let packed = batch.packed(number, self.store.layout.words);
            let known = if item.discrete == NIL {
                self.store.find_recent(item.hash, packed)
            } else {
                Some(item.discrete)
            };
            let ranks = batch.ranks(number, self.counters.len());
            let mut lost = false;
            let discrete = match known {
                None => self.store.add_discrete(item.hash, packed),
                Some(d) => {
                    // What was there before the round was looked at already.
                    let Some(covers) = worker.compare(
                        &self.store,
                        &self.options,
                        d,
                        first,
                        (batch.zone(item, &self.store), item.dim as usize),
                        (item.parent, ranks),
                    ) else {
                        continue;
                    };
                    for n in covers.iter().chain(batch.covered(item)) {
                        if !self.store.covered.has(*n) {
                            self.waiting.covered(*n);
                            self.store.cover(*n);
                            lost = true;
                        }
                    }
                    d
                }
            };
            if lost {
                self.store.unlink(discrete);
            }
            if self.store.nodes.len() >= self.options.budget.states || !self.store.has_room(item.entries()) {
                return Some(SearchCutoff::States);
            }
            let zone = batch.intern(item, &mut self.store);
            let id = self.store.add(item.parent, item.via, discrete, zone, ranks);
            self.waiting.push(id, lost, item.level, arrival);
        }
        None
    }

    fn fault(&mut self, error: ModelError, path: GoalPath) -> SearchError {
        match self.path(path) {
            Ok(taken) => build::fault_after(self.model, taken.into_iter().map(Rc::new), error),
            Err(internal) => internal,
        }
    }

    /// The path's transitions, made concrete and replayed.
    fn witness(&mut self, path: GoalPath, goal: usize) -> Result<WitnessRun, SearchError> {
        let taken = self.path(path)?;
        build::witness(self.model, taken, Some(&self.goals[goal]), ScheduleOptions::default())
    }

    fn path(&mut self, path: GoalPath) -> Result<Vec<PathTransition>, SearchError> {
        let mut vias = Vec::new();
        let mut at = path.node;
        vias.extend(path.via.map(|via| (path.node, via)));
        while at != NIL && self.store.nodes[at as usize].parent != NIL {
            let node = self.store.nodes[at as usize];
            vias.push((node.parent, node.via));
            at = node.parent;
        }
        vias.reverse();
        let context = ExpansionContext {
            store: &self.store,
            goals: &self.compiled,
            open: &self.open,
            options: &self.options,
            counters: &self.counters,
            probe: self.probe,
            latest: self.latest,
        };
        let mut taken: Vec<PathTransition> = Vec::new();
        // A path through committed states that are not stored begins at the initial state itself.
        for (node, via) in vias {
            self.crew.first().retrace(&context, node, via, &mut taken)?;
        }
        Ok(taken)
    }
}

impl<N: DbmNumber> RoundSearch for ZoneGraphSearch<'_, '_, N> {
    fn round(
        &mut self,
        found: &mut Vec<ProbeFinding>,
    ) -> Result<ControlFlow<Option<SearchCutoff>>, SearchError> {
        let end = self.next_round(self.go_on.unwrap_or(&|_| true))?;
        for place in in_order(&self.batches) {
            found.extend_from_slice(self.batches[place.batch].findings(place.chunk));
        }
        Ok(end)
    }

    fn only_until(&mut self, arrival: i64) {
        self.latest = self.latest.map(|latest| latest.min(arrival));
    }

    fn path_to(&mut self, node: u32) -> Result<Vec<PathTransition>, SearchError> {
        self.path(GoalPath { node, via: None })
    }

    fn path_to_goal(&mut self, goal: usize) -> Result<Option<Vec<PathTransition>>, SearchError> {
        self.hits[goal].map(|path| self.path(path)).transpose()
    }

    fn exclude(&mut self, goals: &[usize]) {
        for &goal in goals {
            if std::mem::replace(&mut self.open[goal], false) {
                self.left -= 1;
            }
        }
    }

    fn report(&mut self, exhausted: Option<SearchCutoff>) -> Result<SearchReport, SearchError> {
        self.told(exhausted)
    }

    fn stored(&self) -> usize {
        self.store.stored
    }

    fn widest(&self) -> Option<WidestVariable> {
        WidestVariable::of(self.model, &self.extremes())
    }

    fn statistics(&self) -> SearchStatistics {
        SearchStatistics {
            stored: self.store.stored,
            visited: self.visited,
            transitions: self.transitions,
            discrete_states: self.store.discrete_states(),
            bytes: self.peak,
        }
    }
}
