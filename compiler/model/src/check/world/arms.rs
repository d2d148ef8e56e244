//! What moves: joints, with the motors that drive them, arms and grippers.

use hrdsl_ir::{
    sensor::SensorSource,
    value::nanos,
    world::{Arm, ArmId, ENDLESS, Gripper, JointDrive, JointMimic, JointMotion},
};
use hrdsl_syntax::ast::{
    ExprSyntax, JointListSyntax, JointSyntax, NameSyntax, RangeSyntax, WorldMemberKind as Member,
};

use crate::check::{
    state::scope::ExprEnv,
    world::{parts::PlacedMember, sensing::SensedKind},
};
use crate::check::{template::CheckerPhase, world::phase::WorldPhase};
use crate::{BodyId, Dimension, JointId, noun::Noun, report::world::bad_world, world::TypedJoint};

use super::{LENGTH, NUMBER};

/// With how much a finger presses if nothing is said, N.
const FORCE: f64 = 40.0;

impl<'a> WorldPhase<'_, 'a> {
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
        let (issues, table) = (&mut self.checker.issues, &mut self.checker.world.names.joints);
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
                own_name: None,
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
        let (effort, speed, damping) = match motion {
            JointMotion::Hinge => (Dimension::TORQUE, Dimension::ANGULAR_SPEED, Dimension::ANGULAR_DAMPING),
            JointMotion::Slider => (Dimension::FORCE, Dimension::SPEED, Dimension::DAMPING),
        };
        if let (JointMotion::Slider, Some(rotor)) = (motion, &joint.rotor) {
            let message = "a joint that slides has no rotor";
            self.report(bad_world(
                rotor.span,
                message,
                "give the body that slides the mass of what moves it",
            ));
        }
        if let (Some(_), Some(loss)) = (&joint.mimic, joint.damping.as_ref().or(joint.friction.as_ref())) {
            let message = format!(
                "the joint `{}` follows another, and is braked by nothing of its own",
                joint.name.text
            );
            self.report(bad_world(
                loss.span,
                message,
                "brake the joint that it follows, or leave out `mimic`",
            ));
        }
        let mut measure = |e: &Option<ExprSyntax>, dim: Dimension, what: &str| {
            e.as_ref().and_then(|e| self.more_than_zero(e, dim, what))
        };
        JointDrive {
            effort: measure(&joint.effort, effort, "the effort"),
            speed: measure(&joint.speed, speed, "the speed"),
            rotor: measure(&joint.rotor, Dimension::INERTIA, "the rotor's inertia").unwrap_or(0.0),
            damping: measure(&joint.damping, damping, "the damping").unwrap_or(0.0),
            friction: measure(&joint.friction, effort, "the friction").unwrap_or(0.0),
            ..JointDrive::default()
        }
    }

    pub(super) fn gripper(&mut self, p: &PlacedMember<'a>) {
        let Member::Gripper(gripper) = &p.member.kind else { return };
        let name = &gripper.name;
        let palm = self.local_body(&gripper.palm, &p.prefix).unwrap_or(BodyId(0));
        let tool = self.vector(&gripper.tool, LENGTH).unwrap_or_default();
        let fingers = self.fingers(&gripper.fingers, &p.prefix);
        let reversed = self.closed_at_lower(&fingers, palm, tool);
        let reach = self.more_than_zero(&gripper.reach, Dimension::LENGTH, "the reach").unwrap_or(0.0);
        let delay = self.time(&gripper.delay, "the delay", false).unwrap_or(0.0);
        let force =
            gripper.force.as_ref().and_then(|e| self.more_than_zero(e, Dimension::FORCE, "the force"));
        let full = format!("{}{}", p.prefix, name.text);
        let (issues, table) = (&mut self.checker.issues, &mut self.checker.world.names.grippers);
        if issues.declare_as(table, Noun::Gripper, &full, name.span).is_some() {
            let force = force.unwrap_or(FORCE);
            // All bodies are there: they were the passes before.
            let holds = self.graspable();
            self.world_mut().grippers.push(Gripper {
                name: full,
                palm,
                fingers,
                reversed,
                tool,
                reach,
                delay: nanos(delay),
                force,
                holds,
            });
        }
    }

    fn graspable(&mut self) -> Vec<BodyId> {
        let bodies = (0..).zip(&self.world_mut().bodies);
        bodies.filter(|(_, b)| b.graspable).map(|(i, _)| BodyId(i)).collect()
    }

    /// Fingers slide, or turn if a description says so; what follows them is a finger, too.
    fn fingers(&mut self, list: &JointListSyntax, prefix: &str) -> Vec<JointId> {
        let mut fingers = Vec::new();
        for (id, name) in self.joint_list(list, prefix).unwrap_or_default() {
            let described = self.is_described(id);
            let joint = &self.world_mut().joints[usize::from(id.0)];
            let moves = joint.hi > joint.lo && joint.hi - joint.lo < ENDLESS;
            if !moves || joint.motion == JointMotion::Hinge && !described {
                let message = format!("the joint `{}` does not slide", name.text);
                let help = "give the finger a joint whose limits are lengths: `limits 0 cm .. 3 cm`";
                self.report(bad_world(name.span, message, help));
            }
            fingers.push(id);
        }
        let all = (0u16..).zip(&self.world_mut().joints);
        let follows = |joint: &TypedJoint| joint.drive.mimic.is_some_and(|m| fingers.contains(&m.joint));
        let more: Vec<JointId> = all.filter(|(_, j)| follows(j)).map(|(id, _)| JointId(id)).collect();
        let new: Vec<JointId> = more.into_iter().filter(|id| !fingers.contains(id)).collect();
        fingers.extend(new);
        fingers
    }

    /// `mimic left times -1`
    pub(super) fn mimic(&mut self, p: &PlacedMember<'a>) {
        let Member::Joint(joint) = &p.member.kind else { return };
        let Some(mimic) = &joint.mimic else { return };
        let leader = self.world_name(Noun::Joint, std::slice::from_ref(&mimic.joint), &p.prefix);
        let own = self.world.names.joints.get(&format!("{}{}", p.prefix, joint.name.text));
        let factor = mimic.times.as_ref().map_or(Some(1.0), |e| self.quantity_of(e, Dimension::NUMBER));
        let (Some(leader), Some(own), Some(factor)) = (leader, own, factor) else { return };
        let joints = &self.world_mut().joints;
        let (Some(of), Some(to)) = (joints.get(usize::from(own)), joints.get(usize::from(leader))) else {
            return;
        };
        let is_follower = to.drive.mimic.is_some() || leader == own;
        let is_followed = joints.iter().any(|j| j.drive.mimic.is_some_and(|m| m.joint.0 == own));
        if is_follower || is_followed || of.motion != to.motion {
            let message = format!("the joint `{}` cannot follow `{}`", joint.name.text, mimic.joint.text);
            let help = "a joint follows one of its own kind that follows none, and none follows it";
            self.report(bad_world(mimic.joint.span, message, help));
            return;
        }
        if let Some(joint) = self.world_mut().joints.get_mut(usize::from(own)) {
            joint.drive.mimic = Some(JointMimic { joint: JointId(leader), factor, offset: 0.0 });
        }
    }

    pub(super) fn arm(&mut self, p: &PlacedMember<'a>) {
        let Member::Arm(arm) = &p.member.kind else { return };
        let (name, tip) = (&arm.name, &arm.tip);
        let listed = self.joint_list(&arm.joints, &p.prefix);
        let tip_id = self.local_body(tip, &p.prefix);
        // What is fixed, or follows another, has no motor of its own.
        let mut joints = listed.clone().unwrap_or_default();
        joints.retain(|(id, _)| !self.is_passive(*id));
        if let (Some(_), Some(tip_id)) = (&listed, tip_id) {
            self.chain(&joints, tip, tip_id);
        }
        let ids: Vec<JointId> = joints.iter().map(|(id, _)| *id).collect();
        let tool = self.vector(&arm.tool, LENGTH).unwrap_or_default();
        let speed = self.more_than_zero(&arm.speed, Dimension::ANGULAR_SPEED, "the speed").unwrap_or(0.0);
        let contact =
            arm.contact.as_ref().and_then(|e| self.more_than_zero(e, Dimension::FORCE, "the contact force"));
        let avoids_people = arm.avoids.as_ref().is_some_and(|what| self.avoids_people(what));
        let full = format!("{}{}", p.prefix, name.text);
        let (issues, table) = (&mut self.checker.issues, &mut self.checker.world.names.arms);
        if let Some(id) = issues.declare_as(table, Noun::Arm, &full, name.span) {
            self.sensing(&arm.sensing, SensedKind::Arm, (&full, SensorSource::Arm(ArmId(id))));
            let (tip, postures) = (tip_id.unwrap_or(BodyId(0)), Vec::new());
            self.world_mut().arms.push(Arm {
                name: full,
                joints: ids,
                tip,
                tool,
                max_speed: speed,
                contact_limit: contact,
                avoids_people,
                postures,
            });
        }
    }

    /// Everything but people an arm goes round anyway.
    fn avoids_people(&mut self, what: &NameSyntax) -> bool {
        let known = what.text == "people";
        if !known {
            let message = format!("an arm cannot be told to avoid `{}`", what.text);
            let help = "write `avoids people`; it goes round everything else anyway";
            self.report(bad_world(what.span, message, help));
        }
        known
    }

    fn chain(&mut self, listed: &[(JointId, NameSyntax)], tip: &NameSyntax, tip_id: BodyId) {
        let ends = |id: JointId| {
            let world = self.s.world.as_ref()?;
            let joint = world.joints.get(usize::from(id.0))?;
            Some((self.rigid_root(joint.parent), self.rigid_root(joint.child)))
        };
        let joints: Vec<(BodyId, BodyId)> = listed.iter().filter_map(|(id, _)| ends(*id)).collect();
        let follows = joints.windows(2).zip(listed.iter().skip(1));
        let strays: Vec<NameSyntax> = follows
            .filter(|(pair, _)| pair.first().map(|j| j.1) != pair.last().map(|j| j.0))
            .map(|(_, (_, name))| name.clone())
            .collect();
        let reaches = joints.last().is_some_and(|last| last.1 == self.rigid_root(tip_id));
        for name in strays {
            let message = format!("the joint `{}` does not follow the one before it", name.text);
            let help = "name the joints in order, from the base to the tip";
            self.report(bad_world(name.span, message, help));
        }
        if !reaches {
            let message = format!("the arm's last joint does not move `{}`", tip.text);
            self.report(bad_world(tip.span, message, "the tip is the child of the last joint"));
        }
    }

    /// Whether a joint has nothing to do in an arm.
    fn is_passive(&self, id: JointId) -> bool {
        let joint = self.s.world.as_ref().and_then(|world| world.joints.get(usize::from(id.0)));
        self.is_fixed_joint(id) || joint.is_some_and(|joint| joint.drive.mimic.is_some())
    }
}
