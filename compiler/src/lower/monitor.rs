//! Requirements → monitor automata.

use hrdsl_ir::{
    EventPattern, Expr, Nanos, Unit,
    expr::{BinaryOp, NumberFunction, OperatorSort, UnaryOp},
    monitor::{
        Assumption, Monitor, MonitorEdge, MonitorEffect, MonitorMargin, MonitorState, MonitorTrigger, StateId,
    },
    value::nanos,
    world::SignalId,
};
use hrdsl_model::{self as model, InferredType, TypedExprKind};
use hrdsl_source::SourceFiles;
use hrdsl_syntax::{RequirementPattern, ast};

use super::world::{SignalReader, SignalTable};
use MonitorEffect::{Discharge, Fail, ResetClock, Trigger};

/// The part of a monitor that its pattern decides.
#[derive(Default)]
struct PatternMachine {
    states: Vec<MonitorState>,
    edges: Vec<MonitorEdge>,
    signals: Vec<SignalId>,
    margin: Option<MonitorMargin>,
}

pub(crate) fn monitor(
    r: &model::TypedRequirement,
    files: &SourceFiles,
    signals: &mut SignalTable<'_>,
) -> Monitor {
    let machine = match &r.pattern {
        RequirementPattern::Causes { trigger, response, within } => {
            causes(trigger.clone(), response.clone(), within.map(nanos))
        }
        RequirementPattern::Forbids { trigger, forbidden, until } => {
            forbids(trigger.clone(), forbidden.clone(), until.clone())
        }
        RequirementPattern::Precedes { first, then } => precedes(first.clone(), then.clone()),
        RequirementPattern::NeverWhile { events, condition } => {
            never(events.clone(), condition.as_ref(), signals)
        }
        RequirementPattern::Globally(condition) => globally(condition, signals),
    };
    Monitor {
        name: r.name.clone(),
        kind: r.kind,
        title: r.title.clone(),
        text: one_line(files.text(r.text)),
        signals: machine.signals,
        states: machine.states,
        initial: StateId(0),
        edges: machine.edges,
        margin: machine.margin,
        origin: r.span,
    }
}

pub(crate) fn assumption(a: &model::TypedAssumption, files: &SourceFiles) -> Assumption {
    Assumption {
        text: one_line(files.text(a.text)),
        events: a.events.clone(),
        at_most: a.at_most,
        within: a.within,
        origin: a.origin,
    }
}

pub(crate) fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn state(name: &str, pending: bool, deadline: Option<Nanos>) -> MonitorState {
    MonitorState { name: name.to_owned(), pending, deadline }
}

fn edge(
    from: u16,
    to: u16,
    on: MonitorTrigger,
    guard: Option<Expr>,
    effects: &[MonitorEffect],
) -> MonitorEdge {
    MonitorEdge { from: StateId(from), to: StateId(to), on, guard, effects: effects.to_vec() }
}

/// While an answer is due, an event that is both answer and trigger answers.
fn causes(trigger: Vec<EventPattern>, response: Vec<EventPattern>, within: Option<Nanos>) -> PatternMachine {
    let mut edges = vec![
        edge(0, 1, MonitorTrigger::Event(trigger.clone()), None, &[Trigger, ResetClock]),
        edge(1, 0, MonitorTrigger::Event(response), None, &[Discharge]),
        edge(1, 1, MonitorTrigger::Event(trigger), None, &[Trigger]),
    ];
    if within.is_some() {
        edges.push(edge(1, 0, MonitorTrigger::Deadline, None, &[Fail]));
    }
    let states = vec![state("idle", false, None), state("pending", true, within)];
    PatternMachine { states, edges, ..PatternMachine::default() }
}

fn forbids(
    trigger: Vec<EventPattern>,
    forbidden: Vec<EventPattern>,
    until: Vec<EventPattern>,
) -> PatternMachine {
    let edges = vec![
        edge(0, 1, MonitorTrigger::Event(trigger.clone()), None, &[Trigger]),
        edge(1, 1, MonitorTrigger::Event(forbidden), None, &[Fail]),
        edge(1, 0, MonitorTrigger::Event(until), None, &[Discharge]),
        edge(1, 1, MonitorTrigger::Event(trigger), None, &[Trigger]),
    ];
    let states = vec![state("idle", false, None), state("armed", false, None)];
    PatternMachine { states, edges, ..PatternMachine::default() }
}

