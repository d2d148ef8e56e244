//! The search of the zone graph for many goals at once, with one list of passed and waiting states.
//!
//! It goes in rounds: some of the waiting states are expanded, each on its own and against what is stored when the round
//! begins; then what they lead to is stored, in their order. So nothing depends on the number of threads. A symbolic state
//! is stored unless one of the same discrete part covers its zone, and it drives out those that it covers: of these only
//! the way to them is kept, for witnesses. When nothing waits any more, a goal that was not met is proved unreachable.

use std::sync::{Mutex, PoisonError};

use hrdsl_ir::{Program, ta::Network};
use rayon::prelude::*;

use crate::{
    Abstraction, Budget, Counter, Error, Goal, Limit, Model, ModelError, Observe, Witness,
    dbm::Number,
    expand::{Batch, Context, Taken, Worker},
    goals::Goals,
    local,
    network::Width,
    order::Waiting,
    slice,
    store::{Layout, NIL, Store},
    witness,
};

/// How a goal ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// The witness was replayed under concrete clocks.
    Reached(Box<Witness>),
    /// All that can be reached was seen.
    Unreachable,
    /// The budget was used up first.
    Open(Exhausted),
}

/// What ended a search before its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exhausted {
    States,
    Memory,
    /// The caller had enough: see [`explore`].
    Stopped,
}

/// What a search found.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// One for each goal, in the order of the question.
    pub goals: Vec<Outcome>,
    /// Symbolic states kept at the end.
    pub states_stored: usize,
    /// Symbolic states whose successors were computed.
    pub states_visited: usize,
    /// Discrete states.
    pub discrete_states: usize,
    /// Symbolic transitions computed.
    pub transitions: usize,
    /// The most bytes that states took at any time.
    pub peak_bytes: usize,
    /// Nothing was left to explore. Without goals a search goes on to this end or to that of its budget.
    pub complete: bool,
    /// Why local time, which was asked for, does not serve this network or these goals.
    pub global_because: Option<String>,
}

/// In which order waiting states are expanded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Order {
    /// The oldest first: if committed states are kept, witnesses are the shortest.
    Breadth,
    /// The newest first.
    Depth,
    /// The newest first, those of one state in an order drawn from the seed.
    RandomDepth,
    /// By a topological order of the locations, and states that cover others first (Herbreteau and Tran, "Improving
    /// Search Order for Reachability Testing in Timed Automata", 2015).
    #[default]
    Topological,
}

/// When a state covers another of the same discrete part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Subsumption {
    /// Its zone has all valuations of the other.
    Inclusion,
    /// The zones are the same.
    Equality,
    /// It can simulate the other, as far as lower and upper bounds of clocks tell: aLU (Herbreteau, Srivathsan and
    /// Walukiewicz, "Better Abstractions for Timed Automata", LICS 2012).
    #[default]
    Simulation,
}

/// How to search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    pub order: Order,
    pub subsumption: Subsumption,
    pub abstraction: Abstraction,
    /// Threads; results do not depend on it.
    pub threads: usize,
    /// States with a committed location are stored, too; otherwise transitions out of them are a part of those into them.
    pub keep_committed: bool,
    /// Variables that nothing depends on are left out of the state.
    pub reduce: bool,
    /// Each automaton has a time of its own, where that serves the network and the goals: see [`local`]. Then `subsumption`,
    /// `abstraction`, `threads`, `keep_committed` and `reduce` have no meaning.
    pub local_time: bool,
    pub budget: Budget,
    pub seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            order: Order::default(),
            subsumption: Subsumption::default(),
            abstraction: Abstraction::default(),
            threads: 1,
            keep_committed: true,
            reduce: true,
            local_time: false,
            budget: Budget::default(),
            seed: 0,
        }
    }
}

impl Options {
    /// The plain zone graph by ExtraLU+ and inclusion, breadth first, of all states.
    #[must_use]
    pub fn reference() -> Self {
        Self { order: Order::Breadth, subsumption: Subsumption::Inclusion, reduce: false, ..Self::default() }
    }

    /// Witnesses have as few transitions as any.
    #[must_use]
    pub fn shortest() -> Self {
        Self { order: Order::Breadth, ..Self::default() }
    }
}

/// How far a search is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    pub stored: usize,
    pub visited: usize,
    pub waiting: usize,
    pub bytes: usize,
    /// Goals that are not met yet.
    pub open: usize,
}

