//! Requirements and assumptions.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, ItemKind, PatternKind};

use super::{Checker, Env, table::Table};
use crate::{
    Assumption, Expr, ExprKind, Kind, Leaf, Pattern, Requirement, RequirementKind, noun::Noun,
    report::requirements::says_nothing,
};

impl Checker<'_> {
    pub(super) fn requirements(&mut self) {
        let mut names = Table::default();
        for (item, span) in self.each_item() {
            match item {
                ItemKind::Require(require) => self.requirement(require, span, &mut names),
                ItemKind::Assume(assume) => self.assume(assume, span),
                _ => {}
            }
        }
    }

    fn requirement(&mut self, require: &ast::Require, span: Span, names: &mut Table) {
        let kind = match self.choice(Noun::RequirementKind, &require.kind, &["safety", "functional"]) {
            Some(0) => RequirementKind::Safety,
            Some(_) | None => RequirementKind::Functional,
        };
        let pattern = self.requirement_pattern(&require.pattern);
        Self::declare(&mut self.issues, names, Noun::Requirement, &require.name);
        if let Some(pattern) = pattern {
            self.s.requirements.push(Requirement {
                name: require.name.text.clone(),
                kind,
                title: require.title.as_ref().map_or_else(String::new, |t| t.text.clone()),
                pattern,
                text: require.pattern.span,
                span,
            });
        }
    }

    fn requirement_pattern(&mut self, pattern: &ast::Pattern) -> Option<Pattern> {
        Some(match &pattern.kind {
            PatternKind::Causes { trigger, response, within } => {
                let (trigger, response) = (self.patterns(trigger), self.patterns(response));
                let within = within.as_ref().and_then(|e| self.time(e, "the time to respond", true));
                Pattern::Causes { trigger, response, within }
            }
            PatternKind::Forbids { trigger, forbidden, until } => Pattern::Forbids {
                trigger: self.patterns(trigger),
                forbidden: self.patterns(forbidden),
                until: self.patterns(until),
            },
            PatternKind::NeverWhile { events, condition } => {
                let events = self.patterns(events);
                let condition = condition.as_ref().map(|e| self.condition(e));
                Pattern::NeverWhile { events, condition }
            }
            PatternKind::Globally(condition) => Pattern::Globally(self.condition(condition)),
            PatternKind::Error => return None,
        })
    }

    /// A boolean that depends on the world.
    fn condition(&mut self, e: &ast::Expr) -> Expr {
        let e = self.expr_of(e, Kind::Bool, &mut Env::measured(""));
        let mut reads = false;
        e.each(&mut |part| {
            reads |=
                matches!(part.kind, ExprKind::Term(_) | ExprKind::Leaf(Leaf::Signal(_)) | ExprKind::Error);
        });
        if !reads {
            self.report(says_nothing(e.span));
        }
        e
    }

    fn assume(&mut self, assume: &ast::Assume, span: Span) {
        let at_most = self.count(&assume.at_most, "the number", 0);
        let events = self.patterns(&assume.events);
        let within = assume.within.as_ref().and_then(|e| self.time(e, "the time", true));
        let at_most = at_most.and_then(|n| u32::try_from(n).ok()).unwrap_or(0);
        self.s.assumptions.push(Assumption { events, at_most, within, span });
    }
}
