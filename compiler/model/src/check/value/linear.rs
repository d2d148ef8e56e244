//! Times that variables have a part in, as sums: a constant, and whole numbers with constant factors.

use hrdsl_source::Span;

use crate::check::value::expr::MAX_TIME;
use crate::{BinaryOp, Expr, ExprKind, Kind, Time, TimeTerm, UnaryOp, Value};

/// `constant + Σ factor · value`, in SI units; each value is a whole number.
#[derive(Clone, Debug, Default)]
pub(in crate::check) struct Linear {
    constant: f64,
    terms: Vec<(f64, Expr)>,
}

/// Why a sum is no time that an engine can count with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BadTime {
    /// A factor is no whole number of nanoseconds.
    Fraction,
    TooLong,
}

impl Linear {
    fn constant(constant: f64) -> Self {
        Self { constant, terms: Vec::new() }
    }

    /// Adds another, multiplied.
    pub fn add(&mut self, other: Linear, times: f64) {
        self.constant += other.constant * times;
        self.terms.extend(other.terms.into_iter().map(|(f, e)| (f * times, e)));
    }

    fn scaled(mut self, times: f64) -> Self {
        self.constant *= times;
        self.terms.iter_mut().for_each(|(f, _)| *f *= times);
        self
    }

    fn product(self, other: Self) -> Self {
        let mut terms: Vec<(f64, Expr)> = Vec::new();
        for (f, a) in &self.terms {
            terms.extend(other.terms.iter().map(|(g, b)| (f * g, times(a, b))));
        }
        terms.extend(self.terms.into_iter().map(|(f, e)| (f * other.constant, e)));
        terms.extend(other.terms.into_iter().map(|(f, e)| (f * self.constant, e)));
        Self { constant: self.constant * other.constant, terms }
    }

    /// `if condition { self } else { other }`: where it does not apply, a part is not evaluated.
    fn either(self, other: Self, condition: &Expr) -> Self {
        let number = |n| Expr::value(Value::Int(n), Kind::Int, condition.span);
        let choice = |a: Expr, b: Expr| Expr {
            span: condition.span,
            kind: ExprKind::If(Box::new(condition.clone()), Box::new(a), Box::new(b)),
            ty: Kind::Int,
        };
        let mut terms = vec![(self.constant - other.constant, choice(number(1), number(0)))];
        terms.extend(self.terms.into_iter().map(|(f, e)| (f, choice(e, number(0)))));
        terms.extend(other.terms.into_iter().map(|(f, e)| (f, choice(number(0), e))));
        Self { constant: other.constant, terms }
    }

    /// In nanoseconds, multiplied by `sign`.
    pub fn time(self, sign: f64) -> Result<Time, BadTime> {
        let nanos = |seconds: f64| {
            let fits = seconds.abs() <= MAX_TIME;
            fits.then(|| (seconds * sign * 1e9).round() as i64).ok_or(BadTime::TooLong)
        };
        let mut time = Time::constant(nanos(self.constant)?);
        for (factor, value) in self.terms.into_iter().filter(|(f, _)| *f != 0.0) {
            // What the conversion from decimal seconds costs is no fraction.
            let exact = factor.abs() * 1e9;
            if (exact - exact.round()).abs() > 1e-4_f64.max(exact * 1e-15) {
                return Err(BadTime::Fraction);
            }
            time.terms.push(TimeTerm { factor: nanos(factor)?, value });
        }
        Ok(time)
    }
}

fn times(a: &Expr, b: &Expr) -> Expr {
    let kind = ExprKind::Binary(BinaryOp::Mul, Box::new(a.clone()), Box::new(b.clone()));
    Expr { kind, ty: Kind::Int, span: a.span.to(b.span) }
}

/// A number as such a sum.
///
/// # Errors
/// The part that is none; `None` if it has a diagnostic already.
pub(in crate::check) fn linear(e: &Expr) -> Result<Linear, Option<Span>> {
    if let (Some(n), true) = (e.constant().and_then(Value::as_f64), e.ty.is_number()) {
        return Ok(Linear::constant(n));
    }
    match e.ty {
        Kind::Int => return Ok(Linear { constant: 0.0, terms: vec![(1.0, e.clone())] }),
        Kind::Unknown => return Err(None),
        Kind::Float(_) => {}
        Kind::Bool | Kind::Enum(_) | Kind::Text | Kind::List(_) => return Err(Some(e.span)),
    }
    match &e.kind {
        ExprKind::Unary(UnaryOp::Neg, a) => Ok(linear(a)?.scaled(-1.0)),
        ExprKind::Binary(op @ (BinaryOp::Add | BinaryOp::Sub), a, b) => {
            let mut sum = linear(a)?;
            sum.add(linear(b)?, if *op == BinaryOp::Add { 1.0 } else { -1.0 });
            Ok(sum)
        }
        ExprKind::Binary(BinaryOp::Mul, a, b) => Ok(linear(a)?.product(linear(b)?)),
        ExprKind::Binary(BinaryOp::Div, a, b) => match b.constant().and_then(Value::as_f64) {
            Some(by) if by != 0.0 => Ok(linear(a)?.scaled(1.0 / by)),
            Some(_) | None => Err(Some(e.span)),
        },
        ExprKind::If(condition, a, b) => Ok(linear(a)?.either(linear(b)?, condition)),
        ExprKind::Error => Err(None),
        _ => Err(Some(e.span)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Dim, Leaf};

    fn float(x: f64) -> Expr {
        Expr::value(Value::Float(x), Kind::Float(Dim::TIME), Span::default())
    }

    fn var() -> Expr {
        Expr { kind: ExprKind::Leaf(Leaf::Own(0)), ty: Kind::Int, span: Span::default() }
    }

    fn op(op: BinaryOp, a: Expr, b: Expr) -> Expr {
        let kind = ExprKind::Binary(op, Box::new(a), Box::new(b));
        Expr { kind, ty: Kind::Float(Dim::TIME), span: Span::default() }
    }

    #[test]
    fn factors_are_whole_nanoseconds() {
        let time = |x| linear(&op(BinaryOp::Mul, var(), float(x))).unwrap().time(1.0);
        let one = |factor| [TimeTerm { factor, value: var() }];
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
        let half = op(BinaryOp::Div, sum, Expr::value(Value::Int(2), Kind::Int, Span::default()));
        let time = linear(&half).unwrap().time(-1.0).unwrap();
        assert_eq!(
            (time.nanos, time.terms),
            (-1_500_000_000, vec![TimeTerm { factor: -1_000_000_000, value: var() }])
        );
        assert!(linear(&op(BinaryOp::Div, float(1.0), var())).is_err());
        assert!(linear(&op(BinaryOp::Rem, float(1.0), float(2.0))).is_err());
    }
}
