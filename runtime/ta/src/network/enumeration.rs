//! Goes through what may happen in a discrete state: edges, their selects, and who else takes part.
//!
//! Transitions are enumerated in a fixed order: by automaton in the order of the network, its edges in source order, their
//! selects (the first slowest), then the partners and their edges and selects (the last partner fastest); multi-way channels
//! come last, in the order of the program. Who enumerates may give a test for clock constraints: what fails it is left out.
//!
//! A broadcast never waits for receivers: each other automaton with an enabled receiving edge takes part by one of them.
//! Where the receiver's edges have clock guards, it takes part where one of them holds and stays away where none does,
//! which is a union of zones: one transition for each part of it. The same holds for optional participants of multi-way channels.

use std::ops::ControlFlow;

use smallvec::SmallVec;

use super::{
    code::{CodeEvalContext, CodeEvalError, SyncMedium},
    model::CompiledNetwork,
    parts::{CompiledEdge, EdgeOutput, EdgeSync},
    selects::{first, next},
    semantics::{CompiledMove, ConstraintFilter, EnumerationScratch, FiringOrError, TransitionFiring},
};
use crate::zone::constraint::DifferenceConstraint;

pub(super) type EnumerationFlow = ControlFlow<()>;

/// What one automaton may do about something that others do.
pub(super) enum SyncResponse {
    Take(CompiledMove, SmallVec<[DifferenceConstraint; 2]>),
    /// It stays away where these hold.
    Absent(SmallVec<[DifferenceConstraint; 4]>),
    /// Its guard has no value where these hold.
    Fault(CompiledMove, SmallVec<[DifferenceConstraint; 2]>, CodeEvalError),
}

/// The state of an enumeration.
pub(super) struct FiringEnumeration<'a, 'p, M, F: ?Sized> {
    pub model: &'a CompiledNetwork<'p>,
    pub state: &'a mut [i64],
    pub committed: bool,
    /// That nobody takes something is a transition, too: it comes from outside.
    pub outside: bool,
    pub may: &'a M,
    pub found: &'a mut F,
    pub s: &'a mut EnumerationScratch,
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

    pub(super) fn active(&mut self, member: usize, edge: usize) -> EnumerationFlow {
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
    pub(super) fn responses(&mut self, member: usize, edges: &[u16], optional: bool) -> Vec<SyncResponse> {
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
    pub(super) fn combine(
        &mut self,
        options: &[Vec<SyncResponse>],
        medium: Option<SyncMedium>,
    ) -> EnumerationFlow {
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

    pub(super) fn multiway(&mut self, index: usize) -> EnumerationFlow {
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
