//! Arguments of plans as terms: which can be equal (unification), and which is at least as general (one-way matching).

use std::collections::BTreeMap;

use crate::{Arg, BinaryOp, Context, Expr, ExprKind, Leaf, Plan, Value};

/// An argument, as far as the rules look at it.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Term<'a> {
    Any,
    Var(u16),
    Const(Value),
    /// Computed: may have any value.
    Other(&'a Expr),
    /// A list of which a part is matched: some list.
    Part,
}

impl<'a> Term<'a> {
    pub fn of_expr(e: &'a Expr) -> Self {
        match (&e.kind, e.constant()) {
            (_, Some(value)) => Term::Const(value),
            (ExprKind::Leaf(Leaf::Local(var)), None) => Term::Var(*var),
            (_, None) => Term::Other(e),
        }
    }

    pub fn of_arg(arg: &'a Arg) -> Self {
        match arg {
            Arg::Any => Term::Any,
            Arg::Var(var) => Term::Var(*var),
            Arg::Expr(e) => Term::of_expr(e),
            Arg::List(..) => Term::Part,
        }
    }
}

pub(crate) fn of_args(args: &[Arg]) -> Vec<Term<'_>> {
    args.iter().map(Term::of_arg).collect()
}

pub(crate) fn of_exprs(args: &[Expr]) -> Vec<Term<'_>> {
    args.iter().map(Term::of_expr).collect()
}

pub(crate) fn of_values(args: &[Value]) -> Vec<Term<'static>> {
    args.iter().map(|v| Term::Const(*v)).collect()
}

/// The same at run time: `1` and `1.0` are equal.
pub(crate) fn same_value(a: Value, b: Value) -> bool {
    hrdsl_ir::list::same(a, b)
}

/// Whose variables a term's are: those of two plans are different though they have the same numbers.
type Owned = (bool, u16);

/// Whether the arguments can have the same values. `apart`: they are of two plans.
pub(crate) fn may_unify(a: &[Term<'_>], b: &[Term<'_>], apart: bool) -> bool {
    let mut bound: BTreeMap<Owned, Side<'_>> = BTreeMap::new();
    a.len() == b.len()
        && a.iter().zip(b).all(|(a, b)| unify(Side::of(*a, false), Side::of(*b, apart), &mut bound))
}

#[derive(Clone, Copy)]
enum Side<'a> {
    Var(Owned),
    Rest(Term<'a>),
}

impl<'a> Side<'a> {
    fn of(term: Term<'a>, other: bool) -> Self {
        match term {
            Term::Var(var) => Side::Var((other, var)),
            Term::Any | Term::Const(_) | Term::Other(_) | Term::Part => Side::Rest(term),
        }
    }

    fn walk(mut self, bound: &BTreeMap<Owned, Side<'a>>) -> Self {
        while let Side::Var(var) = self
            && let Some(next) = bound.get(&var)
        {
            self = *next;
        }
        self
    }
}

fn unify<'a>(a: Side<'a>, b: Side<'a>, bound: &mut BTreeMap<Owned, Side<'a>>) -> bool {
    match (a.walk(bound), b.walk(bound)) {
        (Side::Var(a), Side::Var(b)) if a == b => true,
        (Side::Var(var), other @ (Side::Rest(Term::Const(_)) | Side::Var(_)))
        | (other @ Side::Rest(Term::Const(_)), Side::Var(var)) => {
            bound.insert(var, other);
            true
        }
        (Side::Rest(Term::Const(a)), Side::Rest(Term::Const(b))) => same_value(a, b),
        (Side::Var(_) | Side::Rest(_), Side::Var(_) | Side::Rest(_)) => true,
    }
}

/// What the variables of a general plan stand for in a special one.
pub(crate) type Renaming = BTreeMap<u16, Image>;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Image {
    Var(u16),
    Const(Value),
    /// Has a value there, but no name.
    Unnamed,
}

/// Whether whatever matches `special` matches `general` too. Extends the renaming, also if it does not match.
pub(crate) fn more_general(general: &[Term<'_>], special: &[Term<'_>], renaming: &mut Renaming) -> bool {
    general.len() == special.len()
        && general.iter().zip(special).all(|(g, s)| more_general_term(*g, *s, renaming))
}

