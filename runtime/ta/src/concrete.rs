//! A small interpreter of automata under concrete clocks, straight from the program.
//!
//! It shares no transition relation with the search, so that a witness that it replays is believed for good reason; and it
//! plays a single automaton in a harness ([`Player`](crate::Player)).

use std::fmt;

use hrdsl_ir::{
    EventId, Expr, Program, Value,
    expr::EvalError,
    ta::{Automaton, ClockConstraint, ClockId, ClockOp, Edge, LocationId, LocationKind, Sync, Update, Var},
};

use crate::{
    Counter, Limit, ModelError, Witness, WitnessStep,
    error::EdgeName,
    query::{View, any_matches},
    semantics::{Binders, Move, argument_fault, bad_argument, bind, choices, range_fault, stored},
};

/// The state of some automata at an instant; time is in ticks.
#[derive(Clone)]
pub(crate) struct Machine<'p> {
    program: &'p Program,
    pub(crate) members: Vec<&'p Automaton>,
    pub(crate) location: Vec<LocationId>,
    shared: Vec<i64>,
    own: Vec<Vec<i64>>,
    /// When each clock was last zero.
    reset_at: Vec<Vec<i128>>,
    pub(crate) now: i128,
    /// Ticks in a nanosecond.
    ticks: i128,
}

impl<'p> Machine<'p> {
    /// INVARIANT: the automata have passed the check.
    pub(crate) fn new(program: &'p Program, members: &[&'p Automaton], ticks: i64) -> Self {
        Self {
            program,
            location: members.iter().map(|a| a.initial).collect(),
            shared: program.shared.iter().map(|v| v.init).collect(),
            own: members.iter().map(|a| a.vars.iter().map(|v| v.init).collect()).collect(),
            reset_at: members.iter().map(|a| vec![0; a.clocks.len()]).collect(),
            members: members.to_vec(),
            now: 0,
            ticks: i128::from(ticks),
        }
    }

    pub(crate) fn kind(&self, member: usize) -> LocationKind {
        self.members[member].locations[usize::from(self.location[member].0)].kind
    }

    pub(crate) fn invariant(&self, member: usize) -> &'p [ClockConstraint] {
        let automaton: &'p Automaton = self.members[member];
        &automaton.locations[usize::from(self.location[member].0)].invariant
    }

    /// Whether clock constraints hold now.
    pub(crate) fn holds(&self, member: usize, constraints: &[ClockConstraint]) -> bool {
        let clock = |c: ClockId| self.now - self.reset_at[member][usize::from(c.0)];
        constraints.iter().all(|c| {
            let value = clock(c.clock) - c.minus.map_or(0, clock);
            let bound = i128::from(c.bound.nanos) * self.ticks;
            match c.op {
                ClockOp::Lt => value < bound,
                ClockOp::Le => value <= bound,
                ClockOp::Eq => value == bound,
                ClockOp::Ge => value >= bound,
                ClockOp::Gt => value > bound,
            }
        })
    }

    /// When a clock was last zero, in ticks.
    pub(crate) fn zero_at(&self, member: usize, clock: ClockId) -> i128 {
        self.reset_at[member][usize::from(clock.0)]
    }

    /// Whether the edge leaves the current location and its data guard holds; clocks are not looked at.
    pub(crate) fn guard(&self, m: &Move) -> Result<bool, ModelError> {
        let edge = self.edge(m);
        if edge.from != self.location[m.automaton] {
            return Ok(false);
        }
        let Some(guard) = &edge.guard else { return Ok(true) };
        let value = self.eval(m, guard).and_then(|v| v.as_bool().ok_or(EvalError::Type));
        value.map_err(|e| self.fault(m, e))
    }

    /// The arguments that a sending edge sends.
    pub(crate) fn arguments(
        &self,
        m: &Move,
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

    /// Goes along an edge: its updates in order, then its target.
    pub(crate) fn take(&mut self, m: &Move) -> Result<(), ModelError> {
        let edge = self.edge(m);
        self.location[m.automaton] = edge.to;
        for u in &edge.updates {
            match u {
                Update::Reset { clock, .. } => self.reset_at[m.automaton][usize::from(clock.0)] = self.now,
                Update::Assign { place, value } => self.assign(m, usize::from(place.slot), value)?,
                Update::Call { .. } => {}
            }
        }
        Ok(())
    }

    fn assign(&mut self, m: &Move, slot: usize, value: &Expr) -> Result<(), ModelError> {
        let program = self.program;
        let var = match program.shared.get(slot) {
            Some(var) => var,
            None => &self.members[m.automaton].vars[slot - program.shared.len()],
        };
        let n = self.eval(m, value).and_then(|v| stored(var, v)).map_err(|e| self.fault(m, e))?;
        if !(var.lo..=var.hi).contains(&n) {
            return Err(range_fault(self.names(m), var, n));
        }
        match self.shared.get_mut(slot) {
            Some(place) => *place = n,
            None => self.own[m.automaton][slot - program.shared.len()] = n,
        }
        Ok(())
    }

    pub(crate) fn edge(&self, m: &Move) -> &'p Edge {
        let automaton: &'p Automaton = self.members[m.automaton];
        &automaton.edges[m.edge]
    }

    fn eval(&self, m: &Move, e: &Expr) -> Result<Value, EvalError> {
        let own = &self.members[m.automaton].vars;
        e.eval(&|i| {
            let i = usize::from(i);
            if let Some(var) = self.program.shared.get(i) {
                return var.value(self.shared[i]);
            }
            let i = i - self.shared.len();
            match own.get(i) {
                Some(var) => var.value(self.own[m.automaton][i]),
                None => m.binders.get(i - own.len()).copied(),
            }
        })
    }

    /// The variable that a member's expressions call `slot`.
    pub(crate) fn variable(&self, member: usize, slot: usize) -> Option<Value> {
        if let Some(var) = self.program.shared.get(slot) {
            return var.value(self.shared[slot]);
        }
        let own = slot - self.shared.len();
        let n = *self.own.get(member)?.get(own)?;
        self.members[member].vars[own].value(n)
    }

    fn names(&self, m: &Move) -> Box<EdgeName> {
        EdgeName::of(self.members[m.automaton], self.edge(m))
    }

    fn fault(&self, m: &Move, error: EvalError) -> ModelError {
        ModelError::Evaluation { edge: self.names(m), error }
    }

    /// The ways in which an automaton can receive an event now: data and clock guards hold.
    pub(crate) fn receptions(
        &self,
        member: usize,
        event: EventId,
        args: &[Value],
    ) -> Result<Vec<Move>, ModelError> {
        let mut out = Vec::new();
        for (i, edge) in self.members[member].edges.iter().enumerate() {
            let Sync::Receive { event: wanted, args: pattern } = &edge.sync else { continue };
            let mut bound = Binders::new();
            let here = edge.from == self.location[member] && *wanted == event;
            if !here || pattern.len() != args.len() || !bind(pattern, args, &mut bound) {
                continue;
            }
            if !self.holds(member, &edge.clock_guard) {
                continue;
            }
            for mut binders in choices(&edge.selects) {
                binders.extend_from_slice(&bound);
                let m = Move { automaton: member, edge: i, binders };
                if self.guard(&m)? {
                    out.push(m);
                }
            }
        }
        Ok(out)
    }
}

