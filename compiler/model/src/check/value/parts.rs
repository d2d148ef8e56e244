//! Values of several parts: records, arrays and vectors. The checker takes them apart, so that everything behind it
//! knows single values alone.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, Name};

use crate::check::{
    checker::Checker,
    state::{
        issues::too_many,
        item::{Item, axes},
        record::MAX_PARTS,
        scope::Env,
    },
    value::range,
};
use crate::{
    BinaryOp, Expr, ExprKind, Kind, Type, Value,
    noun::Noun,
    report::{names, types},
    types::Layout,
};

impl Checker<'_> {
    /// `(a, b)`, which has as many single values as anything can have.
    pub(in crate::check) fn tuple(&mut self, parts: &[ast::Expr], span: Span, env: &mut Env) -> Item {
        let parts: Vec<Item> = parts.iter().map(|p| self.item(p, env)).collect();
        let whole = Item::Tuple(parts, span);
        if whole.singles() > MAX_PARTS {
            let rule = format!("at most {MAX_PARTS}");
            self.report(types::must_be("the number of single values in it", &rule, span));
            return Item::error(span);
        }
        whole
    }

    /// Whether an expression may be copied so many times; says so if that would be too much.
    pub(in crate::check) fn may_copy(&mut self, item: &Item, times: usize, span: Span) -> bool {
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
    pub(in crate::check) fn shown(&self, item: &Item) -> String {
        match item {
            Item::One(e) => e.ty.to_string(),
            Item::Record(id, _, _) => format!("a `{}`", self.types.records[usize::from(*id)].name.text),
            Item::Array(parts, _) => format!("an array of {}", parts.len()),
            Item::Tuple(parts, _) => format!("a tuple of {}", parts.len()),
        }
    }

    /// What is due, as a message says it.
    pub(in crate::check) fn shown_layout(&self, layout: &Layout) -> String {
        match layout {
            Layout::Scalar(ty) => Kind::of(*ty).to_string(),
            Layout::Unknown => Kind::Unknown.to_string(),
            Layout::Record(id) => format!("a `{}`", self.types.records[usize::from(*id)].name.text),
            Layout::Array(_, n) => format!("an array of {n}"),
        }
    }

    /// The layouts of the parts, with the names that they are reached by.
    pub(in crate::check) fn parts_of(&self, layout: &Layout) -> Vec<(String, Layout)> {
        match layout {
            Layout::Scalar(_) | Layout::Unknown => Vec::new(),
            Layout::Record(id) => {
                let fields = &self.types.records[usize::from(*id)].fields;
                fields.iter().map(|(name, layout)| (format!(".{name}"), layout.clone())).collect()
            }
            Layout::Array(of, n) => (0..*n).map(|i| (format!("[{i}]"), (**of).clone())).collect(),
        }
    }

    /// The single values of something of this layout: their full names and types.
    pub(in crate::check) fn leaves(&self, base: &str, layout: &Layout, out: &mut Vec<(String, Type)>) {
        if let Layout::Scalar(ty) = layout {
            out.push((base.to_owned(), *ty));
            return;
        }
        for (name, part) in self.parts_of(layout) {
            self.leaves(&format!("{base}{name}"), &part, out);
        }
    }

    /// Says that nothing is known of something that must have parts, unless it has a diagnostic.
    pub(in crate::check) fn not_known(&mut self, item: &Item) {
        if let Item::One(e) = item
            && e.ty == Kind::Unknown
            && e.kind != ExprKind::Error
        {
            self.report(types::not_known(e.span));
        }
    }

    /// Whether all parts of a name have a value here.
    pub(in crate::check) fn all_bound(&self, base: &str, layout: &Layout, env: &Env) -> bool {
        let mut leaves = Vec::new();
        self.leaves(base, layout, &mut leaves);
        leaves.iter().all(|(name, _)| env.find(name).is_some_and(|l| l.bound))
    }

    /// What a name of several parts stands for, put together from the locals that are its parts.
    pub(in crate::check) fn assembled(&self, base: &str, layout: &Layout, env: &Env, span: Span) -> Item {
        let parts = |c: &Self| {
            let parts = c.parts_of(layout).into_iter();
            parts.map(|(name, part)| c.assembled(&format!("{base}{name}"), &part, env, span)).collect()
        };
        match layout {
            Layout::Scalar(_) => match env.find(base) {
                Some(local) if local.bound => match local.leaf {
                    Some(leaf) => Item::One(Expr { kind: ExprKind::Leaf(leaf), ty: local.ty, span }),
                    None => Item::error(span),
                },
                Some(_) | None => Item::error(span),
            },
            Layout::Record(id) => Item::Record(*id, parts(self), span),
            Layout::Array(..) => Item::Array(parts(self), span),
            Layout::Unknown => Item::error(span),
        }
    }

    // ── parts ──

    /// `item.name`
    pub(in crate::check) fn field(&mut self, item: Item, name: &Name) -> Item {
        let span = item.span().to(name.span);
        if item.is_unknown() {
            self.not_known(&item);
            return Item::error(span);
        }
        let fields: Vec<String> = match &item {
            Item::Record(id, ..) => {
                self.types.records[usize::from(*id)].fields.iter().map(|(n, _)| n.clone()).collect()
            }
            Item::Array(..) | Item::Tuple(..) => item.axes().iter().map(|a| (*a).to_owned()).collect(),
            Item::One(_) => Vec::new(),
        };
        if let Item::Record(id, ..) = &item {
            let record = self.types.records[usize::from(*id)].name.span;
            self.refer_within(name, record, "field");
        }
        let at = fields.iter().position(|f| *f == name.text);
        match at.zip(item.parts()).and_then(|(at, parts)| parts.get(at)) {
            Some(part) => part.clone().at(span),
            None => {
                let shown = self.shown(&item);
                self.no_field(name, &fields, &shown, item.parts().is_some());
                Item::error(span)
            }
        }
    }

    fn no_field(&mut self, name: &Name, fields: &[String], of: &str, parts: bool) {
        let issue = names::unknown(Noun::Field, &name.text, name.span, fields.iter().map(String::as_str));
        self.report(match (fields.is_empty(), parts) {
            (false, _) => issue,
            (true, true) => issue.help(format!("the parts of {of} are reached by their index: `[0]`")),
            (true, false) => issue.help(format!("{of} has no fields")),
        });
    }

    /// How a part of something is reached, and its layout.
    pub(in crate::check) fn field_of(&mut self, layout: &Layout, name: &Name) -> Option<(String, Layout)> {
        let parts = self.parts_of(layout);
        let names: Vec<String> = match layout {
            Layout::Array(of, n) => match **of {
                Layout::Scalar(Type::Int { .. } | Type::Float(_)) => {
                    axes(usize::from(*n)).iter().map(|a| (*a).to_owned()).collect()
                }
                Layout::Scalar(Type::Bool | Type::Enum(_) | Type::Text | Type::List(_))
                | Layout::Record(_)
                | Layout::Array(..)
                | Layout::Unknown => Vec::new(),
            },
            Layout::Unknown => return None,
            Layout::Scalar(_) => Vec::new(),
            Layout::Record(_) => parts.iter().map(|(n, _)| n.trim_start_matches('.').to_owned()).collect(),
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
        of: &ast::Expr,
        index: &ast::Expr,
        span: Span,
        env: &mut Env,
    ) -> Item {
        let item = self.item(of, env);
        let at = self.expr_of(index, Kind::Int, env);
        if item.is_unknown() {
            self.not_known(&item);
            return Item::error(span);
        }
        let (Item::Array(parts, _) | Item::Tuple(parts, _)) = &item else {
            let message = format!("{} has no elements", self.shown(&item));
            self.report(types::no_elements(message, of.span));
            return Item::error(span);
        };
        if !self.index_fits(&at, parts.len(), env) {
            return Item::error(span);
        }
        if let Some(Value::Int(n)) = at.constant() {
            return usize::try_from(n).map_or(Item::error(span), |n| parts[n].clone().at(span));
        }
        if !self.may_copy(&Item::One(at.clone()), parts.len(), span) {
            return Item::error(span);
        }
        let mut parts = parts.clone().into_iter().enumerate().rev();
        let Some((_, last)) = parts.next() else { return Item::error(span) };
        parts.fold(last.at(span), |otherwise, (i, part)| {
            let here = is_at(&at, i);
            self.either_item(&here, part, otherwise, span, env)
        })
    }

    /// Whether an index lies within an array, for certain; says so if not.
    pub(in crate::check) fn index_fits(&mut self, at: &Expr, len: usize, env: &Env) -> bool {
        let last = i64::try_from(len).unwrap_or(i64::MAX) - 1;
        let fits = range::of(at, env).is_some_and(|(lo, hi)| lo >= 0 && hi <= last);
        if !fits && at.kind != ExprKind::Error {
            self.report(types::bad_index(at, last));
        }
        fits
    }

    /// `if condition { a } else { b }`, part by part.
    pub(in crate::check) fn either_item(
        &mut self,
        condition: &Expr,
        a: Item,
        b: Item,
        span: Span,
        env: &mut Env,
    ) -> Item {
        match (a, b) {
            (Item::One(a), Item::One(b)) => Item::One(self.conditional(condition.clone(), a, b, span, env)),
            (a, _) if !self.may_copy(&Item::One(condition.clone()), a.singles() - 1, span) => {
                Item::error(span)
            }
            (Item::Record(i, a, _), Item::Record(j, b, _)) if i == j => {
                Item::Record(i, self.either_items(condition, a, b, span, env), span)
            }
            (Item::Record(i, a, _), Item::Tuple(b, _)) | (Item::Tuple(a, _), Item::Record(i, b, _))
                if a.len() == b.len() =>
            {
                Item::Record(i, self.either_items(condition, a, b, span, env), span)
            }
            (Item::Tuple(a, _), Item::Tuple(b, _)) if a.len() == b.len() => {
                Item::Tuple(self.either_items(condition, a, b, span, env), span)
            }
            (Item::Array(a, _) | Item::Tuple(a, _), Item::Array(b, _) | Item::Tuple(b, _))
                if a.len() == b.len() =>
            {
                Item::Array(self.either_items(condition, a, b, span, env), span)
            }
            (a, b) => self.clash("if", &a, &b, span),
        }
    }

    fn either_items(
        &mut self,
        condition: &Expr,
        a: Vec<Item>,
        b: Vec<Item>,
        span: Span,
        env: &mut Env,
    ) -> Vec<Item> {
        a.into_iter().zip(b).map(|(a, b)| self.either_item(condition, a, b, span, env)).collect()
    }

    pub(in crate::check) fn clash(&mut self, op: &str, a: &Item, b: &Item, span: Span) -> Item {
        self.not_known(a);
        self.not_known(b);
        if !a.is_unknown() && !b.is_unknown() {
            let (left, right) = (self.shown(a), self.shown(b));
            self.report(types::shapes(op, span, (&left, a.span()), (&right, b.span())));
        }
        Item::error(span)
    }
}

/// `index == i`
pub(in crate::check) fn is_at(index: &Expr, i: usize) -> Expr {
    let n = i64::try_from(i).unwrap_or(i64::MAX);
    let value = Expr::value(Value::Int(n), Kind::Int, index.span);
    let kind = ExprKind::Binary(BinaryOp::Eq, Box::new(index.clone()), Box::new(value));
    Expr { kind, ty: Kind::Bool, span: index.span }
}
