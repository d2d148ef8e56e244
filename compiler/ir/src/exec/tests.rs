//! Functions of automata: their values are those of the same functions in Rust, and their limits hold.

use proptest::prelude::*;

use super::*;
use crate::{
    Span,
    expr::{ArrayIndex, BinaryOp},
};

fn int(name: &str, lo: i64, hi: i64) -> AutomatonVar {
    AutomatonVar { name: name.into(), lo, hi, init: lo.max(0).min(hi), is_bool: false, enumeration: None }
}

struct TestMemory {
    vars: Vec<AutomatonVar>,
    values: Vec<i64>,
}

impl TestMemory {
    fn new(vars: &[AutomatonVar]) -> Self {
        Self { vars: vars.to_vec(), values: vars.iter().map(|v| v.init).collect() }
    }
}

impl VariableMemory for TestMemory {
    fn read(&self, slot: u16) -> Option<Value> {
        let at = usize::from(slot);
        self.vars.get(at)?.value(self.values[at])
    }

    fn write(&mut self, slot: u16, value: Value) -> Result<(), EvalError> {
        let at = usize::from(slot);
        self.values[at] = fit(self.vars.get(at).ok_or(EvalError::Type)?, slot, value)?;
        Ok(())
    }
}

fn function(
    params: &[AutomatonVar],
    locals: &[AutomatonVar],
    result: Option<AutomatonVar>,
    body: Vec<FunctionStatement>,
) -> AutomatonFunction {
    AutomatonFunction {
        name: "f".into(),
        owner: None,
        params: params.to_vec(),
        locals: locals.to_vec(),
        result,
        pure: false,
        body,
        origin: Span::default(),
    }
}

fn program(shared: Vec<AutomatonVar>, functions: Vec<AutomatonFunction>) -> Program {
    Program { shared, functions, ..Program::default() }
}

fn bin(op: BinaryOp, a: Expr, b: Expr) -> Expr {
    Expr::binary(op, a, b)
}

fn set(slot: u16, value: Expr) -> FunctionStatement {
    FunctionStatement::Assign { place: Lvalue::slot(slot), value }
}

fn at(slot: u16, at: Expr, count: u16) -> Lvalue {
    Lvalue { slot, indices: vec![ArrayIndex { at, count, stride: 1 }] }
}

fn element(slot: u16, index: Expr, count: u16) -> Expr {
    Expr::Element(Box::new(at(slot, index, count)))
}

use BinaryOp::{Add, Gt, Le, Lt, Ne, Rem, Sub};
use Expr::Var as V;

fn wide(name: &str) -> AutomatonVar {
    int(name, -1_000_000_000_000, 1_000_000_000_000)
}

/// `fn gcd(a, b) { var t; while b != 0 { t = a % b; a = b; b = t }; return a }`
fn gcd() -> AutomatonFunction {
    let body = vec![
        FunctionStatement::While {
            condition: bin(Ne, V(1), Expr::int(0)),
            body: vec![set(2, bin(Rem, V(0), V(1))), set(0, V(1)), set(1, V(2))],
        },
        FunctionStatement::Return(Some(V(0))),
    ];
    function(&[wide("a"), wide("b")], &[wide("t")], Some(wide("result")), body)
}

/// Sorts the shared array of eight by exchanges of neighbours.
fn sort() -> AutomatonFunction {
    let (i, j, t) = (8, 9, 10);
    let next = || bin(Add, V(j), Expr::int(1));
    let exchange = vec![
        set(t, element(0, V(j), 8)),
        FunctionStatement::Assign { place: at(0, V(j), 8), value: element(0, next(), 8) },
        FunctionStatement::Assign { place: at(0, next(), 8), value: V(t) },
    ];
    let inner = FunctionStatement::For {
        slot: j,
        lo: Expr::int(0),
        hi: bin(Sub, Expr::int(6), V(i)),
        body: vec![FunctionStatement::If {
            condition: bin(Gt, element(0, V(j), 8), element(0, next(), 8)),
            then: exchange,
            otherwise: vec![],
        }],
    };
    let outer = FunctionStatement::For { slot: i, lo: Expr::int(0), hi: Expr::int(6), body: vec![inner] };
    function(&[], &[int("i", 0, 6), int("j", 0, 6), int("t", -100, 100)], None, vec![outer])
}

fn euclid(mut a: i64, mut b: i64) -> i64 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

