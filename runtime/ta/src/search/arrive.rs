//! What an expansion comes to: the goals that it meets, and the states to store.

use crate::{
    network::{error::ModelError, model::CompiledNetwork},
    search::{
        batch::{ExpansionBatch, GoalHit, GoalPath, PendingState, PendingZone},
        covering::{covers, demands, subsumes},
        expand::{ExpansionContext, ExpansionState, WorkerMemory, arrival},
        goals::SymbolicStateRef,
        monotone::{may_drive_out, no_worse},
        options::SubsumptionRelation,
        stepper::SymbolicSuccessor,
        store::{NIL, PackedState},
        waiting,
    },
    zone::{
        dbm::{Dbm, DbmNumber, dominates},
        diagonals::split,
        extrapolation::{ActiveClocks, extra_lu, thresholds},
    },
};

/// The expansion of one node.
pub(super) struct NodeExpansion<'a, 'm, 'p, N> {
    pub model: &'m CompiledNetwork<'p>,
    pub c: &'a ExpansionContext<'a, N>,
    pub node: u32,
    pub keep: bool,
}

impl<N: DbmNumber> NodeExpansion<'_, '_, '_, N> {
    /// Without times of arrival: 0.
    fn arrival(&self, zone: &Dbm<N>) -> i64 {
        if self.c.latest.is_some() { arrival(zone) } else { 0 }
    }

    /// Looks at the goals that a transition meets.
    pub(super) fn taken(
        &self,
        before: &[i64],
        s: &SymbolicSuccessor<N>,
        via: u32,
        batch: &mut ExpansionBatch<N>,
    ) {
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
    pub(super) fn pass(
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

    /// The extrapolated pieces of a zone, into `m.pieces`; what is left of the zone is of no use.
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
                extra_lu(frame, zone, &mut m.most);
                m.pieces.truncate(1);
                if m.pieces.is_empty() {
                    m.pieces.push(Dbm::zero(1));
                }
                std::mem::swap(&mut m.pieces[0], zone);
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

    /// A state to store, packed and looked up in `m`, unless a stored one covers it.
    pub(super) fn arrive(
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
        let subsumption = self.c.options.subsumption;
        m.ranks.clear();
        m.ranks.extend(self.c.counters.iter().map(|counter| counter.rank(state[counter.place])));
        let known = m.packed.known;
        let simple = self.model.extrapolation.diagonals.is_none();
        if subsumption == SubsumptionRelation::Simulation
            && simple
            && let Some(discrete) = known
            && self.is_passed(m, discrete, frame, zone)
        {
            return Ok(());
        }
        let path = GoalPath { node: parent, via: (parent != NIL).then_some(via) };
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
            self.offer(m, frame, state, piece, (parent, via), batch);
        }
        m.pieces = pieces;
        Ok(())
    }

    /// Whether nodes of the discrete state cover the zone. What is covered before extrapolation is so after it: most of the work is saved.
    /// Mostly the newest has it all.
    fn is_passed(&self, m: &mut WorkerMemory<N>, discrete: u32, frame: &ActiveClocks, zone: &Dbm<N>) -> bool {
        m.flat.clear();
        zone.store(&mut m.flat);
        if self.is_within_newest(discrete, zone.dim(), &m.flat, &m.ranks) {
            return true;
        }
        thresholds(frame, zone, &mut m.bounds);
        self.is_covered(discrete, frame.dim(), &m.bounds, &m.ranks)
    }

    /// Whether the newest node of the discrete state includes the zone.
    fn is_within_newest(&self, discrete: u32, dim: usize, flat: &[N], ranks: &[u32]) -> bool {
        let store = self.c.store;
        let newest = store.head(discrete);
        newest != NIL
            && no_worse(store.ranks(newest), ranks)
            && dominates(store.zone(&store.nodes[newest as usize], dim), flat)
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
        (parent, via): (u32, u32),
        batch: &mut ExpansionBatch<N>,
    ) {
        let subsumption = self.c.options.subsumption;
        let dim = frame.dim();
        let PackedState { hash, known, .. } = m.packed;
        let (place, first) = (batch.zones.len(), batch.covered.len());
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
        batch.words.extend_from_slice(&m.packed.words);
        batch.ranks.extend_from_slice(&m.ranks);
        let zone = PendingZone::of(self.c.store, &mut batch.zones, place);
        batch.push(PendingState {
            parent,
            via,
            discrete: known.unwrap_or(NIL),
            level: waiting::level(&m.levels, state, &m.ranks),
            hash,
            zone,
            dim: dim as u32,
            covered: (first as u32, batch.covered.len() as u32),
        });
    }
}
