//! Timed automata, after Alur and Dill, with UPPAAL's committed and urgent locations and broadcast synchronisation.

use serde::{Deserialize, Serialize};

use crate::{ActorId, ArgPattern, Enumeration, EventId, Expr, Nanos, Span, Value};

/// Index into [`Program::automata`](crate::Program::automata).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct AutomatonId(pub u16);

/// Index into [`Automaton::locations`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct LocationId(pub u16);

/// Index into [`Automaton::clocks`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct ClockId(pub u16);

/// A network: the parallel product of automata.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Network {
    pub name: String,
    pub automata: Vec<AutomatonId>,
    pub origin: Span,
}

/// A variable of a finite type, kept as a number of `lo..=hi`: a bool as one of `0..=1`, a symbol as its index in the
/// enumeration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Var {
    pub name: String,
    pub lo: i64,
    pub hi: i64,
    pub init: i64,
    /// Declared as bool: it evaluates to `Value::Bool`.
    pub is_bool: bool,
    /// Declared as an enumeration: it evaluates to `Value::Symbol`. Then `is_bool` is false and the range is that of the
    /// enumeration's indices.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub enumeration: Option<Enumeration>,
}

impl Var {
    /// The value that a number kept for the variable stands for. `None`: the enumeration has no such index.
    #[must_use]
    pub fn value(&self, n: i64) -> Option<Value> {
        match self.enumeration {
            Some(e) => usize::try_from(n).ok().and_then(|n| e.values().get(n)).copied().map(Value::Symbol),
            None if self.is_bool => Some(Value::Bool(n != 0)),
            None => Some(Value::Int(n)),
        }
    }

    /// The number to keep for a value; it may lie outside the range. `None`: the value is of another type.
    #[must_use]
    pub fn number(&self, value: Value) -> Option<i64> {
        match (self.enumeration, value) {
            (Some(e), Value::Symbol(s)) => e.index_of(s).and_then(|n| i64::try_from(n).ok()),
            (None, Value::Bool(b)) if self.is_bool => Some(i64::from(b)),
            (None, Value::Int(n)) if !self.is_bool => Some(n),
            (
                _,
                Value::Bool(_)
                | Value::Int(_)
                | Value::Float(_)
                | Value::Symbol(_)
                | Value::Text(_)
                | Value::List(_),
            ) => None,
        }
    }
}

/// One timed automaton.
///
/// In its expressions, `Expr::Var(i)` is, in order: the program's shared variables, the automaton's own variables,
/// then on an edge its binders: first the selects, then the parameters of a received event that the edge binds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Automaton {
    pub name: String,
    /// The actor it plays: it can only send this actor's events.
    pub actor: ActorId,
    pub clocks: Vec<String>,
    pub vars: Vec<Var>,
    pub locations: Vec<Location>,
    pub initial: LocationId,
    pub edges: Vec<Edge>,
    pub origin: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Location {
    pub name: String,
    pub kind: LocationKind,
    /// A conjunction; upper bounds on clocks.
    pub invariant: Vec<ClockConstraint>,
    pub origin: Span,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LocationKind {
    Normal,
    /// Time does not pass.
    Urgent,
    /// Time does not pass, and the next transition must involve a committed location.
    Committed,
}

/// `clock - minus op bound`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ClockConstraint {
    pub clock: ClockId,
    pub minus: Option<ClockId>,
    pub op: ClockOp,
    pub bound: Nanos,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ClockOp {
    Lt,
    Le,
    Eq,
    Ge,
    Gt,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Edge {
    pub from: LocationId,
    pub to: LocationId,
    /// Nondeterministic choices, each an integer of `lo..=hi`, a bool or a symbol, as a variable is.
    pub selects: Vec<Var>,
    pub clock_guard: Vec<ClockConstraint>,
    /// A boolean expression over variables, selects and received arguments.
    pub guard: Option<Expr>,
    pub sync: Sync,
    /// In order; each sees the effect of those before it. In a synchronisation the sender's updates come first.
    pub updates: Vec<Update>,
    pub origin: Span,
}

/// Events are broadcast: the sender never waits, each automaton with an enabled receiving edge takes part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Sync {
    Internal,
    /// The event or stimulus sent, with its arguments.
    Send {
        event: EventId,
        args: Vec<Expr>,
    },
    Receive {
        event: EventId,
        args: Vec<ReceiveArg>,
    },
}

/// What a receiving edge does with one argument.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ReceiveArg {
    /// Takes part only if it matches.
    Match(ArgPattern),
    /// Binds it: the next binder of the edge. The binders follow the selects, in the order of the arguments.
    Bind,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Update {
    /// `slot` counts as `Expr::Var` does: shared variables, then own ones. Leaving the range is a model error.
    Assign {
        slot: u16,
        value: Expr,
    },
    Reset {
        clock: ClockId,
    },
}
