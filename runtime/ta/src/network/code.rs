//! Expressions and functions of automata, compiled once into trees over whole numbers.
//!
//! A value is kept as variables keep it: a bool as 0 or 1, a symbol as its index in its enumeration. What has no such form
//! (floats, strings and lists, which finite variables never hold) is left to the evaluation of [`Expr`] itself.

use std::cell::RefCell;

use hrdsl_ir::{
    Enumeration, EventId, Expr, Value,
    expr::{ArrayIndex, BinaryOp, EvalError, EvalScope, Lvalue, NumberFunction, UnaryOp},
    ta::{ChannelId, FunctionId},
};

use crate::network::number::{NumberComparison, NumberType};

/// Statements that one evaluation may run.
const STEPS: u32 = 1_000_000;
/// Calls within calls.
const DEPTH: u32 = 100;

pub(crate) use crate::network::scope::{VariablePlace, VariableScope};

/// Why there is no value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum CodeEvalError {
    Eval(EvalError),
    /// A variable of the network leaves its range; the place in the state.
    Range {
        at: u32,
        value: i64,
    },
    /// An argument outside its parameter's range.
    Argument {
        of: SyncMedium,
        parameter: u16,
        value: Value,
    },
    /// A clock becomes less than zero.
    Negative {
        clock: u16,
    },
}

impl From<EvalError> for CodeEvalError {
    fn from(e: EvalError) -> Self {
        CodeEvalError::Eval(e)
    }
}

/// What a transition goes over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum SyncMedium {
    Event(EventId),
    Channel(ChannelId),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ArithmeticOp {
    Add,
    Sub,
    Mul,
    Div,
    Rem,
    Min,
    Max,
}

/// What an operator does with numbers.
enum NumericOp {
    Arith(ArithmeticOp),
    Compare(NumberComparison),
    And,
    Or,
}

fn numeric(op: BinaryOp) -> NumericOp {
    match op {
        BinaryOp::Add => NumericOp::Arith(ArithmeticOp::Add),
        BinaryOp::Sub => NumericOp::Arith(ArithmeticOp::Sub),
        BinaryOp::Mul => NumericOp::Arith(ArithmeticOp::Mul),
        BinaryOp::Div => NumericOp::Arith(ArithmeticOp::Div),
        BinaryOp::Rem => NumericOp::Arith(ArithmeticOp::Rem),
        BinaryOp::Eq => NumericOp::Compare(NumberComparison::Eq),
        BinaryOp::Ne => NumericOp::Compare(NumberComparison::Ne),
        BinaryOp::Lt => NumericOp::Compare(NumberComparison::Lt),
        BinaryOp::Le => NumericOp::Compare(NumberComparison::Le),
        BinaryOp::Gt => NumericOp::Compare(NumberComparison::Gt),
        BinaryOp::Ge => NumericOp::Compare(NumberComparison::Ge),
        BinaryOp::And => NumericOp::And,
        BinaryOp::Or => NumericOp::Or,
    }
}

/// A compiled expression.
#[derive(Clone, Debug)]
pub(crate) enum CompiledExpr {
    Const(i64),
    Var(u32),
    Local(u32),
    VarConst(NumberComparison, u32, i64),
    VarVar(NumberComparison, u32, u32),
    Compare(NumberComparison, Box<(CompiledExpr, CompiledExpr)>),
    Arith(ArithmeticOp, Box<(CompiledExpr, CompiledExpr)>),
    Not(Box<CompiledExpr>),
    Neg(Box<CompiledExpr>),
    Abs(Box<CompiledExpr>),
    And(Box<(CompiledExpr, CompiledExpr)>),
    Or(Box<(CompiledExpr, CompiledExpr)>),
    If(Box<(CompiledExpr, CompiledExpr, CompiledExpr)>),
    Element(Box<CompiledLvalue>),
    Apply(u32, Box<[CompiledExpr]>),
    /// A symbol's index in another enumeration; `-1` if it is none of its symbols.
    Convert(Box<CompiledExpr>, Enumeration, Box<[i64]>),
    Generic(Box<GenericExpr>),
}

/// A variable or an element of an array of them.
#[derive(Clone, Debug)]
pub(crate) struct CompiledLvalue {
    pub base: VariablePlace,
    /// Index, count, stride.
    pub indices: Box<[(CompiledExpr, u16, u16)]>,
}

