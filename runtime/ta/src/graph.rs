//! The plain zone graph of a network: what the searches for liveness, deadlocks, bounds and fastest witnesses walk on.
//!
//! A node is a discrete state and a zone, after time has passed if it may. Unlike the search for goals, which may keep of a
//! zone what can do most, a walk for infinite runs must keep apart what can be told apart: see [`Detail`].

use hrdsl_ir::{
    EventId, Nanos, Value,
    expr::EvalError,
    ta::{ChannelId, FunctionId, LocationId},
};
use smallvec::SmallVec;

use crate::{
    ModelError, StateFormula,
    abstraction::{Bounds, KEEP, NONE, extra, split},
    dbm::{Bound, Dbm},
    federation::{Federation, forget, keep, past},
    network::{Constraint, Model},
    query::{Symbolic, View, as_bounds, nanos},
    semantics::Move,
};

/// What a transition goes over.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Label {
    Internal,
    Event(EventId, Vec<Value>),
    Channel(ChannelId, Vec<Value>),
}

/// `clock := from + plus`, in units; `from` is 0 for none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SetClock {
    pub clock: u16,
    pub from: u16,
    pub plus: i64,
}

/// Something that may happen in a discrete state.
#[derive(Clone)]
pub(crate) struct Action {
    pub label: Label,
    pub moves: SmallVec<[Move; 2]>,
    pub guard: SmallVec<[Constraint; 4]>,
    /// In order.
    pub sets: SmallVec<[SetClock; 4]>,
    /// The discrete state after it; it may be one that the invariants over variables forbid.
    pub target: Result<Vec<i64>, Box<ModelError>>,
}

/// What staying in a discrete state means.
#[derive(Clone, Debug)]
pub(crate) struct Stay {
    pub invariant: Vec<Constraint>,
    /// Time may pass.
    pub waits: bool,
}

impl Stay {
    /// Time may pass for ever.
    pub(crate) fn for_ever(&self) -> bool {
        self.waits && !self.invariant.iter().any(|c| c.i != 0 && c.j == 0 && !c.bound.is_infinite())
    }
}

/// What a walk keeps of zones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Detail {
    /// What is needed to say what can be reached: ExtraLU+.
    Reach,
    /// What tells valuations apart: ExtraM+, which is a bisimulation.
    Tell,
}

/// The zone graph of a network, with what formulas tell apart.
pub(crate) struct Graph<'m, 'p> {
    pub(crate) model: &'m Model<'p>,
    detail: Detail,
    /// Bounds that formulas add everywhere.
    raised: Bounds,
    diagonals: Vec<Constraint>,
    /// With comparisons of clocks: the greatest constant of each clock.
    greatest: Vec<i64>,
    /// Clocks after the network's that only run.
    spare: usize,
}

impl<'m, 'p> Graph<'m, 'p> {
    /// # Errors
    /// If a comparison in a formula has no bound that is known beforehand.
    pub(crate) fn new(
        model: &'m Model<'p>,
        detail: Detail,
        formulas: &[&StateFormula],
        spare: usize,
    ) -> Result<Self, ModelError> {
        let mut graph = Self {
            model,
            detail,
            raised: Bounds::none(model.dim + spare),
            diagonals: model.diagonals(),
            greatest: Vec::new(),
            spare,
        };
        for clock in model.dim..model.dim + spare {
            (graph.raised.lower[clock], graph.raised.upper[clock]) = (NONE, KEEP);
        }
        let mut fault = None;
        for formula in formulas {
            formula.each_clock(&mut |c| match model.span(&c.bound) {
                Ok((lo, hi)) => graph.note(c, lo, hi),
                Err(e) => fault = Some(e),
            });
            if formula.asks_deadlock() {
                graph.detail = Detail::Tell;
            }
        }
        if let Some(e) = fault {
            return Err(e);
        }
        graph.greatest = graph.greatest();
        Ok(graph)
    }

    fn note(&mut self, c: &hrdsl_ir::ta::ClockConstraint, lo: i64, hi: i64) {
        let most = lo.abs().max(hi.abs());
        let clock = |x: hrdsl_ir::ta::ClockId| usize::from(x.0) + 1;
        self.raised.note(clock(c.clock), most);
        let Some(minus) = c.minus else { return };
        self.raised.note(clock(minus), most);
        for bound in lo..=hi {
            for d in as_bounds(c, bound) {
                if !self.diagonals.contains(&d) && !self.diagonals.contains(&d.negated()) {
                    self.diagonals.push(d);
                }
            }
        }
    }

    fn greatest(&self) -> Vec<i64> {
        let mut all = self.model.greatest();
        all.resize(self.dim(), KEEP);
        for (g, l) in all.iter_mut().zip(&self.raised.lower).take(self.model.dim) {
            *g = (*g).max(*l).max(0);
        }
        all
    }

