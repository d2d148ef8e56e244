//! Variables of automata: the single values of each, with what they hold at the start.

use hrdsl_syntax::ast;

use crate::check::{checker::Checker, state::scope::ExprEnv};
use crate::{
    AutomatonVar, Type, TypedExpr, Value,
    report::types,
    types::{TypeLayout, starting_var},
};

impl Checker<'_> {
    /// A variable of an automaton or shared: of finite types, each part with a value at the start.
    pub(in crate::check) fn var(&mut self, var: &ast::VarSyntax) -> (TypeLayout, Vec<AutomatonVar>) {
        let span = var.name.span;
        let layout = self.layout(&var.ty).filter(|l| {
            self.plain(l, &var.name.text, span) && self.finite_layout(l, "a variable of automata", span)
        });
        let layout = layout.unwrap_or(TypeLayout::Unknown);
        let mut values = Vec::new();
        if let Some(e) = &var.init {
            self.item_for(e, &layout, &mut ExprEnv::constants()).flatten(&mut values);
        }
        for e in &values {
            if e.constant().is_none() && e.ty != crate::InferredType::Unknown {
                self.report(types::not_constant(e.span));
            }
        }
        let mut leaves = Vec::new();
        self.leaves(&var.name.text, &layout, &mut leaves);
        let mut values = values.into_iter();
        let vars = leaves.into_iter().map(|(name, ty)| {
            let init = values.next().and_then(|e: TypedExpr| e.constant());
            starting_var(&name, ty, init.unwrap_or(nearest_to_zero(ty)))
        });
        (layout, vars.collect())
    }
}

/// What a variable holds that is given no value.
pub(in crate::check) fn nearest_to_zero(ty: Type) -> Value {
    match ty {
        Type::Bool | Type::Float(_) | Type::Text | Type::List(_) => Value::Bool(false),
        Type::Int { lo, hi } => Value::Int(0.clamp(lo, hi)),
        Type::Enum(of) => of.values().first().map_or(Value::Bool(false), |v| Value::Symbol(*v)),
    }
}
