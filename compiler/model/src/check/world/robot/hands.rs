//! At which end of its way a finger of a description is closed: where it is nearer to the place between the fingers.

use hrdsl_ir::world::{JointMotion, Vec3};
use hrdsl_robots::{RigidTransform, UrdfLink};

use crate::check::world::phase::WorldPhase;
use crate::{BodyId, JointId, world::TypedJoint};

impl WorldPhase<'_, '_> {
    /// Whether a joint is one of a description.
    pub(in crate::check::world) fn is_described(&self, id: JointId) -> bool {
        self.robots.iter().any(|robot| robot.joints.contains(&id))
    }

    /// The fingers that are closed at their lower limits. Those of hand-made parts never are.
    pub(in crate::check::world) fn closed_at_lower(
        &self,
        fingers: &[JointId],
        palm: BodyId,
        tool: Vec3,
    ) -> Vec<JointId> {
        let is = |id: &JointId| {
            let placed = self.robots.iter().find(|robot| robot.joints.contains(id))?;
            let joint = self.s.world.as_ref()?.joints.get(usize::from(id.0))?;
            let meeting = placed.poses.get(placed.link_of(palm)?.0)?.place(tool);
            let child = placed.link_of(joint.child)?;
            let at = placed.poses.get(child.0)?.place(middle(placed.robot()?.link(child)?));
            let away = |value: f64| distance(moved(joint, at, value), meeting);
            Some(away(joint.lo) < away(joint.hi))
        };
        fingers.iter().copied().filter(|id| is(id).unwrap_or(false)).collect()
    }
}

/// About where a link is, in its own frame.
fn middle(link: &UrdfLink) -> Vec3 {
    let shape = link.collisions.first().map(|shape| shape.origin.xyz);
    link.inertial.map(|inertial| inertial.origin.xyz).or(shape).unwrap_or_default()
}

/// Where a point of the child would be at a value of the joint.
fn moved(joint: &TypedJoint, at: Vec3, value: f64) -> Vec3 {
    let by = value - joint.drive.start;
    match joint.motion {
        JointMotion::Slider => RigidTransform::along(joint.axis.map(|x| x * by)).place(at),
        JointMotion::Hinge => {
            let [a, b, c] = joint.anchor;
            let [x, y, z] =
                RigidTransform::about_axis(joint.axis, by).place([at[0] - a, at[1] - b, at[2] - c]);
            [x + a, y + b, z + c]
        }
    }
}

fn distance(a: Vec3, b: Vec3) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum::<f64>().sqrt()
}
