//! Questions about a network: goals, counters of events, and restrictions of the environment.

use hrdsl_ir::{EventId, EventPattern, Expr, Value, expr::EvalError, ta::LocationId};

/// What a search looks for. Automata are given by their index in the network.
#[derive(Clone, Debug, PartialEq)]
pub struct Goal {
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
    Formula(hrdsl_ir::ta::Formula),
}

/// A formula over a state's locations, variables and counters.
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
    /// A boolean expression; `Expr::Var(i)` is the network's slot `i`: see [`slot_names`](crate::slot_names).
    Data(Expr),
    /// `lo <= n`, and `n <= hi` if there is such a bound.
    CounterIn {
        counter: usize,
        lo: i64,
        hi: Option<i64>,
    },
}

/// Counts the events that match one of the patterns, up to `cap`: it stays there.
#[derive(Clone, Debug, PartialEq)]
pub struct Counter {
    pub patterns: Vec<EventPattern>,
    pub cap: i64,
}

/// A restriction of the environment: no transition is taken that makes a matching event happen more often than this.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    pub patterns: Vec<EventPattern>,
    pub at_most: i64,
}

/// How much a search may use; when it is used up, the goals that are left are [`Outcome::Open`](crate::Outcome::Open).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// Symbolic states ever stored, including those that a greater one replaced.
    pub states: usize,
    /// Bytes for states, an estimate from below.
    pub bytes: usize,
}

impl Default for Budget {
    fn default() -> Self {
        Self { states: 2_000_000, bytes: 2 << 30 }
    }
}

/// A discrete state, as formulas see it.
pub trait View {
    /// The location of the network's automaton of this index.
    fn location(&self, automaton: usize) -> Option<LocationId>;
    /// The value of the network's slot of this index.
    fn slot(&self, slot: u16) -> Option<Value>;
    /// The counter's number.
    fn counter(&self, counter: usize) -> i64;
}

impl StateFormula {
    /// Whether it holds in a state.
    ///
    /// # Errors
    /// If an expression has no value there.
    pub fn holds(&self, view: &dyn View) -> Result<bool, EvalError> {
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
            StateFormula::Data(e) => e.eval(&|i| view.slot(i))?.as_bool().ok_or(EvalError::Type),
            StateFormula::CounterIn { counter, lo, hi } => {
                let n = view.counter(*counter);
                Ok(*lo <= n && hi.is_none_or(|hi| n <= hi))
            }
        }
    }
}

/// Whether one of the patterns matches.
#[must_use]
pub fn any_matches(patterns: &[EventPattern], event: EventId, args: &[Value]) -> bool {
    patterns.iter().any(|p| p.matches(event, args))
}
