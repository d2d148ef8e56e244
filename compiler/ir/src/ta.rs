//! Timed automata, after Alur and Dill, with UPPAAL's locations, channels, variables and functions.

use hrdsl_source::{Enumeration, Span};
use serde::{Deserialize, Serialize};

pub use crate::located::{located_automaton, location_variable};

pub use hrdsl_source::LocationKind;

pub use crate::expr::FunctionId;
use crate::{
    event::{ActorId, ArgPattern, EventId},
    expr::{Expr, Lvalue},
    value::{Nanos, Type, Value},
};

/// Index into [`Program::automata`](crate::Program::automata).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct AutomatonId(pub u16);

/// Index into [`Automaton::locations`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct LocationId(pub u16);

/// A clock as an automaton numbers it: the program's shared clocks first, then its own ([`Automaton::clocks`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct ClockId(pub u16);

/// Index into [`Program::channels`](crate::Program::channels).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct ChannelId(pub u16);

/// Index into [`Program::networks`](crate::Program::networks).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct NetworkId(pub u16);

/// Index into [`Program::queries`](crate::Program::queries).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct QueryId(pub u16);

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
pub struct AutomatonVar {
    pub name: String,
    pub lo: i64,
    pub hi: i64,
    pub init: i64,
    /// Declared as bool: it evaluates to `Value::Bool`.
    pub is_bool: bool,
    /// Declared as an enumeration: it evaluates to `Value::Symbol`, `is_bool` is false, the range is that of its indices.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub enumeration: Option<Enumeration>,
}

impl AutomatonVar {
    /// A variable of this type that starts with its first value; `None`: the type is not finite.
    #[must_use]
    pub fn of_type(name: &str, ty: Type) -> Option<Self> {
        let (lo, hi, is_bool, enumeration) = match ty {
            Type::Bool => (0, 1, true, None),
            Type::Int { lo, hi } => (lo, hi, false, None),
            Type::Enum(e) => (0, i64::try_from(e.values().len()).ok()? - 1, false, Some(e)),
            Type::Float(_) | Type::Text | Type::List(_) => return None,
        };
        Some(Self { name: name.to_owned(), lo, hi, init: lo, is_bool, enumeration })
    }

    /// Its type.
    #[must_use]
    pub fn ty(&self) -> Type {
        match self.enumeration {
            Some(e) => Type::Enum(e),
            None if self.is_bool => Type::Bool,
            None => Type::Int { lo: self.lo, hi: self.hi },
        }
    }

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
pub struct Automaton<E = Expr, V = u16> {
    pub name: String,
    /// The actor it plays: it can only send this actor's events. `None`: it sends and takes no events, only channels.
    pub actor: Option<ActorId>,
    pub clocks: Vec<String>,
    pub vars: Vec<AutomatonVar>,
    pub locations: Vec<Location<E>>,
    pub initial: LocationId,
    pub edges: Vec<Edge<E, V>>,
    pub origin: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Location<E = Expr> {
    pub name: String,
    pub kind: LocationKind,
    /// A conjunction of bounds on clocks.
    pub invariant: Vec<ClockConstraint<E>>,
    /// The part of the invariant over variables.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub holds: Option<E>,
    /// The clocks that stand still here, ascending.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stopped: Vec<ClockId>,
    pub origin: Span,
}

/// `clock - minus op bound`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClockConstraint<E = Expr> {
    pub clock: ClockId,
    pub minus: Option<ClockId>,
    pub op: ClockOp,
    pub bound: TimeSum<E>,
}

impl<E> ClockConstraint<E> {
    /// Its clocks.
    pub fn clocks(&self) -> impl Iterator<Item = ClockId> {
        std::iter::once(self.clock).chain(self.minus)
    }
}

/// A time that variables may have a part in: `nanos + Σ factor · value`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TimeSum<E = Expr> {
    pub nanos: Nanos,
    #[serde(default = "Vec::new", skip_serializing_if = "Vec::is_empty")]
    pub terms: Vec<TimeTerm<E>>,
}

impl<E> Default for TimeSum<E> {
    fn default() -> Self {
        Self::ZERO
    }
}

impl<E> TimeSum<E> {
    pub const ZERO: Self = TimeSum { nanos: 0, terms: Vec::new() };

    #[must_use]
    pub fn constant(nanos: Nanos) -> Self {
        Self { nanos, terms: Vec::new() }
    }

    /// The nanoseconds, if no variable has a part in it.
    #[must_use]
    pub fn fixed(&self) -> Option<Nanos> {
        self.terms.is_empty().then_some(self.nanos)
    }
}

