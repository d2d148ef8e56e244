//! Questions about a network: goals, counters of events, and restrictions of the environment.

use hrdsl_ir::{
    EventId, EventPattern, Expr, Nanos, Program, Value,
    expr::{EvalError, EvalScope},
    ta::{self as ir, ClockConstraint, ClockId, ClockOp, FunctionId, LocationId, TimeSum},
};
use smallvec::{SmallVec, smallvec};

use crate::{
    network::error::ModelError,
    zone::{
        constraint::{DifferenceConstraint, keep},
        dbm::{Dbm, DbmBound},
        federation::Federation,
    },
};

/// What a search looks for. Automata are given by their index in the network.
#[derive(Clone, Debug, PartialEq)]
pub struct ReachabilityGoal {
    pub what: GoalKind,
    /// It must hold where a run may stop: no automaton is in a committed location. Edges ignore it.
    pub settled: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub enum GoalKind {
    /// The edge of this index is taken, by the sender or as a receiver.
    Edge {
        automaton: usize,
        edge: usize,
    },
    Location {
        automaton: usize,
        location: LocationId,
    },
    /// The automaton takes these two of its edges one after the other, whatever others do in between.
    Pair {
        automaton: usize,
        first: usize,
        second: usize,
    },
    /// The edge `user` (automaton, edge) reads the slot, which the edge `definition` was the last to assign to; `None`: the
    /// slot still has its initial value.
    Use {
        slot: usize,
        definition: Option<(usize, usize)>,
        user: (usize, usize),
    },
    Condition(StateFormula),
    /// A formula over locations, variables and clocks; it holds where the zone meets it.
    Formula(hrdsl_ir::ta::QueryFormula),
}

impl ReachabilityGoal {
    /// The formula that its states meet; `None`, if it is met by transitions.
    #[must_use]
    pub fn formula(&self) -> Option<StateFormula> {
        match &self.what {
            GoalKind::Edge { .. } | GoalKind::Pair { .. } | GoalKind::Use { .. } => None,
            GoalKind::Location { automaton, location } => {
                Some(StateFormula::At { automaton: *automaton, location: *location })
            }
            GoalKind::Condition(f) => Some(f.clone()),
            GoalKind::Formula(f) => Some(f.into()),
        }
    }
}

/// A formula over a state's locations, variables, clocks and counters.
#[derive(Clone, Debug, PartialEq)]
pub enum StateFormula {
    And(Vec<StateFormula>),
    Or(Vec<StateFormula>),
    Not(Box<StateFormula>),
    /// The automaton is in this location.
    At {
        automaton: usize,
        location: LocationId,
    },
    /// A boolean expression; `Expr::Var(i)` is the network's slot `i`: see [`slot_names`](crate::slot_names). A
    /// [location](hrdsl_ir::ta::location_variable) counts as an int.
    Data(Expr),
    /// `lo <= n`, and `n <= hi` if there is such a bound.
    CounterIn {
        counter: usize,
        lo: i64,
        hi: Option<i64>,
    },
    /// Over the network's clocks: the shared ones first, then each automaton's own; see
    /// [`clock_names`]. Expressions in it are as in `Data`.
    Clock(ClockConstraint),
    /// No transition is possible, now or after any delay.
    Deadlock,
}

/// Counts the events that match one of the patterns, up to `cap`: it stays there.
#[derive(Clone, Debug, PartialEq)]
pub struct EventCounter {
    pub patterns: Vec<EventPattern>,
    pub cap: i64,
}

/// A restriction of the environment: no transition is taken that makes a matching event happen more often than this.
#[derive(Clone, Debug, PartialEq)]
pub struct EventLimit {
    pub patterns: Vec<EventPattern>,
    pub at_most: i64,
}

/// How much a search may use; when it is used up, the goals that are left are [`GoalOutcome::Inconclusive`](crate::GoalOutcome::Inconclusive).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SearchBudget {
    /// Symbolic states ever stored, including those that a greater one replaced. By default the memory alone decides.
    pub states: usize,
    /// Bytes for states, an estimate from below.
    pub bytes: usize,
}

impl Default for SearchBudget {
    fn default() -> Self {
        Self { states: usize::MAX, bytes: 2 << 30 }
    }
}

/// A discrete state, as formulas see it.
pub trait StateView {
    /// The location of the network's automaton of this index.
    fn location(&self, automaton: usize) -> Option<LocationId>;
    /// The value of the network's slot of this index.
    fn slot(&self, slot: u16) -> Option<Value>;
    /// The counter's number.
    fn counter(&self, counter: usize) -> i64;
    /// The value of a function.
    ///
    /// # Errors
    /// Of its body; `Type` if there is no such function.
    fn apply(&self, function: FunctionId, args: &[Value]) -> Result<Value, EvalError> {
        let _ = (function, args);
        Err(EvalError::Type)
    }
}

