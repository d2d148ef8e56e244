//! What the system actor can ask of its arms, hands and bases.

use hrdsl_ir::world::{ArmId, BaseId, GripperId, Vec3};

/// A request to a motor or hand. It takes time; its end is told by [`finished`](crate::WorldSimulation::finished).
#[derive(Clone, Debug, PartialEq)]
pub enum MotorCommand {
    /// Brings the arm's tool point to a place in the world (m), along whatever path the planner finds.
    ReachPoint {
        arm: ArmId,
        target: Vec3,
        /// No joint goes faster (rad/s); at most, and without it exactly, the arm's own limit.
        max_speed: Option<f64>,
    },
    /// Brings the arm's joints to these angles (rad), in the arm's order, all arriving at once.
    ReachJoints { arm: ArmId, positions: Vec<f64>, max_speed: Option<f64> },
    /// Brings the joints through postures (rad, one after the other), each at its time (s, from now).
    FollowJoints { arm: ArmId, positions: Vec<f64>, times: Vec<f64> },
    /// Lets the motor of one joint, counted from the base, aim at an angle (rad) from now on.
    AimJoint { arm: ArmId, joint: f64, to: f64 },
    /// Gives up what the arm is doing.
    StopJoints { arm: ArmId },
    /// Lets go of what the hand holds, after the hand's delay.
    OpenFingers { gripper: GripperId },
    /// After the hand's delay, takes the nearest body in reach. That there is none is not an error: ask whether it holds.
    CloseFingers { gripper: GripperId },
    /// Lets a base drive from now on: forward and to the left (m/s), and about the vertical, to the left (rad/s).
    DriveWheels { base: BaseId, forward: f64, sideways: f64, turn: f64 },
    /// Brakes a base until it stands.
    StopWheels { base: BaseId },
}
