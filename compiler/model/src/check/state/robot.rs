//! A description in the world: which bodies its links are, and which joints its joints.

use std::sync::Arc;

use hrdsl_robots::{
    RigidTransform, RobotReading, UrdfJoint, UrdfJointId, UrdfLinkId, UrdfRangeSensor, UrdfRobot,
};

use crate::{BodyId, JointId};

/// A part from a description, where the world has it.
pub(crate) struct PlacedRobot {
    /// `robot.`
    pub prefix: String,
    pub reading: Arc<RobotReading>,
    /// By link.
    pub bodies: Vec<BodyId>,
    /// By joint; filled when the joints are declared.
    pub joints: Vec<JointId>,
    /// By joint: what it says at the start.
    pub values: Vec<f64>,
    /// By link: where it is at the start, in the frame of the part.
    pub poses: Vec<RigidTransform>,
}

impl PlacedRobot {
    pub fn robot(&self) -> Option<&UrdfRobot> {
        self.reading.robot.as_ref()
    }

    /// The link that a body is.
    pub fn link_of(&self, body: BodyId) -> Option<UrdfLinkId> {
        self.bodies.iter().position(|known| *known == body).map(UrdfLinkId)
    }

    /// The description's joint that a joint is.
    pub fn joint_of(&self, joint: JointId) -> Option<(UrdfJointId, &UrdfJoint)> {
        let at = self.joints.iter().position(|known| *known == joint).map(UrdfJointId)?;
        self.robot()?.joint(at).map(|joint| (at, joint))
    }

    pub fn joint_id(&self, joint: UrdfJointId) -> Option<JointId> {
        self.joints.get(joint.0).copied()
    }

    /// The range sensors on a body, by their numbers.
    pub fn sensors_on(&self, body: BodyId) -> Vec<&UrdfRangeSensor> {
        let (link, robot) = (self.link_of(body), self.robot());
        robot.iter().flat_map(|r| &r.range_sensors).filter(|sensor| Some(sensor.link) == link).collect()
    }
}
