//! Values, and the folding of constants. The operators mean what they mean at run time; the compiler's tests compare the two.

use std::{
    collections::BTreeMap,
    fmt,
    sync::{Mutex, PoisonError},
};

use hrdsl_source::Symbol;
use hrdsl_syntax::ast::{BinaryOp, UnaryOp};
use serde::Serialize;

use crate::Function;

/// A value of a scalar type, quantities in SI units; of an agent also a string or a list.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Value {
    Bool(bool),
    Int(i64),
    Float(f64),
    Symbol(Symbol),
    Text(Text),
    List(Elements),
}

/// A string.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(transparent)]
pub struct Text(pub Symbol);

impl fmt::Display for Text {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.0.name())
    }
}

/// The elements of a list that is written in the text, kept once, so that a value stays as small as a number.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Elements(&'static [Value]);

/// By how they are written; a text holds few.
static LISTS: Mutex<BTreeMap<String, &'static [Value]>> = Mutex::new(BTreeMap::new());

impl Elements {
    #[must_use]
    pub fn new(values: &[Value]) -> Self {
        let mut known = LISTS.lock().unwrap_or_else(PoisonError::into_inner);
        let make = || -> &'static [Value] { Box::leak(values.into()) };
        Self(known.entry(format!("{values:?}")).or_insert_with(make))
    }

    #[must_use]
    pub fn values(self) -> &'static [Value] {
        self.0
    }
}

impl fmt::Display for Elements {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let values: Vec<String> = self.0.iter().map(Value::to_string).collect();
        write!(f, "[{}]", values.join(", "))
    }
}

/// Why a constant has no value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FoldError {
    DivisionByZero,
    Overflow,
    /// Operands that do not fit; the type checker has said so.
    Type,
}

impl fmt::Display for FoldError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            FoldError::DivisionByZero => "this divides by zero",
            FoldError::Overflow => "this number is too large",
            FoldError::Type => "the operands do not fit the operator",
        })
    }
}

impl Value {
    /// The number, whether whole or not.
    #[must_use]
    pub fn number(self) -> Option<f64> {
        match self {
            Value::Int(n) => Some(n as f64),
            Value::Float(x) => Some(x),
            Value::Bool(_) | Value::Symbol(_) | Value::Text(_) | Value::List(_) => None,
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Value::Bool(b) => write!(f, "{b}"),
            Value::Int(n) => write!(f, "{n}"),
            Value::Float(x) => write!(f, "{x}"),
            Value::Symbol(symbol) => write!(f, "{symbol}"),
            Value::Text(text) => write!(f, "{text}"),
            Value::List(list) => write!(f, "{list}"),
        }
    }
}

pub(crate) fn unary(op: UnaryOp, v: Value) -> Result<Value, FoldError> {
    match (op, v) {
        (UnaryOp::Not, Value::Bool(b)) => Ok(Value::Bool(!b)),
        (UnaryOp::Neg, Value::Int(n)) => n.checked_neg().map(Value::Int).ok_or(FoldError::Overflow),
        (UnaryOp::Neg, Value::Float(x)) => Ok(Value::Float(-x)),
        (UnaryOp::Not, Value::Int(_) | Value::Float(_))
        | (UnaryOp::Not | UnaryOp::Neg, Value::Text(_) | Value::List(_))
        | (UnaryOp::Neg, Value::Bool(_))
        | (UnaryOp::Not | UnaryOp::Neg, Value::Symbol(_)) => Err(FoldError::Type),
    }
}

pub(crate) fn binary(op: BinaryOp, a: Value, b: Value) -> Result<Value, FoldError> {
    match (a, b) {
        (Value::Bool(a), Value::Bool(b)) => bools(op, a, b),
        (Value::Int(a), Value::Int(b)) => ints(op, a, b),
        (Value::Symbol(_), Value::Symbol(_))
        | (Value::Text(_), Value::Text(_))
        | (Value::List(_), Value::List(_)) => match op {
            BinaryOp::Eq => Ok(Value::Bool(same(a, b))),
            BinaryOp::Ne => Ok(Value::Bool(!same(a, b))),
            BinaryOp::Add
            | BinaryOp::Sub
            | BinaryOp::Mul
            | BinaryOp::Div
            | BinaryOp::Rem
            | BinaryOp::Lt
            | BinaryOp::Le
            | BinaryOp::Gt
            | BinaryOp::Ge
            | BinaryOp::And
            | BinaryOp::Or => Err(FoldError::Type),
        },
        (Value::Bool(_) | Value::Symbol(_) | Value::Text(_) | Value::List(_), _)
        | (_, Value::Bool(_) | Value::Symbol(_) | Value::Text(_) | Value::List(_)) => Err(FoldError::Type),
        (Value::Int(_) | Value::Float(_), Value::Int(_) | Value::Float(_)) => {
            let (Some(a), Some(b)) = (a.number(), b.number()) else { return Err(FoldError::Type) };
            floats(op, a, b)
        }
    }
}