/// Why a run is not one of the network.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Mismatch {
    step: usize,
    why: String,
}

impl fmt::Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "step {}: {}", self.step, self.why)
    }
}

/// The discrete state after a replay.
pub(crate) struct Final<'p> {
    locations: Vec<LocationId>,
    /// Variables and the numbers that they keep.
    slots: Vec<(&'p Var, i64)>,
    counters: Vec<i64>,
    /// No automaton is in a committed location.
    pub(crate) settled: bool,
}

impl Final<'_> {
    /// Locations, variables, counters, in the search's order.
    pub(crate) fn numbers(&self) -> Vec<i64> {
        let locations = self.locations.iter().map(|l| i64::from(l.0));
        locations.chain(self.slots.iter().map(|s| s.1)).chain(self.counters.iter().copied()).collect()
    }
}

impl View for Final<'_> {
    fn location(&self, automaton: usize) -> Option<LocationId> {
        self.locations.get(automaton).copied()
    }

    fn slot(&self, slot: u16) -> Option<Value> {
        let (var, n) = self.slots.get(usize::from(slot))?;
        var.value(*n)
    }

    fn counter(&self, counter: usize) -> i64 {
        self.counters.get(counter).copied().unwrap_or(0)
    }
}

/// Runs a witness and checks each rule of the semantics on the way.
pub(crate) fn replay<'p>(
    program: &'p Program,
    automata: &[&'p Automaton],
    counters: &[Counter],
    limits: &[Limit],
    witness: &Witness,
) -> Result<Final<'p>, Mismatch> {
    let mut machine = Machine::new(program, automata, witness.ticks);
    let mut counted = vec![0; counters.len()];
    let mut used = vec![0; limits.len()];
    if let Err(why) = invariants(&machine) {
        return Err(Mismatch { step: 0, why });
    }
    for (step, s) in witness.steps.iter().enumerate() {
        replay_step(&mut machine, s).map_err(|why| Mismatch { step, why })?;
        let Some((event, args)) = &s.event else { continue };
        for (n, counter) in counted.iter_mut().zip(counters) {
            if any_matches(&counter.patterns, *event, args) && *n < counter.cap {
                *n += 1;
            }
        }
        for (n, limit) in used.iter_mut().zip(limits) {
            *n += i64::from(any_matches(&limit.patterns, *event, args));
            if *n > limit.at_most {
                return Err(Mismatch { step, why: "an event happens more often than its limit".into() });
            }
        }
    }
    let shared = program.shared.iter().zip(&machine.shared);
    let own = automata.iter().zip(&machine.own);
    let own = own.flat_map(|(a, own)| a.vars.iter().zip(own));
    Ok(Final {
        slots: shared.chain(own).map(|(v, n)| (v, *n)).collect(),
        counters: counted,
        settled: (0..automata.len()).all(|m| machine.kind(m) != LocationKind::Committed),
        locations: machine.location,
    })
}

