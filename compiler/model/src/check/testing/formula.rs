//! Formulas in metric temporal logic: that they can be decided while a run goes on, and that their windows hold something.

use hrdsl_syntax::{
    TemporalFormula, TemporalKind, TemporalReach,
    ast::{CallSyntax, ExprSyntax},
};

use super::phase::TestingPhase;
use crate::{
    TypedTemporal,
    check::{template::CheckerPhase, value::quantity::MAX_TIME},
    report::{requirements, types},
};

impl TestingPhase<'_, '_> {
    /// What looks ahead without a window stands outermost only: what is asked of every moment is known so much later.
    pub(super) fn can_be_decided(
        &mut self,
        formula: &TemporalFormula<CallSyntax, ExprSyntax, ExprSyntax>,
        outermost: bool,
    ) {
        if formula.looks_without_end() && !outermost {
            let word = match &formula.kind {
                TemporalKind::Look { look, .. } => look.word(),
                TemporalKind::Reach { .. }
                | TemporalKind::Constant(_)
                | TemporalKind::Events(_)
                | TemporalKind::Condition(_)
                | TemporalKind::Not(_)
                | TemporalKind::Junction(..) => TemporalReach::Until.word(),
            };
            self.report(requirements::without_a_window(word, formula.span));
        }
        let joins = matches!(formula.kind, TemporalKind::Not(_) | TemporalKind::Junction(..));
        formula.parts().iter().for_each(|part| self.can_be_decided(part, outermost && joins));
    }

    /// How far it looks ahead, in seconds; windows that hold nothing, or the present alone, are reported.
    pub(super) fn has_windows(&mut self, formula: &TypedTemporal) -> f64 {
        let farthest = formula.parts().iter().map(|part| self.has_windows(part)).fold(0.0, f64::max);
        let Some(window) = formula.window() else { return farthest };
        if window.from > window.to {
            self.report(requirements::backwards(window.from, window.to, window.span));
        } else if window.to == 0.0 {
            self.report(requirements::only_now(window.span));
        }
        let ahead = match &formula.kind {
            TemporalKind::Look { look, .. } => look.is_ahead(),
            TemporalKind::Reach { reach, .. } => *reach == TemporalReach::Until,
            TemporalKind::Constant(_)
            | TemporalKind::Events(_)
            | TemporalKind::Condition(_)
            | TemporalKind::Not(_)
            | TemporalKind::Junction(..) => false,
        };
        if !ahead {
            return farthest;
        }
        let reach = farthest + window.to;
        if reach > MAX_TIME && farthest <= MAX_TIME {
            let rule = format!("at most {MAX_TIME} s");
            self.report(types::must_be("how far the windows look ahead together", &rule, formula.span));
        }
        reach
    }
}
