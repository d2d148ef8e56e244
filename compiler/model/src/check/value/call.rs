//! Calls of the functions of automata: where they are known, and what they are given.

use std::rc::Rc;

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, CallSyntax, ItemSyntaxKind, NameSyntax};

use crate::check::{
    checker::Checker,
    state::scope::{CallableFunction, ExprEnv},
};
use crate::{
    FunctionId, InferredType, TypedExpr, TypedExprKind,
    noun::Noun,
    report::{functions, types},
    types::TypeLayout,
};

impl Checker<'_> {
    /// `f(a, b)`, if `f` is a function that is known here.
    pub(in crate::check) fn applied_function(
        &mut self,
        name: &NameSyntax,
        args: &[ast::ExprSyntax],
        span: Span,
        env: &mut ExprEnv,
    ) -> Option<TypedExpr> {
        let callable = env.function(&name.text)?.clone();
        let values = self.function_args(&callable, name, args, span, env);
        let Some(result) = callable.result else {
            self.refer(name, Some(callable.span));
            self.report(functions::has_no_value(&name.text, span));
            return Some(TypedExpr::error(span));
        };
        self.refer(name, Some(callable.span));
        self.called(&callable, span, env);
        Some(match (result, values) {
            (Some(ty), Some(args)) => TypedExpr {
                kind: TypedExprKind::Apply(callable.id, args, ty),
                ty: InferredType::of(ty),
                span,
            },
            (Some(_), None) | (None, _) => TypedExpr::error(span),
        })
    }

    /// `f(a, b)` for its effect; `None`: no function of the name is known here, or its arguments do not fit.
    pub(in crate::check) fn called_function(
        &mut self,
        call: &CallSyntax,
        env: &mut ExprEnv,
    ) -> Option<(FunctionId, Vec<TypedExpr>)> {
        let callable = env.function(&call.name.text)?.clone();
        let args = call.args.as_deref().unwrap_or_default();
        let args = self.function_args(&callable, &call.name, args, call.span, env);
        self.refer(&call.name, Some(callable.span));
        self.called(&callable, call.span, env);
        Some((callable.id, args?))
    }

    fn function_args(
        &mut self,
        callable: &CallableFunction,
        name: &NameSyntax,
        args: &[ast::ExprSyntax],
        span: Span,
        env: &mut ExprEnv,
    ) -> Option<Vec<TypedExpr>> {
        let params = Rc::clone(&callable.params);
        if args.len() != params.len() {
            let names: Vec<&str> = params.iter().map(|(n, _)| n.as_str()).collect();
            self.report(types::arity(Noun::Function, &name.text, &names, args.len(), span));
            args.iter().for_each(|a| drop(self.item(a, env)));
            return None;
        }
        let mut values = Some(Vec::with_capacity(args.len()));
        for (arg, (_, layout)) in args.iter().zip(params.iter()) {
            if let TypeLayout::Scalar(ty) = layout {
                let value = self.expr_for(arg, *ty, env);
                values.iter_mut().for_each(|v| v.push(value.clone()));
            } else {
                self.item(arg, env);
                values = None;
            }
        }
        values
    }

    fn called(&mut self, callable: &CallableFunction, span: Span, env: &ExprEnv) {
        if let Some(open) = self.shared.functions.open {
            self.shared.functions.calls.entry(open.0).or_default().push((callable.id, span));
        }
        if !env.effects {
            self.shared.functions.only_read.push((callable.id, span));
        }
    }

    /// A function of automata that is called elsewhere; says so.
    pub(in crate::check) fn function_elsewhere(&mut self, name: &NameSyntax) -> bool {
        let function =
            |item: &ItemSyntaxKind| matches!(item, ItemSyntaxKind::Function(f) if f.name.text == name.text);
        let found = self.each_item().any(|(item, _)| function(item));
        if found {
            self.report(functions::not_here(&name.text, name.span));
        }
        found
    }
}
