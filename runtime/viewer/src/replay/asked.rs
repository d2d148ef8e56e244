//! What is asked for: comparisons with a limit, truths and events, and how they are put together, in a requirement and in what the world tells an
//! event by.

use hrdsl_ir::{
    Expr,
    expr::{BinaryOp, NumberFunction, UnaryOp},
    formula::MetricFormula,
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

/// What has to be so.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum KeptCondition {
    All(Vec<KeptCondition>),
    Any(Vec<KeptCondition>),
    Compared(LimitComparison),
    /// An expression has this truth.
    Truth(Expr, bool),
    /// An event happens, or does not: its text.
    Happens(String, bool),
    /// An operator of a formula that looks at other moments, with its truth and its operands.
    Window {
        text: String,
        truth: bool,
        formula: Option<Box<MetricFormula>>,
        of: Vec<KeptCondition>,
    },
}

impl KeptCondition {
    /// That an expression has this truth.
    pub fn of(expr: &Expr, truth: bool) -> Self {
        match expr {
            Expr::Unary(UnaryOp::Not, of) => Self::of(of, !truth),
            Expr::Binary(BinaryOp::And, a, b) => {
                Self::joined(truth, [Self::of(a, truth), Self::of(b, truth)])
            }
            Expr::Binary(BinaryOp::Or, a, b) => {
                Self::joined(!truth, [Self::of(a, truth), Self::of(b, truth)])
            }
            Expr::Binary(BinaryOp::Lt, a, b) => Self::less(a, b, true, truth),
            Expr::Binary(BinaryOp::Le, a, b) => Self::less(a, b, false, truth),
            Expr::Binary(BinaryOp::Gt, a, b) => Self::less(b, a, true, truth),
            Expr::Binary(BinaryOp::Ge, a, b) => Self::less(b, a, false, truth),
            Expr::Unary(..)
            | Expr::Binary(..)
            | Expr::Const(_)
            | Expr::Var(_)
            | Expr::Call(..)
            | Expr::If(..)
            | Expr::List(..)
            | Expr::Element(_)
            | Expr::Apply(..) => Self::Truth(expr.clone(), truth),
        }
    }

    /// That a margin is not negative: it is `a − b` of a comparison, or the least or greatest of several.
    pub fn of_margin(expr: &Expr) -> Option<Self> {
        let all = |parts: &[Expr]| parts.iter().map(Self::of_margin).collect::<Option<Vec<_>>>();
        match expr {
            Expr::Binary(BinaryOp::Sub, large, small) => Some(ordered(small, large, false)),
            Expr::Call(NumberFunction::Min, parts) => Some(Self::joined(true, all(parts)?)),
            Expr::Call(NumberFunction::Max, parts) => Some(Self::joined(false, all(parts)?)),
            Expr::Call(NumberFunction::Abs | NumberFunction::Norm, _)
            | Expr::Const(_)
            | Expr::Var(_)
            | Expr::Unary(..)
            | Expr::Binary(..)
            | Expr::If(..)
            | Expr::List(..)
            | Expr::Element(_)
            | Expr::Apply(..) => None,
        }
    }

    /// That the first is less than the second, or as great unless `strict`; or that it is not.
    pub fn less(small: &Expr, large: &Expr, strict: bool, truth: bool) -> Self {
        if truth { ordered(small, large, strict) } else { ordered(large, small, !strict) }
    }

    /// All of them, or one of them; what is joined in the same way is one list, and has nothing twice.
    pub fn joined(all: bool, parts: impl IntoIterator<Item = Self>) -> Self {
        let mut flat: Vec<Self> = Vec::new();
        for part in parts {
            let inner = match part {
                Self::All(parts) if all => parts,
                Self::Any(parts) if !all => parts,
                other @ (Self::All(_)
                | Self::Any(_)
                | Self::Compared(_)
                | Self::Truth(..)
                | Self::Happens(..)
                | Self::Window { .. }) => vec![other],
            };
            for one in inner {
                if !flat.contains(&one) {
                    flat.push(one);
                }
            }
        }
        if flat.len() == 1 {
            return flat.remove(0);
        }
        if all { Self::All(flat) } else { Self::Any(flat) }
    }
}

/// What has a value without any signal.
pub(super) fn constant(expr: &Expr) -> Option<f64> {
    expr.eval(&|_| None).ok()?.as_f64()
}