/// Equal at run time: `1` and `1.0` are, and lists element by element.
pub(crate) fn same(a: Value, b: Value) -> bool {
    match (a, b) {
        (Value::List(a), Value::List(b)) => {
            a.0.len() == b.0.len() && a.0.iter().zip(b.0).all(|(a, b)| same(*a, *b))
        }
        (_, _) => a == b || matches!((a.number(), b.number()), (Some(x), Some(y)) if x == y),
    }
}

fn bools(op: BinaryOp, a: bool, b: bool) -> Result<Value, FoldError> {
    match op {
        BinaryOp::And => Ok(Value::Bool(a && b)),
        BinaryOp::Or => Ok(Value::Bool(a || b)),
        BinaryOp::Eq => Ok(Value::Bool(a == b)),
        BinaryOp::Ne => Ok(Value::Bool(a != b)),
        BinaryOp::Add | BinaryOp::Sub | BinaryOp::Mul | BinaryOp::Div | BinaryOp::Rem => Err(FoldError::Type),
        BinaryOp::Lt | BinaryOp::Le | BinaryOp::Gt | BinaryOp::Ge => Err(FoldError::Type),
    }
}

fn ints(op: BinaryOp, a: i64, b: i64) -> Result<Value, FoldError> {
    let int = |n: Option<i64>| n.map(Value::Int).ok_or(FoldError::Overflow);
    match op {
        BinaryOp::Add => int(a.checked_add(b)),
        BinaryOp::Sub => int(a.checked_sub(b)),
        BinaryOp::Mul => int(a.checked_mul(b)),
        BinaryOp::Div | BinaryOp::Rem if b == 0 => Err(FoldError::DivisionByZero),
        BinaryOp::Div => int(a.checked_div(b)),
        BinaryOp::Rem => int(a.checked_rem(b)),
        BinaryOp::And | BinaryOp::Or => Err(FoldError::Type),
        BinaryOp::Eq => Ok(Value::Bool(a == b)),
        BinaryOp::Ne => Ok(Value::Bool(a != b)),
        BinaryOp::Lt => Ok(Value::Bool(a < b)),
        BinaryOp::Le => Ok(Value::Bool(a <= b)),
        BinaryOp::Gt => Ok(Value::Bool(a > b)),
        BinaryOp::Ge => Ok(Value::Bool(a >= b)),
    }
}

fn floats(op: BinaryOp, a: f64, b: f64) -> Result<Value, FoldError> {
    Ok(match op {
        BinaryOp::Add => Value::Float(a + b),
        BinaryOp::Sub => Value::Float(a - b),
        BinaryOp::Mul => Value::Float(a * b),
        BinaryOp::Div | BinaryOp::Rem if b == 0.0 => return Err(FoldError::DivisionByZero),
        BinaryOp::Div => Value::Float(a / b),
        BinaryOp::Rem => Value::Float(a % b),
        BinaryOp::And | BinaryOp::Or => return Err(FoldError::Type),
        BinaryOp::Eq => Value::Bool(a == b),
        BinaryOp::Ne => Value::Bool(a != b),
        BinaryOp::Lt => Value::Bool(a < b),
        BinaryOp::Le => Value::Bool(a <= b),
        BinaryOp::Gt => Value::Bool(a > b),
        BinaryOp::Ge => Value::Bool(a >= b),
    })
}

pub(crate) fn call(f: Function, args: &[Value]) -> Result<Value, FoldError> {
    match (f, args) {
        (Function::Abs, [Value::Int(n)]) => n.checked_abs().map(Value::Int).ok_or(FoldError::Overflow),
        (Function::Abs, [Value::Float(x)]) => Ok(Value::Float(x.abs())),
        (Function::Min, [a, b]) => pick(*a, *b, BinaryOp::Le),
        (Function::Max, [a, b]) => pick(*a, *b, BinaryOp::Ge),
        (Function::Norm, parts) if !parts.is_empty() => {
            let squares = parts.iter().map(|v| v.number().map(|x| x * x)).sum::<Option<f64>>();
            squares.map(|sum| Value::Float(sum.sqrt())).ok_or(FoldError::Type)
        }
        (Function::Abs | Function::Min | Function::Max | Function::Norm, _) => Err(FoldError::Type),
    }
}

fn pick(a: Value, b: Value, keep_first: BinaryOp) -> Result<Value, FoldError> {
    Ok(if binary(keep_first, a, b)? == Value::Bool(true) { a } else { b })
}
