//! The value of a field: of an event that holds for some time, or of an expression over signals and the arguments of events.

use hrdsl_ir::binding::{GapRead, GapValue, MessageScalar};
use hrdsl_ir::value::nanos;
use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, BinaryOp, CallSyntax, ExprSyntaxKind as Syntax};

use super::scope::BindingPlace;
use crate::check::state::scope::ExprEnv;
use crate::check::{binding::phase::BindingPhase, template::CheckerPhase};
use crate::{
    ActorId, Dimension, EventId, InferredType, Type, TypedExpr, Value, VariableRef,
    noun::Noun,
    report::{bindings, names},
};

impl<'a> BindingPhase<'_, 'a> {
    pub(super) fn gap_value(
        &mut self,
        place: BindingPlace,
        scalar: MessageScalar,
        value: &ast::ExprSyntax,
    ) -> Option<GapValue<TypedExpr>> {
        if let Some((what, time)) = held(value) {
            let time = self.time(time, "the time", true).map_or(0, nanos);
            return self.held(scalar, what, time);
        }
        if self.names_event(value) {
            if place.periodic {
                self.report(bindings::held_for_how_long(value.span));
                return None;
            }
            return self.held(scalar, value, 0);
        }
        let (mut env, reads) = self.heard_arguments(self.actor);
        self.known_arguments(self.actor, value, &env)?;
        let value = self.expr(value, &mut env);
        self.read_value(value, scalar, &reads)
    }

    /// Whether all arguments of events are there that a value names; says so if not.
    fn known_arguments(&mut self, actor: ActorId, value: &ast::ExprSyntax, env: &ExprEnv) -> Option<()> {
        let mut paths = Vec::new();
        paths_in(value, &mut paths);
        let mut known = Some(());
        for path in paths {
            let [event, param, ..] = path.names.as_slice() else { continue };
            let is_argument = env.place_of(&format!("{}.{}", event.text, param.text)).is_some();
            if is_argument || self.kind_of(&event.text) != Some(Noun::Event) {
                continue;
            }
            known = None;
            let id = self.event(Noun::Event, event, None)?;
            let params: Vec<String> =
                self.s.events.get(usize::from(id.0)).map_or_else(Vec::new, |event| {
                    event.params.iter().map(|param| param.name.clone()).collect()
                });
            if params.contains(&param.text) {
                self.perceives(actor, id, event.span, false);
            } else {
                let near = params.iter().map(String::as_str);
                self.report(names::unknown(Noun::Parameter, &param.text, param.span, near));
            }
        }
        known
    }

    /// What a field of this kind holds, as an expression over `reads`.
    pub(super) fn read_value(
        &mut self,
        value: TypedExpr,
        scalar: MessageScalar,
        reads: &[GapRead],
    ) -> Option<GapValue<TypedExpr>> {
        let value = self.fitting(value, scalar)?;
        let mut is_read = false;
        value.each_leaf(&mut |leaf| is_read |= matches!(leaf, VariableRef::Local(_)));
        Some(GapValue::Value { value, reads: if is_read { reads.to_vec() } else { Vec::new() } })
    }

    /// `held(leg_request, 5 s)`
    fn held(
        &mut self,
        scalar: MessageScalar,
        what: &ast::ExprSyntax,
        time: i64,
    ) -> Option<GapValue<TypedExpr>> {
        if !matches!(scalar, MessageScalar::Bool | MessageScalar::Int { .. }) {
            let issue = bindings::does_not_fit("true or false", scalar, what.span);
            let arguments = self.arguments_of(what);
            self.report(if arguments.is_empty() {
                issue
            } else {
                issue.help(format!("for an argument of the event write {}", arguments.join(" or ")))
            });
            return None;
        }
        let Some(calls) = events(what) else {
            self.report(bindings::no_event(what.span));
            return None;
        };
        let found = self.patterns_with(&calls, &mut ExprEnv::constants());
        for (pattern, span) in &found {
            let actor = self.actor;
            self.perceives(actor, pattern.event, *span, false);
        }
        let events: Vec<_> = found.into_iter().map(|(pattern, _)| pattern).collect();
        (!events.is_empty()).then_some(GapValue::Held { events, time })
    }

    /// How the arguments of the events in an expression are written as values.
    fn arguments_of(&self, what: &ast::ExprSyntax) -> Vec<String> {
        let named = |call: &CallSyntax| self.s.events.iter().find(|event| event.name == call.name.text);
        let calls = events(what).unwrap_or_default();
        let events = calls.iter().filter_map(named);
        events
            .flat_map(|event| event.params.iter().map(|param| format!("`{}.{}`", event.name, param.name)))
            .collect()
    }

    /// Whether a value is written as the name of an event.
    fn names_event(&self, value: &ast::ExprSyntax) -> bool {
        let is_event = |name: &str| self.kind_of(name) == Some(Noun::Event);
        events(value).is_some_and(|calls| calls.iter().all(|call| is_event(&call.name.text)))
    }

    /// Signals, measurements, and `EVENT.PARAMETER` of what the actor hears.
    pub(super) fn heard_arguments(&self, actor: ActorId) -> (ExprEnv, Vec<GapRead>) {
        let (mut env, mut reads) = (ExprEnv::measured(""), Vec::new());
        for (event, id) in self.s.events.iter().zip(0u16..) {
            let hears = event.stimulus.is_none()
                && event.from != actor
                && (event.to.is_empty() || event.to.contains(&actor));
            if !hears {
                continue;
            }
            for (param, at) in event.params.iter().zip(0u16..) {
                let place = self.events.table.span(id).unwrap_or_default();
                env.push_typed(&format!("{}.{}", event.name, param.name), place, Noun::Parameter, param.ty);
                let initial = initial(param.ty);
                reads.push(GapRead::Argument { event: EventId(id), param: at, initial });
            }
        }
        (env, reads)
    }

    /// Whether a field can hold the value.
    fn fitting(&mut self, value: TypedExpr, scalar: MessageScalar) -> Option<TypedExpr> {
        let fits = match (scalar, value.ty) {
            (_, InferredType::Unknown) => return None,
            (MessageScalar::Bool | MessageScalar::Int { .. }, InferredType::Bool)
            | (MessageScalar::Float, InferredType::Int | InferredType::Float(_))
            | (MessageScalar::Text, InferredType::Text | InferredType::Enum(_))
            | (MessageScalar::Heading, InferredType::Float(Dimension::ANGLE)) => true,
            (MessageScalar::Int { lo, hi }, InferredType::Int) => {
                self.in_range(&value, Type::Int { lo, hi });
                true
            }
            (
                MessageScalar::Bool
                | MessageScalar::Int { .. }
                | MessageScalar::Float
                | MessageScalar::Text
                | MessageScalar::Time
                | MessageScalar::Heading,
                _,
            ) => false,
        };
        if !fits {
            self.report(bindings::does_not_fit(&value.ty.to_string(), scalar, value.span));
        }
        fits.then_some(value)
    }
}

