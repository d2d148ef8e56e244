//! Variables, expressions and functions, by the pages: every statement one after the other.

use std::cell::{Cell, RefCell};

use hrdsl_ir::{
    Expr, Program, Value,
    expr::{EvalError, EvalScope, Lvalue},
    ta::{AutomatonFunction, AutomatonId, AutomatonVar, FunctionId, FunctionStatement, TimeSum},
};

use super::{Fault, Stop};

const STATEMENTS: u32 = 1_000_000;
const DEPTH: u32 = 100;

/// Where the variables of a network are: the shared ones, then each automaton's own.
pub struct Layout<'p> {
    pub p: &'p Program,
    pub members: Vec<usize>,
    /// All variables of the network.
    pub vars: Vec<&'p AutomatonVar>,
    /// The first own variable of each member.
    first: Vec<usize>,
}

impl<'p> Layout<'p> {
    pub fn new(p: &'p Program, members: &[AutomatonId]) -> Self {
        let members: Vec<usize> = members.iter().map(|a| usize::from(a.0)).collect();
        let mut vars: Vec<&AutomatonVar> = p.shared.iter().collect();
        let mut first = Vec::new();
        for &a in &members {
            first.push(vars.len());
            vars.extend(&p.automata[a].vars);
        }
        Self { p, members, vars, first }
    }

    fn own(&self, member: usize) -> usize {
        self.p.automata[self.members[member]].vars.len()
    }

    /// What a function's variables are, besides the shared ones and its parameters.
    fn owner(&self, f: &AutomatonFunction) -> Option<usize> {
        f.owner.and_then(|o| self.members.iter().position(|&m| m == usize::from(o.0)))
    }
}

/// What comes after the variables of the network in an expression.
#[derive(Clone, Copy)]
enum Rest<'a> {
    Binders(&'a [Value]),
    Locals(&'a AutomatonFunction, &'a RefCell<Vec<i64>>),
}

/// Where an expression stands.
#[derive(Clone, Copy)]
pub struct Here<'a> {
    layout: &'a Layout<'a>,
    data: &'a RefCell<Vec<i64>>,
    /// The automaton whose variables are known; none: the shared ones alone, or all, in a query.
    member: Option<usize>,
    all: bool,
    rest: Rest<'a>,
    statements: &'a Cell<u32>,
    depth: u32,
}

enum Slot {
    Network(usize),
    Rest(usize),
}

enum Flow {
    On,
    Back(Option<Value>),
}

impl<'a> Here<'a> {
    pub fn of_member(
        layout: &'a Layout<'a>,
        data: &'a RefCell<Vec<i64>>,
        member: usize,
        binders: &'a [Value],
        statements: &'a Cell<u32>,
    ) -> Self {
        let rest = Rest::Binders(binders);
        Self { layout, data, member: Some(member), all: false, rest, statements, depth: 0 }
    }

    /// Of a query: all variables of the network, in order.
    pub fn of_query(layout: &'a Layout<'a>, data: &'a RefCell<Vec<i64>>, statements: &'a Cell<u32>) -> Self {
        Self { layout, data, member: None, all: true, rest: Rest::Binders(&[]), statements, depth: 0 }
    }

    fn place(&self, slot: u16) -> Slot {
        let (slot, shared) = (usize::from(slot), self.layout.p.shared.len());
        if self.all || slot < shared {
            return Slot::Network(slot);
        }
        let own = self.member.map_or(0, |m| self.layout.own(m));
        match self.member {
            Some(m) if slot - shared < own => Slot::Network(self.layout.first[m] + slot - shared),
            Some(_) | None => Slot::Rest(slot - shared - own),
        }
    }

    pub fn value(&self, e: &Expr) -> Result<Value, Stop> {
        Ok(e.eval_in(self)?)
    }

    pub fn truth(&self, e: &Expr) -> Result<bool, Stop> {
        Ok(e.eval_in(self)?.as_bool().ok_or(EvalError::Type)?)
    }

    /// In nanoseconds.
    pub fn time(&self, t: &TimeSum) -> Result<i64, Stop> {
        let mut sum = i128::from(t.nanos);
        for term in &t.terms {
            let n = term.value.eval_in(self)?.as_int().ok_or(EvalError::Type)?;
            sum += i128::from(term.factor) * i128::from(n);
        }
        i64::try_from(sum).map_err(|_| EvalError::Overflow.into())
    }

    /// The indices of the place first, then the value.
    pub fn assign(&self, place: &Lvalue, value: &Expr) -> Result<(), Stop> {
        let slot = place.resolve(self)?;
        let value = value.eval_in(self)?;
        match self.place(slot) {
            Slot::Network(at) => {
                let var = self.layout.vars[at];
                let n = var.number(value).ok_or(EvalError::Type)?;
                if n < var.lo || n > var.hi {
                    return Err(Stop::Fault(Fault::Range { slot: at, value: n }));
                }
                self.data.borrow_mut()[at] = n;
            }
            Slot::Rest(at) => match self.rest {
                Rest::Locals(f, locals) => {
                    let n = within(local(f, at), value)?;
                    locals.borrow_mut()[at] = n;
                }
                Rest::Binders(_) => return Err(EvalError::Type.into()),
            },
        }
        Ok(())
    }

