//! What all that compiles a network has at hand, and how assignments, times and comparisons of clocks are compiled.

use hrdsl_ir::{
    Expr, Nanos, Program,
    expr::Lvalue,
    ta::{Automaton, ClockConstraint, ClockId, Network, TimeSum},
};

use crate::{
    network::{
        code::{CodeLibrary, CompiledExpr, CompiledLvalue, VariableScope},
        error::ModelError,
        number::NumberType,
        parts::{ClockConstraints, ParametricConstraint, TimeExpr},
    },
    zone::constraint::constraints,
};

/// The greatest constant, in units.
const FAR: u64 = 1 << 50;

/// A network on its way to a [`CompiledNetwork`](super::model::CompiledNetwork).
pub(super) struct NetworkCompiler<'p, 'n> {
    pub(super) program: &'p Program,
    pub(super) network: &'n Network,
    pub(super) unit: Nanos,
    pub(super) library: CodeLibrary,
}

pub(super) type ModelResult<T> = std::result::Result<T, ModelError>;

pub(super) fn malformed(automaton: &str, what: &str) -> ModelError {
    ModelError::Malformed { automaton: automaton.to_owned(), what: what.to_owned() }
}

impl NetworkCompiler<'_, '_> {
    pub(super) fn assignment(
        &self,
        names: &VariableScope,
        place: &Lvalue,
        value: &Expr,
    ) -> Option<(CompiledLvalue, CompiledExpr)> {
        let reach = self.library.reach(names, place)?;
        let ty = names.vars.get(usize::from(place.slot))?.1;
        Some((reach, self.library.compile(names, value, ty)))
    }

    pub(super) fn clock(&self, clock: ClockId, first: usize) -> u16 {
        let shared = self.program.clocks.len();
        let n = usize::from(clock.0);
        // Clock 0 of a zone is the constant zero.
        (if n < shared { n + 1 } else { first + n - shared }) as u16
    }

    pub(super) fn times(
        &self,
        automaton: &Automaton,
        names: &VariableScope,
        locals: &[(i64, i64)],
        time: &TimeSum,
    ) -> ModelResult<TimeExpr> {
        let far = || ModelError::Constants { automaton: automaton.name.clone() };
        let mut terms = Vec::new();
        // Without remainder: the unit divides all constants and factors, so that no bound is rounded.
        let mut units = time.nanos / self.unit;
        for t in &time.terms {
            let factor = t.factor / self.unit;
            let code = self.library.compile(names, &t.value, NumberType::Int);
            if let CompiledExpr::Const(n) = code {
                units = n.checked_mul(factor).and_then(|n| units.checked_add(n)).ok_or_else(far)?;
            } else {
                terms.push((factor, code));
            }
        }
        let times = TimeExpr { units, terms };
        let (lo, hi) = times.span(&self.library, locals);
        if lo.unsigned_abs() > FAR || hi.unsigned_abs() > FAR { Err(far()) } else { Ok(times) }
    }

    pub(super) fn clocks(
        &self,
        automaton: &Automaton,
        names: &VariableScope,
        first: usize,
        locals: &[(i64, i64)],
        constraints_of: &[ClockConstraint],
    ) -> ModelResult<ClockConstraints> {
        let mut out = ClockConstraints::default();
        for c in constraints_of {
            let (i, j) = (self.clock(c.clock, first), c.minus.map_or(0, |m| self.clock(m, first)));
            let time = self.times(automaton, names, locals, &c.bound)?;
            if time.terms.is_empty() {
                constraints(i, j, c.op, time.units, &mut |c| out.fixed.push(c));
            } else {
                let span = time.span(&self.library, locals);
                out.moving.push(ParametricConstraint { i, j, op: c.op, time, span });
            }
        }
        Ok(out)
    }
}
