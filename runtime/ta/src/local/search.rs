//! Breadth-first search of the local zone graph, with subsumption on the synchronised part of zones.

use std::{collections::VecDeque, ops::ControlFlow, rc::Rc};

use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use super::{
    Failure, Options, order,
    space::{Meets, Space, Work},
    zone::{self, Bound, LocalZone},
};
use crate::{
    Error, Exhausted, Goal, Model, ModelError, Outcome, Progress, Report, Witness,
    dbm::{Dbm, Number},
    goals::{Goals, Look},
    semantics::{Firing, Found, Scratch},
    slice,
    store::Layout,
    witness,
};

const ROOT: u32 = u32::MAX;

/// A symbolic state.
struct Node {
    discrete: u32,
    parent: u32,
    /// Which of the parent's successors it is.
    number: u32,
    /// Its zone as far as all processes have one time; `None`: another simulates it.
    together: Option<Box<[Bound]>>,
    /// Its zone, until its successors are computed.
    zone: Option<LocalZone>,
}

/// A way to a goal: a node, then perhaps one successor more.
#[derive(Clone, Copy)]
struct Path {
    node: u32,
    last: Option<u32>,
}

struct Discrete {
    packed: Rc<[u64]>,
    nodes: SmallVec<[u32; 4]>,
}

struct Search<'m, 'p> {
    space: Space<'m, 'p>,
    goals: &'m [Goal],
    compiled: Goals,
    hits: Vec<Option<Path>>,
    open: Vec<bool>,
    left: usize,
    layout: Layout,
    nodes: Vec<Node>,
    discrete: Vec<Discrete>,
    numbers: FxHashMap<Rc<[u64]>, u32>,
    waiting: VecDeque<u32>,
    packed: Vec<u64>,
    met: Vec<usize>,
    /// Zones to use again.
    pool: Vec<LocalZone>,
    bytes: usize,
    peak: usize,
    stored: usize,
    visited: usize,
    transitions: usize,
}

/// Searches a network that local time serves.
pub(super) fn explore(
    model: &Model,
    goals: &[Goal],
    options: &Options,
    go_on: &dyn Fn(&Progress) -> bool,
) -> Result<Report, Failure> {
    let mut search = Search::new(Space::new(model, options.media)?, goals)?;
    let exhausted = search.run(options, go_on)?;
    let mut outcomes = Vec::new();
    for (goal, hit) in goals.iter().zip(&search.hits) {
        outcomes.push(match (hit, exhausted) {
            (Some(path), _) => Outcome::Reached(Box::new(search.witness(path, Some(goal))?)),
            (None, Some(what)) => Outcome::Open(what),
            (None, None) => Outcome::Unreachable,
        });
    }
    Ok(Report {
        goals: outcomes,
        states_stored: search.stored,
        states_visited: search.visited,
        discrete_states: search.discrete.len(),
        transitions: search.transitions,
        peak_bytes: search.peak,
        complete: exhausted.is_none() && search.waiting.is_empty(),
    })
}

impl<'m, 'p> Search<'m, 'p> {
    fn new(space: Space<'m, 'p>, goals: &'m [Goal]) -> Result<Self, Failure> {
        let compiled = Goals::new(space.model, goals).map_err(Error::from)?;
        let layout = Layout::new(space.model, &slice::relevant(space.model, &compiled));
        Ok(Self {
            space,
            goals,
            compiled,
            hits: vec![None; goals.len()],
            open: vec![true; goals.len()],
            left: goals.len(),
            layout,
            nodes: Vec::new(),
            discrete: Vec::new(),
            numbers: FxHashMap::default(),
            waiting: VecDeque::new(),
            packed: Vec::new(),
            met: Vec::new(),
            pool: Vec::new(),
            bytes: 0,
            peak: 0,
            stored: 0,
            visited: 0,
            transitions: 0,
        })
    }

