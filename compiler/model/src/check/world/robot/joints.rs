//! The joints of a description as joints of the world.

use hrdsl_ir::world::{ENDLESS, JointDrive, JointMimic, JointMotion};
use hrdsl_robots::{RigidTransform, UrdfJoint, UrdfJointId, UrdfJointKind, UrdfRobot};
use hrdsl_syntax::ast::WorldMemberKind as Member;

use crate::check::world::parts::PlacedMember;
use crate::check::world::phase::WorldPhase;
use crate::{BodyId, JointId, noun::Noun, world::TypedJoint};

/// The inertia of a hinge's rotor is that which its effort brings to this in a second, rad/s²: descriptions do not say it.
const ROTOR_RATE: f64 = 800.0;
/// The least and the most of it, kg·m².
const ROTORS: (f64, f64) = (1e-3, 0.2);
/// In gears that link joints, where an effort is often there to be large and nothing else, it is at most so many times what hangs on the joint.
const ROTOR_OF_LOAD: f64 = 10.0;

impl<'a> WorldPhase<'_, 'a> {
    pub(in crate::check::world) fn described_joints(&mut self, p: &PlacedMember<'a>) {
        if !matches!(p.member.kind, Member::Robot(_)) {
            return;
        }
        let Some(at) = self.robots.iter().position(|robot| robot.prefix == p.prefix) else { return };
        let reading = std::sync::Arc::clone(&self.robots[at].reading);
        let Some(robot) = reading.robot.as_ref() else { return };
        let own = |joint: &UrdfJoint| (joint.name.clone(), joint.place);
        let Some(names) = self.spelled(robot.joints.iter().map(own), Noun::Joint) else {
            self.world.names.broken.insert(p.prefix.trim_end_matches('.').to_owned());
            return;
        };
        let mut ids = Vec::new();
        for (joint, name) in robot.joints.iter().zip(&names) {
            let full = format!("{}{name}", p.prefix);
            let (issues, table) = (&mut self.checker.issues, &mut self.checker.world.names.joints);
            let Some(id) = issues.declare_as(table, Noun::Joint, &full, joint.place.span) else { return };
            ids.push(JointId(id));
            let placed = &self.robots[at];
            let (parent, child) = (placed.bodies.get(joint.parent.0), placed.bodies.get(joint.child.0));
            let pose = placed.poses.get(joint.child.0).copied().unwrap_or(RigidTransform::IDENTITY);
            let value = placed.values.get(ids.len() - 1).copied().unwrap_or_default();
            let (lo, hi) = limits(joint);
            let mut drive = JointDrive { start: value, ..drive(joint) };
            if is_geared(robot, ids.len() - 1) {
                let most = ROTOR_OF_LOAD * robot.inertia_beyond(UrdfJointId(ids.len() - 1));
                drive.rotor = drive.rotor.min(most.max(ROTORS.0));
            }
            let typed = TypedJoint {
                name: full,
                parent: parent.copied().unwrap_or(BodyId(0)),
                child: child.copied().unwrap_or(BodyId(0)),
                frame: p.frame,
                anchor: pose.translation,
                axis: pose.turned(joint.axis),
                motion: motion(joint),
                lo,
                hi,
                drive,
                own_name: (*name != joint.name).then(|| joint.name.clone()),
            };
            self.world_mut().joints.push(typed);
        }
        self.gears(robot, &ids);
        self.robots[at].joints = ids;
    }

    /// What mimics another that mimics follows the last.
    fn gears(&mut self, robot: &UrdfRobot, ids: &[JointId]) {
        for (joint, id) in robot.joints.iter().zip(ids) {
            let Some(first) = &joint.mimic else { continue };
            let (mut factor, mut offset, mut to) = (first.multiplier, first.offset, first.joint);
            for _ in 0..robot.joints.len() {
                let Some(next) = robot.joint(to).and_then(|joint| joint.mimic.as_ref()) else { break };
                offset += factor * next.offset;
                factor *= next.multiplier;
                to = next.joint;
            }
            let Some(leader) = ids.get(to.0).copied() else { continue };
            if let Some(joint) = self.world_mut().joints.get_mut(usize::from(id.0)) {
                joint.drive.mimic = Some(JointMimic { joint: leader, factor, offset });
            }
        }
    }
}

/// Whether a joint follows another, or is followed.
fn is_geared(robot: &UrdfRobot, at: usize) -> bool {
    let follows = |joint: &UrdfJoint| joint.mimic.as_ref().is_some_and(|mimic| mimic.joint.0 == at);
    robot.joints.get(at).is_some_and(|joint| joint.mimic.is_some()) || robot.joints.iter().any(follows)
}

fn motion(joint: &UrdfJoint) -> JointMotion {
    if joint.kind == UrdfJointKind::Prismatic { JointMotion::Slider } else { JointMotion::Hinge }
}

/// What is free as a whole stands where it is put.
fn limits(joint: &UrdfJoint) -> (f64, f64) {
    match joint.kind {
        UrdfJointKind::Continuous => (-ENDLESS / 2.0, ENDLESS / 2.0),
        UrdfJointKind::Revolute | UrdfJointKind::Prismatic => {
            joint.limits.map_or((0.0, 0.0), |limits| (limits.lower, limits.upper))
        }
        UrdfJointKind::Fixed | UrdfJointKind::Floating | UrdfJointKind::Planar => (0.0, 0.0),
    }
}

fn drive(joint: &UrdfJoint) -> JointDrive {
    let effort = joint.limits.and_then(|limits| limits.effort);
    let turns = motion(joint) == JointMotion::Hinge && joint.kind.has_one_value();
    let rotor = match effort {
        Some(effort) if turns => (effort / ROTOR_RATE).clamp(ROTORS.0, ROTORS.1),
        Some(_) | None => 0.0,
    };
    JointDrive {
        effort,
        speed: joint.limits.and_then(|limits| limits.velocity).filter(|speed| *speed > 0.0),
        rotor,
        damping: joint.dynamics.damping,
        friction: joint.dynamics.friction,
        ..JointDrive::default()
    }
}