/// An event that is both comes first, and is allowed.
fn precedes(first: Vec<EventPattern>, then: Vec<EventPattern>) -> PatternMachine {
    let then = MonitorTrigger::Event(then);
    let edges = vec![
        edge(0, 1, MonitorTrigger::Event(first), None, &[]),
        edge(0, 0, then.clone(), None, &[Trigger, Fail]),
        edge(1, 1, then, None, &[Trigger, Discharge]),
    ];
    let states = vec![state("before", false, None), state("after", false, None)];
    PatternMachine { states, edges, ..PatternMachine::default() }
}

/// The margin is that of the negated condition, at the events.
fn never(
    events: Vec<EventPattern>,
    condition: Option<&model::TypedExpr>,
    signals: &mut SignalTable<'_>,
) -> PatternMachine {
    let mut reader = SignalReader::new(signals);
    let guard = condition.map(|c| reader.expr(c));
    let margin = condition.and_then(|c| margin(c, false, &mut reader));
    let mut edges = vec![edge(0, 0, MonitorTrigger::Event(events.clone()), guard, &[Trigger, Fail])];
    if condition.is_some() {
        edges.push(edge(0, 0, MonitorTrigger::Event(events.clone()), None, &[Trigger, Discharge]));
    }
    PatternMachine {
        states: vec![state("watch", false, None)],
        edges,
        signals: reader.read(),
        margin: margin.map(|(value, unit)| MonitorMargin { value, unit, at: events }),
    }
}

/// The first sample triggers; each time the condition ceases to hold is one failure.
fn globally(condition: &model::TypedExpr, signals: &mut SignalTable<'_>) -> PatternMachine {
    let mut reader = SignalReader::new(signals);
    let holds = reader.expr(condition);
    let broken = not(holds.clone());
    let margin = margin(condition, true, &mut reader);
    let edges = vec![
        edge(0, 2, MonitorTrigger::Sample, Some(broken.clone()), &[Trigger, Fail]),
        edge(0, 1, MonitorTrigger::Sample, Some(holds.clone()), &[Trigger]),
        edge(1, 2, MonitorTrigger::Sample, Some(broken), &[Fail]),
        edge(2, 1, MonitorTrigger::Sample, Some(holds), &[]),
    ];
    let states =
        vec![state("unseen", false, None), state("seen", false, None), state("violated", false, None)];
    PatternMachine {
        states,
        edges,
        signals: reader.read(),
        margin: margin.map(|(value, unit)| MonitorMargin { value, unit, at: Vec::new() }),
    }
}

fn not(e: Expr) -> Expr {
    Expr::Unary(UnaryOp::Not, Box::new(e))
}

/// The robustness of a condition (of its negation, if not `positive`): `a < c` has c − a, a conjunction the least of its
/// parts, a disjunction the greatest (Fainekos and Pappas, 2009). `None` if some part is not a comparison of numbers, or
/// the parts' units differ.
fn margin(e: &model::TypedExpr, positive: bool, reader: &mut SignalReader<'_, '_>) -> Option<(Expr, Unit)> {
    match &e.kind {
        TypedExprKind::Unary(ast::UnaryOp::Not, a) => margin(a, !positive, reader),
        TypedExprKind::Binary(op @ (BinaryOp::And | BinaryOp::Or), a, b) => {
            let ((a, unit), (b, other)) = (margin(a, positive, reader)?, margin(b, positive, reader)?);
            let least = (*op == BinaryOp::And) == positive;
            let pick = if least { NumberFunction::Min } else { NumberFunction::Max };
            (unit == other).then(|| (Expr::Call(pick, vec![a, b]), unit))
        }
        TypedExprKind::Binary(op, a, b) => {
            if op.sort() != OperatorSort::Order {
                return None;
            }
            let smaller_first = matches!(op, BinaryOp::Lt | BinaryOp::Le);
            let unit = match a.ty {
                InferredType::Float(dim) => dim.unit(),
                InferredType::Int
                | InferredType::Bool
                | InferredType::Enum(_)
                | InferredType::Text
                | InferredType::List(_)
                | InferredType::Unknown => Unit::None,
            };
            let (a, b) = (reader.expr(a), reader.expr(b));
            let (small, large) = if smaller_first == positive { (a, b) } else { (b, a) };
            Some((Expr::binary(BinaryOp::Sub, large, small), unit))
        }
        TypedExprKind::Unary(ast::UnaryOp::Neg, _)
        | TypedExprKind::Const(_)
        | TypedExprKind::Leaf(_)
        | TypedExprKind::Term(_)
        | TypedExprKind::If(..)
        | TypedExprKind::Call(..)
        | TypedExprKind::List(..)
        | TypedExprKind::Element(_)
        | TypedExprKind::Apply(..)
        | TypedExprKind::Error => None,
    }
}
