//! The discrete half of the transition relation: what may happen in a discrete state, and under which clock guards.
//!
//! Transitions are enumerated in a fixed order: by automaton in the order of the network, its edges in source order, their
//! selects (the first slowest), then the partners and their edges and selects (the last partner fastest); multi-way channels
//! come last, in the order of the program. Who enumerates may give a test for clock constraints: what fails it is left out.
//!
//! A broadcast never waits for receivers: each other automaton with an enabled receiving edge takes part by one of them.
//! Where the receiver's edges have clock guards, it takes part where one of them holds and stays away where none does,
//! which is a union of zones: one transition for each part of it. The same holds for optional participants of multi-way channels.

use std::ops::ControlFlow;

use hrdsl_ir::{EventId, Value, expr::EvalError, ta::LocationKind};
use smallvec::SmallVec;

use crate::{
    network::{
        code::{CodeEvalContext, CodeEvalError, SyncMedium},
        error::ModelError,
        model::CompiledNetwork,
        parts::{CompiledEdge, EdgeOutput, EdgeSync, EdgeUpdate, stops_time},
        selects::{BinderValues, first, next},
    },
    zone::constraint::{DifferenceConstraint, constraints},
};

/// One automaton's part in a transition.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct AutomatonMove {
    /// Index in the network.
    pub automaton: usize,
    /// Index in the automaton.
    pub edge: usize,
    pub binders: BinderValues,
}

/// One automaton's part in a transition, in numbers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CompiledMove {
    pub member: u16,
    pub edge: u16,
    pub binders: SmallVec<[i64; 4]>,
}

/// Something that may happen in a discrete state.
pub(crate) struct TransitionFiring<'a> {
    /// In the order of their updates.
    pub parts: &'a [CompiledMove],
    pub medium: Option<SyncMedium>,
    pub args: &'a [i64],
    /// The clock constraints under which it may happen.
    pub guard: &'a [DifferenceConstraint],
}

/// What an enumeration comes upon.
pub(crate) enum FiringOrError<'a> {
    Firing(TransitionFiring<'a>),
    /// Something of the edge has no value, if these constraints hold.
    Fault {
        member: u16,
        edge: u16,
        fault: CodeEvalError,
        guard: &'a [DifferenceConstraint],
    },
}

/// What one automaton may do about something that others do.
enum SyncResponse {
    Take(CompiledMove, SmallVec<[DifferenceConstraint; 2]>),
    /// It stays away where these hold.
    Absent(SmallVec<[DifferenceConstraint; 4]>),
    /// Its guard has no value where these hold.
    Fault(CompiledMove, SmallVec<[DifferenceConstraint; 2]>, CodeEvalError),
}

/// A clock after a transition: the value of `from` before it (0: zero) plus `by`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ClockReset {
    pub clock: u16,
    pub from: u16,
    pub by: i64,
}

/// What an update may make negative: `from + by` at an edge's update of a clock.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NegativityCheck {
    pub reset: ClockReset,
    pub member: u16,
    pub edge: u16,
}

/// What a transition does besides its guard.
#[derive(Default)]
pub(crate) struct TransitionEffect {
    /// The discrete state after it.
    pub target: Vec<i64>,
    pub resets: Vec<ClockReset>,
    pub below: Vec<NegativityCheck>,
}

/// Memory that enumerations use again and again.
#[derive(Default)]
pub(crate) struct EnumerationScratch {
    pub stack: Vec<i64>,
    parts: Vec<CompiledMove>,
    args: Vec<i64>,
    guard: Vec<DifferenceConstraint>,
}

/// Whether a constraint may hold, as far as the one who enumerates cares.
pub(crate) trait ConstraintFilter {
    fn may(&self, c: DifferenceConstraint) -> bool;
}

/// No constraint is looked at.
pub(crate) struct NoConstraintFilter;

impl ConstraintFilter for NoConstraintFilter {
    fn may(&self, _: DifferenceConstraint) -> bool {
        true
    }
}

/// The state of an enumeration.
struct FiringEnumeration<'a, 'p, M, F: ?Sized> {
    model: &'a CompiledNetwork<'p>,
    state: &'a mut [i64],
    committed: bool,
    /// That nobody takes something is a transition, too: it comes from outside.
    outside: bool,
    may: &'a M,
    found: &'a mut F,
    s: &'a mut EnumerationScratch,
}

