//! One state's expansion: its symbolic successors, those through committed states included, against what is stored.
//!
//! An expansion is deterministic: its transitions are numbered, and a path through the search is named by such numbers.

use std::ops::ControlFlow;

use crate::{
    network::{actions::PathTransition, error::ModelError, model::CompiledNetwork},
    search::{
        batch::{ExpansionBatch, GoalHit, GoalPath, PendingState},
        covering::{covers, demands, subsumes},
        goals::{CompiledGoals, SymbolicStateRef},
        monotone::{OneWayCounter, may_drive_out, no_worse},
        options::{SearchOptions, SubsumptionRelation},
        probe::{ProbeFinding, ProbedState, StateProbe, widened},
        stepper::{SymbolicStepper, SymbolicSuccessor, ZoneClocks},
        store::{NIL, PassedList, hash_words},
        waiting,
    },
    witness::error::SearchError,
    zone::{
        constraint::DifferenceConstraint,
        dbm::{Dbm, DbmNumber},
        diagonals::split,
        extrapolation::{ActiveClocks, extra_lu, thresholds},
    },
};

/// Committed states that one expansion goes through without storing them. Of more, each would be expanded again and again.
const AT_ONCE: usize = 4;

/// What an expansion may look at.
pub(crate) struct ExpansionContext<'a, N> {
    pub store: &'a PassedList<N>,
    pub goals: &'a CompiledGoals,
    /// The goals that are not met yet.
    pub open: &'a [bool],
    pub options: &'a SearchOptions,
    /// Their ranks stand with the nodes.
    pub counters: &'a [OneWayCounter],
    pub probe: Option<&'a dyn StateProbe>,
    /// If the time since the start is a clock: what [arrives](arrival) later is left out.
    pub latest: Option<i64>,
}

/// The least value of the last clock of a zone, the time since the start, so that the earlier is the less: a bound `≤ n` is before `< n`.
pub(crate) fn arrival<N: DbmNumber>(zone: &Dbm<N>) -> i64 {
    let least: i64 = zone.entry(0, zone.dim() - 1).into();
    -least
}

/// A state of an expansion: the one that is expanded, or a committed one on the path.
struct ExpansionState<N> {
    state: Vec<i64>,
    frame: ActiveClocks,
    zone: Dbm<N>,
    /// The local state before it, and the number of its successor.
    from: (usize, u32),
    /// The number of the transition in the whole expansion.
    via: Option<u32>,
}

/// Expands states, with memory that it uses again and again.
pub(crate) struct ExpansionWorker<'m, 'p, N> {
    model: &'m CompiledNetwork<'p>,
    stepper: SymbolicStepper<'m, 'p, N>,
    locals: Vec<ExpansionState<N>>,
    count: usize,
    m: WorkerMemory<N>,
}

struct WorkerMemory<N> {
    stack: Vec<i64>,
    packed: Vec<u64>,
    ranks: Vec<u32>,
    bounds: Vec<N>,
    flat: Vec<N>,
    met: Vec<usize>,
    frame: ActiveClocks,
    state: Vec<i64>,
    zone: Dbm<N>,
    pieces: Vec<Dbm<N>>,
    covers: Vec<u32>,
    beyond: Vec<bool>,
    /// What a search by the topological order knows of locations.
    levels: Vec<Vec<u32>>,
    /// The lower bound of the time at which a goal over clocks is met.
    earliest: Option<N>,
    /// With comparisons of clocks: the greatest constants, also of the time if that is a clock.
    greatest: Vec<i64>,
    wide: Dbm,
    /// By discrete state: whether the probe can find anything there, if it was asked.
    worth: Vec<Option<bool>>,
}

/// An expansion that met a fault.
pub(crate) struct ExpansionError;

