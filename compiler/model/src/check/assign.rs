//! Assignments of edges: to single values, to several at once, and to elements that an index names.

use hrdsl_syntax::ast::{self, Access, BinaryOp, Name};

use super::{Checker, Env, automaton::Scope, clock::is_clock, edge::and};
use crate::{
    Expr, ExprKind, Kind, Leaf, Type, Update, Value,
    noun::Noun,
    report::{automata, types},
    types::Layout,
};

impl Checker<'_> {
    /// `target = value`: one update for each single value.
    pub(super) fn update(
        &mut self,
        scope: &Scope,
        (target, access): (&Name, &[Access]),
        op: Option<BinaryOp>,
        value: &ast::Expr,
        env: &mut Env,
        updates: &mut Vec<Update>,
    ) {
        if is_clock(target, env) {
            return updates.extend(self.set_clock((target, access), op, value, scope, env));
        }
        let slot = env.find(&target.text).map(|l| l.leaf);
        if env.layout(&target.text) == Some(&Layout::Unknown) {
            return;
        }
        let layout = match slot {
            Some(Some(leaf @ (Leaf::Own(_) | Leaf::Shared(_)))) => Layout::Scalar(self.type_of(scope, leaf)),
            Some(Some(Leaf::Local(_) | Leaf::Signal(_)) | None) => {
                return self.report(automata::bound_by_edge(&target.text, target.span));
            }
            None => match env.layout(&target.text) {
                Some(layout) if self.bound_by_edge(&target.text, layout, env) => {
                    return self.report(automata::bound_by_edge(&target.text, target.span));
                }
                Some(layout) => layout.clone(),
                None => {
                    let vars = env.all().filter(|l| !matches!(l.leaf, Some(Leaf::Local(_))));
                    let single = vars.map(|l| l.name.clone()).filter(|n| !n.contains(['.', '[']));
                    let all: Vec<String> = single.chain(env.layout_names().map(str::to_owned)).collect();
                    self.unknown(Noun::Variable, target, &all, None);
                    self.item(value, env);
                    return;
                }
            },
        };
        let place = Place { name: target.text.clone(), layout, only_if: None };
        let places = self.targets(place, access, target, env);
        let several = places.len() > 1 || places.iter().any(|p| !matches!(p.layout, Layout::Scalar(_)));
        for place in places {
            if several {
                self.assign_parts(scope, &place, op, value, target, env, updates);
            } else {
                self.assign(scope, &place, op, value, target, env, updates);
            }
        }
    }

    /// Whether the parts of a name are not those of a variable.
    fn bound_by_edge(&self, name: &str, layout: &Layout, env: &Env) -> bool {
        let mut leaves = Vec::new();
        self.leaves(name, layout, &mut leaves);
        let own = |l: &super::env::Local| matches!(l.leaf, Some(Leaf::Own(_) | Leaf::Shared(_)));
        !leaves.iter().all(|(name, _)| env.find(name).is_some_and(own))
    }

    fn type_of(&self, scope: &Scope, leaf: Leaf) -> Type {
        match leaf {
            Leaf::Own(i) => self.s.automata[scope.index].vars[usize::from(i)].ty,
            Leaf::Shared(i) => self.s.shared[usize::from(i)].ty,
            Leaf::Local(_) | Leaf::Signal(_) => Type::Bool,
        }
    }

    /// What `a[i].x` may be: each element that the index can name, under the condition that it does.
    fn targets(&mut self, place: Place, access: &[Access], target: &Name, env: &mut Env) -> Vec<Place> {
        let mut places = vec![place];
        for step in access {
            let mut inner = Vec::new();
            for place in places {
                match (step, &place.layout) {
                    (Access::Index(e), Layout::Array(of, n)) => {
                        let at = self.expr_of(e, Kind::Int, env);
                        if !self.index_fits(&at, usize::from(*n), env) {
                            return Vec::new();
                        }
                        let element = |i: u16, only_if| Place {
                            name: format!("{}[{i}]", place.name),
                            layout: (**of).clone(),
                            only_if,
                        };
                        match at.constant() {
                            Some(Value::Int(i)) => {
                                inner.push(element(u16::try_from(i).unwrap_or(0), place.only_if.clone()));
                            }
                            Some(_) | None => inner.extend((0..*n).map(|i| {
                                let here = super::item::is_at(&at, usize::from(i));
                                element(i, Some(place.only_if.clone().map_or(here.clone(), |c| and(c, here))))
                            })),
                        }
                    }
                    (Access::Field(name), layout) => match self.field_of(layout, name) {
                        Some(layout) => inner.push(Place {
                            name: format!("{}{}", place.name, layout.0),
                            layout: layout.1,
                            only_if: place.only_if.clone(),
                        }),
                        None => return Vec::new(),
                    },
                    (Access::Index(_), Layout::Unknown) => return Vec::new(),
                    (Access::Index(_), layout) => {
                        let message = format!("{} has no elements", self.shown_layout(layout));
                        self.report(types::no_elements(message, target.span));
                        return Vec::new();
                    }
                }
            }
            places = inner;
        }
        places
    }

    /// One single value is set.
    #[allow(clippy::too_many_arguments, reason = "all of an assignment")]
    fn assign(
        &mut self,
        scope: &Scope,
        place: &Place,
        op: Option<BinaryOp>,
        value: &ast::Expr,
        target: &Name,
        env: &mut Env,
        updates: &mut Vec<Update>,
    ) {
        let Some(leaf) = env.find(&place.name).and_then(|l| l.leaf) else { return };
        let value = self.new_value(leaf, self.type_of(scope, leaf), op, value, target, env);
        updates.extend(set(leaf, value));
    }

    /// Several single values are set, or one of several: nothing that is set may be read on the way.
    #[allow(clippy::too_many_arguments, reason = "all of an assignment")]
    fn assign_parts(
        &mut self,
        scope: &Scope,
        place: &Place,
        op: Option<BinaryOp>,
        value: &ast::Expr,
        target: &Name,
        env: &mut Env,
        updates: &mut Vec<Update>,
    ) {
        let mut leaves = Vec::new();
        self.leaves(&place.name, &place.layout, &mut leaves);
        let mut values = Vec::new();
        match (op, leaves.as_slice()) {
            (None, _) => self.item_for(value, &place.layout, env).flatten(&mut values),
            (Some(_), [(name, ty)]) => {
                let Some(leaf) = env.find(name).and_then(|l| l.leaf) else { return };
                values.push(self.new_value(leaf, *ty, op, value, target, env));
            }
            (Some(_), _) => {
                let got = self.shown_layout(&place.layout);
                let issue = types::other_shape("one number", &got, target.span);
                return self.report(issue.help("`+=` and `-=` change one number: name a part of it"));
            }
        }
        if values.len() != leaves.len() {
            // A part is of a type that has a diagnostic.
            return;
        }
        let slots: Vec<Option<Leaf>> =
            leaves.iter().map(|(name, _)| env.find(name).and_then(|l| l.leaf)).collect();
        let whole = leaves.len() > 1;
        for (i, (slot, value)) in slots.iter().zip(values).enumerate() {
            let Some(leaf) = *slot else { continue };
            let reads = |e: &Expr, of: &[Option<Leaf>]| {
                let mut found = false;
                e.each(&mut |e| found |= matches!(e.kind, ExprKind::Leaf(l) if of.contains(&Some(l))));
                found
            };
            let early = whole && reads(&value, &slots[..i]);
            let index = place.only_if.as_ref().is_some_and(|c| self.reads_variable(c, target, env));
            if early || index {
                return self.report(automata::read_while_set(&target.text, value.span));
            }
            let value = match &place.only_if {
                None => value,
                Some(condition) => {
                    let ty = self.type_of(scope, leaf).kind();
                    let old = Expr { kind: ExprKind::Leaf(leaf), ty, span: target.span };
                    let span = value.span;
                    self.conditional(condition.clone(), value, old, span, env)
                }
            };
            updates.extend(set(leaf, value));
        }
    }

    /// Whether an expression reads a part of this variable.
    fn reads_variable(&self, e: &Expr, target: &Name, env: &Env) -> bool {
        let mut leaves = Vec::new();
        if let Some(layout) = env.layout(&target.text) {
            self.leaves(&target.text, layout, &mut leaves);
        }
        let slots: Vec<Option<Leaf>> =
            leaves.iter().map(|(name, _)| env.find(name).and_then(|l| l.leaf)).collect();
        let mut found = false;
        e.each(&mut |e| found |= matches!(e.kind, ExprKind::Leaf(l) if slots.contains(&Some(l))));
        found
    }

    /// `v`, or for `x += v` the sum.
    fn new_value(
        &mut self,
        leaf: Leaf,
        ty: Type,
        op: Option<BinaryOp>,
        value: &ast::Expr,
        target: &Name,
        env: &mut Env,
    ) -> Expr {
        let Some(op) = op else { return self.expr_for(value, ty, env) };
        if !ty.kind().is_number() {
            self.report(types::mismatch(Kind::Int, ty.kind(), None, target.span));
        }
        let by = self.expr_of(value, Kind::Int, env);
        let span = target.span.to(value.span);
        let old = Expr { kind: ExprKind::Leaf(leaf), ty: ty.kind(), span: target.span };
        Expr { kind: ExprKind::Binary(op, Box::new(old), Box::new(by)), ty: Kind::Int, span }
    }
}

/// A variable or a part of one that an assignment sets.
struct Place {
    /// `a[0].x`
    name: String,
    layout: Layout,
    /// Set only if this holds; else it keeps its value.
    only_if: Option<Expr>,
}

fn set(leaf: Leaf, value: Expr) -> Option<Update> {
    match leaf {
        Leaf::Own(i) => Some(Update::Own(i, value)),
        Leaf::Shared(i) => Some(Update::Shared(i, value)),
        Leaf::Local(_) | Leaf::Signal(_) => None,
    }
}
