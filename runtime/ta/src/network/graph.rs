//! The plain zone graph of a network: what the search for liveness walks on, and what formulas are evaluated in.
//!
//! A node is a discrete state and a zone, after time has passed if it may. Unlike the search for goals, which may keep of a
//! zone what can do most, a walk for infinite runs must keep apart what can be told apart: see
//! [`ExtrapolationAbstraction`].

use std::ops::ControlFlow;

use hrdsl_ir::{
    Nanos, Value,
    exec::{self, FunctionTable, VariableMemory},
    expr::{EvalError, EvalScope},
    ta::{FunctionId, LocationId, located_automaton},
};

use crate::{
    network::{
        actions::{DelayCondition, EnabledTransition, PathTransition},
        error::ModelError,
        model::CompiledNetwork,
        number::NumberType,
        parts::{CompiledAutomaton, TimeExpr},
        query::{StateFormula, StateView, SymbolicView, as_bounds},
        semantics::ClockReset,
    },
    zone::{
        constraint::{DifferenceConstraint, keep},
        dbm::{Dbm, DbmBound},
        diagonals::split,
        extrapolation::{ActiveClocks, ExtrapolationAbstraction, LuBounds, NONE, extra_lu},
        federation::{Federation, past},
    },
};

/// The zone graph of a network, with what formulas tell apart.
pub(crate) struct ZoneGraph<'m, 'p> {
    pub(crate) model: &'m CompiledNetwork<'p>,
    /// The greatest constants that formulas add everywhere.
    raised: Vec<i64>,
    diagonals: Vec<DifferenceConstraint>,
    /// With comparisons of clocks: the greatest constant of each clock.
    greatest: Vec<i64>,
}

impl<'m, 'p> ZoneGraph<'m, 'p> {
    /// # Errors
    /// If a comparison in a formula has no bound that is known beforehand.
    pub(crate) fn new(
        model: &'m CompiledNetwork<'p>,
        formulas: &[&StateFormula],
    ) -> Result<Self, ModelError> {
        let mut graph = Self {
            model,
            raised: vec![NONE; model.dim],
            diagonals: model.extrapolation.differences(),
            greatest: Vec::new(),
        };
        let mut fault = None;
        for formula in formulas {
            formula.each_clock(&mut |c| {
                let (lo, hi) = model.span(&c.bound);
                if usize::from(c.clock.0.max(c.minus.map_or(0, |m| m.0))) + 1 >= model.dim {
                    let what = "a formula speaks of a clock that is not there";
                    fault = Some(ModelError::Question(what.into()));
                } else if hi - lo > 64 && c.minus.is_some() {
                    let what = "a difference of clocks is compared with a time of too many values";
                    fault = Some(ModelError::Question(what.into()));
                } else {
                    graph.note(c, lo, hi);
                }
            });
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
        let mut note = |x: usize| self.raised[x] = self.raised[x].max(most);
        note(clock(c.clock));
        let Some(minus) = c.minus else { return };
        note(clock(minus));
        for bound in lo..=hi {
            for d in as_bounds(c, bound) {
                if !self.diagonals.contains(&d) && !self.diagonals.contains(&d.negated()) {
                    self.diagonals.push(d);
                }
            }
        }
    }

    fn greatest(&self) -> Vec<i64> {
        let mut all = self.model.extrapolation.greatest(self.model.dim);
        all.iter_mut().zip(&self.raised).for_each(|(most, raised)| *most = (*most).max(*raised).max(0));
        all
    }

    pub(crate) fn dim(&self) -> usize {
        self.model.dim
    }

    pub(crate) fn initial(&self) -> Vec<i64> {
        self.model.initial()
    }

    pub(crate) fn actions(&self, state: &[i64]) -> Vec<EnabledTransition> {
        self.model.actions(state)
    }

    /// `None`: invariants over variables forbid the state.
    ///
    /// # Errors
    /// If an invariant has no value.
    pub(crate) fn stay(&self, state: &[i64]) -> Result<Option<DelayCondition>, ModelError> {
        self.model.stay(state)
    }

    fn invariant(&self, state: &[i64]) -> Result<Option<Vec<DifferenceConstraint>>, ModelError> {
        let mut all = Vec::new();
        let holds = self.model.invariant(&mut state.to_vec(), &mut Vec::new(), &mut all)?;
        Ok(holds.then_some(all))
    }

    /// The clocks at the start, before time passes.
    ///
    /// # Errors
    /// If the invariants do not hold at the start.
    pub(crate) fn start(&self) -> Result<(Vec<i64>, DelayCondition, Dbm), ModelError> {
        let state = self.initial();
        let stay = self.stay(&state)?.ok_or(ModelError::Initial)?;
        let mut zone = Dbm::zero(self.dim());
        if !stay.invariant.iter().all(|c| keep(&mut zone, *c)) {
            return Err(ModelError::Initial);
        }
        Ok((state, stay, zone))
    }

    /// Lets time pass, as far as it may.
    pub(crate) fn wait(&self, stay: &DelayCondition, zone: &mut Dbm) {
        if stay.waits {
            zone.up_but(&stay.stopped);
            // Not empty: it has what was there before.
            stay.invariant.iter().for_each(|c| {
                keep(zone, *c);
            });
        }
    }

    /// What a transition of a state leads to.
    ///
    /// # Errors
    /// If it is a fault.
    pub(crate) fn target(&self, state: &[i64], taken: &PathTransition) -> Result<Vec<i64>, ModelError> {
        self.model.target(state, taken)
    }

    /// The clocks with which a transition is possible, as far as its guard tells, and the state it leads to.
    ///
    /// # Errors
    /// The fault of the model that the transition is.
    pub(crate) fn guarded<'a>(
        &self,
        action: &'a EnabledTransition,
        zone: &Dbm,
    ) -> Result<Option<(&'a [i64], Dbm)>, ModelError> {
        let fails = |c: &DifferenceConstraint| !zone.meets(usize::from(c.i), usize::from(c.j), c.bound);
        // Quick, where one alone rules it out.
        if action.taken.guard.iter().any(fails) {
            return Ok(None);
        }
        let mut zone = zone.clone();
        if !action.taken.guard.iter().all(|c| keep(&mut zone, *c)) {
            return Ok(None);
        }
        let target = action.target.as_ref().map_err(|e| (**e).clone())?;
        let meets = |c: &DifferenceConstraint| zone.meets(usize::from(c.i), usize::from(c.j), c.bound);
        if let Some((_, fault)) = action.below.iter().find(|(c, _)| meets(c)) {
            return Err(fault.clone());
        }
        Ok(Some((target, zone)))
    }