/// `factor · value`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TimeTerm<E = Expr> {
    pub factor: Nanos,
    /// An integer.
    pub value: E,
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
pub struct Edge<E = Expr, V = u16> {
    pub from: LocationId,
    pub to: LocationId,
    /// Nondeterministic choices, each an integer of `lo..=hi`, a bool or a symbol, as a variable is.
    pub selects: Vec<AutomatonVar>,
    pub clock_guard: Vec<ClockConstraint<E>>,
    /// A boolean expression over variables, selects and received arguments.
    pub guard: Option<E>,
    pub sync: SyncLabel<E>,
    /// In order; each sees the effect of those before it. In a synchronisation the sender's updates come first.
    pub updates: Vec<EdgeAssignment<E, V>>,
    pub origin: Span,
}

/// How an edge takes part in a transition. Events are broadcast: the sender never waits, and whoever can take part does.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SyncLabel<E = Expr> {
    Internal,
    /// The event or stimulus sent, with its arguments.
    Send {
        event: EventId,
        args: Vec<E>,
    },
    Receive {
        event: EventId,
        args: Vec<ReceiveArg>,
    },
    /// `c!` of a binary or broadcast channel.
    Offer {
        channel: ChannelId,
        args: Vec<E>,
    },
    /// `c?` of a binary or broadcast channel.
    Accept {
        channel: ChannelId,
        args: Vec<ReceiveArg>,
    },
    /// Its automaton's part in a multi-way channel.
    Join {
        channel: ChannelId,
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
pub enum EdgeAssignment<E = Expr, V = u16> {
    /// Slots count as `Expr::Var` does: shared variables, then own ones. Leaving the range is a model error.
    Assign { place: Lvalue<E, V>, value: E },
    /// The clock becomes `from + to`; without `from`, just `to`. A negative value is a model error.
    Reset { clock: ClockId, from: Option<ClockId>, to: TimeSum<E> },
    /// Calls an update function.
    Call { function: FunctionId, args: Vec<E> },
}

impl EdgeAssignment {
    /// Sets a clock to zero.
    #[must_use]
    pub fn zero(clock: ClockId) -> Self {
        EdgeAssignment::Reset { clock, from: None, to: TimeSum::ZERO }
    }
}

/// A medium between automata. Each combination of arguments is a channel of its own, as an element of UPPAAL's arrays is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Channel {
    pub name: String,
    pub kind: ChannelKind,
    /// Time does not pass while a transition over it is possible. Its edges have no clock guards, except those that accept
    /// a broadcast.
    pub urgent: bool,
    /// Of finite types; the `init` has no meaning. None, if its kind is multi-way.
    pub params: Vec<AutomatonVar>,
    pub origin: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ChannelKind {
    /// One edge that offers and one of another automaton that accepts, together.
    Binary,
    /// One edge that offers, and of each other automaton that can one that accepts.
    Broadcast,
    /// An edge of each of these automata at once, their updates in this order; if all are optional, at least one's.
    MultiWay(Vec<ChannelParticipant>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ChannelParticipant {
    pub automaton: AutomatonId,
    /// It takes part if it can (TChecker's weak synchronisation); otherwise nobody can without it.
    pub optional: bool,
}

/// A function of automata.
///
/// In its body `Expr::Var(i)` is, in order: the program's shared variables, the owner's own variables if it has an owner,
/// the parameters, the locals. Locals start with their `init`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AutomatonFunction<E = Expr, V = u16> {
    pub name: String,
    /// The automaton whose variables it knows.
    pub owner: Option<AutomatonId>,
    pub params: Vec<AutomatonVar>,
    pub locals: Vec<AutomatonVar>,
    /// The type of its value, as that of a variable; its `init` has no meaning. `None`: it is for its effect.
    pub result: Option<AutomatonVar>,
    /// It assigns nothing but its parameters and locals, nor does what it calls.
    pub pure: bool,
    pub body: Vec<FunctionStatement<E, V>>,
    pub origin: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FunctionStatement<E = Expr, V = u16> {
    Assign {
        place: Lvalue<E, V>,
        value: E,
    },
    Call {
        function: FunctionId,
        args: Vec<E>,
    },
    If {
        condition: E,
        then: Vec<FunctionStatement<E, V>>,
        otherwise: Vec<FunctionStatement<E, V>>,
    },
    While {
        condition: E,
        body: Vec<FunctionStatement<E, V>>,
    },
    /// For each number from `lo` to `hi`, both evaluated once; `slot` is a local.
    For {
        slot: V,
        lo: E,
        hi: E,
        body: Vec<FunctionStatement<E, V>>,
    },
    Return(Option<E>),
}

impl<E, V> FunctionStatement<E, V> {
    /// Calls `f` with this statement and each one in it, the outer one first.
    pub fn each<'a>(&'a self, f: &mut dyn FnMut(&'a FunctionStatement<E, V>)) {
        f(self);
        match self {
            FunctionStatement::Assign { .. }
            | FunctionStatement::Call { .. }
            | FunctionStatement::Return(_) => {}
            FunctionStatement::If { then, otherwise, .. } => {
                then.iter().chain(otherwise).for_each(|s| s.each(f));
            }
            FunctionStatement::While { body, .. } | FunctionStatement::For { body, .. } => {
                body.iter().for_each(|s| s.each(f));
            }
        }
    }

    /// The expressions of the statement itself, not of those in it; the indices of what it assigns are not among them.
    #[must_use]
    pub fn expressions(&self) -> Vec<&E> {
        match self {
            FunctionStatement::Assign { value: e, .. } | FunctionStatement::Return(Some(e)) => vec![e],
            FunctionStatement::Call { args, .. } => args.iter().collect(),
            FunctionStatement::If { condition, .. } | FunctionStatement::While { condition, .. } => {
                vec![condition]
            }
            FunctionStatement::For { lo, hi, .. } => vec![lo, hi],
            FunctionStatement::Return(None) => Vec::new(),
        }
    }
}

// ── Queries ──

/// A question about a network, after UPPAAL's query language.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Query<E = Expr, T = String> {
    pub name: String,
    pub title: String,
    /// The formal part as written in the source; for the checker, where that stands.
    pub text: T,
    pub network: NetworkId,
    pub ask: QueryKind<E>,
    pub origin: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum QueryKind<E = Expr> {
    /// `E<> f`: some run reaches it.
    Possibly(QueryFormula<E>),
    /// `A[] f`: no run leaves it.
    Invariantly(QueryFormula<E>),
    /// `E[] f`: some maximal run stays in it.
    PotentiallyAlways(QueryFormula<E>),
    /// `A<> f`: every maximal run reaches it.
    Eventually(QueryFormula<E>),
    /// `f --> g`: `A[] (f imply A<> g)`
    LeadsTo(QueryFormula<E>, QueryFormula<E>),
    /// The least upper bound of each measure where the formula holds.
    Sup { of: Vec<QueryMeasure<E>>, when: QueryFormula<E> },
    /// The greatest lower bound.
    Inf { of: Vec<QueryMeasure<E>>, when: QueryFormula<E> },
}

/// A formula over a network's states. Automata are given by their index in the network; clocks are numbered with the
/// shared ones first, then each automaton's own, in the network's order; so are variables in expressions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum QueryFormula<E = Expr> {
    At {
        automaton: u16,
        location: LocationId,
    },
    /// A boolean expression.
    Data(E),
    Clock(ClockConstraint<E>),
    /// No transition is possible, now or after any delay.
    Deadlock,
    Not(Box<QueryFormula<E>>),
    And(Vec<QueryFormula<E>>),
    Or(Vec<QueryFormula<E>>),
}

impl<E> QueryKind<E> {
    /// The formulas that it asks.
    #[must_use]
    pub fn formulas(&self) -> Vec<&QueryFormula<E>> {
        match self {
            QueryKind::Possibly(f)
            | QueryKind::Invariantly(f)
            | QueryKind::PotentiallyAlways(f)
            | QueryKind::Eventually(f) => vec![f],
            QueryKind::LeadsTo(f, g) => vec![f, g],
            QueryKind::Sup { when, .. } | QueryKind::Inf { when, .. } => vec![when],
        }
    }
}

impl QueryFormula {
    /// Whether it holds whatever the state is, by the way it is written.
    #[must_use]
    pub fn is_always(&self) -> bool {
        match self {
            QueryFormula::And(parts) => parts.is_empty(),
            QueryFormula::Data(condition) => *condition == Expr::bool(true),
            QueryFormula::At { .. }
            | QueryFormula::Clock(_)
            | QueryFormula::Deadlock
            | QueryFormula::Not(_)
            | QueryFormula::Or(_) => false,
        }
    }
}

impl<E> QueryFormula<E> {
    /// Whether it speaks of `deadlock`.
    #[must_use]
    pub fn asks_deadlock(&self) -> bool {
        match self {
            QueryFormula::Deadlock => true,
            QueryFormula::Not(f) => f.asks_deadlock(),
            QueryFormula::And(fs) | QueryFormula::Or(fs) => fs.iter().any(QueryFormula::asks_deadlock),
            QueryFormula::At { .. } | QueryFormula::Data(_) | QueryFormula::Clock(_) => false,
        }
    }
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum QueryMeasure<E = Expr> {
    Clock(ClockId),
    /// An integer.
    Data(E),
}