/// An expression that is evaluated as values.
#[derive(Clone, Debug)]
pub(crate) struct GenericExpr {
    expr: Expr,
    want: NumberType,
    scope: VariableScope,
}

#[derive(Clone, Debug)]
pub(crate) enum CompiledStatement {
    Assign(CompiledLvalue, CompiledExpr),
    Call(u32, Box<[CompiledExpr]>),
    If(CompiledExpr, Box<[CompiledStatement]>, Box<[CompiledStatement]>),
    While(CompiledExpr, Box<[CompiledStatement]>),
    For(u32, CompiledExpr, CompiledExpr, Box<[CompiledStatement]>),
    Return(Option<CompiledExpr>),
}

/// A compiled function.
#[derive(Clone, Debug, Default)]
pub(crate) struct CompiledFunction {
    pub params: Vec<(i64, i64)>,
    /// Of the parameters.
    pub types: Vec<NumberType>,
    /// Ranges of the frame: parameters, then locals.
    pub frame: Vec<(i64, i64)>,
    pub inits: Vec<i64>,
    pub result: Option<(NumberType, i64, i64)>,
    pub body: Box<[CompiledStatement]>,
}

/// Everything that code refers to.
#[derive(Debug, Default)]
pub(crate) struct CodeLibrary {
    pub routines: Vec<CompiledFunction>,
    /// The range of each place of the state.
    pub ranges: Vec<(i64, i64)>,
    pub constants: Vec<Value>,
    /// The routine of a function of the program, for a member of the network.
    pub numbers: Vec<(FunctionId, Option<u16>, u32)>,
}

/// What an evaluation works on.
pub(crate) struct CodeEvalContext<'e> {
    pub library: &'e CodeLibrary,
    pub state: &'e mut [i64],
    pub stack: &'e mut Vec<i64>,
    pub base: usize,
    pub steps: u32,
    pub depth: u32,
    /// Places of the state that were assigned to, if somebody wants to know.
    pub written: Option<&'e mut Vec<u32>>,
}

impl<'e> CodeEvalContext<'e> {
    /// The stack holds the frame.
    pub(crate) fn new(library: &'e CodeLibrary, state: &'e mut [i64], stack: &'e mut Vec<i64>) -> Self {
        Self { library, state, stack, base: 0, steps: 0, depth: 0, written: None }
    }

    fn get(&self, at: VariablePlace) -> i64 {
        match at {
            VariablePlace::State(i) => self.state[i as usize],
            VariablePlace::Local(i) => self.stack[self.base + i as usize],
        }
    }

    fn step(&mut self) -> Result<(), CodeEvalError> {
        self.steps += 1;
        if self.steps > STEPS { Err(EvalError::Endless.into()) } else { Ok(()) }
    }

    /// Assigns to a variable of the network, within its range.
    pub(crate) fn put(&mut self, at: u32, value: i64) -> Result<(), CodeEvalError> {
        let (lo, hi) = self.library.ranges[at as usize];
        if value < lo || value > hi {
            return Err(CodeEvalError::Range { at, value });
        }
        self.state[at as usize] = value;
        if let Some(written) = &mut self.written {
            written.push(at);
        }
        Ok(())
    }

