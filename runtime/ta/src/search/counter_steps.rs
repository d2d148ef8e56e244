//! How expressions use a counter: sums that it has a part in, steps that are added to it, and what a guard says of it.

use crate::network::{
    code::{ArithmeticOp, CompiledExpr, CompiledLvalue, VariablePlace},
    number::NumberComparison,
};

/// A place that no index chooses.
pub(super) fn single(place: &CompiledLvalue) -> Option<u32> {
    match place.base {
        VariablePlace::State(i) if place.indices.is_empty() => Some(i),
        VariablePlace::State(_) | VariablePlace::Local(_) => None,
    }
}

/// By how much an assignment changes what it sets: `n = n + k`.
pub(super) fn step(counter: u32, value: &CompiledExpr) -> Option<i64> {
    let sum = sum(value)?;
    (sum.plus == [counter] && sum.minus.is_empty()).then_some(sum.constant?)
}

/// A sum of variables and constants.
#[derive(Default)]
pub(super) struct VariableSum {
    pub plus: Vec<u32>,
    pub minus: Vec<u32>,
    /// `None`: something else that is the same in all states that differ in counters alone.
    constant: Option<i64>,
}

pub(super) fn sum(code: &CompiledExpr) -> Option<VariableSum> {
    match code {
        CompiledExpr::Const(n) => Some(VariableSum { constant: Some(*n), ..VariableSum::default() }),
        CompiledExpr::Local(_) => Some(VariableSum::default()),
        CompiledExpr::Var(i) => Some(VariableSum { plus: vec![*i], minus: Vec::new(), constant: Some(0) }),
        CompiledExpr::Neg(a) => {
            let a = sum(a)?;
            Some(VariableSum {
                plus: a.minus,
                minus: a.plus,
                constant: a.constant.and_then(i64::checked_neg),
            })
        }
        CompiledExpr::Arith(op @ (ArithmeticOp::Add | ArithmeticOp::Sub), ab) => {
            let (mut a, mut b) = (sum(&ab.0)?, sum(&ab.1)?);
            let adds = *op == ArithmeticOp::Add;
            if !adds {
                std::mem::swap(&mut b.plus, &mut b.minus);
            }
            a.plus.append(&mut b.plus);
            a.minus.append(&mut b.minus);
            let both = a.constant.zip(b.constant);
            a.constant = both.and_then(|(x, y)| if adds { x.checked_add(y) } else { x.checked_sub(y) });
            Some(a)
        }
        CompiledExpr::Arith(..)
        | CompiledExpr::VarConst(..)
        | CompiledExpr::VarVar(..)
        | CompiledExpr::Compare(..)
        | CompiledExpr::Not(_)
        | CompiledExpr::Abs(_)
        | CompiledExpr::And(_)
        | CompiledExpr::Or(_)
        | CompiledExpr::If(_)
        | CompiledExpr::Element(_)
        | CompiledExpr::Apply(..)
        | CompiledExpr::Convert(..)
        | CompiledExpr::Generic(_) => None,
    }
}

/// What a guard that holds says of a variable by itself.
pub(super) fn narrow(guard: &CompiledExpr, of: u32, lo: &mut i64, hi: &mut i64) {
    if let CompiledExpr::And(ab) = guard {
        narrow(&ab.0, of, lo, hi);
        narrow(&ab.1, of, lo, hi);
    } else if let CompiledExpr::VarConst(op, i, n) = guard
        && *i == of
    {
        match op {
            NumberComparison::Lt => *hi = (*hi).min(n.saturating_sub(1)),
            NumberComparison::Le => *hi = (*hi).min(*n),
            NumberComparison::Gt => *lo = (*lo).max(n.saturating_add(1)),
            NumberComparison::Ge => *lo = (*lo).max(*n),
            NumberComparison::Eq => (*lo, *hi) = ((*lo).max(*n), (*hi).min(*n)),
            NumberComparison::Ne => {}
        }
    }
}
