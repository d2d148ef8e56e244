//! What a message makes happen: events of the system's actor, commands to its devices.

use hrdsl_ir::{
    binding::{
        CommandArgument, MessageEffect, MessageRead, MessageRule, MessageScalar, MessageStep, TextOperand,
        place_text,
    },
    device::{CommandParam, DeviceBody, NumberCount},
    world::DeviceCommandId,
};
use hrdsl_source::Span;
use hrdsl_syntax::ast::{
    self, BindingEntry, BindingEntryKind as Entry, CallSyntax, ExprSyntaxKind as Syntax, PathSyntax,
};

use super::{
    places::{WrittenStep, steps_of},
    scope::BindingPlace,
    shape::{FieldShape, MessageShape},
};
use crate::check::state::{item::ExprItem, scope::ExprEnv};
use crate::check::{binding::phase::BindingPhase, template::CheckerPhase};
use crate::{
    ActorId, Dimension, EventId, InferredType, Type, TypedExpr, TypedExprKind, VariableRef,
    noun::Noun,
    report::{bindings, names, types},
    types::TypeLayout,
};

/// What the rules of a message can read.
pub(super) struct MessageEnv<'s> {
    pub env: ExprEnv,
    /// By the number of the local.
    pub reads: Vec<MessageRead>,
    pub shape: &'s MessageShape,
}

impl<'s> MessageEnv<'s> {
    pub fn new(shape: &'s MessageShape) -> Self {
        let env = ExprEnv { noun: Some(Noun::Field), ..ExprEnv::default() };
        let mut this = Self { env, reads: Vec::new(), shape };
        for (path, scalar) in shape.scalars() {
            this.read(path, scalar);
        }
        this
    }

    /// The name of what is read at a place; `None`: it is a time.
    pub fn read(&mut self, path: Vec<MessageStep>, scalar: MessageScalar) -> Option<String> {
        let ty = match scalar {
            MessageScalar::Bool => Type::Bool,
            MessageScalar::Int { lo, hi } => Type::Int { lo, hi },
            MessageScalar::Float => Type::Float(hrdsl_ir::Unit::None),
            MessageScalar::Text => Type::Text,
            MessageScalar::Time | MessageScalar::Heading => return None,
        };
        let name = place_text(&path);
        if self.env.find(&name).is_none() {
            self.add(&name, MessageRead { path, length: false, ty, same_as: None });
        }
        Some(name)
    }

    /// The name of how long the sequence at a place is.
    pub fn read_length(&mut self, path: Vec<MessageStep>) -> String {
        let name = format!("length({})", place_text(&path));
        if self.env.find(&name).is_none() {
            let ty = Type::Int { lo: 0, hi: i64::from(u32::MAX) };
            self.add(&name, MessageRead { path, length: true, ty, same_as: None });
        }
        name
    }

    fn add(&mut self, name: &str, read: MessageRead) -> u16 {
        let at = self.env.next_local();
        self.env.push_typed(name, Span::default(), Noun::Field, read.ty);
        self.reads.push(read);
        at
    }

    /// Whether the first step is a field of the message: other names are for the scenario to know.
    pub fn begins_in(&self, steps: &[WrittenStep<'_>]) -> bool {
        let Some(WrittenStep::Field(first)) = steps.first() else { return false };
        self.shape.fields.iter().any(|(name, _)| *name == first.text)
    }

    /// A field with text, as a value of an enumeration.
    fn as_enumeration(&mut self, value: &TypedExpr, ty: Type) -> Option<TypedExpr> {
        let TypedExprKind::Leaf(VariableRef::Local(at)) = value.kind else { return None };
        let path = self.reads.get(usize::from(at))?.path.clone();
        // Of the same place as another type it is found by its number alone.
        let at = self.add("", MessageRead { path, length: false, ty, same_as: None });
        let kind = TypedExprKind::Leaf(VariableRef::Local(at));
        Some(TypedExpr { kind, ty: InferredType::of(ty), span: value.span })
    }
}

impl<'a> BindingPhase<'_, 'a> {
    pub(super) fn message_rule(
        &mut self,
        env: &mut MessageEnv<'_>,
        entry: &BindingEntry,
    ) -> Option<MessageRule<TypedExpr>> {
        let (effect, when) = match &entry.kind {
            Entry::Emit { emit, when } => {
                let (event, args) = self.emission_of(self.actor, emit, env)?;
                (Some(MessageEffect::Emit { event, args }), when)
            }
            Entry::Command { command, device, args, when } => {
                (self.message_command((command, device), args.as_deref(), entry.span, env), when)
            }
            Entry::Field { .. } | Entry::Joint { .. } | Entry::Error => return None,
        };
        let (condition, rising) = match when.as_ref().map(|w| (w, rising(w))) {
            Some((_, Some(inner))) => (Some(inner), true),
            Some((whole, None)) => (Some(whole), false),
            None => (None, false),
        };
        let guard = condition.map(|e| match self.placed(e, env) {
            Some(e) => self.expr_of(&e, InferredType::Bool, &mut env.env),
            None => TypedExpr::error(e.span),
        });
        Some(MessageRule { guard, rising, effect: effect?, origin: entry.span })
    }

