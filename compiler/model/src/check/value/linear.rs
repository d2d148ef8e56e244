//! Times that variables have a part in, as sums: a constant, and whole numbers with constant factors.

use hrdsl_source::Span;

use crate::check::value::quantity::MAX_TIME;
use crate::report::automata::BadTime;
use crate::{BinaryOp, InferredType, TypedExpr, TypedExprKind, TypedTime, TypedTimeTerm, UnaryOp, Value};

/// `constant + Σ factor · value`, in SI units; each value is a whole number.
#[derive(Clone, Debug, Default)]
pub(in crate::check) struct LinearTime {
    constant: f64,
    terms: Vec<(f64, TypedExpr)>,
}

impl LinearTime {
    fn constant(constant: f64) -> Self {
        Self { constant, terms: Vec::new() }
    }

    /// Adds another, multiplied.
    pub fn add(&mut self, other: LinearTime, times: f64) {
        self.constant += other.constant * times;
        self.terms.extend(other.terms.into_iter().map(|(f, e)| (f * times, e)));
    }

    fn scaled(mut self, times: f64) -> Self {
        self.constant *= times;
        self.terms.iter_mut().for_each(|(f, _)| *f *= times);
        self
    }

    fn product(self, other: Self) -> Self {
        let mut terms: Vec<(f64, TypedExpr)> = Vec::new();
        for (f, a) in &self.terms {
            terms.extend(other.terms.iter().map(|(g, b)| (f * g, times(a, b))));
        }
        terms.extend(self.terms.into_iter().map(|(f, e)| (f * other.constant, e)));
        terms.extend(other.terms.into_iter().map(|(f, e)| (f * self.constant, e)));
        Self { constant: self.constant * other.constant, terms }
    }

    /// `if condition { self } else { other }`: where it does not apply, a part is not evaluated.
    fn either(self, other: Self, condition: &TypedExpr) -> Self {
        let number = |n| TypedExpr::value(Value::Int(n), InferredType::Int, condition.span);
        let choice = |a: TypedExpr, b: TypedExpr| TypedExpr {
            span: condition.span,
            kind: TypedExprKind::If(Box::new(condition.clone()), Box::new(a), Box::new(b)),
            ty: InferredType::Int,
        };
        let mut terms = vec![(self.constant - other.constant, choice(number(1), number(0)))];
        terms.extend(self.terms.into_iter().map(|(f, e)| (f, choice(e, number(0)))));
        terms.extend(other.terms.into_iter().map(|(f, e)| (f, choice(number(0), e))));
        Self { constant: other.constant, terms }
    }

    /// In nanoseconds, multiplied by `sign`.
    pub fn time(self, sign: f64) -> Result<TypedTime, BadTime> {
        let nanos = |seconds: f64| {
            let fits = seconds.abs() <= MAX_TIME;
            fits.then(|| (seconds * sign * 1e9).round() as i64).ok_or(BadTime::TooLong)
        };
        let mut time = TypedTime::constant(nanos(self.constant)?);
        for (factor, value) in self.terms.into_iter().filter(|(f, _)| *f != 0.0) {
            // What the conversion from decimal seconds costs is no fraction.
            let exact = factor.abs() * 1e9;
            if (exact - exact.round()).abs() > 1e-4_f64.max(exact * 1e-15) {
                return Err(BadTime::Fraction);
            }
            time.terms.push(TypedTimeTerm { factor: nanos(factor)?, value });
        }
        Ok(time)
    }
}

fn times(a: &TypedExpr, b: &TypedExpr) -> TypedExpr {
    let kind = TypedExprKind::Binary(BinaryOp::Mul, Box::new(a.clone()), Box::new(b.clone()));
    TypedExpr { kind, ty: InferredType::Int, span: a.span.to(b.span) }
}

