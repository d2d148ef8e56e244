//! Arguments of plans as terms: which can be equal (unification), and which is at least as general (one-way matching).

use std::collections::BTreeMap;

use crate::{BinaryOp, TypedContext, TypedExpr, TypedExprKind, TypedPlan, TypedTerm, Value, VariableRef};

/// An argument, as far as the rules look at it.
#[derive(Clone, Copy, Debug)]
pub(crate) enum PlanTerm<'a> {
    Any,
    Var(u16),
    Const(Value),
    /// Computed: may have any value.
    Other(&'a TypedExpr),
    /// A list of which a part is matched: some list.
    Part,
}

impl<'a> PlanTerm<'a> {
    pub fn of_expr(e: &'a TypedExpr) -> Self {
        match (&e.kind, e.constant()) {
            (_, Some(value)) => PlanTerm::Const(value),
            (TypedExprKind::Leaf(VariableRef::Local(var)), None) => PlanTerm::Var(*var),
            (_, None) => PlanTerm::Other(e),
        }
    }

    pub fn of_arg(arg: &'a TypedTerm) -> Self {
        match arg {
            TypedTerm::Any => PlanTerm::Any,
            TypedTerm::Var(var) => PlanTerm::Var(*var),
            TypedTerm::Expr(e) => PlanTerm::of_expr(e),
            TypedTerm::List(..) => PlanTerm::Part,
        }
    }
}

pub(crate) fn of_args(args: &[TypedTerm]) -> Vec<PlanTerm<'_>> {
    args.iter().map(PlanTerm::of_arg).collect()
}

pub(crate) fn of_exprs(args: &[TypedExpr]) -> Vec<PlanTerm<'_>> {
    args.iter().map(PlanTerm::of_expr).collect()
}

pub(crate) fn of_values(args: &[Value]) -> Vec<PlanTerm<'static>> {
    args.iter().map(|v| PlanTerm::Const(*v)).collect()
}

/// The same at run time: `1` and `1.0` are equal.
pub(crate) fn same_value(a: Value, b: Value) -> bool {
    hrdsl_ir::list::same(a, b)
}

/// Whose variables a term's are: those of two plans are different though they have the same numbers.
type OwnedVar = (bool, u16);

/// Whether the arguments can have the same values. `apart`: they are of two plans.
pub(crate) fn may_unify(a: &[PlanTerm<'_>], b: &[PlanTerm<'_>], apart: bool) -> bool {
    let mut bound: BTreeMap<OwnedVar, PlanSide<'_>> = BTreeMap::new();
    a.len() == b.len()
        && a.iter().zip(b).all(|(a, b)| unify(PlanSide::of(*a, false), PlanSide::of(*b, apart), &mut bound))
}

#[derive(Clone, Copy)]
enum PlanSide<'a> {
    Var(OwnedVar),
    Rest(PlanTerm<'a>),
}

impl<'a> PlanSide<'a> {
    fn of(term: PlanTerm<'a>, other: bool) -> Self {
        match term {
            PlanTerm::Var(var) => PlanSide::Var((other, var)),
            PlanTerm::Any | PlanTerm::Const(_) | PlanTerm::Other(_) | PlanTerm::Part => PlanSide::Rest(term),
        }
    }

    fn walk(mut self, bound: &BTreeMap<OwnedVar, PlanSide<'a>>) -> Self {
        while let PlanSide::Var(var) = self
            && let Some(next) = bound.get(&var)
        {
            self = *next;
        }
        self
    }
}

fn unify<'a>(a: PlanSide<'a>, b: PlanSide<'a>, bound: &mut BTreeMap<OwnedVar, PlanSide<'a>>) -> bool {
    match (a.walk(bound), b.walk(bound)) {
        (PlanSide::Var(a), PlanSide::Var(b)) if a == b => true,
        (PlanSide::Var(var), other @ (PlanSide::Rest(PlanTerm::Const(_)) | PlanSide::Var(_)))
        | (other @ PlanSide::Rest(PlanTerm::Const(_)), PlanSide::Var(var)) => {
            bound.insert(var, other);
            true
        }
        (PlanSide::Rest(PlanTerm::Const(a)), PlanSide::Rest(PlanTerm::Const(b))) => same_value(a, b),
        (PlanSide::Var(_) | PlanSide::Rest(_), PlanSide::Var(_) | PlanSide::Rest(_)) => true,
    }
}

/// What the variables of a general plan stand for in a special one.
pub(crate) type VarRenaming = BTreeMap<u16, TermImage>;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum TermImage {
    Var(u16),
    Const(Value),
    /// Has a value there, but no name.
    Unnamed,
}

