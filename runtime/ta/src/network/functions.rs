//! The functions of automata, compiled for each member that calls them.

use hrdsl_ir::ta::{AutomatonFunction, AutomatonVar, FunctionStatement, Network};

use crate::network::{
    code::{CompiledFunction, CompiledStatement, VariablePlace, VariableScope},
    compiler::{ModelResult, NetworkCompiler, malformed},
    model::CompiledNetwork,
    number::NumberType,
    parts::CompiledAutomaton,
};

impl NetworkCompiler<'_, '_> {
    pub(super) fn functions(&mut self, network: &Network, members: &[CompiledAutomaton]) -> ModelResult<()> {
        // In two passes, all signatures before any body: functions may call each other in circles.
        let shared: Vec<(VariablePlace, NumberType)> = self
            .program
            .shared
            .iter()
            .enumerate()
            .map(|(i, v)| (VariablePlace::State((members.len() + i) as u32), NumberType::of(v)))
            .collect();
        let mut todo: Vec<(&AutomatonFunction, VariableScope)> = Vec::new();
        for (f, id) in self.program.functions.iter().zip((0..).map(hrdsl_ir::ta::FunctionId)) {
            let owner = f.owner.map(|a| CompiledNetwork::member_of(network, a));
            let (member, vars) = match owner {
                None => (None, shared.clone()),
                // Of an automaton that is not in this network: nobody can call it.
                Some(None) => continue,
                Some(Some(m)) => (Some(m), members[usize::from(m)].names.vars.clone()),
            };
            self.library.numbers.push((id, member, todo.len() as u32));
            let range = |v: &AutomatonVar| (v.lo, v.hi);
            self.library.routines.push(CompiledFunction {
                params: f.params.iter().map(range).collect(),
                types: f.params.iter().map(NumberType::of).collect(),
                frame: f.params.iter().chain(&f.locals).map(range).collect(),
                inits: f.locals.iter().map(|v| v.init).collect(),
                result: f.result.as_ref().map(|v| (NumberType::of(v), v.lo, v.hi)),
                body: Box::default(),
            });
            let frame = f.params.iter().chain(&f.locals).enumerate();
            let locals = frame.map(|(i, v)| (VariablePlace::Local(i as u32), NumberType::of(v)));
            todo.push((f, VariableScope::own(vars.into_iter().chain(locals).collect(), member)));
        }
        for (n, (f, names)) in todo.iter().enumerate() {
            let first = names.vars.len() - f.params.len() - f.locals.len();
            let body = self.body(names, f, first, &f.body);
            let fault = || malformed(&f.name, "a function uses an unknown variable or function");
            self.library.routines[n].body = body.ok_or_else(fault)?;
        }
        Ok(())
    }

    pub(super) fn body(
        &self,
        names: &VariableScope,
        f: &AutomatonFunction,
        first: usize,
        body: &[FunctionStatement],
    ) -> Option<Box<[CompiledStatement]>> {
        body.iter().map(|s| self.statement(names, f, first, s)).collect()
    }

    pub(super) fn statement(
        &self,
        names: &VariableScope,
        f: &AutomatonFunction,
        first: usize,
        s: &FunctionStatement,
    ) -> Option<CompiledStatement> {
        let lib = &self.library;
        Some(match s {
            FunctionStatement::Assign { place, value } => {
                let (reach, value) = self.assignment(names, place, value)?;
                CompiledStatement::Assign(reach, value)
            }
            FunctionStatement::Call { function, args } => {
                let routine = lib.routine(*function, names.member)?;
                CompiledStatement::Call(routine, lib.arguments(names, routine, args)?)
            }
            FunctionStatement::If { condition, then, otherwise } => CompiledStatement::If(
                lib.compile(names, condition, NumberType::Bool),
                self.body(names, f, first, then)?,
                self.body(names, f, first, otherwise)?,
            ),
            FunctionStatement::While { condition, body } => CompiledStatement::While(
                lib.compile(names, condition, NumberType::Bool),
                self.body(names, f, first, body)?,
            ),
            FunctionStatement::For { slot, lo, hi, body } => {
                let local = usize::from(*slot).checked_sub(first)?;
                names.vars.get(usize::from(*slot))?;
                let (lo, hi) =
                    (lib.compile(names, lo, NumberType::Int), lib.compile(names, hi, NumberType::Int));
                CompiledStatement::For(local as u32, lo, hi, self.body(names, f, first, body)?)
            }
            FunctionStatement::Return(value) => {
                let ty = f.result.as_ref().map(NumberType::of);
                let code = |e| ty.map(|ty| lib.compile(names, e, ty));
                CompiledStatement::Return(match value {
                    None => None,
                    Some(e) => Some(code(e)?),
                })
            }
        })
    }
}
