//! In which range a whole number lies, whatever the values of the variables in it.

use crate::check::state::scope::ExprEnv;
use crate::{
    BinaryOp, InferredType, NumberFunction, TypedExpr, TypedExprKind, UnaryOp, Value, interval::ValueInterval,
};

/// The smallest and largest value that is possible; `None` if that is not known.
pub(in crate::check) fn of(e: &TypedExpr, env: &ExprEnv) -> Option<(i64, i64)> {
    let known = interval(e, env)?;
    Some((i64::try_from(known.lo).ok()?, i64::try_from(known.hi).ok()?))
}

fn interval(e: &TypedExpr, env: &ExprEnv) -> Option<ValueInterval> {
    if e.ty != InferredType::Int {
        return None;
    }
    let declared = |(lo, hi): (i64, i64)| ValueInterval { lo: lo.into(), hi: hi.into() };
    match &e.kind {
        TypedExprKind::Const(value @ Value::Int(_)) => Some(ValueInterval::value(*value)),
        TypedExprKind::Const(
            Value::Bool(_) | Value::Float(_) | Value::Symbol(_) | Value::Text(_) | Value::List(_),
        )
        | TypedExprKind::List(..)
        | TypedExprKind::Term(_)
        | TypedExprKind::Error => None,
        TypedExprKind::Leaf(leaf) => env.of_leaf(*leaf).and_then(|l| l.range).map(declared),
        // The elements of an array are of one type.
        TypedExprKind::Element(place) => env.of_leaf(place.slot).and_then(|l| l.range).map(declared),
        TypedExprKind::Apply(_, _, ty) => ty.range().map(declared),
        TypedExprKind::Unary(UnaryOp::Neg, a) => bounded(interval(a, env)?.neg()),
        TypedExprKind::Unary(UnaryOp::Not, _) => None,
        TypedExprKind::Binary(op, a, b) => binary(*op, interval(a, env)?, interval(b, env)?),
        TypedExprKind::If(_, a, b) => Some(interval(a, env)?.join(interval(b, env)?)),
        TypedExprKind::Call(f, args) => {
            let args: Vec<ValueInterval> = args.iter().map(|a| interval(a, env)).collect::<Option<_>>()?;
            match (f, args.as_slice()) {
                (NumberFunction::Min, [a, b]) => Some(a.min(*b)),
                (NumberFunction::Max, [a, b]) => Some(a.max(*b)),
                (NumberFunction::Abs, [a]) => bounded(a.abs()),
                (
                    NumberFunction::Min | NumberFunction::Max | NumberFunction::Abs | NumberFunction::Norm,
                    _,
                ) => None,
            }
        }
    }
}

fn binary(op: BinaryOp, a: ValueInterval, b: ValueInterval) -> Option<ValueInterval> {
    bounded(match op {
        BinaryOp::Add => a.add(b),
        BinaryOp::Sub => a.sub(b),
        BinaryOp::Mul => a.mul(b),
        // Where there may be no value, nothing is promised of it: an index has to lie in its array for certain.
        BinaryOp::Div | BinaryOp::Rem if b.lo <= 0 && b.hi >= 0 => return None,
        BinaryOp::Div => a.div(b),
        BinaryOp::Rem => a.rem(b),
        BinaryOp::Eq
        | BinaryOp::Ne
        | BinaryOp::Lt
        | BinaryOp::Le
        | BinaryOp::Gt
        | BinaryOp::Ge
        | BinaryOp::And
        | BinaryOp::Or => return None,
    })
}

/// What may go beyond 64 bits has been cut there: then it is not known.
fn bounded(value: ValueInterval) -> Option<ValueInterval> {
    (!value.is_open()).then_some(value)
}
