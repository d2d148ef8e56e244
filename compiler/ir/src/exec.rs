//! The functions of automata, executed: the one meaning that every interpreter of a [`Program`] shares.
//!
//! A [`MemoryView`] evaluates expressions and assigns lvalues over a [`VariableMemory`] (the variables that an automaton knows) and binders
//! (selects and received arguments). Everything is evaluated from left to right: arguments in their order, the indices of a
//! lvalue before the value that is assigned to it, the bounds of a loop before its first round.
//!
//! A call from outside has a budget of [`STEPS`] statements: each statement that is executed counts one, and so does each round
//! of a loop. Calls within calls draw on the same budget and may be [`DEPTH`] deep, the outer one counted.

use std::cell::{Cell, RefCell};

use crate::{
    Program,
    expr::{EvalError, EvalScope, Expr, Lvalue},
    ta::{AutomatonFunction, AutomatonId, AutomatonVar, FunctionId, FunctionStatement},
    value::Value,
};

/// The statements that one call from outside may execute.
pub const STEPS: u32 = 1_000_000;

/// The calls that may be open at once.
pub const DEPTH: u32 = 100;

/// Variables outside functions, as one automaton counts them: the program's shared ones, then its own.
pub trait VariableMemory {
    /// The value of a variable; `None`: there is no such variable.
    fn read(&self, slot: u16) -> Option<Value>;

    /// Gives a variable a value; [`fit`] checks it.
    ///
    /// # Errors
    /// `Outside`, if the value is outside the variable's range; `Type`.
    fn write(&mut self, slot: u16, value: Value) -> Result<(), EvalError>;
}

/// The number that a variable keeps for a value.
///
/// # Errors
/// `Outside` if it is not in the variable's range, with the slot that is given; `Type` if the value is of another type.
pub fn fit(var: &AutomatonVar, slot: u16, value: Value) -> Result<i64, EvalError> {
    let n = var.number(value).ok_or(EvalError::Type)?;
    if (var.lo..=var.hi).contains(&n) { Ok(n) } else { Err(EvalError::Outside { slot, value: n }) }
}

/// The functions of a program, with where the variables of each are.
#[derive(Clone, Debug)]
pub struct FunctionTable<'a> {
    list: &'a [AutomatonFunction],
    shared: u16,
    /// The number of each automaton's own variables.
    own: Vec<u16>,
}

impl<'a> FunctionTable<'a> {
    #[must_use]
    pub fn new(program: &'a Program) -> Self {
        let own = program.automata.iter().map(|a| count(a.vars.len())).collect();
        Self { list: &program.functions, shared: count(program.shared.len()), own }
    }

    fn get(&self, id: FunctionId) -> Option<&'a AutomatonFunction> {
        self.list.get(usize::from(id.0))
    }

    /// The first slot of a function's parameters: it follows the variables that the function knows.
    fn base(&self, owner: Option<AutomatonId>) -> u16 {
        self.shared + owner.and_then(|a| self.own.get(usize::from(a.0))).copied().unwrap_or(0)
    }
}

fn count(n: usize) -> u16 {
    u16::try_from(n).unwrap_or(u16::MAX)
}

/// What expressions and updates outside functions see: a memory, and binders after its variables.
///
/// An owner's function may only be called where the memory is that owner's; a function without owner reads shared variables
/// alone, which come first in every memory.
pub struct MemoryView<'a> {
    functions: &'a FunctionTable<'a>,
    memory: FunctionStore<'a>,
    /// The number of variables in memory: the first binder's slot.
    base: u16,
    binders: &'a [Value],
}

