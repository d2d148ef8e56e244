//! One automaton alone in a harness, in virtual time: it plays its actor as soon as its model lets it.
//!
//! The policy is urgency: whenever an internal or sending edge is enabled, the first in source order is taken at once, so
//! the model shows its fastest behaviour. A strict lower bound is met one nanosecond after it.
//!
//! The player has its own copy of the program's shared variables and clocks: what other automata do to theirs it does not
//! see. Since it is alone, it never takes edges over binary synchronisations and multi-way channels; an offer over a broadcast channel it
//! takes as an internal edge, for nobody hears it.

use hrdsl_ir::{
    EventId, Nanos, Program, Value,
    expr::EvalError,
    ta::{
        AutomatonId, ChannelKind, ClockConstraint, ClockId, ClockOp, EdgeAssignment, LocationId,
        LocationKind, SyncLabel,
    },
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::{
    network::{
        error::ModelError,
        selects::{BinderValues, bind, choices},
        semantics::AutomatonMove,
        well_formed,
    },
    witness::concrete::ConcreteInterpreter,
};

/// More edges than this at one instant are taken for a run without end.
const ZENO: u32 = 10_000;

/// An automaton that plays its actor.
pub struct VirtualTimePlayer<'p> {
    machine: ConcreteInterpreter<'p>,
    /// When the current location was entered.
    entered: i128,
    /// Edges taken at the current instant.
    taken: u32,
    /// Draws the selects; without it they take the first value that the guard allows.
    rng: Option<ChaCha8Rng>,
    /// The program was not well formed; each call gives this back.
    fault: Option<ModelError>,
}

impl<'p> VirtualTimePlayer<'p> {
    /// The automaton at its initial location at time 0; selects take the first value that the guard allows.
    #[must_use]
    pub fn new(program: &'p Program, automaton: AutomatonId) -> Self {
        let (members, fault) = match well_formed::automaton(program, automaton) {
            Ok(a) => (vec![a], None),
            Err(e) => (Vec::new(), Some(e)),
        };
        Self {
            machine: ConcreteInterpreter::new(program, &members, 1),
            entered: 0,
            taken: 0,
            rng: None,
            fault,
        }
    }

    /// As [`new`](Self::new), but selects are drawn, evenly among the values that the guard allows.
    #[must_use]
    pub fn seeded(program: &'p Program, automaton: AutomatonId, seed: u64) -> Self {
        Self { rng: Some(ChaCha8Rng::seed_from_u64(seed)), ..Self::new(program, automaton) }
    }

    /// Where it is; `None` if the automaton is malformed.
    #[must_use]
    pub fn location(&self) -> Option<LocationId> {
        self.machine.location.first().copied()
    }

    /// The value of a variable; slots count the shared variables, then the automaton's own.
    #[must_use]
    pub fn variable(&self, slot: u16) -> Option<Value> {
        self.machine.variable(0, usize::from(slot))
    }

    /// An event of another player happened: takes the first enabled receiving edge in source order, if any.
    ///
    /// # Errors
    /// If the model is at fault: no value, out of range, or stuck in a location that it had to leave.
    pub fn receive(&mut self, event: EventId, args: &[Value], now: Nanos) -> Result<(), ModelError> {
        self.advance(now)?;
        for e in 0..self.machine.members[0].edges.len() {
            let edge = &self.machine.members[0].edges[e];
            let SyncLabel::Receive { event: wanted, args: pattern } = &edge.sync else { continue };
            let mut bound = BinderValues::new();
            if *wanted != event || pattern.len() != args.len() || !bind(pattern, args, &mut bound) {
                continue;
            }
            if let Some(edge) = self.enabled(e, &bound)? {
                return self.go(edge);
            }
        }
        Ok(())
    }

    /// Takes internal and sending edges as long as one is enabled now; what they send is added to `out`, in order.
    ///
    /// # Errors
    /// If the model is at fault: no value, out of range, stuck, or edges without end at one instant.
    pub fn run(&mut self, now: Nanos, out: &mut Vec<(EventId, Vec<Value>)>) -> Result<(), ModelError> {
        self.advance(now)?;
        while let Some(edge) = self.next_move()? {
            if let Some((event, args)) = self.machine.edge(&edge.step).sync.as_send() {
                out.push((event, self.machine.arguments(&edge.step, event, args)?));
            }
            self.go(edge)?;
        }
        Ok(())
    }

    /// The earliest time, from the last call on, at which an internal or sending edge is enabled if nothing is received,
    /// and until which the invariant lets time pass. `None`: only an event of others can move it.
    #[must_use]
    pub fn next_wake(&self) -> Option<Nanos> {
        let automaton = self.machine.members.first()?;
        let mut least: Option<i128> = None;
        for (e, edge) in automaton.edges.iter().enumerate() {
            if edge.from != self.machine.location[0] || !self.is_active(&edge.sync) {
                continue;
            }
            for binders in choices(&edge.selects) {
                let m = AutomatonMove { automaton: 0, edge: e, binders };
                // A guard without a value wakes it, too, so that `run` can report it.
                if self.machine.guard(&m).unwrap_or(true)
                    && let Some(t) = self.earliest(&m)
                {
                    least = Some(least.map_or(t, |l| l.min(t)));
                }
            }
        }
        least.and_then(|t| Nanos::try_from(t).ok())
    }

