//! Where a body is: along an axis of the world, or how far from a place, or from another body, along some axes.

use hrdsl_ir::{
    Expr,
    expr::{BinaryOp, NumberFunction},
    world::{Axis, SignalId, SignalTerm},
};

use super::{about::MeasureSubject, asked::constant, run::ReplayedRun, tracks::bodies_of};
use crate::requirement::{MeasureAxis, MeasureKind};

/// Signals may be read by signals so often: deeper ones would be a loop.
const DEEPEST: usize = 16;

/// A coordinate of a body, and what it is held against: a number, and perhaps the same coordinate of another body.
struct PartOffset {
    axis: MeasureAxis,
    body: usize,
    other: Option<usize>,
    place: f64,
}

/// `base.x`, `abs(base.x - 1 m)`, `norm((base.x - 1 m, base.y))`, `abs(head.y - leg.y)`: of one body along axes of the world.
pub(super) fn offset(run: &ReplayedRun<'_>, signals: &[SignalId], measured: &Expr) -> Option<MeasureSubject> {
    if let Expr::Var(slot) = measured {
        let (body, axis) = coordinate(run, signals, *slot)?;
        // A height has a picture of its own.
        return (axis != MeasureAxis::Z).then(|| MeasureSubject {
            kind: MeasureKind::Coordinate,
            bodies: vec![body],
            axes: vec![axis],
            ..MeasureSubject::default()
        });
    }
    let Expr::Call(NumberFunction::Abs | NumberFunction::Norm, parts) = measured else { return None };
    let parts: Vec<PartOffset> =
        parts.iter().map(|part| of_part(run, signals, part)).collect::<Option<_>>()?;
    let first = parts.first()?;
    let is_one = |part: &PartOffset| part.body == first.body && part.other == first.other;
    let axes: Vec<MeasureAxis> = parts.iter().map(|part| part.axis).collect();
    let is_once = axes.iter().enumerate().all(|(at, axis)| !axes.iter().take(at).any(|other| other == axis));
    (parts.iter().all(is_one) && is_once).then(|| MeasureSubject {
        kind: MeasureKind::Offset,
        bodies: std::iter::once(first.body).chain(first.other).collect(),
        place: parts.iter().map(|part| part.place).collect(),
        axes,
        within: None,
    })
}

fn of_part(run: &ReplayedRun<'_>, signals: &[SignalId], part: &Expr) -> Option<PartOffset> {
    let of = |slot: u16| coordinate(run, signals, slot);
    match part {
        Expr::Var(slot) => {
            let (body, axis) = of(*slot)?;
            Some(PartOffset { axis, body, other: None, place: 0.0 })
        }
        Expr::Binary(op @ (BinaryOp::Sub | BinaryOp::Add), a, b) => match (&**a, &**b) {
            (Expr::Var(one), Expr::Var(two)) if *op == BinaryOp::Sub => {
                let ((body, axis), (other, along)) = (of(*one)?, of(*two)?);
                (axis == along).then_some(PartOffset { axis, body, other: Some(other), place: 0.0 })
            }
            (Expr::Var(slot), number) | (number, Expr::Var(slot)) => {
                let (body, axis) = of(*slot)?;
                let number = constant(number)?;
                let place = if *op == BinaryOp::Sub { number } else { -number };
                Some(PartOffset { axis, body, other: None, place })
            }
            _ => None,
        },
        Expr::Binary(..)
        | Expr::Const(_)
        | Expr::Unary(..)
        | Expr::Call(..)
        | Expr::If(..)
        | Expr::List(..)
        | Expr::Element(_)
        | Expr::Apply(..) => None,
    }
}

/// The coordinate that a signal is, and nothing else, now.
fn coordinate(run: &ReplayedRun<'_>, signals: &[SignalId], slot: u16) -> Option<(usize, MeasureAxis)> {
    let mut id = *signals.get(usize::from(slot))?;
    for _ in 0..DEEPEST {
        let signal = run.program.signal(id);
        let ([term], Expr::Var(0)) = (&signal.terms[..], &signal.value) else { return None };
        if let SignalTerm::Coordinate(_, axis) = term {
            return Some((*bodies_of(run, term).first()?, axis_of(*axis)));
        }
        let SignalTerm::Reading(of) = term else { return None };
        id = *of;
    }
    None
}

pub(super) fn axis_of(axis: Axis) -> MeasureAxis {
    match axis {
        Axis::X => MeasureAxis::X,
        Axis::Y => MeasureAxis::Y,
        Axis::Z => MeasureAxis::Z,
    }
}