impl<'m, 'p, N: DbmNumber> ExpansionWorker<'m, 'p, N> {
    pub(crate) fn new(model: &'m CompiledNetwork<'p>, clocks: ZoneClocks) -> Self {
        let greatest = model.extrapolation.diagonals.as_ref().map_or(Vec::new(), |d| d.greatest.clone());
        let m = WorkerMemory {
            stack: Vec::new(),
            packed: Vec::new(),
            ranks: Vec::new(),
            bounds: Vec::new(),
            flat: Vec::new(),
            met: Vec::new(),
            frame: ActiveClocks::default(),
            state: Vec::new(),
            zone: Dbm::zero(1),
            pieces: Vec::new(),
            covers: Vec::new(),
            beyond: Vec::new(),
            levels: waiting::levels(model),
            earliest: None,
            greatest: greatest.into_iter().chain(clocks.time).collect(),
            wide: Dbm::zero(1),
            worth: Vec::new(),
        };
        Self { model, stepper: SymbolicStepper::new(model, clocks), locals: Vec::new(), count: 0, m }
    }

    /// The initial state, which is stored even if it is committed.
    pub(crate) fn begin(
        &mut self,
        c: &ExpansionContext<N>,
        batch: &mut ExpansionBatch<N>,
    ) -> Result<(), ModelError> {
        let (mut state, frame, mut zone) = self.stepper.initial()?;
        let visit = NodeExpansion { model: self.model, c, node: NIL, keep: true };
        visit.arrive(&mut self.m, (&mut state, None), &frame, &mut zone, (NIL, 0), batch)
    }

    fn local(&mut self) {
        if self.count == self.locals.len() {
            self.locals.push(ExpansionState {
                state: Vec::new(),
                frame: ActiveClocks::default(),
                zone: Dbm::zero(1),
                from: (0, 0),
                via: None,
            });
        }
        self.count += 1;
    }

    /// Makes the node the first local state.
    fn load(&mut self, c: &ExpansionContext<N>, id: u32) {
        let node = c.store.nodes[id as usize];
        self.count = 0;
        self.local();
        let local = &mut self.locals[0];
        c.store.layout.unpack(c.store.packed(node.discrete), &mut local.state);
        for (counter, &rank) in c.counters.iter().zip(c.store.ranks(id)) {
            local.state[counter.place] = counter.value(rank);
        }
        self.stepper.frame(&local.state, &mut local.frame);
        let dim = local.frame.dim();
        local.zone.load(dim, c.store.zone(&node, dim));
        local.via = None;
    }

    /// Expands a stored state.
    pub(crate) fn expand(
        &mut self,
        c: &ExpansionContext<N>,
        node: u32,
        batch: &mut ExpansionBatch<N>,
    ) -> Result<(), ExpansionError> {
        self.load(c, node);
        batch.visited += 1;
        if let Err(error) = self.probe(c, node, &mut batch.findings) {
            batch.fault = Some((error, GoalPath { node, via: None }));
            return Err(ExpansionError);
        }
        let visit = NodeExpansion { model: self.model, c, node, keep: c.options.keep_committed };
        // Committed states that are met are put behind this one, and expanded by the same loop. `via` counts through all of them, so that
        // a number means the same transition whenever the node is expanded again: `retrace` relies on it.
        let mut via = 0;
        let mut at = 0;
        while at < self.count {
            // Taken out, since `step` adds to the list that it stands in.
            let mut current = std::mem::replace(&mut self.locals[at], ExpansionState::empty());
            let result = self.step(&visit, at, &mut current, &mut via, batch, None);
            let reached = current.via;
            self.locals[at] = current;
            if let Err(error) = result {
                batch.fault = Some((error, GoalPath { node, via: reached }));
                return Err(ExpansionError);
            }
            at += 1;
        }
        Ok(())
    }

    /// Shows the loaded node to the probe.
    fn probe(
        &mut self,
        c: &ExpansionContext<N>,
        node: u32,
        out: &mut Vec<ProbeFinding>,
    ) -> Result<(), ModelError> {
        let Some(probe) = c.probe else { return Ok(()) };
        let ExpansionState { state, frame, zone, .. } = &self.locals[0];
        let discrete = c.store.nodes[node as usize].discrete as usize;
        if self.m.worth.len() <= discrete {
            self.m.worth.resize(c.store.discrete_states(), None);
        }
        let worth = match self.m.worth[discrete] {
            Some(known) => known,
            None => *self.m.worth[discrete].insert(probe.matters(state)?),
        };
        if !worth {
            return Ok(());
        }
        widened(zone, &mut self.m.wide);
        probe.look(&ProbedState { node, state, frame, zone: &self.m.wide }, out)
    }