/// Whether whatever matches `special` matches `general` too. Extends the renaming, also if it does not match.
pub(crate) fn more_general(
    general: &[PlanTerm<'_>],
    special: &[PlanTerm<'_>],
    renaming: &mut VarRenaming,
) -> bool {
    general.len() == special.len()
        && general.iter().zip(special).all(|(g, s)| more_general_term(*g, *s, renaming))
}

fn more_general_term(general: PlanTerm<'_>, special: PlanTerm<'_>, renaming: &mut VarRenaming) -> bool {
    match (general, special) {
        (PlanTerm::Any, _) => true,
        (PlanTerm::Var(var), special) => {
            let image = match special {
                PlanTerm::Var(var) => TermImage::Var(var),
                PlanTerm::Const(value) => TermImage::Const(value),
                PlanTerm::Any | PlanTerm::Other(_) | PlanTerm::Part => TermImage::Unnamed,
            };
            match renaming.get(&var) {
                Some(known) => *known == image && image != TermImage::Unnamed,
                None => {
                    renaming.insert(var, image);
                    true
                }
            }
        }
        (PlanTerm::Const(a), PlanTerm::Const(b)) => same_value(a, b),
        (PlanTerm::Other(a), PlanTerm::Other(b)) => {
            is_total(a) && same_expr(a, b, &mut |a, b| renaming.get(&a) == Some(&TermImage::Var(b)))
        }
        (
            PlanTerm::Const(_) | PlanTerm::Other(_) | PlanTerm::Part,
            PlanTerm::Any | PlanTerm::Var(_) | PlanTerm::Const(_) | PlanTerm::Other(_) | PlanTerm::Part,
        ) => false,
    }
}

/// Whether two expressions over the same variables are written alike, wherever they stand.
pub(crate) fn same(a: &TypedExpr, b: &TypedExpr) -> bool {
    same_expr(a, b, &mut |a, b| a == b)
}

/// Whether two expressions are written alike; `vars` says which variables are alike.
pub(crate) fn same_expr(a: &TypedExpr, b: &TypedExpr, vars: &mut dyn FnMut(u16, u16) -> bool) -> bool {
    match (&a.kind, &b.kind) {
        (TypedExprKind::Const(a), TypedExprKind::Const(b)) => same_value(*a, *b),
        (TypedExprKind::Leaf(VariableRef::Local(a)), TypedExprKind::Leaf(VariableRef::Local(b))) => {
            vars(*a, *b)
        }
        (TypedExprKind::Leaf(a), TypedExprKind::Leaf(b)) => a == b,
        (TypedExprKind::Term(a), TypedExprKind::Term(b)) => a == b,
        (TypedExprKind::Unary(f, a), TypedExprKind::Unary(g, b)) => f == g && same_expr(a, b, vars),
        (TypedExprKind::Binary(f, a, b), TypedExprKind::Binary(g, c, d)) => {
            f == g && same_expr(a, c, vars) && same_expr(b, d, vars)
        }
        (TypedExprKind::If(a, b, c), TypedExprKind::If(d, e, f)) => {
            same_expr(a, d, vars) && same_expr(b, e, vars) && same_expr(c, f, vars)
        }
        (TypedExprKind::Call(f, a), TypedExprKind::Call(g, b)) => {
            f == g && a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same_expr(a, b, vars))
        }
        (TypedExprKind::List(a, r), TypedExprKind::List(b, s)) => {
            a.len() == b.len()
                && a.iter().zip(b).all(|(a, b)| same_expr(a, b, vars))
                && match (r, s) {
                    (None, None) => true,
                    (Some(r), Some(s)) => same_expr(r, s, vars),
                    (Some(_), None) | (None, Some(_)) => false,
                }
        }
        (
            TypedExprKind::Const(_)
            | TypedExprKind::Leaf(_)
            | TypedExprKind::Term(_)
            | TypedExprKind::Unary(..)
            | TypedExprKind::Binary(..)
            | TypedExprKind::If(..)
            | TypedExprKind::Call(..)
            | TypedExprKind::List(..)
            | TypedExprKind::Element(_)
            | TypedExprKind::Apply(..)
            | TypedExprKind::Error,
            _,
        ) => false,
    }
}

/// Whether it has a value for all values of its variables: a plan with a division by zero is not applicable.
pub(crate) fn is_total(e: &TypedExpr) -> bool {
    let mut total = true;
    e.each(&mut |part| {
        total &= !matches!(part.kind, TypedExprKind::Binary(BinaryOp::Div | BinaryOp::Rem, ..));
    });
    total
}

/// Formulas with more alternatives are not looked into.
const MANY: usize = 64;

/// A context as alternatives of conjunctions of literals, negations and tests, in their order; `None` if there are too
/// many.
pub(crate) fn alternatives(context: &TypedContext) -> Option<Vec<Vec<&TypedContext>>> {
    expand(context, vec![vec![]])
}

fn expand<'a>(
    context: &'a TypedContext,
    mut so_far: Vec<Vec<&'a TypedContext>>,
) -> Option<Vec<Vec<&'a TypedContext>>> {
    match context {
        TypedContext::True => {}
        TypedContext::Test(e) if e.constant() == Some(Value::Bool(true)) => {}
        TypedContext::And(all) => return all.iter().try_fold(so_far, |so_far, c| expand(c, so_far)),
        TypedContext::Or(any) => {
            let mut all = Vec::new();
            for c in any {
                all.extend(expand(c, so_far.clone())?);
            }
            so_far = all;
        }
        TypedContext::Belief(..)
        | TypedContext::Not(_)
        | TypedContext::Test(_)
        | TypedContext::Unify(..)
        | TypedContext::Internal(..) => {
            so_far.iter_mut().for_each(|c| c.push(context));
        }
    }
    (so_far.len() <= MANY).then_some(so_far)
}

