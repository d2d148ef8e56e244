//! What a requirement compares with a limit, as far as it can be drawn.

use hrdsl_ir::{
    Expr, Nanos, Type,
    expr::BinaryOp,
    monitor::Monitor,
    world::{Signal, SignalTerm},
};

use super::{
    ReplayedRun,
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
        let id = monitor.signals.get(usize::from(slot))?;
        Some(measure_of(run, run.program.signal(*id), relation, limit, at))
    };
    found.into_iter().filter_map(measure).collect()
}

/// A margin is `a − b` of a comparison, or the least or greatest of several.
fn compared(expr: &Expr, found: &mut Vec<(u16, LimitRelation, f64)>) {
    match expr {
        Expr::Binary(BinaryOp::Sub, large, small) => match (large.as_ref(), small.as_ref()) {
            (Expr::Var(slot), Expr::Const(limit)) => {
                found.extend(limit.as_f64().map(|limit| (*slot, LimitRelation::AtLeast, limit)));
            }
            (Expr::Const(limit), Expr::Var(slot)) => {
                found.extend(limit.as_f64().map(|limit| (*slot, LimitRelation::AtMost, limit)));
            }
            (_, _) => {}
        },
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
