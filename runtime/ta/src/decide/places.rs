//! Which numbers of a state questions read.

use hrdsl_ir::Expr;

use crate::network::{model::CompiledNetwork, number::NumberType, query::StateFormula};

/// Calls `f` with each place of the state that a formula reads, but for what a deadlock depends on: that matters anyway.
pub(crate) fn each_place(model: &CompiledNetwork, formula: &StateFormula, f: &mut dyn FnMut(u32)) {
    match formula {
        StateFormula::And(all) | StateFormula::Or(all) => all.iter().for_each(|g| each_place(model, g, f)),
        StateFormula::Not(g) => each_place(model, g, f),
        StateFormula::Data(e) => of_expression(model, e, f),
        StateFormula::Clock(c) => c.bound.terms.iter().for_each(|t| of_expression(model, &t.value, f)),
        StateFormula::CounterIn { counter, .. } => f(model.counter_at(*counter) as u32),
        StateFormula::At { .. } | StateFormula::Deadlock => {}
    }
}

/// Calls `f` with each place of the state that an expression over the network reads.
pub(crate) fn of_expression(model: &CompiledNetwork, e: &Expr, f: &mut dyn FnMut(u32)) {
    model.library.compile(&model.slot_scope(), e, NumberType::Int).each_var(&model.library, f);
}
