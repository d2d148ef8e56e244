//! What the system actor can ask of its arms and hands.

use hrdsl_ir::world::{ArmId, GripperId, Vec3};

/// A request to a motor or hand. It takes time; its end is told by [`Sim::finished`](crate::Sim::finished).
#[derive(Clone, Debug, PartialEq)]
pub enum MotorCommand {
    /// Brings the arm's tool point to a place in the world (m), along whatever way the planner finds.
    ReachPoint {
        arm: ArmId,
        target: Vec3,
        /// No joint goes faster (rad/s); at most, and without it exactly, the arm's own limit.
        max_speed: Option<f64>,
    },
    /// Brings the arm's joints to these angles (rad), in the arm's order, all arriving at once.
    ReachJoints { arm: ArmId, positions: Vec<f64>, max_speed: Option<f64> },
    /// Lets go of what the hand holds, after the hand's delay.
    OpenFingers { gripper: GripperId },
    /// After the hand's delay, takes the nearest body in reach. That there is none is not an error: ask whether it holds.
    CloseFingers { gripper: GripperId },
}
