//! Matching of terms against values: variables are bound if they are open, compared if not.

use hrdsl_ir::{
    Expr, List, Value,
    bdi::AgentTerm,
    expr::{BinaryOp, EvalError, binary, on_ints},
    list::same,
};

/// A variable: its value, once bound.
pub(crate) type VariableSlot = Option<Value>;

/// The variables bound since a choice, by their place on the stack of slots, so that backtracking can open them again.
pub(crate) type BindingTrail = Vec<u32>;

/// The expression's value in these variables.
pub(crate) fn eval(expr: &Expr, slots: &[VariableSlot]) -> Result<Value, EvalError> {
    match expr {
        Expr::Const(value) => Ok(*value),
        Expr::Var(i) => slots.get(usize::from(*i)).copied().flatten().ok_or(EvalError::Unbound(*i)),
        Expr::Binary(op, a, b) => operate(*op, a, b, slots),
        Expr::Unary(..)
        | Expr::If(..)
        | Expr::Call(..)
        | Expr::List(..)
        | Expr::Element(_)
        | Expr::Apply(..) => expr.eval(&|i| slots.get(usize::from(i)).copied().flatten()),
    }
}

/// The whole number that a constant or a variable is.
#[inline]
fn whole(expr: &Expr, slots: &[VariableSlot]) -> Option<i64> {
    if let Expr::Const(Value::Int(n)) = expr {
        Some(*n)
    } else if let Expr::Var(i) = expr
        && let Some(Some(Value::Int(n))) = slots.get(usize::from(*i))
    {
        Some(*n)
    } else {
        None
    }
}

/// Operations on whole numbers are done at once: this is where most of an agent's time goes.
fn operate(op: BinaryOp, a: &Expr, b: &Expr, slots: &[VariableSlot]) -> Result<Value, EvalError> {
    if let (Some(a), Some(b)) = (whole(a, slots), whole(b, slots)) {
        return on_ints(op, a, b);
    }
    if matches!(op, BinaryOp::And | BinaryOp::Or) {
        let left = eval(a, slots)?.as_bool().ok_or(EvalError::Type)?;
        if left == (op == BinaryOp::Or) { Ok(Value::Bool(left)) } else { eval(b, slots) }
    } else {
        binary(op, eval(a, slots)?, eval(b, slots)?)
    }
}

/// Opens all variables bound since the trail was this long.
pub(crate) fn undo(slots: &mut [VariableSlot], trail: &mut BindingTrail, mark: usize) {
    for var in trail.drain(mark..) {
        slots[var as usize] = None;
    }
}

/// Matches one term, whose variables start at `base` on the stack; what it binds is on the trail.
pub(crate) fn unify(
    term: &AgentTerm,
    value: Value,
    base: usize,
    slots: &mut [VariableSlot],
    trail: &mut BindingTrail,
) -> Result<bool, EvalError> {
    match term {
        AgentTerm::Any => Ok(true),
        AgentTerm::Var(var) => {
            let at = base + usize::from(*var);
            match slots[at] {
                Some(bound) => Ok(same(bound, value)),
                None => {
                    slots[at] = Some(value);
                    trail.push(at as u32);
                    Ok(true)
                }
            }
        }
        AgentTerm::Expr(expr) => Ok(same(eval(expr, &slots[base..])?, value)),
        AgentTerm::List(items, rest) => {
            let Value::List(mut list) = value else { return Ok(false) };
            for item in items {
                let Some((head, tail)) = list.split() else { return Ok(false) };
                if !unify(item, head, base, slots, trail)? {
                    return Ok(false);
                }
                list = tail;
            }
            match rest {
                Some(rest) => unify(rest, Value::List(list), base, slots, trail),
                None => Ok(list.is_empty()),
            }
        }
    }
}

/// Matches terms with as many values, from the left; an open value matches anything and binds nothing. Without a match
/// nothing is bound.
pub(crate) fn unify_all(
    terms: &[AgentTerm],
    values: impl ExactSizeIterator<Item = VariableSlot>,
    base: usize,
    slots: &mut [VariableSlot],
    trail: &mut BindingTrail,
) -> Result<bool, EvalError> {
    if terms.len() != values.len() {
        return Ok(false);
    }
    let mark = trail.len();
    for (term, value) in terms.iter().zip(values) {
        let Some(value) = value else { continue };
        let matches = unify(term, value, base, slots, trail);
        if matches != Ok(true) {
            undo(slots, trail, mark);
            return matches;
        }
    }
    Ok(true)
}

/// The value of a term, if all its variables have one: `None` for `_` and what is open.
pub(crate) fn known(term: &AgentTerm, slots: &[VariableSlot]) -> VariableSlot {
    match term {
        AgentTerm::Any => None,
        AgentTerm::Var(var) => slots[usize::from(*var)],
        AgentTerm::Expr(expr) => eval(expr, slots).ok(),
        AgentTerm::List(items, rest) => {
            let items: Option<Vec<Value>> = items.iter().map(|i| known(i, slots)).collect();
            let rest = match rest {
                None => List::EMPTY,
                Some(rest) => known(rest, slots)?.as_list()?,
            };
            Some(Value::List(items?.into_iter().rev().fold(rest, |rest, head| List::cons(head, rest))))
        }
    }
}

