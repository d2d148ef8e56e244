//! Elements of arrays of variables that are chosen at run time: an index outside of its array is a fault of the model.

use hrdsl_syntax::ast::{self, AccessSyntax, ExprSyntaxKind as Syntax, NameSyntax};

use hrdsl_source::Span;

use crate::check::{
    checker::Checker,
    state::{
        item::ExprItem,
        scope::{ExprEnv, IndexedArrays, LocalName},
    },
    value::range,
};
use crate::{
    BinaryOp, InferredType, Type, TypedExpr, TypedExprKind, TypedIndex, TypedLvalue, Value, VariableRef,
    leaves,
    report::{automata, types},
    types::TypeLayout,
};

/// A variable or a part of one, on the way to it.
pub(in crate::check) struct ReachedElements {
    /// `a[0].x`; where an index is chosen at run time, with the first.
    name: String,
    layout: TypeLayout,
    indices: Vec<TypedIndex>,
}

impl ReachedElements {
    pub fn whole(name: &str, layout: TypeLayout) -> Self {
        Self { name: name.to_owned(), layout, indices: Vec::new() }
    }
}

/// The type of a variable that an automaton or function has.
pub(in crate::check) fn type_of(local: &LocalName) -> Type {
    match local.ty {
        InferredType::Int => {
            local.range.map_or(Type::Int { lo: i64::MIN, hi: i64::MAX }, |(lo, hi)| Type::Int { lo, hi })
        }
        InferredType::Enum(of) => Type::Enum(of),
        InferredType::Bool
        | InferredType::Float(_)
        | InferredType::Text
        | InferredType::List(_)
        | InferredType::Unknown => Type::Bool,
    }
}

/// The name that an expression of indices and fields starts with.
fn root(e: &ast::ExprSyntax) -> Option<&ast::PathSyntax> {
    if let Syntax::Index { of, .. } | Syntax::Field { of, .. } = &e.kind {
        return root(of);
    }
    if let Syntax::Path(path) = &e.kind { Some(path) } else { None }
}