fn more_general_term(general: Term<'_>, special: Term<'_>, renaming: &mut Renaming) -> bool {
    match (general, special) {
        (Term::Any, _) => true,
        (Term::Var(var), special) => {
            let image = match special {
                Term::Var(var) => Image::Var(var),
                Term::Const(value) => Image::Const(value),
                Term::Any | Term::Other(_) | Term::Part => Image::Unnamed,
            };
            match renaming.get(&var) {
                Some(known) => *known == image && image != Image::Unnamed,
                None => {
                    renaming.insert(var, image);
                    true
                }
            }
        }
        (Term::Const(a), Term::Const(b)) => same_value(a, b),
        (Term::Other(a), Term::Other(b)) => {
            is_total(a) && same_expr(a, b, &mut |a, b| renaming.get(&a) == Some(&Image::Var(b)))
        }
        (
            Term::Const(_) | Term::Other(_) | Term::Part,
            Term::Any | Term::Var(_) | Term::Const(_) | Term::Other(_) | Term::Part,
        ) => false,
    }
}

/// Whether two expressions are written alike; `vars` says which variables are alike.
pub(crate) fn same_expr(a: &Expr, b: &Expr, vars: &mut dyn FnMut(u16, u16) -> bool) -> bool {
    match (&a.kind, &b.kind) {
        (ExprKind::Const(a), ExprKind::Const(b)) => same_value(*a, *b),
        (ExprKind::Leaf(Leaf::Local(a)), ExprKind::Leaf(Leaf::Local(b))) => vars(*a, *b),
        (ExprKind::Leaf(a), ExprKind::Leaf(b)) => a == b,
        (ExprKind::Term(a), ExprKind::Term(b)) => a == b,
        (ExprKind::Unary(f, a), ExprKind::Unary(g, b)) => f == g && same_expr(a, b, vars),
        (ExprKind::Binary(f, a, b), ExprKind::Binary(g, c, d)) => {
            f == g && same_expr(a, c, vars) && same_expr(b, d, vars)
        }
        (ExprKind::If(a, b, c), ExprKind::If(d, e, f)) => {
            same_expr(a, d, vars) && same_expr(b, e, vars) && same_expr(c, f, vars)
        }
        (ExprKind::Call(f, a), ExprKind::Call(g, b)) => {
            f == g && a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same_expr(a, b, vars))
        }
        (ExprKind::List(a, r), ExprKind::List(b, s)) => {
            a.len() == b.len()
                && a.iter().zip(b).all(|(a, b)| same_expr(a, b, vars))
                && match (r, s) {
                    (None, None) => true,
                    (Some(r), Some(s)) => same_expr(r, s, vars),
                    (Some(_), None) | (None, Some(_)) => false,
                }
        }
        (
            ExprKind::Const(_)
            | ExprKind::Leaf(_)
            | ExprKind::Term(_)
            | ExprKind::Unary(..)
            | ExprKind::Binary(..)
            | ExprKind::If(..)
            | ExprKind::Call(..)
            | ExprKind::List(..)
            | ExprKind::Element(_)
            | ExprKind::Apply(..)
            | ExprKind::Error,
            _,
        ) => false,
    }
}

/// The value of an expression whose variables have these values.
pub(crate) fn fold(e: &Expr, vars: &dyn Fn(u16) -> Option<Value>) -> Option<Value> {
    match &e.kind {
        ExprKind::Const(value) => Some(*value),
        ExprKind::Leaf(Leaf::Local(var)) => vars(*var),
        ExprKind::Leaf(_)
        | ExprKind::Term(_)
        | ExprKind::List(..)
        | ExprKind::Element(_)
        | ExprKind::Apply(..)
        | ExprKind::Error => None,
        ExprKind::Unary(op, a) => hrdsl_ir::expr::unary(*op, fold(a, vars)?).ok(),
        ExprKind::Binary(op, a, b) => hrdsl_ir::expr::binary(*op, fold(a, vars)?, fold(b, vars)?).ok(),
        ExprKind::If(c, a, b) => match fold(c, vars)? {
            Value::Bool(true) => fold(a, vars),
            Value::Bool(false) => fold(b, vars),
            Value::Int(_) | Value::Float(_) | Value::Symbol(_) | Value::Text(_) | Value::List(_) => None,
        },
        ExprKind::Call(f, args) => {
            let args: Option<Vec<Value>> = args.iter().map(|a| fold(a, vars)).collect();
            hrdsl_ir::expr::call(*f, &args?).ok()
        }
    }
}

