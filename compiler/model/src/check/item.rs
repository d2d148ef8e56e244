//! Values of several parts: records, arrays and vectors. The checker takes them apart, so that everything behind it
//! knows single values alone.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, BinaryOp, ExprKind as Syntax, Name};

use super::{Checker, Env, layout::MAX_PARTS};
use crate::{
    Dim, Expr, ExprKind, Function, Kind, Type, Value,
    noun::Noun,
    report::{names, types},
    types::Layout,
};

/// The most nodes that are made by copying expressions, as `a[i]` copies the index for each element.
pub(super) const MAX_COPIES: usize = 2_000_000;

/// The names of the parts of a short array.
const AXES: [&str; 3] = ["x", "y", "z"];

/// What an expression yields.
#[derive(Clone, Debug)]
pub(crate) enum Item {
    One(Expr),
    /// Of the checker's record of this number.
    Record(u16, Vec<Item>, Span),
    Array(Vec<Item>, Span),
    /// `(a, b)`: an array, or a record where one is due.
    Tuple(Vec<Item>, Span),
}

/// One part of an argument that is given for a parameter, with the type of the part.
pub(super) enum Part<'e> {
    /// `_`
    Any,
    /// Not looked at yet.
    Syntax(&'e ast::Expr, Type),
    /// A part of something that was looked at as a whole.
    Done(Expr, Type),
    /// A part of a variable: its name with the part's.
    Variable(Name, Type),
}

impl Item {
    pub fn error(span: Span) -> Self {
        Item::One(Expr::error(span))
    }

    pub fn span(&self) -> Span {
        match self {
            Item::One(e) => e.span,
            Item::Record(_, _, span) | Item::Array(_, span) | Item::Tuple(_, span) => *span,
        }
    }

    /// How many nodes its expressions have; a constant is one.
    fn nodes(&self) -> usize {
        match self {
            Item::One(e) => nodes(e),
            Item::Record(_, parts, _) | Item::Array(parts, _) | Item::Tuple(parts, _) => {
                parts.iter().map(Item::nodes).sum()
            }
        }
    }

    fn at(self, span: Span) -> Self {
        match self {
            Item::One(e) => Item::One(Expr { span, ..e }),
            Item::Record(id, parts, _) => Item::Record(id, parts, span),
            Item::Array(parts, _) => Item::Array(parts, span),
            Item::Tuple(parts, _) => Item::Tuple(parts, span),
        }
    }

    /// Where the name stands that stands for it.
    pub fn named_at(&self, span: Span) -> Self {
        self.clone().at(span)
    }

    /// Its single values, in order.
    pub fn flatten(self, out: &mut Vec<Expr>) {
        match self {
            Item::One(e) => out.push(e),
            Item::Record(_, parts, _) | Item::Array(parts, _) | Item::Tuple(parts, _) => {
                parts.into_iter().for_each(|p| p.flatten(out));
            }
        }
    }

    /// How many single values it has.
    fn singles(&self) -> usize {
        match self {
            Item::One(_) => 1,
            Item::Record(_, parts, _) | Item::Array(parts, _) | Item::Tuple(parts, _) => {
                parts.iter().map(Item::singles).sum()
            }
        }
    }

    fn parts(&self) -> Option<&[Item]> {
        match self {
            Item::One(_) => None,
            Item::Record(_, parts, _) | Item::Array(parts, _) | Item::Tuple(parts, _) => Some(parts),
        }
    }

    /// Whether all its single values are known.
    pub fn is_constant(&self) -> bool {
        match self {
            Item::One(e) => e.constant().is_some(),
            Item::Record(_, parts, _) | Item::Array(parts, _) | Item::Tuple(parts, _) => {
                parts.iter().all(Item::is_constant)
            }
        }
    }

    /// Whether something in it has a diagnostic already.
    fn is_unknown(&self) -> bool {
        matches!(self, Item::One(e) if e.ty == Kind::Unknown)
    }
}

fn nodes(e: &Expr) -> usize {
    let mut n = 0;
    e.each(&mut |_| n += 1);
    n
}

