//! What is settled when all devices are known: which joints stay as they start, and which pairs of links never touch.

use std::collections::BTreeSet;

use hrdsl_ir::solid::{SharedData, SolidBody};
use hrdsl_robots::{UrdfJoint, UrdfJointKind};
use hrdsl_syntax::ast::WorldMemberKind as Member;

use crate::check::{checker::Checker, state::robot::PlacedRobot, world::parts::PlacedMember};
use crate::{BodyId, JointId};

impl<'a> Checker<'a> {
    pub(in crate::check::world) fn settle(&mut self, p: &PlacedMember<'a>) {
        if !matches!(p.member.kind, Member::Robot(_)) {
            return;
        }
        let (Some(placed), Some(world)) = (self.robot_at(&p.prefix), &self.s.world) else { return };
        let arms = world.arms.iter().flat_map(|arm| &arm.joints);
        let moved: BTreeSet<JointId> =
            arms.chain(world.grippers.iter().flat_map(|g| &g.fingers)).copied().collect();
        let held = held_joints(placed, &moved);
        let apart = apart(placed);
        let world = self.world_mut();
        for id in held {
            if let Some(joint) = world.joints.get_mut(usize::from(id.0)) {
                joint.drive.held = true;
            }
        }
        for (body, exempt) in apart {
            if let Some(solid) = world.bodies.get_mut(usize::from(body.0)).and_then(|b| b.solid.as_mut()) {
                *solid = SharedData::new(SolidBody { exempt, ..SolidBody::clone(solid) });
            }
        }
    }
}

/// Joints with a motor that no device moves stay as they are; what turns without end, what no motor moves, and what follows
/// a joint that is moved, does not.
fn held_joints(placed: &PlacedRobot, moved: &BTreeSet<JointId>) -> Vec<JointId> {
    let Some(robot) = placed.robot() else { return Vec::new() };
    let passive = |name: &str| {
        let semantics = placed.reading.semantics.as_ref();
        semantics.is_some_and(|s| s.passive_joints.iter().any(|joint| joint.name == name))
    };
    let stays = |joint: &UrdfJoint, id: JointId| {
        let motor = joint.limits.and_then(|limits| limits.effort).is_none_or(|effort| effort > 0.0);
        let ends = matches!(joint.kind, UrdfJointKind::Revolute | UrdfJointKind::Prismatic);
        ends && motor && !passive(&joint.name) && !moved.contains(&id)
    };
    let leader = |at: usize| {
        let mut at = at;
        for _ in 0..robot.joints.len() {
            match robot.joints.get(at).and_then(|joint| joint.mimic.as_ref()) {
                Some(mimic) => at = mimic.joint.0,
                None => break,
            }
        }
        at
    };
    let held = |at: &usize| {
        let first = leader(*at);
        let is = |at: usize| match (robot.joints.get(at), placed.joints.get(at)) {
            (Some(joint), Some(id)) => stays(joint, *id),
            (_, _) => false,
        };
        is(*at) && (first == *at || is(first))
    };
    (0..robot.joints.len()).filter(held).filter_map(|at| placed.joints.get(at).copied()).collect()
}

/// Of each link those that the semantics say are not to be looked at with it.
fn apart(placed: &PlacedRobot) -> Vec<(BodyId, Vec<BodyId>)> {
    let (Some(robot), Some(semantics)) = (placed.robot(), &placed.reading.semantics) else {
        return Vec::new();
    };
    let body = |name: &str| robot.link_named(name).and_then(|link| placed.bodies.get(link.0)).copied();
    let mut all: Vec<(BodyId, Vec<BodyId>)> = Vec::new();
    for pair in &semantics.disabled_collisions {
        let (Some(a), Some(b)) = (body(&pair.link1), body(&pair.link2)) else { continue };
        match all.iter_mut().find(|(of, _)| *of == a) {
            Some((_, others)) => others.push(b),
            None => all.push((a, vec![b])),
        }
    }
    all
}
