//! What conditions and numbers on the world are in every run: what follows from measurements and from what devices can do.

use crate::{
    BinaryOp, BodyId, BodyMotion, BodyRef, NumberFunction, Scenario, SignalTerm, TypedExpr, TypedExprKind,
    TypedStimulusStep, TypedWorldAction, UnaryOp, Value, VariableRef, expr::ComparisonOp, world::TypedWorld,
};

/// Signals within signals are followed so far.
const DEPTH: u32 = 8;

/// The signal's own expression.
fn signal<'a>(scenario: &'a Scenario, leaf: &VariableRef, depth: u32) -> Option<&'a TypedExpr> {
    match leaf {
        VariableRef::Signal(id) if depth < DEPTH => {
            scenario.world.as_ref()?.signals.get(usize::from(id.0)).map(|s| &s.value)
        }
        VariableRef::Signal(_) | VariableRef::Local(_) | VariableRef::Own(_) | VariableRef::Shared(_) => None,
    }
}

/// The truth of a condition on the world, if it is the same in every world.
pub(super) fn truth(scenario: &Scenario, e: &TypedExpr, depth: u32) -> Option<bool> {
    let of = |e: &TypedExpr| truth(scenario, e, depth);
    match &e.kind {
        TypedExprKind::Const(Value::Bool(b)) => Some(*b),
        TypedExprKind::Leaf(leaf) => truth(scenario, signal(scenario, leaf, depth)?, depth + 1),
        TypedExprKind::Unary(UnaryOp::Not, a) => of(a).map(|b| !b),
        TypedExprKind::Binary(BinaryOp::And, a, b) => match (of(a), of(b)) {
            (Some(false), _) | (_, Some(false)) => Some(false),
            (Some(true), Some(true)) => Some(true),
            (Some(true) | None, _) => None,
        },
        TypedExprKind::Binary(BinaryOp::Or, a, b) => match (of(a), of(b)) {
            (Some(true), _) | (_, Some(true)) => Some(true),
            (Some(false), Some(false)) => Some(false),
            (Some(false) | None, _) => None,
        },
        TypedExprKind::Binary(op, a, b) => {
            let ((a_lo, a_hi), (b_lo, b_hi)) = (range(scenario, a, depth)?, range(scenario, b, depth)?);
            match ComparisonOp::of(*op)? {
                ComparisonOp::Lt => decided(a_hi < b_lo, a_lo >= b_hi),
                ComparisonOp::Le => decided(a_hi <= b_lo, a_lo > b_hi),
                ComparisonOp::Gt => decided(a_lo > b_hi, a_hi <= b_lo),
                ComparisonOp::Ge => decided(a_lo >= b_hi, a_hi < b_lo),
                ComparisonOp::Eq => decided(false, a_hi < b_lo || a_lo > b_hi),
                ComparisonOp::Ne => decided(a_hi < b_lo || a_lo > b_hi, false),
            }
        }
        TypedExprKind::If(c, a, b) => match of(c) {
            Some(c) => of(if c { a } else { b }),
            None => of(a).filter(|t| of(b) == Some(*t)),
        },
        TypedExprKind::Const(_)
        | TypedExprKind::Term(_)
        | TypedExprKind::Unary(UnaryOp::Neg, _)
        | TypedExprKind::Call(..)
        | TypedExprKind::List(..)
        | TypedExprKind::Element(_)
        | TypedExprKind::Apply(..)
        | TypedExprKind::Error => None,
    }
}

fn decided(yes: bool, no: bool) -> Option<bool> {
    (yes || no).then_some(yes)
}

/// The numbers that an expression lies between, in every world; infinite ends are ends.
fn range(scenario: &Scenario, e: &TypedExpr, depth: u32) -> Option<(f64, f64)> {
    let of = |e: &TypedExpr| range(scenario, e, depth);
    let infinite = f64::INFINITY;
    let (lo, hi) = match &e.kind {
        TypedExprKind::Const(value) => value.as_f64().map(|x| (x, x))?,
        TypedExprKind::Leaf(leaf) => range(scenario, signal(scenario, leaf, depth)?, depth + 1)?,
        TypedExprKind::Term(term) => range_of_term(scenario, term)?,
        TypedExprKind::Unary(UnaryOp::Neg, a) => of(a).map(|(lo, hi)| (-hi, -lo))?,
        TypedExprKind::Binary(BinaryOp::Add, a, b) => {
            let (a, b) = (of(a)?, of(b)?);
            (a.0 + b.0, a.1 + b.1)
        }
        TypedExprKind::Binary(BinaryOp::Sub, a, b) => {
            let (a, b) = (of(a)?, of(b)?);
            (a.0 - b.1, a.1 - b.0)
        }
        TypedExprKind::Binary(BinaryOp::Mul, a, b) => {
            let (a, b) = (of(a)?, of(b)?);
            let all = [a.0 * b.0, a.0 * b.1, a.1 * b.0, a.1 * b.1];
            if all.iter().any(|x| x.is_nan()) {
                return None;
            }
            (all.into_iter().fold(infinite, f64::min), all.into_iter().fold(-infinite, f64::max))
        }
        TypedExprKind::If(_, a, b) => {
            let (a, b) = (of(a)?, of(b)?);
            (a.0.min(b.0), a.1.max(b.1))
        }
        TypedExprKind::Call(f, args) => {
            let args: Option<Vec<(f64, f64)>> = args.iter().map(of).collect();
            match (f, args?.as_slice()) {
                (NumberFunction::Abs, [(lo, hi)]) if *lo >= 0.0 => (*lo, *hi),
                (NumberFunction::Abs, [(lo, hi)]) => ((-hi).max(0.0), hi.max(-lo)),
                (NumberFunction::Min, [a, b]) => (a.0.min(b.0), a.1.min(b.1)),
                (NumberFunction::Max, [a, b]) => (a.0.max(b.0), a.1.max(b.1)),
                (
                    NumberFunction::Abs | NumberFunction::Min | NumberFunction::Max | NumberFunction::Norm,
                    _,
                ) => return None,
            }
        }
        TypedExprKind::Unary(UnaryOp::Not, _)
        | TypedExprKind::Binary(..)
        | TypedExprKind::List(..)
        | TypedExprKind::Element(_)
        | TypedExprKind::Apply(..)
        | TypedExprKind::Error => return None,
    };
    (!lo.is_nan() && !hi.is_nan()).then_some((lo, hi))
}

