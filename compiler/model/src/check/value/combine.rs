//! Operators on values of several parts.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self};

use crate::check::{
    checker::Checker,
    state::{item::ExprItem, scope::ExprEnv},
    value::expr,
};
use crate::{
    BinaryOp, Dimension, InferredType, NumberFunction, TypedExpr, TypedExprKind, noun::Noun, report::types,
};

impl Checker<'_> {
    /// An operator of which one side at least has several parts.
    pub(in crate::check) fn combine(
        &mut self,
        op: BinaryOp,
        a: ExprItem,
        b: ExprItem,
        span: Span,
        env: &mut ExprEnv,
    ) -> ExprItem {
        match op {
            BinaryOp::Eq | BinaryOp::Ne => self.equal(op, a, b, span, env),
            BinaryOp::Add | BinaryOp::Sub => match (a, b) {
                (ExprItem::One(a), ExprItem::One(b)) => ExprItem::One(self.operate(op, a, b, span, env)),
                (
                    ExprItem::Array(a, _) | ExprItem::Tuple(a, _),
                    ExprItem::Array(b, _) | ExprItem::Tuple(b, _),
                ) if a.len() == b.len() => {
                    let pairs = a.into_iter().zip(b);
                    ExprItem::Array(pairs.map(|(a, b)| self.combine(op, a, b, span, env)).collect(), span)
                }
                (a, b) => self.clash(expr::symbol(op), &a, &b, span),
            },
            BinaryOp::Mul | BinaryOp::Div => match (a, b) {
                (ExprItem::One(a), ExprItem::One(b)) => ExprItem::One(self.operate(op, a, b, span, env)),
                (ExprItem::Array(a, _) | ExprItem::Tuple(a, _), ExprItem::One(by)) => {
                    let by = ExprItem::One(by);
                    if !self.may_copy(&by, a.len(), span) {
                        return ExprItem::error(span);
                    }
                    let scaled = a.into_iter();
                    ExprItem::Array(
                        scaled.map(|a| self.combine(op, a, by.clone(), span, env)).collect(),
                        span,
                    )
                }
                (ExprItem::One(by), ExprItem::Array(b, _) | ExprItem::Tuple(b, _)) if op == BinaryOp::Mul => {
                    let by = ExprItem::One(by);
                    if !self.may_copy(&by, b.len(), span) {
                        return ExprItem::error(span);
                    }
                    let scaled = b.into_iter();
                    ExprItem::Array(
                        scaled.map(|b| self.combine(op, by.clone(), b, span, env)).collect(),
                        span,
                    )
                }
                (a, b) => self.clash(expr::symbol(op), &a, &b, span),
            },
            BinaryOp::Rem
            | BinaryOp::Lt
            | BinaryOp::Le
            | BinaryOp::Gt
            | BinaryOp::Ge
            | BinaryOp::And
            | BinaryOp::Or => self.clash(expr::symbol(op), &a, &b, span),
        }
    }

    /// Equal if all parts are.
    fn equal(&mut self, op: BinaryOp, a: ExprItem, b: ExprItem, span: Span, env: &mut ExprEnv) -> ExprItem {
        let same = match (&a, &b) {
            (ExprItem::Record(i, ..), ExprItem::Record(j, ..)) => i == j,
            (ExprItem::One(_), _) | (_, ExprItem::One(_)) | (ExprItem::Record(..), ExprItem::Array(..)) => {
                false
            }
            (ExprItem::Array(..), ExprItem::Record(..)) => false,
            (
                ExprItem::Record(_, p, _) | ExprItem::Array(p, _) | ExprItem::Tuple(p, _),
                ExprItem::Tuple(q, _),
            )
            | (ExprItem::Tuple(p, _), ExprItem::Record(_, q, _) | ExprItem::Array(q, _))
            | (ExprItem::Array(p, _), ExprItem::Array(q, _)) => p.len() == q.len(),
        };
        let (left, right) = match (a, b) {
            (ExprItem::One(l), ExprItem::One(r)) => return ExprItem::One(self.operate(op, l, r, span, env)),
            (
                ExprItem::Record(_, p, _) | ExprItem::Array(p, _) | ExprItem::Tuple(p, _),
                ExprItem::Record(_, q, _) | ExprItem::Array(q, _) | ExprItem::Tuple(q, _),
            ) if same => (p, q),
            (a, b) => return self.clash(expr::symbol(op), &a, &b, span),
        };
        let join = if op == BinaryOp::Eq { BinaryOp::And } else { BinaryOp::Or };
        let mut all: Option<TypedExpr> = None;
        for (l, r) in left.into_iter().zip(right) {
            let ExprItem::One(one) = self.equal(op, l, r, span, env) else { return ExprItem::error(span) };
            if one.kind == TypedExprKind::Error {
                return ExprItem::error(span);
            }
            all = Some(match all {
                Some(before) => self.operate(join, before, one, span, env),
                None => one,
            });
        }
        all.map_or(ExprItem::error(span), ExprItem::One)
    }

    /// `norm(v)`: the length of a vector.
    pub(in crate::check) fn norm(
        &mut self,
        args: &[ast::ExprSyntax],
        span: Span,
        env: &mut ExprEnv,
    ) -> TypedExpr {
        let [arg] = args else {
            self.report(types::counts(Noun::Function, "norm", 1, args.len(), span));
            return TypedExpr::error(span);
        };
        let item = self.item(arg, env);
        if item.is_unknown() {
            self.not_known(&item);
            return TypedExpr::error(span);
        }
        let number = |part: &ExprItem| matches!(part, ExprItem::One(e) if e.ty.is_number());
        let vector = matches!(item, ExprItem::Array(..) | ExprItem::Tuple(..));
        if !vector || !item.parts().is_some_and(|parts| parts.iter().all(number)) {
            let got = self.shown(&item);
            self.report(types::not_a_vector(&got, arg.span));
            return TypedExpr::error(span);
        }
        let mut parts = Vec::new();
        item.flatten(&mut parts);
        if parts.iter().any(|p| p.kind == TypedExprKind::Error) {
            return TypedExpr::error(span);
        }
        let known = parts.iter().map(|p| p.ty).find(|ty| *ty != InferredType::Unknown);
        let ty = match known {
            Some(InferredType::Int) | None => InferredType::Float(Dimension::NUMBER),
            Some(ty) => ty,
        };
        let floats = parts.into_iter().map(|part| self.fit(part, ty, env)).collect();
        self.applied(NumberFunction::Norm, floats, ty, span)
    }
}