    /// What a field of an answer asks of the message that is answered.
    pub(super) fn field_condition(
        &mut self,
        place: BindingPlace,
        when: &ast::ExprSyntax,
        env: &mut MessageEnv<'_>,
    ) -> TypedExpr {
        if !place.rules {
            self.report(bindings::no_condition(when.span));
            return TypedExpr::error(when.span);
        }
        match self.placed(when, env) {
            Some(e) => self.expr_of(&e, InferredType::Bool, &mut env.env),
            None => TypedExpr::error(when.span),
        }
    }

    /// `emit decided(true)`, where arguments are constants.
    pub(super) fn emission(
        &mut self,
        actor: ActorId,
        emit: &CallSyntax,
        env: &mut ExprEnv,
    ) -> Option<(EventId, Vec<TypedExpr>)> {
        let event = self.event(Noun::Event, &emit.name, None)?;
        self.owns(actor, event, emit);
        let fields = self.fields_of(event);
        let args = self.args(Noun::Event, emit, &fields, env);
        if let Some(bad) = args.iter().find(|a| a.constant().is_none() && a.ty != InferredType::Unknown) {
            self.report(types::not_constant(bad.span));
        }
        Some((event, args))
    }

    /// The same, where fields of the message are known: a number of a message counts in the unit that its place needs.
    fn emission_of(
        &mut self,
        actor: ActorId,
        emit: &CallSyntax,
        env: &mut MessageEnv<'_>,
    ) -> Option<(EventId, Vec<TypedExpr>)> {
        let event = self.event(Noun::Event, &emit.name, None)?;
        self.owns(actor, event, emit);
        let fields = self.fields_of(event);
        let args = match &emit.args {
            Some(args) => Some(self.all_placed(args, env)?),
            None => None,
        };
        let emit = CallSyntax { args, ..emit.clone() };
        let given = emit.args.as_deref().unwrap_or_default();
        let scalars = fields.iter().all(|(_, layout)| matches!(layout, TypeLayout::Scalar(_)));
        if given.len() != fields.len() || !scalars {
            let args = self.args(Noun::Event, &emit, &fields, &mut env.env);
            return Some((event, args));
        }
        let mut args = Vec::new();
        for (arg, (_, layout)) in given.iter().zip(fields.iter()) {
            let TypeLayout::Scalar(ty) = layout else { continue };
            args.push(self.message_argument(arg, *ty, env));
        }
        Some((event, args))
    }

    /// An argument in which the places of the message are names already.
    fn message_argument(&mut self, arg: &ast::ExprSyntax, ty: Type, env: &mut MessageEnv<'_>) -> TypedExpr {
        let want = InferredType::of(ty);
        let ExprItem::One(value) = self.item_due(arg, want, &mut env.env) else {
            return self.expr_for(arg, ty, &mut env.env);
        };
        if let (Type::Enum(_), InferredType::Text) = (ty, value.ty)
            && let Some(value) = env.as_enumeration(&value, ty)
        {
            return value;
        }
        self.in_si(value, want, env)
    }

    /// A bare number of a message, where a quantity is due, counts in its SI unit.
    fn in_si(&mut self, value: TypedExpr, want: InferredType, env: &mut MessageEnv<'_>) -> TypedExpr {
        let is_number = matches!(value.ty, InferredType::Int | InferredType::Float(Dimension::NUMBER));
        let due = matches!(want, InferredType::Float(dim) if dim != Dimension::NUMBER);
        if is_number && due && value.constant().is_none() {
            return TypedExpr { ty: want, ..value };
        }
        self.fit(value, want, &mut env.env)
    }

