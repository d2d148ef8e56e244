//! A small interpreter of automata under concrete clocks, straight from the program.
//!
//! It shares no transition relation with the search, so that a witness that it [replays](crate::witness::replay) is
//! believed for good reason; and it plays a single automaton in a harness ([`VirtualTimePlayer`](crate::VirtualTimePlayer)). What functions mean
//! it takes from [`hrdsl_ir::exec`], as everybody does.

use std::{ops::ControlFlow, sync::Arc};

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

    /// Clocks beyond a value become that value.
    #[cfg(test)]
    pub(crate) fn cap(&mut self, most: i128) {
        let least = self.now - most;
        let all = self.shared_zero.iter_mut().chain(self.own_zero.iter_mut().flatten());
        all.for_each(|zero| *zero = (*zero).max(least));
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
        for c in constraints {
            let clock = |c: ClockId| self.now - self.zero_at(member, c);
            let value = clock(c.clock) - c.minus.map_or(0, clock);
            if !compare(value, c.op, self.span(member, binders, &c.bound)?) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Whether a member's invariant holds now, its variables' part included.
    pub(crate) fn invariant_holds(&self, member: usize) -> Result<bool, ModelError> {
        let place = self.place(member);
        let all = self.data_holds(member).and_then(|h| Ok(h && self.holds(member, &[], &place.invariant)?));
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
        for m in 0..self.members.len() {
            if !self.invariant_holds(m)? {
                return Ok(Some(m));
            }
        }
        Ok(None)
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
                if self.guard(&m)? && (!clocks || self.clock_guard(&m)?) {
                    out.push(m);
                }
            }
        }
        Ok(out)
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

    /// Whether some transition is possible right now.
    ///
    /// # Errors
    /// If the model is at fault.
    pub(crate) fn can_move(&self) -> Result<bool, ModelError> {
        Ok(self.each_next(&mut |_| ControlFlow::Break(()))?.is_break())
    }

    /// Shows what each transition that is possible right now leads to, until it breaks off.
    ///
    /// # Errors
    /// If the model is at fault.
    pub(crate) fn each_next(
        &self,
        f: &mut dyn FnMut(ConcreteInterpreter<'p>) -> ControlFlow<()>,
    ) -> Result<ControlFlow<()>, ModelError> {
        let mut groups: Vec<Vec<Vec<AutomatonMove>>> = Vec::new();
        for (automaton, a) in self.members.iter().enumerate() {
            for (edge, e) in a.edges.iter().enumerate().filter(|(_, e)| e.from == self.location[automaton]) {
                // What takes something moves with whoever sends it, and binds the arguments then.
                if matches!(e.sync, SyncLabel::Receive { .. } | SyncLabel::Accept { .. }) {
                    continue;
                }
                for binders in choices(&e.selects) {
                    let m = AutomatonMove { automaton, edge, binders };
                    if starts(&e.sync) && self.guard(&m)? && self.clock_guard(&m)? {
                        self.partners(&m, &mut groups)?;
                    }
                }
            }
        }
        for group in groups {
            if self.each_combination(&group, f)?.is_break() {
                return Ok(ControlFlow::Break(()));
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    /// The transitions that an open edge starts: for each, what each automaton that takes part may do.
    fn partners(
        &self,
        m: &AutomatonMove,
        groups: &mut Vec<Vec<Vec<AutomatonMove>>>,
    ) -> Result<(), ModelError> {
        let hear = |medium: SyncMedium, args: &[Value]| -> Result<Vec<Vec<AutomatonMove>>, ModelError> {
            let mut all = vec![vec![m.clone()]];
            for o in self.others(m.automaton) {
                let moves = self.receptions(o, medium, args, true)?;
                if !moves.is_empty() {
                    all.push(moves);
                }
            }
            Ok(all)
        };
        match &self.edge(m).sync {
            SyncLabel::Internal => groups.push(vec![vec![m.clone()]]),
            SyncLabel::Send { event, args } => {
                let args = self.arguments(m, *event, args)?;
                groups.push(hear(SyncMedium::Event(*event), &args)?);
            }
            SyncLabel::Offer { channel, args } => {
                let Some(declared) = self.channel(*channel) else { return Ok(()) };
                let args = self.offered(m, declared, args)?;
                let all = hear(SyncMedium::Channel(*channel), &args)?;
                match declared.kind {
                    ChannelKind::Broadcast => groups.push(all),
                    // One partner at a time: each of those that could accept is another transition.
                    ChannelKind::Binary | ChannelKind::MultiWay(_) => {
                        groups.extend(all.into_iter().skip(1).map(|moves| vec![vec![m.clone()], moves]));
                    }
                }
            }
            SyncLabel::Join { channel } => groups.extend(self.multiway(*channel, m)?),
            SyncLabel::Receive { .. } | SyncLabel::Accept { .. } => {}
        }
        Ok(())
    }

    /// What each participant of a multi-way channel may do; nothing if a participant that must take part cannot, or if the given move is
    /// not the first participant's, which starts it.
    pub(crate) fn multiway(
        &self,
        id: ChannelId,
        first: &AutomatonMove,
    ) -> Result<Option<Vec<Vec<AutomatonMove>>>, ModelError> {
        let Some(ChannelKind::MultiWay(participants)) = self.channel(id).map(|c| &c.kind) else {
            return Ok(None);
        };
        let mut all = Vec::new();
        for p in participants {
            let Some(member) = self.member(p.automaton) else { continue };
            let moves = self.receptions(member, SyncMedium::Channel(id), &[], true)?;
            match (moves.is_empty(), p.optional) {
                (true, true) => {}
                (true, false) => return Ok(None),
                (false, _) => all.push(moves),
            }
        }
        // Every open edge of a participant is asked whether it starts this; only the first participant's do, or each combination would come
        // once for each of its parts.
        Ok(all.first().is_some_and(|moves| moves.contains(first)).then_some(all))
    }

    /// Each choice of a move for each automaton.
    fn each_combination(
        &self,
        group: &[Vec<AutomatonMove>],
        f: &mut dyn FnMut(ConcreteInterpreter<'p>) -> ControlFlow<()>,
    ) -> Result<ControlFlow<()>, ModelError> {
        let takes_committed =
            group.iter().any(|moves| self.kind(moves[0].automaton) == LocationKind::Committed);
        // INVARIANT: a list of the group is of one automaton, and none is empty. One committed part lets all the others move with it.
        if self.any_committed() && !takes_committed {
            return Ok(ControlFlow::Continue(()));
        }
        let mut at = vec![0; group.len()];
        loop {
            // Guards and arguments were worked out in the state before; updates go one after the other, in the order of the parts.
            let mut next = self.clone();
            for (moves, &i) in group.iter().zip(&at) {
                next.take(&moves[i])?;
            }
            // A transition into an invariant that does not hold is not there; it is no fault.
            if next.broken_invariant()?.is_none() && f(next).is_break() {
                return Ok(ControlFlow::Break(()));
            }
            let Some(turn) = (0..at.len()).rev().find(|&i| at[i] + 1 < group[i].len()) else {
                return Ok(ControlFlow::Continue(()));
            };
            at[turn] += 1;
            at[turn + 1..].fill(0);
        }
    }

    /// Whether some transition is possible now or after some delay.
    ///
    /// Between two neighbouring bounds of the clocks' constraints nothing changes, so it looks at each bound and a tick to
    /// either side.
    ///
    /// # Errors
    /// If the model is at fault.
    pub(crate) fn can_ever_move(&self) -> Result<bool, ModelError> {
        if self.can_move()? {
            return Ok(true);
        }
        if !self.may_wait() {
            return Ok(false);
        }
        for later in self.turns() {
            let mut then = self.clone();
            then.now = later;
            if then.broken_invariant()?.is_none() && then.can_move()? {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// The times from now on at which a constraint may change its value, in order.
    fn turns(&self) -> Vec<i128> {
        let mut times = Vec::new();
        for (member, a) in self.members.iter().enumerate() {
            let edges = a.edges.iter().filter(|e| e.from == self.location[member]);
            // Invariants of targets count, too: an edge may be open before the location that it leads to can be entered.
            let targets = edges.clone().flat_map(|e| &a.locations[usize::from(e.to.0)].invariant);
            let guards = edges.clone().flat_map(|e| e.clock_guard.iter().map(move |c| (e, c)));
            for c in targets.chain(&self.place(member).invariant) {
                self.note_turn(member, &[], c, &mut times);
            }
            for (e, c) in guards {
                for binders in choices(&e.selects) {
                    self.note_turn(member, &binders, c, &mut times);
                }
            }
        }
        times.retain(|t| *t > self.now);
        times.sort_unstable();
        times.dedup();
        times
    }

    fn note_turn(&self, member: usize, binders: &[Value], c: &ClockConstraint, times: &mut Vec<i128>) {
        // The difference of two clocks does not change with time. A bound without a value is a fault of its edge, which is met where the
        // edge is tried.
        if let (None, Ok(bound)) = (c.minus, self.span(member, binders, &c.bound)) {
            let at = self.zero_at(member, c.clock) + bound;
            times.extend([at - 1, at, at + 1]);
        }
    }
}

/// Whether such an edge can begin a transition.
fn starts(sync: &SyncLabel) -> bool {
    match sync {
        SyncLabel::Internal | SyncLabel::Send { .. } | SyncLabel::Offer { .. } | SyncLabel::Join { .. } => {
            true
        }
        SyncLabel::Receive { .. } | SyncLabel::Accept { .. } => false,
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
