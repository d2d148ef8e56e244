//! Expressions and functions of automata, compiled once into trees over whole numbers.
//!
//! A value is kept as variables keep it: a bool as 0 or 1, a symbol as its index in its enumeration. What has no such form
//! (floats, strings and lists, which finite variables never hold) is left to the evaluation of [`Expr`] itself.

use std::cell::RefCell;

use hrdsl_ir::{
    Enumeration, EventId, Expr, Value,
    expr::{BinaryOp, EvalError, Function, Index, Place, Scope, UnaryOp},
    ta::{ChannelId, FunctionId, Var},
};

/// Statements that one evaluation may run.
const STEPS: u32 = 1_000_000;
/// Calls within calls.
const DEPTH: u32 = 100;

/// Why there is no value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Fault {
    Eval(EvalError),
    /// A variable of the network leaves its range; the place in the state.
    Range {
        at: u32,
        value: i64,
    },
    /// An argument outside its parameter's range.
    Argument {
        of: Medium,
        parameter: u16,
        value: Value,
    },
    /// A clock becomes less than zero.
    Negative {
        clock: u16,
    },
}

impl From<EvalError> for Fault {
    fn from(e: EvalError) -> Self {
        Fault::Eval(e)
    }
}

/// What a transition goes over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Medium {
    Event(EventId),
    Channel(ChannelId),
}

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Ty {
    Bool,
    Int,
    Enum(Enumeration),
    /// An index into the model's constants: of a float, string or list that an event carries.
    Constant,
}

impl Ty {
    pub(crate) fn of(var: &Var) -> Self {
        match var.enumeration {
            Some(e) => Ty::Enum(e),
            None if var.is_bool => Ty::Bool,
            None => Ty::Int,
        }
    }

    /// The number of a value. `None`: it is of another type.
    pub(crate) fn number(self, value: Value) -> Option<i64> {
        match (self, value) {
            (Ty::Bool, Value::Bool(b)) => Some(i64::from(b)),
            (Ty::Int, Value::Int(n)) => Some(n),
            (Ty::Enum(e), Value::Symbol(s)) => e.index_of(s).and_then(|n| i64::try_from(n).ok()),
            (Ty::Bool | Ty::Int | Ty::Enum(_) | Ty::Constant, _) => None,
        }
    }

    /// The value of a number.
    pub(crate) fn value(self, n: i64, constants: &[Value]) -> Option<Value> {
        let index = usize::try_from(n);
        match self {
            Ty::Bool => Some(Value::Bool(n != 0)),
            Ty::Int => Some(Value::Int(n)),
            Ty::Enum(e) => index.ok().and_then(|n| e.values().get(n)).copied().map(Value::Symbol),
            Ty::Constant => index.ok().and_then(|n| constants.get(n)).copied(),
        }
    }
}

/// Where a variable of an expression lives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum At {
    /// An index into the state's vector.
    State(u32),
    /// Of the frame: selects and bound arguments of an edge, or parameters and locals of a function.
    Local(u32),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cmp {
    Eq,
    Ne,
    Lt,
    Le,
    Gt,
    Ge,
}

