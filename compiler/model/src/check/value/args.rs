//! Arguments and event patterns.

use hrdsl_ir::Unit;
use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, CallSyntax, ExprSyntaxKind as Syntax};

use crate::check::{
    checker::Checker,
    state::{item::ArgumentPart, record::DeclaredFields, scope::ExprEnv, template::TemplateArgument},
};
use crate::{
    ArgPattern, EventId, EventPattern, Type, TypedExpr, Value, noun::Noun, report::types, types::TypeLayout,
};

impl Checker<'_> {
    /// The arguments of a call, each of its parameter's type, as single values. Without parentheses there are none.
    pub(in crate::check) fn args(
        &mut self,
        noun: Noun,
        call: &CallSyntax,
        fields: &[(String, TypeLayout)],
        env: &mut ExprEnv,
    ) -> Vec<TypedExpr> {
        let args = call.args.as_deref().unwrap_or_default();
        if args.len() != fields.len() {
            self.wrong_arity(noun, call, fields);
        }
        let mut values = Vec::with_capacity(fields.len());
        for (arg, (_, layout)) in args.iter().zip(fields) {
            match layout {
                // With a wrong number of arguments, which is for which is not known.
                TypeLayout::Record(_) | TypeLayout::Array(..) if args.len() != fields.len() => {
                    self.item(arg, env);
                }
                TypeLayout::Scalar(ty) => values.push(self.expr_for(arg, *ty, env)),
                TypeLayout::Unknown => {}
                TypeLayout::Record(_) | TypeLayout::Array(..) => {
                    self.item_for(arg, layout, env).flatten(&mut values)
                }
            }
        }
        values
    }

    pub(in crate::check) fn wrong_arity(
        &mut self,
        noun: Noun,
        call: &CallSyntax,
        fields: &[(String, TypeLayout)],
    ) {
        let names: Vec<&str> = fields.iter().map(|(n, _)| n.as_str()).collect();
        let got = call.args.as_ref().map_or(0, Vec::len);
        self.report(types::arity(noun, &call.name.text, &names, got, call.span));
    }

    /// An event with constants or `_` for arguments; without parentheses any arguments will do.
    pub(in crate::check) fn pattern(&mut self, call: &CallSyntax, env: &mut ExprEnv) -> Option<EventPattern> {
        let event = self.event(Noun::EventOrStimulus, &call.name, None)?;
        let fields = self.fields_of(event);
        let Some(args) = &call.args else {
            return Some(EventPattern { event, args: vec![ArgPattern::Any; self.arity_of(event)] });
        };
        if args.len() != fields.len() {
            self.wrong_arity(Noun::Event, call, &fields);
            return None;
        }
        let mut parts = Vec::new();
        for (arg, (_, layout)) in args.iter().zip(fields.iter()) {
            self.spread(arg, layout, env, &|_, _| false, &mut parts);
        }
        let pattern = |part| self.pattern_part(part, env).map_or(ArgPattern::Any, ArgPattern::Is);
        let patterns = parts.into_iter().map(pattern).collect();
        Some(EventPattern { event, args: patterns })
    }

    fn pattern_part(&mut self, part: ArgumentPart<'_>, env: &mut ExprEnv) -> Option<Value> {
        let e = match part {
            ArgumentPart::Any | ArgumentPart::Variable(..) => return None,
            ArgumentPart::Syntax(arg, _) if arg.kind == Syntax::Any => return None,
            ArgumentPart::Syntax(arg, ty) => self.expr_for(arg, ty, env),
            ArgumentPart::Done(e, _) => e,
        };
        if e.constant().is_none() && e.ty != crate::InferredType::Unknown {
            self.report(types::not_constant(e.span).help("write a constant, or `_` for any value"));
        }
        e.constant()
    }

    /// Patterns over constants. A parameter of a template may stand for several.
    pub(in crate::check) fn patterns(&mut self, calls: &[CallSyntax]) -> Vec<EventPattern> {
        self.patterns_with(calls, &mut ExprEnv::constants()).into_iter().map(|(p, _)| p).collect()
    }

    /// Patterns with the places where they are named.
    pub(in crate::check) fn patterns_with(
        &mut self,
        calls: &[CallSyntax],
        env: &mut ExprEnv,
    ) -> Vec<(EventPattern, Span)> {
        let mut all = Vec::new();
        for call in calls {
            match self.given(&call.name.text) {
                Some(TemplateArgument::Events(events)) if call.args.is_none() => {
                    all.extend(events.iter().map(|p| (p.clone(), call.name.span)));
                    self.refer_given(&call.name);
                }
                Some(TemplateArgument::Unknown) => self.refer_given(&call.name),
                Some(
                    TemplateArgument::Events(_)
                    | TemplateArgument::Value(_)
                    | TemplateArgument::Actor(_)
                    | TemplateArgument::Thing(..)
                    | TemplateArgument::Point(_),
                )
                | None => all.extend(self.pattern(call, env).map(|p| (p, call.name.span))),
            }
        }
        all
    }

    pub(in crate::check) fn fields_of(&self, event: EventId) -> DeclaredFields {
        self.events.fields[usize::from(event.0)].clone()
    }

    /// How many single values an event carries.
    pub(in crate::check) fn arity_of(&self, event: EventId) -> usize {
        self.s.events[usize::from(event.0)].params.len()
    }

    /// A constant that must not be less than another of its type; says so at `span`.
    pub(in crate::check) fn ordered(&mut self, lo: &TypedExpr, hi: &TypedExpr, span: Span) -> bool {
        let (Some(a), Some(b)) = (lo.constant(), hi.constant()) else { return true };
        match (a.as_f64(), b.as_f64()) {
            (Some(x), Some(y)) if x > y => {
                self.report(types::empty_range(a, b, span));
                false
            }
            (Some(_) | None, _) => true,
        }
    }

    /// A type that models can enumerate.
    pub(in crate::check) fn finite(&mut self, ty: Type, what: &str, span: Span) -> bool {
        if !ty.is_finite() {
            self.report(types::not_finite(what, span));
        }
        ty.is_finite()
    }

    /// Whether all single values of a layout can be enumerated; says so if not.
    pub(in crate::check) fn finite_layout(&mut self, layout: &TypeLayout, what: &str, span: Span) -> bool {
        let mut leaves = Vec::new();
        self.leaves("", layout, &mut leaves);
        leaves.iter().all(|(_, ty)| ty.is_finite()) || self.finite(Type::Float(Unit::None), what, span)
    }

    /// The arguments of a call with their types, taken apart as the parameters are.
    pub(in crate::check) fn spread_args<'e>(
        &mut self,
        args: &'e [ast::ExprSyntax],
        fields: &[(String, TypeLayout)],
        env: &mut ExprEnv,
        variable: &dyn Fn(&Checker<'_>, &ast::NameSyntax) -> bool,
    ) -> Vec<ArgumentPart<'e>> {
        let mut parts = Vec::new();
        for (arg, (_, layout)) in args.iter().zip(fields) {
            self.spread(arg, layout, env, variable, &mut parts);
        }
        parts
    }
}
