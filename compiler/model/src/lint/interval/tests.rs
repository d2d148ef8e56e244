//! Soundness against enumeration: whatever small values the variables have, the value of an expression lies in its
//! interval, and a condition that holds leaves the values with which it does.

use hrdsl_source::Span;
use proptest::prelude::*;

use super::*;

pub(crate) const VARS: usize = 3;

fn expr(kind: ExprKind, ty: Kind) -> Expr {
    Expr { kind, ty, span: Span::default() }
}

pub(crate) fn number() -> impl Strategy<Value = Expr> {
    let leaf = prop_oneof![
        (-5i64..=5).prop_map(|n| expr(ExprKind::Const(Value::Int(n)), Kind::Int)),
        (0..VARS as u16).prop_map(|i| expr(ExprKind::Leaf(Leaf::Own(i)), Kind::Int)),
        Just(expr(ExprKind::Const(Value::Int(i64::MAX)), Kind::Int)),
    ];
    leaf.prop_recursive(3, 16, 2, |inner| {
        let ops = prop::sample::select(vec![
            BinaryOp::Add,
            BinaryOp::Sub,
            BinaryOp::Mul,
            BinaryOp::Div,
            BinaryOp::Rem,
        ]);
        let two = (inner.clone(), inner.clone());
        prop_oneof![
            (ops, two.clone())
                .prop_map(|(op, (a, b))| expr(ExprKind::Binary(op, a.into(), b.into()), Kind::Int)),
            inner.clone().prop_map(|a| expr(ExprKind::Unary(UnaryOp::Neg, a.into()), Kind::Int)),
            inner.clone().prop_map(|a| expr(ExprKind::Call(NumberFunction::Abs, vec![a]), Kind::Int)),
            two.clone().prop_map(|(a, b)| expr(ExprKind::Call(NumberFunction::Min, vec![a, b]), Kind::Int)),
            two.clone().prop_map(|(a, b)| expr(ExprKind::Call(NumberFunction::Max, vec![a, b]), Kind::Int)),
            (two, inner).prop_map(|((a, b), c)| {
                let condition = expr(ExprKind::Binary(BinaryOp::Lt, a.clone().into(), b.into()), Kind::Bool);
                expr(ExprKind::If(condition.into(), a.into(), c.into()), Kind::Int)
            }),
        ]
    })
}

pub(crate) fn condition() -> impl Strategy<Value = Expr> {
    let compare = prop::sample::select(vec![
        BinaryOp::Lt,
        BinaryOp::Le,
        BinaryOp::Eq,
        BinaryOp::Ne,
        BinaryOp::Gt,
        BinaryOp::Ge,
    ]);
    let leaf = (compare, number(), number())
        .prop_map(|(op, a, b)| expr(ExprKind::Binary(op, a.into(), b.into()), Kind::Bool));
    leaf.prop_recursive(3, 8, 2, |inner| {
        let two = (inner.clone(), inner.clone());
        prop_oneof![
            two.clone()
                .prop_map(|(a, b)| expr(ExprKind::Binary(BinaryOp::And, a.into(), b.into()), Kind::Bool)),
            two.prop_map(|(a, b)| expr(ExprKind::Binary(BinaryOp::Or, a.into(), b.into()), Kind::Bool)),
            inner.prop_map(|a| expr(ExprKind::Unary(UnaryOp::Not, a.into()), Kind::Bool)),
        ]
    })
}

/// The value as at run time; `None`: it has none.
pub(crate) fn run(e: &Expr, own: &[i64]) -> Option<Value> {
    let truth = |e: &Expr| run(e, own).map(|v| v == Value::Bool(true));
    match &e.kind {
        ExprKind::Const(v) => Some(*v),
        ExprKind::Leaf(Leaf::Own(i)) => Some(Value::Int(own[usize::from(*i)])),
        ExprKind::Leaf(_)
        | ExprKind::Term(_)
        | ExprKind::List(..)
        | ExprKind::Element(_)
        | ExprKind::Apply(..)
        | ExprKind::Error => None,
        ExprKind::Unary(op, a) => hrdsl_ir::expr::unary(*op, run(a, own)?).ok(),
        ExprKind::Binary(BinaryOp::And, a, b) => Some(Value::Bool(truth(a)? && truth(b)?)),
        ExprKind::Binary(BinaryOp::Or, a, b) => Some(Value::Bool(truth(a)? || truth(b)?)),
        ExprKind::Binary(op, a, b) => hrdsl_ir::expr::binary(*op, run(a, own)?, run(b, own)?).ok(),
        ExprKind::If(c, a, b) => run(if truth(c)? { a } else { b }, own),
        ExprKind::Call(f, args) => {
            let args: Option<Vec<Value>> = args.iter().map(|a| run(a, own)).collect();
            hrdsl_ir::expr::call(*f, &args?).ok()
        }
    }
}

pub(crate) fn holds(interval: Interval, value: Value) -> bool {
    Interval::value(value).within(interval)
}

