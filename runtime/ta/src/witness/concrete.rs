//! A small interpreter of automata under concrete clocks, straight from the program.
//!
//! It shares no transition relation with the search, so that a witness that it [replays](crate::witness::replay) is
//! believed for good reason; and it plays a single automaton in a harness ([`VirtualTimePlayer`](crate::VirtualTimePlayer)). What functions mean
//! it takes from [`hrdsl_ir::exec`], as everybody does.

use std::sync::Arc;

use hrdsl_ir::{
    EventId, Expr, Program, Value,
    exec::{self, FunctionTable},
    expr::EvalError,
    ta::{
        Automaton, AutomatonVar, Channel, ChannelId, ChannelKind, ClockConstraint, ClockId, ClockOp, Edge,
        EdgeAssignment, FunctionId, LocationId, LocationKind, ReceiveArg, SyncLabel, TimeSum,
    },
};

use crate::{
    network::{
        code::SyncMedium,
        error::{EdgeName, ModelError, argument_fault, bad_argument, range_fault},
        query::nanos,
        selects::{BinderValues, bind, choices},
        semantics::AutomatonMove,
    },
    witness::memory::{AutomatonScope, AutomatonScopeMut, read, slots},
};

/// The state of some automata at an instant; time is in ticks.
#[derive(Clone)]
pub(crate) struct ConcreteInterpreter<'p> {
    pub(crate) program: &'p Program,
    functions: Arc<FunctionTable<'p>>,
    pub(crate) members: Vec<&'p Automaton>,
    pub(crate) location: Vec<LocationId>,
    shared: Vec<i64>,
    own: Vec<Vec<i64>>,
    /// When each shared clock was, or would have been, zero.
    shared_zero: Vec<i128>,
    own_zero: Vec<Vec<i128>>,
    pub(crate) now: i128,
    /// Ticks in a nanosecond.
    ticks: i128,
}

