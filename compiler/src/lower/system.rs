//! Systems: what their bindings read of the world becomes signals, and what they read of messages only that.

use hrdsl_ir::{
    Expr, Type, Value,
    binding::{
        BoundAction, BoundService, CommandArgument, GapCase, GapRead, GapValue, MessageEffect, MessageGap,
        MessageRead, MessageRule, MessageRules, MessageTemplate, MiddlewareBinding, TextOperand, TopicInput,
        TopicOutput,
    },
    expr::{BinaryOp, UnaryOp},
    system::SystemUnderTest,
    world::SignalId,
};
use hrdsl_model::{TypedExpr, VariableRef};

use super::{
    expr::{LeafSource, expr, ruled_out},
    world::SignalTable,
};

pub(crate) fn system(system: &SystemUnderTest<TypedExpr>, signals: &mut SignalTable<'_>) -> SystemUnderTest {
    SystemUnderTest {
        name: system.name.clone(),
        actor: system.actor,
        programs: system.programs.clone(),
        limit: system.limit,
        budget: system.budget,
        cpu: system.cpu,
        wall: system.wall,
        memory: system.memory,
        output: system.output,
        env: system.env.clone(),
        online: system.online,
        binding: system.binding.as_ref().map(|b| binding(b, signals)),
        origin: system.origin,
    }
}

fn binding(b: &MiddlewareBinding<TypedExpr>, signals: &mut SignalTable<'_>) -> MiddlewareBinding {
    let input = |t: &TopicInput<TypedExpr>| TopicInput {
        topic: t.topic.clone(),
        interface: t.interface.clone(),
        period: t.period,
        latched: t.latched,
        message: template(&t.message, signals),
        origin: t.origin,
    };
    let inputs = b.inputs.iter().map(input).collect();
    let output = |t: &TopicOutput<TypedExpr>| TopicOutput {
        topic: t.topic.clone(),
        interface: t.interface.clone(),
        rules: rules(&t.rules),
        origin: t.origin,
    };
    let service = |s: &BoundService<TypedExpr>, signals: &mut SignalTable<'_>| BoundService {
        service: s.service.clone(),
        interface: s.interface.clone(),
        rules: rules(&s.rules),
        response: template(&s.response, signals),
        origin: s.origin,
    };
    let action = |a: &BoundAction<TypedExpr>, signals: &mut SignalTable<'_>| BoundAction {
        action: a.action.clone(),
        interface: a.interface.clone(),
        rules: rules(&a.rules),
        result: template(&a.result, signals),
        origin: a.origin,
    };
    MiddlewareBinding {
        kind: b.kind,
        packages: b.packages.clone(),
        inputs,
        outputs: b.outputs.iter().map(output).collect(),
        services: b.services.iter().map(|s| service(s, signals)).collect(),
        actions: b.actions.iter().map(|a| action(a, signals)).collect(),
        groups: b.groups.clone(),
        parameters: b.parameters.clone(),
        transitions: b.transitions.clone(),
        origin: b.origin,
    }
}

fn template(t: &MessageTemplate<TypedExpr>, signals: &mut SignalTable<'_>) -> MessageTemplate {
    MessageTemplate { text: t.text.clone(), gaps: t.gaps.iter().map(|g| gap(g, signals)).collect() }
}

fn gap(gap: &MessageGap<TypedExpr>, signals: &mut SignalTable<'_>) -> MessageGap {
    let value = match &gap.value {
        GapValue::Held { events, time } => GapValue::Held { events: events.clone(), time: *time },
        GapValue::Now => GapValue::Now,
        GapValue::Told { device, what, numbers } => {
            GapValue::Told { device: *device, what: *what, numbers: *numbers }
        }
        GapValue::Fixed(json) => GapValue::Fixed(json.clone()),
        GapValue::Value { value, reads } => read_value(value, reads, signals),
        GapValue::Whole(whole) => GapValue::Whole(template(whole, signals)),
        GapValue::Chosen { cases, otherwise } => {
            let case = |case: &GapCase<TypedExpr>| GapCase {
                condition: case.condition,
                gap: self::gap(&case.gap, signals),
            };
            GapValue::Chosen { cases: cases.iter().map(case).collect(), otherwise: otherwise.clone() }
        }
    };
    MessageGap { value, scalar: gap.scalar }
}

/// Only what the expression reads is kept, arguments of events and signals alike.
fn read_value(value: &TypedExpr, reads: &[GapRead], signals: &mut SignalTable<'_>) -> GapValue {
    let mut kept: Vec<GapRead> = Vec::new();
    let value = expr(value, &mut |source| {
        let signal = |at: usize| GapRead::Signal(SignalId(u16::try_from(at).unwrap_or(u16::MAX)));
        let read = match source {
            LeafSource::Term(term, e) => signal(signals.of_term(term, e.span)),
            LeafSource::Leaf(VariableRef::Signal(id)) => signal(usize::from(id.0)),
            LeafSource::Leaf(VariableRef::Local(at)) => match reads.get(usize::from(at)) {
                Some(read) => *read,
                None => ruled_out("local that a binding does not read"),
            },
            LeafSource::Leaf(VariableRef::Own(_) | VariableRef::Shared(_)) => {
                ruled_out("variable of an automaton in a binding")
            }
        };
        var(&mut kept, read)
    });
    GapValue::Value { value, reads: kept }
}