/// All values of the variables within their ranges.
fn each(ranges: &[(i64, i64)], f: &mut dyn FnMut(&[i64])) {
    for a in ranges[0].0..=ranges[0].1 {
        for b in ranges[1].0..=ranges[1].1 {
            for c in ranges[2].0..=ranges[2].1 {
                f(&[a, b, c]);
            }
        }
    }
}

fn ranges() -> impl Strategy<Value = Vec<(i64, i64)>> {
    prop::collection::vec((-4i64..=4, 0i64..=4).prop_map(|(lo, n)| (lo, lo + n)), VARS)
}

fn intervals(ranges: &[(i64, i64)]) -> Vec<Interval> {
    ranges.iter().map(|(lo, hi)| Interval { lo: (*lo).into(), hi: (*hi).into() }).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn a_value_lies_in_its_interval(e in number(), ranges in ranges()) {
        let own = intervals(&ranges);
        let interval = Env::new(&own, &[], Vec::new()).eval(&e);
        let mut out = Vec::new();
        each(&ranges, &mut |values| {
            out.extend(run(&e, values).filter(|v| !holds(interval, *v)).map(|v| (values.to_vec(), v)));
        });
        prop_assert!(out.is_empty(), "{interval:?} lacks {out:?}");
    }

    #[test]
    fn a_condition_leaves_what_it_holds_for(e in condition(), ranges in ranges(), want: bool) {
        let own = intervals(&ranges);
        let mut env = Env::new(&own, &[], Vec::new());
        let always = env.truth(&e);
        let possible = env.assume(&e, want);
        let mut lost = Vec::new();
        each(&ranges, &mut |values| {
            let Some(truth) = run(&e, values).map(|v| v == Value::Bool(true)) else { return };
            let left = (0u16..).zip(values).all(|(i, n)| holds(env.get(Leaf::Own(i)), Value::Int(*n)));
            if always.is_some_and(|a| a != truth) || truth == want && !(possible && left) {
                lost.push(values.to_vec());
            }
        });
        prop_assert!(lost.is_empty(), "lost {lost:?}");
    }

    #[test]
    fn a_comparison_leaves_the_values_of_its_sides(
        a in number(), b in number(), less: bool, and in condition(), ranges in ranges(),
    ) {
        let own = intervals(&ranges);
        let op = if less { BinaryOp::Lt } else { BinaryOp::Eq };
        let compared = expr(ExprKind::Binary(op, a.clone().into(), b.clone().into()), Kind::Bool);
        let both = expr(ExprKind::Binary(BinaryOp::And, compared.into(), and.into()), Kind::Bool);
        let mut env = Env::new(&own, &[], Vec::new());
        let possible = env.assume(&both, true);
        let mut lost = Vec::new();
        each(&ranges, &mut |values| {
            if run(&both, values) != Some(Value::Bool(true)) {
                return;
            }
            let kept = |e: &Expr| run(e, values).is_none_or(|v| holds(env.eval(e), v));
            if !(possible && kept(&a) && kept(&b)) {
                lost.push(values.to_vec());
            }
        });
        prop_assert!(lost.is_empty(), "lost {lost:?}");
    }
}

fn own(i: u16) -> Box<Expr> {
    Box::new(expr(ExprKind::Leaf(Leaf::Own(i)), Kind::Int))
}

#[test]
fn a_comparison_of_two_variables_narrows_both() {
    let ranges = [Interval { lo: 0, hi: 9 }, Interval { lo: 0, hi: 4 }];
    let less = expr(ExprKind::Binary(BinaryOp::Lt, own(0), own(1)), Kind::Bool);
    let mut env = Env::new(&ranges, &[], Vec::new());
    assert!(env.assume(&less, true));
    assert_eq!(env.get(Leaf::Own(0)), Interval { lo: 0, hi: 3 });
    assert_eq!(env.get(Leaf::Own(1)), Interval { lo: 1, hi: 4 });
    assert_eq!(env.truth(&less), None);
    let mut env = Env::new(&ranges, &[], Vec::new());
    assert!(env.assume(&less, false));
    assert_eq!(env.get(Leaf::Own(0)), Interval { lo: 0, hi: 9 });
}

#[test]
fn arithmetic_is_exact_at_the_ends() {
    let ranges = [Interval { lo: -3, hi: 5 }, Interval { lo: 2, hi: 3 }];
    let env = Env::new(&ranges, &[], Vec::new());
    let of = |op| env.eval(&expr(ExprKind::Binary(op, own(0), own(1)), Kind::Int));
    assert_eq!(of(BinaryOp::Add), Interval { lo: -1, hi: 8 });
    assert_eq!(of(BinaryOp::Sub), Interval { lo: -6, hi: 3 });
    assert_eq!(of(BinaryOp::Mul), Interval { lo: -9, hi: 15 });
    assert_eq!(of(BinaryOp::Div), Interval { lo: -1, hi: 2 });
    assert_eq!(of(BinaryOp::Rem), Interval { lo: -2, hi: 2 });
}