    /// The successors of one local state. With `until` it stops at that number of the expansion.
    fn step(
        &mut self,
        visit: &NodeExpansion<N>,
        at: usize,
        current: &mut ExpansionState<N>,
        via: &mut u32,
        batch: &mut ExpansionBatch<N>,
        until: Option<u32>,
    ) -> Result<(), ModelError> {
        let (m, locals, count) = (&mut self.m, &mut self.locals, &mut self.count);
        let mut fault = None;
        // Goals over two edges ask which edge was the last one before this transition, and the stepper works on the state itself.
        let before = &if visit.c.open.is_empty() { Vec::new() } else { current.state.clone() };
        // Goals that wait until no location is committed were not asked in a committed state.
        let settled = !before.is_empty() && !visit.model.any_committed(before);
        let asked = settled.then_some(before.as_slice());
        let result = self.stepper.each(&mut current.state, &current.frame, &current.zone, |s| {
            let number = *via;
            *via += 1;
            batch.transitions += 1;
            visit.taken(before, &s, number, batch);
            // No time passes in a committed state: what follows it is found at once, and nothing is won by storing it. The cut at `AT_ONCE`
            // depends on the node alone, never on the store, so that `retrace` makes it, too.
            if visit.keep || *count > AT_ONCE || !visit.model.any_committed(s.state) {
                // Who retraces has stored the state already.
                if until.is_none()
                    && let Err(error) =
                        visit.arrive(m, (s.state, asked), s.frame, s.zone, (visit.node, number), batch)
                {
                    fault = Some(error);
                    return ControlFlow::Break(());
                }
            } else if let Err(error) = visit.pass(m, locals, count, s, (at, number), batch) {
                fault = Some(error);
                return ControlFlow::Break(());
            }
            if until == Some(number) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        result.and(fault.map_or(Ok(()), Err))
    }

    /// The transitions that a number of a node's expansion stands for.
    pub(crate) fn retrace(
        &mut self,
        c: &ExpansionContext<N>,
        node: u32,
        via: u32,
        out: &mut Vec<PathTransition>,
    ) -> Result<(), SearchError> {
        let lost = || SearchError::Internal("a path takes a transition that is not there".into());
        self.load(c, node);
        let visit = NodeExpansion { model: self.model, c, node, keep: c.options.keep_committed };
        let mut batch = ExpansionBatch::default();
        let (mut number, mut at) = (0, 0);
        // The last transition: of which local state, and its number there.
        let mut last = None;
        while at < self.count && last.is_none() {
            let mut current = std::mem::replace(&mut self.locals[at], ExpansionState::empty());
            let before = number;
            let result = self.step(&visit, at, &mut current, &mut number, &mut batch, Some(via));
            self.locals[at] = current;
            // Looked at before the fault: a transition that comes before one is a path all the same.
            if via >= before && via < number {
                last = Some((at, via - before));
                break;
            }
            result?;
            at += 1;
        }
        // Back along the committed states, each of which knows the one before it; the first local state is the node itself.
        let mut steps = vec![last.ok_or_else(lost)?];
        while let Some(&(at, _)) = steps.last()
            && at > 0
        {
            steps.push(self.locals[at].from);
        }
        for (at, number) in steps.into_iter().rev() {
            out.push(self.transition(at, number).ok_or_else(lost)?);
        }
        Ok(())
    }

    /// A local state's transition of this number.
    fn transition(&mut self, at: usize, number: u32) -> Option<PathTransition> {
        let mut current = std::mem::replace(&mut self.locals[at], ExpansionState::empty());
        let mut found = None;
        let side = self.side(&current.zone);
        let _ = self.stepper.each(&mut current.state, &current.frame, &current.zone, |s| {
            if s.number < number {
                return ControlFlow::Continue(());
            }
            found = Some(PathTransition {
                parts: s.firing.parts.to_vec(),
                medium: s.firing.medium,
                args: s.firing.args.to_vec(),
                guard: s.firing.guard.iter().chain(&side).copied().collect(),
                resets: s.resets.to_vec(),
            });
            ControlFlow::Break(())
        });
        self.locals[at] = current;
        found
    }

    /// On which side of the compared differences a zone lies: zones were split along them, and what a transition needs may
    /// follow from the side alone.
    fn side(&self, zone: &Dbm<N>) -> Vec<DifferenceConstraint> {
        let excluded = |c: &DifferenceConstraint| {
            !zone.is_empty() && !zone.meets(usize::from(c.i), usize::from(c.j), c.bound)
        };
        let compared = self.model.extrapolation.differences().into_iter();
        compared.flat_map(|c| [c, c.negated()]).filter(excluded).map(DifferenceConstraint::negated).collect()
    }

    /// Compares a zone with those of its discrete state that were stored from node `first` on. `None`: one covers it;
    /// otherwise those that it covers.
    pub(crate) fn compare(
        &mut self,
        store: &PassedList<N>,
        options: &SearchOptions,
        discrete: u32,
        first: u32,
        (zone, dim): (&[N], usize),
        (parent, ranks): (u32, &[u32]),
    ) -> Option<&[u32]> {
        let subsumption = options.subsumption;
        self.m.covers.clear();
        let head = store.head(discrete);
        // The newest node stands first: what was stored before the round was compared when the state was expanded.
        if head == NIL || head < first {
            return Some(&self.m.covers);
        }
        store.layout.unpack(store.packed(discrete), &mut self.m.state);
        let (state, frame) = (&self.m.state, &mut self.m.frame);
        self.stepper.frame(state, frame);
        self.m.zone.load(dim, zone);
        demands(subsumption, &self.m.frame, &self.m.zone, &mut self.m.bounds, zone);
        let mut at = head;
        while at != NIL && at >= first {
            let node = &store.nodes[at as usize];
            let old = store.zone(node, dim);
            if no_worse(store.ranks(at), ranks) && subsumes(subsumption, old, &self.m.bounds) {
                return None;
            }
            if may_drive_out(options.order, ranks, store.ranks(at))
                && !store.is_longer_way(parent, at)
                && covers(subsumption, &self.m.frame, zone, old)
            {
                self.m.covers.push(at);
            }
            at = node.next;
        }
        Some(&self.m.covers)
    }
}

impl<N: DbmNumber> ExpansionState<N> {
    fn empty() -> Self {
        Self {
            state: Vec::new(),
            frame: ActiveClocks::default(),
            zone: Dbm::zero(0),
            from: (0, 0),
            via: None,
        }
    }
}

/// The expansion of one node.
struct NodeExpansion<'a, 'm, 'p, N> {
    model: &'m CompiledNetwork<'p>,
    c: &'a ExpansionContext<'a, N>,
    node: u32,
    keep: bool,
}

impl<N: DbmNumber> NodeExpansion<'_, '_, '_, N> {
    /// Without times of arrival: 0.
    fn arrival(&self, zone: &Dbm<N>) -> i64 {
        if self.c.latest.is_some() { arrival(zone) } else { 0 }
    }