/// A discrete state that knows the network's clocks, too.
pub trait SymbolicView: StateView {
    /// The nanoseconds of a unit of zones' bounds.
    fn unit(&self) -> Nanos;
    /// The part of a zone from which no transition is possible, now or after any delay.
    ///
    /// # Errors
    /// If the model is at fault there.
    fn deadlocked(&self, zone: &Dbm) -> Result<Federation, ModelError>;
}

/// A view as the scope of expressions.
pub(crate) struct StateViewScope<'a>(pub(crate) &'a dyn StateView);

impl EvalScope for StateViewScope<'_> {
    fn var(&self, slot: u16) -> Option<Value> {
        self.0.slot(slot)
    }

    fn apply(&self, function: FunctionId, args: &[Value]) -> Result<Value, EvalError> {
        self.0.apply(function, args)
    }
}

impl From<&ir::QueryFormula> for StateFormula {
    fn from(f: &ir::QueryFormula) -> Self {
        let all = |fs: &[ir::QueryFormula]| fs.iter().map(StateFormula::from).collect();
        match f {
            ir::QueryFormula::At { automaton, location } => {
                StateFormula::At { automaton: usize::from(*automaton), location: *location }
            }
            ir::QueryFormula::Data(e) => StateFormula::Data(e.clone()),
            ir::QueryFormula::Clock(c) => StateFormula::Clock(c.clone()),
            ir::QueryFormula::Deadlock => StateFormula::Deadlock,
            ir::QueryFormula::Not(f) => StateFormula::from(&**f).not(),
            ir::QueryFormula::And(fs) => StateFormula::And(all(fs)),
            ir::QueryFormula::Or(fs) => StateFormula::Or(all(fs)),
        }
    }
}

/// The time of an expression in nanoseconds.
///
/// # Errors
/// If a term has no value or the sum is too large.
pub(crate) fn nanos(time: &TimeSum, scope: &dyn EvalScope) -> Result<Nanos, EvalError> {
    let mut sum = time.nanos;
    for term in &time.terms {
        let n = term.value.eval_in(scope)?.as_int().ok_or(EvalError::Type)?;
        sum = term.factor.checked_mul(n).and_then(|t| sum.checked_add(t)).ok_or(EvalError::Overflow)?;
    }
    Ok(sum)
}

/// A comparison of clocks of the network, `bound` units, as bounds of a zone: one, or two for an equality.
pub(crate) fn as_bounds(c: &ClockConstraint, bound: i64) -> SmallVec<[DifferenceConstraint; 2]> {
    let clock = |x: ClockId| x.0.saturating_add(1);
    let (i, j) = (clock(c.clock), c.minus.map_or(0, clock));
    let upper = |bound| DifferenceConstraint { i, j, bound };
    let lower = |bound| DifferenceConstraint { i: j, j: i, bound };
    match c.op {
        ClockOp::Lt => smallvec![upper(DbmBound::lt(bound))],
        ClockOp::Le => smallvec![upper(DbmBound::le(bound))],
        ClockOp::Eq => smallvec![upper(DbmBound::le(bound)), lower(DbmBound::le(-bound))],
        ClockOp::Ge => smallvec![lower(DbmBound::le(-bound))],
        ClockOp::Gt => smallvec![lower(DbmBound::lt(-bound))],
    }
}

impl StateFormula {
    #[must_use]
    #[expect(clippy::should_implement_trait, reason = "it is a constructor, as `And` and `Or` are")]
    pub fn not(self) -> Self {
        if let StateFormula::Not(f) = self { *f } else { StateFormula::Not(Box::new(self)) }
    }

    /// Whether it holds in a state; without clocks, so `Clock` and `Deadlock` have no value.
    ///
    /// # Errors
    /// If an expression has no value there.
    pub fn holds(&self, view: &dyn StateView) -> Result<bool, EvalError> {
        match self {
            StateFormula::And(fs) => {
                for f in fs {
                    if !f.holds(view)? {
                        return Ok(false);
                    }
                }
                Ok(true)
            }
            StateFormula::Or(fs) => {
                for f in fs {
                    if f.holds(view)? {
                        return Ok(true);
                    }
                }
                Ok(false)
            }
            StateFormula::Not(f) => Ok(!f.holds(view)?),
            StateFormula::At { automaton, location } => Ok(view.location(*automaton) == Some(*location)),
            StateFormula::Data(e) => e.eval_in(&StateViewScope(view))?.as_bool().ok_or(EvalError::Type),
            StateFormula::CounterIn { counter, lo, hi } => {
                let n = view.counter(*counter);
                Ok(*lo <= n && hi.is_none_or(|hi| n <= hi))
            }
            StateFormula::Clock(_) | StateFormula::Deadlock => Err(EvalError::Type),
        }
    }