    /// Assigns to a variable of the network or a local.
    pub(crate) fn assign(
        &mut self,
        place: &CompiledLvalue,
        value: &CompiledExpr,
        routine: Option<u32>,
    ) -> Result<(), CodeEvalError> {
        // As in `hrdsl_ir::exec`: the lvalue is chosen before the value is worked out, since a function in the value may change its indices.
        let at = place.resolve(self)?;
        let n = value.eval(self)?;
        match at {
            VariablePlace::State(i) => self.put(i, n),
            VariablePlace::Local(i) => {
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
    pub(crate) fn call(&mut self, routine: u32, args: &[CompiledExpr]) -> Result<i64, CodeEvalError> {
        if self.depth >= DEPTH {
            return Err(EvalError::Endless.into());
        }
        let library = self.library;
        let r = &library.routines[routine as usize];
        // The frame grows on top while `base` is still the caller's: arguments are worked out in the caller's frame.
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
    fn run(&mut self, routine: u32, body: &[CompiledStatement]) -> Result<Option<i64>, CodeEvalError> {
        for i in body {
            self.step()?;
            let returned = match i {
                CompiledStatement::Assign(place, value) => {
                    self.assign(place, value, Some(routine))?;
                    None
                }
                CompiledStatement::Call(f, args) => {
                    self.call(*f, args)?;
                    None
                }
                CompiledStatement::If(c, then, otherwise) => {
                    let body = if c.eval(self)? != 0 { then } else { otherwise };
                    self.run(routine, body)?
                }
                CompiledStatement::While(c, body) => self.repeat(routine, c, body)?,
                CompiledStatement::For(slot, lo, hi, body) => self.count(routine, *slot, (lo, hi), body)?,
                CompiledStatement::Return(value) => {
                    return Ok(Some(value.as_ref().map_or(Ok(0), |v| v.eval(self))?));
                }
            };
            if returned.is_some() {
                return Ok(returned);
            }
        }
        Ok(None)
    }

    fn repeat(
        &mut self,
        routine: u32,
        c: &CompiledExpr,
        body: &[CompiledStatement],
    ) -> Result<Option<i64>, CodeEvalError> {
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
        (lo, hi): (&CompiledExpr, &CompiledExpr),
        body: &[CompiledStatement],
    ) -> Result<Option<i64>, CodeEvalError> {
        let (lo, hi) = (lo.eval(self)?, hi.eval(self)?);
        let (least, most) = self.library.routines[routine as usize].frame[slot as usize];
        let mut n = lo;
        while n <= hi {
            self.step()?;
            // Rounds are counted in `n`: a body that sets the variable does not change how often it runs.
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

impl CompiledLvalue {
    pub(crate) fn resolve(&self, env: &mut CodeEvalContext) -> Result<VariablePlace, CodeEvalError> {
        let mut offset = 0;
        for (at, count, stride) in &self.indices {
            let n = at.eval(env)?;
            if n < 0 || n >= i64::from(*count) {
                return Err(EvalError::Index { at: n, count: *count }.into());
            }
            offset += n as u32 * u32::from(*stride);
        }
        Ok(match self.base {
            VariablePlace::State(i) => VariablePlace::State(i + offset),
            VariablePlace::Local(i) => VariablePlace::Local(i + offset),
        })
    }

    /// All variables of the network that it may stand for.
    pub(crate) fn targets(&self, f: &mut dyn FnMut(u32)) {
        let VariablePlace::State(base) = self.base else { return };
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

fn some(n: Option<i64>) -> Result<i64, CodeEvalError> {
    n.ok_or(CodeEvalError::Eval(EvalError::Overflow))
}

impl ArithmeticOp {
    fn of(self, a: i64, b: i64) -> Result<i64, CodeEvalError> {
        match self {
            ArithmeticOp::Add => some(a.checked_add(b)),
            ArithmeticOp::Sub => some(a.checked_sub(b)),
            ArithmeticOp::Mul => some(a.checked_mul(b)),
            ArithmeticOp::Div | ArithmeticOp::Rem if b == 0 => Err(EvalError::DivisionByZero.into()),
            ArithmeticOp::Div => some(a.checked_div(b)),
            ArithmeticOp::Rem => some(a.checked_rem(b)),
            ArithmeticOp::Min => Ok(a.min(b)),
            ArithmeticOp::Max => Ok(a.max(b)),
        }
    }
}

impl CompiledExpr {
    pub(crate) fn eval(&self, env: &mut CodeEvalContext) -> Result<i64, CodeEvalError> {
        Ok(match self {
            CompiledExpr::Const(n) => *n,
            CompiledExpr::Var(i) => env.state[*i as usize],
            CompiledExpr::Local(i) => env.stack[env.base + *i as usize],
            CompiledExpr::VarConst(op, i, n) => i64::from(op.holds(env.state[*i as usize], *n)),
            CompiledExpr::VarVar(op, i, j) => {
                i64::from(op.holds(env.state[*i as usize], env.state[*j as usize]))
            }
            CompiledExpr::Compare(op, ab) => {
                let a = ab.0.eval(env)?;
                i64::from(op.holds(a, ab.1.eval(env)?))
            }
            CompiledExpr::Arith(op, ab) => {
                let a = ab.0.eval(env)?;
                return op.of(a, ab.1.eval(env)?);
            }
            CompiledExpr::Not(a) => i64::from(a.eval(env)? == 0),
            CompiledExpr::Neg(a) => return some(a.eval(env)?.checked_neg()),
            CompiledExpr::Abs(a) => return some(a.eval(env)?.checked_abs()),
            CompiledExpr::And(ab) => {
                if ab.0.eval(env)? == 0 {
                    0
                } else {
                    return ab.1.eval(env);
                }
            }
            CompiledExpr::Or(ab) => {
                if ab.0.eval(env)? == 0 {
                    return ab.1.eval(env);
                }
                1
            }
            CompiledExpr::If(cab) => {
                return if cab.0.eval(env)? != 0 { cab.1.eval(env) } else { cab.2.eval(env) };
            }
            CompiledExpr::Element(place) => {
                let at = place.resolve(env)?;
                env.get(at)
            }
            CompiledExpr::Apply(f, args) => return env.call(*f, args),
            CompiledExpr::Convert(a, _, table) => {
                let n = a.eval(env)?;
                usize::try_from(n).ok().and_then(|n| table.get(n)).copied().unwrap_or(-1)
            }
            CompiledExpr::Generic(g) => return g.eval(env),
        })
    }

    /// What a value that is out of range is called.
    pub(crate) fn value_of(&self, env: &mut CodeEvalContext, n: i64) -> Value {
        if let CompiledExpr::Convert(inner, from, _) = self
            && let Ok(n) = inner.eval(env)
            && let Some(value) = NumberType::Enum(*from).value(n, &[])
        {
            return value;
        }
        Value::Int(n)
    }

    pub(crate) fn constant(&self) -> Option<i64> {
        if let CompiledExpr::Const(n) = self { Some(*n) } else { None }
    }

    /// The least and greatest value that it can have, and whether it always has one. `locals` are the frame's ranges.
    pub(crate) fn span(&self, library: &CodeLibrary, locals: &[(i64, i64)]) -> (i64, i64, bool) {
        let of = |c: &CompiledExpr| c.span(library, locals);
        // Bounds of zones rely on it, and an interval that is too small would make them unsound: what is not known saturates outwards.
        match self {
            CompiledExpr::Const(n) => (*n, *n, true),
            CompiledExpr::Var(i) => {
                let (lo, hi) = library.ranges[*i as usize];
                (lo, hi, true)
            }
            CompiledExpr::Local(i) => {
                let known = locals.get(*i as usize);
                known.map_or((i64::MIN, i64::MAX, true), |&(lo, hi)| (lo, hi, true))
            }
            CompiledExpr::VarConst(..) | CompiledExpr::VarVar(..) => (0, 1, true),
            CompiledExpr::Compare(_, ab) | CompiledExpr::And(ab) | CompiledExpr::Or(ab) => {
                (0, 1, of(&ab.0).2 && of(&ab.1).2)
            }
            CompiledExpr::Not(a) => (0, 1, of(a).2),
            CompiledExpr::Neg(a) => {
                let (lo, hi, sure) = of(a);
                (hi.saturating_neg(), lo.saturating_neg(), sure && lo > i64::MIN)
            }
            CompiledExpr::Abs(a) => {
                let (lo, hi, sure) = of(a);
                let least = if lo <= 0 && hi >= 0 { 0 } else { lo.saturating_abs().min(hi.saturating_abs()) };
                (least, lo.saturating_abs().max(hi.saturating_abs()), sure && lo > i64::MIN)
            }
            CompiledExpr::Arith(op, ab) => op.span(of(&ab.0), of(&ab.1)),
            CompiledExpr::If(cab) => {
                let (c, a, b) = (of(&cab.0), of(&cab.1), of(&cab.2));
                (a.0.min(b.0), a.1.max(b.1), c.2 && a.2 && b.2)
            }
            CompiledExpr::Element(place) => {
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
            // A function may be endless, or have a fault: never sure.
            CompiledExpr::Apply(f, _) => {
                let result = library.routines[*f as usize].result;
                result.map_or((0, 0, false), |(_, lo, hi)| (lo, hi, false))
            }
            CompiledExpr::Convert(a, _, table) => {
                (-1, table.iter().copied().max().unwrap_or(-1), of(a).2 && !table.contains(&-1))
            }
            CompiledExpr::Generic(_) => (i64::MIN, i64::MAX, false),
        }
    }

    /// Calls `f` with each variable of the network that it may read.
    pub(crate) fn each_var(&self, library: &CodeLibrary, f: &mut dyn FnMut(u32)) {
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
            CompiledExpr::Const(_) | CompiledExpr::Local(_) => {}
            CompiledExpr::Var(i) | CompiledExpr::VarConst(_, i, _) => read(*i),
            CompiledExpr::VarVar(_, i, j) => {
                read(*i);
                read(*j);
            }
            CompiledExpr::Compare(_, ab)
            | CompiledExpr::Arith(_, ab)
            | CompiledExpr::And(ab)
            | CompiledExpr::Or(ab) => {
                ab.0.scan(read, called);
                ab.1.scan(read, called);
            }
            CompiledExpr::Not(a)
            | CompiledExpr::Neg(a)
            | CompiledExpr::Abs(a)
            | CompiledExpr::Convert(a, ..) => a.scan(read, called),
            CompiledExpr::If(cab) => {
                cab.0.scan(read, called);
                cab.1.scan(read, called);
                cab.2.scan(read, called);
            }
            CompiledExpr::Element(place) => {
                place.targets(read);
                place.indices.iter().for_each(|(at, ..)| at.scan(read, called));
            }
            CompiledExpr::Apply(routine, args) => {
                called(*routine);
                args.iter().for_each(|a| a.scan(read, called));
            }
            // Not looked into: it may read all that it could name.
            CompiledExpr::Generic(g) => {
                let located = (0..g.scope.located).map(|m| (VariablePlace::State(m as u32), NumberType::Int));
                for (at, _) in g.scope.vars.iter().copied().chain(located) {
                    if let VariablePlace::State(i) = at {
                        read(i);
                    }
                }
            }
        }
    }
}

impl CodeLibrary {
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
        body: &[CompiledStatement],
        read: &mut dyn FnMut(u32),
        written: &mut dyn FnMut(u32),
        called: &mut dyn FnMut(u32),
    ) {
        for i in body {
            match i {
                CompiledStatement::Assign(place, value) => {
                    value.scan(read, called);
                    place.indices.iter().for_each(|(at, ..)| at.scan(read, called));
                    place.targets(written);
                }
                CompiledStatement::Call(routine, args) => {
                    called(*routine);
                    args.iter().for_each(|a| a.scan(read, called));
                }
                CompiledStatement::If(c, then, otherwise) => {
                    c.scan(read, called);
                    self.scan(then, read, written, called);
                    self.scan(otherwise, read, written, called);
                }
                CompiledStatement::While(c, body) => {
                    c.scan(read, called);
                    self.scan(body, read, written, called);
                }
                CompiledStatement::For(_, lo, hi, body) => {
                    lo.scan(read, called);
                    hi.scan(read, called);
                    self.scan(body, read, written, called);
                }
                CompiledStatement::Return(value) => value.iter().for_each(|v| v.scan(read, called)),
            }
        }
    }
}

impl CompiledLvalue {
    pub(crate) fn always_there(&self, library: &CodeLibrary, locals: &[(i64, i64)]) -> bool {
        self.indices.iter().all(|(at, count, _)| {
            let (lo, hi, sure) = at.span(library, locals);
            sure && lo >= 0 && hi < i64::from(*count)
        })
    }
}

impl ArithmeticOp {
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
            ArithmeticOp::Add => corners(&i64::checked_add),
            ArithmeticOp::Sub => corners(&i64::checked_sub),
            ArithmeticOp::Mul => corners(&i64::checked_mul),
            // Towards zero it comes no farther from zero than the dividend. Only `i64::MIN / -1` would.
            ArithmeticOp::Div => {
                let most = a.saturating_abs().max(b.saturating_abs());
                (most.saturating_neg(), most, x && y && (c > 0 || d < 0) && a > i64::MIN)
            }
            ArithmeticOp::Rem => {
                let most = c.saturating_abs().max(d.saturating_abs()).saturating_sub(1).max(0);
                let lo = if a >= 0 { 0 } else { most.saturating_neg() };
                (lo, most, x && y && (c > 0 || d < 0))
            }
            ArithmeticOp::Min => (a.min(c), b.min(d), x && y),
            ArithmeticOp::Max => (a.max(c), b.max(d), x && y),
        }
    }
}

// ── Values, for the rest ──

struct CodeValueScope<'a, 'e> {
    env: RefCell<&'a mut CodeEvalContext<'e>>,
    scope: &'a VariableScope,
}

impl EvalScope for CodeValueScope<'_, '_> {
    fn var(&self, slot: u16) -> Option<Value> {
        let (at, ty) = self.scope.variable(slot)?;
        // While a function that this expression calls runs, nobody asks this scope: the function's code has the environment itself.
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
        let args: Option<Vec<CompiledExpr>> =
            args.iter().map(|v| number(v).map(CompiledExpr::Const)).collect();
        let n = env.call(routine, &args.ok_or(EvalError::Type)?).map_err(|f| match f {
            CodeEvalError::Eval(e) => e,
            CodeEvalError::Range { value, .. } => EvalError::Range(value),
            CodeEvalError::Argument { .. } | CodeEvalError::Negative { .. } => EvalError::Type,
        })?;
        ty.value(n, &library.constants).ok_or(EvalError::Type)
    }
}

impl GenericExpr {
    fn eval(&self, env: &mut CodeEvalContext) -> Result<i64, CodeEvalError> {
        let scope = CodeValueScope { env: RefCell::new(env), scope: &self.scope };
        let value = self.expr.eval_in(&scope)?;
        self.want.number(value).ok_or(CodeEvalError::Eval(EvalError::Type))
    }
}

// ── Compilation ──

impl CodeLibrary {
    pub(crate) fn routine(&self, function: FunctionId, member: Option<u16>) -> Option<u32> {
        // A function of the automaton's own is over its variables; one that all share has no member.
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
    pub(crate) fn compile(&self, names: &VariableScope, e: &Expr, want: NumberType) -> CompiledExpr {
        let hint = if let NumberType::Enum(e) = want { Some(e) } else { None };
        match self.typed(names, e, hint) {
            Some((code, ty)) if ty == want => code,
            Some((code, NumberType::Enum(from))) if hint.is_some() && self.total(from, hint) => {
                convert(code, from, hint)
            }
            Some(_) | None => {
                CompiledExpr::Generic(Box::new(GenericExpr { expr: e.clone(), want, scope: names.clone() }))
            }
        }
    }

    /// Whether each symbol of the one is one of the other.
    fn total(&self, from: Enumeration, to: Option<Enumeration>) -> bool {
        from.values().iter().all(|s| to.is_some_and(|t| t.index_of(*s).is_some()))
    }

    /// `None`: it has no form in whole numbers.
    pub(crate) fn typed(
        &self,
        names: &VariableScope,
        e: &Expr,
        hint: Option<Enumeration>,
    ) -> Option<(CompiledExpr, NumberType)> {
        match e {
            Expr::Const(Value::Bool(b)) => Some((CompiledExpr::Const(i64::from(*b)), NumberType::Bool)),
            Expr::Const(Value::Int(n)) => Some((CompiledExpr::Const(*n), NumberType::Int)),
            Expr::Const(Value::Symbol(s)) => {
                let e = hint?;
                Some((CompiledExpr::Const(e.index_of(*s)? as i64), NumberType::Enum(e)))
            }
            Expr::Const(Value::Float(_) | Value::Text(_) | Value::List(_)) | Expr::List(..) => None,
            Expr::Var(i) => match names.variable(*i)? {
                (_, NumberType::Constant) => None,
                (VariablePlace::State(i), ty) => Some((CompiledExpr::Var(i), ty)),
                (VariablePlace::Local(i), ty) => Some((CompiledExpr::Local(i), ty)),
            },
            Expr::Unary(op, a) => {
                let (code, ty) = self.typed(names, a, None)?;
                match (op, ty) {
                    (UnaryOp::Not, NumberType::Bool) => {
                        Some((fold(CompiledExpr::Not(Box::new(code))), NumberType::Bool))
                    }
                    (UnaryOp::Neg, NumberType::Int) => {
                        Some((fold(CompiledExpr::Neg(Box::new(code))), NumberType::Int))
                    }
                    (UnaryOp::Not | UnaryOp::Neg, _) => None,
                }
            }
            Expr::Binary(op, a, b) => self.binary(names, *op, a, b),
            Expr::If(c, a, b) => {
                let (c, NumberType::Bool) = self.typed(names, c, None)? else { return None };
                let (a, b, ty) = self.both(names, a, b, hint)?;
                Some((CompiledExpr::If(Box::new((c, a, b))), ty))
            }
            Expr::Call(f, args) => self.function(names, *f, args),
            Expr::Element(place) => {
                let reach = self.reach(names, place)?;
                let ty = names.vars.get(usize::from(place.slot))?.1;
                let code = match (reach.indices.is_empty(), reach.base) {
                    (true, VariablePlace::State(i)) => CompiledExpr::Var(i),
                    (true, VariablePlace::Local(i)) => CompiledExpr::Local(i),
                    (false, _) => CompiledExpr::Element(Box::new(reach)),
                };
                Some((code, ty))
            }
            Expr::Apply(f, args) => {
                let routine = self.routine(*f, names.member)?;
                let (ty, ..) = self.routines[routine as usize].result?;
                Some((CompiledExpr::Apply(routine, self.arguments(names, routine, args)?), ty))
            }
        }
    }

    /// Both of one type.
    fn both(
        &self,
        names: &VariableScope,
        a: &Expr,
        b: &Expr,
        hint: Option<Enumeration>,
    ) -> Option<(CompiledExpr, CompiledExpr, NumberType)> {
        let of = |e, hint| self.typed(names, e, hint);
        let kind = |t: NumberType| if let NumberType::Enum(e) = t { Some(e) } else { None };
        // A symbol alone says not of which enumeration it is: whichever side knows tells the other.
        let ((a, x), (b, y)) = match of(a, hint) {
            Some((code, ty)) => ((code, ty), of(b, kind(ty).or(hint))?),
            None => {
                let (right, ty) = of(b, hint)?;
                (of(a, Some(kind(ty)?))?, (right, ty))
            }
        };
        if x == y { Some((a, b, x)) } else { None }
    }

    fn function(
        &self,
        names: &VariableScope,
        f: NumberFunction,
        args: &[Expr],
    ) -> Option<(CompiledExpr, NumberType)> {
        let numbers: Option<Vec<CompiledExpr>> = args
            .iter()
            .map(|a| self.typed(names, a, None).and_then(|(c, ty)| (ty == NumberType::Int).then_some(c)))
            .collect();
        let mut numbers = numbers?.into_iter();
        let code = match (f, numbers.next(), numbers.next(), numbers.next()) {
            (NumberFunction::Abs, Some(a), None, None) => CompiledExpr::Abs(Box::new(a)),
            (NumberFunction::Min, Some(a), Some(b), None) => {
                CompiledExpr::Arith(ArithmeticOp::Min, Box::new((a, b)))
            }
            (NumberFunction::Max, Some(a), Some(b), None) => {
                CompiledExpr::Arith(ArithmeticOp::Max, Box::new((a, b)))
            }
            (NumberFunction::Abs | NumberFunction::Min | NumberFunction::Max | NumberFunction::Norm, ..) => {
                return None;
            }
        };
        Some((fold(code), NumberType::Int))
    }

    fn binary(
        &self,
        names: &VariableScope,
        op: BinaryOp,
        a: &Expr,
        b: &Expr,
    ) -> Option<(CompiledExpr, NumberType)> {
        let (a, b, ty) = self.both(names, a, b, None)?;
        let both = Box::new((a, b));
        Some(match (numeric(op), ty) {
            (NumericOp::And, NumberType::Bool) => (CompiledExpr::And(both), NumberType::Bool),
            (NumericOp::Or, NumberType::Bool) => (CompiledExpr::Or(both), NumberType::Bool),
            (NumericOp::Compare(how), _)
                if ty == NumberType::Int || how.is_equality() && ty != NumberType::Constant =>
            {
                (comparison(how, both.0, both.1), NumberType::Bool)
            }
            (NumericOp::Arith(op), NumberType::Int) => (fold(CompiledExpr::Arith(op, both)), NumberType::Int),
            (NumericOp::And | NumericOp::Or | NumericOp::Compare(_) | NumericOp::Arith(_), _) => return None,
        })
    }

    pub(crate) fn reach(&self, names: &VariableScope, place: &Lvalue) -> Option<CompiledLvalue> {
        let base = names.vars.get(usize::from(place.slot))?.0;
        let index = |i: &ArrayIndex| Some((self.compile(names, &i.at, NumberType::Int), i.count, i.stride));
        let indices = place.indices.iter().map(index).collect::<Option<Vec<_>>>()?;
        // The last element has to be a variable, too: from here on a place is only ever reached by indices within their counts.
        let last: usize =
            place.indices.iter().map(|i| usize::from(i.count.max(1) - 1) * usize::from(i.stride)).sum();
        names.vars.get(usize::from(place.slot) + last)?;
        if indices.iter().all(|(at, count, _)| at.constant().is_some_and(|n| n >= 0 && n < i64::from(*count)))
        {
            let offset: i64 =
                indices.iter().map(|(at, _, stride)| at.constant().unwrap_or(0) * i64::from(*stride)).sum();
            let base = match base {
                VariablePlace::State(i) => VariablePlace::State(i + offset as u32),
                VariablePlace::Local(i) => VariablePlace::Local(i + offset as u32),
            };
            return Some(CompiledLvalue { base, indices: Box::default() });
        }
        Some(CompiledLvalue { base, indices: indices.into() })
    }

    /// Arguments for a routine's parameters.
    pub(crate) fn arguments(
        &self,
        names: &VariableScope,
        routine: u32,
        args: &[Expr],
    ) -> Option<Box<[CompiledExpr]>> {
        let r = &self.routines[routine as usize];
        if args.len() != r.params.len() {
            return None;
        }
        Some(args.iter().zip(&r.types).map(|(a, &ty)| self.compile(names, a, ty)).collect())
    }
}

fn convert(code: CompiledExpr, from: Enumeration, to: Option<Enumeration>) -> CompiledExpr {
    let index = |s| to.and_then(|t| t.index_of(s)).map_or(-1, |n| n as i64);
    CompiledExpr::Convert(Box::new(code), from, from.values().iter().map(|s| index(*s)).collect())
}

fn comparison(op: NumberComparison, a: CompiledExpr, b: CompiledExpr) -> CompiledExpr {
    let turned = match op {
        NumberComparison::Eq | NumberComparison::Ne => op,
        NumberComparison::Lt => NumberComparison::Gt,
        NumberComparison::Le => NumberComparison::Ge,
        NumberComparison::Gt => NumberComparison::Lt,
        NumberComparison::Ge => NumberComparison::Le,
    };
    match (a, b) {
        (CompiledExpr::Const(a), CompiledExpr::Const(b)) => CompiledExpr::Const(i64::from(op.holds(a, b))),
        (CompiledExpr::Var(i), CompiledExpr::Const(n)) => CompiledExpr::VarConst(op, i, n),
        (CompiledExpr::Const(n), CompiledExpr::Var(i)) => CompiledExpr::VarConst(turned, i, n),
        (CompiledExpr::Var(i), CompiledExpr::Var(j)) => CompiledExpr::VarVar(op, i, j),
        (a, b) => CompiledExpr::Compare(op, Box::new((a, b))),
    }
}

/// Of constants: the value, if it has one.
#[expect(clippy::wildcard_enum_match_arm, reason = "what is not folded here is folded where it is made")]
fn fold(code: CompiledExpr) -> CompiledExpr {
    // What has no value (`1 / 0`) stays as it is: it is a fault when, and if, it is evaluated.
    let value = match &code {
        CompiledExpr::Not(a) => a.constant().map(|n| i64::from(n == 0)),
        CompiledExpr::Neg(a) => a.constant().and_then(i64::checked_neg),
        CompiledExpr::Abs(a) => a.constant().and_then(i64::checked_abs),
        CompiledExpr::Arith(op, ab) => {
            ab.0.constant().zip(ab.1.constant()).and_then(|(a, b)| op.of(a, b).ok())
        }
        _ => None,
    };
    value.map_or(code, CompiledExpr::Const)
}