    fn run(
        &mut self,
        options: &Options,
        go_on: &dyn Fn(&Progress) -> bool,
    ) -> Result<Option<Exhausted>, Failure> {
        let (mut w, mut scratch) = (Work::default(), Scratch::default());
        self.space.start(&mut w)?;
        self.insert(&mut w, ROOT, 0)?;
        let mut state = Vec::new();
        while let Some(id) = self.waiting.pop_front() {
            let node = &mut self.nodes[id as usize];
            let Some(zone) = node.zone.take() else { continue };
            let used_up = if !self.goals.is_empty() && self.left == 0 {
                None
            } else if self.nodes.len() >= options.budget.states.min(ROOT as usize) {
                Some(Exhausted::States)
            } else if self.bytes >= options.budget.bytes {
                Some(Exhausted::Memory)
            } else if self.visited.is_multiple_of(ROUND) && !go_on(&self.progress()) {
                Some(Exhausted::Stopped)
            } else {
                self.layout
                    .unpack(&self.discrete[self.nodes[id as usize].discrete as usize].packed, &mut state);
                self.bytes -= zone.heap_bytes();
                self.visited += 1;
                self.expand(id, &mut state, &zone, &mut w, &mut scratch)?;
                self.pool.push(zone);
                continue;
            };
            // So that the report does not claim to be complete.
            self.waiting.push_front(id);
            return Ok(used_up);
        }
        Ok(None)
    }

    fn progress(&self) -> Progress {
        Progress {
            stored: self.stored,
            visited: self.visited,
            waiting: self.waiting.len(),
            bytes: self.bytes,
            open: self.left,
        }
    }

