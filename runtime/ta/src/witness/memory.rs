//! The variables that an automaton knows, as the evaluation of expressions sees them.

use hrdsl_ir::{
    Program, Value,
    exec::{self, VariableMemory},
    expr::EvalError,
    ta::AutomatonVar,
};

/// The variables that an automaton knows.
pub(super) struct AutomatonScope<'m> {
    pub program: &'m Program,
    pub vars: &'m [AutomatonVar],
    pub shared: &'m [i64],
    pub own: &'m [i64],
}

impl VariableMemory for AutomatonScope<'_> {
    fn read(&self, slot: u16) -> Option<Value> {
        read(self.program, self.vars, self.shared, self.own, slot)
    }

    fn write(&mut self, _: u16, _: Value) -> Result<(), EvalError> {
        Err(EvalError::Type)
    }
}

/// The same, to be assigned.
pub(super) struct AutomatonScopeMut<'m> {
    pub program: &'m Program,
    pub vars: &'m [AutomatonVar],
    pub shared: &'m mut [i64],
    pub own: &'m mut [i64],
}

impl VariableMemory for AutomatonScopeMut<'_> {
    fn read(&self, slot: u16) -> Option<Value> {
        read(self.program, self.vars, self.shared, self.own, slot)
    }

    fn write(&mut self, slot: u16, value: Value) -> Result<(), EvalError> {
        let at = usize::from(slot);
        let (var, place) = match self.program.shared.get(at) {
            Some(var) => (var, self.shared.get_mut(at)),
            None => {
                let own = at - self.program.shared.len();
                (self.vars.get(own).ok_or(EvalError::Unbound(slot))?, self.own.get_mut(own))
            }
        };
        *place.ok_or(EvalError::Unbound(slot))? = exec::fit(var, slot, value)?;
        Ok(())
    }
}

pub(super) fn read(
    program: &Program,
    vars: &[AutomatonVar],
    shared: &[i64],
    own: &[i64],
    slot: u16,
) -> Option<Value> {
    let at = usize::from(slot);
    match program.shared.get(at) {
        Some(var) => var.value(*shared.get(at)?),
        None => {
            let at = at - program.shared.len();
            vars.get(at)?.value(*own.get(at)?)
        }
    }
}

/// How many variables an automaton knows.
pub(super) fn slots(program: &Program, vars: &[AutomatonVar]) -> u16 {
    u16::try_from(program.shared.len() + vars.len()).unwrap_or(u16::MAX)
}
