//! Matching of terms against values: variables are bound if they are open, compared if not.

use hrdsl_ir::{Expr, Value, bdi::Term, expr::EvalError};

use crate::belief::Rows;

/// A variable of a plan: its value, once bound.
pub(crate) type Slot = Option<Value>;

/// The variables bound since a choice, so that backtracking can open them again.
pub(crate) type Trail = Vec<u16>;

/// Whether two values match: bit for bit; an integer matches the float that equals it, as `==` has it.
pub(crate) fn same(a: Value, b: Value) -> bool {
    match (a, b) {
        (Value::Int(n), Value::Float(x)) | (Value::Float(x), Value::Int(n)) => n as f64 == x,
        (Value::Symbol(a), Value::Symbol(b)) => a == b,
        (Value::Bool(_) | Value::Int(_) | Value::Float(_) | Value::Symbol(_), _) => a.key() == b.key(),
    }
}

/// The expression's value in these variables.
pub(crate) fn eval(expr: &Expr, slots: &[Slot]) -> Result<Value, EvalError> {
    let var = |i: u16| slots.get(i as usize).copied().flatten();
    match expr {
        Expr::Const(value) => Ok(*value),
        Expr::Var(i) => var(*i).ok_or(EvalError::Unbound(*i)),
        Expr::Unary(..) | Expr::Binary(..) | Expr::If(..) | Expr::Call(..) => expr.eval(&var),
    }
}

/// Opens all variables bound since the trail was this long.
pub(crate) fn undo(slots: &mut [Slot], trail: &mut Trail, mark: usize) {
    for var in trail.drain(mark..) {
        slots[var as usize] = None;
    }
}

/// Matches one term; what it binds is on the trail.
pub(crate) fn unify(
    term: &Term,
    value: Value,
    slots: &mut [Slot],
    trail: &mut Trail,
) -> Result<bool, EvalError> {
    match term {
        Term::Any => Ok(true),
        Term::Var(var) => match slots[*var as usize] {
            Some(bound) => Ok(same(bound, value)),
            None => {
                slots[*var as usize] = Some(value);
                trail.push(*var);
                Ok(true)
            }
        },
        Term::Expr(expr) => Ok(same(eval(expr, slots)?, value)),
    }
}

/// Matches terms with as many values, from the left; an open value matches anything and binds nothing. Without a match
/// nothing is bound.
pub(crate) fn unify_all(
    terms: &[Term],
    values: impl ExactSizeIterator<Item = Option<Value>>,
    slots: &mut [Slot],
    trail: &mut Trail,
) -> Result<bool, EvalError> {
    if terms.len() != values.len() {
        return Ok(false);
    }
    let mark = trail.len();
    for (term, value) in terms.iter().zip(values) {
        let Some(value) = value else { continue };
        let matches = unify(term, value, slots, trail);
        if matches != Ok(true) {
            undo(slots, trail, mark);
            return matches;
        }
    }
    Ok(true)
}

/// Refuses a literal that computes with a variable which is neither bound nor bound by an earlier term of the literal:
/// such a fault must not depend on whether the belief base happens to reach it.
pub(crate) fn well_bound(terms: &[Term], slots: &[Slot]) -> Result<(), EvalError> {
    for (at, term) in terms.iter().enumerate() {
        let Term::Expr(expr) = term else { continue };
        let mut fault = None;
        expr.each_var(&mut |var| {
            let bound = slots.get(var as usize).is_some_and(Option::is_some);
            if !bound && !terms[..at].contains(&Term::Var(var)) {
                fault = fault.or(Some(var));
            }
        });
        if let Some(var) = fault {
            return Err(EvalError::Unbound(var));
        }
    }
    Ok(())
}

