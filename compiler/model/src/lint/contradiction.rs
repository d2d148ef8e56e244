//! Contexts that can never hold: a constant, a belief and its negation, comparisons that exclude each other.

use std::collections::BTreeMap;

use hrdsl_source::Span;

use super::{
    agent_facts::AgentFacts,
    plan_terms::{PlanTerm, alternatives, bound_before, of_args, same, same_value, tested},
    triggers::matched,
};
use crate::{
    Parameter, Type, TypedContext, TypedExpr, TypedExprKind, TypedPlan, TypedTerm, VariableRef,
    expr::ComparisonOp,
};

/// Why a context can never hold.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FoundContradiction {
    pub span: Span,
    pub why: String,
    /// What it clashes with.
    pub with: Option<(Span, String)>,
}

/// Why no alternative of the plan's context can hold: what is wrong with the first.
pub(crate) fn of(facts: &AgentFacts<'_>, plan: &TypedPlan) -> Option<FoundContradiction> {
    let mut first = None;
    for parts in alternatives(&plan.context)? {
        let found = in_conjunction(facts, plan, &parts)?;
        first.get_or_insert(found);
    }
    first
}

fn in_conjunction(
    facts: &AgentFacts<'_>,
    plan: &TypedPlan,
    parts: &[&TypedContext],
) -> Option<FoundContradiction> {
    constant(parts)
        .or_else(|| negated_belief(plan, parts))
        .or_else(|| negated_test(parts))
        .or_else(|| excluded(parts))
        .or_else(|| out_of_range(facts, plan, parts))
}

fn constant(parts: &[&TypedContext]) -> Option<FoundContradiction> {
    parts.iter().find_map(|part| {
        let (e, holds) = tested(part)?;
        (e.constant() == Some(crate::Value::Bool(!holds))).then(|| FoundContradiction {
            span: e.span,
            why: format!("this is always {}", !holds),
            with: None,
        })
    })
}

/// `b(X) && not b(X)`
fn negated_belief(plan: &TypedPlan, parts: &[&TypedContext]) -> Option<FoundContradiction> {
    let bound = bound_before(plan, parts);
    parts.iter().zip(&bound).find_map(|(part, bound)| {
        let TypedContext::Not(inner) = part else { return None };
        // One with annotations may be absent while others are held.
        let TypedContext::Belief(denied) = inner.as_ref() else { return None };
        if !denied.annotations.is_empty() {
            return None;
        }
        parts.iter().find_map(|part| {
            let TypedContext::Belief(held) = part else { return None };
            let clashes = held.belief == denied.belief && denies(&denied.args, &held.args, bound);
            clashes.then(|| FoundContradiction {
                span: denied.origin,
                why: "this cannot be absent".to_owned(),
                with: Some((held.origin, "since the context needs it here".to_owned())),
            })
        })
    })
}

