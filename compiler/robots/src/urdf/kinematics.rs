//! Where the links are for given values of the joints.

use hrdsl_source::nearest;

use super::model::{UrdfJoint, UrdfJointId, UrdfJointKind, UrdfRobot};
use crate::space::transform::RigidTransform;

impl UrdfJoint {
    /// The child's frame in the parent's, at a value in radians or metres. Joints without one value stay at their origin.
    #[must_use]
    pub fn pose(&self, value: f64) -> RigidTransform {
        let origin = self.origin.transform();
        match self.kind {
            UrdfJointKind::Revolute | UrdfJointKind::Continuous => {
                origin.then(&RigidTransform::about_axis(self.axis, value))
            }
            UrdfJointKind::Prismatic => {
                origin.then(&RigidTransform::along(self.axis.map(|part| part * value)))
            }
            UrdfJointKind::Fixed | UrdfJointKind::Floating | UrdfJointKind::Planar => origin,
        }
    }
}

impl UrdfRobot {
    /// The values of all joints, of which some are given by name; others are 0, and those that mimic follow.
    ///
    /// # Errors
    /// What to write for a name that no joint has.
    pub fn joint_values<'a>(
        &self,
        given: impl IntoIterator<Item = (&'a str, f64)>,
    ) -> Result<Vec<f64>, String> {
        let mut values = vec![0.0; self.joints.len()];
        for (name, value) in given {
            let slot = self.joint_named(name).and_then(|id| values.get_mut(id.0)).ok_or_else(|| {
                let near = nearest(name, self.joints.iter().map(|joint| joint.name.as_str()));
                near.map_or(format!("no joint is called `{name}`"), |near| {
                    format!("no joint is called `{name}`: write `{near}`")
                })
            })?;
            *slot = value;
        }
        Ok(self.followed(&values))
    }

    /// The values with those of mimicking joints computed from the others'; too few are filled up with 0.
    #[must_use]
    pub fn followed(&self, values: &[f64]) -> Vec<f64> {
        (0..self.joints.len()).map(|at| self.value_of(UrdfJointId(at), values)).collect()
    }

    /// Of a joint that mimics one that mimics, and so on, the whole way. There are no circles in a robot that was read.
    fn value_of(&self, id: UrdfJointId, values: &[f64]) -> f64 {
        let (mut factor, mut sum, mut at) = (1.0, 0.0, id);
        for _ in 0..=self.joints.len() {
            match self.joint(at).and_then(|joint| joint.mimic.as_ref()) {
                Some(mimic) => {
                    sum += factor * mimic.offset;
                    factor *= mimic.multiplier;
                    at = mimic.joint;
                }
                None => break,
            }
        }
        factor * values.get(at.0).copied().unwrap_or_default() + sum
    }

    /// The pose of every link in the root's frame, in the order of the links, for values in the order of the joints. Those of
    /// mimicking joints are computed, whatever is given for them.
    #[must_use]
    pub fn link_poses(&self, values: &[f64]) -> Vec<RigidTransform> {
        let values = self.followed(values);
        let mut poses = vec![RigidTransform::IDENTITY; self.links.len()];
        for id in &self.order {
            let (Some(joint), Some(value)) = (self.joint(*id), values.get(id.0)) else { continue };
            let Some(parent) = poses.get(joint.parent.0).copied() else { continue };
            if let Some(pose) = poses.get_mut(joint.child.0) {
                *pose = parent.then(&joint.pose(*value));
            }
        }
        poses
    }
}