    /// Looks at the goals that a transition meets.
    fn taken(&self, before: &[i64], s: &SymbolicSuccessor<N>, via: u32, batch: &mut ExpansionBatch<N>) {
        if self.c.open.is_empty() {
            return;
        }
        for part in s.firing.parts {
            let m = usize::from(part.member);
            let number = self.model.members[m].edges[usize::from(part.edge)].number;
            let last = self.model.pairs.then(|| self.model.last_edge_at(m));
            self.c.goals.taken(number, before, last, &mut |goal| {
                if self.c.open[goal] {
                    let path = GoalPath { node: self.node, via: Some(via) };
                    batch.hits.push(GoalHit { goal, path, arrival: self.arrival(s.zone) });
                }
            });
        }
    }

    /// A committed state that is not stored: it is expanded at once, unless that was done.
    fn pass(
        &self,
        m: &mut WorkerMemory<N>,
        locals: &mut Vec<ExpansionState<N>>,
        count: &mut usize,
        s: SymbolicSuccessor<N>,
        (at, via): (usize, u32),
        batch: &mut ExpansionBatch<N>,
    ) -> Result<(), ModelError> {
        let path = GoalPath { node: self.node, via: Some(via) };
        m.met.clear();
        self.c.goals.states(s.state, None, &mut m.stack, self.model, false, self.c.open, &mut m.met)?;
        self.look_at_zone(m, s.state, s.frame, s.zone, false)?;
        batch.hits.extend(m.met.iter().map(|&goal| GoalHit { goal, path, arrival: 0 }));
        self.split(m, s.frame, s.zone);
        let pieces = std::mem::take(&mut m.pieces);
        for piece in &pieces {
            m.flat.clear();
            piece.store(&mut m.flat);
            demands(self.c.options.subsumption, s.frame, piece, &mut m.bounds, &m.flat);
            // Against the local states alone, so that the numbers of an expansion depend on nothing but its node.
            let known = locals[..*count].iter().any(|l| {
                if l.state != *s.state {
                    return false;
                }
                m.flat.clear();
                l.zone.store(&mut m.flat);
                subsumes(self.c.options.subsumption, &m.flat, &m.bounds)
            });
            if known {
                continue;
            }
            if *count == locals.len() {
                locals.push(ExpansionState::empty());
            }
            let local = &mut locals[*count];
            *count += 1;
            local.state.clone_from(s.state);
            local.frame.clone_from(s.frame);
            local.zone.copy_from(piece);
            local.from = (at, s.number);
            local.via = Some(via);
        }
        m.pieces = pieces;
        Ok(())
    }

