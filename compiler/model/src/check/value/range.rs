//! In which range a whole number lies, whatever the values of the variables in it.

use crate::check::state::scope::ExprEnv;
use crate::{BinaryOp, InferredType, NumberFunction, TypedExpr, TypedExprKind, UnaryOp, Value};

/// The smallest and largest value that is possible; `None` if that is not known.
pub(in crate::check) fn of(e: &TypedExpr, env: &ExprEnv) -> Option<(i64, i64)> {
    if e.ty != InferredType::Int {
        return None;
    }
    match &e.kind {
        TypedExprKind::Const(Value::Int(n)) => Some((*n, *n)),
        TypedExprKind::Const(
            Value::Bool(_) | Value::Float(_) | Value::Symbol(_) | Value::Text(_) | Value::List(_),
        )
        | TypedExprKind::List(..)
        | TypedExprKind::Term(_)
        | TypedExprKind::Error => None,
        TypedExprKind::Leaf(leaf) => env.of_leaf(*leaf).and_then(|l| l.range),
        // The elements of an array are of one type.
        TypedExprKind::Element(place) => env.of_leaf(place.slot).and_then(|l| l.range),
        TypedExprKind::Apply(_, _, ty) => ty.range(),
        TypedExprKind::Unary(UnaryOp::Neg, a) => {
            let (lo, hi) = of(a, env)?;
            Some((hi.checked_neg()?, lo.checked_neg()?))
        }
        TypedExprKind::Unary(UnaryOp::Not, _) => None,
        TypedExprKind::Binary(op, a, b) => binary(*op, of(a, env)?, of(b, env)?),
        TypedExprKind::If(_, a, b) => {
            let (a, b) = (of(a, env)?, of(b, env)?);
            Some((a.0.min(b.0), a.1.max(b.1)))
        }
        TypedExprKind::Call(f, args) => {
            let ranges: Vec<(i64, i64)> = args.iter().map(|a| of(a, env)).collect::<Option<_>>()?;
            match (f, ranges.as_slice()) {
                (NumberFunction::Min, [a, b]) => Some((a.0.min(b.0), a.1.min(b.1))),
                (NumberFunction::Max, [a, b]) => Some((a.0.max(b.0), a.1.max(b.1))),
                (NumberFunction::Abs, [(lo, hi)]) => {
                    let (low, high) = (lo.checked_abs()?, hi.checked_abs()?);
                    let least = if *lo <= 0 && *hi >= 0 { 0 } else { low.min(high) };
                    Some((least, low.max(high)))
                }
                (
                    NumberFunction::Min | NumberFunction::Max | NumberFunction::Abs | NumberFunction::Norm,
                    _,
                ) => None,
            }
        }
    }
}

fn binary(op: BinaryOp, a: (i64, i64), b: (i64, i64)) -> Option<(i64, i64)> {
    match op {
        BinaryOp::Add => Some((a.0.checked_add(b.0)?, a.1.checked_add(b.1)?)),
        BinaryOp::Sub => Some((a.0.checked_sub(b.1)?, a.1.checked_sub(b.0)?)),
        BinaryOp::Mul => {
            let ends =
                [a.0.checked_mul(b.0)?, a.0.checked_mul(b.1)?, a.1.checked_mul(b.0)?, a.1.checked_mul(b.1)?];
            Some((*ends.iter().min()?, *ends.iter().max()?))
        }
        // The remainder has the sign of the dividend.
        BinaryOp::Rem if b.0 > 0 => {
            let most = b.1 - 1;
            Some((a.0.clamp(-most, 0), a.1.clamp(0, most)))
        }
        BinaryOp::Div if b.0 > 0 && b.0 == b.1 => Some((a.0 / b.0, a.1 / b.0)),
        BinaryOp::Rem
        | BinaryOp::Div
        | BinaryOp::Eq
        | BinaryOp::Ne
        | BinaryOp::Lt
        | BinaryOp::Le
        | BinaryOp::Gt
        | BinaryOp::Ge
        | BinaryOp::And
        | BinaryOp::Or => None,
    }
}
