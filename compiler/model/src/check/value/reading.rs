//! Readings: what the system could read of signals.

use hrdsl_syntax::ast::ExprSyntax;

use crate::check::checker::Checker;
use crate::{InferredType, SignalTerm, TypedExpr, TypedExprKind, VariableRef, noun::Noun};

impl Checker<'_> {
    /// What the system could read of a signal: `reading(near)`.
    pub(in crate::check) fn reading(
        &mut self,
        of: &ExprSyntax,
        prefix: &str,
    ) -> Option<(SignalTerm, InferredType)> {
        let id = self.world_arg(Noun::Signal, of, prefix)?;
        let signal = self.s.world.as_ref()?.signals.get(usize::from(id))?;
        if self.world.names.broken.contains(&signal.name) {
            return None;
        }
        let ty = InferredType::of(signal.ty);
        Some((SignalTerm::Reading(crate::SignalId(id)), ty))
    }

    /// Whether an expression depends on what the system could read.
    pub(in crate::check) fn depends_on_a_reading(&self, e: &TypedExpr) -> bool {
        let mut found = false;
        e.each(&mut |part| {
            found |= matches!(part.kind, TypedExprKind::Term(SignalTerm::Reading(_)));
            if let TypedExprKind::Leaf(VariableRef::Signal(id)) = part.kind {
                let signal = self.s.world.as_ref().and_then(|w| w.signals.get(usize::from(id.0)));
                found |= signal.is_some_and(|s| self.depends_on_a_reading(&s.value));
            }
        });
        found
    }
}
