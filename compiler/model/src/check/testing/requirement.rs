//! Requirements and assumptions.

use hrdsl_ir::value::nanos;
use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, ItemSyntaxKind, NameSyntax, TemplateSyntaxKind};

use super::phase::TestingPhase;
use crate::check::state::phase::CheckPhase;
use crate::check::{
    state::scope::ExprEnv,
    template::{CheckerPhase, template},
};
use crate::{
    InferredType, RequirementKind, TypedAssumption, TypedExpr, TypedExprKind, TypedPattern, TypedRequirement,
    VariableRef, noun::Noun, report::requirements::says_nothing,
};

impl TestingPhase<'_, '_> {
    pub(in crate::check) fn requirements(&mut self) {
        self.templates_of(TemplateSyntaxKind::Require, |c, template| {
            if let ItemSyntaxKind::Require(require) = template.kind {
                c.resolved(require);
            }
        });
        for ast::ItemSyntax { doc, kind: item, span } in self.source.items.clone() {
            let span = *span;
            if template(item).is_some() {
                continue;
            }
            let looked_at = self.source.looks_at(CheckPhase::Requirements, span);
            if let ItemSyntaxKind::Require(require) = item {
                let resolved = if looked_at { self.resolved(require) } else { None };
                self.requirement((&require.name, doc), resolved, require.pattern.span, span);
            } else if let ItemSyntaxKind::Instance(instance) = item
                && instance.sort == TemplateSyntaxKind::Require
                && let Some((template, given)) = self.instance(instance, &ExprEnv::measured(""))
                && let ItemSyntaxKind::Require(require) = template.kind
            {
                let place = Some((&instance.name, instance.span));
                let resolved = self.as_instance(Some(given), place, |c| c.resolved(require));
                self.requirement((&instance.name, doc), resolved, instance.span, span);
            } else if let ItemSyntaxKind::Assume(assume) = item
                && looked_at
            {
                self.assume(assume, span);
            }
        }
    }

    /// What a requirement says, whatever its name.
    fn resolved(&mut self, require: &ast::RequireSyntax) -> Option<(RequirementKind, String, TypedPattern)> {
        let kind = match self.choice(Noun::RequirementKind, &require.kind, &["safety", "functional"]) {
            Some(0) => RequirementKind::Safety,
            Some(_) | None => RequirementKind::Functional,
        };
        let pattern = self.sentence(require.pattern.kind.as_ref()?);
        let title = require.title.as_ref().map_or_else(String::new, |t| t.text.clone());
        Some((kind, title, pattern))
    }

    fn requirement(
        &mut self,
        (name, doc): (&NameSyntax, &str),
        resolved: Option<(RequirementKind, String, TypedPattern)>,
        text: Span,
        span: Span,
    ) {
        self.not_a_template(TemplateSyntaxKind::Require, name);
        let new = self.checker.issues.declare(&mut self.requirements, Noun::Requirement, name).is_some();
        if let Some((kind, title, pattern)) = resolved.filter(|_| new) {
            let (name, doc) = (name.text.clone(), doc.to_owned());
            self.s.requirements.push(TypedRequirement { name, kind, title, doc, pattern, text, span });
        }
    }

    /// A boolean that depends on the world.
    pub(super) fn condition(&mut self, e: &ast::ExprSyntax) -> TypedExpr {
        let e = self.expr_of(e, InferredType::Bool, &mut ExprEnv::measured(""));
        let mut reads = false;
        e.each(&mut |part| {
            reads |= matches!(
                part.kind,
                TypedExprKind::Term(_) | TypedExprKind::Leaf(VariableRef::Signal(_)) | TypedExprKind::Error
            );
        });
        // A parameter may stand for something measured.
        if !reads && !self.templates.by_itself {
            self.report(says_nothing(e.span));
        }
        e
    }

    fn assume(&mut self, assume: &ast::AssumeSyntax, span: Span) {
        let at_most = self.count(&assume.at_most, "the number", 0);
        let events = self.patterns(&assume.events);
        let within = assume.within.as_ref().and_then(|e| self.time(e, "the time", true)).map(nanos);
        let at_most = at_most.and_then(|n| u32::try_from(n).ok()).unwrap_or(0);
        self.s.assumptions.push(TypedAssumption { text: span, events, at_most, within, origin: span });
    }
}
