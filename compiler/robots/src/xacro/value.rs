//! Values of expressions, as Python has them.

use std::rc::Rc;

use crate::{
    fault::{RobotFault, RobotFaultKind, RobotPlace},
    limits::{MOST_NESTING, MOST_VALUE_SIZE},
};

/// What is wrong with an expression; the place is put to it by whoever evaluates.
#[derive(Clone, Debug)]
pub(super) struct EvalFault {
    pub kind: RobotFaultKind,
    pub help: Box<str>,
    /// Where it is, if it is not where the expression stands: in a property that the expression uses.
    pub place: Option<RobotPlace>,
}

pub(super) type EvalResult<T> = Result<T, EvalFault>;

impl EvalFault {
    pub fn new(kind: RobotFaultKind, help: impl Into<Box<str>>) -> Self {
        Self { kind, help: help.into(), place: None }
    }

    pub fn at(self, place: RobotPlace) -> RobotFault {
        self.kind.at(self.place.unwrap_or(place), self.help)
    }
}

impl From<RobotFault> for EvalFault {
    fn from(fault: RobotFault) -> Self {
        Self { kind: fault.kind, help: fault.help, place: Some(fault.place) }
    }
}

/// A fault of an expression that its own message explains.
pub(super) fn wrong<T>(reason: impl Into<String>, help: impl Into<Box<str>>) -> EvalResult<T> {
    Err(EvalFault::new(RobotFaultKind::BadExpression(reason.into()), help))
}

/// Something of xacro or Python that is not done here.
pub(super) fn not_done<T>(what: impl Into<String>, help: impl Into<Box<str>>) -> EvalResult<T> {
    Err(EvalFault::new(RobotFaultKind::NotDone(what.into()), help))
}

#[derive(Clone, Debug)]
pub(super) enum XacroValue {
    None,
    Bool(bool),
    Int(i64),
    Float(f64),
    Text(Rc<str>),
    List(XacroItems<XacroValue>),
    Tuple(XacroItems<XacroValue>),
    Dict(XacroItems<(XacroValue, XacroValue)>),
    /// A function of Python's, by its name.
    Function(Rc<str>),
}

/// Items, with how many values they are in all and how deep they lie in each other: what is shared is counted as often as it is
/// written out.
#[derive(Clone, Debug)]
pub(super) struct XacroItems<T> {
    items: Rc<Vec<T>>,
    size: usize,
    depth: usize,
}

impl<T> XacroItems<T> {
    fn new(items: Vec<T>, measure: impl Fn(&T) -> (usize, usize)) -> EvalResult<Self> {
        let (mut size, mut depth) = (1_usize, 0);
        for item in &items {
            let (inside, below) = measure(item);
            size = size.saturating_add(inside);
            depth = depth.max(below);
        }
        if size > MOST_VALUE_SIZE || depth >= MOST_NESTING {
            let kind = RobotFaultKind::TooMuch { what: "values of a list", limit: MOST_VALUE_SIZE };
            return Err(EvalFault::new(kind, "compute a smaller list"));
        }
        Ok(Self { items: Rc::new(items), size, depth: depth + 1 })
    }

    pub fn iter(&self) -> std::slice::Iter<'_, T> {
        self.items.iter()
    }

    pub fn as_slice(&self) -> &[T] {
        &self.items
    }
}

impl XacroValue {
    pub fn text(text: impl AsRef<str>) -> EvalResult<Self> {
        let text = text.as_ref();
        if text.len() > MOST_VALUE_SIZE {
            let kind = RobotFaultKind::TooMuch { what: "bytes of a text", limit: MOST_VALUE_SIZE };
            return Err(EvalFault::new(kind, "compute a shorter one"));
        }
        Ok(Self::Text(Rc::from(text)))
    }

    pub fn list(items: Vec<Self>) -> EvalResult<Self> {
        XacroItems::new(items, Self::measure).map(Self::List)
    }

    pub fn tuple(items: Vec<Self>) -> EvalResult<Self> {
        XacroItems::new(items, Self::measure).map(Self::Tuple)
    }

    pub fn dict(pairs: Vec<(Self, Self)>) -> EvalResult<Self> {
        let measure = |(key, value): &(Self, Self)| {
            let ((a, b), (c, d)) = (key.measure(), value.measure());
            (a.saturating_add(c), b.max(d))
        };
        XacroItems::new(pairs, measure).map(Self::Dict)
    }

    /// How many values it is, and how deep.
    fn measure(&self) -> (usize, usize) {
        match self {
            Self::List(items) | Self::Tuple(items) => (items.size, items.depth),
            Self::Dict(items) => (items.size, items.depth),
            Self::None | Self::Bool(_) | Self::Int(_) | Self::Float(_) | Self::Function(_) => (1, 0),
            // A text counts by its bytes.
            Self::Text(text) => (1 + text.len(), 0),
        }
    }

    /// What it is called in messages.
    pub fn noun(&self) -> &'static str {
        match self {
            Self::None => "None",
            Self::Bool(_) => "a boolean",
            Self::Int(_) => "a whole number",
            Self::Float(_) => "a number",
            Self::Text(_) => "a text",
            Self::List(_) => "a list",
            Self::Tuple(_) => "a tuple",
            Self::Dict(_) => "a dictionary",
            Self::Function(_) => "a function",
        }
    }

    /// Whether Python takes it for true.
    pub fn is_true(&self) -> bool {
        match self {
            Self::None => false,
            Self::Bool(value) => *value,
            Self::Int(value) => *value != 0,
            Self::Float(value) => *value != 0.0,
            Self::Text(text) => !text.is_empty(),
            Self::List(items) | Self::Tuple(items) => !items.as_slice().is_empty(),
            Self::Dict(items) => !items.as_slice().is_empty(),
            Self::Function(_) => true,
        }
    }

    /// As a number, if it is one; booleans are.
    pub fn number(&self) -> Option<f64> {
        if let Self::Float(value) = self { Some(*value) } else { self.whole().map(|n| n as f64) }
    }

    /// As a whole number, if it is one; booleans are.
    pub fn whole(&self) -> Option<i64> {
        match self {
            Self::Bool(value) => Some(i64::from(*value)),
            Self::Int(value) => Some(*value),
            Self::None
            | Self::Float(_)
            | Self::Text(_)
            | Self::List(_)
            | Self::Tuple(_)
            | Self::Dict(_)
            | Self::Function(_) => None,
        }
    }

    /// The values that a loop over it goes through.
    pub fn iterated(&self) -> EvalResult<Vec<XacroValue>> {
        match self {
            Self::List(items) | Self::Tuple(items) => Ok(items.as_slice().to_vec()),
            Self::Dict(pairs) => Ok(pairs.iter().map(|(key, _)| key.clone()).collect()),
            Self::Text(text) => text.chars().map(|c| Self::text(c.to_string())).collect(),
            Self::None | Self::Bool(_) | Self::Int(_) | Self::Float(_) | Self::Function(_) => {
                wrong(format!("{} cannot be gone through", self.noun()), "write a list")
            }
        }
    }
}