/// All names with their parts in an expression.
fn paths_in<'e>(e: &'e ast::ExprSyntax, all: &mut Vec<&'e ast::PathSyntax>) {
    match &e.kind {
        Syntax::Path(path) => all.push(path),
        Syntax::Call { args: parts, .. } | Syntax::Tuple(parts) => {
            parts.iter().for_each(|part| paths_in(part, all));
        }
        Syntax::Unary { operand, .. } => paths_in(operand, all),
        Syntax::Binary { left, right, .. } => [left, right].into_iter().for_each(|part| paths_in(part, all)),
        Syntax::If { condition, then, otherwise } => {
            [condition, then, otherwise].into_iter().for_each(|part| paths_in(part, all));
        }
        Syntax::Index { of, .. } | Syntax::Field { of, .. } => paths_in(of, all),
        Syntax::Bool(_) | Syntax::Int(_) | Syntax::Float(_) | Syntax::Quantity { .. } => {}
        Syntax::Any | Syntax::Text(_) | Syntax::Internal(_) | Syntax::Error => {}
        // Agents have these, messages do not.
        Syntax::List { .. } | Syntax::Strong(_) | Syntax::Annotated { .. } | Syntax::Unify { .. } => {}
    }
}

/// What an argument is before its event has happened.
fn initial(ty: Type) -> Value {
    match ty {
        Type::Bool => Value::Bool(false),
        Type::Int { lo, hi } => Value::Int(0_i64.clamp(lo, hi.max(lo))),
        Type::Float(_) => Value::Float(0.0),
        Type::Enum(of) => of.values().first().map_or(Value::Bool(false), |v| Value::Symbol(*v)),
        Type::Text | Type::List(_) => Value::Bool(false),
    }
}

/// The two arguments of `held(…, …)`.
fn held(value: &ast::ExprSyntax) -> Option<(&ast::ExprSyntax, &ast::ExprSyntax)> {
    let Syntax::Call { callee, args } = &value.kind else { return None };
    let ([name], [what, time]) = (callee.names.as_slice(), args.as_slice()) else { return None };
    (name.text == "held").then_some((what, time))
}

/// `a`, `a(1)`, `a or b` as patterns of events.
fn events(what: &ast::ExprSyntax) -> Option<Vec<CallSyntax>> {
    let call = |callee: &ast::PathSyntax, args: Option<Vec<ast::ExprSyntax>>, span: Span| {
        let [name] = callee.names.as_slice() else { return None };
        Some(vec![CallSyntax { name: name.clone(), args, span }])
    };
    if let Syntax::Path(path) = &what.kind {
        return call(path, None, what.span);
    }
    if let Syntax::Call { callee, args } = &what.kind {
        return call(callee, Some(args.clone()), what.span);
    }
    let Syntax::Binary { op: BinaryOp::Or, left, right } = &what.kind else { return None };
    let (mut all, more) = (events(left)?, events(right)?);
    all.extend(more);
    Some(all)
}