impl Cmp {
    fn holds(self, a: i64, b: i64) -> bool {
        match self {
            Cmp::Eq => a == b,
            Cmp::Ne => a != b,
            Cmp::Lt => a < b,
            Cmp::Le => a <= b,
            Cmp::Gt => a > b,
            Cmp::Ge => a >= b,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Arith {
    Add,
    Sub,
    Mul,
    Div,
    Rem,
    Min,
    Max,
}

/// A compiled expression.
#[derive(Clone, Debug)]
pub(crate) enum Code {
    Const(i64),
    Var(u32),
    Local(u32),
    VarConst(Cmp, u32, i64),
    VarVar(Cmp, u32, u32),
    Compare(Cmp, Box<(Code, Code)>),
    Arith(Arith, Box<(Code, Code)>),
    Not(Box<Code>),
    Neg(Box<Code>),
    Abs(Box<Code>),
    And(Box<(Code, Code)>),
    Or(Box<(Code, Code)>),
    If(Box<(Code, Code, Code)>),
    Element(Box<Reach>),
    Apply(u32, Box<[Code]>),
    /// A symbol's index in another enumeration; `-1` if it is none of its symbols.
    Convert(Box<Code>, Enumeration, Box<[i64]>),
    Generic(Box<Generic>),
}

/// A variable or an element of an array of them.
#[derive(Clone, Debug)]
pub(crate) struct Reach {
    pub base: At,
    /// Index, count, stride.
    pub indices: Box<[(Code, u16, u16)]>,
}

/// An expression that is evaluated as values.
#[derive(Clone, Debug)]
pub(crate) struct Generic {
    expr: Expr,
    want: Ty,
    scope: Names,
}

/// What the variables of an expression are.
#[derive(Clone, Debug, Default)]
pub(crate) struct Names {
    pub vars: Vec<(At, Ty)>,
    /// The automaton (index in the network) whose functions may be called.
    pub member: Option<u16>,
}

#[derive(Clone, Debug)]
pub(crate) enum Instruction {
    Assign(Reach, Code),
    Call(u32, Box<[Code]>),
    If(Code, Box<[Instruction]>, Box<[Instruction]>),
    While(Code, Box<[Instruction]>),
    For(u32, Code, Code, Box<[Instruction]>),
    Return(Option<Code>),
}

/// A compiled function.
#[derive(Clone, Debug, Default)]
pub(crate) struct Routine {
    pub params: Vec<(i64, i64)>,
    /// Of the parameters.
    pub types: Vec<Ty>,
    /// Ranges of the frame: parameters, then locals.
    pub frame: Vec<(i64, i64)>,
    pub inits: Vec<i64>,
    pub result: Option<(Ty, i64, i64)>,
    pub body: Box<[Instruction]>,
}

/// Everything that code refers to.
#[derive(Debug, Default)]
pub(crate) struct Library {
    pub routines: Vec<Routine>,
    /// The range of each place of the state.
    pub ranges: Vec<(i64, i64)>,
    pub constants: Vec<Value>,
    /// The routine of a function of the program, for a member of the network.
    pub numbers: Vec<(FunctionId, Option<u16>, u32)>,
}

/// What an evaluation works on.
pub(crate) struct Env<'e> {
    pub library: &'e Library,
    pub state: &'e mut [i64],
    pub stack: &'e mut Vec<i64>,
    pub base: usize,
    pub steps: u32,
    pub depth: u32,
    /// Places of the state that were assigned to, if somebody wants to know.
    pub written: Option<&'e mut Vec<u32>>,
}

impl<'e> Env<'e> {
    /// The stack holds the frame.
    pub(crate) fn new(library: &'e Library, state: &'e mut [i64], stack: &'e mut Vec<i64>) -> Self {
        Self { library, state, stack, base: 0, steps: 0, depth: 0, written: None }
    }

    fn get(&self, at: At) -> i64 {
        match at {
            At::State(i) => self.state[i as usize],
            At::Local(i) => self.stack[self.base + i as usize],
        }
    }

    fn step(&mut self) -> Result<(), Fault> {
        self.steps += 1;
        if self.steps > STEPS { Err(EvalError::Endless.into()) } else { Ok(()) }
    }

    /// Assigns to a variable of the network, within its range.
    pub(crate) fn put(&mut self, at: u32, value: i64) -> Result<(), Fault> {
        let (lo, hi) = self.library.ranges[at as usize];
        if value < lo || value > hi {
            return Err(Fault::Range { at, value });
        }
        self.state[at as usize] = value;
        if let Some(written) = &mut self.written {
            written.push(at);
        }
        Ok(())
    }

    /// Assigns to a variable of the network or a local.
    pub(crate) fn assign(&mut self, place: &Reach, value: &Code, routine: Option<u32>) -> Result<(), Fault> {
        // The place is chosen before the value is worked out: a function in the value may change its indices.
        let at = place.resolve(self)?;
        let n = value.eval(self)?;
        match at {
            At::State(i) => self.put(i, n),
            At::Local(i) => {
                let range = routine.map(|r| self.library.routines[r as usize].frame[i as usize]);
                if range.is_some_and(|(lo, hi)| n < lo || n > hi) {
                    return Err(EvalError::Range(n).into());
                }
                self.stack[self.base + i as usize] = n;
                Ok(())
            }
        }
    }

    /// Calls a routine; 0 if it has no value.
    pub(crate) fn call(&mut self, routine: u32, args: &[Code]) -> Result<i64, Fault> {
        if self.depth >= DEPTH {
            return Err(EvalError::Endless.into());
        }
        let library = self.library;
        let r = &library.routines[routine as usize];
        let base = self.stack.len();
        for (a, &(lo, hi)) in args.iter().zip(&r.params) {
            let n = a.eval(self)?;
            if n < lo || n > hi {
                return Err(EvalError::Range(n).into());
            }
            self.stack.push(n);
        }
        self.stack.extend_from_slice(&r.inits);
        let outer = std::mem::replace(&mut self.base, base);
        self.depth += 1;
        let result = self.run(routine, &r.body);
        self.depth -= 1;
        self.base = outer;
        self.stack.truncate(base);
        match (result?, r.result) {
            (Some(n), Some((_, lo, hi))) if n < lo || n > hi => Err(EvalError::Range(n).into()),
            (Some(n), _) => Ok(n),
            (None, None) => Ok(0),
            // The checker sees to it that a value is returned on each way.
            (None, Some(_)) => Err(EvalError::Type.into()),
        }
    }

    /// `Some`: it returned.
    fn run(&mut self, routine: u32, body: &[Instruction]) -> Result<Option<i64>, Fault> {
        for i in body {
            self.step()?;
            let returned = match i {
                Instruction::Assign(place, value) => {
                    self.assign(place, value, Some(routine))?;
                    None
                }
                Instruction::Call(f, args) => {
                    self.call(*f, args)?;
                    None
                }
                Instruction::If(c, then, otherwise) => {
                    let body = if c.eval(self)? != 0 { then } else { otherwise };
                    self.run(routine, body)?
                }
                Instruction::While(c, body) => self.repeat(routine, c, body)?,
                Instruction::For(slot, lo, hi, body) => self.count(routine, *slot, (lo, hi), body)?,
                Instruction::Return(value) => {
                    return Ok(Some(value.as_ref().map_or(Ok(0), |v| v.eval(self))?));
                }
            };
            if returned.is_some() {
                return Ok(returned);
            }
        }
        Ok(None)
    }

    fn repeat(&mut self, routine: u32, c: &Code, body: &[Instruction]) -> Result<Option<i64>, Fault> {
        while c.eval(self)? != 0 {
            self.step()?;
            let returned = self.run(routine, body)?;
            if returned.is_some() {
                return Ok(returned);
            }
        }
        Ok(None)
    }

    fn count(
        &mut self,
        routine: u32,
        slot: u32,
        (lo, hi): (&Code, &Code),
        body: &[Instruction],
    ) -> Result<Option<i64>, Fault> {
        let (lo, hi) = (lo.eval(self)?, hi.eval(self)?);
        let (least, most) = self.library.routines[routine as usize].frame[slot as usize];
        let mut n = lo;
        while n <= hi {
            self.step()?;
            if n < least || n > most {
                return Err(EvalError::Range(n).into());
            }
            let at = self.base + slot as usize;
            self.stack[at] = n;
            let returned = self.run(routine, body)?;
            if returned.is_some() {
                return Ok(returned);
            }
            n = n.checked_add(1).ok_or(EvalError::Overflow)?;
        }
        Ok(None)
    }
}

impl Reach {
    pub(crate) fn resolve(&self, env: &mut Env) -> Result<At, Fault> {
        let mut offset = 0;
        for (at, count, stride) in &self.indices {
            let n = at.eval(env)?;
            if n < 0 || n >= i64::from(*count) {
                return Err(EvalError::Index { at: n, count: *count }.into());
            }
            offset += n as u32 * u32::from(*stride);
        }
        Ok(match self.base {
            At::State(i) => At::State(i + offset),
            At::Local(i) => At::Local(i + offset),
        })
    }

    /// All variables of the network that it may stand for.
    pub(crate) fn targets(&self, f: &mut dyn FnMut(u32)) {
        let At::State(base) = self.base else { return };
        let mut all = vec![base];
        for (_, count, stride) in &self.indices {
            let step = |s: &u32| {
                let s = *s;
                (0..*count).map(move |n| s + u32::from(n) * u32::from(*stride)).collect::<Vec<_>>()
            };
            all = all.iter().flat_map(step).collect();
        }
        all.into_iter().for_each(f);
    }
}

fn some(n: Option<i64>) -> Result<i64, Fault> {
    n.ok_or(Fault::Eval(EvalError::Overflow))
}

impl Arith {
    fn of(self, a: i64, b: i64) -> Result<i64, Fault> {
        match self {
            Arith::Add => some(a.checked_add(b)),
            Arith::Sub => some(a.checked_sub(b)),
            Arith::Mul => some(a.checked_mul(b)),
            Arith::Div | Arith::Rem if b == 0 => Err(EvalError::DivisionByZero.into()),
            Arith::Div => some(a.checked_div(b)),
            Arith::Rem => some(a.checked_rem(b)),
            Arith::Min => Ok(a.min(b)),
            Arith::Max => Ok(a.max(b)),
        }
    }
}

impl Code {
    pub(crate) fn eval(&self, env: &mut Env) -> Result<i64, Fault> {
        Ok(match self {
            Code::Const(n) => *n,
            Code::Var(i) => env.state[*i as usize],
            Code::Local(i) => env.stack[env.base + *i as usize],
            Code::VarConst(op, i, n) => i64::from(op.holds(env.state[*i as usize], *n)),
            Code::VarVar(op, i, j) => i64::from(op.holds(env.state[*i as usize], env.state[*j as usize])),
            Code::Compare(op, ab) => {
                let a = ab.0.eval(env)?;
                i64::from(op.holds(a, ab.1.eval(env)?))
            }
            Code::Arith(op, ab) => {
                let a = ab.0.eval(env)?;
                return op.of(a, ab.1.eval(env)?);
            }
            Code::Not(a) => i64::from(a.eval(env)? == 0),
            Code::Neg(a) => return some(a.eval(env)?.checked_neg()),
            Code::Abs(a) => return some(a.eval(env)?.checked_abs()),
            Code::And(ab) => {
                if ab.0.eval(env)? == 0 {
                    0
                } else {
                    return ab.1.eval(env);
                }
            }
            Code::Or(ab) => {
                if ab.0.eval(env)? == 0 {
                    return ab.1.eval(env);
                }
                1
            }
            Code::If(cab) => {
                return if cab.0.eval(env)? != 0 { cab.1.eval(env) } else { cab.2.eval(env) };
            }
            Code::Element(place) => {
                let at = place.resolve(env)?;
                env.get(at)
            }
            Code::Apply(f, args) => return env.call(*f, args),
            Code::Convert(a, _, table) => {
                let n = a.eval(env)?;
                usize::try_from(n).ok().and_then(|n| table.get(n)).copied().unwrap_or(-1)
            }
            Code::Generic(g) => return g.eval(env),
        })
    }

    /// What a value that is out of range is called.
    pub(crate) fn value_of(&self, env: &mut Env, n: i64) -> Value {
        if let Code::Convert(inner, from, _) = self
            && let Ok(n) = inner.eval(env)
            && let Some(value) = Ty::Enum(*from).value(n, &[])
        {
            return value;
        }
        Value::Int(n)
    }

    pub(crate) fn constant(&self) -> Option<i64> {
        match self {
            Code::Const(n) => Some(*n),
            _ => None,
        }
    }

    /// The least and greatest value that it can have, and whether it always has one. `locals` are the frame's ranges.
    pub(crate) fn span(&self, library: &Library, locals: &[(i64, i64)]) -> (i64, i64, bool) {
        let of = |c: &Code| c.span(library, locals);
        match self {
            Code::Const(n) => (*n, *n, true),
            Code::Var(i) => {
                let (lo, hi) = library.ranges[*i as usize];
                (lo, hi, true)
            }
            Code::Local(i) => {
                let known = locals.get(*i as usize);
                known.map_or((i64::MIN, i64::MAX, true), |&(lo, hi)| (lo, hi, true))
            }
            Code::VarConst(..) | Code::VarVar(..) => (0, 1, true),
            Code::Compare(_, ab) | Code::And(ab) | Code::Or(ab) => (0, 1, of(&ab.0).2 && of(&ab.1).2),
            Code::Not(a) => (0, 1, of(a).2),
            Code::Neg(a) => {
                let (lo, hi, sure) = of(a);
                (hi.saturating_neg(), lo.saturating_neg(), sure && lo > i64::MIN)
            }
            Code::Abs(a) => {
                let (lo, hi, sure) = of(a);
                let least = if lo <= 0 && hi >= 0 { 0 } else { lo.saturating_abs().min(hi.saturating_abs()) };
                (least, lo.saturating_abs().max(hi.saturating_abs()), sure && lo > i64::MIN)
            }
            Code::Arith(op, ab) => op.span(of(&ab.0), of(&ab.1)),
            Code::If(cab) => {
                let (c, a, b) = (of(&cab.0), of(&cab.1), of(&cab.2));
                (a.0.min(b.0), a.1.max(b.1), c.2 && a.2 && b.2)
            }
            Code::Element(place) => {
                let (mut lo, mut hi) = (i64::MAX, i64::MIN);
                place.targets(&mut |i| {
                    let (a, b) = library.ranges[i as usize];
                    (lo, hi) = (lo.min(a), hi.max(b));
                });
                if lo > hi {
                    return (i64::MIN, i64::MAX, false);
                }
                (lo, hi, place.always_there(library, locals))
            }
            Code::Apply(f, _) => {
                let result = library.routines[*f as usize].result;
                result.map_or((0, 0, false), |(_, lo, hi)| (lo, hi, false))
            }
            Code::Convert(a, _, table) => {
                (-1, table.iter().copied().max().unwrap_or(-1), of(a).2 && !table.contains(&-1))
            }
            Code::Generic(_) => (i64::MIN, i64::MAX, false),
        }
    }

    /// Calls `f` with each variable of the network that it may read.
    pub(crate) fn each_var(&self, library: &Library, f: &mut dyn FnMut(u32)) {
        let mut calls = Vec::new();
        self.scan(f, &mut |c| calls.push(c));
        calls.into_iter().for_each(|c| library.each_read(c, f));
    }

    /// The routines that it calls.
    pub(crate) fn each_call(&self, f: &mut dyn FnMut(u32)) {
        self.scan(&mut |_| {}, f);
    }

    fn scan(&self, read: &mut dyn FnMut(u32), called: &mut dyn FnMut(u32)) {
        match self {
            Code::Const(_) | Code::Local(_) => {}
            Code::Var(i) | Code::VarConst(_, i, _) => read(*i),
            Code::VarVar(_, i, j) => {
                read(*i);
                read(*j);
            }
            Code::Compare(_, ab) | Code::Arith(_, ab) | Code::And(ab) | Code::Or(ab) => {
                ab.0.scan(read, called);
                ab.1.scan(read, called);
            }
            Code::Not(a) | Code::Neg(a) | Code::Abs(a) | Code::Convert(a, ..) => a.scan(read, called),
            Code::If(cab) => {
                cab.0.scan(read, called);
                cab.1.scan(read, called);
                cab.2.scan(read, called);
            }
            Code::Element(place) => {
                place.targets(read);
                place.indices.iter().for_each(|(at, ..)| at.scan(read, called));
            }
            Code::Apply(routine, args) => {
                called(*routine);
                args.iter().for_each(|a| a.scan(read, called));
            }
            Code::Generic(g) => {
                for (at, _) in &g.scope.vars {
                    if let At::State(i) = at {
                        read(*i);
                    }
                }
            }
        }
    }
}

impl Library {
    /// Calls `f` with each variable of the network that a routine or what it calls reads.
    pub(crate) fn each_read(&self, routine: u32, f: &mut dyn FnMut(u32)) {
        let (mut seen, mut todo) = (vec![routine], vec![routine]);
        while let Some(r) = todo.pop() {
            let mut calls = Vec::new();
            // What an expression calls is looked at here, not by the expression: calls may go in circles.
            self.scan(&self.routines[r as usize].body, f, &mut |_| {}, &mut |c| calls.push(c));
            for c in calls {
                if !seen.contains(&c) {
                    seen.push(c);
                    todo.push(c);
                }
            }
        }
    }

    /// Calls `f` with each variable of the network that a routine or what it calls may assign to.
    pub(crate) fn each_written(&self, routine: u32, f: &mut dyn FnMut(u32)) {
        let (mut seen, mut todo) = (vec![routine], vec![routine]);
        while let Some(r) = todo.pop() {
            let mut calls = Vec::new();
            self.scan(&self.routines[r as usize].body, &mut |_| {}, f, &mut |c| calls.push(c));
            for c in calls {
                if !seen.contains(&c) {
                    seen.push(c);
                    todo.push(c);
                }
            }
        }
    }

    fn scan(
        &self,
        body: &[Instruction],
        read: &mut dyn FnMut(u32),
        written: &mut dyn FnMut(u32),
        called: &mut dyn FnMut(u32),
    ) {
        for i in body {
            match i {
                Instruction::Assign(place, value) => {
                    value.scan(read, called);
                    place.indices.iter().for_each(|(at, ..)| at.scan(read, called));
                    place.targets(written);
                }
                Instruction::Call(routine, args) => {
                    called(*routine);
                    args.iter().for_each(|a| a.scan(read, called));
                }
                Instruction::If(c, then, otherwise) => {
                    c.scan(read, called);
                    self.scan(then, read, written, called);
                    self.scan(otherwise, read, written, called);
                }
                Instruction::While(c, body) => {
                    c.scan(read, called);
                    self.scan(body, read, written, called);
                }
                Instruction::For(_, lo, hi, body) => {
                    lo.scan(read, called);
                    hi.scan(read, called);
                    self.scan(body, read, written, called);
                }
                Instruction::Return(value) => value.iter().for_each(|v| v.scan(read, called)),
            }
        }
    }
}

impl Reach {
    pub(crate) fn always_there(&self, library: &Library, locals: &[(i64, i64)]) -> bool {
        self.indices.iter().all(|(at, count, _)| {
            let (lo, hi, sure) = at.span(library, locals);
            sure && lo >= 0 && hi < i64::from(*count)
        })
    }
}

impl Arith {
    fn span(self, (a, b, x): (i64, i64, bool), (c, d, y): (i64, i64, bool)) -> (i64, i64, bool) {
        let corners = |f: &dyn Fn(i64, i64) -> Option<i64>| {
            let all = [f(a, c), f(a, d), f(b, c), f(b, d)];
            let sure = all.iter().all(Option::is_some) && x && y;
            let known = || all.iter().flatten().copied();
            if sure {
                (known().min().unwrap_or(i64::MIN), known().max().unwrap_or(i64::MAX), true)
            } else {
                (i64::MIN, i64::MAX, false)
            }
        };
        match self {
            Arith::Add => corners(&i64::checked_add),
            Arith::Sub => corners(&i64::checked_sub),
            Arith::Mul => corners(&i64::checked_mul),
            Arith::Div => {
                let most = a.saturating_abs().max(b.saturating_abs());
                (most.saturating_neg(), most, x && y && (c > 0 || d < 0) && a > i64::MIN)
            }
            Arith::Rem => {
                let most = c.saturating_abs().max(d.saturating_abs()).saturating_sub(1).max(0);
                let lo = if a >= 0 { 0 } else { most.saturating_neg() };
                (lo, most, x && y && (c > 0 || d < 0))
            }
            Arith::Min => (a.min(c), b.min(d), x && y),
            Arith::Max => (a.max(c), b.max(d), x && y),
        }
    }
}

// ── Values, for the rest ──

struct Values<'a, 'e> {
    env: RefCell<&'a mut Env<'e>>,
    scope: &'a Names,
}

impl Scope for Values<'_, '_> {
    fn var(&self, slot: u16) -> Option<Value> {
        let (at, ty) = *self.scope.vars.get(usize::from(slot))?;
        let env = self.env.try_borrow().ok()?;
        ty.value(env.get(at), &env.library.constants)
    }

    fn apply(&self, function: FunctionId, args: &[Value]) -> Result<Value, EvalError> {
        let Ok(mut env) = self.env.try_borrow_mut() else { return Err(EvalError::Type) };
        let library = env.library;
        let routine = library.routine(function, self.scope.member).ok_or(EvalError::Type)?;
        let (ty, ..) = library.routines[routine as usize].result.ok_or(EvalError::Type)?;
        let number = |v: &Value| match v {
            Value::Bool(b) => Some(i64::from(*b)),
            Value::Int(n) => Some(*n),
            Value::Float(_) | Value::Symbol(_) | Value::Text(_) | Value::List(_) => None,
        };
        let args: Option<Vec<Code>> = args.iter().map(|v| number(v).map(Code::Const)).collect();
        let n = env.call(routine, &args.ok_or(EvalError::Type)?).map_err(|f| match f {
            Fault::Eval(e) => e,
            Fault::Range { value, .. } => EvalError::Range(value),
            Fault::Argument { .. } | Fault::Negative { .. } => EvalError::Type,
        })?;
        ty.value(n, &library.constants).ok_or(EvalError::Type)
    }
}

impl Generic {
    fn eval(&self, env: &mut Env) -> Result<i64, Fault> {
        let scope = Values { env: RefCell::new(env), scope: &self.scope };
        let value = self.expr.eval_in(&scope)?;
        self.want.number(value).ok_or(Fault::Eval(EvalError::Type))
    }
}

// ── Compilation ──

impl Library {
    pub(crate) fn routine(&self, function: FunctionId, member: Option<u16>) -> Option<u32> {
        let of = |m: Option<u16>| self.numbers.iter().find(|n| n.0 == function && n.1 == m).map(|n| n.2);
        of(member).or_else(|| of(None))
    }

    /// The number of a constant that is not of a finite type.
    pub(crate) fn constant(&mut self, value: Value) -> i64 {
        let known = self.constants.iter().position(|v| v.key() == value.key());
        let n = known.unwrap_or_else(|| {
            self.constants.push(value);
            self.constants.len() - 1
        });
        n as i64
    }

    /// An expression of a known type. One that has no form in whole numbers is evaluated as it is.
    pub(crate) fn compile(&self, names: &Names, e: &Expr, want: Ty) -> Code {
        let hint = if let Ty::Enum(e) = want { Some(e) } else { None };
        match self.typed(names, e, hint) {
            Some((code, ty)) if ty == want => code,
            Some((code, Ty::Enum(from))) if hint.is_some() && self.total(from, hint) => {
                convert(code, from, hint)
            }
            Some(_) | None => {
                Code::Generic(Box::new(Generic { expr: e.clone(), want, scope: names.clone() }))
            }
        }
    }

    /// Whether each symbol of the one is one of the other.
    fn total(&self, from: Enumeration, to: Option<Enumeration>) -> bool {
        from.values().iter().all(|s| to.is_some_and(|t| t.index_of(*s).is_some()))
    }

    /// `None`: it has no form in whole numbers.
    pub(crate) fn typed(&self, names: &Names, e: &Expr, hint: Option<Enumeration>) -> Option<(Code, Ty)> {
        match e {
            Expr::Const(Value::Bool(b)) => Some((Code::Const(i64::from(*b)), Ty::Bool)),
            Expr::Const(Value::Int(n)) => Some((Code::Const(*n), Ty::Int)),
            Expr::Const(Value::Symbol(s)) => {
                let e = hint?;
                Some((Code::Const(e.index_of(*s)? as i64), Ty::Enum(e)))
            }
            Expr::Const(Value::Float(_) | Value::Text(_) | Value::List(_)) | Expr::List(..) => None,
            Expr::Var(i) => match *names.vars.get(usize::from(*i))? {
                (_, Ty::Constant) => None,
                (At::State(i), ty) => Some((Code::Var(i), ty)),
                (At::Local(i), ty) => Some((Code::Local(i), ty)),
            },
            Expr::Unary(op, a) => {
                let (code, ty) = self.typed(names, a, None)?;
                match (op, ty) {
                    (UnaryOp::Not, Ty::Bool) => Some((fold(Code::Not(Box::new(code))), Ty::Bool)),
                    (UnaryOp::Neg, Ty::Int) => Some((fold(Code::Neg(Box::new(code))), Ty::Int)),
                    (UnaryOp::Not | UnaryOp::Neg, _) => None,
                }
            }
            Expr::Binary(op, a, b) => self.binary(names, *op, a, b),
            Expr::If(c, a, b) => {
                let (c, Ty::Bool) = self.typed(names, c, None)? else { return None };
                let (a, b, ty) = self.both(names, a, b, hint)?;
                Some((Code::If(Box::new((c, a, b))), ty))
            }
            Expr::Call(f, args) => self.function(names, *f, args),
            Expr::Element(place) => {
                let reach = self.reach(names, place)?;
                let ty = names.vars.get(usize::from(place.slot))?.1;
                let code = match (reach.indices.is_empty(), reach.base) {
                    (true, At::State(i)) => Code::Var(i),
                    (true, At::Local(i)) => Code::Local(i),
                    (false, _) => Code::Element(Box::new(reach)),
                };
                Some((code, ty))
            }
            Expr::Apply(f, args) => {
                let routine = self.routine(*f, names.member)?;
                let (ty, ..) = self.routines[routine as usize].result?;
                Some((Code::Apply(routine, self.arguments(names, routine, args)?), ty))
            }
        }
    }

    /// Both of one type.
    fn both(&self, names: &Names, a: &Expr, b: &Expr, hint: Option<Enumeration>) -> Option<(Code, Code, Ty)> {
        let of = |e, hint| self.typed(names, e, hint);
        let kind = |t: Ty| if let Ty::Enum(e) = t { Some(e) } else { None };
        let ((a, x), (b, y)) = match of(a, hint) {
            Some((code, ty)) => ((code, ty), of(b, kind(ty).or(hint))?),
            None => {
                let (right, ty) = of(b, hint)?;
                (of(a, Some(kind(ty)?))?, (right, ty))
            }
        };
        if x == y { Some((a, b, x)) } else { None }
    }

    fn function(&self, names: &Names, f: Function, args: &[Expr]) -> Option<(Code, Ty)> {
        let numbers: Option<Vec<Code>> = args
            .iter()
            .map(|a| self.typed(names, a, None).and_then(|(c, ty)| (ty == Ty::Int).then_some(c)))
            .collect();
        let mut numbers = numbers?.into_iter();
        let code = match (f, numbers.next(), numbers.next(), numbers.next()) {
            (Function::Abs, Some(a), None, None) => Code::Abs(Box::new(a)),
            (Function::Min, Some(a), Some(b), None) => Code::Arith(Arith::Min, Box::new((a, b))),
            (Function::Max, Some(a), Some(b), None) => Code::Arith(Arith::Max, Box::new((a, b))),
            (Function::Abs | Function::Min | Function::Max | Function::Norm, ..) => return None,
        };
        Some((fold(code), Ty::Int))
    }

    fn binary(&self, names: &Names, op: BinaryOp, a: &Expr, b: &Expr) -> Option<(Code, Ty)> {
        let (a, b, ty) = self.both(names, a, b, None)?;
        let arith = |op, a, b| Some((fold(Code::Arith(op, Box::new((a, b)))), Ty::Int));
        let compare = |op, a, b| Some((comparison(op, a, b), Ty::Bool));
        match (op, ty) {
            (BinaryOp::And, Ty::Bool) => Some((Code::And(Box::new((a, b))), Ty::Bool)),
            (BinaryOp::Or, Ty::Bool) => Some((Code::Or(Box::new((a, b))), Ty::Bool)),
            (BinaryOp::Eq, Ty::Bool | Ty::Int | Ty::Enum(_)) => compare(Cmp::Eq, a, b),
            (BinaryOp::Ne, Ty::Bool | Ty::Int | Ty::Enum(_)) => compare(Cmp::Ne, a, b),
            (BinaryOp::Lt, Ty::Int) => compare(Cmp::Lt, a, b),
            (BinaryOp::Le, Ty::Int) => compare(Cmp::Le, a, b),
            (BinaryOp::Gt, Ty::Int) => compare(Cmp::Gt, a, b),
            (BinaryOp::Ge, Ty::Int) => compare(Cmp::Ge, a, b),
            (BinaryOp::Add, Ty::Int) => arith(Arith::Add, a, b),
            (BinaryOp::Sub, Ty::Int) => arith(Arith::Sub, a, b),
            (BinaryOp::Mul, Ty::Int) => arith(Arith::Mul, a, b),
            (BinaryOp::Div, Ty::Int) => arith(Arith::Div, a, b),
            (BinaryOp::Rem, Ty::Int) => arith(Arith::Rem, a, b),
            (
                BinaryOp::Add
                | BinaryOp::Sub
                | BinaryOp::Mul
                | BinaryOp::Div
                | BinaryOp::Rem
                | BinaryOp::Eq
                | BinaryOp::Ne
                | BinaryOp::Lt
                | BinaryOp::Le
                | BinaryOp::Gt
                | BinaryOp::Ge
                | BinaryOp::And
                | BinaryOp::Or,
                _,
            ) => None,
        }
    }

    pub(crate) fn reach(&self, names: &Names, place: &Place) -> Option<Reach> {
        let base = names.vars.get(usize::from(place.slot))?.0;
        let index = |i: &Index| Some((self.compile(names, &i.at, Ty::Int), i.count, i.stride));
        let indices = place.indices.iter().map(index).collect::<Option<Vec<_>>>()?;
        let last: usize =
            place.indices.iter().map(|i| usize::from(i.count.max(1) - 1) * usize::from(i.stride)).sum();
        names.vars.get(usize::from(place.slot) + last)?;
        if indices.iter().all(|(at, count, _)| at.constant().is_some_and(|n| n >= 0 && n < i64::from(*count)))
        {
            let offset: i64 =
                indices.iter().map(|(at, _, stride)| at.constant().unwrap_or(0) * i64::from(*stride)).sum();
            let base = match base {
                At::State(i) => At::State(i + offset as u32),
                At::Local(i) => At::Local(i + offset as u32),
            };
            return Some(Reach { base, indices: Box::default() });
        }
        Some(Reach { base, indices: indices.into() })
    }

    /// Arguments for a routine's parameters.
    pub(crate) fn arguments(&self, names: &Names, routine: u32, args: &[Expr]) -> Option<Box<[Code]>> {
        let r = &self.routines[routine as usize];
        if args.len() != r.params.len() {
            return None;
        }
        Some(args.iter().zip(&r.types).map(|(a, &ty)| self.compile(names, a, ty)).collect())
    }
}

fn convert(code: Code, from: Enumeration, to: Option<Enumeration>) -> Code {
    let index = |s| to.and_then(|t| t.index_of(s)).map_or(-1, |n| n as i64);
    Code::Convert(Box::new(code), from, from.values().iter().map(|s| index(*s)).collect())
}

fn comparison(op: Cmp, a: Code, b: Code) -> Code {
    let turned = match op {
        Cmp::Eq | Cmp::Ne => op,
        Cmp::Lt => Cmp::Gt,
        Cmp::Le => Cmp::Ge,
        Cmp::Gt => Cmp::Lt,
        Cmp::Ge => Cmp::Le,
    };
    match (a, b) {
        (Code::Const(a), Code::Const(b)) => Code::Const(i64::from(op.holds(a, b))),
        (Code::Var(i), Code::Const(n)) => Code::VarConst(op, i, n),
        (Code::Const(n), Code::Var(i)) => Code::VarConst(turned, i, n),
        (Code::Var(i), Code::Var(j)) => Code::VarVar(op, i, j),
        (a, b) => Code::Compare(op, Box::new((a, b))),
    }
}

/// Of constants: the value, if it has one.
fn fold(code: Code) -> Code {
    let value = match &code {
        Code::Not(a) => a.constant().map(|n| i64::from(n == 0)),
        Code::Neg(a) => a.constant().and_then(i64::checked_neg),
        Code::Abs(a) => a.constant().and_then(i64::checked_abs),
        Code::Arith(op, ab) => ab.0.constant().zip(ab.1.constant()).and_then(|(a, b)| op.of(a, b).ok()),
        _ => None,
    };
    value.map_or(code, Code::Const)
}
