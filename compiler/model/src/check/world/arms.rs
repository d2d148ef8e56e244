//! What moves: joints, with the motors that drive them, arms and grippers.

use hrdsl_ir::{
    sensor::SensorSource,
    world::{ArmId, JointDrive, JointMotion},
};
use hrdsl_syntax::ast::{ExprSyntax, JointSyntax, NameSyntax, RangeSyntax, WorldMemberKind as Member};

use crate::check::{
    checker::Checker,
    state::scope::ExprEnv,
    world::{parts::PlacedMember, sensing::SensedKind},
};
use crate::{
    BodyId, Dimension, JointId,
    noun::Noun,
    report::world::bad_world,
    world::{TypedArm, TypedGripper, TypedJoint},
};

use super::{LENGTH, NUMBER};

/// With how much a finger presses if nothing is said, N.
const FORCE: f64 = 40.0;

impl<'a> Checker<'a> {
    pub(super) fn joint(&mut self, p: &PlacedMember<'a>) {
        let Member::Joint(joint) = &p.member.kind else { return };
        let JointSyntax { name, parent, child, at, axis, .. } = &**joint;
        let bodies = (self.local_body(parent, &p.prefix), self.local_body(child, &p.prefix));
        if parent.text == child.text {
            let message = format!("the joint `{}` joins a body to itself", name.text);
            self.report(bad_world(child.span, message, "name another body"));
        }
        let anchor = self.vector(at, LENGTH).unwrap_or_default();
        let direction = self.vector(axis, NUMBER);
        if direction == Some([0.0; 3]) {
            self.report(bad_world(axis.span, "an axis has a direction", "write `axis (0, 0, 1)`"));
        }
        let motion = self.joint_motion(&joint.limits);
        let (lo, hi) = self.limits(&joint.limits, motion);
        let drive = self.joint_drive(joint, motion);
        let full = format!("{}{}", p.prefix, name.text);
        let (issues, table) = (&mut self.issues, &mut self.world.names.joints);
        if issues.declare_as(table, Noun::Joint, &full, name.span).is_some() {
            self.world_mut().joints.push(TypedJoint {
                name: full,
                parent: bodies.0.unwrap_or(BodyId(0)),
                child: bodies.1.unwrap_or(BodyId(0)),
                frame: p.frame,
                anchor,
                axis: direction.unwrap_or([0.0, 0.0, 1.0]),
                motion,
                lo,
                hi,
                drive,
            });
        }
    }

    /// Limits that are lengths make a slider. What is wrong with them is said when they are read.
    fn joint_motion(&mut self, limits: &RangeSyntax) -> JointMotion {
        let known = self.issues.list.len();
        let lower = self.expr(&limits.lo, &mut ExprEnv::constants()).ty;
        self.issues.list.truncate(known);
        if lower == LENGTH { JointMotion::Slider } else { JointMotion::Hinge }
    }

    fn limits(&mut self, limits: &RangeSyntax, motion: JointMotion) -> (f64, f64) {
        let (dim, help) = match motion {
            JointMotion::Hinge => (Dimension::ANGLE, "write `limits -90 deg .. 90 deg`"),
            JointMotion::Slider => (Dimension::LENGTH, "write `limits 0 cm .. 35 cm`"),
        };
        self.ends(limits, dim, "limits have two ends", help).unwrap_or_default()
    }

    fn joint_drive(&mut self, joint: &JointSyntax, motion: JointMotion) -> JointDrive {
        let (effort, speed) = match motion {
            JointMotion::Hinge => (Dimension::TORQUE, Dimension::ANGULAR_SPEED),
            JointMotion::Slider => (Dimension::FORCE, Dimension::SPEED),
        };
        if let (JointMotion::Slider, Some(rotor)) = (motion, &joint.rotor) {
            let message = "a joint that slides has no rotor";
            self.report(bad_world(
                rotor.span,
                message,
                "give the body that slides the mass of what moves it",
            ));
        }
        let mut measure = |e: &Option<ExprSyntax>, dim: Dimension, what: &str| {
            e.as_ref().and_then(|e| self.more_than_zero(e, dim, what))
        };
        JointDrive {
            effort: measure(&joint.effort, effort, "the effort"),
            speed: measure(&joint.speed, speed, "the speed"),
            rotor: measure(&joint.rotor, Dimension::INERTIA, "the rotor's inertia").unwrap_or(0.0),
        }
    }

