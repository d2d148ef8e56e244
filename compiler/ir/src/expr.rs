//! Expressions: the one place where the language's operators get their meaning.

use serde::{Deserialize, Serialize};

pub use hrdsl_source::{BinaryOp, OperatorSort, UnaryOp};

use crate::{
    list::{self, List},
    value::Value,
};

pub use crate::eval_error::EvalError;

/// Index into [`Program::functions`](crate::Program::functions).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct FunctionId(pub u16);

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
    Call(NumberFunction, Vec<Expr>),
    /// `[a, b | rest]`; without a rest, of just these elements.
    List(Vec<Expr>, Option<Box<Expr>>),
    /// An element of an array of variables. Automata only.
    Element(Box<Lvalue>),
    /// A function of automata, applied: see [`AutomatonFunction`](crate::ta::AutomatonFunction).
    Apply(FunctionId, Vec<Expr>),
}

/// A variable, perhaps one that indices choose among several: `slot + Σ at · stride`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lvalue<E = Expr, V = u16> {
    /// The variable, or the first of the array.
    pub slot: V,
    #[serde(default = "Vec::new", skip_serializing_if = "Vec::is_empty")]
    pub indices: Vec<ArrayIndex<E>>,
}

impl<E, V> Lvalue<E, V> {
    /// A variable outright.
    #[must_use]
    pub fn slot(slot: V) -> Self {
        Self { slot, indices: Vec::new() }
    }
}

/// One index of an lvalue: less than `count` and not negative, or there is no such element, which is an error.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ArrayIndex<E = Expr> {
    pub at: E,
    pub count: u16,
    pub stride: u16,
}

/// What an expression's variables and functions mean.
pub trait EvalScope {
    /// The value of a variable, if it has one.
    fn var(&self, slot: u16) -> Option<Value>;

    /// The value of a function.
    ///
    /// # Errors
    /// Of its body; `Type` if there are no functions here.
    fn apply(&self, function: FunctionId, args: &[Value]) -> Result<Value, EvalError> {
        let _ = (function, args);
        Err(EvalError::Type)
    }
}

/// Variables alone.
struct VarsOnly<'a>(&'a dyn Fn(u16) -> Option<Value>);

impl EvalScope for VarsOnly<'_> {
    fn var(&self, slot: u16) -> Option<Value> {
        (self.0)(slot)
    }
}

/// Functions on numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NumberFunction {
    Abs,
    Min,
    Max,
    /// Of one or more numbers: the square root of the sum of their squares, always a float. Of one it is the magnitude.
    Norm,
}

/// The sign of an operator, and how tightly it binds: from 1, more binds tighter.
#[must_use]
pub fn sign(op: BinaryOp) -> (&'static str, u8) {
    match op {
        BinaryOp::Or => ("||", 1),
        BinaryOp::And => ("&&", 2),
        BinaryOp::Eq => ("==", 4),
        BinaryOp::Ne => ("!=", 4),
        BinaryOp::Lt => ("<", 4),
        BinaryOp::Le => ("<=", 4),
        BinaryOp::Gt => (">", 4),
        BinaryOp::Ge => (">=", 4),
        BinaryOp::Add => ("+", 5),
        BinaryOp::Sub => ("-", 5),
        BinaryOp::Mul => ("*", 6),
        BinaryOp::Div => ("/", 6),
        BinaryOp::Rem => ("%", 6),
    }
}

impl NumberFunction {
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            NumberFunction::Abs => "abs",
            NumberFunction::Min => "min",
            NumberFunction::Max => "max",
            NumberFunction::Norm => "norm",
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
    /// compares them as floats; floats compare by IEEE 754 (nothing is less than or equal to NaN); symbols know `==` and `!=`
    /// only.
    ///
    /// # Errors
    /// See [`EvalError`].
    pub fn eval(&self, var: &dyn Fn(u16) -> Option<Value>) -> Result<Value, EvalError> {
        self.eval_in(&VarsOnly(var))
    }

