//! The discrete half of the transition relation: what may happen in a discrete state, and under which clock guards.
//!
//! Transitions are enumerated in a fixed order: by automaton in the order of the network, its edges in source order, their
//! selects (the first slowest), then the partners and their edges and selects (the last partner fastest); joint channels
//! come last, in the order of the program. Who enumerates may give a test for clock constraints: what fails it is left out.
//!
//! A broadcast never waits for receivers: each other automaton with an enabled receiving edge takes part by one of them.
//! Where the receiver's edges have clock guards, it takes part where one of them holds and stays away where none does,
//! which is a union of zones: one transition for each part of it. The same holds for optional parties of joint channels.

use std::ops::ControlFlow;

use hrdsl_ir::{
    ArgPattern, EventId, Type, Value,
    expr::EvalError,
    ta::{LocationKind, ReceiveArg, Var},
};
use smallvec::SmallVec;

use crate::{
    ModelError,
    code::{Env, Fault, Medium},
    compile,
    error::EdgeName,
    network::{Arrow, Constraint, Model, Op, Part, Signal},
};

/// The values of an edge's selects, then of the parameters it binds.
pub type Binders = SmallVec<[Value; 2]>;

/// One automaton's part in a transition.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Move {
    /// Index in the network.
    pub automaton: usize,
    /// Index in the automaton.
    pub edge: usize,
    pub binders: Binders,
}

/// One automaton's part in a transition, in numbers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Take {
    pub member: u16,
    pub edge: u16,
    pub binders: SmallVec<[i64; 4]>,
}

/// Something that may happen in a discrete state.
pub(crate) struct Firing<'a> {
    /// In the order of their updates.
    pub parts: &'a [Take],
    pub medium: Option<Medium>,
    pub args: &'a [i64],
    /// The clock constraints under which it may happen.
    pub guard: &'a [Constraint],
}

/// What an enumeration comes upon.
pub(crate) enum Found<'a> {
    Firing(Firing<'a>),
    /// Something of the edge has no value, if these constraints hold.
    Fault {
        member: u16,
        edge: u16,
        fault: Fault,
        guard: &'a [Constraint],
    },
}

/// What one automaton may do about something that others do.
enum Response {
    Take(Take, SmallVec<[Constraint; 2]>),
    /// It stays away where these hold.
    Absent(SmallVec<[Constraint; 4]>),
    /// Its guard has no value where these hold.
    Fault(Take, SmallVec<[Constraint; 2]>, Fault),
}

/// A clock after a transition: the value of `from` before it (0: zero) plus `by`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Reset {
    pub clock: u16,
    pub from: u16,
    pub by: i64,
}

/// What an update may make negative: `from + by` at an edge's update of a clock.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Below {
    pub reset: Reset,
    pub member: u16,
    pub edge: u16,
}

/// What a transition does besides its guard.
#[derive(Default)]
pub(crate) struct Effect {
    /// The discrete state after it.
    pub target: Vec<i64>,
    pub resets: Vec<Reset>,
    pub below: Vec<Below>,
}

/// Memory that enumerations use again and again.
#[derive(Default)]
pub(crate) struct Scratch {
    pub stack: Vec<i64>,
    parts: Vec<Take>,
    args: Vec<i64>,
    guard: Vec<Constraint>,
    written: Vec<u32>,
}

/// All combinations of the selects' values, the first select slowest.
pub(crate) fn choices(selects: &[Var]) -> Vec<Binders> {
    let mut all = vec![Binders::new()];
    for s in selects {
        let mut longer = Vec::new();
        for chosen in &all {
            for value in (s.lo..=s.hi).filter_map(|n| s.value(n)) {
                let mut next = chosen.clone();
                next.push(value);
                longer.push(next);
            }
        }
        all = longer;
    }
    all
}

/// Binds an event's arguments to a receiving edge's parameters, if they match.
pub(crate) fn bind(pattern: &[ReceiveArg], args: &[Value], binders: &mut Binders) -> bool {
    for (p, &v) in pattern.iter().zip(args) {
        match p {
            ReceiveArg::Match(ArgPattern::Any) => {}
            ReceiveArg::Match(ArgPattern::Is(want)) if want.key() == v.key() => {}
            ReceiveArg::Match(ArgPattern::Is(_)) => return false,
            ReceiveArg::Bind => binders.push(v),
        }
    }
    true
}

/// The least of all combinations of selects; `false`: there is none.
fn first(selects: &[(i64, i64)], out: &mut SmallVec<[i64; 4]>) -> bool {
    out.clear();
    out.extend(selects.iter().map(|s| s.0));
    selects.iter().all(|s| s.0 <= s.1)
}

