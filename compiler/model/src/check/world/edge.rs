//! Rules that wait for a condition: `on rising(C)`, `on falling(C, D)`.

use hrdsl_ir::{value::nanos, world::RuleTrigger};
use hrdsl_source::nearest;
use hrdsl_syntax::ast;

use crate::check::{
    checker::{Checker, EVENTS},
    template::CheckerPhase,
    world::phase::WorldPhase,
};
use crate::{
    InferredType, TypedExpr, TypedExprKind,
    check::state::scope::ExprEnv,
    noun::Noun,
    report::{types, world::bad_world},
};

pub(in crate::check) const RISING: &str = "rising";
const FALLING: &str = "falling";

impl Checker<'_> {
    /// Whether a condition's edge is meant. A scenario that has an event of this name means the event.
    pub(in crate::check) fn is_edge(&self, call: &ast::CallSyntax) -> bool {
        let name = call.name.text.as_str();
        (name == RISING || name == FALLING)
            && self.events.table.get(name).is_none()
            && self.given(name).is_none()
    }

    /// Whether a word that names nothing, and stands before a condition, was meant for one of these.
    pub(in crate::check) fn is_misspelt_edge(&self, call: &ast::CallSyntax) -> bool {
        let text = &call.name.text;
        let is_known = self.s.names.kind_of(text).is_some() || self.given(text).is_some();
        !is_known && call.args.is_some() && nearest(text, [RISING, FALLING]).is_some()
    }

    /// The same; says so.
    pub(in crate::check) fn says_misspelt_edge(&mut self, call: &ast::CallSyntax) -> bool {
        if !self.is_misspelt_edge(call) {
            return false;
        }
        let mut words = self.near_of(&EVENTS);
        words.extend([RISING, FALLING].map(str::to_owned));
        self.unknown(Noun::EventOrStimulus, &call.name, &words, None);
        true
    }
}

impl WorldPhase<'_, '_> {
    pub(super) fn edge_of(&mut self, call: &ast::CallSyntax, prefix: &str) -> Option<RuleTrigger<TypedExpr>> {
        let name = &call.name.text;
        let args = call.args.as_deref().unwrap_or_default();
        let (condition, held) = match args {
            [condition] => (condition, None),
            [condition, held] => (condition, Some(held)),
            [] | [_, _, _, ..] => {
                let issue = types::counts(Noun::Function, name, 1, args.len(), call.span);
                let help = format!(
                    "write `{name}(CONDITION)`, or `{name}(CONDITION, TIME)`: it has held for so long"
                );
                self.report(issue.help(help));
                return None;
            }
        };
        let mut env = ExprEnv::measured(prefix);
        let condition = self.expr_of(condition, InferredType::Bool, &mut env);
        let held = held.map_or(Some(0.0), |e| self.time(e, "how long it has held", false))?;
        let mut reads = false;
        condition.each(&mut |part| {
            reads |=
                matches!(part.kind, TypedExprKind::Leaf(_) | TypedExprKind::Term(_) | TypedExprKind::Error);
        });
        if !reads {
            let message = "the condition measures nothing, and never changes";
            self.report(bad_world(
                condition.span,
                message,
                "compare a measurement: `distance(a, b) < 50 cm`",
            ));
            return None;
        }
        Some(RuleTrigger::Edge { rising: name == RISING, condition, held: nanos(held) })
    }
}
