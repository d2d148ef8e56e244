//! Operators on values of several parts.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self};

use crate::check::{
    checker::Checker,
    state::{item::Item, scope::Env},
    value::expr,
};
use crate::{BinaryOp, Dim, Expr, ExprKind, Kind, NumberFunction, noun::Noun, report::types};

impl Checker<'_> {
    /// An operator of which one side at least has several parts.
    pub(in crate::check) fn combine(
        &mut self,
        op: BinaryOp,
        a: Item,
        b: Item,
        span: Span,
        env: &mut Env,
    ) -> Item {
        match op {
            BinaryOp::Eq | BinaryOp::Ne => self.equal(op, a, b, span, env),
            BinaryOp::Add | BinaryOp::Sub => match (a, b) {
                (Item::One(a), Item::One(b)) => Item::One(self.operate(op, a, b, span, env)),
                (Item::Array(a, _) | Item::Tuple(a, _), Item::Array(b, _) | Item::Tuple(b, _))
                    if a.len() == b.len() =>
                {
                    let pairs = a.into_iter().zip(b);
                    Item::Array(pairs.map(|(a, b)| self.combine(op, a, b, span, env)).collect(), span)
                }
                (a, b) => self.clash(expr::symbol(op), &a, &b, span),
            },
            BinaryOp::Mul | BinaryOp::Div => match (a, b) {
                (Item::One(a), Item::One(b)) => Item::One(self.operate(op, a, b, span, env)),
                (Item::Array(a, _) | Item::Tuple(a, _), Item::One(by)) => {
                    let by = Item::One(by);
                    if !self.may_copy(&by, a.len(), span) {
                        return Item::error(span);
                    }
                    let scaled = a.into_iter();
                    Item::Array(scaled.map(|a| self.combine(op, a, by.clone(), span, env)).collect(), span)
                }
                (Item::One(by), Item::Array(b, _) | Item::Tuple(b, _)) if op == BinaryOp::Mul => {
                    let by = Item::One(by);
                    if !self.may_copy(&by, b.len(), span) {
                        return Item::error(span);
                    }
                    let scaled = b.into_iter();
                    Item::Array(scaled.map(|b| self.combine(op, by.clone(), b, span, env)).collect(), span)
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
    fn equal(&mut self, op: BinaryOp, a: Item, b: Item, span: Span, env: &mut Env) -> Item {
        let same = match (&a, &b) {
            (Item::Record(i, ..), Item::Record(j, ..)) => i == j,
            (Item::One(_), _) | (_, Item::One(_)) | (Item::Record(..), Item::Array(..)) => false,
            (Item::Array(..), Item::Record(..)) => false,
            (Item::Record(_, p, _) | Item::Array(p, _) | Item::Tuple(p, _), Item::Tuple(q, _))
            | (Item::Tuple(p, _), Item::Record(_, q, _) | Item::Array(q, _))
            | (Item::Array(p, _), Item::Array(q, _)) => p.len() == q.len(),
        };
        let (left, right) = match (a, b) {
            (Item::One(l), Item::One(r)) => return Item::One(self.operate(op, l, r, span, env)),
            (
                Item::Record(_, p, _) | Item::Array(p, _) | Item::Tuple(p, _),
                Item::Record(_, q, _) | Item::Array(q, _) | Item::Tuple(q, _),
            ) if same => (p, q),
            (a, b) => return self.clash(expr::symbol(op), &a, &b, span),
        };
        let join = if op == BinaryOp::Eq { BinaryOp::And } else { BinaryOp::Or };
        let mut all: Option<Expr> = None;
        for (l, r) in left.into_iter().zip(right) {
            let Item::One(one) = self.equal(op, l, r, span, env) else { return Item::error(span) };
            if one.kind == ExprKind::Error {
                return Item::error(span);
            }
            all = Some(match all {
                Some(before) => self.operate(join, before, one, span, env),
                None => one,
            });
        }
        all.map_or(Item::error(span), Item::One)
    }

    /// `norm(v)`: the length of a vector.
    pub(in crate::check) fn norm(&mut self, args: &[ast::Expr], span: Span, env: &mut Env) -> Expr {
        let [arg] = args else {
            self.report(types::counts(Noun::Function, "norm", 1, args.len(), span));
            return Expr::error(span);
        };
        let item = self.item(arg, env);
        if item.is_unknown() {
            self.not_known(&item);
            return Expr::error(span);
        }
        let number = |part: &Item| matches!(part, Item::One(e) if e.ty.is_number());
        let vector = matches!(item, Item::Array(..) | Item::Tuple(..));
        if !vector || !item.parts().is_some_and(|parts| parts.iter().all(number)) {
            let got = self.shown(&item);
            self.report(types::not_a_vector(&got, arg.span));
            return Expr::error(span);
        }
        let mut parts = Vec::new();
        item.flatten(&mut parts);
        if parts.iter().any(|p| p.kind == ExprKind::Error) {
            return Expr::error(span);
        }
        let known = parts.iter().map(|p| p.ty).find(|ty| *ty != Kind::Unknown);
        let ty = match known {
            Some(Kind::Int) | None => Kind::Float(Dim::NUMBER),
            Some(ty) => ty,
        };
        let floats = parts.into_iter().map(|part| self.fit(part, ty, env)).collect();
        self.applied(NumberFunction::Norm, floats, ty, span)
    }
}