/// Whether it has a value for all values of its variables: a plan with a division by zero is not applicable.
pub(crate) fn is_total(e: &Expr) -> bool {
    let mut total = true;
    e.each(&mut |part| {
        total &= !matches!(part.kind, ExprKind::Binary(BinaryOp::Div | BinaryOp::Rem, ..));
    });
    total
}

/// Formulas with more alternatives are not looked into.
const MANY: usize = 64;

/// A context as alternatives of conjunctions of literals, negations and tests, in their order; `None` if there are too
/// many.
pub(crate) fn alternatives(context: &Context) -> Option<Vec<Vec<&Context>>> {
    expand(context, vec![vec![]])
}

fn expand<'a>(context: &'a Context, mut so_far: Vec<Vec<&'a Context>>) -> Option<Vec<Vec<&'a Context>>> {
    match context {
        Context::True => {}
        Context::Test(e) if e.constant() == Some(Value::Bool(true)) => {}
        Context::And(all) => return all.iter().try_fold(so_far, |so_far, c| expand(c, so_far)),
        Context::Or(any) => {
            let mut all = Vec::new();
            for c in any {
                all.extend(expand(c, so_far.clone())?);
            }
            so_far = all;
        }
        Context::Belief(..)
        | Context::Not(_)
        | Context::Test(_)
        | Context::Unify(..)
        | Context::Internal(..) => {
            so_far.iter_mut().for_each(|c| c.push(context));
        }
    }
    (so_far.len() <= MANY).then_some(so_far)
}

/// For each part of a conjunction, the variables that have a value before it.
pub(crate) fn bound_before(plan: &Plan, parts: &[&Context]) -> Vec<Vec<u16>> {
    let mut bound: Vec<u16> = vars_of(&plan.trigger.args);
    plan.trigger.annotations.iter().for_each(|(_, arg)| arg.each_var(&mut |var| bound.push(var)));
    let mut all = Vec::new();
    for part in parts {
        all.push(bound.clone());
        bound.extend(part.binds());
    }
    all
}

pub(crate) fn vars_of(args: &[Arg]) -> Vec<u16> {
    let mut vars = Vec::new();
    args.iter().for_each(|arg| arg.each_var(&mut |var| vars.push(var)));
    vars
}

#[cfg(test)]
mod tests {
    use super::*;

    const ANY: Term<'static> = Term::Any;

    fn v(n: u16) -> Term<'static> {
        Term::Var(n)
    }

    fn c(n: i64) -> Term<'static> {
        Term::Const(Value::Int(n))
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
        assert!(may_unify(&[c(1)], &[Term::Const(Value::Float(1.0))], true));
        assert!(!may_unify(&[c(1)], &[c(2)], true));
        assert!(!may_unify(&[c(1)], &[], true));
    }

    #[test]
    fn a_head_is_more_general_in_one_direction() {
        let general = |a: &[Term<'_>], b: &[Term<'_>]| more_general(a, b, &mut Renaming::new());
        assert!(general(&[v(0), v(1)], &[v(1), v(0)]), "renamed");
        assert!(general(&[v(0), v(1)], &[v(3), v(3)]));
        assert!(!general(&[v(0), v(0)], &[v(1), v(2)]));
        assert!(general(&[v(0), v(0)], &[v(2), v(2)]));
        assert!(general(&[v(0), v(0)], &[c(2), c(2)]));
        assert!(!general(&[v(0), v(0)], &[ANY, ANY]), "two values, each without a name");
        assert!(general(&[ANY], &[c(1)]) && general(&[v(0)], &[ANY]));
        assert!(!general(&[c(1)], &[v(0)]) && !general(&[c(1)], &[ANY]) && !general(&[c(1)], &[c(2)]));
        let mut renaming = Renaming::new();
        assert!(more_general(&[v(0), v(1), v(2)], &[v(7), c(3), ANY], &mut renaming));
        let images: Vec<Image> = renaming.into_values().collect();
        assert_eq!(images, [Image::Var(7), Image::Const(Value::Int(3)), Image::Unnamed]);
    }
}