    /// Calls `f` with each comparison of clocks in it.
    pub fn each_clock(&self, f: &mut dyn FnMut(&ClockConstraint)) {
        match self {
            StateFormula::And(fs) | StateFormula::Or(fs) => fs.iter().for_each(|g| g.each_clock(f)),
            StateFormula::Not(g) => g.each_clock(f),
            StateFormula::Clock(c) => f(c),
            StateFormula::At { .. }
            | StateFormula::Data(_)
            | StateFormula::CounterIn { .. }
            | StateFormula::Deadlock => {}
        }
    }

    /// Whether it speaks of `deadlock`.
    #[must_use]
    pub fn asks_deadlock(&self) -> bool {
        match self {
            StateFormula::And(fs) | StateFormula::Or(fs) => fs.iter().any(StateFormula::asks_deadlock),
            StateFormula::Not(f) => f.asks_deadlock(),
            StateFormula::Deadlock => true,
            StateFormula::At { .. }
            | StateFormula::Data(_)
            | StateFormula::CounterIn { .. }
            | StateFormula::Clock(_) => false,
        }
    }

    /// Whether the state's discrete part alone does not decide it.
    #[must_use]
    pub fn is_timed(&self) -> bool {
        let mut timed = self.asks_deadlock();
        self.each_clock(&mut |_| timed = true);
        timed
    }

    /// The part of a zone in which it holds.
    ///
    /// # Errors
    /// `Question` if an expression has no value there; what `deadlocked` gives.
    pub fn part(&self, at: &dyn SymbolicView, zone: &Dbm) -> Result<Federation, ModelError> {
        match self {
            StateFormula::And(fs) => {
                let mut parts = Federation::from_zone(zone.clone());
                for f in fs {
                    let mut next = Federation::empty();
                    for z in parts.zones() {
                        next = next.union(f.part(at, z)?);
                    }
                    parts = next;
                }
                Ok(parts)
            }
            StateFormula::Or(fs) => {
                let mut parts = Federation::empty();
                for f in fs {
                    parts = parts.union(f.part(at, zone)?);
                }
                Ok(parts)
            }
            StateFormula::Not(f) => Ok(Federation::from_zone(zone.clone()).without(&f.part(at, zone)?)),
            StateFormula::Clock(c) => clock_part(c, at, zone),
            StateFormula::Deadlock => at.deadlocked(zone),
            StateFormula::At { .. } | StateFormula::Data(_) | StateFormula::CounterIn { .. } => {
                let holds = self.holds(at).map_err(no_value)?;
                Ok(if holds { Federation::from_zone(zone.clone()) } else { Federation::empty() })
            }
        }
    }
}

/// What is said of a formula without a value.
pub(crate) fn no_value(e: EvalError) -> ModelError {
    ModelError::Question(format!("the formula has no value in a state that can be reached: {e}"))
}

fn clock_part(c: &ClockConstraint, at: &dyn SymbolicView, zone: &Dbm) -> Result<Federation, ModelError> {
    let time = nanos(&c.bound, &StateViewScope(at)).map_err(no_value)?;
    if time % at.unit() != 0 {
        return Err(ModelError::Question("a time in the formula is finer than the network's unit".into()));
    }
    let mut part = zone.clone();
    for b in as_bounds(c, time / at.unit()) {
        if !keep(&mut part, b) {
            return Ok(Federation::empty());
        }
    }
    Ok(Federation::from_zone(part))
}

/// The network's clocks by name, in the order in which [`StateFormula::Clock`] numbers them: the shared clocks, then each
/// automaton's own as `Automaton.clock`.
#[must_use]
pub fn clock_names(program: &Program, network: &ir::Network) -> Vec<String> {
    let members = network.automata.iter().filter_map(|id| program.automata.get(usize::from(id.0)));
    let own = members.flat_map(|a| a.clocks.iter().map(|c| format!("{}.{c}", a.name)));
    program.clocks.iter().cloned().chain(own).collect()
}

/// Whether one of the patterns matches.
#[must_use]
pub fn any_matches(patterns: &[EventPattern], event: EventId, args: &[Value]) -> bool {
    patterns.iter().any(|p| p.matches(event, args))
}