/// The test that a literal of a conjunction is, with whether it must hold: `N > 3`, `not N > 3`.
pub(crate) fn tested(part: &TypedContext) -> Option<(&TypedExpr, bool)> {
    if let TypedContext::Not(inner) = part {
        return if let TypedContext::Test(e) = inner.as_ref() { Some((e, false)) } else { None };
    }
    if let TypedContext::Test(e) = part { Some((e, true)) } else { None }
}

/// For each part of a conjunction, the variables that have a value before it.
pub(crate) fn bound_before(plan: &TypedPlan, parts: &[&TypedContext]) -> Vec<Vec<u16>> {
    let mut bound: Vec<u16> = vars_of(&plan.trigger.args);
    plan.trigger.annotations.iter().for_each(|(_, arg)| arg.each_var(&mut |var| bound.push(var)));
    let mut all = Vec::new();
    for part in parts {
        all.push(bound.clone());
        bound.extend(part.binds());
    }
    all
}

pub(crate) fn vars_of(args: &[TypedTerm]) -> Vec<u16> {
    let mut vars = Vec::new();
    args.iter().for_each(|arg| arg.each_var(&mut |var| vars.push(var)));
    vars
}

#[cfg(test)]
mod tests {
    use super::*;

    const ANY: PlanTerm<'static> = PlanTerm::Any;

    fn v(n: u16) -> PlanTerm<'static> {
        PlanTerm::Var(n)
    }

    fn c(n: i64) -> PlanTerm<'static> {
        PlanTerm::Const(Value::Int(n))
    }

    #[test]
    fn arguments_unify_if_they_can_be_equal() {
        assert!(may_unify(&[v(0), c(1)], &[c(2), v(0)], true));
        assert!(!may_unify(&[v(0), c(1)], &[c(2), v(0)], false), "one variable, two values");
        assert!(!may_unify(&[v(0), v(0)], &[c(1), c(2)], true));
        assert!(!may_unify(&[v(0), v(0), v(1)], &[v(1), c(1), c(2)], false));
        assert!(may_unify(&[v(0), v(0), c(3)], &[v(5), v(6), v(6)], true));
        assert!(!may_unify(&[v(0), v(0), c(3), c(4)], &[v(5), v(6), v(6), v(5)], true), "by way of two");
        assert!(may_unify(&[ANY, ANY], &[c(1), v(3)], true));
        assert!(may_unify(&[c(1)], &[PlanTerm::Const(Value::Float(1.0))], true));
        assert!(!may_unify(&[c(1)], &[c(2)], true));
        assert!(!may_unify(&[c(1)], &[], true));
    }

    #[test]
    fn a_head_is_more_general_in_one_direction() {
        let general = |a: &[PlanTerm<'_>], b: &[PlanTerm<'_>]| more_general(a, b, &mut VarRenaming::new());
        assert!(general(&[v(0), v(1)], &[v(1), v(0)]), "renamed");
        assert!(general(&[v(0), v(1)], &[v(3), v(3)]));
        assert!(!general(&[v(0), v(0)], &[v(1), v(2)]));
        assert!(general(&[v(0), v(0)], &[v(2), v(2)]));
        assert!(general(&[v(0), v(0)], &[c(2), c(2)]));
        assert!(!general(&[v(0), v(0)], &[ANY, ANY]), "two values, each without a name");
        assert!(general(&[ANY], &[c(1)]) && general(&[v(0)], &[ANY]));
        assert!(!general(&[c(1)], &[v(0)]) && !general(&[c(1)], &[ANY]) && !general(&[c(1)], &[c(2)]));
        let mut renaming = VarRenaming::new();
        assert!(more_general(&[v(0), v(1), v(2)], &[v(7), c(3), ANY], &mut renaming));
        let images: Vec<TermImage> = renaming.into_values().collect();
        assert_eq!(images, [TermImage::Var(7), TermImage::Const(Value::Int(3)), TermImage::Unnamed]);
    }
}
