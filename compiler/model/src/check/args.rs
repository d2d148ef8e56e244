//! Arguments and event patterns.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{Call, ExprKind as Syntax};

use super::{Checker, Env};
use crate::{EventId, EventPattern, Expr, Param, Type, noun::Noun, report::types};

impl Checker<'_> {
    /// The arguments of a call, each of its parameter's type. Without parentheses there are none.
    pub(super) fn args(&mut self, noun: Noun, call: &Call, params: &[Param], env: &mut Env) -> Vec<Expr> {
        let args = call.args.as_deref().unwrap_or_default();
        if args.len() != params.len() {
            self.report(types::arity(noun, &call.name.text, params, args.len(), call.span));
        }
        args.iter().zip(params).map(|(a, p)| self.expr_for(a, p.ty, env)).collect()
    }

    /// An event with constants or `_` for arguments; without parentheses any arguments will do.
    pub(super) fn pattern(&mut self, call: &Call, env: &mut Env) -> Option<EventPattern> {
        let event = self.event(Noun::EventOrStimulus, &call.name, None)?;
        let params = self.params_of(event);
        let Some(args) = &call.args else {
            return Some(EventPattern { event, args: vec![None; params.len()] });
        };
        if args.len() != params.len() {
            self.report(types::arity(Noun::Event, &call.name.text, &params, args.len(), call.span));
            return None;
        }
        let mut patterns = Vec::new();
        for (arg, param) in args.iter().zip(&params) {
            patterns.push(match arg.kind {
                Syntax::Any => None,
                _ => {
                    let e = self.expr_for(arg, param.ty, env);
                    if e.constant().is_none() && e.ty != crate::Kind::Unknown {
                        self.report(
                            types::not_constant(e.span).help("write a constant, or `_` for any value"),
                        );
                    }
                    e.constant()
                }
            });
        }
        Some(EventPattern { event, args: patterns })
    }

    /// Patterns over constants.
    pub(super) fn patterns(&mut self, calls: &[Call]) -> Vec<EventPattern> {
        calls.iter().filter_map(|c| self.pattern(c, &mut Env::constants())).collect()
    }

    pub(super) fn params_of(&self, event: EventId) -> Vec<Param> {
        self.s.events[usize::from(event.0)].params.clone()
    }

    /// A constant that must not be less than another of its type; says so at `span`.
    pub(super) fn ordered(&mut self, lo: &Expr, hi: &Expr, span: Span) -> bool {
        let (Some(a), Some(b)) = (lo.constant(), hi.constant()) else { return true };
        match (a.number(), b.number()) {
            (Some(x), Some(y)) if x > y => {
                self.report(types::empty_range(a, b, span));
                false
            }
            (Some(_) | None, _) => true,
        }
    }

    /// A type that models can enumerate.
    pub(super) fn finite(&mut self, ty: Type, what: &str, span: Span) -> bool {
        if !ty.is_finite() {
            self.report(types::not_finite(what, span));
        }
        ty.is_finite()
    }
}