fn replay_step(machine: &mut Machine, s: &WitnessStep) -> Result<(), String> {
    let time = i128::from(s.time);
    let members = 0..machine.members.len();
    if time < machine.now {
        return Err("time goes back".into());
    }
    if time > machine.now && members.clone().any(|m| machine.kind(m) != LocationKind::Normal) {
        return Err("time passes in an urgent or committed location".into());
    }
    machine.now = time;
    invariants(machine)?;
    let Some((sender, receivers)) = s.moves.split_first() else { return Err("nobody moves".into()) };
    if s.moves.iter().any(|m| machine.members.get(m.automaton).is_none_or(|a| m.edge >= a.edges.len())) {
        return Err("an automaton or edge is not there".into());
    }
    sends(machine, sender, s)?;
    receives(machine, sender.automaton, receivers, s)?;
    let committed = |m: usize| machine.kind(m) == LocationKind::Committed;
    if members.clone().any(committed) && !s.moves.iter().any(|m| committed(m.automaton)) {
        return Err("a committed location waits".into());
    }
    for m in &s.moves {
        machine.take(m).map_err(|e| e.to_string())?;
    }
    invariants(machine)
}

fn invariants(machine: &Machine) -> Result<(), String> {
    match (0..machine.members.len()).find(|&m| !machine.holds(m, machine.invariant(m))) {
        None => Ok(()),
        Some(m) => Err(format!("the invariant of `{}` does not hold", machine.members[m].name)),
    }
}

fn sends(machine: &Machine, sender: &Move, s: &WitnessStep) -> Result<(), String> {
    let edge = machine.edge(sender);
    let chosen = choices(&edge.selects).contains(&sender.binders);
    if !chosen || !machine.holds(sender.automaton, &edge.clock_guard) {
        return Err("the sender's selects or clock guard do not hold".into());
    }
    if !machine.guard(sender).map_err(|e| e.to_string())? {
        return Err("the sender's guard does not hold".into());
    }
    match (&edge.sync, &s.event) {
        (Sync::Internal, None) => Ok(()),
        (Sync::Send { event, args }, Some((sent, values))) if event == sent => {
            let own = machine.arguments(sender, *event, args).map_err(|e| e.to_string())?;
            let same = own.iter().map(|v| v.key()).eq(values.iter().map(|v| v.key()));
            if same { Ok(()) } else { Err("the sender sends other arguments".into()) }
        }
        (
            Sync::Internal
            | Sync::Send { .. }
            | Sync::Receive { .. }
            | Sync::Offer { .. }
            | Sync::Accept { .. }
            | Sync::Join { .. },
            _,
        ) => Err("the sender's edge sends something else".into()),
    }
}

fn receives(machine: &Machine, sender: usize, receivers: &[Move], s: &WitnessStep) -> Result<(), String> {
    let mut left = receivers;
    for m in (0..machine.members.len()).filter(|&m| m != sender) {
        let can = match &s.event {
            None => Vec::new(),
            Some((event, args)) => machine.receptions(m, *event, args).map_err(|e| e.to_string())?,
        };
        match left.split_first() {
            Some((first, rest)) if first.automaton == m => {
                if !can.contains(first) {
                    return Err(format!("`{}` cannot receive that way", machine.members[m].name));
                }
                left = rest;
            }
            Some(_) | None if can.is_empty() => {}
            Some(_) | None => {
                return Err(format!("`{}` must take part and does not", machine.members[m].name));
            }
        }
    }
    if left.is_empty() { Ok(()) } else { Err("the receivers are out of order".into()) }
}
