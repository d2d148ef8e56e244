//! Calls, parameters, types and expressions.

use crate::ast::{Call, Expr, ExprKind, Literal, Param, Range, TypeExpr, UnaryOp};
use crate::print::marks::Marker;
use crate::token::Kind;

impl Marker<'_> {
    pub(super) fn call(&mut self, call: &Call) {
        if let Some(args) = &call.args {
            self.args(call.name.span.end, args);
        }
    }

    pub(super) fn literal(&mut self, literal: &Literal) {
        self.call(&literal.call);
        literal.annotations.iter().for_each(|a| self.expr(a));
    }

    pub(super) fn calls(&mut self, calls: &[Call]) {
        calls.iter().for_each(|c| self.call(c));
    }

    pub(super) fn args(&mut self, name_end: u32, args: &[Expr]) {
        self.call_after(name_end);
        args.iter().for_each(|a| self.expr(a));
    }

    pub(super) fn params(&mut self, name_end: u32, params: &[Param]) {
        self.call_after(name_end);
        params.iter().for_each(|p| self.param(p));
    }

    pub(super) fn param(&mut self, param: &Param) {
        self.ty(&param.ty);
    }

    pub(super) fn ty(&mut self, ty: &TypeExpr) {
        match ty {
            TypeExpr::Named(_) | TypeExpr::Error => {}
            TypeExpr::Range(lo, hi) => self.range_of(lo, Some(hi), false),
            TypeExpr::List(of) => self.ty(of),
            TypeExpr::Array(of, size) => {
                self.ty(of);
                self.expr(size);
            }
        }
    }

    pub(super) fn range(&mut self, range: &Range) {
        self.range_of(&range.lo, range.hi.as_ref(), range.hi.is_none());
    }

    pub(super) fn range_of(&mut self, lo: &Expr, hi: Option<&Expr>, open: bool) {
        self.expr(lo);
        self.maybe(hi);
        if (open || hi.is_some()) && small(lo) && hi.is_none_or(small) {
            let at = self.at(lo.span.end);
            if self.tokens.get(at).is_some_and(|t| t.kind == Kind::DotDot) {
                self.marks[at].tight = true;
            }
        }
    }

    pub(super) fn maybe(&mut self, expr: Option<&Expr>) {
        if let Some(expr) = expr {
            self.expr(expr);
        }
    }

    pub(super) fn expr(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::Bool(_)
            | ExprKind::Int(_)
            | ExprKind::Float(_)
            | ExprKind::Quantity { .. }
            | ExprKind::Any
            | ExprKind::Text(_)
            | ExprKind::Path(_)
            | ExprKind::Error => {}
            ExprKind::Call { callee, args } => self.args(callee.span.end, args),
            ExprKind::Index { of, index } => {
                self.expr(of);
                self.expr(index);
            }
            ExprKind::Field { of, .. } => self.expr(of),
            ExprKind::Unary { op, operand } => {
                if *op == UnaryOp::Neg {
                    self.sign(expr.span.start);
                }
                self.expr(operand);
            }
            ExprKind::Binary { left, right, .. } => {
                self.expr(left);
                self.expr(right);
            }
            ExprKind::If { condition, then, otherwise } => {
                self.expr(condition);
                self.expr(then);
                self.expr(otherwise);
            }
            ExprKind::Tuple(parts) => parts.iter().for_each(|p| self.expr(p)),
            ExprKind::List { items, rest } => {
                self.apart(expr.span.start);
                items.iter().for_each(|i| self.expr(i));
                self.maybe(rest.as_deref());
            }
            ExprKind::Strong(of) => {
                self.sign(expr.span.start);
                self.expr(of);
            }
            ExprKind::Annotated { of, annotations } => {
                self.expr(of);
                annotations.iter().for_each(|a| self.expr(a));
            }
            ExprKind::Internal(call) => self.call(call),
            ExprKind::Unify { left, right } => {
                self.expr(left);
                self.expr(right);
            }
        }
    }

    /// The sign of an operand, which may be in parentheses.
    pub(super) fn sign(&mut self, offset: u32) {
        let at = self.within_parentheses(offset);
        if let Some(mark) = self.marks.get_mut(at) {
            mark.prefix = true;
        }
    }

    /// The bracket of a list, which may be in parentheses.
    fn apart(&mut self, offset: u32) {
        let at = self.within_parentheses(offset);
        if let Some(mark) = self.marks.get_mut(at) {
            mark.apart = true;
        }
    }

    fn within_parentheses(&self, offset: u32) -> usize {
        let from = self.at(offset);
        let parentheses = self.tokens[from..].iter().take_while(|t| t.kind == Kind::LParen).count();
        from + parentheses
    }
}

/// Needs no blanks around its `..`.
fn small(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Int(_) => true,
        ExprKind::Path(path) => path.names.len() == 1,
        ExprKind::Unary { op: UnaryOp::Neg, operand } => matches!(operand.kind, ExprKind::Int(_)),
        ExprKind::Unary { op: UnaryOp::Not, .. }
        | ExprKind::Bool(_)
        | ExprKind::Float(_)
        | ExprKind::Quantity { .. }
        | ExprKind::Any
        | ExprKind::Call { .. }
        | ExprKind::Index { .. }
        | ExprKind::Field { .. }
        | ExprKind::Binary { .. }
        | ExprKind::If { .. }
        | ExprKind::Tuple(_)
        | ExprKind::Text(_)
        | ExprKind::List { .. }
        | ExprKind::Strong(_)
        | ExprKind::Annotated { .. }
        | ExprKind::Internal(_)
        | ExprKind::Unify { .. }
        | ExprKind::Error => false,
    }
}
