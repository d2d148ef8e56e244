//! Measurements of contacts, of joints and of the past.

use hrdsl_ir::{
    value::nanos,
    world::{ContactPhase, JointMotion},
};
use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, ExprSyntaxKind as Syntax};

use crate::{
    ArmId, BodyRef, Dimension, InferredType, JointId, LaserId, SignalId, SignalTerm,
    check::checker::Checker,
    noun::Noun,
    report::{types, world::bad_world},
};

impl Checker<'_> {
    /// `joint_speed` is of an arm or of a joint, the others are of a joint; `joint_angle` and `torque` of one that turns.
    pub(super) fn of_joint(
        &mut self,
        name: &str,
        arg: &ast::ExprSyntax,
        prefix: &str,
    ) -> Option<(SignalTerm, InferredType)> {
        if name == "joint_speed" && !self.names_joint(arg, prefix) {
            let arm = self.world_arg(Noun::Arm, arg, prefix)?;
            return Some((SignalTerm::JointSpeed(ArmId(arm)), InferredType::Float(Dimension::ANGULAR_SPEED)));
        }
        let joint = JointId(self.world_arg(Noun::Joint, arg, prefix)?);
        let declared = self.s.world.as_ref().and_then(|w| w.joints.get(usize::from(joint.0)));
        let slides = declared.is_some_and(|j| j.motion == JointMotion::Slider);
        let of_any = match name {
            "joint_angle" => "joint_position",
            "torque" => "joint_effort",
            other => other,
        };
        if slides && name != of_any {
            let message = format!("`{name}` is of joints that turn, and this one slides");
            let help = format!("write `{of_any}`, which is of all joints, each in its own unit");
            self.report(bad_world(arg.span, message, help));
            return None;
        }
        let (term, turning, sliding) = match of_any {
            "joint_position" => (SignalTerm::JointPosition(joint), Dimension::ANGLE, Dimension::LENGTH),
            "joint_effort" => (SignalTerm::JointEffort(joint), Dimension::TORQUE, Dimension::FORCE),
            _ => (SignalTerm::JointRate(joint), Dimension::ANGULAR_SPEED, Dimension::SPEED),
        };
        Some((term, InferredType::Float(if slides { sliding } else { turning })))
    }

    /// `nearest(laser)`: of all beams, or of those between two angles.
    pub(super) fn nearest(
        &mut self,
        args: &[ast::ExprSyntax],
        prefix: &str,
        span: Span,
    ) -> Option<(SignalTerm, InferredType)> {
        let laser = self.world_arg(Noun::Laser, args.first()?, prefix);
        let mut angle = |at: usize| args.get(at).map(|e| self.quantity_of(e, Dimension::ANGLE));
        let (from, to) = (angle(1), angle(2));
        let id = LaserId(laser?);
        let declared = self.s.world.as_ref()?.lasers.get(usize::from(id.0))?;
        let (from, to) = (from.unwrap_or(Some(declared.lo))?, to.unwrap_or(Some(declared.hi))?);
        let Some((first, last)) = declared.beams_between(from, to) else {
            let [lo, hi] = [declared.lo, declared.hi].map(f64::to_degrees);
            let message = format!("`{}` has no beam between these angles", declared.name);
            let help = format!(
                "its {} beams go from {lo:.1} deg to {hi:.1} deg; the lesser angle is the first",
                declared.beams
            );
            self.report(bad_world(span, message, help));
            return None;
        };
        Some((SignalTerm::Nearest { laser: id, first, last }, InferredType::Float(Dimension::LENGTH)))
    }

    /// `estimated_pressure(a, area)`: the force over an area that somebody assumes.
    pub(super) fn pressure(
        &mut self,
        args: &[ast::ExprSyntax],
        prefix: &str,
    ) -> Option<(SignalTerm, InferredType)> {
        let (area, bodies) = args.split_last()?;
        let mut solid = |at: usize| bodies.get(at).map(|a| self.solid_arg("estimated_pressure", a, prefix));
        let (body, by) = (solid(0)?, solid(1));
        let found = self.quantity_of(area, Dimension::LENGTH.times(Dimension::LENGTH))?;
        if found <= 0.0 {
            self.report(types::must_be("the assumed area", "more than 0", area.span));
            return None;
        }
        let by = match by {
            Some(by) => Some(by?),
            None => None,
        };
        Some((
            SignalTerm::Pressure { body: body?, by, area: found },
            InferredType::Float(Dimension::PRESSURE),
        ))
    }

    fn names_joint(&self, arg: &ast::ExprSyntax, prefix: &str) -> bool {
        let Syntax::Path(path) = &arg.kind else { return false };
        let full = self.full_name(&path.names, prefix);
        full.is_some_and(|full| self.world.names.get(Noun::Joint, &full).is_some())
    }

    /// What touches what, and how hard. A ghost touches nothing.
    pub(super) fn contact(
        &mut self,
        name: &str,
        args: &[ast::ExprSyntax],
        prefix: &str,
    ) -> Option<(SignalTerm, InferredType)> {
        let bodies: Vec<Option<BodyRef>> = args.iter().map(|a| self.solid_arg(name, a, prefix)).collect();
        let bodies: Vec<BodyRef> = bodies.into_iter().collect::<Option<_>>()?;
        let force = InferredType::Float(Dimension::FORCE);
        Some(match (name, bodies.as_slice()) {
            ("touches", [a, b]) => (SignalTerm::Touches(*a, *b), InferredType::Bool),
            ("force", [a, b]) => (SignalTerm::Force(*a, *b), force),
            ("force", [a]) => (SignalTerm::ForceOn(*a), force),
            ("weight", [a]) => (SignalTerm::Weight(*a), force),
            ("transient_force" | "quasistatic_force", [a, by @ ..]) => {
                let transient = name == "transient_force";
                let phase = if transient { ContactPhase::Transient } else { ContactPhase::QuasiStatic };
                if !self.yields(*a) && !by.first().is_some_and(|by| self.yields(*by)) {
                    let message = format!("`{name}` is of what yields, and this has no stiffness");
                    let help = "measure a body with a `stiffness`, such as those of `std.person`; or `force`";
                    self.report(bad_world(args[0].span, message, help));
                    return None;
                }
                (SignalTerm::Pressed { body: *a, by: by.first().copied(), phase }, force)
            }
            _ => return None,
        })
    }

    /// Whether a body's surface does; of a current nobody says.
    fn yields(&self, body: BodyRef) -> bool {
        let BodyRef::Body(id) = body else { return true };
        let declared = self.s.world.as_ref().and_then(|w| w.bodies.get(usize::from(id.0)));
        declared.is_none_or(|body| body.stiffness.is_some())
    }

    fn solid_arg(&mut self, name: &str, arg: &ast::ExprSyntax, prefix: &str) -> Option<BodyRef> {
        let body = self.body_arg(arg, prefix)?;
        let BodyRef::Body(id) = body else { return Some(body) };
        let ghost = self.s.world.as_ref().and_then(|w| w.bodies.get(usize::from(id.0))).filter(|b| b.ghost);
        let Some(ghost) = ghost else { return Some(body) };
        let message =
            format!("`{}` is a ghost, which nothing touches: `{name}` of it never changes", ghost.name);
        let help = "measure how far it is: `distance(a, b)`; or leave out `ghost`";
        self.report(bad_world(arg.span, message, help));
        None
    }

    /// By how much a signal has changed: `delta(reach, 1 s)`.
    pub(super) fn delta(
        &mut self,
        of: &ast::ExprSyntax,
        over: &ast::ExprSyntax,
        prefix: &str,
    ) -> Option<(SignalTerm, InferredType)> {
        let over = self.time(over, "the time", true);
        let id = self.world_arg(Noun::Signal, of, prefix)?;
        let signal = self.s.world.as_ref()?.signals.get(usize::from(id))?;
        let ty = InferredType::of(signal.ty);
        if !matches!(ty, InferredType::Float(_)) {
            if !self.world.names.broken.contains(&signal.name) {
                let message = format!("`{}` is no quantity, and has no difference", signal.name);
                self.report(bad_world(
                    of.span,
                    message,
                    "name a signal of a length, a speed or another quantity",
                ));
            }
            return None;
        }
        if self.depends_on_a_reading(&signal.value) {
            let message = format!("`{}` is made of readings, which have no difference", signal.name);
            self.report(bad_world(of.span, message, "name a signal of what is measured: the truth"));
            return None;
        }
        Some((SignalTerm::Delta(SignalId(id), nanos(over?)), ty))
    }
}
