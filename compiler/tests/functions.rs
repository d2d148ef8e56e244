//! Functions of automata from the text to what they do: compiled, lowered and executed by the interpreter of the program form.

use hrdsl_compiler::{InputFile, compile};
use hrdsl_ir::{
    Expr, Program, Value,
    exec::{FunctionTable, MemoryView, VariableMemory, fit},
    expr::{ArrayIndex, EvalError, Lvalue},
    ta::{AutomatonId, AutomatonVar, EdgeAssignment, FunctionId, FunctionStatement},
};
use proptest::prelude::*;

const TEXT: &str = "\
scenario functions
actor robot : system
enum Mode { idle, busy, done }
record Slot { used: bool, who: 0..9 }
const N = 5
var q: (0..9)[N]
var len: 0..N
var mode: Mode = busy
var slots: Slot[3]
var grid: (0..99)[2][3]
fn front() -> 0..9 { return q[0] }
fn push(e: 0..9) { q[len] = e; len += 1 }
fn pop() -> 0..9 {
  var first: 0..9 = q[0];
  for i in 0..N - 2 { q[i] = q[i + 1] }
  q[N - 1] = 0; len -= 1;
  return first
}
fn sort() {
  for i in 0..N - 2 { for j in 0..N - 2 - i {
    if q[j] > q[j + 1] { var t: 0..9 = q[j]; q[j] = q[j + 1]; q[j + 1] = t }
  } }
}
fn has(e: 0..9) -> bool { for i in 0..N - 1 { if q[i] == e { return true } } return false }
fn next(m: Mode) -> Mode { if m == idle { return busy } else if m == busy { return done } return idle }
fn turn() { mode = next(mode) }
fn keep(i: 0..2, e: 0..9) { slots[i] = (has(e), e); slots[i].who += 0 }
fn table() { for i in 0..1 { for j in 0..2 { grid[i][j] = 10 * i + j } } }
fn fresh() -> 0..9 {
  var sum: 0..9;
  for i in 0..2 { var once: 0..9; var many: (0..9)[2]; once += 1; many[i % 2] += 2; sum += once + many[i % 2] }
  return sum
}
automaton Robot plays robot {
  var mine: (0..9)[2]
  init location a
  fn own(i: 0..1) -> 0..9 { return max(mine[i], front()) }
  fn take(i: 0..1) { mine[i] = pop() }
  a -> a select i: 0..1, k: 0..2 when own(i) > q[k] do take(i); grid[i][k] = own(i); q[mine[i]] = pop()
}
automaton Twin(n: 0..9) plays robot {
  var left: 0..9
  init location a
  fn grow(by_: 0..9) { left += by_ + n }
  a -> a do grow(1)
}
automaton One = Twin(1)
automaton Two = Twin(2)
";

fn program() -> Program {
    let c = compile(InputFile { name: "functions.hri", text: TEXT }, &[]);
    let errors: Vec<_> = c.diagnostics.iter().filter(|d| d.is_error()).collect();
    assert!(errors.is_empty(), "{errors:#?}");
    c.program.unwrap()
}

/// The shared variables, then those of one automaton.
struct Ram {
    vars: Vec<AutomatonVar>,
    values: Vec<i64>,
}

impl Ram {
    fn of(p: &Program, automaton: usize) -> Self {
        let vars: Vec<AutomatonVar> = p.shared.iter().chain(&p.automata[automaton].vars).cloned().collect();
        let values = vars.iter().map(|v| v.init).collect();
        Self { vars, values }
    }
}

impl VariableMemory for Ram {
    fn read(&self, slot: u16) -> Option<Value> {
        self.vars.get(usize::from(slot))?.value(self.values[usize::from(slot)])
    }

    fn write(&mut self, slot: u16, value: Value) -> Result<(), EvalError> {
        let at = usize::from(slot);
        self.values[at] = fit(self.vars.get(at).ok_or(EvalError::Type)?, slot, value)?;
        Ok(())
    }
}

fn id(p: &Program, name: &str) -> FunctionId {
    FunctionId(u16::try_from(p.functions.iter().position(|f| f.name == name).unwrap()).unwrap())
}

fn ints(args: &[i64]) -> Vec<Expr> {
    args.iter().map(|n| Expr::int(*n)).collect()
}

fn call(p: &Program, ram: &mut Ram, name: &str, args: &[i64]) -> Result<(), EvalError> {
    let (functions, base) = (FunctionTable::new(p), u16::try_from(ram.vars.len()).unwrap());
    MemoryView::open(&functions, ram, base, &[]).call(id(p, name), &ints(args))
}

fn value(p: &Program, ram: &mut Ram, name: &str, args: &[i64]) -> Result<Value, EvalError> {
    let (functions, base) = (FunctionTable::new(p), u16::try_from(ram.vars.len()).unwrap());
    MemoryView::open(&functions, ram, base, &[]).eval(&Expr::Apply(id(p, name), ints(args)))
}