/// The numbers that a measurement lies between.
fn range_of_term(scenario: &Scenario, term: &SignalTerm) -> Option<(f64, f64)> {
    let infinite = f64::INFINITY;
    Some(match term {
        SignalTerm::Speed(body) => {
            (0.0, scenario.world.as_ref().map_or(infinite, |w| top_speed(scenario, w, *body)))
        }
        SignalTerm::Distance(..)
        | SignalTerm::Range(..)
        | SignalTerm::JointSpeed(_)
        | SignalTerm::Force(..)
        | SignalTerm::ForceOn(_)
        | SignalTerm::Pressed { .. }
        | SignalTerm::Pressure { .. }
        | SignalTerm::Weight(_) => (0.0, infinite),
        SignalTerm::Angle(..) | SignalTerm::Tilt(_) => (0.0, std::f64::consts::PI),
        SignalTerm::Heading(_) => (-std::f64::consts::PI, std::f64::consts::PI),
        SignalTerm::Orientation(..) => (-1.0, 1.0),
        SignalTerm::Coordinate(..)
        | SignalTerm::Height(_)
        | SignalTerm::JointPosition(_)
        | SignalTerm::JointRate(_)
        | SignalTerm::JointEffort(_)
        | SignalTerm::Nearest { .. }
        | SignalTerm::Delta(..) => (-infinite, infinite),
        SignalTerm::Visible(..)
        | SignalTerm::Touches(..)
        | SignalTerm::Holds(..)
        | SignalTerm::HoldsAny(_)
        | SignalTerm::Reading(_) => return None,
    })
}

/// The measurements of a condition whose bounds are those of a device, in words.
pub(super) fn cap(scenario: &Scenario, condition: &TypedExpr) -> Option<String> {
    let world = scenario.world.as_ref()?;
    let mut told = None;
    condition.each(&mut |e| {
        let TypedExprKind::Term(SignalTerm::Speed(BodyRef::Body(body))) = &e.kind else { return };
        let speed = top_speed(scenario, world, BodyRef::Body(*body));
        let Some(known) = world.bodies.get(usize::from(body.0)).filter(|_| speed.is_finite()) else { return };
        told.get_or_insert_with(|| match known.motion {
            BodyMotion::Fixed => format!("`{}` never moves", known.name),
            BodyMotion::Dynamic | BodyMotion::Kinematic | BodyMotion::Guided => {
                format!("the base of `{}` goes at {speed:.3} m/s at most", known.name)
            }
        });
    });
    told
}

/// How fast the centre of a body can be. What can be pushed, or is moved by an action, can be as fast as it is pushed.
fn top_speed(scenario: &Scenario, world: &TypedWorld, body: BodyRef) -> f64 {
    let BodyRef::Body(body) = body else { return f64::INFINITY };
    let motion = world.bodies.get(usize::from(body.0)).map(|b| b.motion);
    match motion {
        Some(BodyMotion::Fixed) => 0.0,
        Some(BodyMotion::Kinematic) if !is_moved(scenario, body) => {
            let base = world.bases.iter().find(|base| base.body == body);
            // Measured in single precision.
            base.map_or(f64::INFINITY, |b| b.max_speed.hypot(b.max_sideways) * (1.0 + 1e-5))
        }
        Some(BodyMotion::Kinematic | BodyMotion::Dynamic | BodyMotion::Guided) | None => f64::INFINITY,
    }
}

/// Whether an action of a stimulus may move the body.
fn is_moved(scenario: &Scenario, body: BodyId) -> bool {
    fn moves(steps: &[TypedStimulusStep], body: BodyId) -> bool {
        steps.iter().any(|step| match step {
            TypedStimulusStep::Act(
                TypedWorldAction::Move { body: moved, .. } | TypedWorldAction::Look { body: moved, .. },
            ) => *moved == body,
            TypedStimulusStep::Act(
                TypedWorldAction::Grasp { .. }
                | TypedWorldAction::LetGo { .. }
                | TypedWorldAction::Walk { .. }
                | TypedWorldAction::Turn { .. },
            )
            | TypedStimulusStep::Emit { .. }
            | TypedStimulusStep::Hold { .. } => false,
            TypedStimulusStep::If { then, otherwise, .. } => moves(then, body) || moves(otherwise, body),
        })
    }
    scenario.events.iter().filter_map(|e| e.stimulus.as_ref()).any(|s| moves(&s.steps, body))
}
