//! Conditions over samples of which some have no value: what they come to, and whether that rests on nothing.

use hrdsl_ir::{
    Expr, Nanos, Value,
    expr::{BinaryOp, EvalError, UnaryOp, binary},
    monitor::MonitorOutcome,
};

/// What a condition comes to. A comparison of what has no value (a NaN, a division by zero) is false, and `!=` is true, as everywhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeasuredTruth {
    pub truth: bool,
    /// It would perhaps be another one, had everything been measured.
    pub unvalued: bool,
}

impl MeasuredTruth {
    /// `None`: the condition reads a variable that has no sample yet.
    #[must_use]
    pub fn of(condition: &Expr, var: &dyn Fn(u16) -> Option<Value>) -> Option<Self> {
        match condition {
            Expr::Unary(UnaryOp::Not, a) => Self::of(a, var).map(|a| Self { truth: !a.truth, ..a }),
            Expr::Binary(op @ (BinaryOp::And | BinaryOp::Or), a, b) => {
                let first = Self::of(a, var)?;
                // What settles the whole by itself leaves the other part without a say.
                let settles = *op == BinaryOp::Or;
                if !first.unvalued && first.truth == settles {
                    return Some(first);
                }
                let second = Self::of(b, var)?;
                if !second.unvalued && second.truth == settles {
                    return Some(second);
                }
                let truth = if settles { first.truth || second.truth } else { first.truth && second.truth };
                Some(Self { truth, unvalued: first.unvalued || second.unvalued })
            }
            Expr::Binary(
                op
                @ (BinaryOp::Eq | BinaryOp::Ne | BinaryOp::Lt | BinaryOp::Le | BinaryOp::Gt | BinaryOp::Ge),
                a,
                b,
            ) => {
                let compared = side(a, var)?.zip(side(b, var)?).map(|(a, b)| binary(*op, a, b));
                Some(match compared {
                    Some(Ok(Value::Bool(truth))) => Self { truth, unvalued: false },
                    Some(_) | None => Self { truth: *op == BinaryOp::Ne, unvalued: true },
                })
            }
            Expr::Const(_)
            | Expr::Var(_)
            | Expr::Unary(UnaryOp::Neg, _)
            | Expr::Binary(..)
            | Expr::If(..)
            | Expr::Call(..)
            | Expr::List(..)
            | Expr::Element(_)
            | Expr::Apply(..) => match condition.eval(var) {
                Ok(value) => value.as_bool().map(|truth| Self { truth, unvalued: false }),
                Err(EvalError::Unbound(_)) => None,
                Err(_) => Some(Self { truth: false, unvalued: true }),
            },
        }
    }
}

/// What a requirement comes to if one of its comparisons had no value from this moment on: it may have failed all the same, and that it has
/// not is no pass.
#[must_use]
pub fn outcome_of_measured(outcome: MonitorOutcome, unvalued: Option<Nanos>) -> MonitorOutcome {
    match (outcome, unvalued) {
        (MonitorOutcome::Pass | MonitorOutcome::Vacuous, Some(_)) => MonitorOutcome::Inconclusive,
        (MonitorOutcome::Pass | MonitorOutcome::Vacuous, None)
        | (MonitorOutcome::Fail | MonitorOutcome::Inconclusive, _) => outcome,
    }
}

/// One side of a comparison; inside, `None`: it has no value, since something was not measured.
fn side(expr: &Expr, var: &dyn Fn(u16) -> Option<Value>) -> Option<Option<Value>> {
    match expr.eval(var) {
        Ok(value) => Some(Some(value).filter(|v| v.as_f64().is_none_or(|n| !n.is_nan()))),
        Err(EvalError::Unbound(_)) => None,
        Err(_) => Some(None),
    }
}

/// The number that an expression comes to, NaN if it has none. `None`: it reads a variable that has no sample yet.
pub(crate) fn measured_number(expr: &Expr, var: &dyn Fn(u16) -> Option<Value>) -> Option<f64> {
    match expr.eval(var) {
        Ok(value) => value.as_f64(),
        Err(EvalError::Unbound(_)) => None,
        Err(_) => Some(f64::NAN),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn below(limit: f64, variable: u16) -> Expr {
        Expr::binary(BinaryOp::Lt, Expr::Var(variable), Expr::float(limit))
    }

    fn both(op: BinaryOp, values: [f64; 2]) -> Option<MeasuredTruth> {
        let whole = Expr::binary(op, below(1.0, 0), below(1.0, 1));
        MeasuredTruth::of(&whole, &|i| values.get(usize::from(i)).map(|n| Value::Float(*n)))
    }

    #[test]
    fn what_settles_a_condition_leaves_what_was_not_measured_without_a_say() {
        let said = |truth, unvalued| Some(MeasuredTruth { truth, unvalued });
        assert_eq!(both(BinaryOp::And, [2.0, f64::NAN]), said(false, false));
        assert_eq!(both(BinaryOp::And, [f64::NAN, 2.0]), said(false, false));
        assert_eq!(both(BinaryOp::And, [0.0, f64::NAN]), said(false, true));
        assert_eq!(both(BinaryOp::Or, [0.0, f64::NAN]), said(true, false));
        assert_eq!(both(BinaryOp::Or, [f64::NAN, 0.0]), said(true, false));
        assert_eq!(both(BinaryOp::Or, [2.0, f64::NAN]), said(false, true));
    }

    #[test]
    fn only_unequal_holds_of_what_has_no_value() {
        let nothing = Expr::binary(BinaryOp::Div, Expr::Var(0), Expr::float(0.0));
        for op in [BinaryOp::Eq, BinaryOp::Ne, BinaryOp::Lt, BinaryOp::Le, BinaryOp::Gt, BinaryOp::Ge] {
            let compared = Expr::binary(op, nothing.clone(), Expr::float(1.0));
            let said = MeasuredTruth::of(&compared, &|_| Some(Value::Float(1.0)));
            assert_eq!(said, Some(MeasuredTruth { truth: op == BinaryOp::Ne, unvalued: true }), "{op:?}");
            assert_eq!(MeasuredTruth::of(&compared, &|_| None), None);
        }
    }
}