    /// The clocks with which a transition of the state is this fault: one conjunction for each way to it.
    pub(crate) fn faulty(&self, state: &[i64], error: &ModelError) -> Vec<Vec<DifferenceConstraint>> {
        let mut all = Vec::new();
        for action in self.actions(state) {
            let guard = &action.taken.guard;
            let target = match &action.target {
                Err(e) if **e == *error => {
                    all.push(guard.clone());
                    continue;
                }
                Err(_) => continue,
                Ok(target) => target,
            };
            for (below, _) in action.below.iter().filter(|(_, e)| e == error) {
                all.push(guard.iter().chain([below]).copied().collect());
            }
            if self.stay(target).is_err_and(|e| e == *error) {
                all.push(guard.clone());
            }
        }
        all
    }

    /// From the guarded clocks to those right after the transition, before time passes. `false`: the target's invariant forbids it.
    pub(crate) fn take(&self, action: &EnabledTransition, target: &DelayCondition, zone: &mut Dbm) -> bool {
        if !action.taken.resets.is_empty() {
            *zone = set(zone, &self.sources(&action.taken.resets));
        }
        target.invariant.iter().all(|c| keep(zone, *c))
    }

    /// Zones are split along comparisons of clocks.
    pub(crate) fn splits(&self) -> bool {
        !self.diagonals.is_empty()
    }

    /// All clocks, with what they are compared with from a state on.
    pub(crate) fn frame(&self, state: &[i64], abstraction: ExtrapolationAbstraction) -> ActiveClocks {
        let mut active = ActiveClocks::default();
        self.model.extrapolation.frame(state, abstraction, &mut active);
        let mut all = ActiveClocks {
            clocks: (0..self.dim() as u16).collect(),
            bounds: self.raised.iter().map(|&most| LuBounds { lower: most, upper: most }).collect(),
        };
        for (&clock, lu) in active.clocks.iter().zip(&active.bounds) {
            let bounds = &mut all.bounds[usize::from(clock)];
            *bounds = bounds.join(*lu);
        }
        if abstraction == ExtrapolationAbstraction::Greatest {
            for lu in &mut all.bounds {
                let most = lu.lower.max(lu.upper);
                *lu = LuBounds { lower: most, upper: most };
            }
        }
        all
    }

