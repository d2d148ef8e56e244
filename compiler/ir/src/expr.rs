//! Expressions: the one place where the language's operators get their meaning.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::Value;

/// An expression over constants and the variables of its context.
///
/// What `Var(i)` stands for depends on where the expression is: a stimulus's parameters and samples, a plan's
/// variables, an automaton's variables, a signal's terms. The owner documents it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Expr {
    Const(Value),
    Var(u16),
    Unary(UnaryOp, Box<Expr>),
    Binary(BinaryOp, Box<Expr>, Box<Expr>),
    /// `if cond { a } else { b }`
    If(Box<Expr>, Box<Expr>, Box<Expr>),
    Call(Function, Vec<Expr>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum UnaryOp {
    Not,
    Neg,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BinaryOp {
    Add,
    Sub,
    Mul,
    Div,
    Rem,
    Eq,
    Ne,
    Lt,
    Le,
    Gt,
    Ge,
    And,
    Or,
}

/// Functions on numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Function {
    Abs,
    Min,
    Max,
}

/// Why an expression has no value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EvalError {
    /// A variable without a value.
    Unbound(u16),
    DivisionByZero,
    Overflow,
    /// An operand of the wrong type: a fault of whoever made the expression, since the checker rules it out.
    Type,
}

impl fmt::Display for EvalError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            EvalError::Unbound(v) => write!(f, "variable {v} has no value"),
            EvalError::DivisionByZero => f.write_str("division by zero"),
            EvalError::Overflow => f.write_str("integer overflow"),
            EvalError::Type => f.write_str("operand of the wrong type"),
        }
    }
}

impl std::error::Error for EvalError {}

impl Expr {
    #[must_use]
    pub fn int(n: i64) -> Self {
        Expr::Const(Value::Int(n))
    }

    #[must_use]
    pub fn bool(b: bool) -> Self {
        Expr::Const(Value::Bool(b))
    }

    #[must_use]
    pub fn float(x: f64) -> Self {
        Expr::Const(Value::Float(x))
    }

    #[must_use]
    pub fn binary(op: BinaryOp, a: Expr, b: Expr) -> Self {
        Expr::Binary(op, Box::new(a), Box::new(b))
    }

    /// The value, with `var(i)` giving the variables' values.
    ///
    /// `&&` and `||` are short-circuit; `/` on integers truncates towards zero; a comparison of an integer with a float
    /// compares them as floats; floats compare by IEEE 754 (nothing is less than or equal to NaN).
    ///
    /// # Errors
    /// See [`EvalError`].
    pub fn eval(&self, var: &dyn Fn(u16) -> Option<Value>) -> Result<Value, EvalError> {
        match self {
            Expr::Const(v) => Ok(*v),
            Expr::Var(i) => var(*i).ok_or(EvalError::Unbound(*i)),
            Expr::Unary(op, a) => unary(*op, a.eval(var)?),
            Expr::Binary(BinaryOp::And, a, b) => {
                if boolean(a.eval(var)?)? {
                    b.eval(var)
                } else {
                    Ok(Value::Bool(false))
                }
            }
            Expr::Binary(BinaryOp::Or, a, b) => {
                if boolean(a.eval(var)?)? {
                    Ok(Value::Bool(true))
                } else {
                    b.eval(var)
                }
            }
            Expr::Binary(op, a, b) => binary(*op, a.eval(var)?, b.eval(var)?),
            Expr::If(c, a, b) => {
                if boolean(c.eval(var)?)? {
                    a.eval(var)
                } else {
                    b.eval(var)
                }
            }
            Expr::Call(f, args) => {
                let args: Vec<Value> = args.iter().map(|a| a.eval(var)).collect::<Result<_, _>>()?;
                call(*f, &args)
            }
        }
    }

    /// Calls `f` with each variable read, as often as it occurs.
    pub fn each_var(&self, f: &mut dyn FnMut(u16)) {
        match self {
            Expr::Const(_) => {}
            Expr::Var(i) => f(*i),
            Expr::Unary(_, a) => a.each_var(f),
            Expr::Binary(_, a, b) => {
                a.each_var(f);
                b.each_var(f);
            }
            Expr::If(c, a, b) => {
                c.each_var(f);
                a.each_var(f);
                b.each_var(f);
            }
            Expr::Call(_, args) => args.iter().for_each(|a| a.each_var(f)),
        }
    }
}

fn boolean(v: Value) -> Result<bool, EvalError> {
    v.as_bool().ok_or(EvalError::Type)
}

/// Applies a unary operator.
///
/// # Errors
/// `Type` or `Overflow`.
pub fn unary(op: UnaryOp, v: Value) -> Result<Value, EvalError> {
    match (op, v) {
        (UnaryOp::Not, Value::Bool(b)) => Ok(Value::Bool(!b)),
        (UnaryOp::Neg, Value::Int(n)) => n.checked_neg().map(Value::Int).ok_or(EvalError::Overflow),
        (UnaryOp::Neg, Value::Float(x)) => Ok(Value::Float(-x)),
        (UnaryOp::Not, Value::Int(_) | Value::Float(_)) | (UnaryOp::Neg, Value::Bool(_)) => {
            Err(EvalError::Type)
        }
    }
}