/// Whether a fact that matches `held` matches what is denied. A variable that is not bound before the negation stands
/// for any value in it.
fn denies(denied: &[TypedTerm], held: &[TypedTerm], bound: &[u16]) -> bool {
    let mut own: Vec<(u16, PlanTerm<'_>)> = Vec::new();
    of_args(denied).into_iter().zip(of_args(held)).all(|(denied, held)| match (denied, held) {
        (PlanTerm::Any, _) => true,
        (PlanTerm::Var(a), held) if !bound.contains(&a) => match own.iter().find(|(var, _)| *var == a) {
            Some((_, before)) => same_term(*before, held),
            None => {
                own.push((a, held));
                true
            }
        },
        (denied @ (PlanTerm::Var(_) | PlanTerm::Const(_) | PlanTerm::Other(_) | PlanTerm::Part), held) => {
            same_term(denied, held)
        }
    })
}

fn same_term(a: PlanTerm<'_>, b: PlanTerm<'_>) -> bool {
    match (a, b) {
        (PlanTerm::Var(a), PlanTerm::Var(b)) => a == b,
        (PlanTerm::Const(a), PlanTerm::Const(b)) => same_value(a, b),
        (PlanTerm::Other(a), PlanTerm::Other(b)) => same(a, b),
        (PlanTerm::Any | PlanTerm::Var(_) | PlanTerm::Const(_) | PlanTerm::Other(_) | PlanTerm::Part, _) => {
            false
        }
    }
}

/// `X && not X`
fn negated_test(parts: &[&TypedContext]) -> Option<FoundContradiction> {
    let tests: Vec<(&TypedExpr, bool)> = parts.iter().filter_map(|part| tested(part)).collect();
    tests.iter().enumerate().find_map(|(i, (e, holds))| {
        let (other, _) = tests[..i].iter().find(|(other, held)| held != holds && same(e, other))?;
        Some(clash(e.span, other.span))
    })
}

fn clash(span: Span, with: Span) -> FoundContradiction {
    FoundContradiction {
        span,
        why: "these two are never true together".to_owned(),
        with: Some((with, "with this".to_owned())),
    }
}

const LESS: u8 = 1;
const EQUAL: u8 = 2;
const MORE: u8 = 4;

/// A comparison: the orders of its operands for which it holds.
struct VarComparison<'a> {
    left: &'a TypedExpr,
    right: &'a TypedExpr,
    orders: u8,
    span: Span,
}

fn comparison(e: &TypedExpr, holds: bool) -> Option<VarComparison<'_>> {
    let TypedExprKind::Binary(op, left, right) = &e.kind else { return None };
    let orders = match ComparisonOp::of(*op)? {
        ComparisonOp::Lt => LESS,
        ComparisonOp::Le => LESS | EQUAL,
        ComparisonOp::Gt => MORE,
        ComparisonOp::Ge => MORE | EQUAL,
        ComparisonOp::Eq => EQUAL,
        ComparisonOp::Ne => LESS | MORE,
    };
    let orders = if holds { orders } else { !orders & (LESS | EQUAL | MORE) };
    Some(VarComparison { left, right, orders, span: e.span })
}

/// The orders with the operands exchanged.
fn mirrored(orders: u8) -> u8 {
    (orders & EQUAL) | if orders & LESS > 0 { MORE } else { 0 } | if orders & MORE > 0 { LESS } else { 0 }
}

fn comparisons<'a>(parts: &[&'a TypedContext]) -> Vec<VarComparison<'a>> {
    parts.iter().filter_map(|part| tested(part)).filter_map(|(e, holds)| comparison(e, holds)).collect()
}

/// `N < M && N > M`
fn excluded(parts: &[&TypedContext]) -> Option<FoundContradiction> {
    let all = comparisons(parts);
    all.iter().enumerate().find_map(|(i, c)| {
        if same(c.left, c.right) && c.orders & EQUAL == 0 {
            let why = "nothing differs from itself".to_owned();
            return Some(FoundContradiction { span: c.span, why, with: None });
        }
        let other = all[..i].iter().find(|d| {
            (same(c.left, d.left) && same(c.right, d.right) && c.orders & d.orders == 0)
                || (same(c.left, d.right) && same(c.right, d.left) && c.orders & mirrored(d.orders) == 0)
        })?;
        Some(clash(c.span, other.span))
    })
}

/// The values that a variable can have.
#[derive(Clone, Debug)]
struct BoundInterval {
    /// The end, whether it is left out, and what says so.
    lo: (f64, bool, Option<Span>),
    hi: (f64, bool, Option<Span>),
    whole: bool,
    not: Vec<(f64, Span)>,
    /// Its declared range and where it is matched.
    declared: Option<(i64, i64, Span)>,
}

impl Default for BoundInterval {
    fn default() -> Self {
        let (lo, hi) = ((f64::NEG_INFINITY, true, None), (f64::INFINITY, true, None));
        Self { lo, hi, whole: false, not: Vec::new(), declared: None }
    }
}

