//! Conditions on discrete states that are goals, made ready to be asked of many states.

use crate::network::{
    code::{CodeEvalContext, CodeEvalError, CompiledExpr},
    model::CompiledNetwork,
    number::NumberComparison,
};

/// A condition on states, and which goal it is.
pub(crate) struct StateTest {
    pub goal: usize,
    /// No automaton may be in a committed location.
    pub settled: bool,
    pub code: CompiledExpr,
    /// The same code as comparisons with numbers, and what is left of it.
    literals: Vec<(NumberComparison, u32, i64)>,
    rest: Vec<CompiledExpr>,
    /// The numbers of the state that it reads, as bits of their places.
    pub(super) reads: u64,
}

impl StateTest {
    pub(super) fn new(model: &CompiledNetwork, goal: usize, settled: bool, code: CompiledExpr) -> Self {
        let (mut literals, mut rest, mut reads) = (Vec::new(), Vec::new(), 0);
        code.each_var(&model.library, &mut |i| reads |= place_bit(i as usize));
        // What may have no value keeps its order: a part that does not hold protects those after it.
        if code.span(&model.library, &[]).2 {
            conjuncts(&code, &mut literals, &mut rest);
        } else {
            rest.push(code.clone());
        }
        Self { goal, settled, code, literals, rest, reads }
    }

    /// A location without which it does not hold.
    pub(super) fn location(&self, members: usize) -> Option<(usize, usize)> {
        let at = |&(op, place, n): &(NumberComparison, u32, i64)| {
            let member = place as usize;
            (op == NumberComparison::Eq && member < members).then_some((member, usize::try_from(n).ok()?))
        };
        self.literals.iter().find_map(at)
    }

    pub(super) fn holds(
        &self,
        state: &mut [i64],
        stack: &mut Vec<i64>,
        model: &CompiledNetwork,
    ) -> Result<bool, CodeEvalError> {
        if !self.literals.iter().all(|&(op, place, n)| op.holds(state[place as usize], n)) {
            return Ok(false);
        }
        for code in &self.rest {
            if code.eval(&mut CodeEvalContext::new(&model.library, state, stack))? == 0 {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

/// The bit of a place of the state; some share one.
pub(super) fn place_bit(place: usize) -> u64 {
    1 << (place % 64)
}

/// Takes a conjunction apart.
fn conjuncts(
    code: &CompiledExpr,
    literals: &mut Vec<(NumberComparison, u32, i64)>,
    rest: &mut Vec<CompiledExpr>,
) {
    if let CompiledExpr::And(ab) = code {
        conjuncts(&ab.0, literals, rest);
        conjuncts(&ab.1, literals, rest);
    } else if let CompiledExpr::VarConst(op, place, n) = code {
        literals.push((*op, *place, *n));
    } else if let CompiledExpr::Not(a) = code
        && let CompiledExpr::VarConst(op, place, n) = **a
    {
        literals.push((op.negated(), place, n));
    } else {
        rest.push(code.clone());
    }
}