    fn expand(
        &mut self,
        id: u32,
        state: &mut [i64],
        zone: &LocalZone,
        w: &mut Work,
        scratch: &mut Scratch,
    ) -> Result<(), Failure> {
        let (before, model) = (state.to_vec(), self.space.model);
        let processes = Rc::clone(&self.space.processes);
        let may = Meets { zone, processes: &processes };
        let (mut number, mut end) = (0, Ok(()));
        let _ = model.enumerate(state, &may, scratch, &mut |found| {
            let next = self.space.found(w, &before, zone, &found);
            let done = match (next, &found) {
                (Ok(true), Found::Firing(firing)) => {
                    number += 1;
                    self.transitions += 1;
                    self.taken(&before, firing, (id, number - 1));
                    self.insert(w, id, number - 1)
                }
                (Ok(_), _) => Ok(()),
                (Err(failure), _) => Err(self.led_to(id, failure)),
            };
            end = done;
            if end.is_ok() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
        end
    }

    /// Looks at the goals that a transition meets.
    fn taken(&mut self, before: &[i64], firing: &Firing, (node, number): (u32, u32)) {
        if self.left == 0 {
            return;
        }
        let model = self.space.model;
        self.met.clear();
        for part in firing.parts {
            let m = usize::from(part.member);
            let edge = model.members[m].edges[usize::from(part.edge)].number;
            let last = model.pairs.then(|| model.last_edge_at(m));
            self.compiled.taken(edge, before, last, &mut |goal| self.met.push(goal));
        }
        self.hit(Path { node, last: Some(number) });
    }

    /// The goals that were met are so by this path, unless they were met before.
    fn hit(&mut self, path: Path) {
        for &goal in &self.met {
            if std::mem::replace(&mut self.open[goal], false) {
                self.hits[goal] = Some(path);
                self.left -= 1;
            }
        }
    }

    /// Stores the symbolic state in `w`, unless a stored one simulates it.
    fn insert(&mut self, w: &mut Work, parent: u32, number: u32) -> Result<(), Failure> {
        self.layout.pack(&w.effect.target, &mut self.packed);
        let (discrete, new) = match self.numbers.get(self.packed.as_slice()) {
            Some(&n) => (n, false),
            None => (self.number(), true),
        };
        if self.is_covered(discrete, w) {
            return Ok(());
        }
        self.drive_out(discrete, w);
        // INVARIANT: the budget keeps the number of nodes below the root's mark.
        let id = self.nodes.len() as u32;
        self.look(w, new, id)?;
        let together: Box<[Bound]> = w.together.as_slice().into();
        let zone = std::mem::replace(&mut w.zone, self.pool.pop().unwrap_or_default());
        self.bytes += zone.heap_bytes() + size_of_val(&*together) + size_of::<Node>() + size_of::<u32>();
        self.peak = self.peak.max(self.bytes);
        self.stored += 1;
        self.nodes.push(Node { discrete, parent, number, together: Some(together), zone: Some(zone) });
        self.discrete[discrete as usize].nodes.push(id);
        self.waiting.push_back(id);
        Ok(())
    }

    fn is_covered(&self, discrete: u32, w: &Work) -> bool {
        let simulates = |n: &u32| match &self.nodes[*n as usize].together {
            Some(old) => zone::is_simulated(&w.together, old, &w.lu),
            None => false,
        };
        self.discrete[discrete as usize].nodes.iter().rev().any(simulates)
    }

    /// Forgets the states that the new one simulates; those that wait need not be explored.
    fn drive_out(&mut self, discrete: u32, w: &Work) {
        let (nodes, pool) = (&mut self.nodes, &mut self.pool);
        let (bytes, stored) = (&mut self.bytes, &mut self.stored);
        self.discrete[discrete as usize].nodes.retain(|n| {
            let old = &mut nodes[*n as usize];
            let keep = old.together.as_ref().is_some_and(|old| !zone::is_simulated(old, &w.together, &w.lu));
            if !keep && let Some(gone) = old.together.take() {
                *stored -= 1;
                *bytes -= size_of_val(&*gone);
                if let Some(zone) = old.zone.take() {
                    *bytes -= zone.heap_bytes();
                    pool.push(zone);
                }
            }
            keep
        });
    }

    /// Gives the packed state its number.
    fn number(&mut self) -> u32 {
        let n = self.discrete.len() as u32;
        let packed: Rc<[u64]> = Rc::from(self.packed.as_slice());
        self.bytes += size_of_val(&*packed) + 2 * size_of::<Discrete>();
        self.numbers.insert(packed.clone(), n);
        self.discrete.push(Discrete { packed, nodes: SmallVec::new() });
        n
    }

    /// Looks at the goals that a state meets: all have one time in it.
    fn look(&mut self, w: &mut Work, new: bool, node: u32) -> Result<(), Failure> {
        if self.left == 0 {
            return Ok(());
        }
        self.met.clear();
        let model = self.space.model;
        let settled = !model.any_committed(&w.effect.target);
        let state = &mut w.effect.target;
        if new {
            let states = self.compiled.states(state, &mut w.stack, model, settled, &self.open, &mut self.met);
            states.map_err(Error::from)?;
        }
        if !self.compiled.symbolic.is_empty() {
            let zone = matrix(&w.together, w.frame.dim());
            let mut look = Look { model, state, stack: &mut w.stack, frame: &w.frame, zone: &zone };
            self.compiled.zones(&mut look, settled, &self.open, &mut self.met).map_err(Error::from)?;
        }
        self.hit(Path { node, last: None });
        Ok(())
    }

    /// A fault of the model with the way to it.
    fn led_to(&self, id: u32, failure: Failure) -> Failure {
        match failure {
            Failure::Search(Error::Model { error, witness: None }) => match self.faulty(id, error) {
                Ok(error) | Err(error) => error.into(),
            },
            other => other,
        }
    }

    fn faulty(&self, id: u32, error: ModelError) -> Result<Error, Error> {
        let witness = self.witness(&Path { node: id, last: None }, None)?;
        Ok(Error::Model { error, witness: Some(Box::new(witness)) })
    }

    fn witness(&self, path: &Path, goal: Option<&Goal>) -> Result<Witness, Error> {
        let mut numbers: Vec<u32> = path.last.into_iter().collect();
        let mut at = path.node;
        while self.nodes[at as usize].parent != ROOT {
            numbers.push(self.nodes[at as usize].number);
            at = self.nodes[at as usize].parent;
        }
        numbers.reverse();
        let taken = order::by_time(&self.space, &numbers, path.last.is_some())?;
        witness::build(self.space.model, &taken, goal)
    }
}

/// After how many states the caller is asked whether to go on.
const ROUND: usize = 1024;

/// The synchronised part of a zone as others look at it.
fn matrix(together: &[Bound], dim: usize) -> Dbm<i64> {
    let mut flat = Vec::with_capacity(dim * dim);
    for i in 0..dim {
        flat.extend((0..dim).map(|j| match together[j * dim + i] {
            zone::INF => <i64 as Number>::INFINITY,
            b => i64::from(b),
        }));
    }
    let mut out = Dbm::zero(dim);
    out.load(dim, &flat);
    out
}