    /// Whether it can take such an edge without having received anything.
    fn is_active(&self, sync: &SyncLabel) -> bool {
        match sync {
            SyncLabel::Internal | SyncLabel::Send { .. } => true,
            SyncLabel::Offer { channel, .. } => {
                self.machine.channel(*channel).is_some_and(|c| c.kind == ChannelKind::Broadcast)
            }
            SyncLabel::Receive { .. } | SyncLabel::Accept { .. } | SyncLabel::Join { .. } => false,
        }
    }

    /// Lets time pass. Times before the last call count as that.
    fn advance(&mut self, now: Nanos) -> Result<(), ModelError> {
        if let Some(fault) = &self.fault {
            return Err(fault.clone());
        }
        let now = i128::from(now);
        if now > self.machine.now {
            self.machine.advance(now);
            self.taken = 0;
        }
        let stays = match self.machine.kind(0) {
            LocationKind::Normal => true,
            LocationKind::Urgent | LocationKind::Committed => self.machine.now == self.entered,
        };
        if !stays || !self.machine.invariant_holds(0)? {
            let (automaton, location) = self.names();
            return Err(ModelError::Timelock { automaton, location });
        }
        Ok(())
    }

    fn next_move(&mut self) -> Result<Option<EnabledEdge<'p>>, ModelError> {
        for e in 0..self.machine.members[0].edges.len() {
            if self.is_active(&self.machine.members[0].edges[e].sync)
                && let Some(edge) = self.enabled(e, &[])?
            {
                return Ok(Some(edge));
            }
        }
        Ok(None)
    }

    /// The edge with the chosen selects, if it is enabled now and its target's invariant will hold.
    fn enabled(&mut self, edge: usize, bound: &[Value]) -> Result<Option<EnabledEdge<'p>>, ModelError> {
        let e = &self.machine.members[0].edges[edge];
        if e.from != self.machine.location[0] {
            return Ok(None);
        }
        let mut open = Vec::new();
        for mut binders in choices(&e.selects) {
            binders.extend_from_slice(bound);
            let step = AutomatonMove { automaton: 0, edge, binders };
            // First what the clocks forbid, so that a fault counts only where they do not.
            if !self.machine.clock_guard(&step)? || !self.machine.guard(&step)? {
                continue;
            }
            if let Some(after) = self.after(&step)? {
                open.push(EnabledEdge { step, after });
                if self.rng.is_none() {
                    break;
                }
            }
        }
        let pick = match &mut self.rng {
            Some(rng) if open.len() > 1 => rng.random_range(0..open.len()),
            Some(_) | None => 0,
        };
        Ok(if open.is_empty() { None } else { Some(open.swap_remove(pick)) })
    }

    /// What the edge leads to now; `None`: the target's invariant forbids it.
    fn after(&self, m: &AutomatonMove) -> Result<Option<ConcreteInterpreter<'p>>, ModelError> {
        let now = self.machine.now;
        // The clocks first: if they forbid the edge, its updates have no faults.
        let clocks =
            self.zeros_after(m).and_then(|zeros| self.window(&self.target(m), &zeros, m, (now, now)));
        if clocks.is_ok_and(|(lo, hi)| lo > hi) && !self.depends(m) {
            return Ok(None);
        }
        let mut after = self.machine.clone();
        after.take(m)?;
        Ok(after.broken_invariant()?.is_none().then_some(after))
    }

    /// Whether the target's bounds on clocks have variables, which the edge may change.
    fn depends(&self, m: &AutomatonMove) -> bool {
        self.target(m).iter().any(|c| !c.bound.terms.is_empty())
    }

    fn go(&mut self, edge: EnabledEdge<'p>) -> Result<(), ModelError> {
        self.taken += 1;
        if self.taken > ZENO {
            let (automaton, location) = self.names();
            return Err(ModelError::Zeno { automaton, location });
        }
        self.machine = edge.after;
        self.entered = self.machine.now;
        Ok(())
    }

    fn names(&self) -> (String, String) {
        let a = self.machine.members[0];
        (a.name.clone(), a.locations[usize::from(self.machine.location[0].0)].name.clone())
    }

    fn target(&self, m: &AutomatonMove) -> Vec<ClockConstraint> {
        let a = self.machine.members[0];
        a.locations[usize::from(self.machine.edge(m).to.0)].invariant.clone()
    }

    /// The earliest time from now on at which an edge's clock guard holds, the location's invariant still holds, and the
    /// target's will. What has no value is left to `run`.
    fn earliest(&self, m: &AutomatonMove) -> Option<i128> {
        let now = self.machine.now;
        let last = match self.machine.kind(0) {
            LocationKind::Normal => i128::MAX,
            LocationKind::Urgent | LocationKind::Committed => self.entered,
        };
        let still: Vec<ClockOrigin> = self.zeros();
        let here = &self.machine.place(0).invariant;
        let mut window = self.window(&self.machine.edge(m).clock_guard, &still, m, (now, last)).ok()?;
        window = self.window(here, &still, m, window).ok()?;
        if window.0 > window.1 {
            return None;
        }
        // Variables and clocks after the edge; what has no value is for `run` to say.
        let mut after = self.machine.clone();
        let Ok(zeros) = self.zeros_after(m) else { return Some(window.0) };
        if after.take(m).is_err() {
            return Some(window.0);
        }
        let place = after.place(0);
        if place.holds.is_some() && !holds_data(&after) {
            return None;
        }
        let after = VirtualTimePlayer { machine: after, entered: 0, taken: 0, rng: None, fault: None };
        let none = AutomatonMove { automaton: 0, edge: m.edge, binders: BinderValues::new() };
        window = after.window(&place.invariant, &zeros, &none, window).ok()?;
        (window.0 <= window.1).then_some(window.0)
    }

    /// The clocks as they are while nothing happens.
    fn zeros(&self) -> Vec<ClockOrigin> {
        let a = self.machine.members[0];
        let count = self.machine.program.clocks.len() + a.clocks.len();
        (0..count)
            .filter_map(|c| u16::try_from(c).ok())
            .map(|c| {
                let zero = self.machine.zero_at(0, ClockId(c));
                let stands = self.machine.place(0).stopped.contains(&ClockId(c));
                ClockOrigin { runs: !stands, at: if stands { self.machine.now - zero } else { zero } }
            })
            .collect()
    }

    /// The clocks after an edge that is taken some time from now on.
    fn zeros_after(&self, m: &AutomatonMove) -> Result<Vec<ClockOrigin>, EvalError> {
        let mut zeros = self.zeros();
        let mut trial = self.machine.clone();
        for u in &self.machine.edge(m).updates {
            match u {
                EdgeAssignment::Assign { .. } | EdgeAssignment::Call { .. } => {
                    trial.update(m, u).map_err(|_| EvalError::Type)?;
                }
                EdgeAssignment::Reset { clock, from, to } => {
                    let to = trial.span(0, &m.binders, to)?;
                    let from = from.map_or(ClockOrigin { runs: false, at: 0 }, |f| zeros[usize::from(f.0)]);
                    let at = if from.runs { from.at - to } else { from.at + to };
                    zeros[usize::from(clock.0)] = ClockOrigin { runs: from.runs, at };
                }
            }
        }
        Ok(zeros)
    }

    /// Narrows an interval of times to those at which the constraints hold.
    fn window(
        &self,
        constraints: &[ClockConstraint],
        zeros: &[ClockOrigin],
        m: &AutomatonMove,
        (mut lo, mut hi): (i128, i128),
    ) -> Result<(i128, i128), EvalError> {
        for c in constraints {
            // As `sign · t` against `bound`: a clock is the time since it was zero, or what the edge sets it to.
            let (mut sign, mut bound) = (0, self.machine.span(0, &m.binders, &c.bound)?);
            for (clock, factor) in [(Some(c.clock), 1), (c.minus, -1)] {
                let Some(clock) = clock else { continue };
                let zero = zeros[usize::from(clock.0)];
                if zero.runs {
                    sign += factor;
                    bound += factor * zero.at;
                } else {
                    bound -= factor * zero.at;
                }
            }
            let (least, most) = allowed(c.op, bound);
            match sign {
                0 if least <= 0 && 0 <= most => {}
                0 => return Ok((1, 0)),
                1 => (lo, hi) = (lo.max(least), hi.min(most)),
                // `0 - t`, the clock of `minus` being the one that runs
                _ => {
                    let negated = |n: i128| if n == i128::MIN { i128::MAX } else { -n };
                    (lo, hi) = (lo.max(negated(most)), hi.min(negated(least)));
                }
            }
        }
        Ok((lo, hi))
    }
}

/// An edge that can be taken, and what it leads to.
struct EnabledEdge<'p> {
    step: AutomatonMove,
    after: ConcreteInterpreter<'p>,
}

/// A clock: one that runs since it was zero `at` that time, or one that is `at` when the edge is taken.
#[derive(Clone, Copy)]
struct ClockOrigin {
    runs: bool,
    at: i128,
}

fn holds_data(machine: &ConcreteInterpreter) -> bool {
    machine.data_holds(0).unwrap_or(true)
}

/// The whole numbers `n` with `n op bound`, as an interval; without an end it is the type's.
fn allowed(op: ClockOp, bound: i128) -> (i128, i128) {
    match op {
        ClockOp::Lt => (i128::MIN, bound - 1),
        ClockOp::Le => (i128::MIN, bound),
        ClockOp::Eq => (bound, bound),
        ClockOp::Ge => (bound, i128::MAX),
        ClockOp::Gt => (bound + 1, i128::MAX),
    }
}
