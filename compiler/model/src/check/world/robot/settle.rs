//! What is settled when all devices are known: which joints stay as they start, and which pairs of links never touch.

use std::collections::BTreeSet;

use hrdsl_ir::solid::{SharedData, SolidBody};
use hrdsl_robots::{UrdfJoint, UrdfJointKind, UrdfLinkId, UrdfRobot};
use hrdsl_syntax::ast::WorldMemberKind as Member;

use crate::check::world::phase::WorldPhase;
use crate::check::{state::robot::PlacedRobot, world::parts::PlacedMember};
use crate::{BodyId, JointId};

/// Between the joints of what counts as short, m.
const SHORT: f64 = 0.15;
/// The sine of how far the axis of a wheel may be from level.
const LEVEL: f64 = 0.2;

impl<'a> WorldPhase<'_, 'a> {
    pub(in crate::check::world) fn settle(&mut self, p: &PlacedMember<'a>) {
        if !matches!(p.member.kind, Member::Robot(_)) {
            return;
        }
        let (Some(placed), Some(world)) = (self.robot_at(&p.prefix), &self.s.world) else { return };
        let arms = world.arms.iter().flat_map(|arm| &arm.joints);
        let moved: BTreeSet<JointId> =
            arms.chain(world.grippers.iter().flat_map(|g| &g.fingers)).copied().collect();
        let drives = world.bases.iter().any(|base| placed.link_of(base.body).is_some());
        let mut held = held_joints(placed, &moved);
        if drives {
            held.extend(wheel_joints(placed, &moved));
        }
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

/// The joints of a base's wheels, which are one with it, since the base drives as if it had them: joints without end that no device moves,
/// about an axis that is level, and those that swivel such wheels.
fn wheel_joints(placed: &PlacedRobot, moved: &BTreeSet<JointId>) -> Vec<JointId> {
    let Some(robot) = placed.robot() else { return Vec::new() };
    let groups = robot.rigid_groups();
    let moves = |joint: &UrdfJoint| joint.kind.has_one_value();
    let mut wheels = BTreeSet::new();
    for at in robot.order.iter().rev() {
        let (Some(joint), Some(id)) = (robot.joint(*at), placed.joints.get(at.0)) else { continue };
        if joint.kind != UrdfJointKind::Continuous || moved.contains(id) {
            continue;
        }
        let hangs =
            |other: &UrdfJoint| moves(other) && groups.get(other.parent.0) == groups.get(joint.child.0);
        let mut beyond = robot.joints.iter().zip(&placed.joints).filter(|(other, _)| hangs(other)).peekable();
        let upward = placed.poses.get(joint.child.0).map_or(1.0, |pose| pose.turned(joint.axis)[2]);
        let is_wheel = if beyond.peek().is_none() {
            upward.abs() < LEVEL
        } else {
            beyond.all(|(_, other)| wheels.contains(other))
        };
        if is_wheel {
            wheels.insert(*id);
        }
    }
    wheels.into_iter().collect()
}

/// The links on both sides of a body whose joints are near each other, as at a shoulder or a wrist: they are drawn so that they
/// overlap, or do when they turn.
fn across_short_links(robot: &UrdfRobot, placed: &PlacedRobot) -> Vec<(UrdfLinkId, UrdfLinkId)> {
    let groups = robot.rigid_groups();
    let group = |link: UrdfLinkId| groups.get(link.0).copied().unwrap_or(link);
    let at = |link: UrdfLinkId| placed.poses.get(link.0).map(|pose| pose.translation).unwrap_or_default();
    let all = |of: UrdfLinkId| (0..robot.links.len()).map(UrdfLinkId).filter(move |link| group(*link) == of);
    let mut pairs = Vec::new();
    for lower in robot.joints.iter().filter(|joint| joint.kind.has_one_value()) {
        let between = group(lower.parent);
        let upper = robot.joint_above(between).and_then(|id| robot.joint(id));
        let Some(upper) = upper.filter(|joint| joint.kind.has_one_value()) else { continue };
        let way = at(upper.child).into_iter().zip(at(lower.child));
        let length = way.map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
        if length <= SHORT {
            for above in all(group(upper.parent)) {
                pairs.extend(all(group(lower.child)).map(|below| (above, below)));
            }
        }
    }
    pairs
}

/// Of each link those that the semantics say are not to be looked at with it; without semantics, those beyond a short one.
fn apart(placed: &PlacedRobot) -> Vec<(BodyId, Vec<BodyId>)> {
    let Some(robot) = placed.robot() else { return Vec::new() };
    let body = |link: UrdfLinkId| placed.bodies.get(link.0).copied();
    let named = |name: &str| robot.link_named(name);
    let pairs: Vec<(UrdfLinkId, UrdfLinkId)> = match &placed.reading.semantics {
        Some(semantics) => {
            let disabled = semantics.disabled_collisions.iter();
            disabled.filter_map(|pair| named(&pair.link1).zip(named(&pair.link2))).collect()
        }
        None => across_short_links(robot, placed),
    };
    let mut all: Vec<(BodyId, Vec<BodyId>)> = Vec::new();
    for (a, b) in pairs {
        let (Some(a), Some(b)) = (body(a), body(b)) else { continue };
        match all.iter_mut().find(|(of, _)| *of == a) {
            Some((_, others)) => others.push(b),
            None => all.push((a, vec![b])),
        }
    }
    all
}
