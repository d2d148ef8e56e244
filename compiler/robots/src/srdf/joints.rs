//! Which joints a group has, with those of its chains, links and subgroups.

use std::collections::BTreeSet;

use super::model::{SrdfGroup, SrdfSemantics};
use crate::urdf::model::{UrdfJointId, UrdfRobot};

impl SrdfSemantics {
    /// The joints of a group, from the root outwards, each once; fixed ones and those that mimic are among them. A group that is
    /// not there has none.
    #[must_use]
    pub fn joints_of(&self, robot: &UrdfRobot, group: &str) -> Vec<UrdfJointId> {
        let mut found = BTreeSet::new();
        let mut seen = BTreeSet::new();
        let mut waiting = vec![group];
        while let Some(name) = waiting.pop() {
            let Some(group) = self.group(name).filter(|_| seen.insert(name)) else { continue };
            found.extend(own_joints(group, robot));
            waiting.extend(group.groups.iter().map(String::as_str));
        }
        robot.order.iter().copied().filter(|id| found.contains(id)).collect()
    }
}

fn own_joints(group: &SrdfGroup, robot: &UrdfRobot) -> Vec<UrdfJointId> {
    let mut joints: Vec<UrdfJointId> =
        group.joints.iter().filter_map(|name| robot.joint_named(name)).collect();
    // A link stands for the joint above it.
    let links = group.links.iter().filter_map(|name| robot.link_named(name));
    joints.extend(links.filter_map(|link| robot.joint_above(link)));
    for chain in &group.chains {
        let ends = robot.link_named(&chain.base).zip(robot.link_named(&chain.tip));
        joints.extend(ends.and_then(|(base, tip)| robot.chain(base, tip)).unwrap_or_default());
    }
    joints
}