/// Compiles a network and searches it breadth first for shortest witnesses.
///
/// # Errors
/// If the model is malformed, or a fault of it is met, or the engine contradicts itself.
pub fn check(
    program: &Program,
    network: &Network,
    goals: &[Goal],
    counters: &[Counter],
    limits: &[Limit],
    budget: Budget,
) -> Result<Report, Error> {
    let observe = Observe { counters: counters.to_vec(), limits: limits.to_vec(), ..Observe::default() };
    let model = Model::new(program, network, &observe)?;
    explore(&model, goals, &Options { budget, ..Options::shortest() }, &|_| true)
}

/// Searches a compiled network. It ends when each goal is met, all is explored, the budget is used up, or `go_on` (asked
/// once a round) says so.
///
/// A fault of the model is met only if it comes before that end.
///
/// # Errors
/// If a fault of the model is met, or the engine contradicts itself.
pub fn explore(
    model: &Model,
    goals: &[Goal],
    options: &Options,
    go_on: &dyn Fn(&Progress) -> bool,
) -> Result<Report, Error> {
    if !options.local_time {
        return global(model, goals, options, go_on);
    }
    let Options { order, seed, budget, .. } = *options;
    let alone = local::Options { order, seed, budget, ..local::Options::default() };
    match local::explore(model, goals, &alone, go_on) {
        Ok(report) => Ok(report),
        Err(local::Failure::Search(error)) => Err(error),
        Err(local::Failure::NotApplicable(reason)) => {
            let report = global(model, goals, options, go_on)?;
            Ok(Report { global_because: Some(reason.to_string()), ..report })
        }
    }
}

/// With one time for all.
fn global(
    model: &Model,
    goals: &[Goal],
    options: &Options,
    go_on: &dyn Fn(&Progress) -> bool,
) -> Result<Report, Error> {
    match model.width {
        Width::Bits16 => Search::<i16>::new(model, goals, options)?.explore(go_on),
        Width::Bits32 => Search::<i32>::new(model, goals, options)?.explore(go_on),
        Width::Bits64 => Search::<i64>::new(model, goals, options)?.explore(go_on),
    }
}

/// A way to a goal: a node, then perhaps one transition more of its expansion. No node: the initial state.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Path {
    pub node: u32,
    pub via: Option<u32>,
}

struct Search<'m, 'p, N> {
    model: &'m Model<'p>,
    goals: &'m [Goal],
    options: Options,
    compiled: Goals,
    hits: Vec<Option<Path>>,
    open: Vec<bool>,
    left: usize,
    store: Store<N>,
    waiting: Waiting,
    workers: Vec<Worker<'m, 'p, N>>,
    batches: Vec<Batch<N>>,
    pool: Option<rayon::ThreadPool>,
    visited: usize,
    transitions: usize,
    peak: usize,
}

/// States of one round.
const ROUND: usize = 4096;
/// States that one thread expands in one go.
const CHUNK: usize = 16;

