//! One state's expansion: its symbolic successors, those through committed states included, against what is stored.
//!
//! An expansion is deterministic: its transitions are numbered, and a path through the search is named by such numbers.

use std::ops::ControlFlow;

use crate::{
    network::{actions::PathTransition, error::ModelError, model::CompiledNetwork},
    search::{
        arrive::NodeExpansion,
        batch::{ExpansionBatch, GoalPath},
        covering::{covers, demands, subsumes},
        goals::CompiledGoals,
        monotone::{OneWayCounter, may_drive_out, no_worse},
        options::{SearchOptions, SubsumptionRelation},
        probe::{ProbeFinding, ProbedState, StateProbe, widened},
        stepper::{SymbolicStepper, ZoneClocks},
        store::{NIL, PackedState, PassedList},
        waiting,
    },
    witness::error::SearchError,
    zone::{
        constraint::DifferenceConstraint,
        dbm::{Dbm, DbmNumber, dominates},
        extrapolation::ActiveClocks,
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
pub(super) struct ExpansionState<N> {
    pub(super) state: Vec<i64>,
    pub(super) frame: ActiveClocks,
    pub(super) zone: Dbm<N>,
    /// The local state before it, and the number of its successor.
    pub(super) from: (usize, u32),
    /// The number of the transition in the whole expansion.
    pub(super) via: Option<u32>,
}

/// Expands states, with memory that it uses again and again.
pub(crate) struct ExpansionWorker<'m, 'p, N> {
    model: &'m CompiledNetwork<'p>,
    stepper: SymbolicStepper<'m, 'p, N>,
    locals: Vec<ExpansionState<N>>,
    count: usize,
    m: WorkerMemory<N>,
}

pub(super) struct WorkerMemory<N> {
    pub(super) stack: Vec<i64>,
    pub(super) packed: PackedState,
    pub(super) ranks: Vec<u32>,
    pub(super) bounds: Vec<N>,
    pub(super) flat: Vec<N>,
    pub(super) met: Vec<usize>,
    pub(super) frame: ActiveClocks,
    pub(super) state: Vec<i64>,
    pub(super) zone: Dbm<N>,
    pub(super) pieces: Vec<Dbm<N>>,
    pub(super) covers: Vec<u32>,
    /// What the columns of a zone let stay.
    pub(super) most: Vec<N>,
    /// What a search by the topological order knows of locations.
    pub(super) levels: Vec<Vec<u32>>,
    /// The lower bound of the time at which a goal over clocks is met.
    pub(super) earliest: Option<N>,
    /// With comparisons of clocks: the greatest constants, also of the time if that is a clock.
    pub(super) greatest: Vec<i64>,
    pub(super) wide: Dbm,
    /// By discrete state: whether the probe can find anything there, if it was asked.
    pub(super) worth: Vec<Option<bool>>,
}

impl<'m, 'p, N: DbmNumber> ExpansionWorker<'m, 'p, N> {
    pub(crate) fn new(model: &'m CompiledNetwork<'p>, clocks: ZoneClocks) -> Self {
        let greatest = model.extrapolation.diagonals.as_ref().map_or(Vec::new(), |d| d.greatest.clone());
        let m = WorkerMemory {
            stack: Vec::new(),
            packed: PackedState::default(),
            ranks: Vec::new(),
            bounds: Vec::new(),
            flat: Vec::new(),
            met: Vec::new(),
            frame: ActiveClocks::default(),
            state: Vec::new(),
            zone: Dbm::zero(1),
            pieces: Vec::new(),
            covers: Vec::new(),
            most: Vec::new(),
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
        c.store.anticipate(&state, &mut self.m.packed);
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
    ///
    /// # Errors
    /// A fault of the model, and the path to it.
    pub(crate) fn expand(
        &mut self,
        c: &ExpansionContext<N>,
        node: u32,
        batch: &mut ExpansionBatch<N>,
    ) -> Result<(), (ModelError, GoalPath)> {
        self.load(c, node);
        batch.visited += 1;
        if let Err(error) = self.probe(c, node, &mut batch.findings) {
            return Err((error, GoalPath { node, via: None }));
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
                return Err((error, GoalPath { node, via: reached }));
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
        let result =
            self.stepper.each(&mut current.state, &current.frame, &current.zone, visit.c.store, |s| {
                let number = *via;
                *via += 1;
                batch.transitions += 1;
                visit.taken(before, &s, number, batch);
                // No time passes in a committed state: what follows it is found at once, and nothing is won by storing it. The cut at `AT_ONCE`
                // depends on the node alone, never on the store, so that `retrace` makes it, too.
                if visit.keep || *count > AT_ONCE || !visit.model.any_committed(s.state) {
                    std::mem::swap(&mut m.packed, s.packed);
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
            out.push(self.transition(c.store, at, number).ok_or_else(lost)?);
        }
        Ok(())
    }

    /// A local state's transition of this number.
    fn transition(&mut self, store: &PassedList<N>, at: usize, number: u32) -> Option<PathTransition> {
        let mut current = std::mem::replace(&mut self.locals[at], ExpansionState::empty());
        let mut found = None;
        let side = self.side(&current.zone);
        let _ = self.stepper.each(&mut current.state, &current.frame, &current.zone, store, |s| {
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
        // Mostly the newest includes it: then nothing else need be known.
        let inclusion = subsumption != SubsumptionRelation::Equality;
        let newest = store.zone(&store.nodes[head as usize], dim);
        if inclusion && no_worse(store.ranks(head), ranks) && dominates(newest, zone) {
            return None;
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
    pub(super) fn empty() -> Self {
        Self {
            state: Vec::new(),
            frame: ActiveClocks::default(),
            zone: Dbm::zero(0),
            from: (0, 0),
            via: None,
        }
    }
}