proptest! {
    #[test]
    fn the_greatest_common_divisor_is_as_rust_has_it(a in 0i64..1_000_000, b in 0i64..1_000_000) {
        let program = program(vec![], vec![gcd()]);
        let functions = FunctionTable::new(&program);
        let ram = TestMemory::new(&[]);
        let view = MemoryView::new(&functions, &ram, 0, &[]);
        let applied = Expr::Apply(FunctionId(0), vec![Expr::int(a), Expr::int(b)]);
        prop_assert_eq!(view.eval(&applied), Ok(Value::Int(euclid(a, b))));
    }

    #[test]
    fn an_array_is_sorted_as_rust_sorts_it(values in prop::collection::vec(-100i64..=100, 8)) {
        let shared: Vec<AutomatonVar> = (0..8).map(|i| int(&format!("q[{i}]"), -100, 100)).collect();
        let program = program(shared.clone(), vec![sort()]);
        let functions = FunctionTable::new(&program);
        let mut ram = TestMemory::new(&shared);
        ram.values.clone_from(&values);
        MemoryView::open(&functions, &mut ram, 8, &[]).call(FunctionId(0), &[]).unwrap();
        let mut sorted = values;
        sorted.sort_unstable();
        prop_assert_eq!(ram.values, sorted);
    }

    /// Whatever the index, the element or the fault is the one that Rust's slices have.
    #[test]
    fn an_index_is_in_the_array_or_a_fault(index in -3i64..12, column in -1i64..4) {
        let shared: Vec<AutomatonVar> = (0..15).map(|i| AutomatonVar { init: i, ..int("m", 0, 20) }).collect();
        let program = program(shared.clone(), vec![]);
        let functions = FunctionTable::new(&program);
        let ram = TestMemory::new(&shared);
        let binders = [Value::Int(index), Value::Int(column)];
        let place = Lvalue {
            slot: 0,
            indices: vec![
                ArrayIndex { at: V(15), count: 5, stride: 3 },
                ArrayIndex { at: V(16), count: 3, stride: 1 },
            ],
        };
        let got = MemoryView::new(&functions, &ram, 15, &binders).eval(&Expr::Element(Box::new(place)));
        let expected = match (index, column) {
            (0..5, 0..3) => Ok(Value::Int(index * 3 + column)),
            (0..5, _) => Err(EvalError::Index { at: column, count: 3 }),
            _ => Err(EvalError::Index { at: index, count: 5 }),
        };
        prop_assert_eq!(got, expected);
    }
}

fn call(f: AutomatonFunction, shared: &[AutomatonVar]) -> (Result<(), EvalError>, Vec<i64>) {
    let program = program(shared.to_vec(), vec![f]);
    let functions = FunctionTable::new(&program);
    let mut ram = TestMemory::new(shared);
    let done = MemoryView::open(&functions, &mut ram, count(shared.len()), &[]).call(FunctionId(0), &[]);
    (done, ram.values)
}

#[test]
fn a_loop_without_end_is_found() {
    let body = || vec![FunctionStatement::While { condition: Expr::bool(true), body: vec![] }];
    assert_eq!(call(function(&[], &[], None, body()), &[]).0, Err(EvalError::Endless));
}

#[test]
fn the_budget_is_for_statements_and_rounds() {
    // One for the loop itself, two for each round.
    let rounds = |n: i64| {
        let body = vec![FunctionStatement::For {
            slot: 0,
            lo: Expr::int(1),
            hi: Expr::int(n),
            body: vec![set(1, V(0))],
        }];
        call(function(&[], &[wide("i"), wide("x")], None, body), &[]).0
    };
    assert_eq!(rounds(499_999), Ok(()));
    assert_eq!(rounds(500_000), Err(EvalError::Endless));
}

#[test]
fn calls_may_be_a_hundred_deep() {
    // `fn f(n) { if n > 1 { f(n - 1) } }`: the checker rules recursion out, an engine may still meet it.
    let again = FunctionStatement::Call { function: FunctionId(0), args: vec![bin(Sub, V(0), Expr::int(1))] };
    let body = vec![FunctionStatement::If {
        condition: bin(Gt, V(0), Expr::int(1)),
        then: vec![again],
        otherwise: vec![],
    }];
    let program = program(vec![], vec![function(&[int("n", 0, 1000)], &[], None, body)]);
    let functions = FunctionTable::new(&program);
    let deep = |n: i64| {
        let mut ram = TestMemory::new(&[]);
        MemoryView::open(&functions, &mut ram, 0, &[]).call(FunctionId(0), &[Expr::int(n)])
    };
    assert_eq!(deep(100), Ok(()));
    assert_eq!(deep(101), Err(EvalError::Endless));
}

