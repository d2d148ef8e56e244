//! Clocks that all automata share.

use std::rc::Rc;

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, TypeExpr};

use crate::check::{state::record::MAX_PARTS, template::CheckerPhase, vocabulary::phase::VocabularyPhase};
use crate::{
    VarPlace,
    noun::Noun,
    report::{automata, types},
};

/// The sizes of an array of clocks, and none for one clock. `None`: the type is another.
fn sizes(ty: &TypeExpr) -> Option<Vec<&ast::ExprSyntax>> {
    match ty {
        TypeExpr::Named(name) => (name.text == "clock").then(Vec::new),
        TypeExpr::Array(of, size) => {
            let mut sizes = sizes(of)?;
            sizes.push(size);
            Some(sizes)
        }
        TypeExpr::Range(..) | TypeExpr::List(_) | TypeExpr::Error => None,
    }
}

impl VocabularyPhase<'_, '_> {
    /// `var total: clock`, `var t: clock[3]`; whether it is one.
    pub(super) fn declare_shared_clocks(&mut self, var: &ast::VarSyntax, whole: Span) -> bool {
        let named = self.types.enums.get("clock").is_some() || self.types.record_names.get("clock").is_some();
        let Some(sizes) = sizes(&var.ty).filter(|_| !named) else { return false };
        if let Some(init) = &var.init {
            self.report(automata::clock_init(&var.name.text, init.span));
        }
        let mut counts = Vec::new();
        for size in &sizes {
            let n = self.count(size, "the size of an array", 1).and_then(|n| u16::try_from(n).ok());
            counts.extend(n.filter(|n| usize::from(*n) <= MAX_PARTS));
        }
        let total = counts.iter().fold(1, |n: usize, c| n.saturating_mul(usize::from(*c)));
        if counts.len() != sizes.len() || total > MAX_PARTS {
            self.report(types::must_be(
                "the size of an array",
                &format!("at most {MAX_PARTS}"),
                var.name.span,
            ));
            return true;
        }
        let mut names = vec![var.name.text.clone()];
        for count in &counts {
            let elements = |name: &String| (0..*count).map(|i| format!("{name}[{i}]")).collect::<Vec<_>>();
            names = names.iter().flat_map(elements).collect();
        }
        let place = VarPlace { name: var.name.span, whole };
        for name in names {
            let (issues, table) = (&mut self.checker.issues, &mut self.checker.shared.clocks);
            if issues.declare_as(table, Noun::Clock, &name, var.name.span).is_none() {
                return true;
            }
            Rc::make_mut(&mut self.shared.scope).add_clock(&name, var.name.span);
            self.s.clocks.push(name);
            self.s.places.clocks.push(place);
        }
        if !counts.is_empty() {
            let scope = Rc::make_mut(&mut self.shared.scope);
            scope.add_clock(&var.name.text, var.name.span);
            scope.clock_arrays.insert(var.name.text.clone(), counts);
        }
        true
    }
}
