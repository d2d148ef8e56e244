//! Expressions where something of a certain layout is due, and arguments taken apart as their parameters are.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, ExprSyntaxKind as Syntax, NameSyntax};

use crate::check::{
    checker::Checker,
    state::{
        item::{ArgumentPart, ExprItem},
        scope::ExprEnv,
    },
};
use crate::{InferredType, TypedExpr, noun::Noun, report::types, types::TypeLayout};

impl Checker<'_> {
    /// An expression where something of this layout is due.
    pub(in crate::check) fn item_for(
        &mut self,
        e: &ast::ExprSyntax,
        layout: &TypeLayout,
        env: &mut ExprEnv,
    ) -> ExprItem {
        match layout {
            TypeLayout::Scalar(ty) => return ExprItem::One(self.expr_for(e, *ty, env)),
            TypeLayout::Unknown => return ExprItem::error(e.span),
            TypeLayout::Record(_) | TypeLayout::Array(..) => {}
        }
        if let Syntax::Tuple(parts) = &e.kind {
            let due = self.parts_of(layout);
            if due.len() == parts.len() {
                let items = parts.iter().zip(&due).map(|(p, (_, l))| self.item_for(p, l, env)).collect();
                return self.whole(layout, items, e.span);
            }
        }
        if let Syntax::If { condition, then, otherwise } = &e.kind {
            let condition = self.expr_of(condition, InferredType::Bool, env);
            let (then, otherwise) = (self.item_for(then, layout, env), self.item_for(otherwise, layout, env));
            return self.either_item(&condition, then, otherwise, e.span, env);
        }
        if let Some(of) = self.only_part(layout)
            && (matches!(e.kind, Syntax::Tuple(_)) || self.needs_due(e))
        {
            let only = self.item_for(e, &of, env);
            return self.whole(layout, vec![only], e.span);
        }
        let item = self.item(e, env);
        self.coerce(item, layout, env)
    }

    /// The layout of what has one part alone: its value needs no parentheses of a tuple, which would be no tuple.
    fn only_part(&self, layout: &TypeLayout) -> Option<TypeLayout> {
        match self.parts_of(layout).as_slice() {
            [(_, of)] => Some(of.clone()),
            [] | [_, ..] => None,
        }
    }

    fn whole(&self, layout: &TypeLayout, parts: Vec<ExprItem>, span: Span) -> ExprItem {
        match layout {
            TypeLayout::Record(id) => ExprItem::Record(*id, parts, span),
            TypeLayout::Scalar(_) | TypeLayout::Array(..) | TypeLayout::Unknown => {
                ExprItem::Array(parts, span)
            }
        }
    }

    fn coerce(&mut self, item: ExprItem, layout: &TypeLayout, env: &mut ExprEnv) -> ExprItem {
        let span = item.span();
        if *layout == TypeLayout::Unknown {
            return ExprItem::error(span);
        }
        let due = self.parts_of(layout);
        let fits = match (&item, layout) {
            (ExprItem::One(e), TypeLayout::Scalar(ty)) => {
                let e = self.fit(e.clone(), InferredType::of(*ty), env);
                self.in_range(&e, *ty);
                return ExprItem::One(e);
            }
            (ExprItem::Record(id, ..), TypeLayout::Record(want)) if id == want => true,
            (_, TypeLayout::Record(_) | TypeLayout::Array(_, 1))
                if due.len() == 1 && !item.is_unknown() && !item.is_one_of(layout) =>
            {
                let part = self.coerce(item, &due[0].1, env);
                return self.whole(layout, vec![part], span);
            }
            (ExprItem::Tuple(parts, _), TypeLayout::Record(_) | TypeLayout::Array(..))
            | (ExprItem::Array(parts, _), TypeLayout::Array(..)) => parts.len() == due.len(),
            (ExprItem::One(_) | ExprItem::Record(..) | ExprItem::Array(..) | ExprItem::Tuple(..), _) => false,
        };
        if !fits {
            if item.is_unknown() {
                self.not_known(&item);
            } else {
                let got = self.shown(&item);
                self.other_shape(layout, &got, span);
            }
            return self.error_item(layout, span);
        }
        let parts = match item {
            ExprItem::One(_) => Vec::new(),
            ExprItem::Record(_, parts, _) | ExprItem::Array(parts, _) | ExprItem::Tuple(parts, _) => parts,
        };
        let parts = parts.into_iter().zip(&due).map(|(p, (_, l))| self.coerce(p, l, env)).collect();
        self.whole(layout, parts, span)
    }

    /// Something of another shape is needed: says which.
    fn other_shape(&mut self, layout: &TypeLayout, got: &str, span: Span) {
        let issue = types::other_shape(&self.shown_layout(layout), got, span);
        let due = self.parts_of(layout);
        let form: Vec<&str> = match layout {
            TypeLayout::Record(_) => due.iter().map(|(n, _)| n.trim_start_matches('.')).collect(),
            TypeLayout::Scalar(_) | TypeLayout::Array(..) | TypeLayout::Unknown => Vec::new(),
        };
        self.report(match form.as_slice() {
            [] => issue,
            form => issue.help(format!("write `({})`", form.join(", "))),
        });
    }

    fn error_item(&self, layout: &TypeLayout, span: Span) -> ExprItem {
        if matches!(layout, TypeLayout::Scalar(_) | TypeLayout::Unknown) {
            return ExprItem::error(span);
        }
        let parts = self.parts_of(layout).iter().map(|(_, l)| self.error_item(l, span)).collect();
        self.whole(layout, parts, span)
    }

    /// The bare name of some enumeration's value, or something that holds one: what is due says which it is.
    pub(in crate::check) fn needs_due(&self, e: &ast::ExprSyntax) -> bool {
        if let Syntax::Path(path) = &e.kind {
            return matches!(&path.names[..], [name] if self.types.values.contains_key(name.text.as_str()));
        }
        if let Syntax::If { then, otherwise, .. } = &e.kind {
            return self.needs_due(then) || self.needs_due(otherwise);
        }
        if let Syntax::Tuple(parts) = &e.kind { parts.iter().any(|p| self.needs_due(p)) } else { false }
    }

    /// An expression beside something that it is compared with, which says of which enumeration its bare names are.
    pub(in crate::check) fn item_like(
        &mut self,
        e: &ast::ExprSyntax,
        like: &ExprItem,
        env: &mut ExprEnv,
    ) -> ExprItem {
        match (&e.kind, like) {
            (
                Syntax::Path(_) | Syntax::If { .. },
                ExprItem::One(TypedExpr { ty: ty @ InferredType::Enum(_), .. }),
            ) if self.needs_due(e) || matches!(e.kind, Syntax::Path(_)) => self.item_due(e, *ty, env),
            (
                Syntax::Tuple(parts),
                ExprItem::Record(_, due, _) | ExprItem::Array(due, _) | ExprItem::Tuple(due, _),
            ) if parts.len() == due.len() => {
                let parts = parts.iter().zip(due).map(|(p, d)| self.item_like(p, d, env)).collect();
                ExprItem::Tuple(parts, e.span)
            }
            (_, _) => self.item(e, env),
        }
    }

    /// An argument taken apart as its parameter is, without looking at the single values yet.
    pub(in crate::check) fn spread<'e>(
        &mut self,
        arg: &'e ast::ExprSyntax,
        layout: &TypeLayout,
        env: &mut ExprEnv,
        variable: &dyn Fn(&Checker<'_>, &NameSyntax) -> bool,
        out: &mut Vec<ArgumentPart<'e>>,
    ) {
        if let TypeLayout::Scalar(ty) = layout {
            out.push(if arg.kind == Syntax::Any {
                ArgumentPart::Any
            } else {
                ArgumentPart::Syntax(arg, *ty)
            });
            return;
        }
        if *layout == TypeLayout::Unknown {
            return self.bind_names(arg, env, variable);
        }
        let due = self.parts_of(layout);
        let given: Option<&[ast::ExprSyntax]> = if let Syntax::Tuple(parts) = &arg.kind {
            Some(parts)
        } else if let Syntax::Call { callee, args } = &arg.kind {
            self.is_record(callee, layout).then_some(args)
        } else {
            None
        };
        if let (Some(of), Syntax::Tuple(_) | Syntax::Call { .. }) = (self.only_part(layout), &arg.kind)
            && !matches!(&arg.kind, Syntax::Call { callee, .. } if self.is_record(callee, layout))
        {
            return self.spread(arg, &of, env, variable, out);
        }
        let mut leaves = Vec::new();
        if let Some(parts) = given {
            if parts.len() == due.len() {
                for (part, (_, layout)) in parts.iter().zip(&due) {
                    self.spread(part, layout, env, variable, out);
                }
                return;
            }
            self.other_shape(layout, &format!("a tuple of {}", parts.len()), arg.span);
            parts.iter().for_each(|p| self.bind_names(p, env, variable));
            self.leaves("", layout, &mut leaves);
            out.extend(leaves.into_iter().map(|_| ArgumentPart::Any));
            return;
        }
        if arg.kind == Syntax::Any {
            self.leaves("", layout, &mut leaves);
            out.extend(leaves.into_iter().map(|_| ArgumentPart::Any));
            return;
        }
        if let Syntax::Path(path) = &arg.kind
            && let [name] = path.names.as_slice()
            && variable(self, name)
        {
            return self.spread_variable(name, layout, env, out);
        }
        let item = self.item_for(arg, layout, env);
        self.leaves("", layout, &mut leaves);
        if matches!(&arg.kind, Syntax::Call { .. })
            && matches!(item.parts(), Some([first, ..]) if first.is_unknown())
        {
            // It may have been meant as a record, whose parts are bound.
            self.bind_names(arg, env, variable);
        }
        let mut values = Vec::new();
        item.flatten(&mut values);
        out.extend(values.into_iter().zip(leaves).map(|(e, (_, ty))| ArgumentPart::Done(e, ty)));
    }

    /// The parts of a variable that is bound here, or was.
    fn spread_variable(
        &mut self,
        name: &NameSyntax,
        layout: &TypeLayout,
        env: &mut ExprEnv,
        out: &mut Vec<ArgumentPart<'_>>,
    ) {
        let mut leaves = Vec::new();
        let is_broken = env.broken.contains(&name.text);
        let other = if is_broken { None } else { self.stands_for_other(name, layout, env) };
        if is_broken || other.is_some() {
            if let Some(got) = other {
                let want = self.shown_layout(layout);
                self.report(types::other_before(&name.text, &want, &got, name.span));
            }
            self.leaves("", layout, &mut leaves);
            out.extend(leaves.into_iter().map(|_| ArgumentPart::Any));
            return;
        }
        self.leaves(&name.text, layout, &mut leaves);
        env.declare_layout(&name.text, layout.clone());
        let part = |(text, ty)| ArgumentPart::Variable(NameSyntax { text, span: name.span }, ty);
        out.extend(leaves.into_iter().map(part));
    }

    /// What a variable stands for, if it is of another layout.
    fn stands_for_other(&self, name: &NameSyntax, layout: &TypeLayout, env: &ExprEnv) -> Option<String> {
        match (env.find(&name.text), env.layout(&name.text)) {
            (Some(local), _) => Some(local.ty.to_string()),
            (None, Some(TypeLayout::Unknown)) => None,
            (None, Some(other)) => (other != layout).then(|| self.shown_layout(other)),
            (None, None) => None,
        }
    }

    /// What a pattern would bind is known, but not its types.
    pub(in crate::check) fn bind_names(
        &self,
        e: &ast::ExprSyntax,
        env: &mut ExprEnv,
        variable: &dyn Fn(&Checker<'_>, &NameSyntax) -> bool,
    ) {
        if let Syntax::Path(path) = &e.kind
            && let [name] = path.names.as_slice()
            && variable(self, name)
            && env.find(&name.text).is_none()
            && env.layout(&name.text).is_none()
        {
            env.push_local(&name.text, name.span, Noun::Variable, InferredType::Unknown);
            env.broken.push(name.text.clone());
        }
        if let Syntax::Tuple(parts) | Syntax::Call { args: parts, .. } = &e.kind {
            parts.iter().for_each(|p| self.bind_names(p, env, variable));
        }
    }

    fn is_record(&self, callee: &ast::PathSyntax, layout: &TypeLayout) -> bool {
        match (callee.names.as_slice(), layout) {
            ([name], TypeLayout::Record(id)) => self.types.records[usize::from(*id)].name.text == name.text,
            (_, _) => false,
        }
    }
}