    /// The extrapolated pieces of a zone, into `m.pieces`.
    fn split(&self, m: &mut WorkerMemory<N>, frame: &ActiveClocks, zone: &mut Dbm<N>) {
        match &self.model.extrapolation.diagonals {
            Some(d) => {
                m.pieces.clear();
                if self.c.latest.is_some() {
                    // As extrapolation by lower and upper bounds does: who comes earlier can do no less.
                    let time = zone.dim() - 1;
                    zone.row_mut(time).fill(N::INFINITY);
                    zone.set(time, time, N::LE_ZERO);
                }
                split(zone, &d.constraints, &m.greatest, &mut |piece| m.pieces.push(piece));
            }
            None => {
                extra_lu(frame, zone, &mut m.beyond);
                m.pieces.truncate(1);
                match m.pieces.first_mut() {
                    Some(piece) => piece.copy_from(zone),
                    None => m.pieces.push(zone.clone()),
                }
            }
        }
    }

    /// Adds the goals over clocks that a state meets to `m.met`.
    fn look_at_zone(
        &self,
        m: &mut WorkerMemory<N>,
        state: &mut [i64],
        frame: &ActiveClocks,
        zone: &Dbm<N>,
        settled: bool,
    ) -> Result<(), ModelError> {
        if self.c.goals.symbolic.is_empty() {
            return Ok(());
        }
        let mut look = SymbolicStateRef {
            model: self.model,
            state,
            stack: &mut m.stack,
            frame,
            zone,
            timed: self.c.latest.is_some(),
            earliest: None,
        };
        let met = self.c.goals.zones(&mut look, settled, self.c.open, &mut m.met);
        m.earliest = look.earliest;
        met
    }

