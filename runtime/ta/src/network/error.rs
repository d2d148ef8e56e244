//! What can be wrong with a model.

use hrdsl_ir::{
    Span, Type, Value,
    expr::EvalError,
    ta::{Automaton, AutomatonVar, Edge, LocationId},
};

/// What errors call an edge.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("automaton `{automaton}`, edge {from} -> {to}")]
pub struct EdgeName {
    pub automaton: String,
    pub from: String,
    pub to: String,
    /// Where the edge is written.
    pub origin: Span,
}

impl EdgeName {
    pub(crate) fn of(automaton: &Automaton, edge: &Edge) -> Box<Self> {
        let name = |l: LocationId| automaton.locations[usize::from(l.0)].name.clone();
        let (from, to) = (name(edge.from), name(edge.to));
        Box::new(Self { automaton: automaton.name.clone(), from, to, origin: edge.origin })
    }
}

/// A fault of the model that a search or a run met.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ModelError {
    /// The program is not what the checker lets through.
    #[error("malformed automaton `{automaton}`: {what}")]
    Malformed { automaton: String, what: String },
    /// A question about the network that has no meaning.
    #[error("malformed question: {0}")]
    Question(String),
    /// A constant of more than 2⁵⁰ units, the unit being the greatest in which all constants are whole.
    #[error("the time constants of `{automaton}` are too far apart")]
    Constants { automaton: String },
    /// The invariants of the initial locations exclude clocks at zero.
    #[error("the invariants of the initial locations do not hold at the start")]
    Initial,
    /// An expression of an edge has no value.
    #[error("{edge}: {error}")]
    Evaluation { edge: Box<EdgeName>, error: EvalError },
    /// An update leaves the range of a variable.
    #[error("{edge}: `{variable}` becomes {value}, outside {lo}..{hi}")]
    Range { edge: Box<EdgeName>, variable: String, value: i64, lo: i64, hi: i64 },
    /// An argument of a sent event or of an offer is outside the range of its parameter, or no value of its enumeration.
    #[error("{edge}: argument `{parameter}` of `{event}` is {value}")]
    Argument { edge: Box<EdgeName>, event: String, parameter: String, value: Value },
    /// A clock would become less than zero.
    #[error("{edge}: the clock `{clock}` becomes less than zero")]
    NegativeClock { edge: Box<EdgeName>, clock: String },
    /// The part of an invariant over variables, or a bound in it, has no value.
    #[error("automaton `{automaton}`, invariant of `{location}`: {error}")]
    Invariant { automaton: String, location: String, error: EvalError },
    /// A player's invariant (or urgent location) lets no time pass, yet time passed: nothing it could do was enabled.
    #[error("automaton `{automaton}` may not stay in `{location}` and has no enabled edge")]
    Timelock { automaton: String, location: String },
    /// A player took very many edges at one instant.
    #[error("automaton `{automaton}` takes edges without end at one instant, now in `{location}`")]
    Zeno { automaton: String, location: String },
}

impl ModelError {
    /// Whether taking a transition is what the fault is met by.
    pub(crate) fn is_of_a_transition(&self) -> bool {
        match self {
            ModelError::Evaluation { .. }
            | ModelError::Range { .. }
            | ModelError::Argument { .. }
            | ModelError::NegativeClock { .. }
            | ModelError::Invariant { .. } => true,
            ModelError::Malformed { .. }
            | ModelError::Question(_)
            | ModelError::Constants { .. }
            | ModelError::Initial
            | ModelError::Timelock { .. }
            | ModelError::Zeno { .. } => false,
        }
    }
}

pub(crate) fn range_fault(edge: Box<EdgeName>, var: &AutomatonVar, value: i64) -> ModelError {
    ModelError::Range { edge, variable: var.name.clone(), value, lo: var.lo, hi: var.hi }
}

/// The first argument outside its parameter's range or enumeration, if any.
pub(crate) fn argument_fault<'e>(event: &'e hrdsl_ir::Event, args: &[Value]) -> Option<(&'e str, Value)> {
    event.params.iter().zip(args).find_map(|(p, v)| match (p.ty, v) {
        (Type::Int { lo, hi }, Value::Int(n)) if *n < lo || *n > hi => Some((p.name.as_str(), *v)),
        (Type::Enum(e), Value::Symbol(s)) if e.index_of(*s).is_none() => Some((p.name.as_str(), *v)),
        (Type::Int { .. } | Type::Bool | Type::Float(_) | Type::Enum(_) | Type::Text | Type::List(_), _) => {
            None
        }
    })
}

pub(crate) fn bad_argument(edge: Box<EdgeName>, event: &str, parameter: &str, value: Value) -> ModelError {
    let (event, parameter) = (event.to_owned(), parameter.to_owned());
    ModelError::Argument { edge, event, parameter, value }
}
