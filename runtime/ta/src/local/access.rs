//! What each edge depends on: found once, from the program, before the search.

use std::collections::{BTreeMap, BTreeSet};

use hrdsl_ir::{
    Expr, Program,
    expr::Lvalue,
    ta::{
        Automaton, ClockConstraint, ClockId, Edge, EdgeAssignment, FunctionId, FunctionStatement, Location,
        TimeSum,
    },
};

use super::refusal::NotApplicableError;
use crate::network::{model::CompiledNetwork, parts::EdgeSync, semantics::CompiledMove};

/// Something that automata may share.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum SharedResource {
    Var(u16),
    Clock(u16),
}

/// What is read (or written) and what is written; shared things only.
#[derive(Default)]
struct ResourceAccesses {
    all: BTreeSet<SharedResource>,
    written: BTreeSet<SharedResource>,
}

/// The processes of a network: its automata, then its media, and what each transition depends on.
pub(super) struct NetworkProcesses {
    /// Automata and media.
    pub count: usize,
    /// By automaton and edge: all whose state a transition with this edge depends on because of it.
    edges: Vec<Vec<Vec<u16>>>,
    /// By clock of the network, from 1: whose it is, if anybody uses it.
    owners: Vec<Option<u16>>,
}

impl NetworkProcesses {
    /// Finds what the edges share, and whether it can be told apart.
    ///
    /// # Errors
    /// If the network is none that local time serves.
    pub(super) fn of(model: &CompiledNetwork, media: bool) -> Result<Self, NotApplicableError> {
        let program = model.program;
        let (mut uses, mut invariants) = (Vec::new(), Vec::new());
        for m in &model.members {
            shape(program, m.automaton)?;
            let edges = m.automaton.edges.iter().map(|e| AccessCollector::new(program).edge(e));
            uses.push(edges.collect::<Vec<ResourceAccesses>>());
            let locations = m.automaton.locations.iter().map(|l| AccessCollector::new(program).location(l));
            invariants.push(locations.collect::<Vec<ResourceAccesses>>());
        }
        if model.extrapolation.diagonals.is_some() {
            return Err(NotApplicableError::Difference(model.name.clone()));
        }
        let shared = shared(&uses, &invariants);
        steady(model, &uses, &invariants, &shared)?;
        if let (false, Some(&thing)) = (media, shared.iter().next()) {
            return Err(NotApplicableError::Shared(name(program, thing)));
        }
        let (groups, count) = group(&uses, &shared, model.members.len());
        let touched: Vec<Vec<Vec<u16>>> =
            uses.iter().map(|of| of.iter().map(|u| media_of(u, &groups)).collect()).collect();
        let edges = model.members.iter().enumerate().map(|(m, member)| {
            let one = |e: usize| depends(model, &touched, m, e);
            (0..member.edges.len()).map(one).collect()
        });
        let edges = edges.collect();
        let mut owners = vec![None; model.dim];
        for (clock, owner) in owners.iter_mut().enumerate().skip(1).take(program.clocks.len()) {
            *owner = shared_owner(SharedResource::Clock(clock as u16 - 1), &uses, &invariants, &groups);
        }
        for (m, member) in model.members.iter().enumerate() {
            owners[member.first_clock..][..member.automaton.clocks.len()].fill(Some(m as u16));
        }
        Ok(Self { count, edges, owners })
    }

    /// The processes that a transition with these parts depends on; each once, in order.
    pub(super) fn involved(&self, parts: &[CompiledMove], out: &mut Vec<u16>) {
        out.clear();
        for part in parts {
            out.extend_from_slice(&self.edges[usize::from(part.member)][usize::from(part.edge)]);
        }
        out.sort_unstable();
        out.dedup();
    }

    /// Whose clock it is, counted from 1.
    pub(super) fn owner(&self, clock: u16) -> Option<u16> {
        self.owners[usize::from(clock)]
    }
}

/// The automaton, the media that the edge touches, and those who take part if they can, with what decides whether they can.
fn depends(model: &CompiledNetwork, touched: &[Vec<Vec<u16>>], member: usize, edge: usize) -> Vec<u16> {
    let mut all = vec![member as u16];
    all.extend_from_slice(&touched[member][edge]);
    match &model.members[member].edges[edge].sync {
        EdgeSync::Out(signal) if signal.broadcast => {
            for partner in &signal.partners {
                all.push(partner.member);
                let edges = partner.edges.iter().flatten();
                all.extend(edges.flat_map(|&e| &touched[usize::from(partner.member)][usize::from(e)]));
            }
        }
        EdgeSync::Join { channel, .. } => {
            let shared = model.multiway.iter().find(|j| j.channel == *channel);
            for &(participant, optional) in shared.iter().flat_map(|j| &j.participants) {
                if optional {
                    all.push(participant);
                    let arrows = model.members[usize::from(participant)].edges.iter().enumerate();
                    let joins = arrows.filter(
                        |(_, a)| matches!(&a.sync, EdgeSync::Join { channel: c, .. } if c == channel),
                    );
                    all.extend(joins.flat_map(|(e, _)| &touched[usize::from(participant)][e]));
                }
            }
        }
        EdgeSync::Internal | EdgeSync::Out(_) | EdgeSync::In(_) => {}
    }
    all.sort_unstable();
    all.dedup();
    all
}