    /// A clock's bounds up to this many units are kept.
    pub(crate) fn keep_up_to(&mut self, clock: usize, most: i64) {
        self.raised.note(clock, most);
        self.greatest = self.greatest();
    }

    /// The greatest constant that a clock is compared with anywhere.
    pub(crate) fn most(&self, clock: usize) -> i64 {
        self.greatest[clock]
    }

    pub(crate) fn dim(&self) -> usize {
        self.model.dim + self.spare
    }

    pub(crate) fn initial(&self) -> Vec<i64> {
        self.model.initial()
    }

    pub(crate) fn actions(&self, state: &[i64]) -> Vec<Action> {
        self.model.actions(state)
    }

    /// `None`: invariants over variables forbid the state.
    ///
    /// # Errors
    /// If an invariant has no value.
    pub(crate) fn stay(&self, state: &[i64]) -> Result<Option<Stay>, ModelError> {
        self.model.stay(state)
    }

    /// The clocks at the start, before time passes.
    ///
    /// # Errors
    /// If the invariants do not hold at the start.
    pub(crate) fn start(&self) -> Result<(Vec<i64>, Stay, Dbm), ModelError> {
        let state = self.initial();
        let stay = self.stay(&state)?.ok_or(ModelError::Initial)?;
        let mut zone = Dbm::zero(self.dim());
        if !stay.invariant.iter().all(|c| keep(&mut zone, *c)) {
            return Err(ModelError::Initial);
        }
        Ok((state, stay, zone))
    }

    /// Lets time pass, as far as it may.
    pub(crate) fn wait(&self, stay: &Stay, zone: &mut Dbm) {
        if stay.waits {
            zone.up();
            // Not empty: it has what was there before.
            stay.invariant.iter().for_each(|c| {
                keep(zone, *c);
            });
        }
    }

    /// The clocks right after a transition, before time passes; `false`: it is not possible.
    pub(crate) fn take(&self, action: &Action, target: &Stay, zone: &mut Dbm) -> bool {
        if !action.guard.iter().all(|c| keep(zone, *c)) {
            return false;
        }
        action.sets.iter().for_each(|s| set(zone, *s));
        target.invariant.iter().all(|c| keep(zone, *c))
    }

    /// Widens a zone to one of finitely many, in one or several pieces.
    pub(crate) fn widen(&self, state: &[i64], zone: Dbm, out: &mut dyn FnMut(Dbm)) {
        let mut zone = zone;
        // A clock that only runs is kept from below: who comes later can do no more.
        for clock in self.model.dim..self.dim() {
            for j in (0..self.dim()).filter(|&j| j != clock) {
                zone.put(clock, j, Bound::INFINITY);
            }
        }
        if !self.diagonals.is_empty() {
            return split(&zone, &self.diagonals, &self.greatest, out);
        }
        let mut bounds = Bounds::none(self.dim());
        self.model.bounds(state, &mut bounds);
        bounds.raise(&self.raised);
        if self.detail == Detail::Tell {
            let spare: Vec<(i64, i64)> =
                (self.model.dim..self.dim()).map(|x| (bounds.lower[x], bounds.upper[x])).collect();
            bounds.level();
            for (x, (l, u)) in (self.model.dim..).zip(spare) {
                (bounds.lower[x], bounds.upper[x]) = (l, u);
            }
        }
        extra(&mut zone, &bounds);
        out(zone);
    }

    pub(crate) fn here<'s>(&'s self, state: &'s [i64]) -> Here<'s, 'm, 'p> {
        Here { graph: self, state }
    }

    /// The part of a zone from which no transition is possible, now or after any delay. The zone must keep the invariant.
    ///
    /// # Errors
    /// If an invariant has no value.
    pub(crate) fn deadlocked(&self, state: &[i64], zone: &Dbm) -> Result<Federation, ModelError> {
        let Some(stay) = self.stay(state)? else { return Ok(Federation::empty()) };
        let mut left = Federation::of(zone.clone());
        for action in self.actions(state) {
            if left.is_empty() {
                break;
            }
            if let Some(from) = self.leaves(&action, &stay)? {
                left = left.minus(&from);
            }
        }
        Ok(left)
    }

    /// From where a transition is possible, now or later.
    fn leaves(&self, action: &Action, stay: &Stay) -> Result<Option<Dbm>, ModelError> {
        let mut zone = Dbm::universe(self.dim());
        // A transition that is a fault is one: the search says so.
        if let Ok(target) = &action.target {
            let Some(there) = self.stay(target)? else { return Ok(None) };
            if !there.invariant.iter().all(|c| keep(&mut zone, *c)) {
                return Ok(None);
            }
            for s in action.sets.iter().rev() {
                if !unset(&mut zone, *s) {
                    return Ok(None);
                }
            }
        }
        if !action.guard.iter().chain(&stay.invariant).all(|c| keep(&mut zone, *c)) {
            return Ok(None);
        }
        Ok(Some(if stay.waits { past(&zone) } else { zone }))
    }
}