/// The variable that stands for what is read.
fn var<T: PartialEq>(kept: &mut Vec<T>, read: T) -> Expr {
    let at = kept.iter().position(|known| *known == read).unwrap_or_else(|| {
        kept.push(read);
        kept.len() - 1
    });
    Expr::Var(u16::try_from(at).unwrap_or(u16::MAX))
}

fn rules(r: &MessageRules<TypedExpr>) -> MessageRules {
    let mut kept: Vec<MessageRead> = Vec::new();
    let mut lower = |e: &TypedExpr| {
        let whole = expr(e, &mut |source| match source {
            LeafSource::Leaf(VariableRef::Local(at)) => match r.reads.get(usize::from(at)) {
                Some(read) => var(&mut kept, read.clone()),
                None => ruled_out("local that a rule does not read"),
            },
            LeafSource::Leaf(VariableRef::Own(_) | VariableRef::Shared(_) | VariableRef::Signal(_))
            | LeafSource::Term(..) => ruled_out("rule that reads more than its message"),
        });
        with_texts_compared(whole, &mut kept)
    };
    let rules = r.rules.iter().map(|rule| rule_of(rule, &mut lower)).collect();
    let conditions = r.conditions.iter().map(&mut lower).collect();
    MessageRules { reads: kept, rules, conditions }
}

/// The same expression, in which texts are compared where they are read, and are no values.
fn with_texts_compared(e: Expr, reads: &mut Vec<MessageRead>) -> Expr {
    match e {
        Expr::Unary(op, a) => Expr::Unary(op, Box::new(with_texts_compared(*a, reads))),
        Expr::Binary(op, a, b) => match (op, same_text(&a, &b, reads)) {
            (BinaryOp::Eq, Some(same)) => same,
            (BinaryOp::Ne, Some(same)) => Expr::Unary(UnaryOp::Not, Box::new(same)),
            (_, _) => {
                let a = with_texts_compared(*a, reads);
                Expr::binary(op, a, with_texts_compared(*b, reads))
            }
        },
        Expr::If(c, a, b) => {
            let [c, a, b] = [c, a, b].map(|part| Box::new(with_texts_compared(*part, reads)));
            Expr::If(c, a, b)
        }
        Expr::Call(f, args) => {
            Expr::Call(f, args.into_iter().map(|arg| with_texts_compared(arg, reads)).collect())
        }
        // INVARIANT: rules have no lists and no functions, and constants and fields compare nothing.
        Expr::Const(_) | Expr::Var(_) | Expr::List(..) | Expr::Element(_) | Expr::Apply(..) => e,
    }
}

/// Whether two texts are the same; `None`: they are no texts.
fn same_text(a: &Expr, b: &Expr, reads: &mut Vec<MessageRead>) -> Option<Expr> {
    let text_at = |at: &u16| reads.get(usize::from(*at)).filter(|read| read.ty == Type::Text).cloned();
    let (read, same_as) = match (a, b) {
        (Expr::If(c, then, otherwise), other) | (other, Expr::If(c, then, otherwise)) => {
            let then = same_text(then, other, reads)?;
            let otherwise = same_text(otherwise, other, reads)?;
            let c = with_texts_compared((**c).clone(), reads);
            return Some(Expr::If(Box::new(c), Box::new(then), Box::new(otherwise)));
        }
        (Expr::Const(Value::Text(a)), Expr::Const(Value::Text(b))) => return Some(Expr::bool(a == b)),
        (Expr::Var(at), Expr::Const(Value::Text(text))) | (Expr::Const(Value::Text(text)), Expr::Var(at)) => {
            (text_at(at)?, TextOperand::Literal(text.as_str().to_owned()))
        }
        (Expr::Var(a), Expr::Var(b)) => (text_at(a)?, TextOperand::Place(text_at(b)?.path)),
        (_, _) => return None,
    };
    Some(var(reads, MessageRead { same_as: Some(same_as), ..read }))
}

fn rule_of(rule: &MessageRule<TypedExpr>, lower: &mut dyn FnMut(&TypedExpr) -> Expr) -> MessageRule {
    let effect = match &rule.effect {
        MessageEffect::Emit { event, args } => {
            MessageEffect::Emit { event: *event, args: args.iter().map(&mut *lower).collect() }
        }
        MessageEffect::Command { device, command, args } => {
            let argument = |arg: &Option<CommandArgument<TypedExpr>>| {
                Some(match arg.as_ref()? {
                    CommandArgument::Numbers(all) => {
                        CommandArgument::Numbers(all.iter().map(&mut *lower).collect())
                    }
                    CommandArgument::Sequence(path) => CommandArgument::Sequence(path.clone()),
                    CommandArgument::Wildcard { names } => CommandArgument::Wildcard { names: names.clone() },
                    CommandArgument::TrackPositions { names } => {
                        CommandArgument::TrackPositions { names: names.clone() }
                    }
                    CommandArgument::TrackTimes => CommandArgument::TrackTimes,
                    CommandArgument::Posture(name) => CommandArgument::Posture(name.clone()),
                })
            };
            let args = args.iter().map(argument).collect();
            MessageEffect::Command { device: *device, command: *command, args }
        }
    };
    let guard = rule.guard.as_ref().map(lower);
    MessageRule { guard, rising: rule.rising, effect, origin: rule.origin }
}