/// Whether an automaton by itself has only what local zones can say.
fn shape(program: &Program, a: &Automaton) -> Result<(), NotApplicableError> {
    let invariants = a.locations.iter().flat_map(|l| &l.invariant);
    let guards = a.edges.iter().flat_map(|e| &e.clock_guard);
    if invariants.chain(guards).any(|c| c.minus.is_some()) {
        return Err(NotApplicableError::Difference(a.name.clone()));
    }
    if a.locations.iter().any(|l| !l.stopped.is_empty()) {
        return Err(NotApplicableError::Stopped(a.name.clone()));
    }
    for e in &a.edges {
        let channel = e.sync.channel().map(|c| program.channel(c));
        if let Some(urgent) = channel.filter(|c| c.urgent) {
            return Err(NotApplicableError::Urgent(urgent.name.clone()));
        }
    }
    Ok(())
}

/// The things that several automata use, unless they are never written.
fn shared(uses: &[Vec<ResourceAccesses>], invariants: &[Vec<ResourceAccesses>]) -> BTreeSet<SharedResource> {
    let mut users: BTreeMap<SharedResource, BTreeSet<usize>> = BTreeMap::new();
    let mut written = BTreeSet::new();
    for (automaton, of) in uses.iter().zip(invariants).enumerate() {
        for u in of.0.iter().chain(of.1) {
            for &thing in &u.all {
                users.entry(thing).or_default().insert(automaton);
            }
            written.extend(u.written.iter().copied());
        }
    }
    let lasting = |t: &SharedResource| matches!(t, SharedResource::Clock(_)) || written.contains(t);
    users.into_iter().filter(|(t, by)| by.len() > 1 && lasting(t)).map(|(t, _)| t).collect()
}

/// Whether no invariant depends on what other automata change: time may then pass for each automaton by itself.
fn steady(
    model: &CompiledNetwork,
    uses: &[Vec<ResourceAccesses>],
    invariants: &[Vec<ResourceAccesses>],
    shared: &BTreeSet<SharedResource>,
) -> Result<(), NotApplicableError> {
    for (i, of) in invariants.iter().enumerate() {
        let automaton = model.members[i].automaton;
        for (location, u) in automaton.locations.iter().zip(of) {
            for &thing in u.all.intersection(shared) {
                let others = uses.iter().enumerate().filter(|&(j, _)| j != i);
                let changed = others.flat_map(|(_, of)| of).any(|u| u.written.contains(&thing));
                // The medium of a shared clock has no location, so it cannot have the invariant.
                if changed || matches!(thing, SharedResource::Clock(_)) {
                    return Err(NotApplicableError::Invariant {
                        automaton: automaton.name.clone(),
                        location: location.name.clone(),
                        shared: name(model.program, thing),
                    });
                }
            }
        }
    }
    Ok(())
}

fn name(program: &Program, thing: SharedResource) -> String {
    match thing {
        SharedResource::Var(v) => program.shared[usize::from(v)].name.clone(),
        SharedResource::Clock(c) => program.clocks[usize::from(c)].clone(),
    }
}

/// One medium for all things that the same edges use, numbered after the automata; and the number of processes.
fn group(
    uses: &[Vec<ResourceAccesses>],
    shared: &BTreeSet<SharedResource>,
    automata: usize,
) -> (BTreeMap<SharedResource, u16>, usize) {
    let mut numbers: BTreeMap<Vec<(usize, usize)>, u16> = BTreeMap::new();
    let mut groups = BTreeMap::new();
    for &thing in shared {
        let mut by = Vec::new();
        for (i, of) in uses.iter().enumerate() {
            by.extend((0..of.len()).filter(|&e| of[e].all.contains(&thing)).map(|e| (i, e)));
        }
        let next = (automata + numbers.len()) as u16;
        groups.insert(thing, *numbers.entry(by).or_insert(next));
    }
    (groups, automata + numbers.len())
}

fn media_of(u: &ResourceAccesses, groups: &BTreeMap<SharedResource, u16>) -> Vec<u16> {
    u.all.iter().filter_map(|t| groups.get(t)).copied().collect::<BTreeSet<_>>().into_iter().collect()
}

/// A shared clock's medium, or the one automaton that uses it.
fn shared_owner(
    clock: SharedResource,
    uses: &[Vec<ResourceAccesses>],
    invariants: &[Vec<ResourceAccesses>],
    groups: &BTreeMap<SharedResource, u16>,
) -> Option<u16> {
    let by = |of: &[ResourceAccesses]| of.iter().any(|u| u.all.contains(&clock));
    let one = || (0..uses.len()).find(|&i| by(&uses[i]) || by(&invariants[i])).map(|i| i as u16);
    groups.get(&clock).copied().or_else(one)
}