impl<'p> ConcreteInterpreter<'p> {
    /// INVARIANT: the automata have passed the check.
    pub(crate) fn new(program: &'p Program, members: &[&'p Automaton], ticks: i64) -> Self {
        Self {
            program,
            functions: Arc::new(FunctionTable::new(program)),
            location: members.iter().map(|a| a.initial).collect(),
            shared: program.shared.iter().map(|v| v.init).collect(),
            own: members.iter().map(|a| a.vars.iter().map(|v| v.init).collect()).collect(),
            shared_zero: vec![0; program.clocks.len()],
            own_zero: members.iter().map(|a| vec![0; a.clocks.len()]).collect(),
            members: members.to_vec(),
            now: 0,
            ticks: i128::from(ticks),
        }
    }

    pub(crate) fn kind(&self, member: usize) -> LocationKind {
        self.place(member).kind
    }

    pub(crate) fn place(&self, member: usize) -> &'p hrdsl_ir::ta::Location {
        let automaton: &'p Automaton = self.members[member];
        &automaton.locations[usize::from(self.location[member].0)]
    }

    pub(crate) fn any_committed(&self) -> bool {
        (0..self.members.len()).any(|m| self.kind(m) == LocationKind::Committed)
    }

    /// When a clock was last zero, in ticks.
    pub(crate) fn zero_at(&self, member: usize, clock: ClockId) -> i128 {
        let at = usize::from(clock.0);
        match self.shared_zero.get(at) {
            Some(zero) => *zero,
            None => self.own_zero[member][at - self.shared_zero.len()],
        }
    }

    /// Lets time pass until a later instant. Where a clock stands still, the time at which it was zero comes along.
    pub(crate) fn advance(&mut self, until: i128) {
        let (passed, shared) = (until - self.now, self.shared_zero.len());
        // A shared clock stands once, however many locations stop it.
        let of = |m: usize| self.place(m).stopped.iter().map(move |c| (usize::from(c.0), m));
        let mut stopped: Vec<(usize, usize)> = (0..self.members.len()).flat_map(of).collect();
        stopped.sort_unstable();
        stopped.dedup_by(|b, a| b == a || (b.0 == a.0 && a.0 < shared));
        for (at, member) in stopped {
            match self.shared_zero.get_mut(at) {
                Some(zero) => *zero += passed,
                None => self.own_zero[member][at - shared] += passed,
            }
        }
        self.now = until;
    }

    /// Clocks beyond a value become that value.
    #[cfg(test)]
    pub(crate) fn cap(&mut self, most: i128) {
        let least = self.now - most;
        let all = self.shared_zero.iter_mut().chain(self.own_zero.iter_mut().flatten());
        all.for_each(|zero| *zero = (*zero).max(least));
    }

    /// The same instant with ticks of half the length: between any two of the former is one of these.
    pub(crate) fn in_half_ticks(&self) -> Self {
        let mut finer = self.clone();
        finer.ticks *= 2;
        finer.now *= 2;
        let zeros = finer.shared_zero.iter_mut().chain(finer.own_zero.iter_mut().flatten());
        zeros.for_each(|zero| *zero *= 2);
        finer
    }

    /// The values of the network's clocks now, in ticks: the shared ones, then each automaton's.
    pub(crate) fn clocks(&self) -> Vec<i128> {
        self.shared_zero.iter().chain(self.own_zero.iter().flatten()).map(|zero| self.now - zero).collect()
    }

    /// A time of this automaton in ticks.
    pub(crate) fn span(&self, member: usize, binders: &[Value], time: &TimeSum) -> Result<i128, EvalError> {
        if time.terms.is_empty() {
            return Ok(i128::from(time.nanos) * self.ticks);
        }
        let n = self.view(member, binders, |view| nanos(time, view))?;
        Ok(i128::from(n) * self.ticks)
    }

    fn view<T>(&self, member: usize, binders: &[Value], f: impl FnOnce(&exec::MemoryView<'_>) -> T) -> T {
        let vars = &self.members[member].vars;
        let memory =
            AutomatonScope { program: self.program, vars, shared: &self.shared, own: &self.own[member] };
        f(&exec::MemoryView::new(&self.functions, &memory, slots(self.program, vars), binders))
    }

    /// Whether clock constraints hold now.
    pub(crate) fn holds(
        &self,
        member: usize,
        binders: &[Value],
        constraints: &[ClockConstraint],
    ) -> Result<bool, EvalError> {
        let mut result = Ok(true);
        for c in constraints {
            let clock = |c: ClockId| self.now - self.zero_at(member, c);
            let value = clock(c.clock) - c.minus.map_or(0, clock);
            match self.span(member, binders, &c.bound) {
                Ok(bound) if compare(value, c.op, bound) => {}
                Ok(_) => return Ok(false),
                // Another constraint that does not hold protects this one.
                Err(fault) => result = result.and(Err(fault)),
            }
        }
        result
    }

    /// Whether a member's invariant holds now, its variables' part included.
    pub(crate) fn invariant_holds(&self, member: usize) -> Result<bool, ModelError> {
        Ok(self.invariant_parts(member)? == (true, true))
    }

    /// Whether the invariant's part over variables holds now, and its part over clocks, which has no meaning where the first does not.
    fn invariant_parts(&self, member: usize) -> Result<(bool, bool), ModelError> {
        let place = self.place(member);
        let clocks = || {
            // A bound without a value is a fault whatever the other bounds are.
            place.invariant.iter().try_for_each(|c| self.span(member, &[], &c.bound).map(drop))?;
            self.holds(member, &[], &place.invariant)
        };
        let all = self.data_holds(member).and_then(|data| Ok((data, data && clocks()?)));
        all.map_err(|error| ModelError::Invariant {
            automaton: self.members[member].name.clone(),
            location: place.name.clone(),
            error,
        })
    }

    /// Whether the part of a member's invariant that is over variables holds.
    pub(crate) fn data_holds(&self, member: usize) -> Result<bool, EvalError> {
        match &self.place(member).holds {
            None => Ok(true),
            Some(e) => self.view(member, &[], |v| v.eval(e))?.as_bool().ok_or(EvalError::Type),
        }
    }

    /// The first member whose invariant does not hold now.
    pub(crate) fn broken_invariant(&self) -> Result<Option<usize>, ModelError> {
        let mut broken = None;
        for m in 0..self.members.len() {
            match self.invariant_parts(m)? {
                (true, true) => {}
                // Those after it may have no value for this very reason.
                (false, _) => return Ok(Some(m)),
                (true, false) => broken = broken.or(Some(m)),
            }
        }
        Ok(broken)
    }

    /// Whether the edge leaves the current location and its data guard holds; clocks are not looked at.
    pub(crate) fn guard(&self, m: &AutomatonMove) -> Result<bool, ModelError> {
        let edge = self.edge(m);
        if edge.from != self.location[m.automaton] {
            return Ok(false);
        }
        let Some(guard) = &edge.guard else { return Ok(true) };
        let value = self.eval(m, guard).and_then(|v| v.as_bool().ok_or(EvalError::Type));
        value.map_err(|e| self.fault(m, e))
    }

    /// Whether the edge's clock guard holds now.
    pub(crate) fn clock_guard(&self, m: &AutomatonMove) -> Result<bool, ModelError> {
        self.holds(m.automaton, &m.binders, &self.edge(m).clock_guard).map_err(|e| self.fault(m, e))
    }

    /// The arguments that a sending edge sends.
    pub(crate) fn arguments(
        &self,
        m: &AutomatonMove,
        event: EventId,
        args: &[Expr],
    ) -> Result<Vec<Value>, ModelError> {
        let values: Result<Vec<Value>, EvalError> = args.iter().map(|a| self.eval(m, a)).collect();
        let values = values.map_err(|e| self.fault(m, e))?;
        let declared = self.program.event(event);
        match argument_fault(declared, &values) {
            None => Ok(values),
            Some((name, value)) => Err(bad_argument(self.names(m), &declared.name, name, value)),
        }
    }

    /// The arguments that an offering edge offers.
    pub(crate) fn offered(
        &self,
        m: &AutomatonMove,
        channel: &Channel,
        args: &[Expr],
    ) -> Result<Vec<Value>, ModelError> {
        let mut values = Vec::with_capacity(args.len());
        for (param, e) in channel.params.iter().zip(args) {
            let value = self.eval(m, e).map_err(|e| self.fault(m, e))?;
            let n = param.number(value).ok_or_else(|| self.fault(m, EvalError::Type))?;
            if !(param.lo..=param.hi).contains(&n) {
                return Err(bad_argument(self.names(m), &channel.name, &param.name, value));
            }
            values.push(value);
        }
        Ok(values)
    }

    /// Goes along an edge: its updates in order, then its target.
    pub(crate) fn take(&mut self, m: &AutomatonMove) -> Result<(), ModelError> {
        // The location goes first, and no update can read it; invariants are asked when all parts have moved.
        let edge = self.edge(m);
        self.location[m.automaton] = edge.to;
        edge.updates.iter().try_for_each(|u| self.update(m, u))
    }

    /// One of an edge's updates.
    pub(crate) fn update(&mut self, m: &AutomatonMove, u: &EdgeAssignment) -> Result<(), ModelError> {
        match u {
            EdgeAssignment::Reset { clock, from, to } => self.set_clock(m, *clock, *from, to),
            EdgeAssignment::Assign { place, value } => self.change(m, |view| view.assign(place, value)),
            EdgeAssignment::Call { function, args } => self.change(m, |view| view.call(*function, args)),
        }
    }

    fn set_clock(
        &mut self,
        m: &AutomatonMove,
        clock: ClockId,
        from: Option<ClockId>,
        to: &TimeSum,
    ) -> Result<(), ModelError> {
        let plus = self.span(m.automaton, &m.binders, to).map_err(|e| self.fault(m, e))?;
        // A clock is kept as the time at which it was zero, so that delays change nothing but `now`. A copy takes the other's zero.
        let zero = from.map_or(self.now, |from| self.zero_at(m.automaton, from)) - plus;
        if zero > self.now {
            let name = clock_name(self.program, self.members[m.automaton], clock);
            return Err(ModelError::NegativeClock { edge: self.names(m), clock: name });
        }
        let at = usize::from(clock.0);
        let shared = self.shared_zero.len();
        match self.shared_zero.get_mut(at) {
            Some(place) => *place = zero,
            None => self.own_zero[m.automaton][at - shared] = zero,
        }
        Ok(())
    }

    fn change(
        &mut self,
        m: &AutomatonMove,
        f: impl FnOnce(&exec::MemoryView<'_>) -> Result<(), EvalError>,
    ) -> Result<(), ModelError> {
        let vars = &self.members[m.automaton].vars;
        let result = {
            let own = &mut self.own[m.automaton];
            let mut memory = AutomatonScopeMut { program: self.program, vars, shared: &mut self.shared, own };
            f(&exec::MemoryView::open(&self.functions, &mut memory, slots(self.program, vars), &m.binders))
        };
        result.map_err(|e| match e {
            EvalError::Outside { slot, value } => {
                let at = usize::from(slot);
                let own = || vars.get(at - self.program.shared.len());
                match self.program.shared.get(at).or_else(own) {
                    Some(var) => range_fault(self.names(m), var, value),
                    None => self.fault(m, e),
                }
            }
            EvalError::Unbound(_)
            | EvalError::DivisionByZero
            | EvalError::Overflow
            | EvalError::Index { .. }
            | EvalError::Endless
            | EvalError::Range(_)
            | EvalError::Type => self.fault(m, e),
        })
    }

    pub(crate) fn edge(&self, m: &AutomatonMove) -> &'p Edge {
        let automaton: &'p Automaton = self.members[m.automaton];
        &automaton.edges[m.edge]
    }

    fn eval(&self, m: &AutomatonMove, e: &Expr) -> Result<Value, EvalError> {
        self.view(m.automaton, &m.binders, |view| view.eval(e))
    }

    /// The variable that a member's expressions call `slot`.
    pub(crate) fn variable(&self, member: usize, slot: usize) -> Option<Value> {
        let vars = &self.members.get(member)?.vars;
        read(self.program, vars, &self.shared, &self.own[member], u16::try_from(slot).ok()?)
    }

    /// All variables of the network with the numbers that they keep: the shared ones, then each automaton's.
    pub(crate) fn numbers(&self) -> Vec<(&'p AutomatonVar, i64)> {
        let shared = self.program.shared.iter().zip(&self.shared);
        let own = self.members.iter().zip(&self.own);
        let own = own.flat_map(|(a, own)| a.vars.iter().zip(own));
        shared.chain(own).map(|(v, n)| (v, *n)).collect()
    }

    /// The value of a function: with its owner's variables if it has one.
    pub(crate) fn apply(&self, function: FunctionId, args: &[Value]) -> Result<Value, EvalError> {
        let owner = self.program.functions.get(usize::from(function.0)).ok_or(EvalError::Type)?.owner;
        let owner = owner.and_then(|id| self.program.automata.get(usize::from(id.0)));
        let member = match owner {
            None => 0,
            Some(a) => self.members.iter().position(|m| std::ptr::eq(*m, a)).ok_or(EvalError::Type)?,
        };
        self.view(member, &[], |view| hrdsl_ir::expr::EvalScope::apply(view, function, args))
    }

    pub(crate) fn names(&self, m: &AutomatonMove) -> Box<EdgeName> {
        EdgeName::of(self.members[m.automaton], self.edge(m))
    }

    fn fault(&self, m: &AutomatonMove, error: EvalError) -> ModelError {
        ModelError::Evaluation { edge: self.names(m), error }
    }

    pub(crate) fn channel(&self, id: ChannelId) -> Option<&'p Channel> {
        self.program.channels.get(usize::from(id.0))
    }

    /// The moves by which an automaton can take part in what another one sends or offers: data guards hold, and the clock
    /// guards too if they are asked for.
    pub(crate) fn receptions(
        &self,
        member: usize,
        medium: SyncMedium,
        args: &[Value],
        clocks: bool,
    ) -> Result<Vec<AutomatonMove>, ModelError> {
        let mut out = Vec::new();
        for (i, edge) in self.members[member].edges.iter().enumerate() {
            let Some((_, pattern)) = taken(&edge.sync).filter(|(over, _)| *over == medium) else { continue };
            let mut bound = BinderValues::new();
            let here = edge.from == self.location[member];
            if !here || pattern.len() != args.len() || !bind(pattern, args, &mut bound) {
                continue;
            }
            for mut binders in choices(&edge.selects) {
                binders.extend_from_slice(&bound);
                let m = AutomatonMove { automaton: member, edge: i, binders };
                if if clocks { self.is_open(&m)? } else { self.guard(&m)? } {
                    out.push(m);
                }
            }
        }
        Ok(out)
    }

    /// Whether both guards of the edge hold now. A clock guard that does not hold protects the other from faults, and the other way round.
    pub(crate) fn is_open(&self, m: &AutomatonMove) -> Result<bool, ModelError> {
        let clocks = self.clock_guard(m);
        if clocks == Ok(false) || self.guard(m)? { clocks } else { Ok(false) }
    }

    /// Whether a transition over an urgent channel is possible: then no time passes. Clock guards do not matter, since the
    /// edges of urgent channels have none but those that accept a broadcast. What has no value is not possible.
    pub(crate) fn is_urged(&self) -> bool {
        self.program.channels.iter().zip(0u16..).filter(|(c, _)| c.urgent).any(|(channel, id)| {
            let id = ChannelId(id);
            match &channel.kind {
                ChannelKind::MultiWay(participants) => {
                    let mut there =
                        participants.iter().filter_map(|p| Some((self.member(p.automaton)?, p.optional)));
                    let open = |m| {
                        self.receptions(m, SyncMedium::Channel(id), &[], false).is_ok_and(|w| !w.is_empty())
                    };
                    let participants: Vec<(bool, bool)> =
                        there.by_ref().map(|(m, opt)| (open(m), opt)).collect();
                    participants.iter().any(|w| w.0) && participants.iter().all(|w| w.0 || w.1)
                }
                ChannelKind::Binary => self.offers(id, false).iter().any(|(m, args)| {
                    self.others(m.automaton).any(|o| {
                        self.receptions(o, SyncMedium::Channel(id), args, false).is_ok_and(|w| !w.is_empty())
                    })
                }),
                ChannelKind::Broadcast => !self.offers(id, false).is_empty(),
            }
        })
    }

    /// The open offers over a channel; those without a value are left out.
    fn offers(&self, id: ChannelId, clocks: bool) -> Vec<(AutomatonMove, Vec<Value>)> {
        let Some(declared) = self.channel(id) else { return Vec::new() };
        let mut out = Vec::new();
        for (automaton, a) in self.members.iter().enumerate() {
            for (edge, e) in a.edges.iter().enumerate() {
                let SyncLabel::Offer { channel, args } = &e.sync else { continue };
                if *channel != id || e.from != self.location[automaton] {
                    continue;
                }
                for binders in choices(&e.selects) {
                    let m = AutomatonMove { automaton, edge, binders };
                    let open = self.guard(&m) == Ok(true) && (!clocks || self.clock_guard(&m) == Ok(true));
                    if open && let Ok(args) = self.offered(&m, declared, args) {
                        out.push((m, args));
                    }
                }
            }
        }
        out
    }

    pub(crate) fn others(&self, member: usize) -> impl Iterator<Item = usize> + use<> {
        (0..self.members.len()).filter(move |&m| m != member)
    }

    /// Where an automaton of the program is among the members.
    pub(crate) fn member(&self, id: hrdsl_ir::ta::AutomatonId) -> Option<usize> {
        let automaton = self.program.automata.get(usize::from(id.0))?;
        self.members.iter().position(|m| std::ptr::eq(*m, automaton))
    }

    /// Whether time may pass as far as locations and channels tell.
    pub(crate) fn may_wait(&self) -> bool {
        (0..self.members.len()).all(|m| self.kind(m) == LocationKind::Normal) && !self.is_urged()
    }
}

