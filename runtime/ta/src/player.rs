//! One automaton alone in a harness, in virtual time: it plays its actor as soon as its model lets it.
//!
//! The policy is urgency: whenever an internal or sending edge is enabled, the first in source order is taken at once, so
//! the model shows its fastest behaviour. A strict lower bound is met one nanosecond after it.
//!
//! The player has its own copy of the program's shared variables: what other automata do to theirs it does not see.

use hrdsl_ir::{
    EventId, Nanos, Program, Value,
    ta::{AutomatonId, ClockConstraint, ClockOp, LocationId, LocationKind, Sync, Update},
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::{
    ModelError, check,
    concrete::Machine,
    semantics::{Binders, Move, bind, choices},
};

/// More edges than this at one instant are taken for a run without end.
const ZENO: u32 = 10_000;

/// An automaton that plays its actor.
pub struct Player<'p> {
    machine: Machine<'p>,
    /// When the current location was entered.
    entered: i128,
    /// Edges taken at the current instant.
    taken: u32,
    /// Draws the selects; without it they take the first value that the guard allows.
    rng: Option<ChaCha8Rng>,
    /// The program was not well formed; each call gives this back.
    fault: Option<ModelError>,
}

impl<'p> Player<'p> {
    /// The automaton at its initial location at time 0; selects take the first value that the guard allows.
    #[must_use]
    pub fn new(program: &'p Program, automaton: AutomatonId) -> Self {
        let (members, fault) = match check::automaton(program, automaton) {
            Ok(a) => (vec![a], None),
            Err(e) => (Vec::new(), Some(e)),
        };
        Self { machine: Machine::new(program, &members, 1), entered: 0, taken: 0, rng: None, fault }
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
            let Sync::Receive { event: wanted, args: pattern } = &edge.sync else { continue };
            let mut bound = Binders::new();
            if *wanted != event || pattern.len() != args.len() || !bind(pattern, args, &mut bound) {
                continue;
            }
            if let Some(m) = self.enabled(e, &bound)? {
                return self.take(&m);
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
        while let Some(m) = self.next_move()? {
            match &self.machine.edge(&m).sync {
                Sync::Send { event, args } => out.push((*event, self.machine.arguments(&m, *event, args)?)),
                Sync::Internal
                | Sync::Receive { .. }
                | Sync::Offer { .. }
                | Sync::Accept { .. }
                | Sync::Join { .. } => {}
            }
            self.take(&m)?;
        }
        Ok(())
    }

    /// The earliest time, from the last call on, at which an internal or sending edge is enabled if nothing is received,
    /// and until which the invariant lets time pass. `None`: only an event of others can move it.
    #[must_use]
    pub fn next_wake(&self) -> Option<Nanos> {
        let automaton = self.machine.members.first()?;
        let times = automaton.edges.iter().enumerate().filter_map(|(e, edge)| {
            let active = match edge.sync {
                Sync::Internal | Sync::Send { .. } => true,
                Sync::Receive { .. } | Sync::Offer { .. } | Sync::Accept { .. } | Sync::Join { .. } => false,
            };
            if !active || edge.from != self.machine.location[0] {
                return None;
            }
            // A guard without a value wakes it, too, so that `run` can report it.
            let possible = choices(&edge.selects)
                .into_iter()
                .any(|binders| self.machine.guard(&Move { automaton: 0, edge: e, binders }).unwrap_or(true));
            possible.then(|| self.earliest(e)).flatten()
        });
        times.min().and_then(|t| Nanos::try_from(t).ok())
    }

    /// Lets time pass. Times before the last call count as that.
    fn advance(&mut self, now: Nanos) -> Result<(), ModelError> {
        if let Some(fault) = &self.fault {
            return Err(fault.clone());
        }
        let now = i128::from(now);
        if now > self.machine.now {
            self.machine.now = now;
            self.taken = 0;
        }
        let stays = match self.machine.kind(0) {
            LocationKind::Normal => true,
            LocationKind::Urgent | LocationKind::Committed => self.machine.now == self.entered,
        };
        if !stays || !self.machine.holds(0, self.machine.invariant(0)) {
            let (automaton, location) = self.names();
            return Err(ModelError::Timelock { automaton, location });
        }
        Ok(())
    }

    fn next_move(&mut self) -> Result<Option<Move>, ModelError> {
        for e in 0..self.machine.members[0].edges.len() {
            match self.machine.members[0].edges[e].sync {
                Sync::Receive { .. } | Sync::Offer { .. } | Sync::Accept { .. } | Sync::Join { .. } => {}
                Sync::Internal | Sync::Send { .. } => {
                    if let Some(m) = self.enabled(e, &[])? {
                        return Ok(Some(m));
                    }
                }
            }
        }
        Ok(None)
    }

    /// The edge with the chosen selects, if it is enabled now and its target's invariant will hold.
    fn enabled(&mut self, edge: usize, bound: &[Value]) -> Result<Option<Move>, ModelError> {
        let e = &self.machine.members[0].edges[edge];
        if e.from != self.machine.location[0]
            || !self.machine.holds(0, &e.clock_guard)
            || !self.may_enter(edge)
        {
            return Ok(None);
        }
        let mut open = Vec::new();
        for mut binders in choices(&e.selects) {
            binders.extend_from_slice(bound);
            let m = Move { automaton: 0, edge, binders };
            if self.machine.guard(&m)? {
                open.push(m);
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

    fn take(&mut self, m: &Move) -> Result<(), ModelError> {
        self.taken += 1;
        if self.taken > ZENO {
            let (automaton, location) = self.names();
            return Err(ModelError::Zeno { automaton, location });
        }
        self.machine.take(m)?;
        self.entered = self.machine.now;
        Ok(())
    }

    fn names(&self) -> (String, String) {
        let a = self.machine.members[0];
        (a.name.clone(), a.locations[usize::from(self.machine.location[0].0)].name.clone())
    }

    /// Whether the target's invariant holds after the edge's resets, if it is taken now.
    fn may_enter(&self, edge: usize) -> bool {
        let now = self.machine.now;
        let (lo, hi) = self.interval(edge, &self.target(edge), (now, now), true);
        lo <= hi
    }

    fn target(&self, edge: usize) -> Vec<ClockConstraint> {
        let a = self.machine.members[0];
        a.locations[usize::from(a.edges[edge].to.0)].invariant.clone()
    }

    /// The earliest time from now on at which an edge's clock guard holds, the location's invariant still holds, and the
    /// target's will.
    fn earliest(&self, edge: usize) -> Option<i128> {
        let now = self.machine.now;
        let last = match self.machine.kind(0) {
            LocationKind::Normal => i128::MAX,
            LocationKind::Urgent | LocationKind::Committed => self.entered,
        };
        let guard = &self.machine.members[0].edges[edge].clock_guard;
        let mut window = self.interval(edge, guard, (now, last), false);
        window = self.interval(edge, self.machine.invariant(0), window, false);
        window = self.interval(edge, &self.target(edge), window, true);
        (window.0 <= window.1).then_some(window.0)
    }

    /// Narrows an interval of times to those at which the constraints hold: before the edge, or `after` its resets.
    fn interval(
        &self,
        edge: usize,
        constraints: &[ClockConstraint],
        (mut lo, mut hi): (i128, i128),
        after: bool,
    ) -> (i128, i128) {
        let resets = |clock| {
            after
                && self.machine.members[0].edges[edge].updates.iter().any(|u| match u {
                    Update::Assign { .. } | Update::Call { .. } => false,
                    Update::Reset { clock: c, .. } => *c == clock,
                })
        };
        for c in constraints {
            // As `sign · t` against `bound`: a clock is the time since its reset, or 0 if this edge resets it.
            let (mut sign, mut bound) = (0, i128::from(c.bound.nanos));
            for (clock, factor) in [(Some(c.clock), 1), (c.minus, -1)] {
                let Some(clock) = clock.filter(|&clock| !resets(clock)) else { continue };
                sign += factor;
                bound += factor * self.machine.zero_at(0, clock);
            }
            let (least, most) = allowed(c.op, bound);
            match sign {
                0 if least <= 0 && 0 <= most => {}
                0 => return (1, 0),
                1 => (lo, hi) = (lo.max(least), hi.min(most)),
                // `0 - t`, the clock of `minus` being the one that runs
                _ => {
                    let negated = |n: i128| if n == i128::MIN { i128::MAX } else { -n };
                    (lo, hi) = (lo.max(negated(most)), hi.min(negated(least)));
                }
            }
        }
        (lo, hi)
    }
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