type EnumerationFlow = ControlFlow<()>;

impl<'p> CompiledNetwork<'p> {
    /// Calls `found` with all that may happen, until it breaks off. The state is not changed.
    pub(crate) fn enumerate<M: ConstraintFilter, F: FnMut(FiringOrError) -> EnumerationFlow + ?Sized>(
        &self,
        state: &mut [i64],
        may: &M,
        scratch: &mut EnumerationScratch,
        found: &mut F,
    ) -> EnumerationFlow {
        // A path is kept as numbers of transitions, so that this order is part of what the search remembers.
        let committed = self.any_committed(state);
        let mut e =
            FiringEnumeration { model: self, state, committed, outside: false, may, found, s: scratch };
        for m in 0..self.members.len() {
            for &edge in &self.place(e.state, m).active {
                e.active(m, usize::from(edge))?;
            }
        }
        for index in 0..self.multiway.len() {
            e.multiway(index)?;
        }
        ControlFlow::Continue(())
    }

    /// Calls `found` with all that the network may do about an event from outside: what no committed location holds back, for the world does
    /// not wait. Where nobody takes it, that is found as well.
    pub(crate) fn received<F: FnMut(FiringOrError) -> EnumerationFlow + ?Sized>(
        &self,
        state: &mut [i64],
        (event, args): (EventId, &[i64]),
        scratch: &mut EnumerationScratch,
        found: &mut F,
    ) -> EnumerationFlow {
        let medium = SyncMedium::Event(event);
        let (may, committed) = (&NoConstraintFilter, false);
        let mut e =
            FiringEnumeration { model: self, state, committed, outside: true, may, found, s: scratch };
        e.s.parts.clear();
        e.s.guard.clear();
        e.s.args.clear();
        e.s.args.extend_from_slice(args);
        let mut options = Vec::new();
        for m in 0..self.members.len() {
            let is = |edge: &u16| {
                matches!(&self.members[m].edges[usize::from(*edge)].sync,
                    EdgeSync::In(pattern) if pattern.medium == medium)
            };
            let edges = self.place(e.state, m).receiving.iter().copied().filter(is);
            let edges: SmallVec<[u16; 8]> = edges.collect();
            let responses = e.responses(m, &edges, true);
            if !responses.is_empty() {
                options.push(responses);
            }
        }
        e.combine(&options, Some(medium))
    }

    pub(crate) fn is_committed(&self, state: &[i64], member: usize) -> bool {
        self.place(state, member).kind == LocationKind::Committed
    }

    /// What the transition does; `Ok(false)`: a limit forbids it.
    pub(crate) fn effect(
        &self,
        state: &[i64],
        firing: &TransitionFiring,
        stack: &mut Vec<i64>,
        effect: &mut TransitionEffect,
    ) -> Result<bool, (u16, u16, CodeEvalError)> {
        effect.target.clear();
        effect.target.extend_from_slice(state);
        effect.resets.clear();
        effect.below.clear();
        // Counted before the updates: what a limit forbids has no fault either.
        if let Some(SyncMedium::Event(event)) = firing.medium
            && !self.count(&mut effect.target, event, firing.args)
        {
            return Ok(false);
        }
        for take in firing.parts {
            self.take(take, stack, effect).map_err(|f| (take.member, take.edge, f))?;
        }
        Ok(true)
    }