pub(crate) fn compare(value: i128, op: ClockOp, bound: i128) -> bool {
    match op {
        ClockOp::Lt => value < bound,
        ClockOp::Le => value <= bound,
        ClockOp::Eq => value == bound,
        ClockOp::Ge => value >= bound,
        ClockOp::Gt => value > bound,
    }
}

/// What an edge takes part in that others begin, and in which of it by the arguments.
fn taken(sync: &SyncLabel) -> Option<(SyncMedium, &[ReceiveArg])> {
    match sync {
        SyncLabel::Receive { event, args } => Some((SyncMedium::Event(*event), args)),
        SyncLabel::Accept { channel, args } => Some((SyncMedium::Channel(*channel), args)),
        SyncLabel::Join { channel } => Some((SyncMedium::Channel(*channel), &[])),
        SyncLabel::Internal | SyncLabel::Send { .. } | SyncLabel::Offer { .. } => None,
    }
}

/// The name of a clock as an automaton numbers it.
pub(crate) fn clock_name(program: &Program, automaton: &Automaton, clock: ClockId) -> String {
    let at = usize::from(clock.0);
    match program.clocks.get(at) {
        Some(shared) => shared.clone(),
        None => format!("{}.{}", automaton.name, automaton.clocks[at - program.clocks.len()]),
    }
}