/// Sets a clock to a value, or to another clock's and more.
pub(crate) fn set(zone: &mut Dbm, s: SetClock) {
    let (x, y) = (usize::from(s.clock), usize::from(s.from));
    if zone.is_empty() {
        return;
    }
    if x != y {
        *zone = forget(zone, x);
        zone.constrain(x, y, Bound::le(s.plus));
        zone.constrain(y, x, Bound::le(-s.plus));
        return;
    }
    // It grows by a constant.
    for k in (0..zone.dim()).filter(|&k| k != x) {
        let (row, column) = (zone.at(x, k), zone.at(k, x));
        zone.put(x, k, row.plus(Bound::le(s.plus)));
        zone.put(k, x, column.plus(Bound::le(-s.plus)));
    }
    // INVARIANT: no clock is negative, whatever `plus` is.
    zone.constrain(0, x, Bound::LE_ZERO);
}

/// What an assignment of a clock brings into the zone; `false`: nothing.
fn unset(zone: &mut Dbm, s: SetClock) -> bool {
    let (x, y) = (usize::from(s.clock), usize::from(s.from));
    if x == y {
        set(zone, SetClock { plus: -s.plus, ..s });
        return !zone.is_empty();
    }
    if !zone.constrain(x, y, Bound::le(s.plus)) || !zone.constrain(y, x, Bound::le(-s.plus)) {
        return false;
    }
    *zone = forget(zone, x);
    true
}

/// A discrete state as formulas see it.
pub(crate) struct Here<'s, 'm, 'p> {
    graph: &'s Graph<'m, 'p>,
    state: &'s [i64],
}

impl View for Here<'_, '_, '_> {
    fn location(&self, automaton: usize) -> Option<LocationId> {
        self.graph.model.members.get(automaton)?;
        u16::try_from(self.state[automaton]).ok().map(LocationId)
    }

    fn slot(&self, slot: u16) -> Option<Value> {
        let slot = usize::from(slot);
        let model = self.graph.model;
        if slot < model.slots.len() { model.slot_value(self.state, slot) } else { None }
    }

    fn counter(&self, counter: usize) -> i64 {
        self.state[self.graph.model.counter_at(counter)]
    }

    fn apply(&self, function: FunctionId, args: &[Value]) -> Result<Value, EvalError> {
        self.graph.model.apply(self.state, function, args)
    }
}

impl Symbolic for Here<'_, '_, '_> {
    fn unit(&self) -> Nanos {
        self.graph.model.unit
    }

    fn deadlocked(&self, zone: &Dbm) -> Result<Federation, ModelError> {
        self.graph.deadlocked(self.state, zone)
    }
}

// ── What the network tells ──

impl Model<'_> {
    fn actions(&self, state: &[i64]) -> Vec<Action> {
        self.candidates(state)
            .into_iter()
            .map(|c| Action {
                label: c.event.map_or(Label::Internal, |(e, args)| Label::Event(e, args)),
                moves: c.moves,
                guard: c.guard,
                sets: c.resets.iter().map(|&clock| SetClock { clock, from: 0, plus: 0 }).collect(),
                target: c.target,
            })
            .collect()
    }

    fn stay(&self, state: &[i64]) -> Result<Option<Stay>, ModelError> {
        Ok(Some(Stay { invariant: self.invariant(state).collect(), waits: self.may_delay(state) }))
    }

    fn bounds(&self, state: &[i64], out: &mut Bounds) {
        self.extrapolation.bounds(&state[..self.members.len()], out);
    }

    fn diagonals(&self) -> Vec<Constraint> {
        self.extrapolation.diagonals()
    }

    /// The greatest constant of each clock.
    fn greatest(&self) -> Vec<i64> {
        self.extrapolation.greatest(self.dim)
    }

    /// The least and greatest that a time of a formula can be, in units.
    fn span(&self, time: &hrdsl_ir::ta::Time) -> Result<(i64, i64), ModelError> {
        let n = nanos(time, &NoSlots).map_err(crate::query::no_value)?;
        Ok((n / self.unit, n / self.unit))
    }

    fn apply(&self, _: &[i64], _: FunctionId, _: &[Value]) -> Result<Value, EvalError> {
        Err(EvalError::Type)
    }
}

struct NoSlots;

impl hrdsl_ir::expr::Scope for NoSlots {
    fn var(&self, _: u16) -> Option<Value> {
        None
    }
}