impl BoundInterval {
    fn declare(&mut self, ty: Type, span: Span) {
        let Type::Int { lo, hi } = ty else { return };
        self.whole = true;
        self.declared.get_or_insert((lo, hi, span));
        self.at_least(lo as f64, false, span);
        self.at_most(hi as f64, false, span);
    }

    fn at_least(&mut self, bound: f64, open: bool, span: Span) {
        if bound > self.lo.0 || (bound == self.lo.0 && open) {
            self.lo = (bound, open, Some(span));
        }
    }

    fn at_most(&mut self, bound: f64, open: bool, span: Span) {
        if bound < self.hi.0 || (bound == self.hi.0 && open) {
            self.hi = (bound, open, Some(span));
        }
    }

    /// The variable has one of these orders to the number.
    fn compare(&mut self, orders: u8, number: f64, span: Span) {
        match orders {
            LESS => self.at_most(number, true, span),
            MORE => self.at_least(number, true, span),
            EQUAL => {
                self.at_least(number, false, span);
                self.at_most(number, false, span);
            }
            _ if orders == LESS | EQUAL => self.at_most(number, false, span),
            _ if orders == MORE | EQUAL => self.at_least(number, false, span),
            _ => self.not.push((number, span)),
        }
    }

    /// What leaves no value, besides `last`.
    fn empty(&self, last: Span) -> Option<FoundContradiction> {
        let (mut lo, mut hi) = (self.lo.0, self.hi.0);
        if self.whole {
            lo = if self.lo.1 { lo.floor() + 1.0 } else { lo.ceil() };
            hi = if self.hi.1 { hi.ceil() - 1.0 } else { hi.floor() };
        }
        let open = !self.whole && (self.lo.1 || self.hi.1);
        let excluded = self.not.iter().find(|(n, _)| lo == hi && *n == lo);
        if lo < hi || (lo == hi && !open && excluded.is_none()) {
            return None;
        }
        let mut others = [self.lo.2, self.hi.2, excluded.map(|e| e.1)].into_iter().flatten();
        let with = others.find(|span| *span != last)?;
        Some(match self.declared {
            Some((lo, hi, at)) if at == with => FoundContradiction {
                span: last,
                why: "this is never true".to_owned(),
                with: Some((at, format!("the value is within {lo}..{hi} here"))),
            },
            Some(_) | None => clash(last, with),
        })
    }
}

/// `N < 1 && N > 3`, or a bound outside the range that the belief declares.
fn out_of_range(
    facts: &AgentFacts<'_>,
    plan: &TypedPlan,
    parts: &[&TypedContext],
) -> Option<FoundContradiction> {
    let mut values: BTreeMap<u16, BoundInterval> = BTreeMap::new();
    let params = |belief: crate::BeliefId| facts.belief(belief).params.as_slice();
    let head = matched(facts.scenario, facts.agent, plan.trigger.on);
    declare(&mut values, &plan.trigger.args, head, plan.trigger.origin);
    for part in parts {
        if let TypedContext::Belief(l) = part {
            declare(&mut values, &l.args, params(l.belief), l.origin);
        }
    }
    for c in comparisons(parts) {
        let sides = [(c.left, c.right, c.orders), (c.right, c.left, mirrored(c.orders))];
        for (var, number, orders) in sides {
            let (TypedExprKind::Leaf(VariableRef::Local(var)), Some(number)) =
                (&var.kind, constant_number(number))
            else {
                continue;
            };
            let interval = values.entry(*var).or_default();
            interval.compare(orders, number, c.span);
            if let Some(found) = interval.empty(c.span) {
                return Some(found);
            }
        }
    }
    None
}

fn constant_number(e: &TypedExpr) -> Option<f64> {
    e.constant().and_then(crate::Value::as_f64)
}

fn declare(values: &mut BTreeMap<u16, BoundInterval>, args: &[TypedTerm], params: &[Parameter], span: Span) {
    for (arg, param) in args.iter().zip(params) {
        if let TypedTerm::Var(var) = arg {
            values.entry(*var).or_default().declare(param.ty, span);
        }
    }
}
