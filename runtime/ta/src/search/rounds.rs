//! The search of the zone graph for many goals at once, with one list of passed and waiting states.
//!
//! It goes in rounds: some of the waiting states are expanded, each on its own and against what is stored when the round
//! begins; then what they lead to is stored, in their order. So nothing depends on the number of threads. A symbolic state
//! is stored unless one of the same discrete part covers its zone, and it drives out those that it covers: of these only
//! the path to them is kept, for witnesses. When nothing waits any more, a goal that was not met is proved unreachable.

use std::{
    rc::Rc,
    sync::{Mutex, PoisonError},
};

use rayon::prelude::*;

use crate::{
    network::{
        actions::PathTransition,
        error::ModelError,
        model::{BoundWidth, CompiledNetwork},
        query::ReachabilityGoal,
    },
    search::{
        batch::{ExpansionBatch, GoalPath},
        expand::{ExpansionContext, ExpansionWorker},
        goals::CompiledGoals,
        monotone::{self, OneWayCounter},
        options::{SearchOptions, SubsumptionRelation},
        report::{GoalOutcome, SearchCutoff, SearchProgress, SearchReport, WidestVariable},
        slice,
        store::{NIL, PassedList, StateLayout},
        waiting::WaitingList,
    },
    witness::{build, error::SearchError, run::WitnessRun, schedule::ScheduleOptions},
    zone::dbm::DbmNumber,
};

/// With one time for all.
pub(crate) fn explore(
    model: &CompiledNetwork,
    goals: &[ReachabilityGoal],
    options: &SearchOptions,
    go_on: &dyn Fn(&SearchProgress) -> bool,
) -> Result<SearchReport, SearchError> {
    match model.width {
        BoundWidth::Bits16 => ZoneGraphSearch::<i16>::new(model, goals, options)?.explore(go_on),
        BoundWidth::Bits32 => ZoneGraphSearch::<i32>::new(model, goals, options)?.explore(go_on),
        BoundWidth::Bits64 => ZoneGraphSearch::<i64>::new(model, goals, options)?.explore(go_on),
    }
}

struct ZoneGraphSearch<'m, 'p, N> {
    model: &'m CompiledNetwork<'p>,
    goals: &'m [ReachabilityGoal],
    options: SearchOptions,
    compiled: CompiledGoals,
    counters: Vec<OneWayCounter>,
    hits: Vec<Option<GoalPath>>,
    open: Vec<bool>,
    left: usize,
    store: PassedList<N>,
    waiting: WaitingList,
    workers: Vec<ExpansionWorker<'m, 'p, N>>,
    batches: Vec<ExpansionBatch<N>>,
    pool: Option<rayon::ThreadPool>,
    visited: usize,
    transitions: usize,
    peak: usize,
}

/// States of one round.
const ROUND: usize = 4096;
/// States that one thread expands in one go.
const CHUNK: usize = 16;

