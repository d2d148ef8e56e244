//! What a running world tells of its devices and bodies, besides its signals.

use hrdsl_ir::world::{ArmId, BaseId, BodyId, GripperId, Laser, LaserId, Vec3};

use crate::{
    WorldSimulation, laser,
    math::{SpaceVector, about, arr},
    physics::index,
};

impl WorldSimulation {
    /// `robot.arm`
    #[must_use]
    pub fn arm_named(&self, name: &str) -> Option<ArmId> {
        id(self.arms.iter().position(|a| a.name == name)).map(ArmId)
    }

    /// `robot.grip`
    #[must_use]
    pub fn gripper_named(&self, name: &str) -> Option<GripperId> {
        id(self.hands.named(name)).map(GripperId)
    }

    /// `robot.base`
    #[must_use]
    pub fn base_named(&self, name: &str) -> Option<BaseId> {
        id(self.bases.iter().position(|b| b.name == name)).map(BaseId)
    }

    /// Where a base was at the last physics step: x and y (m), and its heading (rad, -π..π).
    #[must_use]
    pub fn base_pose(&self, base: BaseId) -> Option<[f64; 3]> {
        let pose = self.bases.get(usize::from(base.0))?.pose();
        Some([pose.x, pose.y, pose.yaw])
    }

    /// How it was turned then: a unit quaternion x, y, z, w about the vertical.
    #[must_use]
    pub fn base_orientation(&self, base: BaseId) -> Option<[f64; 4]> {
        let [_, _, yaw] = self.base_pose(base)?;
        let turn = about(SpaceVector::z(), yaw);
        Some([turn.i, turn.j, turn.k, turn.w])
    }

    /// How fast it then was: forward and to the left (m/s), and about the vertical, to the left (rad/s).
    #[must_use]
    pub fn base_velocity(&self, base: BaseId) -> Option<[f64; 3]> {
        let velocity = self.bases.get(usize::from(base.0))?.velocity();
        Some([velocity.forward, velocity.sideways, velocity.turn])
    }

    /// What a laser measures along each beam, m: infinite where it meets nothing, minus infinity where something is too near.
    #[must_use]
    pub fn scan(&self, laser: LaserId) -> Option<Vec<f64>> {
        let laser = self.world.lasers.get(usize::from(laser.0))?;
        Some(laser::scan(laser, &self.physics))
    }

    /// What a laser is.
    #[must_use]
    pub fn laser(&self, laser: LaserId) -> Option<&Laser> {
        self.world.lasers.get(usize::from(laser.0))
    }

    /// `robot.palm`
    #[must_use]
    pub fn body_named(&self, name: &str) -> Option<BodyId> {
        id(self.world.bodies.iter().position(|b| b.name == name)).map(BodyId)
    }

    /// The measured angles of an arm's joints, rad; empty if there is no such arm.
    #[must_use]
    pub fn joint_positions(&self, arm: ArmId) -> Vec<f64> {
        self.arms.get(usize::from(arm.0)).map_or_else(Vec::new, |a| a.positions(&self.physics))
    }

    /// How far each finger of a gripper has moved on its joint, m or rad; empty if there is no such gripper, or it has no fingers.
    #[must_use]
    pub fn finger_places(&self, gripper: GripperId) -> Vec<f64> {
        let fingers = self.world.grippers.get(usize::from(gripper.0)).map_or(&[][..], |g| &g.fingers);
        fingers.iter().map(|joint| self.physics.joint_position(usize::from(joint.0))).collect()
    }

    /// Their measured speeds, rad/s.
    #[must_use]
    pub fn joint_speeds(&self, arm: ArmId) -> Vec<f64> {
        self.arms.get(usize::from(arm.0)).map_or_else(Vec::new, |a| a.speeds(&self.physics))
    }

    /// The torques (N·m) or forces (N) of an arm's motors over the last step.
    #[must_use]
    pub fn efforts(&self, arm: ArmId) -> Vec<f64> {
        self.arms.get(usize::from(arm.0)).map_or_else(Vec::new, |a| a.efforts(&self.physics))
    }

    /// Where an arm's tool point is (m), and how its tip is turned: a unit quaternion x, y, z, w.
    #[must_use]
    pub fn tool_pose(&self, arm: ArmId) -> Option<[f64; 7]> {
        let [x, y, z] = self.tool(arm)?;
        let tip = self.world.arms.get(usize::from(arm.0))?.tip;
        let (_, [i, j, k, w]) = self.pose(tip)?;
        Some([x, y, z, i, j, k, w])
    }

    /// Where an arm's tool point is, m.
    #[must_use]
    pub fn tool(&self, arm: ArmId) -> Option<Vec3> {
        Some(arr(self.arms.get(usize::from(arm.0))?.tool_at(&self.physics)))
    }

    /// What a gripper holds.
    #[must_use]
    pub fn holding(&self, gripper: GripperId) -> Option<BodyId> {
        self.hands.held_by(self.hand(gripper)?)
    }

    /// A body's centre (m) and rotation, a unit quaternion x, y, z, w.
    #[must_use]
    pub fn pose(&self, body: BodyId) -> Option<(Vec3, [f64; 4])> {
        self.world.bodies.get(index(body))?;
        let frame = self.physics.pose(body);
        let q = frame.turn;
        Some((arr(frame.at), [q.i, q.j, q.k, q.w]))
    }
}

fn id(at: Option<usize>) -> Option<u16> {
    at.and_then(|at| u16::try_from(at).ok())
}
