//! What a requirement compares with a limit, as far as it can be drawn.

use hrdsl_ir::{
    Expr, Nanos, Type, Value,
    expr::{BinaryOp, NumberFunction},
    monitor::Monitor,
    world::{Signal, SignalId, SignalTerm},
};
use hrdsl_trace::TraceStepKind;

use super::{
    run::ReplayedRun,
    tracks::{bodies_of, place_at},
};
use crate::requirement::{LimitRelation, MeasureKind, ViewMeasure};

/// The comparisons in a monitor's margin, of which each is with a limit; `at` is the instant that is looked at first.
pub(super) fn measures(run: &ReplayedRun<'_>, monitor: &Monitor, at: Nanos) -> Vec<ViewMeasure> {
    let mut found = Vec::new();
    if let Some(margin) = &monitor.margin {
        compared(&margin.value, &mut found);
    }
    let measure = |(slot, relation, limit): (u16, LimitRelation, f64)| {
        let id = *monitor.signals.get(usize::from(slot))?;
        let value = value_at(run, id, at).unwrap_or(f64::NAN);
        let margin = match relation {
            LimitRelation::Below | LimitRelation::AtMost => limit - value,
            LimitRelation::Above | LimitRelation::AtLeast => value - limit,
        };
        Some((margin, measure_of(run, run.program.signal(id), relation, limit, at)))
    };
    let mut measures: Vec<(f64, ViewMeasure)> = found.into_iter().filter_map(measure).collect();
    // The first is drawn: the one that is worst then.
    measures.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    measures.into_iter().map(|(_, measure)| measure).collect()
}

/// The latest value of a signal at a time.
fn value_at(run: &ReplayedRun<'_>, id: SignalId, at: Nanos) -> Option<f64> {
    let known = run.trace.steps.iter().rev().filter(|step| step.time <= at);
    let mut samples = known.filter_map(|step| match &step.what {
        TraceStepKind::Sample { signal, value } if *signal == id => Some(*value),
        TraceStepKind::Sample { .. } | TraceStepKind::Event { .. } | TraceStepKind::Machine(_) => None,
    });
    samples.next().and_then(Value::as_f64)
}

/// A margin is `a − b` of a comparison, or the least or greatest of several; so may be what is compared.
fn compared(expr: &Expr, found: &mut Vec<(u16, LimitRelation, f64)>) {
    match expr {
        Expr::Binary(BinaryOp::Sub, large, small) => {
            let sides = [(large, small, LimitRelation::AtLeast), (small, large, LimitRelation::AtMost)];
            for (measured, limit, relation) in sides {
                if let Expr::Const(limit) = limit.as_ref()
                    && let Some(limit) = limit.as_f64()
                {
                    let mut slots = Vec::new();
                    measured_slots(measured, &mut slots);
                    found.extend(slots.into_iter().map(|slot| (slot, relation, limit)));
                }
            }
        }
        Expr::Call(_, parts) => parts.iter().for_each(|part| compared(part, found)),
        Expr::Const(_)
        | Expr::Var(_)
        | Expr::Unary(..)
        | Expr::Binary(..)
        | Expr::If(..)
        | Expr::List(..)
        | Expr::Element(_)
        | Expr::Apply(..) => {}
    }
}

/// The signals of which the least or the greatest is compared, or the one that is.
fn measured_slots(expr: &Expr, slots: &mut Vec<u16>) {
    match expr {
        Expr::Var(slot) => slots.push(*slot),
        Expr::Call(NumberFunction::Min | NumberFunction::Max, parts) => {
            parts.iter().for_each(|part| measured_slots(part, slots));
        }
        Expr::Call(..)
        | Expr::Const(_)
        | Expr::Unary(..)
        | Expr::Binary(..)
        | Expr::If(..)
        | Expr::List(..)
        | Expr::Element(_)
        | Expr::Apply(..) => {}
    }
}

fn measure_of(
    run: &ReplayedRun<'_>,
    signal: &Signal,
    relation: LimitRelation,
    limit: f64,
    at: Nanos,
) -> ViewMeasure {
    let unit = match signal.ty {
        Type::Float(unit) => unit.symbol(),
        Type::Bool | Type::Int { .. } | Type::Enum(_) | Type::Text | Type::List(_) => "",
    };
    let kinds: Vec<MeasureKind> = signal.terms.iter().map(kind).collect();
    let is_one = kinds.first().is_some_and(|first| kinds.iter().all(|kind| kind == first));
    ViewMeasure {
        kind: kinds.first().copied().filter(|_| is_one).unwrap_or_default(),
        name: signal.name.clone(),
        bodies: if is_one { nearest(run, &signal.terms, at) } else { Vec::new() },
        relation,
        limit,
        unit: (!unit.is_empty()).then(|| unit.to_owned()),
        points: None,
    }
}

/// Of several distances, the bodies of that whose bodies are nearest to each other then.
fn nearest(run: &ReplayedRun<'_>, terms: &[SignalTerm], at: Nanos) -> Vec<usize> {
    let apart = |bodies: &Vec<usize>| {
        let mut places = bodies.iter().filter_map(|body| place_at(run, *body, at));
        let (Some(a), Some(b)) = (places.next(), places.next()) else { return 0.0 };
        a.iter().zip(&b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>()
    };
    let of = terms.iter().map(|term| bodies_of(run, term));
    of.min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap_or_default()
}

fn kind(term: &SignalTerm) -> MeasureKind {
    match term {
        SignalTerm::Distance(..) | SignalTerm::Range(..) => MeasureKind::Distance,
        SignalTerm::Angle(..) | SignalTerm::Tilt(_) => MeasureKind::Angle,
        SignalTerm::Speed(_) => MeasureKind::Speed,
        SignalTerm::Force(..)
        | SignalTerm::ForceOn(_)
        | SignalTerm::Pressed { .. }
        | SignalTerm::Weight(_) => MeasureKind::Force,
        SignalTerm::Visible(..)
        | SignalTerm::Coordinate(..)
        | SignalTerm::Holds(..)
        | SignalTerm::HoldsAny(_)
        | SignalTerm::JointSpeed(_)
        | SignalTerm::JointRate(_)
        | SignalTerm::JointPosition(_)
        | SignalTerm::JointEffort(_)
        | SignalTerm::Touches(..)
        | SignalTerm::Pressure { .. }
        | SignalTerm::Nearest { .. }
        | SignalTerm::Height(_)
        | SignalTerm::Delta(..)
        | SignalTerm::Reading(_)
        | SignalTerm::Heading(_)
        | SignalTerm::Orientation(..) => MeasureKind::Signal,
    }
}