    pub(super) fn gripper(&mut self, p: &PlacedMember<'a>) {
        let Member::Gripper(gripper) = &p.member.kind else { return };
        let name = &gripper.name;
        let palm = self.local_body(&gripper.palm, &p.prefix).unwrap_or(BodyId(0));
        let fingers = self.fingers(&gripper.fingers, &p.prefix);
        let tool = self.vector(&gripper.tool, LENGTH).unwrap_or_default();
        let reach = self.more_than_zero(&gripper.reach, Dimension::LENGTH, "the reach").unwrap_or(0.0);
        let delay = self.time(&gripper.delay, "the delay", false).unwrap_or(0.0);
        let force =
            gripper.force.as_ref().and_then(|e| self.more_than_zero(e, Dimension::FORCE, "the force"));
        let full = format!("{}{}", p.prefix, name.text);
        let (issues, table) = (&mut self.issues, &mut self.world.names.grippers);
        if issues.declare_as(table, Noun::Gripper, &full, name.span).is_some() {
            let force = force.unwrap_or(FORCE);
            self.world_mut().grippers.push(TypedGripper {
                name: full,
                palm,
                fingers,
                tool,
                reach,
                delay,
                force,
            });
        }
    }

    /// Fingers slide.
    fn fingers(&mut self, names: &[NameSyntax], prefix: &str) -> Vec<JointId> {
        let mut fingers = Vec::new();
        for name in names {
            let Some(id) = self.world_name(Noun::Joint, std::slice::from_ref(name), prefix) else { continue };
            let joint = &self.world_mut().joints[usize::from(id)];
            if joint.motion == JointMotion::Hinge || joint.lo == joint.hi {
                let message = format!("the joint `{}` does not slide", name.text);
                let help = "give the finger a joint whose limits are lengths: `limits 0 cm .. 3 cm`";
                self.report(bad_world(name.span, message, help));
            }
            fingers.push(JointId(id));
        }
        fingers
    }

    pub(super) fn arm(&mut self, p: &PlacedMember<'a>) {
        let Member::Arm(arm) = &p.member.kind else { return };
        let (name, joints, tip) = (&arm.name, &arm.joints, &arm.tip);
        let ids: Vec<JointId> = joints
            .iter()
            .filter_map(|j| self.world_name(Noun::Joint, std::slice::from_ref(j), &p.prefix))
            .map(JointId)
            .collect();
        let tip_id = self.local_body(tip, &p.prefix);
        if let (true, Some(tip_id)) = (ids.len() == joints.len(), tip_id) {
            self.chain(&ids, joints, tip, tip_id);
        }
        let tool = self.vector(&arm.tool, LENGTH).unwrap_or_default();
        let speed = self.more_than_zero(&arm.speed, Dimension::ANGULAR_SPEED, "the speed").unwrap_or(0.0);
        let contact =
            arm.contact.as_ref().and_then(|e| self.more_than_zero(e, Dimension::FORCE, "the contact force"));
        let full = format!("{}{}", p.prefix, name.text);
        let (issues, table) = (&mut self.issues, &mut self.world.names.arms);
        if let Some(id) = issues.declare_as(table, Noun::Arm, &full, name.span) {
            self.sensing(&arm.sensing, SensedKind::Arm, (&full, SensorSource::Arm(ArmId(id))));
            let (tip, postures) = (tip_id.unwrap_or(BodyId(0)), Vec::new());
            self.world_mut().arms.push(TypedArm {
                name: full,
                joints: ids,
                tip,
                tool,
                speed,
                contact,
                postures,
            });
        }
    }

    fn chain(&mut self, ids: &[JointId], names: &[NameSyntax], tip: &NameSyntax, tip_id: BodyId) {
        let joints: Vec<(BodyId, BodyId)> = {
            let world = self.world_mut();
            ids.iter().map(|j| &world.joints[usize::from(j.0)]).map(|j| (j.parent, j.child)).collect()
        };
        for (pair, name) in joints.windows(2).zip(&names[1..]) {
            if pair[0].1 != pair[1].0 {
                let message = format!("the joint `{}` does not follow the one before it", name.text);
                self.report(bad_world(
                    name.span,
                    message,
                    "name the joints in order, from the base to the tip",
                ));
            }
        }
        if joints.last().is_some_and(|last| last.1 != tip_id) {
            let message = format!("the arm's last joint does not move `{}`", tip.text);
            self.report(bad_world(tip.span, message, "the tip is the child of the last joint"));
        }
    }
}