    /// Widens a zone to one of finitely many, in one or several pieces.
    pub(crate) fn widen(&self, frame: &ActiveClocks, mut zone: Dbm, out: &mut dyn FnMut(Dbm)) {
        if self.splits() {
            return split(&zone, &self.diagonals, &self.greatest, out);
        }
        extra_lu(frame, &mut zone, &mut Vec::new());
        out(zone);
    }

    /// For each clock: what it is after a transition, as a clock before it and what is added.
    fn sources(&self, sets: &[ClockReset]) -> Vec<(usize, i64)> {
        let mut sources: Vec<(usize, i64)> = (0..self.dim()).map(|x| (x, 0)).collect();
        for s in sets {
            sources[usize::from(s.clock)] = (usize::from(s.from), s.by);
        }
        sources
    }

    pub(crate) fn here<'s>(&'s self, state: &'s [i64]) -> DiscreteStateView<'s, 'm, 'p> {
        DiscreteStateView { graph: self, state }
    }

    /// The part of a zone from which no transition is possible, now or after any delay. The zone must keep the invariant.
    ///
    /// # Errors
    /// If an invariant has no value.
    pub(crate) fn deadlocked(&self, state: &[i64], zone: &Dbm) -> Result<Federation, ModelError> {
        let Some(stay) = self.stay(state)? else { return Ok(Federation::empty()) };
        let mut left = Federation::from_zone(zone.clone());
        // Of most states the first few transitions leave nothing.
        self.model.each_action(state, &mut |action| {
            if let Some(from) = self.leaves(&action, &stay) {
                left = left.minus(&from);
            }
            if left.is_empty() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        Ok(left)
    }

    /// As [`deadlocked`](Self::deadlocked), with what is known of the state.
    pub(crate) fn deadlocked_by<'a>(
        &self,
        actions: impl Iterator<Item = &'a EnabledTransition>,
        stay: &DelayCondition,
        zone: &Dbm,
    ) -> Federation {
        let mut left = Federation::from_zone(zone.clone());
        for action in actions {
            if left.is_empty() {
                break;
            }
            if let Some(from) = self.leaves(action, stay) {
                left = left.minus(&from);
            }
        }
        left
    }

    /// From where a transition is possible, now or later.
    ///
    /// A transition that is a fault is one, whether its updates or the invariant that it leads to have no value: whether its guard
    /// ever holds is not known here, and the walk that takes it says so.
    fn leaves(&self, action: &EnabledTransition, stay: &DelayCondition) -> Option<Dbm> {
        let mut zone = Dbm::universe(self.dim());
        if let Ok(target) = &action.target
            && let Ok(there) = self.invariant(target)
        {
            if !there?.iter().all(|c| keep(&mut zone, *c)) {
                return None;
            }
            if !action.taken.resets.is_empty() {
                zone = unset(&zone, &self.sources(&action.taken.resets));
            }
        }
        if !action.taken.guard.iter().chain(&stay.invariant).all(|c| keep(&mut zone, *c)) {
            return None;
        }
        Some(if stay.waits { self.past(stay, &zone) } else { zone })
    }

    /// From where a delay leads into a zone, which is given by bounds of single clocks where some stand still.
    ///
    /// INVARIANT: for some d ≥ 0, lᵣ ≤ vᵣ + d ≤ uᵣ for all clocks that run, and lₛ ≤ vₛ ≤ uₛ for all that stand: without d, that is
    /// vᵣ ≤ uᵣ and vᵣ - vᵣ' ≤ uᵣ - lᵣ', which are bounds of a zone, and the zone's own.
    pub(crate) fn past(&self, stay: &DelayCondition, zone: &Dbm) -> Dbm {
        if stay.stopped.is_empty() {
            return past(zone);
        }
        let mut before = Dbm::universe(zone.dim());
        let stands = |x: usize| x == 0 || stay.stopped.iter().any(|&s| usize::from(s) == x);
        for (i, j) in (0..zone.dim()).flat_map(|i| (0..zone.dim()).map(move |j| (i, j))) {
            let stays = stands(i) == stands(j) || j == 0;
            if i != j && stays && !zone.at(i, j).is_infinite() {
                before.constrain(i, j, zone.at(i, j));
            }
        }
        before
    }
}

/// The clocks after a transition: clock `i` is what `sources[i].0` was, plus `sources[i].1`.
///
/// INVARIANT: `x'ᵢ - x'ⱼ = xₛᵢ - xₛⱼ + bᵢ - bⱼ`, and the matrix was canonical, so it is again.
pub(crate) fn set(zone: &Dbm, sources: &[(usize, i64)]) -> Dbm {
    let mut after = zone.clone();
    if zone.is_empty() {
        return after;
    }
    for (i, &(x, a)) in sources.iter().enumerate() {
        for (j, &(y, b)) in sources.iter().enumerate().filter(|(j, _)| *j != i) {
            after.put(i, j, zone.at(x, y).plus(DbmBound::le(a - b)));
        }
    }
    // No clock is negative; a transition that makes one so is a fault.
    (1..sources.len()).for_each(|i| {
        after.constrain(0, i, DbmBound::LE_ZERO);
    });
    after
}

/// The clocks before a transition that sets them into the zone.
fn unset(zone: &Dbm, sources: &[(usize, i64)]) -> Dbm {
    let mut before = Dbm::universe(zone.dim());
    for (i, &(x, a)) in sources.iter().enumerate() {
        for (j, &(y, b)) in sources.iter().enumerate().filter(|(j, _)| *j != i) {
            let bound = zone.at(i, j).plus(DbmBound::le(b - a));
            if !bound.is_infinite() {
                before.constrain(x, y, bound);
            }
        }
    }
    before
}

/// A discrete state as formulas see it.
pub(crate) struct DiscreteStateView<'s, 'm, 'p> {
    graph: &'s ZoneGraph<'m, 'p>,
    state: &'s [i64],
}