    pub fn call(&self, function: FunctionId, args: &[Expr]) -> Result<Option<Value>, Stop> {
        let args: Vec<Value> = args.iter().map(|a| a.eval_in(self)).collect::<Result<_, _>>()?;
        self.enter(function, &args)
    }

    fn enter(&self, function: FunctionId, args: &[Value]) -> Result<Option<Value>, Stop> {
        let f = &self.layout.p.functions[usize::from(function.0)];
        if self.depth >= DEPTH {
            return Err(EvalError::Endless.into());
        }
        if self.depth == 0 {
            self.statements.set(0);
        }
        let mut values = Vec::new();
        for (var, value) in f.params.iter().zip(args) {
            values.push(within(var, *value)?);
        }
        values.extend(f.locals.iter().map(|l| l.init));
        let locals = RefCell::new(values);
        let (member, rest) = (self.layout.owner(f), Rest::Locals(f, &locals));
        let inside = Here { member, all: false, rest, depth: self.depth + 1, ..*self };
        match inside.run(&f.body)? {
            Flow::Back(Some(value)) => {
                if let Some(result) = &f.result {
                    within(result, value)?;
                }
                Ok(Some(value))
            }
            Flow::On | Flow::Back(None) => Ok(None),
        }
    }

    fn count(&self) -> Result<(), Stop> {
        self.statements.set(self.statements.get() + 1);
        if self.statements.get() > STATEMENTS { Err(EvalError::Endless.into()) } else { Ok(()) }
    }

    fn run(&self, body: &[FunctionStatement]) -> Result<Flow, Stop> {
        for statement in body {
            self.count()?;
            if let back @ Flow::Back(_) = self.step(statement)? {
                return Ok(back);
            }
        }
        Ok(Flow::On)
    }

    fn step(&self, statement: &FunctionStatement) -> Result<Flow, Stop> {
        match statement {
            FunctionStatement::Assign { place, value } => self.assign(place, value)?,
            FunctionStatement::Call { function, args } => {
                self.call(*function, args)?;
            }
            FunctionStatement::If { condition, then, otherwise } => {
                return self.run(if self.truth(condition)? { then } else { otherwise });
            }
            FunctionStatement::While { condition, body } => {
                while self.truth(condition)? {
                    self.count()?;
                    if let back @ Flow::Back(_) = self.run(body)? {
                        return Ok(back);
                    }
                }
            }
            FunctionStatement::For { slot, lo, hi, body } => {
                let (lo, hi) = (self.int(lo)?, self.int(hi)?);
                for n in lo..=hi {
                    self.count()?;
                    self.assign(&Lvalue::slot(*slot), &Expr::int(n))?;
                    if let back @ Flow::Back(_) = self.run(body)? {
                        return Ok(back);
                    }
                }
            }
            FunctionStatement::Return(value) => {
                return Ok(Flow::Back(value.as_ref().map(|v| v.eval_in(self)).transpose()?));
            }
        }
        Ok(Flow::On)
    }

    fn int(&self, e: &Expr) -> Result<i64, Stop> {
        Ok(e.eval_in(self)?.as_int().ok_or(EvalError::Type)?)
    }
}

fn local(f: &AutomatonFunction, at: usize) -> &AutomatonVar {
    f.params.iter().chain(&f.locals).nth(at).expect("the slot is a parameter or a local")
}

/// The number kept for a value, if it is one of the variable's.
fn within(var: &AutomatonVar, value: Value) -> Result<i64, EvalError> {
    let n = var.number(value).ok_or(EvalError::Type)?;
    if n < var.lo || n > var.hi { Err(EvalError::Range(n)) } else { Ok(n) }
}

impl EvalScope for Here<'_> {
    fn var(&self, slot: u16) -> Option<Value> {
        match self.place(slot) {
            Slot::Network(at) => {
                let n = *self.data.borrow().get(at)?;
                self.layout.vars[at].value(n)
            }
            Slot::Rest(at) => match self.rest {
                Rest::Binders(binders) => binders.get(at).copied(),
                Rest::Locals(f, locals) => local(f, at).value(*locals.borrow().get(at)?),
            },
        }
    }

    fn apply(&self, function: FunctionId, args: &[Value]) -> Result<Value, EvalError> {
        match self.enter(function, args) {
            Ok(Some(value)) => Ok(value),
            Ok(None) => Err(EvalError::Type),
            Err(Stop::Fault(Fault::Value(error))) => Err(error),
            // A fault is a fault, whatever its kind.
            Err(Stop::Fault(Fault::Range { value, .. })) => Err(EvalError::Range(value)),
            Err(Stop::Fault(Fault::Argument(_) | Fault::Clock(_)) | Stop::Outside(_)) => Err(EvalError::Type),
        }
    }
}
