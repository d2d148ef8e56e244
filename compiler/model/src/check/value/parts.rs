//! Values of several parts: records, arrays and vectors. The checker takes them apart, so that everything behind it
//! knows single values alone.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, NameSyntax};

use crate::check::{
    checker::Checker,
    state::{
        issues::too_many,
        item::{ExprItem, axes},
        record::MAX_PARTS,
        scope::ExprEnv,
    },
    value::range,
};
use crate::{
    BinaryOp, InferredType, Type, TypedExpr, TypedExprKind, Value,
    noun::Noun,
    report::{names, types},
    types::TypeLayout,
};

impl Checker<'_> {
    /// `(a, b)`, which has as many single values as anything can have.
    pub(in crate::check) fn tuple(
        &mut self,
        parts: &[ast::ExprSyntax],
        span: Span,
        env: &mut ExprEnv,
    ) -> ExprItem {
        let parts: Vec<ExprItem> = parts.iter().map(|p| self.item(p, env)).collect();
        let whole = ExprItem::Tuple(parts, span);
        if whole.singles() > MAX_PARTS {
            let rule = format!("at most {MAX_PARTS}");
            self.report(types::must_be("the number of single values in it", &rule, span));
            return ExprItem::error(span);
        }
        whole
    }

    /// Whether an expression may be copied so many times; says so if that would be too much.
    pub(in crate::check) fn may_copy(&mut self, item: &ExprItem, times: usize, span: Span) -> bool {
        if item.is_constant() || times == 0 {
            return true;
        }
        match self.issues.copies.checked_sub(item.nodes().saturating_mul(times)) {
            Some(left) => self.issues.copies = left,
            None if self.issues.copies == 0 => return false,
            None => {
                self.issues.copies = 0;
                let message = "the expression is too large when it is written out for single values";
                self.report(too_many(message.to_owned(), span));
                return false;
            }
        }
        true
    }

    /// What it is, as a message says it.
    pub(in crate::check) fn shown(&self, item: &ExprItem) -> String {
        match item {
            ExprItem::One(e) => e.ty.to_string(),
            ExprItem::Record(id, _, _) => format!("a `{}`", self.types.records[usize::from(*id)].name.text),
            ExprItem::Array(parts, _) => format!("an array of {}", parts.len()),
            ExprItem::Tuple(parts, _) => format!("a tuple of {}", parts.len()),
        }
    }

    /// What is due, as a message says it.
    pub(in crate::check) fn shown_layout(&self, layout: &TypeLayout) -> String {
        match layout {
            TypeLayout::Scalar(ty) => InferredType::of(*ty).to_string(),
            TypeLayout::Unknown => InferredType::Unknown.to_string(),
            TypeLayout::Record(id) => format!("a `{}`", self.types.records[usize::from(*id)].name.text),
            TypeLayout::Array(_, n) => format!("an array of {n}"),
        }
    }

    /// The layouts of the parts, with the names that they are reached by.
    pub(in crate::check) fn parts_of(&self, layout: &TypeLayout) -> Vec<(String, TypeLayout)> {
        match layout {
            TypeLayout::Scalar(_) | TypeLayout::Unknown => Vec::new(),
            TypeLayout::Record(id) => {
                let fields = &self.types.records[usize::from(*id)].fields;
                fields.iter().map(|(name, layout)| (format!(".{name}"), layout.clone())).collect()
            }
            TypeLayout::Array(of, n) => (0..*n).map(|i| (format!("[{i}]"), (**of).clone())).collect(),
        }
    }

    /// The single values of something of this layout: their full names and types.
    pub(in crate::check) fn leaves(&self, base: &str, layout: &TypeLayout, out: &mut Vec<(String, Type)>) {
        if let TypeLayout::Scalar(ty) = layout {
            out.push((base.to_owned(), *ty));
            return;
        }
        for (name, part) in self.parts_of(layout) {
            self.leaves(&format!("{base}{name}"), &part, out);
        }
    }

    /// Says that nothing is known of something that must have parts, unless it has a diagnostic.
    pub(in crate::check) fn not_known(&mut self, item: &ExprItem) {
        if let ExprItem::One(e) = item
            && e.ty == InferredType::Unknown
            && e.kind != TypedExprKind::Error
        {
            self.report(types::not_known(e.span));
        }
    }

    /// Whether all parts of a name have a value here.
    pub(in crate::check) fn all_bound(&self, base: &str, layout: &TypeLayout, env: &ExprEnv) -> bool {
        let mut leaves = Vec::new();
        self.leaves(base, layout, &mut leaves);
        leaves.iter().all(|(name, _)| env.find(name).is_some_and(|l| l.bound))
    }

    /// What a name of several parts stands for, put together from the locals that are its parts.
    pub(in crate::check) fn assembled(
        &self,
        base: &str,
        layout: &TypeLayout,
        env: &ExprEnv,
        span: Span,
    ) -> ExprItem {
        let parts = |c: &Self| {
            let parts = c.parts_of(layout).into_iter();
            parts.map(|(name, part)| c.assembled(&format!("{base}{name}"), &part, env, span)).collect()
        };
        match layout {
            TypeLayout::Scalar(_) => match env.find(base) {
                Some(local) if local.bound => match local.leaf {
                    Some(leaf) => {
                        ExprItem::One(TypedExpr { kind: TypedExprKind::Leaf(leaf), ty: local.ty, span })
                    }
                    None => ExprItem::error(span),
                },
                Some(_) | None => ExprItem::error(span),
            },
            TypeLayout::Record(id) => ExprItem::Record(*id, parts(self), span),
            TypeLayout::Array(..) => ExprItem::Array(parts(self), span),
            TypeLayout::Unknown => ExprItem::error(span),
        }
    }

    // ── parts ──

    /// `item.name`
    pub(in crate::check) fn field(&mut self, item: ExprItem, name: &NameSyntax) -> ExprItem {
        let span = item.span().to(name.span);
        if item.is_unknown() {
            self.not_known(&item);
            return ExprItem::error(span);
        }
        let fields: Vec<String> = match &item {
            ExprItem::Record(id, ..) => {
                self.types.records[usize::from(*id)].fields.iter().map(|(n, _)| n.clone()).collect()
            }
            ExprItem::Array(..) | ExprItem::Tuple(..) => {
                item.axes().iter().map(|a| (*a).to_owned()).collect()
            }
            ExprItem::One(_) => Vec::new(),
        };
        if let ExprItem::Record(id, ..) = &item {
            let record = self.types.records[usize::from(*id)].name.span;
            self.refer_within(name, record, Noun::Field);
        }
        let at = fields.iter().position(|f| *f == name.text);
        match at.zip(item.parts()).and_then(|(at, parts)| parts.get(at)) {
            Some(part) => part.clone().at(span),
            None => {
                let shown = self.shown(&item);
                self.no_field(name, &fields, &shown, item.parts().is_some());
                ExprItem::error(span)
            }
        }
    }

    fn no_field(&mut self, name: &NameSyntax, fields: &[String], of: &str, parts: bool) {
        let issue = names::unknown(Noun::Field, &name.text, name.span, fields.iter().map(String::as_str));
        self.report(match (fields.is_empty(), parts) {
            (false, _) => issue,
            (true, true) => issue.help(format!("the parts of {of} are reached by their index: `[0]`")),
            (true, false) => issue.help(format!("{of} has no fields")),
        });
    }

    /// How a part of something is reached, and its layout.
    pub(in crate::check) fn field_of(
        &mut self,
        layout: &TypeLayout,
        name: &NameSyntax,
    ) -> Option<(String, TypeLayout)> {
        let parts = self.parts_of(layout);
        let names: Vec<String> = match layout {
            TypeLayout::Array(of, n) => match **of {
                TypeLayout::Scalar(Type::Int { .. } | Type::Float(_)) => {
                    axes(usize::from(*n)).iter().map(|a| (*a).to_owned()).collect()
                }
                TypeLayout::Scalar(Type::Bool | Type::Enum(_) | Type::Text | Type::List(_))
                | TypeLayout::Record(_)
                | TypeLayout::Array(..)
                | TypeLayout::Unknown => Vec::new(),
            },
            TypeLayout::Unknown => return None,
            TypeLayout::Scalar(_) => Vec::new(),
            TypeLayout::Record(_) => {
                parts.iter().map(|(n, _)| n.trim_start_matches('.').to_owned()).collect()
            }
        };
        let Some(at) = names.iter().position(|n| *n == name.text) else {
            let shown = self.shown_layout(layout);
            self.no_field(name, &names, &shown, !parts.is_empty());
            return None;
        };
        parts.into_iter().nth(at)
    }

    /// `of[index]`
    pub(in crate::check) fn index(
        &mut self,
        of: &ast::ExprSyntax,
        index: &ast::ExprSyntax,
        span: Span,
        env: &mut ExprEnv,
    ) -> ExprItem {
        let item = self.item(of, env);
        let at = self.expr_of(index, InferredType::Int, env);
        if item.is_unknown() {
            self.not_known(&item);
            return ExprItem::error(span);
        }
        let (ExprItem::Array(parts, _) | ExprItem::Tuple(parts, _)) = &item else {
            let message = format!("{} has no elements", self.shown(&item));
            self.report(types::no_elements(message, of.span));
            return ExprItem::error(span);
        };
        if !self.index_fits(&at, parts.len(), env) {
            return ExprItem::error(span);
        }
        if let Some(Value::Int(n)) = at.constant() {
            return usize::try_from(n).map_or(ExprItem::error(span), |n| parts[n].clone().at(span));
        }
        if !self.may_copy(&ExprItem::One(at.clone()), parts.len(), span) {
            return ExprItem::error(span);
        }
        let mut parts = parts.clone().into_iter().enumerate().rev();
        let Some((_, last)) = parts.next() else { return ExprItem::error(span) };
        parts.fold(last.at(span), |otherwise, (i, part)| {
            let here = is_at(&at, i);
            self.either_item(&here, part, otherwise, span, env)
        })
    }

    /// Whether an index lies within an array, for certain; says so if not.
    pub(in crate::check) fn index_fits(&mut self, at: &TypedExpr, len: usize, env: &ExprEnv) -> bool {
        let last = i64::try_from(len).unwrap_or(i64::MAX) - 1;
        let fits = range::of(at, env).is_some_and(|(lo, hi)| lo >= 0 && hi <= last);
        if !fits && at.kind != TypedExprKind::Error {
            self.report(types::bad_index(at, last));
        }
        fits
    }

    /// `if condition { a } else { b }`, part by part.
    pub(in crate::check) fn either_item(
        &mut self,
        condition: &TypedExpr,
        a: ExprItem,
        b: ExprItem,
        span: Span,
        env: &mut ExprEnv,
    ) -> ExprItem {
        match (a, b) {
            (ExprItem::One(a), ExprItem::One(b)) => {
                ExprItem::One(self.conditional(condition.clone(), a, b, span, env))
            }
            (a, _) if !self.may_copy(&ExprItem::One(condition.clone()), a.singles() - 1, span) => {
                ExprItem::error(span)
            }
            (ExprItem::Record(i, a, _), ExprItem::Record(j, b, _)) if i == j => {
                ExprItem::Record(i, self.either_items(condition, a, b, span, env), span)
            }
            (ExprItem::Record(i, a, _), ExprItem::Tuple(b, _))
            | (ExprItem::Tuple(a, _), ExprItem::Record(i, b, _))
                if a.len() == b.len() =>
            {
                ExprItem::Record(i, self.either_items(condition, a, b, span, env), span)
            }
            (ExprItem::Tuple(a, _), ExprItem::Tuple(b, _)) if a.len() == b.len() => {
                ExprItem::Tuple(self.either_items(condition, a, b, span, env), span)
            }
            (
                ExprItem::Array(a, _) | ExprItem::Tuple(a, _),
                ExprItem::Array(b, _) | ExprItem::Tuple(b, _),
            ) if a.len() == b.len() => ExprItem::Array(self.either_items(condition, a, b, span, env), span),
            (a, b) => self.clash("if", &a, &b, span),
        }
    }

    fn either_items(
        &mut self,
        condition: &TypedExpr,
        a: Vec<ExprItem>,
        b: Vec<ExprItem>,
        span: Span,
        env: &mut ExprEnv,
    ) -> Vec<ExprItem> {
        a.into_iter().zip(b).map(|(a, b)| self.either_item(condition, a, b, span, env)).collect()
    }

    pub(in crate::check) fn clash(&mut self, op: &str, a: &ExprItem, b: &ExprItem, span: Span) -> ExprItem {
        self.not_known(a);
        self.not_known(b);
        if !a.is_unknown() && !b.is_unknown() {
            let (left, right) = (self.shown(a), self.shown(b));
            self.report(types::shapes(op, span, (&left, a.span()), (&right, b.span())));
        }
        ExprItem::error(span)
    }
}

/// `index == i`
pub(in crate::check) fn is_at(index: &TypedExpr, i: usize) -> TypedExpr {
    let n = i64::try_from(i).unwrap_or(i64::MAX);
    let value = TypedExpr::value(Value::Int(n), InferredType::Int, index.span);
    let kind = TypedExprKind::Binary(BinaryOp::Eq, Box::new(index.clone()), Box::new(value));
    TypedExpr { kind, ty: InferredType::Bool, span: index.span }
}
