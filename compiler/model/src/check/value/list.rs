//! Lists, and what stands in the place of a value without being one.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, ExprSyntaxKind as Syntax};

use crate::check::{checker::Checker, state::scope::ExprEnv};
use crate::{
    Dimension, InferredType, List, TypedExpr, TypedExprKind, Value,
    report::{agents, types},
};

impl Checker<'_> {
    /// What belongs into a formula stands where a value is needed.
    pub(in crate::check) fn no_value_here(&mut self, e: &ast::ExprSyntax, env: &ExprEnv) {
        let issue = if let Syntax::Internal(call) = &e.kind {
            let what = format!("`.{}`", call.name.text);
            let help = if env.plan {
                "it is a formula of its own: let it bind a variable, and use that: `.count(F, N) && N > 2`"
            } else {
                "internal actions are part of the plans and rules of agents"
            };
            agents::no_formula(&what, e.span, help)
        } else if matches!(e.kind, Syntax::Unify { .. }) {
            agents::no_binding(e.span, env.plan)
        } else {
            agents::no_formula("a belief", e.span, "bind its value first: `b(X) && X …`")
        };
        self.report(issue);
    }

    /// `[a, b | rest]`, whose elements are all of one kind; `element`: what they are to be.
    pub(in crate::check) fn list(
        &mut self,
        items: &[ast::ExprSyntax],
        rest: Option<&ast::ExprSyntax>,
        element: InferredType,
        span: Span,
        env: &mut ExprEnv,
    ) -> TypedExpr {
        let mut element = element;
        let due = |element: InferredType| {
            if element == InferredType::Int { InferredType::Unknown } else { element }
        };
        let mut values = Vec::new();
        for item in items {
            let value = if let Syntax::List { items, rest } = &item.kind {
                let inner = element.element().unwrap_or(InferredType::Unknown);
                let value = self.list(items, rest.as_deref(), inner, item.span, env);
                self.fit(value, element, env)
            } else {
                self.expr_of(item, due(element), env)
            };
            element = match (element, value.ty) {
                (InferredType::Int, InferredType::Float(Dimension::NUMBER)) => value.ty,
                (InferredType::Int, got) if got.with(InferredType::Int).is_none() => {
                    self.report(types::mismatch(InferredType::Int, got, None, item.span));
                    return TypedExpr::error(span);
                }
                (known, got) => known.with(got).unwrap_or(known),
            };
            values.push(value);
        }
        let values: Vec<TypedExpr> = values.into_iter().map(|v| self.fit(v, element, env)).collect();
        let rest = rest.map(|r| self.expr_of(r, InferredType::list(element), env));
        if values.iter().chain(&rest).any(|v| v.kind == TypedExprKind::Error) {
            return TypedExpr::error(span);
        }
        let known = rest.as_ref().and_then(|r| r.ty.element()).and_then(|of| of.with(element));
        let ty = InferredType::list(known.unwrap_or(element));
        let mut constants: Option<Vec<Value>> = values.iter().map(TypedExpr::constant).collect();
        if let Some(rest) = &rest {
            constants = match (constants, rest.constant()) {
                (Some(mut all), Some(Value::List(more))) => {
                    all.extend(more.iter());
                    Some(all)
                }
                (Some(_) | None, _) => None,
            };
        }
        match constants {
            Some(all) => TypedExpr::value(Value::List(List::of(&all)), ty, span),
            None => TypedExpr { kind: TypedExprKind::List(values, rest.map(Box::new)), ty, span },
        }
    }
}