enum FunctionStore<'a> {
    Shut(&'a dyn VariableMemory),
    Open(RefCell<&'a mut dyn VariableMemory>),
}

impl<'a> MemoryView<'a> {
    /// For guards, invariants, arguments and queries: nothing can be assigned.
    #[must_use]
    pub fn new(
        functions: &'a FunctionTable<'a>,
        memory: &'a dyn VariableMemory,
        base: u16,
        binders: &'a [Value],
    ) -> Self {
        Self { functions, memory: FunctionStore::Shut(memory), base, binders }
    }

    /// For updates.
    #[must_use]
    pub fn open(
        functions: &'a FunctionTable<'a>,
        memory: &'a mut dyn VariableMemory,
        base: u16,
        binders: &'a [Value],
    ) -> Self {
        Self { functions, memory: FunctionStore::Open(RefCell::new(memory)), base, binders }
    }

    /// The value of an expression. A function in it may assign variables, if the view is open.
    ///
    /// # Errors
    /// See [`EvalError`].
    pub fn eval(&self, e: &Expr) -> Result<Value, EvalError> {
        e.eval_in(self)
    }

    /// Assigns a variable. The indices of the lvalue come before the value.
    ///
    /// # Errors
    /// See [`EvalError`]; `Type` if the view is not open, or the lvalue is a binder.
    pub fn assign(&self, place: &Lvalue, value: &Expr) -> Result<(), EvalError> {
        let slot = place.resolve(self)?;
        let value = value.eval_in(self)?;
        self.write(slot, value)
    }

    /// Calls a function for its effect. A value that it returns is dropped.
    ///
    /// # Errors
    /// See [`EvalError`].
    pub fn call(&self, function: FunctionId, args: &[Expr]) -> Result<(), EvalError> {
        let args: Vec<Value> = args.iter().map(|a| a.eval_in(self)).collect::<Result<_, _>>()?;
        StepBudget::full().invoke(self, function, &args).map(drop)
    }

    fn read(&self, slot: u16) -> Option<Value> {
        match &self.memory {
            FunctionStore::Shut(memory) => memory.read(slot),
            FunctionStore::Open(memory) => memory.borrow().read(slot),
        }
    }

    fn write(&self, slot: u16, value: Value) -> Result<(), EvalError> {
        match &self.memory {
            FunctionStore::Open(memory) if slot < self.base => memory.borrow_mut().write(slot, value),
            FunctionStore::Open(_) | FunctionStore::Shut(_) => Err(EvalError::Type),
        }
    }
}

impl EvalScope for MemoryView<'_> {
    fn var(&self, slot: u16) -> Option<Value> {
        match slot.checked_sub(self.base) {
            None => self.read(slot),
            Some(binder) => self.binders.get(usize::from(binder)).copied(),
        }
    }

    fn apply(&self, function: FunctionId, args: &[Value]) -> Result<Value, EvalError> {
        StepBudget::full().invoke(self, function, args)?.ok_or(EvalError::Type)
    }
}

/// What is left of a call from outside.
struct StepBudget {
    steps: Cell<u32>,
    depth: Cell<u32>,
}

impl StepBudget {
    fn full() -> Self {
        Self { steps: Cell::new(STEPS), depth: Cell::new(DEPTH) }
    }

    fn step(&self) -> Result<(), EvalError> {
        let left = self.steps.get().checked_sub(1).ok_or(EvalError::Endless)?;
        self.steps.set(left);
        Ok(())
    }

    /// The function's value, if it has one.
    fn invoke(
        &self,
        view: &MemoryView<'_>,
        id: FunctionId,
        args: &[Value],
    ) -> Result<Option<Value>, EvalError> {
        let function = view.functions.get(id).ok_or(EvalError::Type)?;
        if args.len() != function.params.len() {
            return Err(EvalError::Type);
        }
        let depth = self.depth.get().checked_sub(1).ok_or(EvalError::Endless)?;
        let mut values = Vec::with_capacity(args.len() + function.locals.len());
        for (param, arg) in function.params.iter().zip(args) {
            values.push(within(param, *arg)?);
        }
        for local in &function.locals {
            values.push(local.value(local.init).ok_or(EvalError::Type)?);
        }
        let base = view.functions.base(function.owner);
        self.depth.set(depth);
        let flow = CallFrame { budget: self, view, function, base, values }.block(&function.body);
        self.depth.set(depth + 1);
        match (flow?, &function.result) {
            (ControlFlow::Return(Some(value)), Some(result)) => within(result, value).map(Some),
            (ControlFlow::Return(None) | ControlFlow::On, None) => Ok(None),
            (ControlFlow::Return(_) | ControlFlow::On, _) => Err(EvalError::Type),
        }
    }
}