impl<'m, 'p, N: Number> Search<'m, 'p, N> {
    fn new(model: &'m Model<'p>, goals: &'m [Goal], options: &Options) -> Result<Self, Error> {
        let compiled = Goals::new(model, goals)?;
        let matters =
            if options.reduce { slice::relevant(model, &compiled) } else { vec![true; model.size()] };
        let mut options = *options;
        // With differences of clocks a simulation by bounds of single clocks is none.
        if model.extrapolation.diagonals.is_some() && options.subsumption == Subsumption::Simulation {
            options.subsumption = Subsumption::Inclusion;
        }
        let pool = if options.threads > 1 {
            let built = rayon::ThreadPoolBuilder::new().num_threads(options.threads).build();
            Some(built.map_err(|e| Error::Internal(format!("no threads: {e}")))?)
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
            store: Store::new(Layout::new(model.ranges(), &matters)),
            waiting: Waiting::new(model, options.order, options.seed),
            workers: (0..options.threads.max(1)).map(|_| Worker::new(model, options.abstraction)).collect(),
            batches: Vec::new(),
            pool,
            options,
            visited: 0,
            transitions: 0,
            peak: 0,
        })
    }

    fn explore(mut self, go_on: &dyn Fn(&Progress) -> bool) -> Result<Report, Error> {
        let exhausted = self.run(go_on)?;
        let mut outcomes = Vec::new();
        for i in 0..self.goals.len() {
            outcomes.push(match (self.hits[i], exhausted) {
                (Some(path), _) => Outcome::Reached(Box::new(self.witness(path, Some(i))?)),
                (None, Some(what)) => Outcome::Open(what),
                (None, None) => Outcome::Unreachable,
            });
        }
        Ok(Report {
            goals: outcomes,
            states_stored: self.store.stored,
            states_visited: self.visited,
            discrete_states: self.store.discrete_states(),
            transitions: self.transitions,
            peak_bytes: self.peak,
            complete: exhausted.is_none() && self.waiting.is_empty(&self.store.nodes),
            global_because: None,
        })
    }

    fn decided(&self) -> bool {
        !self.goals.is_empty() && self.left == 0
    }

    fn run(&mut self, go_on: &dyn Fn(&Progress) -> bool) -> Result<Option<Exhausted>, Error> {
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
                return Ok(Some(Exhausted::States));
            }
            if bytes >= budget.bytes {
                return Ok(Some(Exhausted::Memory));
            }
            let progress = Progress {
                stored: self.store.stored,
                visited: self.visited,
                waiting: self.waiting.len(),
                bytes,
                open: self.left,
            };
            if !go_on(&progress) {
                return Ok(Some(Exhausted::Stopped));
            }
            self.waiting.take(&self.store.nodes, ROUND, &mut round);
            self.expand(&round);
            if let Some(what) = self.merge()? {
                return Ok(Some(what));
            }
        }
    }

    fn measure(&mut self) {
        let batches: usize = self.batches.iter().map(Batch::bytes).sum();
        self.peak = self.peak.max(self.store.bytes() + self.waiting.bytes() + batches);
    }

    /// The initial state.
    fn begin(&mut self) -> Result<(), Error> {
        let mut batch = Batch::default();
        let context =
            Context { store: &self.store, goals: &self.compiled, open: &self.open, options: &self.options };
        self.workers[0].begin(&context, &mut batch).map_err(Error::from)?;
        self.batches = vec![batch];
        self.merge()?;
        Ok(())
    }

    /// Expands the states of a round, each chunk of them into a batch.
    fn expand(&mut self, round: &[u32]) {
        let chunks = round.len().div_ceil(CHUNK);
        self.batches.resize_with(self.batches.len().max(chunks), Batch::default);
        let context =
            Context { store: &self.store, goals: &self.compiled, open: &self.open, options: &self.options };
        let work = |worker: &mut Worker<'m, 'p, N>, nodes: &[u32], batch: &mut Batch<N>| {
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
                let workers: Vec<Mutex<&mut Worker<'m, 'p, N>>> =
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
    fn merge(&mut self) -> Result<Option<Exhausted>, Error> {
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

    fn absorb(&mut self, batch: &Batch<N>, first: u32) -> Option<Exhausted> {
        let simulates = self.options.subsumption == Subsumption::Simulation;
        let worker = &mut self.workers[0];
        for item in &batch.items {
            if simulates && item.parent != NIL && self.store.nodes[item.parent as usize].covered {
                continue;
            }
            let packed = batch.packed(item, self.store.layout.words);
            let zone = batch.zone(item);
            let known =
                if item.discrete == NIL { self.store.find(item.hash, packed) } else { Some(item.discrete) };
            let mut lost = false;
            let discrete = match known {
                None => self.store.add_discrete(item.hash, packed),
                Some(d) => {
                    // What was there before the round was looked at already.
                    let Some(covers) =
                        worker.compare(&self.store, self.options.subsumption, d, first, zone, item.dim)
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
                return Some(Exhausted::States);
            }
            let id = self.store.add(item.parent, item.via, discrete, zone);
            self.waiting.push(id, lost, item.level);
        }
        None
    }

    fn fault(&mut self, error: ModelError, path: Path) -> Error {
        match self.witness(path, None) {
            Ok(witness) => Error::Model { error, witness: Some(Box::new(witness)) },
            Err(internal) => internal,
        }
    }

    /// The path's transitions, made concrete and replayed.
    fn witness(&mut self, path: Path, goal: Option<usize>) -> Result<Witness, Error> {
        let mut vias = Vec::new();
        let mut at = path.node;
        vias.extend(path.via.map(|via| (path.node, via)));
        while at != NIL && self.store.nodes[at as usize].parent != NIL {
            let node = self.store.nodes[at as usize];
            vias.push((node.parent, node.via));
            at = node.parent;
        }
        vias.reverse();
        let context =
            Context { store: &self.store, goals: &self.compiled, open: &self.open, options: &self.options };
        let mut taken: Vec<Taken> = Vec::new();
        // A way through committed states that are not stored begins at the initial state itself.
        for (node, via) in vias {
            self.workers[0].retrace(&context, node, via, &mut taken)?;
        }
        witness::build(self.model, taken, goal.map(|g| &self.goals[g]), crate::Timing::default())
    }
}