impl Checker<'_> {
    /// `(a, b)`, which has as many single values as anything can have.
    pub(super) fn tuple(&mut self, parts: &[ast::Expr], span: Span, env: &mut Env) -> Item {
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
    pub(super) fn may_copy(&mut self, item: &Item, times: usize, span: Span) -> bool {
        if item.is_constant() || times == 0 {
            return true;
        }
        match self.copies.checked_sub(item.nodes().saturating_mul(times)) {
            Some(left) => self.copies = left,
            None if self.copies == 0 => return false,
            None => {
                self.copies = 0;
                let message = "the expression is too large when it is written out for single values";
                self.report(super::too_many(message.to_owned(), span));
                return false;
            }
        }
        true
    }

    /// What it is, as a message says it.
    pub(super) fn shown(&self, item: &Item) -> String {
        match item {
            Item::One(e) => e.ty.to_string(),
            Item::Record(id, _, _) => format!("a `{}`", self.records[usize::from(*id)].name.text),
            Item::Array(parts, _) => format!("an array of {}", parts.len()),
            Item::Tuple(parts, _) => format!("a tuple of {}", parts.len()),
        }
    }

    /// What is due, as a message says it.
    pub(super) fn shown_layout(&self, layout: &Layout) -> String {
        match layout {
            Layout::Scalar(ty) => ty.kind().to_string(),
            Layout::Record(id) => format!("a `{}`", self.records[usize::from(*id)].name.text),
            Layout::Array(_, n) => format!("an array of {n}"),
        }
    }

    /// The layouts of the parts, with the names that they are reached by.
    fn parts_of(&self, layout: &Layout) -> Vec<(String, Layout)> {
        match layout {
            Layout::Scalar(_) => Vec::new(),
            Layout::Record(id) => {
                let fields = &self.records[usize::from(*id)].fields;
                fields.iter().map(|(name, layout)| (format!(".{name}"), layout.clone())).collect()
            }
            Layout::Array(of, n) => (0..*n).map(|i| (format!("[{i}]"), (**of).clone())).collect(),
        }
    }

    /// The single values of something of this layout: their full names and types.
    pub(super) fn leaves(&self, base: &str, layout: &Layout, out: &mut Vec<(String, Type)>) {
        if let Layout::Scalar(ty) = layout {
            out.push((base.to_owned(), *ty));
            return;
        }
        for (name, part) in self.parts_of(layout) {
            self.leaves(&format!("{base}{name}"), &part, out);
        }
    }

    /// What a name of several parts stands for, put together from the locals that are its parts.
    pub(super) fn assembled(&self, base: &str, layout: &Layout, env: &Env, span: Span) -> Item {
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
        }
    }

    // ── what is due ──

    /// An expression where something of this layout is due.
    pub(super) fn item_for(&mut self, e: &ast::Expr, layout: &Layout, env: &mut Env) -> Item {
        if let Layout::Scalar(ty) = layout {
            return Item::One(self.expr_for(e, *ty, env));
        }
        if let Syntax::Tuple(parts) = &e.kind {
            let due = self.parts_of(layout);
            if due.len() == parts.len() {
                let items = parts.iter().zip(&due).map(|(p, (_, l))| self.item_for(p, l, env)).collect();
                return self.whole(layout, items, e.span);
            }
        }
        let item = self.item(e, env);
        self.coerce(item, layout, env)
    }

    fn whole(&self, layout: &Layout, parts: Vec<Item>, span: Span) -> Item {
        match layout {
            Layout::Record(id) => Item::Record(*id, parts, span),
            Layout::Scalar(_) | Layout::Array(..) => Item::Array(parts, span),
        }
    }

    fn coerce(&mut self, item: Item, layout: &Layout, env: &mut Env) -> Item {
        let span = item.span();
        let due = self.parts_of(layout);
        let fits = match (&item, layout) {
            (Item::One(e), Layout::Scalar(ty)) => {
                let e = self.fit(e.clone(), ty.kind(), env);
                self.in_range(&e, *ty);
                return Item::One(e);
            }
            // One part alone needs no parentheses of a tuple, which would be no tuple.
            (Item::One(e), _) if due.len() == 1 && e.ty != Kind::Unknown => {
                let part = self.coerce(item, &due[0].1, env);
                return self.whole(layout, vec![part], span);
            }
            (Item::Record(id, ..), Layout::Record(want)) => id == want,
            (Item::Tuple(parts, _), Layout::Record(_) | Layout::Array(..))
            | (Item::Array(parts, _), Layout::Array(..)) => parts.len() == due.len(),
            (Item::One(_) | Item::Record(..) | Item::Array(..) | Item::Tuple(..), _) => false,
        };
        if !fits {
            if !item.is_unknown() {
                let (want, got) = (self.shown_layout(layout), self.shown(&item));
                let issue = types::other_shape(&want, &got, span);
                let form: Vec<String> =
                    due.iter().map(|(n, _)| n.trim_matches(['.', '[', ']']).to_owned()).collect();
                let record = matches!(layout, Layout::Record(_));
                self.report(if record {
                    issue.help(format!("write `({})`", form.join(", ")))
                } else {
                    issue
                });
            }
            let parts = due.iter().map(|(_, l)| self.error_item(l, span)).collect();
            return self.whole(layout, parts, span);
        }
        let parts = match item {
            Item::One(_) => Vec::new(),
            Item::Record(_, parts, _) | Item::Array(parts, _) | Item::Tuple(parts, _) => parts,
        };
        let parts = parts.into_iter().zip(&due).map(|(p, (_, l))| self.coerce(p, l, env)).collect();
        self.whole(layout, parts, span)
    }

    fn error_item(&self, layout: &Layout, span: Span) -> Item {
        let mut leaves = Vec::new();
        self.leaves("", layout, &mut leaves);
        match layout {
            Layout::Scalar(_) => Item::error(span),
            Layout::Record(_) | Layout::Array(..) => {
                let parts = leaves.iter().map(|_| Item::error(span)).collect();
                self.whole(layout, parts, span)
            }
        }
    }

    /// An argument taken apart as its parameter is, without looking at the single values yet.
    pub(super) fn spread<'e>(
        &mut self,
        arg: &'e ast::Expr,
        layout: &Layout,
        env: &mut Env,
        variable: &dyn Fn(&Checker<'_>, &Name) -> bool,
        out: &mut Vec<Part<'e>>,
    ) {
        if let Layout::Scalar(ty) = layout {
            out.push(if arg.kind == Syntax::Any { Part::Any } else { Part::Syntax(arg, *ty) });
            return;
        }
        let due = self.parts_of(layout);
        let given: Option<&[ast::Expr]> = match &arg.kind {
            Syntax::Tuple(parts) => Some(parts),
            Syntax::Call { callee, args } if self.is_record(callee, layout) => Some(args),
            _ => None,
        };
        if let Some(parts) = given
            && parts.len() == due.len()
        {
            for (part, (_, layout)) in parts.iter().zip(&due) {
                self.spread(part, layout, env, variable, out);
            }
            return;
        }
        let mut leaves = Vec::new();
        if arg.kind == Syntax::Any {
            self.leaves("", layout, &mut leaves);
            out.extend(leaves.into_iter().map(|_| Part::Any));
            return;
        }
        if let Syntax::Path(path) = &arg.kind
            && let [name] = path.names.as_slice()
            && variable(self, name)
        {
            self.leaves(&name.text, layout, &mut leaves);
            env.declare_layout(&name.text, layout.clone());
            let part = |(text, ty)| Part::Variable(Name { text, span: name.span }, ty);
            out.extend(leaves.into_iter().map(part));
            return;
        }
        let item = self.item_for(arg, layout, env);
        self.leaves("", layout, &mut leaves);
        let mut values = Vec::new();
        item.flatten(&mut values);
        out.extend(values.into_iter().zip(leaves).map(|(e, (_, ty))| Part::Done(e, ty)));
    }

    fn is_record(&self, callee: &ast::Path, layout: &Layout) -> bool {
        match (callee.names.as_slice(), layout) {
            ([name], Layout::Record(id)) => self.records[usize::from(*id)].name.text == name.text,
            (_, _) => false,
        }
    }

    // ── parts ──

    /// `item.name`
    pub(super) fn field(&mut self, item: Item, name: &Name) -> Item {
        let span = item.span().to(name.span);
        if item.is_unknown() {
            return Item::error(span);
        }
        let fields: Vec<String> = match &item {
            Item::Record(id, ..) => {
                self.records[usize::from(*id)].fields.iter().map(|(n, _)| n.clone()).collect()
            }
            Item::Array(parts, _) | Item::Tuple(parts, _) => {
                AXES.iter().take(parts.len()).filter(|_| parts.len() <= 3).map(|a| (*a).to_owned()).collect()
            }
            Item::One(_) => Vec::new(),
        };
        match (fields.iter().position(|f| *f == name.text), item.parts()) {
            (Some(at), Some(parts)) => parts[at].clone().at(span),
            (_, _) => {
                let names = fields.iter().map(String::as_str);
                self.report(names::unknown(Noun::Field, &name.text, name.span, names));
                Item::error(span)
            }
        }
    }

    /// How a part of something is reached, and its layout.
    pub(super) fn field_of(&mut self, layout: &Layout, name: &Name) -> Option<(String, Layout)> {
        let parts = self.parts_of(layout);
        let names: Vec<String> = match layout {
            Layout::Array(..) if parts.len() <= 3 => {
                AXES.iter().take(parts.len()).map(|a| (*a).to_owned()).collect()
            }
            Layout::Array(..) | Layout::Scalar(_) => Vec::new(),
            Layout::Record(_) => parts.iter().map(|(n, _)| n.trim_start_matches('.').to_owned()).collect(),
        };
        let Some(at) = names.iter().position(|n| *n == name.text) else {
            let near = names.iter().map(String::as_str);
            self.report(names::unknown(Noun::Field, &name.text, name.span, near));
            return None;
        };
        parts.into_iter().nth(at)
    }

    /// `of[index]`
    pub(super) fn index(&mut self, of: &ast::Expr, index: &ast::Expr, span: Span, env: &mut Env) -> Item {
        let item = self.item(of, env);
        let at = self.expr_of(index, Kind::Int, env);
        if item.is_unknown() || at.ty == Kind::Unknown {
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
    pub(super) fn index_fits(&mut self, at: &Expr, len: usize, env: &Env) -> bool {
        let last = i64::try_from(len).unwrap_or(i64::MAX) - 1;
        let fits = super::range::of(at, env).is_some_and(|(lo, hi)| lo >= 0 && hi <= last);
        if !fits && at.ty != Kind::Unknown {
            self.report(types::bad_index(at, last));
        }
        fits
    }

    /// `if condition { a } else { b }`, part by part.
    pub(super) fn either_item(
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

    fn clash(&mut self, op: &str, a: &Item, b: &Item, span: Span) -> Item {
        if !a.is_unknown() && !b.is_unknown() {
            let (left, right) = (self.shown(a), self.shown(b));
            self.report(types::shapes(op, (&left, a.span()), (&right, b.span())));
        }
        Item::error(span)
    }

    // ── operators ──

    /// An operator of which one side at least has several parts.
    pub(super) fn combine(&mut self, op: BinaryOp, a: Item, b: Item, span: Span, env: &mut Env) -> Item {
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
                (a, b) => self.clash(super::expr::symbol(op), &a, &b, span),
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
                (a, b) => self.clash(super::expr::symbol(op), &a, &b, span),
            },
            BinaryOp::Rem
            | BinaryOp::Lt
            | BinaryOp::Le
            | BinaryOp::Gt
            | BinaryOp::Ge
            | BinaryOp::And
            | BinaryOp::Or => self.clash(super::expr::symbol(op), &a, &b, span),
        }
    }

    /// Equal if all parts are.
    fn equal(&mut self, op: BinaryOp, a: Item, b: Item, span: Span, env: &mut Env) -> Item {
        let same = match (&a, &b) {
            (Item::Record(i, ..), Item::Record(j, ..)) => i == j,
            (Item::Record(_, p, _), Item::Tuple(q, _)) | (Item::Tuple(p, _), Item::Record(_, q, _)) => {
                p.len() == q.len()
            }
            (Item::Array(p, _) | Item::Tuple(p, _), Item::Array(q, _) | Item::Tuple(q, _)) => {
                p.len() == q.len()
            }
            (Item::One(_), Item::One(_)) => true,
            (_, _) => false,
        };
        if !same {
            return self.clash(super::expr::symbol(op), &a, &b, span);
        }
        let (mut left, mut right) = (Vec::new(), Vec::new());
        a.flatten(&mut left);
        b.flatten(&mut right);
        if left.len() != right.len() {
            return Item::error(span);
        }
        let join = if op == BinaryOp::Eq { BinaryOp::And } else { BinaryOp::Or };
        let mut all: Option<Expr> = None;
        for (l, r) in left.into_iter().zip(right) {
            let one = self.operate(op, l, r, span, env);
            all = Some(match all {
                Some(before) => self.operate(join, before, one, span, env),
                None => one,
            });
        }
        all.map_or(Item::error(span), Item::One)
    }

    /// `norm(v)`: the length of a vector.
    pub(super) fn norm(&mut self, args: &[ast::Expr], span: Span, env: &mut Env) -> Expr {
        let [arg] = args else {
            self.report(types::counts(Noun::Function, "norm", 1, args.len(), span));
            return Expr::error(span);
        };
        let item = self.item(arg, env);
        let mut parts = Vec::new();
        item.flatten(&mut parts);
        let kind = parts.first().map_or(Kind::Unknown, |p| p.ty);
        let mut floats = Vec::new();
        for part in parts {
            let want = if kind == Kind::Int { Kind::Float(Dim::NUMBER) } else { kind };
            if !part.ty.is_number() {
                self.report(types::mismatch(want, part.ty, None, part.span));
                return Expr::error(span);
            }
            floats.push(self.fit(part, want, env));
        }
        let ty = if kind == Kind::Int { Kind::Float(Dim::NUMBER) } else { kind };
        self.applied(Function::Norm, floats, ty, span)
    }
}

/// `index == i`
pub(super) fn is_at(index: &Expr, i: usize) -> Expr {
    let n = i64::try_from(i).unwrap_or(i64::MAX);
    let value = Expr::value(Value::Int(n), Kind::Int, index.span);
    let kind = ExprKind::Binary(BinaryOp::Eq, Box::new(index.clone()), Box::new(value));
    Expr { kind, ty: Kind::Bool, span: index.span }
}
