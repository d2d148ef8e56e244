//! Functions of automata: their slots and statements.

use hrdsl_ir::ta::{Automaton, Function, Statement, Var};
use hrdsl_model::{self as model, Leaf};

use super::ta::{Slots, bounded, count, var};

/// `automata` are lowered already: they may have variables that the source does not name.
pub(crate) fn function(f: &model::Routine, scenario: &model::Scenario, automata: &[Automaton]) -> Function {
    let owner = f.owner;
    let own = owner.and_then(|a| automata.get(usize::from(a.0))).map_or(0, |a| count(a.vars.len()));
    let slots = Slots { shared: count(scenario.shared.len()), own };
    Function {
        name: f.name.clone(),
        owner,
        params: f.params.iter().map(|p| bounded(&p.name, p.ty)).collect(),
        locals: f.locals.iter().map(var).collect(),
        result: f.result.map(|ty| Var { name: f.name.clone(), ..bounded("", ty) }),
        pure: f.pure(),
        body: block(&f.body, &slots),
        origin: f.span,
    }
}

fn block(statements: &[model::Statement], slots: &Slots) -> Vec<Statement> {
    statements.iter().map(|s| statement(s, slots)).collect()
}

fn statement(s: &model::Statement, slots: &Slots) -> Statement {
    match s {
        model::Statement::Assign(place, value) => {
            Statement::Assign { place: slots.place(place), value: slots.expr(value) }
        }
        model::Statement::Call(function, args) => {
            Statement::Call { function: *function, args: args.iter().map(|a| slots.expr(a)).collect() }
        }
        model::Statement::If { condition, then, otherwise } => Statement::If {
            condition: slots.expr(condition),
            then: block(then, slots),
            otherwise: block(otherwise, slots),
        },
        model::Statement::While { condition, body } => {
            Statement::While { condition: slots.expr(condition), body: block(body, slots) }
        }
        model::Statement::For { local, lo, hi, body } => Statement::For {
            slot: slots.slot(Leaf::Local(*local)),
            lo: slots.expr(lo),
            hi: slots.expr(hi),
            body: block(body, slots),
        },
        model::Statement::Return(value) => Statement::Return(value.as_ref().map(|v| slots.expr(v))),
    }
}
