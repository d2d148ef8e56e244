//! Values as whole numbers, how two of them compare, and what divides all of several.

use hrdsl_ir::{Enumeration, Value, ta::AutomatonVar};

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum NumberType {
    Bool,
    Int,
    Enum(Enumeration),
    /// An index into the model's constants: of a float, string or list that an event carries.
    Constant,
}

impl NumberType {
    pub(crate) fn of(var: &AutomatonVar) -> Self {
        match var.enumeration {
            Some(e) => NumberType::Enum(e),
            None if var.is_bool => NumberType::Bool,
            None => NumberType::Int,
        }
    }

    /// The number of a value. `None`: it is of another type.
    pub(crate) fn number(self, value: Value) -> Option<i64> {
        match (self, value) {
            (NumberType::Bool, Value::Bool(b)) => Some(i64::from(b)),
            (NumberType::Int, Value::Int(n)) => Some(n),
            (NumberType::Enum(e), Value::Symbol(s)) => e.index_of(s).and_then(|n| i64::try_from(n).ok()),
            (NumberType::Bool | NumberType::Int | NumberType::Enum(_) | NumberType::Constant, _) => None,
        }
    }

    /// The value of a number.
    pub(crate) fn value(self, n: i64, constants: &[Value]) -> Option<Value> {
        let index = usize::try_from(n);
        match self {
            NumberType::Bool => Some(Value::Bool(n != 0)),
            NumberType::Int => Some(Value::Int(n)),
            NumberType::Enum(e) => index.ok().and_then(|n| e.values().get(n)).copied().map(Value::Symbol),
            NumberType::Constant => index.ok().and_then(|n| constants.get(n)).copied(),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NumberComparison {
    Eq,
    Ne,
    Lt,
    Le,
    Gt,
    Ge,
}

impl NumberComparison {
    /// Whether it compares values of any type.
    pub(crate) fn is_equality(self) -> bool {
        matches!(self, NumberComparison::Eq | NumberComparison::Ne)
    }

    /// What holds where this one does not.
    pub(crate) fn negated(self) -> Self {
        match self {
            NumberComparison::Eq => NumberComparison::Ne,
            NumberComparison::Ne => NumberComparison::Eq,
            NumberComparison::Lt => NumberComparison::Ge,
            NumberComparison::Le => NumberComparison::Gt,
            NumberComparison::Gt => NumberComparison::Le,
            NumberComparison::Ge => NumberComparison::Lt,
        }
    }

    pub(crate) fn holds(self, a: i64, b: i64) -> bool {
        match self {
            NumberComparison::Eq => a == b,
            NumberComparison::Ne => a != b,
            NumberComparison::Lt => a < b,
            NumberComparison::Le => a <= b,
            NumberComparison::Gt => a > b,
            NumberComparison::Ge => a >= b,
        }
    }
}

/// The greatest common divisor, which of 0 and a number is the number.
pub(crate) fn gcd(mut a: u64, mut b: u64) -> u64 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}