/// `small` is less than `large`, or as great. Without a limit between them, it is their difference that is held to 0.
fn ordered(small: &Expr, large: &Expr, strict: bool) -> KeptCondition {
    let (below, above) = if strict {
        (LimitRelation::Below, LimitRelation::Above)
    } else {
        (LimitRelation::AtMost, LimitRelation::AtLeast)
    };
    match (constant(small), constant(large)) {
        (Some(a), Some(b)) => {
            let truth = if strict { a < b } else { a <= b };
            KeptCondition::Truth(Expr::bool(truth), true)
        }
        (Some(limit), None) => split(large, above, limit),
        (None, Some(limit)) => split(small, below, limit),
        (None, None) => {
            let measured = Expr::binary(BinaryOp::Sub, small.clone(), large.clone());
            KeptCondition::Compared(LimitComparison { measured, relation: below, limit: 0.0 })
        }
    }
}

/// The least of several is at least something where all of them are, and at most something where one of them is: each is told of by itself.
fn split(measured: &Expr, relation: LimitRelation, limit: f64) -> KeptCondition {
    let is_floor = matches!(relation, LimitRelation::Above | LimitRelation::AtLeast);
    match measured {
        Expr::Call(function @ (NumberFunction::Min | NumberFunction::Max), parts) => {
            let all = is_floor == (*function == NumberFunction::Min);
            let parts = parts.iter().filter(|part| constant(part).is_none());
            KeptCondition::joined(all, parts.map(|part| split(part, relation, limit)))
        }
        Expr::Call(..)
        | Expr::Const(_)
        | Expr::Var(_)
        | Expr::Unary(..)
        | Expr::Binary(..)
        | Expr::If(..)
        | Expr::List(..)
        | Expr::Element(_)
        | Expr::Apply(..) => {
            KeptCondition::Compared(LimitComparison { measured: measured.clone(), relation, limit })
        }
    }
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::{
        Expr,
        expr::{BinaryOp, NumberFunction, UnaryOp},
    };

    use super::{KeptCondition, LimitComparison};
    use crate::requirement::LimitRelation;

    fn compared(measured: Expr, relation: LimitRelation, limit: f64) -> KeptCondition {
        KeptCondition::Compared(LimitComparison { measured, relation, limit })
    }

    fn less(a: Expr, b: Expr) -> Expr {
        Expr::binary(BinaryOp::Lt, a, b)
    }

    #[test]
    fn what_is_compared_may_be_any_number_over_signals() {
        let norm = Expr::Call(NumberFunction::Norm, vec![Expr::Var(0), Expr::Var(1)]);
        let limit = Expr::binary(BinaryOp::Add, Expr::float(0.25), Expr::float(0.005));
        let asked = KeptCondition::of(&less(norm.clone(), limit.clone()), true);
        assert_eq!(asked, compared(norm.clone(), LimitRelation::Below, 0.255));
        let margin = Expr::binary(BinaryOp::Sub, limit, norm.clone());
        assert_eq!(KeptCondition::of_margin(&margin), Some(compared(norm, LimitRelation::AtMost, 0.255)));
        let two = KeptCondition::of(&less(Expr::Var(0), Expr::Var(1)), true);
        let difference = Expr::binary(BinaryOp::Sub, Expr::Var(0), Expr::Var(1));
        assert_eq!(two, compared(difference, LimitRelation::Below, 0.0));
    }

    #[test]
    fn the_least_of_several_has_all_of_them_or_one_of_them() {
        let least = Expr::Call(NumberFunction::Min, vec![Expr::Var(0), Expr::Var(1)]);
        let near = less(least, Expr::float(0.05));
        let parts = |relation| [Expr::Var(0), Expr::Var(1)].map(|of| compared(of, relation, 0.05)).to_vec();
        assert_eq!(KeptCondition::of(&near, true), KeptCondition::Any(parts(LimitRelation::Below)));
        assert_eq!(KeptCondition::of(&near, false), KeptCondition::All(parts(LimitRelation::AtLeast)));
    }

    #[test]
    fn what_must_not_be_is_kept_by_the_opposite_of_each_part() {
        let tilted = Expr::binary(BinaryOp::Gt, Expr::Var(0), Expr::float(0.9));
        let kept = KeptCondition::of(&tilted, false);
        assert_eq!(kept, compared(Expr::Var(0), LimitRelation::AtMost, 0.9));
        let not = Expr::Unary(UnaryOp::Not, Box::new(tilted.clone()));
        assert_eq!(KeptCondition::of(&not, true), kept);
        let both = Expr::binary(BinaryOp::And, tilted.clone(), Expr::Var(1));
        let truth = KeptCondition::Truth(Expr::Var(1), false);
        assert_eq!(KeptCondition::of(&both, false), KeptCondition::Any(vec![kept.clone(), truth]));
        let twice = Expr::binary(BinaryOp::And, tilted.clone(), tilted);
        assert_eq!(KeptCondition::of(&twice, false), kept, "nothing is said twice");
    }
}