    fn take(
        &self,
        take: &CompiledMove,
        stack: &mut Vec<i64>,
        effect: &mut TransitionEffect,
    ) -> Result<(), CodeEvalError> {
        let (m, e) = (usize::from(take.member), usize::from(take.edge));
        let arrow = &self.members[m].edges[e];
        effect.target[m] = arrow.to() as i64;
        // One after the other on the target itself: an update sees what those before it did, of this edge and of earlier parts.
        let mut written = Vec::new();
        stack.clear();
        stack.extend_from_slice(&take.binders);
        let TransitionEffect { target, resets, below } = effect;
        for op in &arrow.updates {
            let mut env = CodeEvalContext::new(&self.library, target, stack);
            env.written = self.uses.then_some(&mut written);
            match op {
                EdgeUpdate::Assign(place, value) => env.assign(place, value, None)?,
                EdgeUpdate::Call(routine, args) => {
                    env.call(*routine, args)?;
                }
                EdgeUpdate::Reset { clock, from, to } => {
                    let by = to.eval(&mut env)?;
                    // A zone is changed once for the whole transition, so that a copy of a clock that was set before it in the same
                    // transition goes back to what that was set to.
                    let known = from.and_then(|y| resets.iter().find(|r| r.clock == y).copied());
                    let reset = match (from, known) {
                        (None, _) => ClockReset { clock: *clock, from: 0, by },
                        (Some(y), None) => ClockReset { clock: *clock, from: *y, by },
                        (Some(_), Some(r)) => ClockReset { clock: *clock, from: r.from, by: r.by + by },
                    };
                    if reset.by < 0 {
                        // Without another clock it is known here; with one, the zone has to be asked.
                        if reset.from == 0 {
                            return Err(CodeEvalError::Negative { clock: *clock });
                        }
                        below.push(NegativityCheck { reset, member: take.member, edge: take.edge });
                    }
                    resets.retain(|r| r.clock != *clock);
                    resets.push(reset);
                }
            }
        }
        if self.pairs {
            target[self.last_edge_at(m)] = i64::from(arrow.number);
        }
        for at in written {
            let slot = at as usize - self.members.len();
            target[self.last_definition_at(slot)] = i64::from(arrow.number);
        }
        Ok(())
    }

    /// Counts an event; `false`: a limit forbids it.
    fn count(&self, state: &mut [i64], event: EventId, args: &[i64]) -> bool {
        let watch = &self.watch[usize::from(event.0)];
        let matches = |patterns: &[Vec<Option<i64>>]| {
            patterns.iter().any(|p| p.iter().zip(args).all(|(want, n)| want.is_none_or(|w| w == *n)))
        };
        // Limits come first. A counter stops at its cap, beyond which no goal tells numbers apart: so states stay finitely many.
        for (i, patterns) in &watch.limits {
            if matches(patterns) {
                let n = &mut state[self.limit_at(*i)];
                if *n >= self.limits[*i].at_most {
                    return false;
                }
                *n += 1;
            }
        }
        for (i, patterns) in &watch.counters {
            if matches(patterns) {
                let n = &mut state[self.counter_at(*i)];
                *n = (*n + 1).min(self.counters[*i].cap);
            }
        }
        true
    }

    /// The clock part of the invariants of a state; `Ok(false)`: the part over variables does not hold.
    pub(crate) fn invariant(
        &self,
        state: &mut [i64],
        stack: &mut Vec<i64>,
        out: &mut Vec<DifferenceConstraint>,
    ) -> Result<bool, ModelError> {
        out.clear();
        for row in self.invariants.rows(state) {
            out.extend(row.iter().copied());
        }
        for m in self.with.data_invariants.iter().map(|&m| usize::from(m)) {
            let spot = self.place(state, m);
            if spot.invariant.moving.is_empty() && spot.holds.is_none() {
                continue;
            }
            let mut env = CodeEvalContext::new(&self.library, state, stack);
            let held = match &spot.holds {
                Some(holds) => holds.eval(&mut env).map(|n| n != 0),
                None => Ok(true),
            };
            let mut evaluated = Vec::new();
            let moving = held.and_then(|held| {
                // What does not hold protects the bounds from faults.
                for c in spot.invariant.moving.iter().filter(|_| held) {
                    let n = c.time.eval(&mut env)?;
                    constraints(c.i, c.j, c.op, n, &mut |c| evaluated.push(c));
                }
                Ok(held)
            });
            match moving {
                Ok(true) => out.append(&mut evaluated),
                Ok(false) => return Ok(false),
                Err(fault) => return Err(self.invariant_fault(m, state[m] as usize, fault)),
            }
        }
        Ok(true)
    }

    pub(crate) fn invariant_fault(&self, member: usize, location: usize, fault: CodeEvalError) -> ModelError {
        let a = self.members[member].automaton;
        let error = match fault {
            CodeEvalError::Eval(error) => error,
            CodeEvalError::Range { value, .. } => EvalError::Range(value),
            CodeEvalError::Argument { .. } | CodeEvalError::Negative { .. } => EvalError::Type,
        };
        let location = a.locations[location].name.clone();
        ModelError::Invariant { automaton: a.name.clone(), location, error }
    }