    /// A state to store, unless a stored one covers it.
    fn arrive(
        &self,
        m: &mut WorkerMemory<N>,
        (state, asked): (&mut [i64], Option<&[i64]>),
        frame: &ActiveClocks,
        zone: &mut Dbm<N>,
        (parent, via): (u32, u32),
        batch: &mut ExpansionBatch<N>,
    ) -> Result<(), ModelError> {
        if self.c.latest.is_some_and(|latest| arrival(zone) > latest) {
            return Ok(());
        }
        let store = self.c.store;
        let subsumption = self.c.options.subsumption;
        store.layout.pack(state, &mut m.packed);
        m.ranks.clear();
        m.ranks.extend(self.c.counters.iter().map(|counter| counter.rank(state[counter.place])));
        let hash = hash_words(&m.packed);
        let known = store.find(hash, &m.packed);
        let simple = self.model.extrapolation.diagonals.is_none();
        if subsumption == SubsumptionRelation::Simulation
            && simple
            && let Some(discrete) = known
        {
            // What is covered before extrapolation is so after it: most of the work is saved.
            thresholds(frame, zone, &mut m.bounds);
            if self.is_covered(discrete, frame.dim(), &m.bounds, &m.ranks) {
                return Ok(());
            }
        }
        let path =
            GoalPath { node: if parent == NIL { NIL } else { parent }, via: (parent != NIL).then_some(via) };
        if self.c.open.iter().any(|o| *o) {
            let settled = !self.model.any_committed(state);
            m.met.clear();
            // Goals without clocks are the discrete state's: where that is stored, they were looked at when it came. Its counters are not
            // stored with it, nor when they hold.
            if known.is_none() || !self.c.counters.is_empty() || self.c.latest.is_some() {
                self.c.goals.states(
                    state,
                    asked,
                    &mut m.stack,
                    self.model,
                    settled,
                    self.c.open,
                    &mut m.met,
                )?;
            }
            self.look_at_zone(m, state, frame, zone, settled)?;
            let arrival = m.earliest.take().map_or_else(|| self.arrival(zone), |e| -e.into());
            batch.hits.extend(m.met.iter().map(|&goal| GoalHit { goal, path, arrival }));
        }
        self.split(m, frame, zone);
        let pieces = std::mem::take(&mut m.pieces);
        for piece in &pieces {
            self.offer(m, frame, state, piece, known, hash, (parent, via), batch);
        }
        m.pieces = pieces;
        Ok(())
    }

    fn is_covered(&self, discrete: u32, dim: usize, demands: &[N], ranks: &[u32]) -> bool {
        let mut at = self.c.store.head(discrete);
        while at != NIL {
            let node = &self.c.store.nodes[at as usize];
            if no_worse(self.c.store.ranks(at), ranks)
                && subsumes(self.c.options.subsumption, self.c.store.zone(node, dim), demands)
            {
                return true;
            }
            at = node.next;
        }
        false
    }

    /// An extrapolated state, for the batch unless a stored one covers it.
    #[allow(
        clippy::too_many_arguments,
        reason = "what a worker has at hand, taken apart for the borrow checker"
    )]
    fn offer(
        &self,
        m: &mut WorkerMemory<N>,
        frame: &ActiveClocks,
        state: &[i64],
        zone: &Dbm<N>,
        known: Option<u32>,
        hash: u64,
        (parent, via): (u32, u32),
        batch: &mut ExpansionBatch<N>,
    ) {
        let subsumption = self.c.options.subsumption;
        let dim = frame.dim();
        let (words, place, first) = (batch.words.len(), batch.zones.len(), batch.covered.len());
        zone.store(&mut batch.zones);
        if let Some(discrete) = known {
            let flat = &batch.zones[place..];
            // Simulation was looked at before.
            let looked = subsumption == SubsumptionRelation::Simulation
                && self.model.extrapolation.diagonals.is_none();
            if !looked {
                demands(subsumption, frame, zone, &mut m.bounds, flat);
            }
            // One walk for both questions: a zone that covers this one ends it, those that it covers are noted for the store to drop.
            let mut at = self.c.store.head(discrete);
            while at != NIL {
                let node = &self.c.store.nodes[at as usize];
                let old = self.c.store.zone(node, dim);
                let ranks = self.c.store.ranks(at);
                if !looked && no_worse(ranks, &m.ranks) && subsumes(subsumption, old, &m.bounds) {
                    batch.zones.truncate(place);
                    batch.covered.truncate(first);
                    return;
                }
                if may_drive_out(self.c.options.order, &m.ranks, ranks)
                    && !self.c.store.is_longer_way(parent, at)
                    && covers(subsumption, frame, flat, old)
                {
                    batch.covered.push(at);
                }
                at = node.next;
            }
        }
        batch.words.extend_from_slice(&m.packed);
        let ranks = batch.ranks.len();
        batch.ranks.extend_from_slice(&m.ranks);
        batch.items.push(PendingState {
            parent,
            via,
            discrete: known.unwrap_or(NIL),
            hash,
            level: waiting::level(&m.levels, state, &m.ranks),
            dim,
            words,
            zone: place,
            ranks,
            covered: (first, batch.covered.len()),
        });
    }
}