/// The first row, from the oldest, that the terms match; its bindings stay.
pub(crate) fn first_match(
    rows: &Rows,
    terms: &[Term],
    slots: &mut [Slot],
    trail: &mut Trail,
) -> Result<Option<usize>, EvalError> {
    well_bound(terms, slots)?;
    for (index, row) in rows.iter().enumerate() {
        if unify_all(terms, row.iter().map(|v| Some(*v)), slots, trail)? {
            return Ok(Some(index));
        }
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::{Symbol, expr::BinaryOp};
    use proptest::prelude::*;

    use super::*;

    fn value() -> impl Strategy<Value = Value> {
        prop_oneof![
            any::<bool>().prop_map(Value::Bool),
            (-2i64..3).prop_map(Value::Int),
            (-2i8..3).prop_map(|n| Value::Float(f64::from(n) / 2.0)),
            prop::sample::select(vec!["slow", "fast"]).prop_map(|s| Value::Symbol(Symbol::intern(s))),
        ]
    }

    fn term() -> impl Strategy<Value = Term> {
        prop_oneof![
            Just(Term::Any),
            (0u16..3).prop_map(Term::Var),
            value().prop_map(|v| Term::Expr(Expr::Const(v))),
        ]
    }

    /// What a term stands for once its variables are bound.
    fn instance(term: &Term, slots: &[Slot]) -> Option<Value> {
        match term {
            Term::Any => None,
            Term::Var(v) => slots[*v as usize],
            Term::Expr(e) => eval(e, slots).ok(),
        }
    }

    proptest! {
        #[test]
        fn matching_is_an_equivalence_on_small_values(a in value(), b in value(), c in value()) {
            prop_assert!(same(a, a));
            prop_assert_eq!(same(a, b), same(b, a));
            prop_assert!(!(same(a, b) && same(b, c)) || same(a, c));
        }

        #[test]
        fn a_match_makes_the_terms_equal_to_the_values(
            pairs in prop::collection::vec((term(), value()), 0..5),
            start in prop::collection::vec(prop::option::of(value()), 3),
        ) {
            let (terms, values): (Vec<Term>, Vec<Value>) = pairs.into_iter().unzip();
            let (mut slots, mut trail) = (start.clone(), Trail::new());
            let found = unify_all(&terms, values.iter().map(|v| Some(*v)), &mut slots, &mut trail).unwrap();
            if found {
                for (term, value) in terms.iter().zip(&values) {
                    prop_assert!(instance(term, &slots).is_none_or(|i| same(i, *value)));
                }
                for (before, after) in start.iter().zip(&slots) {
                    prop_assert!(before.is_none() || before == after, "a bound variable changed");
                }
            } else {
                prop_assert_eq!(&slots, &start);
                prop_assert!(trail.is_empty());
            }
        }

        /// Completeness: whatever assignment makes the terms equal to the values, matching finds one, and where a
        /// variable occurs, the same one.
        #[test]
        fn a_match_is_found_if_there_is_one(
            terms in prop::collection::vec(term(), 0..5),
            assignment in prop::collection::vec(value(), 3),
            known in prop::collection::vec(any::<bool>(), 3),
        ) {
            let full: Vec<Slot> = assignment.iter().map(|v| Some(*v)).collect();
            let values: Vec<Value> =
                terms.iter().map(|t| instance(t, &full).unwrap_or(Value::Bool(true))).collect();
            let mut slots: Vec<Slot> =
                full.iter().zip(&known).map(|(v, k)| if *k { *v } else { None }).collect();
            let mut trail = Trail::new();
            prop_assert!(
                unify_all(&terms, values.iter().map(|v| Some(*v)), &mut slots, &mut trail).unwrap()
            );
            for (slot, v) in slots.iter().zip(&assignment) {
                prop_assert!(slot.is_none_or(|s| same(s, *v)));
            }
        }

        #[test]
        fn undoing_opens_exactly_what_was_bound(
            pairs in prop::collection::vec((term(), value()), 0..5),
            start in prop::collection::vec(prop::option::of(value()), 3),
        ) {
            let (mut slots, mut trail) = (start.clone(), Trail::new());
            for (term, value) in &pairs {
                unify(term, *value, &mut slots, &mut trail).unwrap();
            }
            undo(&mut slots, &mut trail, 0);
            prop_assert_eq!(slots, start);
        }
    }

    #[test]
    fn an_earlier_term_may_bind_what_a_later_one_computes_with() {
        let next = Term::Expr(Expr::binary(BinaryOp::Add, Expr::Var(0), Expr::int(1)));
        let row = |a, b| [Some(Value::Int(a)), Some(Value::Int(b))].into_iter();
        let terms = [Term::Var(0), next.clone()];
        assert_eq!(well_bound(&terms, &[None]), Ok(()));
        assert_eq!(unify_all(&terms, row(3, 4), &mut [None], &mut Trail::new()), Ok(true));
        assert_eq!(unify_all(&terms, row(3, 5), &mut [None], &mut Trail::new()), Ok(false));
        assert_eq!(well_bound(&[next, Term::Var(0)], &[None]), Err(EvalError::Unbound(0)));
    }
}