    /// Whether time may pass: no location is urgent or committed, and nothing is possible over an urgent channel.
    pub(crate) fn may_delay(&self, state: &mut [i64], scratch: &mut EnumerationScratch) -> bool {
        let stands = |&m: &u16| stops_time(self.place(state, usize::from(m)).kind);
        !self.with.stop_time.iter().any(stands) && !self.hurries(state, scratch)
    }

    /// Whether a transition over an urgent channel is possible, as far as variables tell.
    fn hurries(&self, state: &mut [i64], scratch: &mut EnumerationScratch) -> bool {
        let mut hurry = |_: FiringOrError| ControlFlow::Break(());
        let any_multiway = self.multiway.iter().any(|j| j.urgent);
        let urgent = &self.with.urgent_edges;
        let offers = urgent.iter().any(|&m| !self.place(state, usize::from(m)).urgent.is_empty());
        if !any_multiway && !offers {
            return false;
        }
        // A guard of a broadcast's receiver does not matter, nor does a fault: it is met when the transition is. Committed locations are left
        // out: where there is one, no time passes anyhow. The clocks of urgent edges have no guards, so that no zone need be asked.
        let mut e = FiringEnumeration {
            model: self,
            state,
            committed: false,
            outside: false,
            may: &NoConstraintFilter,
            found: &mut hurry,
            s: scratch,
        };
        for m in urgent.iter().map(|&m| usize::from(m)) {
            for &edge in &self.place(e.state, m).urgent {
                if e.active(m, usize::from(edge)).is_break() {
                    return true;
                }
            }
        }
        (0..self.multiway.len()).any(|j| self.multiway[j].urgent && e.multiway(j).is_break())
    }

    /// A part of a transition as values.
    pub(crate) fn moved(&self, take: &CompiledMove) -> AutomatonMove {
        let arrow = &self.members[usize::from(take.member)].edges[usize::from(take.edge)];
        let constants = &self.library.constants;
        let values = arrow.binders.iter().zip(&take.binders);
        let binders = values.map(|(ty, &n)| ty.value(n, constants).unwrap_or(Value::Int(n))).collect();
        AutomatonMove { automaton: usize::from(take.member), edge: usize::from(take.edge), binders }
    }
}

