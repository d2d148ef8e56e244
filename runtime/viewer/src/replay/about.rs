//! What a number over signals is about: which bodies, and what is drawn of it in the scene.

use hrdsl_ir::{
    Expr, Nanos, Program,
    expr::{NumberFunction, UnaryOp},
    value::seconds,
    world::{Axis, SignalId, SignalTerm},
};

use super::{
    offset,
    run::ReplayedRun,
    tracks::{bodies_of, place_at},
};
use crate::requirement::{MeasureAxis, MeasureKind};

/// Of a speed, the way of so long is drawn, s.
const SPEED_WINDOW: f64 = 1.0;
/// Signals may be read by signals so often: deeper ones would be a loop.
const DEEPEST: usize = 16;

/// What of a measure is drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct MeasureSubject {
    pub kind: MeasureKind,
    /// Their places in the scene.
    pub bodies: Vec<usize>,
    /// Of a way: within how many seconds.
    pub within: Option<f64>,
    /// Of a way, a coordinate and an offset: along which axes.
    pub axes: Vec<MeasureAxis>,
    /// Of an offset: the place along each of the axes.
    pub place: Vec<f64>,
}

/// A measurement of the world, and how long ago the one was that it is compared with.
type MeasuredTerm = (SignalTerm, Option<Nanos>);

/// What an expression over these signals is about; `at` is the instant that is looked at first.
pub(super) fn subject(
    run: &ReplayedRun<'_>,
    signals: &[SignalId],
    measured: &Expr,
    at: Nanos,
) -> MeasureSubject {
    let mut terms = Vec::new();
    for slot in slots(measured) {
        if let Some(id) = signals.get(usize::from(slot)) {
            terms_of(run.program, *id, None, 0, &mut terms);
        }
    }
    let is_plain = is_magnitude(measured);
    if is_plain && let Some(way) = way(run, &terms, measured) {
        return way;
    }
    if let Some(offset) = offset::offset(run, signals, measured) {
        return offset;
    }
    let first = terms.first().map(|(term, _)| kind(term));
    let is_one = terms.iter().all(|(term, ago)| Some(kind(term)) == first && ago.is_none());
    let kind = first.filter(|_| is_one && is_plain).unwrap_or_default();
    let bodies = match kind {
        MeasureKind::Signal => all_bodies(run, &terms),
        MeasureKind::Distance
        | MeasureKind::Range
        | MeasureKind::Angle
        | MeasureKind::Tilt
        | MeasureKind::Height
        | MeasureKind::Coordinate
        | MeasureKind::Offset
        | MeasureKind::Way
        | MeasureKind::Speed
        | MeasureKind::Force => nearest(run, &terms, at),
    };
    let within = (kind == MeasureKind::Speed).then_some(SPEED_WINDOW);
    MeasureSubject { kind, bodies, within, ..MeasureSubject::default() }
}

/// The slots that an expression reads, each once, in order.
pub(super) fn slots(expr: &Expr) -> Vec<u16> {
    let mut found = Vec::new();
    walk(expr, &mut |part| {
        if let Expr::Var(slot) = part
            && !found.contains(slot)
        {
            found.push(*slot);
        }
    });
    found
}

fn walk(expr: &Expr, see: &mut dyn FnMut(&Expr)) {
    see(expr);
    match expr {
        Expr::Unary(_, a) => walk(a, see),
        Expr::Binary(_, a, b) => [a, b].into_iter().for_each(|part| walk(part, see)),
        Expr::If(c, a, b) => [c, a, b].into_iter().for_each(|part| walk(part, see)),
        Expr::Call(_, parts) | Expr::Apply(_, parts) => parts.iter().for_each(|part| walk(part, see)),
        Expr::List(parts, rest) => {
            parts.iter().chain(rest.as_deref()).for_each(|part| walk(part, see));
        }
        Expr::Const(_) | Expr::Var(_) | Expr::Element(_) => {}
    }
}

/// Whether a number is a signal, the size of one or of several, or the least or the greatest of them.
fn is_magnitude(expr: &Expr) -> bool {
    match expr {
        Expr::Var(_) => true,
        Expr::Unary(UnaryOp::Neg, of) => is_magnitude(of),
        Expr::Call(_, parts) => parts.iter().all(is_magnitude),
        Expr::Unary(..)
        | Expr::Const(_)
        | Expr::Binary(..)
        | Expr::If(..)
        | Expr::List(..)
        | Expr::Element(_)
        | Expr::Apply(..) => false,
    }
}