/// The next combination, the last select fastest.
fn next(selects: &[(i64, i64)], chosen: &mut [i64]) -> bool {
    for (n, s) in chosen.iter_mut().zip(selects).rev() {
        if *n < s.1 {
            *n += 1;
            return true;
        }
        *n = s.0;
    }
    false
}

/// Whether a constraint may hold, as far as the one who enumerates cares.
pub(crate) trait May {
    fn may(&self, c: Constraint) -> bool;
}

/// No constraint is looked at.
pub(crate) struct Always;

impl May for Always {
    fn may(&self, _: Constraint) -> bool {
        true
    }
}

/// The state of an enumeration.
struct Enumeration<'a, 'p, M, F> {
    model: &'a Model<'p>,
    state: &'a mut [i64],
    committed: bool,
    may: &'a M,
    found: &'a mut F,
    s: &'a mut Scratch,
}

type Flow = ControlFlow<()>;

impl<'p> Model<'p> {
    /// Calls `found` with all that may happen, until it breaks off. The state is not changed.
    pub(crate) fn enumerate<M: May, F: FnMut(Found) -> Flow>(
        &self,
        state: &mut [i64],
        may: &M,
        scratch: &mut Scratch,
        found: &mut F,
    ) -> Flow {
        let committed = self.any_committed(state);
        let mut e = Enumeration { model: self, state, committed, may, found, s: scratch };
        for m in 0..self.members.len() {
            for &edge in &self.place(e.state, m).active {
                e.active(m, usize::from(edge))?;
            }
        }
        for joint in 0..self.joints.len() {
            e.joint(joint)?;
        }
        ControlFlow::Continue(())
    }

    fn is_committed(&self, state: &[i64], member: usize) -> bool {
        self.place(state, member).kind == LocationKind::Committed
    }

    /// What the transition does; `Ok(false)`: a limit forbids it.
    pub(crate) fn effect(
        &self,
        state: &[i64],
        firing: &Firing,
        stack: &mut Vec<i64>,
        effect: &mut Effect,
    ) -> Result<bool, (u16, u16, Fault)> {
        effect.target.clear();
        effect.target.extend_from_slice(state);
        effect.resets.clear();
        effect.below.clear();
        if let Some(Medium::Event(event)) = firing.medium
            && !self.count(&mut effect.target, event, firing.args)
        {
            return Ok(false);
        }
        for take in firing.parts {
            self.take(take, stack, effect).map_err(|f| (take.member, take.edge, f))?;
        }
        Ok(true)
    }