impl StateView for DiscreteStateView<'_, '_, '_> {
    fn location(&self, automaton: usize) -> Option<LocationId> {
        self.graph.model.members.get(automaton)?;
        u16::try_from(self.state[automaton]).ok().map(LocationId)
    }

    fn slot(&self, slot: u16) -> Option<Value> {
        let model = self.graph.model;
        if let Some(automaton) = located_automaton(slot, model.members.len()) {
            return Some(Value::Int(self.state[usize::from(automaton)]));
        }
        let slot = usize::from(slot);
        if slot < model.slots.len() { model.slot_value(self.state, slot) } else { None }
    }

    fn counter(&self, counter: usize) -> i64 {
        self.state[self.graph.model.counter_at(counter)]
    }

    fn apply(&self, function: FunctionId, args: &[Value]) -> Result<Value, EvalError> {
        self.graph.model.apply(self.state, function, args)
    }
}

impl SymbolicView for DiscreteStateView<'_, '_, '_> {
    fn unit(&self) -> Nanos {
        self.graph.model.unit
    }

    fn deadlocked(&self, zone: &Dbm) -> Result<Federation, ModelError> {
        self.graph.deadlocked(self.state, zone)
    }
}

// ── What the network tells ──

impl CompiledNetwork<'_> {
    /// The least and greatest that a time of a formula can be, in units.
    fn span(&self, time: &hrdsl_ir::ta::TimeSum) -> (i64, i64) {
        let names = self.slot_scope();
        let term = |t: &hrdsl_ir::ta::TimeTerm| {
            (t.factor / self.unit, self.library.compile(&names, &t.value, NumberType::Int))
        };
        let terms = time.terms.iter().map(term).collect();
        TimeExpr { units: time.nanos / self.unit, terms }.span(&self.library, &[])
    }

    /// The value of a function in a state: with its owner's variables if it has one.
    fn apply(&self, state: &[i64], function: FunctionId, args: &[Value]) -> Result<Value, EvalError> {
        let owner = self.program.functions.get(usize::from(function.0)).ok_or(EvalError::Type)?.owner;
        let owner = owner.and_then(|id| self.program.automata.get(usize::from(id.0)));
        let own = owner.and_then(|a| self.members.iter().find(|m| std::ptr::eq(m.automaton, a)));
        let memory = FunctionScope { model: self, state, own };
        let count = self.shared + own.map_or(0, |m| m.automaton.vars.len());
        let base = u16::try_from(count).unwrap_or(u16::MAX);
        let functions = FunctionTable::new(self.program);
        exec::MemoryView::new(&functions, &memory, base, &[]).apply(function, args)
    }
}

/// The variables that a function knows.
struct FunctionScope<'a, 'p> {
    model: &'a CompiledNetwork<'p>,
    state: &'a [i64],
    own: Option<&'a CompiledAutomaton<'p>>,
}

impl VariableMemory for FunctionScope<'_, '_> {
    fn read(&self, slot: u16) -> Option<Value> {
        let slot = usize::from(slot);
        let at = match slot.checked_sub(self.model.shared) {
            None => slot,
            Some(own) => self.own?.base + own,
        };
        (at < self.model.slots.len()).then(|| self.model.slot_value(self.state, at)).flatten()
    }

    fn write(&mut self, _: u16, _: Value) -> Result<(), EvalError> {
        Err(EvalError::Type)
    }
}
