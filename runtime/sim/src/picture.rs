//! What can be seen of the world: poses, joints and contacts, as somebody draws them.

use hrdsl_harness::BodyPose;
use hrdsl_ir::world::{BodyId, JointId, Vec3};

use crate::{WorldSimulation, math::arr};

impl WorldSimulation {
    /// Where the bodies are that move and are not rigidly one with another.
    pub(crate) fn poses(&self, tell: &mut dyn FnMut(BodyPose)) {
        for (body, frame) in self.physics.moving_poses() {
            let turn = frame.turn.coords;
            tell(BodyPose { body, place: arr(frame.at), turn: [turn.x, turn.y, turn.z, turn.w] });
        }
    }

    /// Where the joints are that can move, rad or m.
    pub(crate) fn joints(&self, tell: &mut dyn FnMut(JointId, f64)) {
        for (at, joint) in self.world.joints.iter().enumerate() {
            if !joint.is_rigid() && !self.physics.is_asleep(at) {
                tell(JointId(u16::try_from(at).unwrap_or(u16::MAX)), self.physics.joint_position(at));
            }
        }
    }

    /// Which bodies press on each other with at least so much: the force on the second, N.
    pub(crate) fn contacts(&self, least: f64, tell: &mut dyn FnMut([BodyId; 2], Vec3)) {
        self.physics.each_contact(least, |bodies, force| tell(bodies, arr(force)));
    }

    /// Where about two bodies touch.
    pub(crate) fn contact_point(&self, [a, b]: [BodyId; 2]) -> Option<Vec3> {
        self.physics.touching_point(a, b).map(arr)
    }
}