/// The value, if it is in the range of a variable of a function.
fn within(var: &AutomatonVar, value: Value) -> Result<Value, EvalError> {
    match fit(var, 0, value) {
        Ok(_) => Ok(value),
        Err(EvalError::Outside { value, .. }) => Err(EvalError::Range(value)),
        Err(e) => Err(e),
    }
}

enum ControlFlow {
    On,
    Return(Option<Value>),
}

/// One call.
struct CallFrame<'a, 'v> {
    budget: &'a StepBudget,
    view: &'a MemoryView<'v>,
    function: &'a AutomatonFunction,
    base: u16,
    /// Of the parameters, then of the locals.
    values: Vec<Value>,
}

impl EvalScope for CallFrame<'_, '_> {
    fn var(&self, slot: u16) -> Option<Value> {
        match slot.checked_sub(self.base) {
            None => self.view.read(slot),
            Some(at) => self.values.get(usize::from(at)).copied(),
        }
    }

    fn apply(&self, function: FunctionId, args: &[Value]) -> Result<Value, EvalError> {
        self.budget.invoke(self.view, function, args)?.ok_or(EvalError::Type)
    }
}

impl CallFrame<'_, '_> {
    fn block(&mut self, statements: &[FunctionStatement]) -> Result<ControlFlow, EvalError> {
        for statement in statements {
            if let ControlFlow::Return(value) = self.statement(statement)? {
                return Ok(ControlFlow::Return(value));
            }
        }
        Ok(ControlFlow::On)
    }

    fn statement(&mut self, statement: &FunctionStatement) -> Result<ControlFlow, EvalError> {
        self.budget.step()?;
        match statement {
            FunctionStatement::Assign { place, value } => {
                let slot = place.resolve(self)?;
                let value = value.eval_in(self)?;
                self.write(slot, value)?;
                Ok(ControlFlow::On)
            }
            FunctionStatement::Call { function, args } => {
                let args: Vec<Value> = args.iter().map(|a| a.eval_in(self)).collect::<Result<_, _>>()?;
                self.budget.invoke(self.view, *function, &args)?;
                Ok(ControlFlow::On)
            }
            FunctionStatement::If { condition, then, otherwise } => {
                let holds = self.holds(condition)?;
                self.block(if holds { then } else { otherwise })
            }
            FunctionStatement::While { condition, body } => {
                while self.holds(condition)? {
                    self.budget.step()?;
                    if let ControlFlow::Return(value) = self.block(body)? {
                        return Ok(ControlFlow::Return(value));
                    }
                }
                Ok(ControlFlow::On)
            }
            FunctionStatement::For { slot, lo, hi, body } => self.each(*slot, lo, hi, body),
            FunctionStatement::Return(value) => {
                Ok(ControlFlow::Return(value.as_ref().map(|v| v.eval_in(self)).transpose()?))
            }
        }
    }

    fn each(
        &mut self,
        slot: u16,
        lo: &Expr,
        hi: &Expr,
        body: &[FunctionStatement],
    ) -> Result<ControlFlow, EvalError> {
        let bound = |e: &Expr| e.eval_in(self)?.as_int().ok_or(EvalError::Type);
        let (lo, hi) = (bound(lo)?, bound(hi)?);
        for n in lo..=hi {
            self.budget.step()?;
            self.write(slot, Value::Int(n))?;
            if let ControlFlow::Return(value) = self.block(body)? {
                return Ok(ControlFlow::Return(value));
            }
        }
        Ok(ControlFlow::On)
    }

    fn holds(&self, condition: &Expr) -> Result<bool, EvalError> {
        condition.eval_in(self)?.as_bool().ok_or(EvalError::Type)
    }

    fn write(&mut self, slot: u16, value: Value) -> Result<(), EvalError> {
        let Some(at) = slot.checked_sub(self.base).map(usize::from) else {
            return self.view.write(slot, value);
        };
        let params = &self.function.params;
        let var = params.get(at).or_else(|| self.function.locals.get(at - params.len()));
        let value = within(var.ok_or(EvalError::Type)?, value)?;
        self.values[at] = value;
        Ok(())
    }
}

#[cfg(test)]
mod tests;