/// The value of an argument of a goal that is waited for; `None` for a variable that is open, to which the goal gives one.
#[inline]
pub(crate) fn wanted(expr: &Expr, slots: &[VariableSlot]) -> Result<VariableSlot, EvalError> {
    if let Expr::Var(var) = expr {
        return Ok(slots.get(usize::from(*var)).copied().flatten());
    }
    eval(expr, slots).map(Some)
}

/// Refuses a literal that computes with a variable which is neither bound nor bound by an earlier term of the literal:
/// such a fault must not depend on whether the belief base happens to reach it.
pub(crate) fn well_bound(terms: &[AgentTerm], slots: &[VariableSlot]) -> Result<(), EvalError> {
    for (at, term) in terms.iter().enumerate() {
        let AgentTerm::Expr(expr) = term else { continue };
        let mut fault = None;
        expr.each_var(&mut |var| {
            let bound = slots.get(var as usize).is_some_and(Option::is_some);
            if !bound && !terms[..at].iter().any(|t| binds(t, var)) {
                fault = fault.or(Some(var));
            }
        });
        if let Some(var) = fault {
            return Err(EvalError::Unbound(var));
        }
    }
    Ok(())
}

/// Whether matching the term gives the variable a value.
fn binds(term: &AgentTerm, var: u16) -> bool {
    match term {
        AgentTerm::Var(v) => *v == var,
        AgentTerm::List(items, rest) => {
            items.iter().any(|t| binds(t, var)) || rest.as_ref().is_some_and(|t| binds(t, var))
        }
        AgentTerm::Any | AgentTerm::Expr(_) => false,
    }
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::{Symbol, Text};
    use proptest::prelude::*;

    use super::*;

    fn value() -> impl Strategy<Value = Value> {
        let scalar = prop_oneof![
            any::<bool>().prop_map(Value::Bool),
            (-2i64..3).prop_map(Value::Int),
            (-2i8..3).prop_map(|n| Value::Float(f64::from(n) / 2.0)),
            prop::sample::select(vec!["slow", "fast"]).prop_map(|s| Value::Symbol(Symbol::intern(s))),
            prop::sample::select(vec!["a", "b"]).prop_map(|s| Value::Text(Text::new(s))),
        ];
        scalar.prop_recursive(2, 8, 3, |inner| {
            prop::collection::vec(inner, 0..3).prop_map(|v| Value::List(List::of(&v)))
        })
    }

    fn term() -> impl Strategy<Value = AgentTerm> {
        let leaf = prop_oneof![
            Just(AgentTerm::Any),
            (0u16..3).prop_map(AgentTerm::Var),
            value().prop_map(|v| AgentTerm::Expr(Expr::Const(v))),
        ];
        leaf.prop_recursive(2, 6, 3, |inner| {
            (prop::collection::vec(inner.clone(), 0..3), prop::option::of(inner))
                .prop_map(|(items, rest)| AgentTerm::List(items, rest.map(Box::new)))
        })
    }

    /// The meaning of a match, without a trail: a substitution is extended or there is none.
    fn matches(term: &AgentTerm, value: Value, mut theta: Vec<VariableSlot>) -> Option<Vec<VariableSlot>> {
        match term {
            AgentTerm::Any => Some(theta),
            AgentTerm::Var(v) => match theta[usize::from(*v)] {
                Some(known) => same(known, value).then_some(theta),
                None => {
                    theta[usize::from(*v)] = Some(value);
                    Some(theta)
                }
            },
            AgentTerm::Expr(e) => same(e.eval(&|_| None).ok()?, value).then_some(theta),
            AgentTerm::List(items, rest) => {
                let all: Vec<Value> = value.as_list()?.iter().collect();
                if all.len() < items.len() || (rest.is_none() && all.len() > items.len()) {
                    return None;
                }
                let (first, others) = all.split_at(items.len());
                let theta = items.iter().zip(first).try_fold(theta, |theta, (t, v)| matches(t, *v, theta))?;
                match rest {
                    Some(rest) => matches(rest, Value::List(List::of(others)), theta),
                    None => Some(theta),
                }
            }
        }
    }

    proptest! {
        #[test]
        fn a_match_extends_the_substitution_and_a_mismatch_leaves_nothing(
            terms in prop::collection::vec(term(), 0..4),
            values in prop::collection::vec(value(), 4),
            bound in prop::collection::vec(prop::option::of(value()), 3),
        ) {
            let expected = terms.iter().zip(&values).try_fold(bound.clone(), |theta, (t, v)| matches(t, *v, theta));
            let (mut slots, mut trail) = (bound.clone(), BindingTrail::new());
            let n = terms.len();
            let given = values[..n].iter().map(|v| Some(*v));
            let found = unify_all(&terms, given, 0, &mut slots, &mut trail).unwrap();
            prop_assert_eq!(found, expected.is_some());
            prop_assert_eq!(&slots, &expected.unwrap_or(bound.clone()));
            undo(&mut slots, &mut trail, 0);
            prop_assert_eq!(slots, bound);
        }

        #[test]
        fn what_is_known_matches_itself(t in term(), bound in prop::collection::vec(value(), 3)) {
            let mut slots: Vec<VariableSlot> = bound.into_iter().map(Some).collect();
            if let Some(v) = known(&t, &slots) {
                prop_assert!(unify(&t, v, 0, &mut slots, &mut BindingTrail::new()).unwrap());
            }
        }

        #[test]
        fn matching_is_symmetric(a in value(), b in value()) {
            prop_assert_eq!(same(a, b), same(b, a));
            prop_assert!(same(a, a));
        }
    }
}
