//! What can go wrong: in the world's data, in an action, in a command.

use hrdsl_ir::expr::EvalError;

/// The world's data, or an environment actor's action, cannot be carried out.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SimulationError {
    #[error("{what} refers to {kind} {index}, which does not exist")]
    BadReference { what: String, kind: &'static str, index: usize },
    #[error("{what} must be a positive finite number")]
    BadNumber { what: String },
    #[error("the arm `{arm}` is not a chain: joint `{joint}` does not start where the one before it ends")]
    NotAChain { arm: String, joint: String },
    #[error("the tip of the arm `{arm}` does not move with its last joint")]
    TipNotOnArm { arm: String },
    #[error("the joint `{joint}` does not carry a dynamic body of its own")]
    BadChild { joint: String },
    #[error(
        "the gripper `{gripper}` cannot hold `{body}`, which is not dynamic, nor rigidly one with a body that is"
    )]
    NotHoldable { gripper: String, body: String },
    #[error("the body `{body}` is neither kinematic nor guided, so that no action moves it")]
    NotMoved { body: String },
    #[error("the body `{body}` is neither kinematic nor dynamic, so that no base moves it")]
    NotDriven { body: String },
    #[error("the body `{body}` of a figure is not guided")]
    NotGuided { body: String },
    #[error("`{body}` goes where its figure goes: send the head, a hand or the pelvis")]
    GoesAlong { body: String },
    /// Metres.
    #[error("`{body}` starts inside `{other}`, by {depth:.3} m: put them apart")]
    StartsInside { body: String, other: String, depth: f64 },
    #[error("{what} has no value: {error}")]
    Eval { what: String, error: EvalError },
}

/// A command of the system actor was refused or did not succeed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CommandError {
    #[error("there is no such arm")]
    NoSuchArm,
    #[error("there is no such gripper")]
    NoSuchGripper,
    #[error("there is no such base")]
    NoSuchBase,
    /// Metres from the nearest place that the planner found.
    #[error("the place is out of reach, by {distance:.3} m")]
    Unreachable { distance: f64 },
    #[error("the arm has {expected} joints, but {given} positions were given")]
    WrongJointCount { expected: usize, given: usize },
    #[error("the arm has {expected} joints, but {given} speeds or accelerations were given")]
    WrongLimitCount { expected: usize, given: usize },
    #[error("the position given for joint `{joint}` is beyond its limits")]
    OutOfLimits { joint: String },
    #[error("a posture has {joints} angles, so that {times} of them have {expected}, but {given} were given")]
    WrongTrackLength { joints: usize, times: usize, expected: usize, given: usize },
    #[error("each posture of a trajectory comes later than the one before, the first not before the command")]
    TimesDoNotGrow,
    #[error("joints are counted from 0 to {}", joints.saturating_sub(1))]
    NoSuchJoint { joints: usize },
    #[error("speeds and accelerations must be positive finite numbers")]
    BadSpeed,
    #[error("a place or position must be a finite number")]
    NotFinite,
    /// No way was found that touches nothing.
    #[error("there is no free way: `{part}` would touch `{by}`")]
    Obstructed { part: String, by: String },
    /// The motors could not go on.
    #[error("the arm is blocked{}", by.as_ref().map_or_else(String::new, |by| format!(" by `{by}`")))]
    Blocked { by: Option<String> },
    /// The arm stops on contact.
    #[error("the arm stopped: `{by}` presses it with {force:.0} N")]
    Pressed { by: String, force: f64 },
    /// Metres from the place when the controller gave up.
    #[error("the arm did not arrive: it stopped {distance:.3} m from the place")]
    Missed { distance: f64 },
    /// How fast a joint still was there when the controller gave up, rad/s or m/s.
    #[error("the arm is at the place, but does not come to rest: a joint moves at {speed:.3} rad/s")]
    Unsettled { speed: f64 },
    /// A later command to the same device took its place.
    #[error("the command was replaced by a later one")]
    Replaced,
}