impl<'m, 'p, N: DbmNumber> ZoneGraphSearch<'m, 'p, N> {
    fn new(
        model: &'m CompiledNetwork<'p>,
        goals: &'m [ReachabilityGoal],
        options: &SearchOptions,
    ) -> Result<Self, SearchError> {
        let compiled = CompiledGoals::new(model, goals)?;
        let mut matters =
            if options.reduce { slice::relevant(model, &compiled) } else { vec![true; model.size()] };
        let counters = if options.counters && options.subsumption != SubsumptionRelation::Equality {
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
        let pool = if options.threads > 1 {
            let built = rayon::ThreadPoolBuilder::new().num_threads(options.threads).build();
            Some(built.map_err(|e| SearchError::Internal(format!("no threads: {e}")))?)
        } else {
            None
        };
        Ok(Self {
            model,
            goals,
            compiled,
            hits: vec![None; goals.len()],
            open: vec![true; goals.len()],
            left: goals.len(),
            store: PassedList::new(StateLayout::new(model.ranges(), &matters), counters.len()),
            counters,
            waiting: WaitingList::new(model, options.order, options.seed),
            workers: (0..options.threads.max(1))
                .map(|_| ExpansionWorker::new(model, options.abstraction))
                .collect(),
            batches: Vec::new(),
            pool,
            options,
            visited: 0,
            transitions: 0,
            peak: 0,
        })
    }

    fn explore(mut self, go_on: &dyn Fn(&SearchProgress) -> bool) -> Result<SearchReport, SearchError> {
        let exhausted = self.run(go_on)?;
        let mut outcomes = Vec::new();
        for i in 0..self.goals.len() {
            outcomes.push(match (self.hits[i], exhausted) {
                (Some(path), _) => GoalOutcome::Reached(Box::new(self.witness(path, i)?)),
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
            complete: exhausted.is_none() && self.waiting.is_empty(&self.store.nodes),
            global_because: None,
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
        self.begin()?;
        let mut round = Vec::new();
        loop {
            self.measure();
            if self.decided() || self.waiting.is_empty(&self.store.nodes) {
                return Ok(None);
            }
            let bytes = self.store.bytes() + self.waiting.bytes();
            let budget = self.options.budget;
            if self.store.nodes.len() >= budget.states || !self.store.has_room(0) {
                return Ok(Some(SearchCutoff::States));
            }
            if bytes >= budget.bytes {
                return Ok(Some(SearchCutoff::Memory));
            }
            let progress = SearchProgress {
                stored: self.store.stored,
                visited: self.visited,
                waiting: self.waiting.len(),
                bytes,
                open: self.left,
            };
            if !go_on(&progress) {
                return Ok(Some(SearchCutoff::Stopped));
            }
            self.waiting.take(&self.store.nodes, ROUND, &mut round);
            self.expand(&round);
            if let Some(what) = self.merge()? {
                return Ok(Some(what));
            }
        }
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
        };
        self.workers[0].begin(&context, &mut batch).map_err(SearchError::from)?;
        self.batches = vec![batch];
        self.merge()?;
        Ok(())
    }

    /// Expands the states of a round, each chunk of them into a batch.
    fn expand(&mut self, round: &[u32]) {
        let chunks = round.len().div_ceil(CHUNK);
        self.batches.resize_with(self.batches.len().max(chunks), ExpansionBatch::default);
        let context = ExpansionContext {
            store: &self.store,
            goals: &self.compiled,
            open: &self.open,
            options: &self.options,
            counters: &self.counters,
        };
        let work = |worker: &mut ExpansionWorker<'m, 'p, N>, nodes: &[u32], batch: &mut ExpansionBatch<N>| {
            batch.clear();
            for &node in nodes {
                if worker.expand(&context, node, batch).is_err() {
                    break;
                }
            }
        };
        for batch in &mut self.batches[chunks..] {
            batch.clear();
        }
        match &self.pool {
            Some(pool) if chunks > 1 => {
                // Whoever is free takes the next chunk: which worker does it makes no difference.
                let workers: Vec<Mutex<&mut ExpansionWorker<'m, 'p, N>>> =
                    self.workers.iter_mut().map(Mutex::new).collect();
                let batches = self.batches[..chunks].par_iter_mut().with_max_len(1);
                pool.install(|| {
                    batches.zip(round.par_chunks(CHUNK)).for_each(|(batch, nodes)| {
                        let me = rayon::current_thread_index().unwrap_or(0) % workers.len();
                        let mut worker = workers[me].lock().unwrap_or_else(PoisonError::into_inner);
                        work(&mut worker, nodes, batch);
                    });
                });
            }
            Some(_) | None => {
                for (batch, nodes) in self.batches.iter_mut().zip(round.chunks(CHUNK)) {
                    work(&mut self.workers[0], nodes, batch);
                }
            }
        }
    }

    /// Stores what a round led to, in order.
    fn merge(&mut self) -> Result<Option<SearchCutoff>, SearchError> {
        self.measure();
        let first = self.store.nodes.len() as u32;
        let mut batches = std::mem::take(&mut self.batches);
        let mut end = None;
        for batch in &mut batches {
            self.visited += batch.visited;
            self.transitions += batch.transitions;
            for hit in &batch.hits {
                if self.open[hit.goal] {
                    self.open[hit.goal] = false;
                    self.left -= 1;
                    self.hits[hit.goal] = Some(hit.path);
                }
            }
            if end.is_none() {
                end = self.absorb(batch, first);
            }
            if let Some((error, path)) = batch.fault.take()
                && !self.decided()
            {
                return Err(self.fault(error, path));
            }
            if self.decided() {
                break;
            }
        }
        self.batches = batches;
        self.waiting.settle(&self.store.nodes);
        Ok(end)
    }

    fn absorb(&mut self, batch: &ExpansionBatch<N>, first: u32) -> Option<SearchCutoff> {
        let simulates = self.options.subsumption == SubsumptionRelation::Simulation;
        let worker = &mut self.workers[0];
        for item in &batch.items {
            if simulates && item.parent != NIL && self.store.nodes[item.parent as usize].covered {
                continue;
            }
            let packed = batch.packed(item, self.store.layout.words);
            let zone = batch.zone(item);
            let known =
                if item.discrete == NIL { self.store.find(item.hash, packed) } else { Some(item.discrete) };
            let ranks = batch.ranks(item, self.counters.len());
            let mut lost = false;
            let discrete = match known {
                None => self.store.add_discrete(item.hash, packed),
                Some(d) => {
                    // What was there before the round was looked at already.
                    let Some(covers) =
                        worker.compare(&self.store, &self.options, d, first, (zone, item.dim), ranks)
                    else {
                        continue;
                    };
                    for n in covers.iter().chain(batch.covered(item)) {
                        if !self.store.nodes[*n as usize].covered {
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
            if self.store.nodes.len() >= self.options.budget.states || !self.store.has_room(zone.len()) {
                return Some(SearchCutoff::States);
            }
            let id = self.store.add(item.parent, item.via, discrete, zone, ranks);
            self.waiting.push(id, lost, item.level);
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
        };
        let mut taken: Vec<PathTransition> = Vec::new();
        // A path through committed states that are not stored begins at the initial state itself.
        for (node, via) in vias {
            self.workers[0].retrace(&context, node, via, &mut taken)?;
        }
        Ok(taken)
    }
}