/// Applies a binary operator to two values (`&&` and `||` too, without short circuit).
///
/// # Errors
/// See [`EvalError`].
pub fn binary(op: BinaryOp, a: Value, b: Value) -> Result<Value, EvalError> {
    match (a, b) {
        (Value::Bool(a), Value::Bool(b)) => on_bools(op, a, b),
        (Value::Int(a), Value::Int(b)) => on_ints(op, a, b),
        (Value::Bool(_), _) | (_, Value::Bool(_)) => Err(EvalError::Type),
        (Value::Int(_) | Value::Float(_), Value::Int(_) | Value::Float(_)) => {
            let (Some(a), Some(b)) = (a.as_f64(), b.as_f64()) else { return Err(EvalError::Type) };
            on_floats(op, a, b)
        }
    }
}

fn on_bools(op: BinaryOp, a: bool, b: bool) -> Result<Value, EvalError> {
    Ok(Value::Bool(match op {
        BinaryOp::And => a && b,
        BinaryOp::Or => a || b,
        BinaryOp::Eq => a == b,
        BinaryOp::Ne => a != b,
        BinaryOp::Add
        | BinaryOp::Sub
        | BinaryOp::Mul
        | BinaryOp::Div
        | BinaryOp::Rem
        | BinaryOp::Lt
        | BinaryOp::Le
        | BinaryOp::Gt
        | BinaryOp::Ge => return Err(EvalError::Type),
    }))
}

fn on_ints(op: BinaryOp, a: i64, b: i64) -> Result<Value, EvalError> {
    let int = |n: Option<i64>| n.map(Value::Int).ok_or(EvalError::Overflow);
    match op {
        BinaryOp::Add => int(a.checked_add(b)),
        BinaryOp::Sub => int(a.checked_sub(b)),
        BinaryOp::Mul => int(a.checked_mul(b)),
        BinaryOp::Div | BinaryOp::Rem if b == 0 => Err(EvalError::DivisionByZero),
        BinaryOp::Div => int(a.checked_div(b)),
        BinaryOp::Rem => int(a.checked_rem(b)),
        BinaryOp::Eq => Ok(Value::Bool(a == b)),
        BinaryOp::Ne => Ok(Value::Bool(a != b)),
        BinaryOp::Lt => Ok(Value::Bool(a < b)),
        BinaryOp::Le => Ok(Value::Bool(a <= b)),
        BinaryOp::Gt => Ok(Value::Bool(a > b)),
        BinaryOp::Ge => Ok(Value::Bool(a >= b)),
        BinaryOp::And | BinaryOp::Or => Err(EvalError::Type),
    }
}

fn on_floats(op: BinaryOp, a: f64, b: f64) -> Result<Value, EvalError> {
    Ok(match op {
        BinaryOp::Add => Value::Float(a + b),
        BinaryOp::Sub => Value::Float(a - b),
        BinaryOp::Mul => Value::Float(a * b),
        BinaryOp::Div | BinaryOp::Rem if b == 0.0 => return Err(EvalError::DivisionByZero),
        BinaryOp::Div => Value::Float(a / b),
        BinaryOp::Rem => Value::Float(a % b),
        BinaryOp::Eq => Value::Bool(a == b),
        BinaryOp::Ne => Value::Bool(a != b),
        BinaryOp::Lt => Value::Bool(a < b),
        BinaryOp::Le => Value::Bool(a <= b),
        BinaryOp::Gt => Value::Bool(a > b),
        BinaryOp::Ge => Value::Bool(a >= b),
        BinaryOp::And | BinaryOp::Or => return Err(EvalError::Type),
    })
}

/// Applies a function to its arguments.
///
/// # Errors
/// See [`EvalError`].
pub fn call(f: Function, args: &[Value]) -> Result<Value, EvalError> {
    match (f, args) {
        (Function::Abs, [Value::Int(n)]) => n.checked_abs().map(Value::Int).ok_or(EvalError::Overflow),
        (Function::Abs, [Value::Float(x)]) => Ok(Value::Float(x.abs())),
        (Function::Min, [a, b]) => pick(*a, *b, BinaryOp::Le),
        (Function::Max, [a, b]) => pick(*a, *b, BinaryOp::Ge),
        (Function::Abs | Function::Min | Function::Max, _) => Err(EvalError::Type),
    }
}

fn pick(a: Value, b: Value, keep_first: BinaryOp) -> Result<Value, EvalError> {
    Ok(if boolean(binary(keep_first, a, b)?)? { a } else { b })
}
