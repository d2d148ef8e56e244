//! Why an expression has no value.

use std::fmt;

/// Why an expression has no value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EvalError {
    /// A variable without a value.
    Unbound(u16),
    DivisionByZero,
    Overflow,
    /// An index that is no element of its array, which has `count`.
    Index {
        at: i64,
        count: u16,
    },
    /// A function that does not end within [`STEPS`](crate::exec::STEPS) statements, or calls more than
    /// [`DEPTH`](crate::exec::DEPTH) deep.
    Endless,
    /// A value outside the range of a local variable, parameter or result of a function.
    Range(i64),
    /// A value outside the range of a variable that a function assigns; the slot is its memory's.
    Outside {
        slot: u16,
        value: i64,
    },
    /// An operand of the wrong type: a fault of whoever made the expression, since the checker rules it out.
    Type,
}

impl fmt::Display for EvalError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            EvalError::Unbound(v) => write!(f, "variable {v} has no value"),
            EvalError::DivisionByZero => f.write_str("division by zero"),
            EvalError::Overflow => f.write_str("integer overflow"),
            EvalError::Index { at, count } => write!(f, "index {at} is none of 0..{}", i32::from(*count) - 1),
            EvalError::Endless => f.write_str("a function does not end"),
            EvalError::Range(n) => write!(f, "{n} is outside the range of a variable of a function"),
            EvalError::Outside { slot, value } => {
                write!(f, "{value} is outside the range of variable {slot}")
            }
            EvalError::Type => f.write_str("operand of the wrong type"),
        }
    }
}
