//! What a message makes happen: events of the system's actor, commands to its devices.

use hrdsl_ir::{
    binding::{
        CommandArgument, MessageEffect, MessageRead, MessageRule, MessageScalar, MessageStep, place_text,
    },
    device::{CommandParam, DeviceBody, NumberCount},
    world::DeviceCommandId,
};
use hrdsl_source::Span;
use hrdsl_syntax::ast::{
    self, BindingEntry, BindingEntryKind as Entry, CallSyntax, ExprSyntaxKind as Syntax, PathSyntax,
};

use super::{
    BindingScope,
    shape::{FieldShape, MessageShape},
};
use crate::check::{
    checker::Checker,
    state::{item::ExprItem, scope::ExprEnv},
};
use crate::{
    ActorId, Dimension, EventId, InferredType, Type, TypedExpr, TypedExprKind, VariableRef,
    noun::Noun,
    report::{bindings, types},
    types::TypeLayout,
    world::TypedRuleTrigger,
};

/// What the rules of a message can read.
pub(super) struct MessageEnv<'s> {
    pub env: ExprEnv,
    /// By the number of the local.
    pub reads: Vec<MessageRead>,
    shape: &'s MessageShape,
}

impl<'s> MessageEnv<'s> {
    pub fn new(shape: &'s MessageShape) -> Self {
        let mut this =
            Self { env: ExprEnv { noun: Some(Noun::Field), ..ExprEnv::default() }, reads: Vec::new(), shape };
        for (path, scalar) in shape.scalars() {
            let ty = match scalar {
                MessageScalar::Bool => Type::Bool,
                MessageScalar::Int { lo, hi } => Type::Int { lo, hi },
                MessageScalar::Float => Type::Float(hrdsl_ir::Unit::None),
                MessageScalar::Text => Type::Text,
                MessageScalar::Time => continue,
            };
            this.add(path, ty);
        }
        this
    }

    fn add(&mut self, path: Vec<MessageStep>, ty: Type) -> u16 {
        // Of the same place as another type it is found by its number alone.
        let name = place_text(&path);
        let name = if self.env.find(&name).is_some() { String::new() } else { name };
        self.reads.push(MessageRead { path, ty, same_as: None });
        let at = self.env.next_local();
        self.env.push_typed(&name, Span::default(), Noun::Field, ty);
        at
    }

    /// A field with text, as a value of an enumeration.
    fn as_enumeration(&mut self, value: &TypedExpr, ty: Type) -> Option<TypedExpr> {
        let TypedExprKind::Leaf(VariableRef::Local(at)) = value.kind else { return None };
        let path = self.reads.get(usize::from(at))?.path.clone();
        let at = self.add(path, ty);
        let kind = TypedExprKind::Leaf(VariableRef::Local(at));
        Some(TypedExpr { kind, ty: InferredType::of(ty), span: value.span })
    }

    /// The sequence of numbers that a path names.
    fn sequence(&self, path: &PathSyntax) -> Option<Vec<MessageStep>> {
        let steps: Vec<MessageStep> = path.names.iter().map(|n| MessageStep::Field(n.text.clone())).collect();
        match self.shape.at(&steps)? {
            FieldShape::Sequence { numbers: true } => Some(steps),
            FieldShape::Array(elements) => {
                let number = |e: &FieldShape| {
                    matches!(e, FieldShape::Scalar(MessageScalar::Float | MessageScalar::Int { .. }, _))
                };
                elements.iter().all(number).then_some(steps)
            }
            FieldShape::Sequence { .. } | FieldShape::Scalar(..) | FieldShape::Message(_) => None,
        }
    }
}

impl<'a> Checker<'a> {
    pub(super) fn message_rule(
        &mut self,
        scope: BindingScope<'a>,
        env: &mut MessageEnv<'_>,
        entry: &BindingEntry,
    ) -> Option<MessageRule<TypedExpr>> {
        let (effect, when) = match &entry.kind {
            Entry::Emit { emit, when } => {
                let (event, args) = self.emission_of(scope.actor, emit, env)?;
                (Some(MessageEffect::Emit { event, args }), when)
            }
            Entry::Command { command, device, args, when } => {
                (self.message_command((command, device), args.as_deref(), entry.span, env), when)
            }
            Entry::Field { .. } | Entry::Error => return None,
        };
        let (condition, rising) = match when.as_ref().map(|w| (w, rising(w))) {
            Some((_, Some(inner))) => (Some(inner), true),
            Some((whole, None)) => (Some(whole), false),
            None => (None, false),
        };
        let guard = condition.map(|e| {
            if !self.known_fields(e, env) {
                return TypedExpr::error(e.span);
            }
            self.expr_of(e, InferredType::Bool, &mut env.env)
        });
        Some(MessageRule { guard, rising, effect: effect?, origin: entry.span })
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
        let given = emit.args.as_deref().unwrap_or_default();
        let scalars = fields.iter().all(|(_, layout)| matches!(layout, TypeLayout::Scalar(_)));
        if given.len() != fields.len() || !scalars {
            let args = self.args(Noun::Event, emit, &fields, &mut env.env);
            return Some((event, args));
        }
        let mut args = Vec::new();
        for (arg, (_, layout)) in given.iter().zip(fields.iter()) {
            let TypeLayout::Scalar(ty) = layout else { continue };
            args.push(self.message_argument(arg, *ty, env));
        }
        Some((event, args))
    }