#[test]
fn ranges_are_checked_everywhere() {
    let shared = [int("x", 0, 5)];
    let outside = vec![set(0, Expr::int(6))];
    assert_eq!(
        call(function(&[], &[], None, outside), &shared),
        (Err(EvalError::Outside { slot: 0, value: 6 }), vec![0])
    );
    let local = vec![set(1, Expr::int(-1))];
    assert_eq!(call(function(&[], &[int("l", 0, 3)], None, local), &shared).0, Err(EvalError::Range(-1)));
    let program = program(
        vec![],
        vec![
            gcd(),
            function(&[], &[], Some(int("", 0, 3)), vec![FunctionStatement::Return(Some(Expr::int(4)))]),
        ],
    );
    let functions = FunctionTable::new(&program);
    let ram = TestMemory::new(&[]);
    let view = MemoryView::new(&functions, &ram, 0, &[]);
    let big = Expr::int(i64::MAX);
    assert_eq!(
        view.eval(&Expr::Apply(FunctionId(0), vec![big, Expr::int(1)])),
        Err(EvalError::Range(i64::MAX))
    );
    assert_eq!(view.eval(&Expr::Apply(FunctionId(1), vec![])), Err(EvalError::Range(4)));
}

#[test]
fn locals_start_anew_with_each_call_and_a_return_ends_it() {
    let shared = [int("x", 0, 9)];
    let body = vec![
        set(1, bin(Add, V(1), Expr::int(1))),
        set(0, bin(Add, V(0), V(1))),
        FunctionStatement::While {
            condition: bin(Le, V(0), Expr::int(9)),
            body: vec![FunctionStatement::If {
                condition: bin(Lt, V(0), Expr::int(9)),
                then: vec![FunctionStatement::Return(None)],
                otherwise: vec![set(0, Expr::int(0))],
            }],
        },
    ];
    let program = program(shared.to_vec(), vec![function(&[], &[int("l", 0, 1)], None, body)]);
    let functions = FunctionTable::new(&program);
    let mut ram = TestMemory::new(&shared);
    for expected in [1, 2, 3, 4, 5, 6, 7, 8, 0, 1] {
        MemoryView::open(&functions, &mut ram, 1, &[]).call(FunctionId(0), &[]).unwrap();
        assert_eq!(ram.values, [expected]);
    }
}

#[test]
fn a_shut_view_assigns_nothing() {
    let shared = [int("x", 0, 9)];
    let body = vec![set(0, Expr::int(1)), FunctionStatement::Return(Some(Expr::int(2)))];
    let program = program(shared.to_vec(), vec![function(&[], &[], Some(int("", 0, 9)), body)]);
    let functions = FunctionTable::new(&program);
    let mut ram = TestMemory::new(&shared);
    let applied = Expr::Apply(FunctionId(0), vec![]);
    assert_eq!(MemoryView::new(&functions, &ram, 1, &[]).eval(&applied), Err(EvalError::Type));
    assert_eq!(ram.values, [0]);
    // The lvalue's index comes first: it is still 0 when the function makes it 1.
    let array = [int("x", 0, 9), int("y", 0, 9)];
    let mut two = TestMemory::new(&array);
    MemoryView::open(&functions, &mut two, 2, &[]).assign(&at(0, V(0), 2), &applied).unwrap();
    assert_eq!(two.values, [2, 0]);
    MemoryView::open(&functions, &mut ram, 1, &[Value::Int(3)]).assign(&Lvalue::slot(0), &V(1)).unwrap();
    assert_eq!(ram.values, [3]);
}

#[test]
fn an_owners_variables_come_before_the_parameters() {
    let automaton = crate::ta::Automaton {
        name: "A".into(),
        actor: None,
        clocks: vec![],
        vars: vec![int("own", 0, 9)],
        locations: vec![],
        initial: crate::ta::LocationId(0),
        edges: vec![],
        origin: Span::default(),
    };
    let double = function(
        &[int("n", 0, 9)],
        &[],
        Some(int("", 0, 18)),
        vec![FunctionStatement::Return(Some(bin(Add, V(1), V(1))))],
    );
    let body = vec![set(1, Expr::Apply(FunctionId(0), vec![V(2)]))];
    let own =
        AutomatonFunction { owner: Some(AutomatonId(0)), ..function(&[int("n", 0, 9)], &[], None, body) };
    let mut program = program(vec![int("x", 0, 9)], vec![double, own]);
    program.automata.push(automaton);
    let functions = FunctionTable::new(&program);
    let mut ram = TestMemory::new(&[int("x", 0, 9), int("own", 0, 9)]);
    let view = MemoryView::open(&functions, &mut ram, 2, &[]);
    assert_eq!(view.call(FunctionId(1), &[Expr::int(4)]), Ok(()));
    assert_eq!(view.call(FunctionId(1), &[Expr::int(5)]), Err(EvalError::Outside { slot: 1, value: 10 }));
    assert_eq!(ram.values, [0, 8]);
}
