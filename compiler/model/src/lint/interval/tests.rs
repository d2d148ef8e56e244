//! Soundness against enumeration: whatever small values the variables have, the value of an expression lies in its
//! interval, and a condition that holds leaves the values with which it does.

use hrdsl_source::Span;
use proptest::prelude::*;

use super::*;
use crate::Value;

pub(crate) const VARS: usize = 3;

fn expr(kind: TypedExprKind, ty: InferredType) -> TypedExpr {
    TypedExpr { kind, ty, span: Span::default() }
}

pub(crate) fn number() -> impl Strategy<Value = TypedExpr> {
    let leaf = prop_oneof![
        (-5i64..=5).prop_map(|n| expr(TypedExprKind::Const(Value::Int(n)), InferredType::Int)),
        (0..VARS as u16).prop_map(|i| expr(TypedExprKind::Leaf(VariableRef::Own(i)), InferredType::Int)),
        Just(expr(TypedExprKind::Const(Value::Int(i64::MAX)), InferredType::Int)),
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
            (ops, two.clone()).prop_map(|(op, (a, b))| expr(
                TypedExprKind::Binary(op, a.into(), b.into()),
                InferredType::Int
            )),
            inner.clone().prop_map(|a| expr(TypedExprKind::Unary(UnaryOp::Neg, a.into()), InferredType::Int)),
            inner
                .clone()
                .prop_map(|a| expr(TypedExprKind::Call(NumberFunction::Abs, vec![a]), InferredType::Int)),
            two.clone().prop_map(|(a, b)| expr(
                TypedExprKind::Call(NumberFunction::Min, vec![a, b]),
                InferredType::Int
            )),
            two.clone().prop_map(|(a, b)| expr(
                TypedExprKind::Call(NumberFunction::Max, vec![a, b]),
                InferredType::Int
            )),
            (two, inner).prop_map(|((a, b), c)| {
                let condition =
                    expr(TypedExprKind::Binary(BinaryOp::Lt, a.clone().into(), b.into()), InferredType::Bool);
                expr(TypedExprKind::If(condition.into(), a.into(), c.into()), InferredType::Int)
            }),
        ]
    })
}

pub(crate) fn condition() -> impl Strategy<Value = TypedExpr> {
    let compare = prop::sample::select(vec![
        BinaryOp::Lt,
        BinaryOp::Le,
        BinaryOp::Eq,
        BinaryOp::Ne,
        BinaryOp::Gt,
        BinaryOp::Ge,
    ]);
    let leaf = (compare, number(), number())
        .prop_map(|(op, a, b)| expr(TypedExprKind::Binary(op, a.into(), b.into()), InferredType::Bool));
    leaf.prop_recursive(3, 8, 2, |inner| {
        let two = (inner.clone(), inner.clone());
        prop_oneof![
            two.clone().prop_map(|(a, b)| expr(
                TypedExprKind::Binary(BinaryOp::And, a.into(), b.into()),
                InferredType::Bool
            )),
            two.prop_map(|(a, b)| expr(
                TypedExprKind::Binary(BinaryOp::Or, a.into(), b.into()),
                InferredType::Bool
            )),
            inner.prop_map(|a| expr(TypedExprKind::Unary(UnaryOp::Not, a.into()), InferredType::Bool)),
        ]
    })
}

/// The value as at run time; `None`: it has none.
pub(crate) fn run(e: &TypedExpr, own: &[i64]) -> Option<Value> {
    e.value_with(&|leaf| match leaf {
        VariableRef::Own(i) => own.get(usize::from(i)).map(|n| Value::Int(*n)),
        VariableRef::Local(_) | VariableRef::Shared(_) | VariableRef::Signal(_) => None,
    })
}