impl Checker<'_> {
    /// `a[i].x` of a variable; `None`: it is not one whose elements are chosen at run time.
    pub(in crate::check) fn element(&mut self, e: &ast::ExprSyntax, env: &mut ExprEnv) -> Option<ExprItem> {
        if env.elements == IndexedArrays::None {
            return None;
        }
        let name = root(e)?.names.first()?;
        if env.find(&name.text).is_some() || env.broken.contains(&name.text) {
            return None;
        }
        let layout = env.layout(&name.text)?;
        let mut leaves = Vec::new();
        self.leaves(&name.text, layout, &mut leaves);
        let first = env.find(&leaves.first()?.0)?.leaf?;
        let chosen = match first {
            VariableRef::Own(_) | VariableRef::Shared(_) => true,
            VariableRef::Local(_) => env.elements == IndexedArrays::Locals,
            VariableRef::Signal(_) => false,
        };
        if !chosen {
            return None;
        }
        Some(match self.reach(e, env) {
            Some(reached) => self.reached_item(&reached, e.span, env),
            None => ExprItem::error(e.span),
        })
    }

    fn reach(&mut self, e: &ast::ExprSyntax, env: &mut ExprEnv) -> Option<ReachedElements> {
        if let Syntax::Index { of, index } = &e.kind {
            let reached = self.reach(of, env)?;
            return self.at_index(reached, index, of.span, env);
        }
        if let Syntax::Field { of, name } = &e.kind {
            let reached = self.reach(of, env)?;
            return self.at_field(reached, name);
        }
        let Syntax::Path(path) = &e.kind else { return None };
        let (first, fields) = path.names.split_first()?;
        let whole = ReachedElements::whole(&first.text, env.layout(&first.text)?.clone());
        fields.iter().try_fold(whole, |reached, field| self.at_field(reached, field))
    }

    fn at_field(&mut self, reached: ReachedElements, field: &NameSyntax) -> Option<ReachedElements> {
        let (part, layout) = self.field_of(&reached.layout, field)?;
        Some(ReachedElements { name: format!("{}{part}", reached.name), layout, indices: reached.indices })
    }

    /// An index is only looked at: what it calls changes nothing.
    fn at_index(
        &mut self,
        mut reached: ReachedElements,
        index: &ast::ExprSyntax,
        of: Span,
        env: &mut ExprEnv,
    ) -> Option<ReachedElements> {
        let effects = std::mem::replace(&mut env.effects, false);
        let at = self.expr_of(index, InferredType::Int, env);
        env.effects = effects;
        let (element, count) = match &reached.layout {
            TypeLayout::Array(element, count) => ((**element).clone(), *count),
            TypeLayout::Unknown => return None,
            other @ (TypeLayout::Scalar(_) | TypeLayout::Record(_)) => {
                let message = format!("{} has no elements", self.shown_layout(other));
                self.report(types::no_elements(message, of));
                return None;
            }
        };
        if !self.index_possible(&at, count, env) {
            return None;
        }
        match at.constant() {
            Some(Value::Int(n)) => reached.name = format!("{}[{n}]", reached.name),
            Some(_) => return None,
            None => {
                let stride = u16::try_from(self.size(&element)).unwrap_or(u16::MAX);
                reached.name = format!("{}[0]", reached.name);
                reached.indices.push(TypedIndex { at, count, stride });
            }
        }
        reached.layout = element;
        Some(reached)
    }

    /// Whether an index can lie within an array of so many; says so if not.
    fn index_possible(&mut self, at: &TypedExpr, count: u16, env: &ExprEnv) -> bool {
        if at.ty != InferredType::Int {
            return false;
        }
        let last = i64::from(count) - 1;
        let never = range::of(at, env).is_some_and(|(lo, hi)| hi < 0 || lo > last);
        if never {
            self.report(types::bad_index(at, last));
        }
        !never
    }

    /// What stands there as a value.
    fn reached_item(&mut self, reached: &ReachedElements, span: Span, env: &ExprEnv) -> ExprItem {
        if reached.indices.is_empty() {
            return self.assembled(&reached.name, &reached.layout, env, span);
        }
        let copies = self.size(&reached.layout);
        for index in &reached.indices {
            if !self.may_copy(&ExprItem::One(index.at.clone()), copies, span) {
                return ExprItem::error(span);
            }
        }
        self.elements(&reached.name, &reached.layout, &reached.indices, span, env)
    }

    fn elements(
        &self,
        name: &str,
        layout: &TypeLayout,
        indices: &[TypedIndex],
        span: Span,
        env: &ExprEnv,
    ) -> ExprItem {
        let parts = || {
            let parts = self.parts_of(layout).into_iter();
            parts.map(|(n, part)| self.elements(&format!("{name}{n}"), &part, indices, span, env)).collect()
        };
        match layout {
            TypeLayout::Scalar(_) => match env.find(name).and_then(|l| Some((l.leaf?, l.ty))) {
                Some((leaf, ty)) => {
                    let place = TypedLvalue { slot: leaf, indices: indices.to_vec() };
                    ExprItem::One(TypedExpr { kind: TypedExprKind::Element(Box::new(place)), ty, span })
                }
                None => ExprItem::error(span),
            },
            TypeLayout::Record(id) => ExprItem::Record(*id, parts(), span),
            TypeLayout::Array(..) => ExprItem::Array(parts(), span),
            TypeLayout::Unknown => ExprItem::error(span),
        }
    }

    // ── assignments ──

    /// `target… = value`: what each single value of the target becomes, in order.
    pub(in crate::check) fn assigned(
        &mut self,
        target: &NameSyntax,
        (layout, access): (TypeLayout, &[AccessSyntax]),
        op: Option<BinaryOp>,
        value: &ast::ExprSyntax,
        env: &mut ExprEnv,
    ) -> Vec<(TypedLvalue, TypedExpr)> {
        let mut reached = Some(ReachedElements::whole(&target.text, layout));
        for step in access {
            let Some(before) = reached else { break };
            reached = match step {
                AccessSyntax::Index(e) => self.at_index(before, e, target.span, env),
                AccessSyntax::Field(name) => self.at_field(before, name),
            };
        }
        let Some(reached) = reached else { return Vec::new() };
        let mut leaves = Vec::new();
        self.leaves(&reached.name, &reached.layout, &mut leaves);
        let place = |name: &str| {
            let leaf = env.find(name).and_then(|l| l.leaf)?;
            Some(TypedLvalue { slot: leaf, indices: reached.indices.clone() })
        };
        let places: Vec<TypedLvalue> = leaves.iter().filter_map(|(name, _)| place(name)).collect();
        let values = match (op, places.as_slice(), &reached.layout) {
            (None, _, TypeLayout::Scalar(ty)) => vec![self.expr_for(value, *ty, env)],
            (None, _, layout) => {
                let mut values = Vec::new();
                self.item_for(value, layout, env).flatten(&mut values);
                values
            }
            (Some(op), [place], TypeLayout::Scalar(ty)) => {
                vec![self.changed(place, *ty, op, value, target, env)]
            }
            (Some(_), _, layout) => {
                let got = self.shown_layout(layout);
                let issue = types::other_shape("one number", &got, target.span);
                self.report(issue.help("`+=` and `-=` change one number: name a part of it"));
                return Vec::new();
            }
        };
        // A part may be of a type that has a diagnostic.
        if values.len() != places.len() || !self.apart(&places, &values, target) {
            return Vec::new();
        }
        places.into_iter().zip(values).collect()
    }

    /// `target op value`
    fn changed(
        &mut self,
        place: &TypedLvalue,
        ty: Type,
        op: BinaryOp,
        value: &ast::ExprSyntax,
        target: &NameSyntax,
        env: &mut ExprEnv,
    ) -> TypedExpr {
        if !InferredType::of(ty).is_number() {
            self.report(types::mismatch(InferredType::Int, InferredType::of(ty), None, target.span));
        }
        let by = self.expr_of(value, InferredType::Int, env);
        let span = target.span.to(value.span);
        let kind = if place.indices.is_empty() {
            TypedExprKind::Leaf(place.slot)
        } else {
            TypedExprKind::Element(Box::new(place.clone()))
        };
        let old = TypedExpr { kind, ty: InferredType::of(ty), span: target.span };
        TypedExpr {
            kind: TypedExprKind::Binary(op, Box::new(old), Box::new(by)),
            ty: InferredType::Int,
            span,
        }
    }

    /// Several values are set one after the other: none may be read after it is set. Says so if one is.
    fn apart(&mut self, places: &[TypedLvalue], values: &[TypedExpr], target: &NameSyntax) -> bool {
        let mut set: Vec<VariableRef> = Vec::new();
        for (place, value) in places.iter().zip(values) {
            let mut read = false;
            if !set.is_empty() {
                value.each_leaf(&mut |l| read |= set.contains(&l));
                place.indices.iter().for_each(|i| i.at.each_leaf(&mut |l| read |= set.contains(&l)));
            }
            if read {
                self.report(automata::read_while_set(&target.text, value.span));
                return false;
            }
            if places.len() > 1 {
                set.extend(leaves(place));
            }
        }
        true
    }
}