    /// As [`eval`](Self::eval), where there may be functions, too.
    ///
    /// # Errors
    /// See [`EvalError`].
    pub fn eval_in(&self, scope: &dyn EvalScope) -> Result<Value, EvalError> {
        match self {
            Expr::Const(v) => Ok(*v),
            Expr::Var(i) => scope.var(*i).ok_or(EvalError::Unbound(*i)),
            Expr::Unary(op, a) => unary(*op, a.eval_in(scope)?),
            Expr::Binary(BinaryOp::And, a, b) => {
                if boolean(a.eval_in(scope)?)? {
                    b.eval_in(scope)
                } else {
                    Ok(Value::Bool(false))
                }
            }
            Expr::Binary(BinaryOp::Or, a, b) => {
                if boolean(a.eval_in(scope)?)? {
                    Ok(Value::Bool(true))
                } else {
                    b.eval_in(scope)
                }
            }
            Expr::Binary(op, a, b) => binary(*op, a.eval_in(scope)?, b.eval_in(scope)?),
            Expr::If(c, a, b) => {
                if boolean(c.eval_in(scope)?)? {
                    a.eval_in(scope)
                } else {
                    b.eval_in(scope)
                }
            }
            Expr::Call(f, args) => {
                let args: Vec<Value> = args.iter().map(|a| a.eval_in(scope)).collect::<Result<_, _>>()?;
                call(*f, &args)
            }
            Expr::List(elements, rest) => {
                let elements: Vec<Value> =
                    elements.iter().map(|e| e.eval_in(scope)).collect::<Result<_, _>>()?;
                let rest = rest.as_ref().map_or(Ok(Value::List(List::EMPTY)), |r| r.eval_in(scope))?;
                let rest = rest.as_list().ok_or(EvalError::Type)?;
                Ok(Value::List(elements.iter().rev().fold(rest, |rest, e| List::cons(*e, rest))))
            }
            Expr::Element(place) => {
                let slot = place.resolve(scope)?;
                scope.var(slot).ok_or(EvalError::Unbound(slot))
            }
            Expr::Apply(function, args) => {
                let args: Vec<Value> = args.iter().map(|a| a.eval_in(scope)).collect::<Result<_, _>>()?;
                scope.apply(*function, &args)
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
            Expr::List(elements, rest) => {
                elements.iter().for_each(|e| e.each_var(f));
                rest.iter().for_each(|r| r.each_var(f));
            }
            Expr::Element(place) => place.each_var(f),
            Expr::Apply(_, args) => args.iter().for_each(|a| a.each_var(f)),
        }
    }
}

impl Lvalue {
    /// The slot that the indices choose.
    ///
    /// # Errors
    /// Of the indices' expressions; `Index` if there is no such element.
    pub fn resolve(&self, scope: &dyn EvalScope) -> Result<u16, EvalError> {
        let mut slot = self.slot;
        for index in &self.indices {
            let at = index.at.eval_in(scope)?.as_int().ok_or(EvalError::Type)?;
            match u16::try_from(at) {
                Ok(n) if n < index.count => slot += n * index.stride,
                Ok(_) | Err(_) => return Err(EvalError::Index { at, count: index.count }),
            }
        }
        Ok(slot)
    }