impl<M: ConstraintFilter, F: FnMut(FiringOrError) -> EnumerationFlow + ?Sized>
    FiringEnumeration<'_, '_, M, F>
{
    fn arrow(&self, member: usize, edge: usize) -> &'_ CompiledEdge<'_> {
        &self.model.members[member].edges[edge]
    }

    /// Whether the edge's clocks allow it; its constraints are added to the guard.
    fn clocks(&mut self, member: usize, edge: usize, binders: &[i64]) -> Result<bool, CodeEvalError> {
        let model = self.model;
        let arrow = &model.members[member].edges[edge];
        let before = self.s.guard.len();
        let mut bounds = Ok(());
        if arrow.guard.moving.is_empty() {
            if arrow.guard.fixed.is_empty() {
                return Ok(true);
            }
            self.s.guard.extend_from_slice(&arrow.guard.fixed);
        } else {
            self.s.stack.clear();
            self.s.stack.extend_from_slice(binders);
            let mut env = CodeEvalContext::new(&model.library, self.state, &mut self.s.stack);
            bounds = arrow.guard.eval(&mut env, &mut self.s.guard);
        }
        if !self.s.guard[before..].iter().all(|&c| self.may.may(c)) {
            return Ok(false);
        }
        bounds.map(|()| true)
    }

    /// Whether the edge is open and its clocks allow it; their constraints are added to the guard. A guard over variables
    /// that is false protects the bounds of clocks from faults.
    fn opens(&mut self, member: usize, edge: usize, binders: &[i64]) -> Result<bool, CodeEvalError> {
        // Clocks first, which are a look at the zone. Their fault waits until the guard over variables is known.
        let clocks = self.clocks(member, edge, binders);
        if clocks == Ok(false) || self.data(member, edge, binders)? { clocks } else { Ok(false) }
    }

    /// Whether committed locations let the parts move.
    fn is_allowed(&self) -> bool {
        let state = &*self.state;
        !self.committed || self.s.parts.iter().any(|t| self.model.is_committed(state, usize::from(t.member)))
    }

    /// Whether the edge's guard over variables holds.
    fn data(&mut self, member: usize, edge: usize, binders: &[i64]) -> Result<bool, CodeEvalError> {
        let model = self.model;
        let Some(data) = &model.members[member].edges[edge].data else { return Ok(true) };
        self.s.stack.clear();
        self.s.stack.extend_from_slice(binders);
        Ok(data.eval(&mut CodeEvalContext::new(&model.library, self.state, &mut self.s.stack))? != 0)
    }

    fn fault(&mut self, member: usize, edge: usize, fault: CodeEvalError) -> EnumerationFlow {
        let guard = std::mem::take(&mut self.s.guard);
        let flow = (self.found)(FiringOrError::Fault {
            member: member as u16,
            edge: edge as u16,
            fault,
            guard: &guard,
        });
        self.s.guard = guard;
        flow
    }

    fn fire(&mut self, medium: Option<SyncMedium>) -> EnumerationFlow {
        if !self.is_allowed() {
            return ControlFlow::Continue(());
        }
        let (parts, args, guard) = (
            std::mem::take(&mut self.s.parts),
            std::mem::take(&mut self.s.args),
            std::mem::take(&mut self.s.guard),
        );
        let flow = (self.found)(FiringOrError::Firing(TransitionFiring {
            parts: &parts,
            medium,
            args: &args,
            guard: &guard,
        }));
        (self.s.parts, self.s.args, self.s.guard) = (parts, args, guard);
        flow
    }

    /// Whether a committed location forbids all that the edge begins.
    fn forbidden(&self, member: usize, edge: usize) -> bool {
        if !self.committed || self.model.is_committed(self.state, member) {
            return false;
        }
        match &self.arrow(member, edge).sync {
            EdgeSync::Internal | EdgeSync::In(_) | EdgeSync::Join { .. } => true,
            EdgeSync::Out(signal) => !signal.partners.iter().any(|p| {
                let at = self.state[usize::from(p.member)] as usize;
                self.model.is_committed(self.state, usize::from(p.member)) && !p.edges[at].is_empty()
            }),
        }
    }

    fn active(&mut self, member: usize, edge: usize) -> EnumerationFlow {
        if self.forbidden(member, edge) {
            return ControlFlow::Continue(());
        }
        let model = self.model;
        let arrow = &model.members[member].edges[edge];
        let mut binders = SmallVec::new();
        let mut more = first(&arrow.selects, &mut binders);
        while more {
            self.begin(member, edge, &binders)?;
            more = next(&arrow.selects, &mut binders);
        }
        ControlFlow::Continue(())
    }

    fn begin(&mut self, member: usize, edge: usize, binders: &[i64]) -> EnumerationFlow {
        let model = self.model;
        self.s.guard.clear();
        match self.opens(member, edge, binders) {
            Ok(true) => {}
            Ok(false) => return ControlFlow::Continue(()),
            Err(fault) => return self.fault(member, edge, fault),
        }
        self.s.parts.clear();
        self.s.args.clear();
        self.s.parts.push(CompiledMove {
            member: member as u16,
            edge: edge as u16,
            binders: SmallVec::from_slice(binders),
        });
        match &model.members[member].edges[edge].sync {
            EdgeSync::Internal => self.fire(None),
            EdgeSync::Out(signal) => {
                if let Err(fault) = self.arguments(signal, binders) {
                    return self.fault(member, edge, fault);
                }
                if signal.broadcast { self.broadcast(signal) } else { self.binary(member, signal) }
            }
            // INVARIANT: `active` has no such edges.
            EdgeSync::In(_) | EdgeSync::Join { .. } => ControlFlow::Continue(()),
        }
    }

    fn arguments(&mut self, signal: &EdgeOutput, binders: &[i64]) -> Result<(), CodeEvalError> {
        let model = self.model;
        if let Some(fixed) = &signal.fixed {
            self.s.args.extend_from_slice(fixed);
            return Ok(());
        }
        for (i, arg) in signal.args.iter().enumerate() {
            self.s.stack.clear();
            self.s.stack.extend_from_slice(binders);
            let mut env = CodeEvalContext::new(&model.library, self.state, &mut self.s.stack);
            let n = arg.code.eval(&mut env)?;
            if n < arg.range.0 || n > arg.range.1 {
                let value = arg.code.value_of(&mut env, n);
                return Err(CodeEvalError::Argument { of: signal.medium, parameter: i as u16, value });
            }
            self.s.args.push(n);
        }
        Ok(())
    }

    fn binary(&mut self, member: usize, signal: &EdgeOutput) -> EnumerationFlow {
        let model = self.model;
        // One committed location among the two is enough; if the sender has it, any partner will do.
        let own = !self.committed || model.is_committed(self.state, member);
        for partner in &signal.partners {
            let p = usize::from(partner.member);
            let edges = &partner.edges[self.state[p] as usize];
            if edges.is_empty() || !(own || model.is_committed(self.state, p)) {
                continue;
            }
            for &edge in edges {
                self.meet(p, usize::from(edge), signal.medium)?;
            }
        }
        ControlFlow::Continue(())
    }

    fn meet(&mut self, member: usize, edge: usize, medium: SyncMedium) -> EnumerationFlow {
        let model = self.model;
        let arrow = &model.members[member].edges[edge];
        let EdgeSync::In(pattern) = &arrow.sync else { return ControlFlow::Continue(()) };
        if !pattern.matches(&self.s.args) {
            return ControlFlow::Continue(());
        }
        let guards = self.s.guard.len();
        let mut chosen = SmallVec::new();
        let mut more = first(&arrow.selects, &mut chosen);
        while more {
            let mut binders: SmallVec<[i64; 4]> = SmallVec::new();
            // Most edges have none of both: to copy nothing takes as long.
            if !chosen.is_empty() {
                binders.extend_from_slice(&chosen);
            }
            if !pattern.binds.is_empty() {
                binders.extend(pattern.binds.iter().map(|&i| self.s.args[usize::from(i)]));
            }
            match self.opens(member, edge, &binders) {
                Ok(true) => {
                    self.s.parts.push(CompiledMove { member: member as u16, edge: edge as u16, binders });
                    self.fire(Some(medium))?;
                    self.s.parts.pop();
                }
                Ok(false) => {}
                Err(fault) => self.fault(member, edge, fault)?,
            }
            self.s.guard.truncate(guards);
            more = next(&arrow.selects, &mut chosen);
        }
        ControlFlow::Continue(())
    }

    fn broadcast(&mut self, signal: &EdgeOutput) -> EnumerationFlow {
        let mut options: Vec<Vec<SyncResponse>> = Vec::new();
        for partner in &signal.partners {
            let p = usize::from(partner.member);
            let edges = &partner.edges[self.state[p] as usize];
            let responses = self.responses(p, edges, true);
            if !responses.is_empty() {
                options.push(responses);
            }
        }
        self.combine(&options, Some(signal.medium))
    }

    /// What an automaton may do by one of these edges; nothing: it has no open edge.
    fn responses(&mut self, member: usize, edges: &[u16], optional: bool) -> Vec<SyncResponse> {
        let model = self.model;
        let mut out = Vec::new();
        // Each entry is a conjunction under which no edge so far is open; at first the empty one, which always holds.
        let mut absent: Vec<SmallVec<[DifferenceConstraint; 4]>> = vec![SmallVec::new()];
        for &edge in edges {
            let arrow = &model.members[member].edges[usize::from(edge)];
            let binds: &[u16] = match &arrow.sync {
                EdgeSync::In(pattern) if pattern.matches(&self.s.args) => &pattern.binds,
                EdgeSync::In(_) => continue,
                EdgeSync::Internal | EdgeSync::Out(_) | EdgeSync::Join { .. } => &[],
            };
            let guards = self.s.guard.len();
            let mut chosen = SmallVec::new();
            let mut more = first(&arrow.selects, &mut chosen);
            while more {
                let mut binders = chosen.clone();
                binders.extend(binds.iter().map(|&i| self.s.args[usize::from(i)]));
                let open = self.opens(member, usize::from(edge), &binders);
                let own: SmallVec<[DifferenceConstraint; 2]> = SmallVec::from_slice(&self.s.guard[guards..]);
                self.s.guard.truncate(guards);
                let take = CompiledMove { member: member as u16, edge, binders };
                // An edge without clock guards leaves `absent` empty: then the automaton cannot stay away. A fault counts as open, since
                // it happens where the guard's clocks hold.
                if open != Ok(false) {
                    // To stay away, one of the constraints of each enabled edge must fail.
                    absent = absent.iter().flat_map(|cs| own.iter().map(|c| extended(cs, *c))).collect();
                    absent.dedup();
                    absent.retain(|cs| cs.iter().all(|&c| self.may.may(c)));
                }
                match open {
                    Ok(true) => out.push(SyncResponse::Take(take, own)),
                    Ok(false) => {}
                    Err(fault) => out.push(SyncResponse::Fault(take, own, fault)),
                }
                more = next(&arrow.selects, &mut chosen);
            }
        }
        // Without an open edge it is no option at all, and does not multiply the combinations.
        if optional && !out.is_empty() {
            out.extend(absent.into_iter().map(SyncResponse::Absent));
        }
        out
    }

    /// All combinations of what the partners may do, the last partner fastest.
    fn combine(&mut self, options: &[Vec<SyncResponse>], medium: Option<SyncMedium>) -> EnumerationFlow {
        let (parts, guards) = (self.s.parts.len(), self.s.guard.len());
        let mut at: SmallVec<[usize; 8]> = SmallVec::from_elem(0, options.len());
        loop {
            let mut fault = None;
            for (responses, &i) in options.iter().zip(&at) {
                match &responses[i] {
                    SyncResponse::Take(take, cs) => {
                        self.s.parts.push(take.clone());
                        self.s.guard.extend_from_slice(cs);
                    }
                    SyncResponse::Absent(cs) => self.s.guard.extend_from_slice(cs),
                    SyncResponse::Fault(take, cs, f) => {
                        self.s.parts.push(take.clone());
                        self.s.guard.extend_from_slice(cs);
                        fault = Some((take.member, take.edge, *f));
                    }
                }
            }
            match fault {
                Some((member, edge, f)) if self.is_allowed() => {
                    self.fault(usize::from(member), usize::from(edge), f)?;
                }
                Some(_) => {}
                // All of a multi-way channel's optional participants stay away: nothing happens.
                None if self.s.parts.is_empty() && !self.outside => {}
                None => self.fire(medium)?,
            }
            self.s.parts.truncate(parts);
            self.s.guard.truncate(guards);
            let Some(next) = (0..at.len()).rev().find(|&i| at[i] + 1 < options[i].len()) else {
                return ControlFlow::Continue(());
            };
            at[next] += 1;
            at[next + 1..].fill(0);
        }
    }

    fn multiway(&mut self, index: usize) -> EnumerationFlow {
        let model = self.model;
        let shared = &model.multiway[index];
        let mut options: Vec<Vec<SyncResponse>> = Vec::new();
        self.s.guard.clear();
        self.s.parts.clear();
        self.s.args.clear();
        for &(member, optional) in &shared.participants {
            let m = usize::from(member);
            let is = |e: &u16| {
                matches!(&model.members[m].edges[usize::from(*e)].sync,
                    EdgeSync::Join { channel, .. } if *channel == shared.channel)
            };
            let spot = model.place(self.state, m);
            let edges: SmallVec<[u16; 4]> = spot.joining.iter().copied().filter(is).collect();
            let responses = if edges.is_empty() { Vec::new() } else { self.responses(m, &edges, optional) };
            if !responses.is_empty() {
                options.push(responses);
            } else if !optional {
                return ControlFlow::Continue(());
            }
        }
        if options.is_empty() {
            return ControlFlow::Continue(());
        }
        self.combine(&options, Some(SyncMedium::Channel(shared.channel)))
    }
}

fn extended(
    cs: &SmallVec<[DifferenceConstraint; 4]>,
    c: DifferenceConstraint,
) -> SmallVec<[DifferenceConstraint; 4]> {
    let mut more = cs.clone();
    let negated = c.negated();
    if !more.contains(&negated) {
        more.push(negated);
    }
    more
}
