//! Measurements of contacts, of joints and of the past.

use hrdsl_ir::{
    value::nanos,
    world::{ContactPhase, JointMotion},
};
use hrdsl_syntax::ast::{self, ExprSyntaxKind as Syntax};

use crate::{
    ArmId, BodyRef, Dimension, InferredType, JointId, SignalId, SignalTerm, check::checker::Checker,
    noun::Noun, report::world::bad_world,
};

impl Checker<'_> {
    /// `joint_speed` is of an arm or of a joint, the others are of a joint.
    pub(super) fn of_joint(
        &mut self,
        name: &str,
        arg: &ast::ExprSyntax,
        prefix: &str,
    ) -> Option<(SignalTerm, InferredType)> {
        let speed = InferredType::Float(Dimension::ANGULAR_SPEED);
        if name == "joint_speed" && !self.names_joint(arg, prefix) {
            let arm = self.world_arg(Noun::Arm, arg, prefix)?;
            return Some((SignalTerm::JointSpeed(ArmId(arm)), speed));
        }
        let joint = JointId(self.world_arg(Noun::Joint, arg, prefix)?);
        let declared = self.s.world.as_ref().and_then(|w| w.joints.get(usize::from(joint.0)));
        if declared.is_some_and(|j| j.motion == JointMotion::Slider) {
            let message = format!("`{name}` is of joints that turn, and this one slides");
            self.report(bad_world(arg.span, message, "measure `distance` or the coordinates of what slides"));
            return None;
        }
        Some(match name {
            "joint_speed" => (SignalTerm::JointRate(joint), speed),
            "joint_angle" => (SignalTerm::JointAngle(joint), InferredType::Float(Dimension::ANGLE)),
            _ => (SignalTerm::Torque(joint), InferredType::Float(Dimension::TORQUE)),
        })
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