    fn message_argument(&mut self, arg: &ast::ExprSyntax, ty: Type, env: &mut MessageEnv<'_>) -> TypedExpr {
        if !self.known_fields(arg, env) {
            return TypedExpr::error(arg.span);
        }
        let want = InferredType::of(ty);
        let value = match self.item_due(arg, want, &mut env.env) {
            ExprItem::One(value) => value,
            _ => return self.expr_for(arg, ty, &mut env.env),
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
        let TypedRuleTrigger::Commanded { device: body, command: id } =
            self.commanded(command, device, "")?
        else {
            return None;
        };
        let params = self.command_params(body, id);
        let given = args.unwrap_or_default();
        let needed = params.iter().filter(|p| !p.optional).count();
        if given.len() < needed || given.len() > params.len() {
            let names: Vec<&str> = params.iter().map(|p| p.name.as_str()).collect();
            self.report(types::arity(Noun::Command, &command.text, &names, given.len(), span));
            return None;
        }
        let args: Vec<_> =
            params.iter().zip(given).map(|(param, arg)| self.command_argument(param, arg, env)).collect();
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
        param: &CommandParam,
        arg: &ast::ExprSyntax,
        env: &mut MessageEnv<'_>,
    ) -> Option<CommandArgument<TypedExpr>> {
        if param.ty.count != NumberCount::One
            && let Syntax::Path(path) = &arg.kind
            && let Some(steps) = env.sequence(path)
        {
            return Some(CommandArgument::Sequence(steps));
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
        Some(CommandArgument::Numbers(parts.iter().map(|p| self.message_argument(p, ty, env)).collect()))
    }

    /// Whether all paths that begin in the message end in it; says where one leaves it.
    fn known_fields(&mut self, e: &ast::ExprSyntax, env: &MessageEnv<'_>) -> bool {
        let (mut paths, mut all_known) = (Vec::new(), true);
        collect_paths(e, &mut paths);
        for path in paths {
            let text: Vec<&str> = path.names.iter().map(|n| n.text.as_str()).collect();
            if path.names.len() < 2 || env.env.find(&text.join(".")).is_some() {
                continue;
            }
            let mut steps = vec![MessageStep::Field(text[0].to_owned())];
            for name in &path.names[1..] {
                let Some(FieldShape::Message(inner)) = env.shape.at(&steps) else { break };
                if inner.fields.iter().all(|(n, _)| *n != name.text) {
                    let known = inner.fields.iter().map(|(n, _)| n.as_str());
                    let issue = bindings::unknown_field(&name.text, &place_text(&steps), name.span, known);
                    self.report(issue);
                    all_known = false;
                    break;
                }
                steps.push(MessageStep::Field(name.text.clone()));
            }
        }
        all_known
    }
}

/// All names with their parts, in operators and arguments.
fn collect_paths<'e>(e: &'e ast::ExprSyntax, all: &mut Vec<&'e PathSyntax>) {
    match &e.kind {
        Syntax::Path(path) => all.push(path),
        Syntax::Call { args, .. } => args.iter().for_each(|a| collect_paths(a, all)),
        Syntax::Unary { operand, .. } => collect_paths(operand, all),
        Syntax::Binary { left, right, .. } => {
            collect_paths(left, all);
            collect_paths(right, all);
        }
        Syntax::If { condition, then, otherwise } => {
            [condition, then, otherwise].into_iter().for_each(|part| collect_paths(part, all));
        }
        _ => {}
    }
}

/// The condition of `rising(…)`.
fn rising(when: &ast::ExprSyntax) -> Option<&ast::ExprSyntax> {
    let Syntax::Call { callee, args } = &when.kind else { return None };
    let ([name], [condition]) = (callee.names.as_slice(), args.as_slice()) else { return None };
    (name.text == "rising").then_some(condition)
}
