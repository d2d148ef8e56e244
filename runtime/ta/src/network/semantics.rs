//! The discrete half of the transition relation: what may happen in a discrete state, and under which clock guards.
//!
//! What may happen is gone through by the [enumeration](super::enumeration); here is what it works with, and what a transition does.

use std::ops::ControlFlow;

use hrdsl_ir::{EventId, Value, expr::EvalError, ta::LocationKind};
use smallvec::SmallVec;

use crate::{
    network::{
        code::{CodeEvalContext, CodeEvalError, SyncMedium},
        enumeration::{EnumerationFlow, FiringEnumeration},
        error::ModelError,
        model::CompiledNetwork,
        parts::{EdgeSync, EdgeUpdate, stops_time},
        selects::BinderValues,
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
    pub(super) parts: Vec<CompiledMove>,
    pub(super) args: Vec<i64>,
    pub(super) guard: Vec<DifferenceConstraint>,
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