    fn take(&self, take: &Take, stack: &mut Vec<i64>, effect: &mut Effect) -> Result<(), Fault> {
        let (m, e) = (usize::from(take.member), usize::from(take.edge));
        let arrow = &self.members[m].edges[e];
        effect.target[m] = arrow.to() as i64;
        let mut written = Vec::new();
        stack.clear();
        stack.extend_from_slice(&take.binders);
        let Effect { target, resets, below } = effect;
        for op in &arrow.updates {
            let mut env = Env::new(&self.library, target, stack);
            env.written = self.uses.then_some(&mut written);
            match op {
                Op::Assign(place, value) => env.assign(place, value, None)?,
                Op::Call(routine, args) => {
                    env.call(*routine, args)?;
                }
                Op::Reset { clock, from, to } => {
                    let by = to.eval(&mut env)?;
                    let known = from.and_then(|y| resets.iter().find(|r| r.clock == y).copied());
                    let reset = match (from, known) {
                        (None, _) => Reset { clock: *clock, from: 0, by },
                        (Some(y), None) => Reset { clock: *clock, from: *y, by },
                        (Some(_), Some(r)) => Reset { clock: *clock, from: r.from, by: r.by + by },
                    };
                    if reset.by < 0 {
                        if reset.from == 0 {
                            return Err(Fault::Negative { clock: *clock });
                        }
                        below.push(Below { reset, member: take.member, edge: take.edge });
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
        out: &mut Vec<Constraint>,
    ) -> Result<bool, ModelError> {
        out.clear();
        for m in 0..self.members.len() {
            let spot = self.place(state, m);
            out.extend_from_slice(&spot.invariant.fixed);
            if spot.invariant.moving.is_empty() && spot.holds.is_none() {
                continue;
            }
            let mut env = Env::new(&self.library, state, stack);
            let held = match &spot.holds {
                Some(holds) => holds.eval(&mut env).map(|n| n != 0),
                None => Ok(true),
            };
            let mut evaluated = Vec::new();
            let moving = held.and_then(|held| {
                for c in &spot.invariant.moving {
                    let n = c.time.eval(&mut env)?;
                    crate::network::constraints(c.i, c.j, c.op, n, &mut |c| evaluated.push(c));
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

    fn invariant_fault(&self, member: usize, location: usize, fault: Fault) -> ModelError {
        let a = self.members[member].automaton;
        let error = match fault {
            Fault::Eval(error) => error,
            Fault::Range { value, .. } => EvalError::Range(value),
            Fault::Argument { .. } | Fault::Negative { .. } => EvalError::Type,
        };
        let location = a.locations[location].name.clone();
        ModelError::Invariant { automaton: a.name.clone(), location, error }
    }

    /// Whether time may pass: no location is urgent or committed, and nothing is possible over an urgent channel.
    pub(crate) fn may_delay(&self, state: &mut [i64], scratch: &mut Scratch) -> bool {
        (0..self.members.len()).all(|m| !compile::stops_time(self.place(state, m).kind))
            && !self.hurries(state, scratch)
    }

    /// Whether a transition over an urgent channel is possible, as far as variables tell.
    fn hurries(&self, state: &mut [i64], scratch: &mut Scratch) -> bool {
        let mut hurry = |_: Found| ControlFlow::Break(());
        let any_joint = self.joints.iter().any(|j| j.urgent);
        let offers = (0..self.members.len()).any(|m| !self.place(state, m).urgent.is_empty());
        if !any_joint && !offers {
            return false;
        }
        // A guard of a broadcast's receiver does not matter, nor does a fault: it is met when the transition is.
        let mut e =
            Enumeration { model: self, state, committed: false, may: &Always, found: &mut hurry, s: scratch };
        for m in 0..self.members.len() {
            for &edge in &self.place(e.state, m).urgent {
                if e.active(m, usize::from(edge)).is_break() {
                    return true;
                }
            }
        }
        (0..self.joints.len()).any(|j| self.joints[j].urgent && e.joint(j).is_break())
    }

    /// A part of a transition as values.
    pub(crate) fn moved(&self, take: &Take) -> Move {
        let arrow = &self.members[usize::from(take.member)].edges[usize::from(take.edge)];
        let constants = &self.library.constants;
        let values = arrow.binders.iter().zip(&take.binders);
        let binders = values.map(|(ty, &n)| ty.value(n, constants).unwrap_or(Value::Int(n))).collect();
        Move { automaton: usize::from(take.member), edge: usize::from(take.edge), binders }
    }
}

impl<M: May, F: FnMut(Found) -> Flow> Enumeration<'_, '_, M, F> {
    fn arrow(&self, member: usize, edge: usize) -> &'_ Arrow<'_> {
        &self.model.members[member].edges[edge]
    }

    /// Whether the edge's clocks allow it; its constraints are added to the guard.
    fn clocks(&mut self, member: usize, edge: usize, binders: &[i64]) -> Result<bool, Fault> {
        let model = self.model;
        let arrow = &model.members[member].edges[edge];
        let before = self.s.guard.len();
        if arrow.guard.moving.is_empty() {
            self.s.guard.extend_from_slice(&arrow.guard.fixed);
        } else {
            self.s.stack.clear();
            self.s.stack.extend_from_slice(binders);
            let mut env = Env::new(&model.library, self.state, &mut self.s.stack);
            arrow.guard.eval(&mut env, &mut self.s.guard)?;
        }
        Ok(self.s.guard[before..].iter().all(|&c| self.may.may(c)))
    }

    /// Whether the edge's guard over variables holds.
    fn data(&mut self, member: usize, edge: usize, binders: &[i64]) -> Result<bool, Fault> {
        let model = self.model;
        let Some(data) = &model.members[member].edges[edge].data else { return Ok(true) };
        self.s.stack.clear();
        self.s.stack.extend_from_slice(binders);
        Ok(data.eval(&mut Env::new(&model.library, self.state, &mut self.s.stack))? != 0)
    }

    fn fault(&mut self, member: usize, edge: usize, fault: Fault) -> Flow {
        let guard = std::mem::take(&mut self.s.guard);
        let flow =
            (self.found)(Found::Fault { member: member as u16, edge: edge as u16, fault, guard: &guard });
        self.s.guard = guard;
        flow
    }

    fn fire(&mut self, medium: Option<Medium>) -> Flow {
        let state = &*self.state;
        let takes = &self.s.parts;
        let model = self.model;
        if self.committed && !takes.iter().any(|t| model.is_committed(state, usize::from(t.member))) {
            return ControlFlow::Continue(());
        }
        let (parts, args, guard) = (
            std::mem::take(&mut self.s.parts),
            std::mem::take(&mut self.s.args),
            std::mem::take(&mut self.s.guard),
        );
        let flow = (self.found)(Found::Firing(Firing { parts: &parts, medium, args: &args, guard: &guard }));
        (self.s.parts, self.s.args, self.s.guard) = (parts, args, guard);
        flow
    }

    /// Whether a committed location forbids all that the edge begins.
    fn forbidden(&self, member: usize, edge: usize) -> bool {
        if !self.committed || self.model.is_committed(self.state, member) {
            return false;
        }
        match &self.arrow(member, edge).sync {
            Part::Internal | Part::In(_) | Part::Join { .. } => true,
            Part::Out(signal) => !signal.partners.iter().any(|p| {
                let at = self.state[usize::from(p.member)] as usize;
                self.model.is_committed(self.state, usize::from(p.member)) && !p.edges[at].is_empty()
            }),
        }
    }

    fn active(&mut self, member: usize, edge: usize) -> Flow {
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

    fn begin(&mut self, member: usize, edge: usize, binders: &SmallVec<[i64; 4]>) -> Flow {
        let model = self.model;
        self.s.guard.clear();
        match self.clocks(member, edge, binders) {
            Ok(true) => {}
            Ok(false) => return ControlFlow::Continue(()),
            Err(fault) => return self.fault(member, edge, fault),
        }
        match self.data(member, edge, binders) {
            Ok(true) => {}
            Ok(false) => return ControlFlow::Continue(()),
            Err(fault) => return self.fault(member, edge, fault),
        }
        self.s.parts.clear();
        self.s.args.clear();
        self.s.parts.push(Take { member: member as u16, edge: edge as u16, binders: binders.clone() });
        match &model.members[member].edges[edge].sync {
            Part::Internal => self.fire(None),
            Part::Out(signal) => {
                if let Err(fault) = self.arguments(signal, binders) {
                    return self.fault(member, edge, fault);
                }
                if signal.broadcast { self.broadcast(signal) } else { self.hand_shake(member, signal) }
            }
            // INVARIANT: `active` has no such edges.
            Part::In(_) | Part::Join { .. } => ControlFlow::Continue(()),
        }
    }

    fn arguments(&mut self, signal: &Signal, binders: &[i64]) -> Result<(), Fault> {
        let model = self.model;
        for (i, arg) in signal.args.iter().enumerate() {
            self.s.stack.clear();
            self.s.stack.extend_from_slice(binders);
            let mut env = Env::new(&model.library, self.state, &mut self.s.stack);
            let n = arg.code.eval(&mut env)?;
            if n < arg.range.0 || n > arg.range.1 {
                let value = arg.code.value_of(&mut env, n);
                return Err(Fault::Argument { of: signal.medium, parameter: i as u16, value });
            }
            self.s.args.push(n);
        }
        Ok(())
    }

    fn hand_shake(&mut self, member: usize, signal: &Signal) -> Flow {
        let model = self.model;
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

    fn meet(&mut self, member: usize, edge: usize, medium: Medium) -> Flow {
        let model = self.model;
        let arrow = &model.members[member].edges[edge];
        let Part::In(pattern) = &arrow.sync else { return ControlFlow::Continue(()) };
        if !pattern.matches(&self.s.args) {
            return ControlFlow::Continue(());
        }
        let guards = self.s.guard.len();
        let mut chosen = SmallVec::new();
        let mut more = first(&arrow.selects, &mut chosen);
        while more {
            let mut binders = chosen.clone();
            binders.extend(pattern.binds.iter().map(|&i| self.s.args[usize::from(i)]));
            let open = match self.clocks(member, edge, &binders) {
                Ok(true) => self.data(member, edge, &binders),
                other => other,
            };
            match open {
                Ok(true) => {
                    self.s.parts.push(Take { member: member as u16, edge: edge as u16, binders });
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

    fn broadcast(&mut self, signal: &Signal) -> Flow {
        let mut options: Vec<Vec<Response>> = Vec::new();
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
    fn responses(&mut self, member: usize, edges: &[u16], optional: bool) -> Vec<Response> {
        let model = self.model;
        let mut out = Vec::new();
        let mut absent: Vec<SmallVec<[Constraint; 4]>> = vec![SmallVec::new()];
        for &edge in edges {
            let arrow = &model.members[member].edges[usize::from(edge)];
            let binds: &[u16] = match &arrow.sync {
                Part::In(pattern) if pattern.matches(&self.s.args) => &pattern.binds,
                Part::In(_) => continue,
                Part::Internal | Part::Out(_) | Part::Join { .. } => &[],
            };
            let guards = self.s.guard.len();
            let mut chosen = SmallVec::new();
            let mut more = first(&arrow.selects, &mut chosen);
            while more {
                let mut binders = chosen.clone();
                binders.extend(binds.iter().map(|&i| self.s.args[usize::from(i)]));
                let open = self.clocks(member, usize::from(edge), &binders);
                let own: SmallVec<[Constraint; 2]> = SmallVec::from_slice(&self.s.guard[guards..]);
                self.s.guard.truncate(guards);
                let open = match open {
                    Ok(true) => self.data(member, usize::from(edge), &binders),
                    other => other,
                };
                let take = Take { member: member as u16, edge, binders };
                if open != Ok(false) {
                    // To stay away, one of the constraints of each enabled edge must fail.
                    absent = absent.iter().flat_map(|cs| own.iter().map(|c| extended(cs, *c))).collect();
                    absent.dedup();
                    absent.retain(|cs| cs.iter().all(|&c| self.may.may(c)));
                }
                match open {
                    Ok(true) => out.push(Response::Take(take, own)),
                    Ok(false) => {}
                    Err(fault) => out.push(Response::Fault(take, own, fault)),
                }
                more = next(&arrow.selects, &mut chosen);
            }
        }
        if optional && !out.is_empty() {
            out.extend(absent.into_iter().map(Response::Absent));
        }
        out
    }

    /// All combinations of what the partners may do, the last partner fastest.
    fn combine(&mut self, options: &[Vec<Response>], medium: Option<Medium>) -> Flow {
        let (parts, guards) = (self.s.parts.len(), self.s.guard.len());
        let mut at: SmallVec<[usize; 8]> = SmallVec::from_elem(0, options.len());
        loop {
            let mut fault = None;
            for (responses, &i) in options.iter().zip(&at) {
                match &responses[i] {
                    Response::Take(take, cs) => {
                        self.s.parts.push(take.clone());
                        self.s.guard.extend_from_slice(cs);
                    }
                    Response::Absent(cs) => self.s.guard.extend_from_slice(cs),
                    Response::Fault(take, cs, f) => {
                        self.s.guard.extend_from_slice(cs);
                        fault = Some((take.member, take.edge, *f));
                    }
                }
            }
            match fault {
                Some((member, edge, f)) => self.fault(usize::from(member), usize::from(edge), f)?,
                None if self.s.parts.is_empty() => {}
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

    fn joint(&mut self, joint: usize) -> Flow {
        let model = self.model;
        let joint = &model.joints[joint];
        let mut options: Vec<Vec<Response>> = Vec::new();
        self.s.guard.clear();
        self.s.parts.clear();
        self.s.args.clear();
        for &(member, optional) in &joint.parties {
            let m = usize::from(member);
            let is = |e: &u16| {
                matches!(&model.members[m].edges[usize::from(*e)].sync,
                    Part::Join { channel, .. } if *channel == joint.channel)
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
        self.combine(&options, Some(Medium::Channel(joint.channel)))
    }
}

fn extended(cs: &SmallVec<[Constraint; 4]>, c: Constraint) -> SmallVec<[Constraint; 4]> {
    let mut more = cs.clone();
    let negated = c.negated();
    if !more.contains(&negated) {
        more.push(negated);
    }
    more
}

pub(crate) fn range_fault(edge: Box<EdgeName>, var: &Var, value: i64) -> ModelError {
    ModelError::Range { edge, variable: var.name.clone(), value, lo: var.lo, hi: var.hi }
}

/// The first argument outside its parameter's range or enumeration, if any.
pub(crate) fn argument_fault<'e>(event: &'e hrdsl_ir::Event, args: &[Value]) -> Option<(&'e str, Value)> {
    event.params.iter().zip(args).find_map(|(p, v)| match (p.ty, v) {
        (Type::Int { lo, hi }, Value::Int(n)) if *n < lo || *n > hi => Some((p.name.as_str(), *v)),
        (Type::Enum(e), Value::Symbol(s)) if e.index_of(*s).is_none() => Some((p.name.as_str(), *v)),
        (Type::Int { .. } | Type::Bool | Type::Float(_) | Type::Enum(_) | Type::Text | Type::List(_), _) => {
            None
        }
    })
}

pub(crate) fn bad_argument(edge: Box<EdgeName>, event: &str, parameter: &str, value: Value) -> ModelError {
    let (event, parameter) = (event.to_owned(), parameter.to_owned());
    ModelError::Argument { edge, event, parameter, value }
}
