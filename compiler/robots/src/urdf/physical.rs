//! Whether bodies could exist: what moves has a mass, and an inertia that a body can have.

use super::model::{UrdfJointId, UrdfJointKind, UrdfLink, UrdfLinkId, UrdfRobot};
use crate::{
    fault::{RobotFault, RobotFaultKind, say},
    space::transform::RigidTransform,
};

/// Masses below this, in kilograms, are of frames that somebody had to give one.
const NEARLY_NOTHING: f64 = 1e-9;

pub(crate) fn check_bodies(robot: &UrdfRobot, faults: &mut Vec<RobotFault>) {
    let rigid = robot.rigid_groups();
    let mut masses = vec![0.0; robot.links.len()];
    for (link, group) in robot.links.iter().zip(&rigid) {
        if let (Some(inertial), Some(sum)) = (&link.inertial, masses.get_mut(group.0)) {
            *sum += inertial.mass;
        }
    }
    let below = masses_below(robot, &masses, &rigid);
    for (at, link) in robot.links.iter().enumerate() {
        let Some(group) = rigid.get(at) else { continue };
        let moves = rigid.get(robot.root.0) != Some(group);
        let mass = masses.get(group.0).copied().unwrap_or_default();
        // Said once of what is one body: at its first link, that which the joint moves.
        if moves && group.0 == at && mass <= NEARLY_NOTHING {
            let write = "write `<inertial><mass value=\"…\"/><inertia ixx=\"…\" iyy=\"…\" izz=\"…\"/></inertial>` in it";
            let carries = below.get(group.0).is_some_and(|mass| *mass > NEARLY_NOTHING);
            let kind = RobotFaultKind::NoInertial(link.name.clone());
            say(
                faults,
                if carries {
                    // Joints one after the other, as at a shoulder, are often joined by mere frames.
                    kind.warned(
                        link.place,
                        format!("{write}, or be content that only what hangs on it has a mass"),
                    )
                } else {
                    kind.at(link.place, format!("{write}, or make its joint `type=\"fixed\"`"))
                },
            );
        }
        let Some(inertial) = &link.inertial else { continue };
        if inertial.mass <= 0.0 {
            let kind = RobotFaultKind::BadMass { link: link.name.clone(), mass: inertial.mass };
            let help = "write a mass above 0, in kilograms, or take `<inertial>` out";
            say(faults, kind.warned(inertial.place, help));
        } else if let Some(reason) = inertial.inertia.flaw() {
            let help =
                "compute it again about the centre of mass; of a box it is ixx = m/12 (y² + z²), and so on";
            let kind = RobotFaultKind::BadInertia { link: link.name.clone(), reason };
            say(faults, kind.warned(inertial.place, help));
        }
    }
}

/// Of each group the mass of all that hangs on it by joints.
fn masses_below(robot: &UrdfRobot, masses: &[f64], rigid: &[UrdfLinkId]) -> Vec<f64> {
    let mut below = vec![0.0; robot.links.len()];
    for joint in robot.order.iter().rev().filter_map(|id| robot.joint(*id)) {
        let (Some(parent), Some(child)) = (rigid.get(joint.parent.0), rigid.get(joint.child.0)) else {
            continue;
        };
        if parent != child {
            let hangs = masses.get(child.0).copied().unwrap_or_default()
                + below.get(child.0).copied().unwrap_or_default();
            if let Some(sum) = below.get_mut(parent.0) {
                *sum += hangs;
            }
        }
    }
    below
}

impl UrdfRobot {
    /// The inertia of all that hangs on a joint, about its axis, with all joints at 0, kg·m²; of a joint that slides as if it turned. Of a
    /// link's own inertia its greatest moment counts.
    #[must_use]
    pub fn inertia_beyond(&self, id: UrdfJointId) -> f64 {
        let Some(joint) = self.joint(id) else { return 0.0 };
        let poses = self.link_poses(&[]);
        let Some(frame) = poses.get(joint.child.0) else { return 0.0 };
        let (inward, axis) = (frame.inverse(), joint.axis);
        let about = |(link, pose): (&UrdfLink, &RigidTransform)| {
            let Some(inertial) = &link.inertial else { return 0.0 };
            let middle = inward.place(pose.place(inertial.origin.xyz));
            let along: f64 = middle.iter().zip(axis).map(|(m, a)| m * a).sum();
            let away = middle.iter().map(|m| m * m).sum::<f64>() - along * along;
            let own = inertial.inertia.principal_moments().into_iter().fold(0.0, f64::max);
            inertial.mass.max(0.0) * away.max(0.0) + own
        };
        let mut hangs = vec![false; self.links.len()];
        if let Some(first) = hangs.get_mut(joint.child.0) {
            *first = true;
        }
        for below in self.order.iter().filter_map(|id| self.joint(*id)) {
            if hangs.get(below.parent.0) == Some(&true)
                && let Some(child) = hangs.get_mut(below.child.0)
            {
                *child = true;
            }
        }
        self.links
            .iter()
            .zip(&poses)
            .zip(hangs)
            .filter(|(_, hangs)| *hangs)
            .map(|(link, _)| about(link))
            .sum()
    }

    /// Of each link the first link of the rigid body that it belongs to: links joined by fixed joints are one.
    #[must_use]
    pub fn rigid_groups(&self) -> Vec<UrdfLinkId> {
        let mut groups: Vec<UrdfLinkId> = (0..self.links.len()).map(UrdfLinkId).collect();
        for joint in self.order.iter().filter_map(|id| self.joint(*id)) {
            if joint.kind == UrdfJointKind::Fixed {
                let parent = groups.get(joint.parent.0).copied().unwrap_or(joint.parent);
                if let Some(group) = groups.get_mut(joint.child.0) {
                    *group = parent;
                }
            }
        }
        groups
    }
}