    /// Calls `f` with each variable that it may stand for, and those that its indices read.
    pub fn each_var(&self, f: &mut dyn FnMut(u16)) {
        let mut slots = vec![self.slot];
        for index in &self.indices {
            index.at.each_var(f);
            slots = slots.iter().flat_map(|s| (0..index.count).map(move |n| s + n * index.stride)).collect();
        }
        slots.into_iter().for_each(f);
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
        (
            UnaryOp::Not,
            Value::Int(_) | Value::Float(_) | Value::Symbol(_) | Value::Text(_) | Value::List(_),
        )
        | (UnaryOp::Neg, Value::Bool(_) | Value::Symbol(_) | Value::Text(_) | Value::List(_)) => {
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
        (Value::Symbol(a), Value::Symbol(b)) => compared(op, a == b),
        (Value::Text(a), Value::Text(b)) => compared(op, a == b),
        (Value::List(_), Value::List(_)) => compared(op, list::same(a, b)),
        (Value::Bool(_) | Value::Symbol(_) | Value::Text(_) | Value::List(_), _)
        | (_, Value::Bool(_) | Value::Symbol(_) | Value::Text(_) | Value::List(_)) => Err(EvalError::Type),
        (Value::Int(_) | Value::Float(_), Value::Int(_) | Value::Float(_)) => {
            let (Some(a), Some(b)) = (a.as_f64(), b.as_f64()) else { return Err(EvalError::Type) };
            on_floats(op, a, b)
        }
    }
}

fn on_bools(op: BinaryOp, a: bool, b: bool) -> Result<Value, EvalError> {
    Ok(Value::Bool(match op.sort() {
        OperatorSort::Logic => {
            if op == BinaryOp::And {
                a && b
            } else {
                a || b
            }
        }
        OperatorSort::Equality => (a == b) == (op == BinaryOp::Eq),
        OperatorSort::Arithmetic | OperatorSort::Order => return Err(EvalError::Type),
    }))
}

/// Symbols, strings and lists know `==` and `!=` only.
fn compared(op: BinaryOp, equal: bool) -> Result<Value, EvalError> {
    match op.sort() {
        OperatorSort::Equality => Ok(Value::Bool(equal == (op == BinaryOp::Eq))),
        OperatorSort::Arithmetic | OperatorSort::Order | OperatorSort::Logic => Err(EvalError::Type),
    }
}

/// Applies a binary operator to two whole numbers: the one place that says what overflows.
///
/// # Errors
/// See [`EvalError`].
#[inline]
pub fn on_ints(op: BinaryOp, a: i64, b: i64) -> Result<Value, EvalError> {
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
pub fn call(f: NumberFunction, args: &[Value]) -> Result<Value, EvalError> {
    match (f, args) {
        (NumberFunction::Abs, [Value::Int(n)]) => n.checked_abs().map(Value::Int).ok_or(EvalError::Overflow),
        (NumberFunction::Abs, [Value::Float(x)]) => Ok(Value::Float(x.abs())),
        (NumberFunction::Min, [a, b]) => pick(*a, *b, BinaryOp::Le),
        (NumberFunction::Max, [a, b]) => pick(*a, *b, BinaryOp::Ge),
        (NumberFunction::Norm, args) => norm(args),
        (NumberFunction::Abs | NumberFunction::Min | NumberFunction::Max, _) => Err(EvalError::Type),
    }
}

fn pick(a: Value, b: Value, keep_first: BinaryOp) -> Result<Value, EvalError> {
    Ok(if boolean(binary(keep_first, a, b)?)? { a } else { b })
}

/// Summed from the left, so that it is the same on every machine.
fn norm(args: &[Value]) -> Result<Value, EvalError> {
    let numbers: Vec<f64> =
        args.iter().map(|a| a.as_f64().ok_or(EvalError::Type)).collect::<Result<_, _>>()?;
    match numbers.as_slice() {
        [] => Err(EvalError::Type),
        // Its square could leave the range of floats.
        [x] => Ok(Value::Float(x.abs())),
        many => Ok(Value::Float(many.iter().fold(0.0, |sum, x| sum + x * x).sqrt())),
    }
}

#[cfg(test)]
mod tests {
    use crate::Symbol;

    use super::*;

    fn symbol(name: &str) -> Value {
        Value::Symbol(Symbol::intern(name))
    }

    const OPS: [BinaryOp; 13] = [
        BinaryOp::Add,
        BinaryOp::Sub,
        BinaryOp::Mul,
        BinaryOp::Div,
        BinaryOp::Rem,
        BinaryOp::Eq,
        BinaryOp::Ne,
        BinaryOp::Lt,
        BinaryOp::Le,
        BinaryOp::Gt,
        BinaryOp::Ge,
        BinaryOp::And,
        BinaryOp::Or,
    ];

    #[test]
    fn symbols_are_equal_or_not_and_nothing_else() {
        let (slow, fast) = (symbol("slow"), symbol("fast"));
        assert_eq!(binary(BinaryOp::Eq, slow, symbol("slow")), Ok(Value::Bool(true)));
        assert_eq!(binary(BinaryOp::Eq, slow, fast), Ok(Value::Bool(false)));
        assert_eq!(binary(BinaryOp::Ne, slow, fast), Ok(Value::Bool(true)));
        for op in OPS {
            if !matches!(op, BinaryOp::Eq | BinaryOp::Ne) {
                assert_eq!(binary(op, slow, fast), Err(EvalError::Type), "{op:?}");
            }
            for other in [Value::Bool(true), Value::Int(1), Value::Float(1.0)] {
                assert_eq!(binary(op, slow, other), Err(EvalError::Type), "{op:?}");
                assert_eq!(binary(op, other, slow), Err(EvalError::Type), "{op:?}");
            }
        }
        for op in [UnaryOp::Not, UnaryOp::Neg] {
            assert_eq!(unary(op, slow), Err(EvalError::Type));
        }
        for f in [NumberFunction::Abs, NumberFunction::Min, NumberFunction::Max, NumberFunction::Norm] {
            assert_eq!(call(f, &[slow]), Err(EvalError::Type));
            assert_eq!(call(f, &[slow, fast]), Err(EvalError::Type));
        }
    }

    #[test]
    fn a_condition_can_choose_a_symbol() {
        let is_slow = Expr::binary(BinaryOp::Eq, Expr::Var(0), Expr::Const(symbol("slow")));
        let other =
            Expr::If(Box::new(is_slow), Box::new(Expr::Const(symbol("fast"))), Box::new(Expr::Var(0)));
        assert_eq!(other.eval(&|_| Some(symbol("slow"))), Ok(symbol("fast")));
        assert_eq!(other.eval(&|_| Some(symbol("still"))), Ok(symbol("still")));
    }

    #[test]
    fn the_norm_is_the_root_of_the_sum_of_squares() {
        let norm = |args: &[f64]| {
            call(NumberFunction::Norm, &args.iter().map(|x| Value::Float(*x)).collect::<Vec<_>>())
        };
        assert_eq!(norm(&[3.0, -4.0]), Ok(Value::Float(5.0)));
        assert_eq!(norm(&[2.0, 3.0, 6.0]), Ok(Value::Float(7.0)));
        assert_eq!(call(NumberFunction::Norm, &[Value::Int(-3), Value::Float(4.0)]), Ok(Value::Float(5.0)));
        assert_eq!(norm(&[1.0, 1.0]), Ok(Value::Float(std::f64::consts::SQRT_2)));
        // Exact, where squaring would overflow or vanish.
        for x in [0.1, -0.1, 1e300, -1e-300, f64::MAX, f64::MIN_POSITIVE] {
            assert_eq!(norm(&[x]), Ok(Value::Float(x.abs())));
        }
        assert_eq!(call(NumberFunction::Norm, &[Value::Int(-2)]), Ok(Value::Float(2.0)));
        assert_eq!(call(NumberFunction::Norm, &[]), Err(EvalError::Type));
        assert_eq!(call(NumberFunction::Norm, &[Value::Bool(true)]), Err(EvalError::Type));
    }
}
