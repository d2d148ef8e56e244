//! Comparisons with a limit: in the margin of a requirement, and in what the world tells an event by.

use hrdsl_ir::{
    Expr,
    expr::{BinaryOp, NumberFunction, UnaryOp},
};

use crate::requirement::LimitRelation;

/// A number over the signals of a requirement, or of a rule of the world, and the limit that it is held to.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LimitComparison {
    pub measured: Expr,
    pub relation: LimitRelation,
    pub limit: f64,
}

impl LimitComparison {
    /// By how much a value keeps to it; less than 0 if it does not.
    pub fn margin(&self, value: f64) -> f64 {
        match self.relation {
            LimitRelation::Below | LimitRelation::AtMost => self.limit - value,
            LimitRelation::Above | LimitRelation::AtLeast => value - self.limit,
        }
    }
}

/// Those in a margin: it is `a − b` of a comparison, or the least or greatest of several.
pub(super) fn in_margin(expr: &Expr, found: &mut Vec<LimitComparison>) {
    match expr {
        Expr::Binary(BinaryOp::Sub, large, small) => ordered(small, large, found),
        Expr::Call(_, parts) => parts.iter().for_each(|part| in_margin(part, found)),
        Expr::Const(_)
        | Expr::Var(_)
        | Expr::Unary(..)
        | Expr::Binary(..)
        | Expr::If(..)
        | Expr::List(..)
        | Expr::Element(_)
        | Expr::Apply(..) => {}
    }
}

/// The one that is kept as long as a condition has this truth; `None` if that takes more than one.
pub(super) fn in_condition(expr: &Expr, truth: bool) -> Option<LimitComparison> {
    let (small, large) = match expr {
        Expr::Unary(UnaryOp::Not, of) => return in_condition(of, !truth),
        Expr::Binary(BinaryOp::Lt | BinaryOp::Le, a, b) => (a, b),
        Expr::Binary(BinaryOp::Gt | BinaryOp::Ge, a, b) => (b, a),
        Expr::Unary(..)
        | Expr::Binary(..)
        | Expr::Const(_)
        | Expr::Var(_)
        | Expr::Call(..)
        | Expr::If(..)
        | Expr::List(..)
        | Expr::Element(_)
        | Expr::Apply(..) => return None,
    };
    let mut found = Vec::new();
    if truth {
        ordered(small, large, &mut found)
    } else {
        ordered(large, small, &mut found)
    }
    found.pop().filter(|_| found.is_empty())
}

/// What has a value without any signal.
fn constant(expr: &Expr) -> Option<f64> {
    expr.eval(&|_| None).ok()?.as_f64()
}

/// `small` is not to be more than `large`. Without a limit between them, their difference is not to be more than 0.
fn ordered(small: &Expr, large: &Expr, found: &mut Vec<LimitComparison>) {
    match (constant(small), constant(large)) {
        (Some(_), Some(_)) => {}
        (Some(limit), None) => split(large, LimitRelation::AtLeast, limit, found),
        (None, Some(limit)) => split(small, LimitRelation::AtMost, limit, found),
        (None, None) => {
            let difference = Expr::binary(BinaryOp::Sub, small.clone(), large.clone());
            found.push(LimitComparison { measured: difference, relation: LimitRelation::AtMost, limit: 0.0 });
        }
    }
}

/// The least of several is at least something where all of them are: each is told of by itself.
fn split(measured: &Expr, relation: LimitRelation, limit: f64, found: &mut Vec<LimitComparison>) {
    let all = if relation == LimitRelation::AtLeast { NumberFunction::Min } else { NumberFunction::Max };
    match measured {
        Expr::Call(function, parts) if *function == all => {
            let parts = parts.iter().filter(|part| constant(part).is_none());
            parts.for_each(|part| split(part, relation, limit, found));
        }
        Expr::Call(..)
        | Expr::Const(_)
        | Expr::Var(_)
        | Expr::Unary(..)
        | Expr::Binary(..)
        | Expr::If(..)
        | Expr::List(..)
        | Expr::Element(_)
        | Expr::Apply(..) => found.push(LimitComparison { measured: measured.clone(), relation, limit }),
    }
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::{
        Expr,
        expr::{BinaryOp, NumberFunction, UnaryOp},
    };

    use super::{LimitComparison, in_condition, in_margin};
    use crate::requirement::LimitRelation;

    fn sub(a: Expr, b: Expr) -> Expr {
        Expr::binary(BinaryOp::Sub, a, b)
    }

    fn told(margin: &Expr) -> Vec<(Expr, LimitRelation, f64)> {
        let mut found = Vec::new();
        in_margin(margin, &mut found);
        found.into_iter().map(|one| (one.measured, one.relation, one.limit)).collect()
    }

    #[test]
    fn what_is_compared_may_be_any_number_over_signals() {
        let norm = Expr::Call(NumberFunction::Norm, vec![Expr::Var(0), Expr::Var(1)]);
        let limit = Expr::binary(BinaryOp::Add, Expr::float(0.25), Expr::float(0.005));
        assert_eq!(told(&sub(limit, norm.clone())), [(norm, LimitRelation::AtMost, 0.255)]);
        let two = told(&sub(Expr::Var(1), Expr::Var(0)));
        assert_eq!(two, [(sub(Expr::Var(0), Expr::Var(1)), LimitRelation::AtMost, 0.0)]);
    }

    #[test]
    fn the_least_of_several_is_split_only_where_all_must_keep() {
        let least = Expr::Call(NumberFunction::Min, vec![Expr::Var(0), Expr::Var(1)]);
        let kept = told(&sub(least.clone(), Expr::float(0.05)));
        assert_eq!(kept.len(), 2);
        assert!(
            kept.iter().all(|(_, relation, limit)| *relation == LimitRelation::AtLeast && *limit == 0.05)
        );
        let one = told(&sub(Expr::float(0.05), least.clone()));
        assert_eq!(one, [(least, LimitRelation::AtMost, 0.05)], "one of them is enough");
    }

    #[test]
    fn an_edge_is_kept_by_the_opposite_of_its_condition() {
        let tilted = Expr::binary(BinaryOp::Gt, Expr::Var(0), Expr::float(0.9));
        let kept = in_condition(&tilted, false).unwrap();
        assert_eq!(
            kept,
            LimitComparison { measured: Expr::Var(0), relation: LimitRelation::AtMost, limit: 0.9 }
        );
        assert!((kept.margin(1.0) + 0.1).abs() < 1e-12);
        let not = Expr::Unary(UnaryOp::Not, Box::new(tilted.clone()));
        assert_eq!(in_condition(&not, true), Some(kept));
        let both = Expr::binary(BinaryOp::And, tilted.clone(), tilted);
        assert_eq!(in_condition(&both, false), None, "either would keep it");
    }
}