pub(crate) fn holds(interval: ValueInterval, value: Value) -> bool {
    ValueInterval::value(value).within(interval)
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

fn intervals(ranges: &[(i64, i64)]) -> Vec<ValueInterval> {
    ranges.iter().map(|(lo, hi)| ValueInterval { lo: (*lo).into(), hi: (*hi).into() }).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn a_value_lies_in_its_interval(e in number(), ranges in ranges()) {
        let own = intervals(&ranges);
        let interval = IntervalEnv::new(&own, &[], Vec::new()).eval(&e);
        let mut out = Vec::new();
        each(&ranges, &mut |values| {
            out.extend(run(&e, values).filter(|v| !holds(interval, *v)).map(|v| (values.to_vec(), v)));
        });
        prop_assert!(out.is_empty(), "{interval:?} lacks {out:?}");
    }

    #[test]
    fn a_condition_leaves_what_it_holds_for(e in condition(), ranges in ranges(), want: bool) {
        let own = intervals(&ranges);
        let mut env = IntervalEnv::new(&own, &[], Vec::new());
        let always = env.truth(&e);
        let possible = env.assume(&e, want);
        let mut lost = Vec::new();
        each(&ranges, &mut |values| {
            let Some(truth) = run(&e, values).map(|v| v == Value::Bool(true)) else { return };
            let left = (0u16..).zip(values).all(|(i, n)| holds(env.get(VariableRef::Own(i)), Value::Int(*n)));
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
        let compared = expr(TypedExprKind::Binary(op, a.clone().into(), b.clone().into()), InferredType::Bool);
        let both = expr(TypedExprKind::Binary(BinaryOp::And, compared.into(), and.into()), InferredType::Bool);
        let mut env = IntervalEnv::new(&own, &[], Vec::new());
        let possible = env.assume(&both, true);
        let mut lost = Vec::new();
        each(&ranges, &mut |values| {
            if run(&both, values) != Some(Value::Bool(true)) {
                return;
            }
            let kept = |e: &TypedExpr| run(e, values).is_none_or(|v| holds(env.eval(e), v));
            if !(possible && kept(&a) && kept(&b)) {
                lost.push(values.to_vec());
            }
        });
        prop_assert!(lost.is_empty(), "lost {lost:?}");
    }
}

fn own(i: u16) -> Box<TypedExpr> {
    Box::new(expr(TypedExprKind::Leaf(VariableRef::Own(i)), InferredType::Int))
}

#[test]
fn a_comparison_of_two_variables_narrows_both() {
    let ranges = [ValueInterval { lo: 0, hi: 9 }, ValueInterval { lo: 0, hi: 4 }];
    let less = expr(TypedExprKind::Binary(BinaryOp::Lt, own(0), own(1)), InferredType::Bool);
    let mut env = IntervalEnv::new(&ranges, &[], Vec::new());
    assert!(env.assume(&less, true));
    assert_eq!(env.get(VariableRef::Own(0)), ValueInterval { lo: 0, hi: 3 });
    assert_eq!(env.get(VariableRef::Own(1)), ValueInterval { lo: 1, hi: 4 });
    assert_eq!(env.truth(&less), None);
    let mut env = IntervalEnv::new(&ranges, &[], Vec::new());
    assert!(env.assume(&less, false));
    assert_eq!(env.get(VariableRef::Own(0)), ValueInterval { lo: 0, hi: 9 });
}

#[test]
fn arithmetic_is_exact_at_the_ends() {
    let ranges = [ValueInterval { lo: -3, hi: 5 }, ValueInterval { lo: 2, hi: 3 }];
    let env = IntervalEnv::new(&ranges, &[], Vec::new());
    let of = |op| env.eval(&expr(TypedExprKind::Binary(op, own(0), own(1)), InferredType::Int));
    assert_eq!(of(BinaryOp::Add), ValueInterval { lo: -1, hi: 8 });
    assert_eq!(of(BinaryOp::Sub), ValueInterval { lo: -6, hi: 3 });
    assert_eq!(of(BinaryOp::Mul), ValueInterval { lo: -9, hi: 15 });
    assert_eq!(of(BinaryOp::Div), ValueInterval { lo: -1, hi: 2 });
    assert_eq!(of(BinaryOp::Rem), ValueInterval { lo: -2, hi: 2 });
}
