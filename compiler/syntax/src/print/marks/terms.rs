//! Calls, parameters, types and expressions.

use crate::ast::{
    CallSyntax, ExprSyntax, ExprSyntaxKind, LiteralSyntax, ParamSyntax, RangeSyntax, TypeExpr, UnaryOp,
};
use crate::print::marks::TokenMarker;
use crate::token::TokenKind;

impl TokenMarker<'_> {
    pub(super) fn call(&mut self, call: &CallSyntax) {
        if let Some(args) = &call.args {
            self.args(call.name.span.end, args);
        }
    }

    pub(super) fn literal(&mut self, literal: &LiteralSyntax) {
        self.call(&literal.call);
        literal.annotations.iter().for_each(|a| self.expr(a));
    }

    pub(super) fn calls(&mut self, calls: &[CallSyntax]) {
        calls.iter().for_each(|c| self.call(c));
    }

    pub(super) fn args(&mut self, name_end: u32, args: &[ExprSyntax]) {
        self.call_after(name_end);
        args.iter().for_each(|a| self.expr(a));
    }

    pub(super) fn params(&mut self, name_end: u32, params: &[ParamSyntax]) {
        self.call_after(name_end);
        params.iter().for_each(|p| self.param(p));
    }

    pub(super) fn param(&mut self, param: &ParamSyntax) {
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

    pub(super) fn range(&mut self, range: &RangeSyntax) {
        self.range_of(&range.lo, range.hi.as_ref(), range.hi.is_none());
    }

    pub(super) fn range_of(&mut self, lo: &ExprSyntax, hi: Option<&ExprSyntax>, open: bool) {
        self.expr(lo);
        self.maybe(hi);
        if (open || hi.is_some()) && small(lo) && hi.is_none_or(small) {
            let at = self.at(lo.span.end);
            if self.tokens.get(at).is_some_and(|t| t.kind == TokenKind::DotDot) {
                self.marks[at].tight = true;
            }
        }
    }

    pub(super) fn maybe(&mut self, expr: Option<&ExprSyntax>) {
        if let Some(expr) = expr {
            self.expr(expr);
        }
    }

    pub(super) fn expr(&mut self, expr: &ExprSyntax) {
        match &expr.kind {
            ExprSyntaxKind::Bool(_)
            | ExprSyntaxKind::Int(_)
            | ExprSyntaxKind::Float(_)
            | ExprSyntaxKind::Quantity { .. }
            | ExprSyntaxKind::Any
            | ExprSyntaxKind::Text(_)
            | ExprSyntaxKind::Path(_)
            | ExprSyntaxKind::Error => {}
            ExprSyntaxKind::Call { callee, args } => self.args(callee.span.end, args),
            ExprSyntaxKind::Index { of, index } => {
                self.expr(of);
                self.expr(index);
            }
            ExprSyntaxKind::Field { of, .. } => self.expr(of),
            ExprSyntaxKind::Unary { op, operand } => {
                if *op == UnaryOp::Neg {
                    self.sign(expr.span.start);
                }
                self.expr(operand);
            }
            ExprSyntaxKind::Binary { left, right, .. } => {
                self.expr(left);
                self.expr(right);
            }
            ExprSyntaxKind::If { condition, then, otherwise } => {
                self.expr(condition);
                self.expr(then);
                self.expr(otherwise);
            }
            ExprSyntaxKind::Tuple(parts) => parts.iter().for_each(|p| self.expr(p)),
            ExprSyntaxKind::List { items, rest } => {
                self.apart(expr.span.start);
                items.iter().for_each(|i| self.expr(i));
                self.maybe(rest.as_deref());
            }
            ExprSyntaxKind::Strong(of) => {
                self.sign(expr.span.start);
                self.expr(of);
            }
            ExprSyntaxKind::Annotated { of, annotations } => {
                self.expr(of);
                annotations.iter().for_each(|a| self.expr(a));
            }
            ExprSyntaxKind::Internal(call) => self.call(call),
            ExprSyntaxKind::Unify { left, right } => {
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
        let parentheses = self.tokens[from..].iter().take_while(|t| t.kind == TokenKind::LParen).count();
        from + parentheses
    }
}

/// Needs no blanks around its `..`.
fn small(expr: &ExprSyntax) -> bool {
    let is_number = |of: &ExprSyntax| matches!(of.kind, ExprSyntaxKind::Int(_));
    is_number(expr)
        || matches!(&expr.kind, ExprSyntaxKind::Path(path) if path.names.len() == 1)
        || matches!(&expr.kind, ExprSyntaxKind::Unary { op: UnaryOp::Neg, operand } if is_number(operand))
}