/// Collects what expressions and functions use.
struct AccessCollector<'p> {
    program: &'p Program,
    uses: ResourceAccesses,
    seen: BTreeSet<FunctionId>,
}

impl<'p> AccessCollector<'p> {
    fn new(program: &'p Program) -> Self {
        Self { program, uses: ResourceAccesses::default(), seen: BTreeSet::new() }
    }

    fn edge(mut self, e: &Edge) -> ResourceAccesses {
        e.clock_guard.iter().for_each(|c| self.constraint(c));
        e.guard.iter().for_each(|g| self.expr(g));
        e.sync.given().iter().for_each(|a| self.expr(a));
        for u in &e.updates {
            match u {
                EdgeAssignment::Assign { place, value } => {
                    self.write(place);
                    self.expr(value);
                }
                EdgeAssignment::Reset { clock, from, to } => {
                    self.clock(*clock, true);
                    from.iter().for_each(|c| self.clock(*c, false));
                    self.time(to);
                }
                EdgeAssignment::Call { function, args } => self.call(*function, args),
            }
        }
        self.uses
    }

    fn location(mut self, l: &Location) -> ResourceAccesses {
        l.invariant.iter().for_each(|c| self.constraint(c));
        l.holds.iter().for_each(|e| self.expr(e));
        self.uses
    }

    fn constraint(&mut self, c: &ClockConstraint) {
        self.clock(c.clock, false);
        c.minus.iter().for_each(|m| self.clock(*m, false));
        self.time(&c.bound);
    }

    fn clock(&mut self, clock: ClockId, written: bool) {
        if usize::from(clock.0) < self.program.clocks.len() {
            self.uses.all.insert(SharedResource::Clock(clock.0));
            if written {
                self.uses.written.insert(SharedResource::Clock(clock.0));
            }
        }
    }

    fn time(&mut self, t: &TimeSum) {
        t.terms.iter().for_each(|t| self.expr(&t.value));
    }

    fn var(&mut self, slot: u16) {
        if usize::from(slot) < self.program.shared.len() {
            self.uses.all.insert(SharedResource::Var(slot));
        }
    }

    fn write(&mut self, place: &Lvalue) {
        self.place(place);
        // The indices' own variables are only read.
        let mut slots = vec![place.slot];
        for index in &place.indices {
            slots = slots.iter().flat_map(|s| (0..index.count).map(move |n| s + n * index.stride)).collect();
        }
        for slot in slots.into_iter().filter(|&s| usize::from(s) < self.program.shared.len()) {
            self.uses.written.insert(SharedResource::Var(slot));
        }
    }

    fn place(&mut self, place: &Lvalue) {
        place.each_var(&mut |v| self.var(v));
        place.indices.iter().for_each(|i| self.expr(&i.at));
    }

    fn expr(&mut self, e: &Expr) {
        match e {
            Expr::Const(_) => {}
            Expr::Var(v) => self.var(*v),
            Expr::Unary(_, a) => self.expr(a),
            Expr::Binary(_, a, b) => [a, b].into_iter().for_each(|e| self.expr(e)),
            Expr::If(a, b, c) => [a, b, c].into_iter().for_each(|e| self.expr(e)),
            Expr::Call(_, args) => args.iter().for_each(|a| self.expr(a)),
            Expr::List(elements, rest) => {
                elements.iter().for_each(|e| self.expr(e));
                rest.iter().for_each(|e| self.expr(e));
            }
            Expr::Element(place) => self.place(place),
            Expr::Apply(function, args) => self.call(*function, args),
        }
    }

    fn call(&mut self, function: FunctionId, args: &[Expr]) {
        args.iter().for_each(|a| self.expr(a));
        let Some(f) = self.program.functions.get(usize::from(function.0)) else { return };
        if self.seen.insert(function) {
            f.body.iter().for_each(|s| self.statement(s));
        }
    }

    fn statement(&mut self, s: &FunctionStatement) {
        match s {
            FunctionStatement::Assign { place, value } => {
                self.write(place);
                self.expr(value);
            }
            FunctionStatement::Call { function, args } => self.call(*function, args),
            FunctionStatement::If { condition, then, otherwise } => {
                self.expr(condition);
                then.iter().chain(otherwise).for_each(|s| self.statement(s));
            }
            FunctionStatement::While { condition, body } => {
                self.expr(condition);
                body.iter().for_each(|s| self.statement(s));
            }
            FunctionStatement::For { lo, hi, body, .. } => {
                self.expr(lo);
                self.expr(hi);
                body.iter().for_each(|s| self.statement(s));
            }
            FunctionStatement::Return(value) => value.iter().for_each(|e| self.expr(e)),
        }
    }
}