#[test]
fn a_queue_is_a_queue() {
    let p = program();
    let mut ram = Ram::of(&p, 0);
    for n in [7, 3, 9, 3, 1] {
        call(&p, &mut ram, "push", &[n]).unwrap();
    }
    assert_eq!(ram.values[..6], [7, 3, 9, 3, 1, 5]);
    // The sixth has no place.
    assert_eq!(call(&p, &mut ram, "push", &[2]), Err(EvalError::Index { at: 5, count: 5 }));
    assert_eq!(call(&p, &mut ram, "push", &[12]), Err(EvalError::Range(12)));
    assert_eq!(value(&p, &mut ram, "front", &[]), Ok(Value::Int(7)));
    for n in [7, 3, 9, 3, 1] {
        assert_eq!(value(&p, &mut ram, "has", &[n]), Ok(Value::Bool(true)));
        assert_eq!(value(&p, &mut ram, "pop", &[]), Ok(Value::Int(n)));
    }
    assert_eq!(ram.values[..6], [0; 6]);
    assert_eq!(value(&p, &mut ram, "pop", &[]), Err(EvalError::Outside { slot: 5, value: -1 }));
}

#[test]
fn records_enumerations_and_tables_have_their_places() {
    let p = program();
    let mut ram = Ram::of(&p, 0);
    let slot = |name: &str| p.shared.iter().position(|v| v.name == name).unwrap();
    for mode in [2, 0, 1, 2] {
        call(&p, &mut ram, "turn", &[]).unwrap();
        assert_eq!(ram.values[slot("mode")], mode);
    }
    call(&p, &mut ram, "push", &[4]).unwrap();
    call(&p, &mut ram, "keep", &[2, 4]).unwrap();
    call(&p, &mut ram, "keep", &[1, 5]).unwrap();
    let first = slot("slots[0].used");
    assert_eq!(ram.values[first..first + 6], [0, 0, 0, 5, 1, 4]);
    call(&p, &mut ram, "table", &[]).unwrap();
    let first = slot("grid[0][0]");
    assert_eq!(ram.values[first..first + 6], [0, 1, 2, 10, 11, 12]);
    // A local starts anew in each round.
    assert_eq!(value(&p, &mut ram, "fresh", &[]), Ok(Value::Int(9)));
}

#[test]
fn purity_and_owners_are_known() {
    let p = program();
    let pure: Vec<&str> = p.functions.iter().filter(|f| f.pure).map(|f| f.name.as_str()).collect();
    assert_eq!(pure, ["front", "has", "next", "fresh", "own"]);
    let owners: Vec<Option<AutomatonId>> = p.functions.iter().skip(10).map(|f| f.owner).collect();
    assert_eq!(owners, [0, 0, 1, 2].map(|a| Some(AutomatonId(a))));
    for (automaton, left) in [(1, 2), (2, 3)] {
        let mut ram = Ram::of(&p, automaton);
        let functions = FunctionTable::new(&p);
        let EdgeAssignment::Call { function, args } = &p.automata[automaton].edges[0].updates[0] else {
            panic!()
        };
        let base = u16::try_from(ram.vars.len()).unwrap();
        MemoryView::open(&functions, &mut ram, base, &[]).call(*function, args).unwrap();
        assert_eq!(ram.values.last(), Some(&left));
    }
}

#[test]
fn edges_index_at_run_time() {
    let p = program();
    let edge = &p.automata[0].edges[0];
    let shared = u16::try_from(p.shared.len()).unwrap();
    let (mine, i, k) = (shared, shared + 2, shared + 3);
    let index = |at: u16, count: u16, stride: u16| ArrayIndex { at: Expr::Var(at), count, stride };
    let Some(Expr::Binary(_, own, element)) = &edge.guard else { panic!("{:?}", edge.guard) };
    assert_eq!(**own, Expr::Apply(id(&p, "own"), vec![Expr::Var(i)]));
    let q = Lvalue { slot: 0, indices: vec![index(k, 5, 1)] };
    assert_eq!(**element, Expr::Element(Box::new(q)));
    let grid = u16::try_from(p.shared.iter().position(|v| v.name == "grid[0][0]").unwrap()).unwrap();
    let [
        EdgeAssignment::Call { .. },
        EdgeAssignment::Assign { place, .. },
        EdgeAssignment::Assign { place: last, .. },
    ] = edge.updates.as_slice()
    else {
        panic!("{:?}", edge.updates)
    };
    assert_eq!(*place, Lvalue { slot: grid, indices: vec![index(i, 2, 3), index(k, 3, 1)] });
    let at = Expr::Element(Box::new(Lvalue { slot: mine, indices: vec![index(i, 2, 1)] }));
    assert_eq!(*last, Lvalue { slot: 0, indices: vec![ArrayIndex { at, count: 5, stride: 1 }] });
    // A loop's variable is a local with the range of its ends.
    let sort = &p.functions[usize::from(id(&p, "sort").0)];
    assert!(matches!(sort.body[0], FunctionStatement::For { slot, .. } if slot == shared));
    let ranges: Vec<(i64, i64)> = sort.locals.iter().map(|v| (v.lo, v.hi)).collect();
    assert_eq!(ranges, [(0, 3), (0, 3), (0, 9)]);
}

proptest! {
    #[test]
    fn sorting_and_searching_are_as_rust_has_them(values in prop::collection::vec(0i64..=9, 5), e in 0i64..=9) {
        let p = program();
        let mut ram = Ram::of(&p, 0);
        ram.values[..5].copy_from_slice(&values);
        prop_assert_eq!(value(&p, &mut ram, "has", &[e]), Ok(Value::Bool(values.contains(&e))));
        call(&p, &mut ram, "sort", &[]).unwrap();
        let mut sorted = values;
        sorted.sort_unstable();
        prop_assert_eq!(&ram.values[..5], sorted.as_slice());
    }
}