/// All that a signal measures, through the signals that it reads.
fn terms_of(
    program: &Program,
    id: SignalId,
    ago: Option<Nanos>,
    depth: usize,
    found: &mut Vec<MeasuredTerm>,
) {
    if depth > DEEPEST {
        return;
    }
    for term in &program.signal(id).terms {
        match term {
            SignalTerm::Delta(of, time) => terms_of(program, *of, Some(*time), depth + 1, found),
            SignalTerm::Reading(of) => terms_of(program, *of, ago, depth + 1, found),
            SignalTerm::Distance(..)
            | SignalTerm::Range(..)
            | SignalTerm::Angle(..)
            | SignalTerm::Visible(..)
            | SignalTerm::Coordinate(..)
            | SignalTerm::Holds(..)
            | SignalTerm::HoldsAny(_)
            | SignalTerm::JointSpeed(_)
            | SignalTerm::JointRate(_)
            | SignalTerm::JointPosition(_)
            | SignalTerm::JointEffort(_)
            | SignalTerm::Speed(_)
            | SignalTerm::Touches(..)
            | SignalTerm::Force(..)
            | SignalTerm::ForceOn(_)
            | SignalTerm::Pressed { .. }
            | SignalTerm::Pressure { .. }
            | SignalTerm::Nearest { .. }
            | SignalTerm::Weight(_)
            | SignalTerm::Tilt(_)
            | SignalTerm::Height(_)
            | SignalTerm::Heading(_)
            | SignalTerm::Orientation(..) => found.push((*term, ago)),
        }
    }
}

/// How far one body has come within a time, along one axis or along several.
fn way(run: &ReplayedRun<'_>, terms: &[MeasuredTerm], measured: &Expr) -> Option<MeasureSubject> {
    let mut axes = Vec::new();
    let mut of: Option<(Vec<usize>, Nanos)> = None;
    for (term, ago) in terms {
        let (SignalTerm::Coordinate(_, axis), Some(ago)) = (term, ago) else { return None };
        let this = (bodies_of(run, term), *ago);
        if of.get_or_insert_with(|| this.clone()) != &this {
            return None;
        }
        let axis = offset::axis_of(*axis);
        if !axes.contains(&axis) {
            axes.push(axis);
        }
    }
    // Along several axes it is the straight way, and not the longest of its parts.
    let is_straight = matches!(measured, Expr::Call(NumberFunction::Norm, _));
    let (bodies, ago) = of.filter(|(bodies, _)| !bodies.is_empty() && (axes.len() == 1 || is_straight))?;
    Some(MeasureSubject {
        kind: MeasureKind::Way,
        bodies,
        within: Some(seconds(ago)),
        axes,
        place: Vec::new(),
    })
}

/// Of several measurements of a kind, the bodies of that whose bodies are nearest to each other then.
fn nearest(run: &ReplayedRun<'_>, terms: &[MeasuredTerm], at: Nanos) -> Vec<usize> {
    let apart = |bodies: &Vec<usize>| {
        let mut places = bodies.iter().filter_map(|body| place_at(run, *body, at));
        let (Some(a), Some(b)) = (places.next(), places.next()) else { return 0.0 };
        a.iter().zip(&b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>()
    };
    let of = terms.iter().map(|(term, _)| bodies_of(run, term));
    of.min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap_or_default()
}

fn all_bodies(run: &ReplayedRun<'_>, terms: &[MeasuredTerm]) -> Vec<usize> {
    let mut all = Vec::new();
    for body in terms.iter().flat_map(|(term, _)| bodies_of(run, term)) {
        if !all.contains(&body) {
            all.push(body);
        }
    }
    all
}

fn kind(term: &SignalTerm) -> MeasureKind {
    match term {
        SignalTerm::Distance(..) => MeasureKind::Distance,
        SignalTerm::Range(..) => MeasureKind::Range,
        SignalTerm::Angle(..) => MeasureKind::Angle,
        SignalTerm::Tilt(_) => MeasureKind::Tilt,
        SignalTerm::Height(_) | SignalTerm::Coordinate(_, Axis::Z) => MeasureKind::Height,
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
        | SignalTerm::Delta(..)
        | SignalTerm::Reading(_)
        | SignalTerm::Heading(_)
        | SignalTerm::Orientation(..) => MeasureKind::Signal,
    }
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::{
        Expr,
        expr::{BinaryOp, NumberFunction},
    };

    use super::{is_magnitude, slots};

    #[test]
    fn sizes_of_signals_are_told_from_other_numbers() {
        let norm = Expr::Call(NumberFunction::Norm, vec![Expr::Var(2), Expr::Var(1), Expr::Var(2)]);
        assert_eq!(slots(&norm), [2, 1]);
        assert!(is_magnitude(&norm));
        let off = Expr::binary(BinaryOp::Sub, Expr::Var(0), Expr::float(0.4));
        assert!(!is_magnitude(&Expr::Call(NumberFunction::Abs, vec![off])));
    }
}