    fn message_command(
        &mut self,
        (command, device): (&ast::NameSyntax, &PathSyntax),
        args: Option<&[ast::ExprSyntax]>,
        span: Span,
        env: &mut MessageEnv<'_>,
    ) -> Option<MessageEffect<TypedExpr>> {
        let (body, id) = self.commanded(command, device, "")?;
        let params = self.command_params(body, id);
        let given = args.unwrap_or_default();
        let needed = params.iter().filter(|p| !p.optional).count();
        if given.len() < needed || given.len() > params.len() {
            let names: Vec<&str> = params.iter().map(|p| p.name.as_str()).collect();
            self.report(types::arity(Noun::Command, &command.text, &names, given.len(), span));
            return None;
        }
        let args: Vec<_> = params
            .iter()
            .zip(given)
            .map(|(param, arg)| self.command_argument(body, param, arg, env))
            .collect();
        let device = self.device_id(body);
        Some(MessageEffect::Command { device, command: id, args })
    }

    pub(super) fn command_params(&self, body: DeviceBody, id: DeviceCommandId) -> Vec<CommandParam> {
        let kind = self.s.device_kinds.iter().find(|kind| kind.sort == body.sort());
        let command = kind.and_then(|kind| kind.commands.get(usize::from(id.0)));
        command.map(|c| c.params.clone()).unwrap_or_default()
    }

    fn command_argument(
        &mut self,
        body: DeviceBody,
        param: &CommandParam,
        arg: &ast::ExprSyntax,
        env: &mut MessageEnv<'_>,
    ) -> Option<CommandArgument<TypedExpr>> {
        if param.ty.count != NumberCount::One
            && let Some(steps) = steps_of(arg).filter(|steps| env.begins_in(steps))
        {
            let path = self.place(env.shape, &steps)?;
            if env.shape.at(&path).is_some_and(FieldShape::is_numbers) {
                return Some(CommandArgument::Sequence(path));
            }
        }
        if let (NumberCount::List, Some(name)) = (param.ty.count, posture(arg)) {
            return self.posture_argument(body, name, arg.span, env);
        }
        let parts: &[ast::ExprSyntax] = match (&arg.kind, param.ty.count) {
            (_, NumberCount::One) => std::slice::from_ref(arg),
            (Syntax::Tuple(parts), NumberCount::Array(n)) if parts.len() == usize::from(n) => parts,
            (Syntax::List { items, rest: None }, NumberCount::List) => items,
            (_, NumberCount::Array(_) | NumberCount::List) => {
                self.report(bindings::other_argument(param, arg.span));
                return None;
            }
        };
        let ty = Type::Float(param.ty.unit);
        let parts = self.all_placed(parts, env)?;
        Some(CommandArgument::Numbers(parts.iter().map(|p| self.message_argument(p, ty, env)).collect()))
    }

    /// The angles of a posture of the arm, by a name that the message says, or that stands here.
    fn posture_argument(
        &mut self,
        body: DeviceBody,
        name: &ast::ExprSyntax,
        span: Span,
        env: &mut MessageEnv<'_>,
    ) -> Option<CommandArgument<TypedExpr>> {
        let (Some(world), DeviceBody::Arm(arm)) = (&self.s.world, body) else {
            self.report(bindings::no_postures(span));
            return None;
        };
        let postures = world.arms.get(usize::from(arm.0)).map(|arm| arm.postures.clone()).unwrap_or_default();
        if postures.is_empty() {
            self.report(bindings::no_postures(span));
            return None;
        }
        if let Some(steps) = steps_of(name).filter(|steps| env.begins_in(steps)) {
            let path = self.place(env.shape, &steps)?;
            if !matches!(env.shape.at(&path), Some(FieldShape::Scalar(MessageScalar::Text, _))) {
                self.report(bindings::no_posture_name(name.span));
                return None;
            }
            return Some(CommandArgument::Posture(TextOperand::Place(path)));
        }
        let value = self.expr_of(name, InferredType::Text, &mut ExprEnv::constants());
        let Some(crate::Value::Text(text)) = value.constant() else { return None };
        if !postures.iter().any(|posture| posture.name == text.as_str()) {
            let near = postures.iter().map(|posture| posture.name.as_str());
            self.report(names::unknown(Noun::Posture, text.as_str(), name.span, near));
            return None;
        }
        Some(CommandArgument::Posture(TextOperand::Literal(text.as_str().to_owned())))
    }
}

/// The name in `posture(…)`.
fn posture(arg: &ast::ExprSyntax) -> Option<&ast::ExprSyntax> {
    let Syntax::Call { callee, args } = &arg.kind else { return None };
    let ([name], [of]) = (callee.names.as_slice(), args.as_slice()) else { return None };
    (name.text == "posture").then_some(of)
}

/// The condition of `rising(…)`.
fn rising(when: &ast::ExprSyntax) -> Option<&ast::ExprSyntax> {
    let Syntax::Call { callee, args } = &when.kind else { return None };
    let ([name], [condition]) = (callee.names.as_slice(), args.as_slice()) else { return None };
    (name.text == "rising").then_some(condition)
}