/// A number as such a sum.
///
/// # Errors
/// The part that is none; `None` if it has a diagnostic already.
pub(in crate::check) fn linear(e: &TypedExpr) -> Result<LinearTime, Option<Span>> {
    if let (Some(n), true) = (e.constant().and_then(Value::as_f64), e.ty.is_number()) {
        return Ok(LinearTime::constant(n));
    }
    match e.ty {
        InferredType::Int => return Ok(LinearTime { constant: 0.0, terms: vec![(1.0, e.clone())] }),
        InferredType::Unknown => return Err(None),
        InferredType::Float(_) => {}
        InferredType::Bool | InferredType::Enum(_) | InferredType::Text | InferredType::List(_) => {
            return Err(Some(e.span));
        }
    }
    match &e.kind {
        TypedExprKind::Unary(UnaryOp::Neg, a) => Ok(linear(a)?.scaled(-1.0)),
        TypedExprKind::Binary(op @ (BinaryOp::Add | BinaryOp::Sub), a, b) => {
            let mut sum = linear(a)?;
            sum.add(linear(b)?, if *op == BinaryOp::Add { 1.0 } else { -1.0 });
            Ok(sum)
        }
        TypedExprKind::Binary(BinaryOp::Mul, a, b) => Ok(linear(a)?.product(linear(b)?)),
        TypedExprKind::Binary(BinaryOp::Div, a, b) => match b.constant().and_then(Value::as_f64) {
            Some(by) if by != 0.0 => Ok(linear(a)?.scaled(1.0 / by)),
            Some(_) | None => Err(Some(e.span)),
        },
        TypedExprKind::If(condition, a, b) => Ok(linear(a)?.either(linear(b)?, condition)),
        TypedExprKind::Error => Err(None),
        TypedExprKind::Const(_) | TypedExprKind::Leaf(_) | TypedExprKind::Term(_) => Err(Some(e.span)),
        TypedExprKind::Unary(UnaryOp::Not, _) | TypedExprKind::Binary(..) => Err(Some(e.span)),
        TypedExprKind::Call(..) | TypedExprKind::List(..) => Err(Some(e.span)),
        TypedExprKind::Element(_) | TypedExprKind::Apply(..) => Err(Some(e.span)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Dimension, VariableRef};

    fn float(x: f64) -> TypedExpr {
        TypedExpr::value(Value::Float(x), InferredType::Float(Dimension::TIME), Span::default())
    }

    fn var() -> TypedExpr {
        TypedExpr {
            kind: TypedExprKind::Leaf(VariableRef::Own(0)),
            ty: InferredType::Int,
            span: Span::default(),
        }
    }

    fn op(op: BinaryOp, a: TypedExpr, b: TypedExpr) -> TypedExpr {
        let kind = TypedExprKind::Binary(op, Box::new(a), Box::new(b));
        TypedExpr { kind, ty: InferredType::Float(Dimension::TIME), span: Span::default() }
    }

    #[test]
    fn factors_are_whole_nanoseconds() {
        let time = |x| linear(&op(BinaryOp::Mul, var(), float(x))).unwrap().time(1.0);
        let one = |factor| [TypedTimeTerm { factor, value: var() }];
        assert_eq!(time(0.1).unwrap().terms, one(100_000_000));
        assert_eq!(time(1e-9).unwrap().terms, one(1));
        assert_eq!(time(0.5e-9), Err(BadTime::Fraction));
        assert_eq!(time(1.0 / 3.0), Err(BadTime::Fraction));
        assert_eq!(time(2e9), Err(BadTime::TooLong));
        assert_eq!(time(123_456.789).unwrap().terms[0].factor, 123_456_789_000_000);
    }

    #[test]
    fn products_and_quotients_are_taken_apart() {
        let sum = op(BinaryOp::Add, op(BinaryOp::Mul, float(2.0), var()), float(3.0));
        let half =
            op(BinaryOp::Div, sum, TypedExpr::value(Value::Int(2), InferredType::Int, Span::default()));
        let time = linear(&half).unwrap().time(-1.0).unwrap();
        assert_eq!(
            (time.nanos, time.terms),
            (-1_500_000_000, vec![TypedTimeTerm { factor: -1_000_000_000, value: var() }])
        );
        assert!(linear(&op(BinaryOp::Div, float(1.0), var())).is_err());
        assert!(linear(&op(BinaryOp::Rem, float(1.0), float(2.0))).is_err());
    }
}
