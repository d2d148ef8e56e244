//! How rigidly arms are steered.

use hrdsl_ir::world::{BodyId, World};

use crate::physics::PhysicsAdapter;

/// The frequency of an arm's controlled joints, 1/s; and the most that this is of the frequency of the steps, so that they are stable.
const RIGID: f64 = 25.0;
const RIGID_OF_STEPS: f64 = 0.25;
/// The same on a base that gives way, of which the control knows nothing: where it takes a part in the motion, joints are quicker than
/// their torques were meant to make them.
const RIGID_ON_WHEELS: f64 = 12.5;

/// That of an arm on this body, 1/s.
pub(crate) fn of_arm_on(base: BodyId, physics: &PhysicsAdapter, world: &World) -> f64 {
    if physics.is_loose(base, world) { RIGID_ON_WHEELS } else { RIGID }
}

/// The same in steps of this time, s.
pub(crate) fn in_steps(rigid: f64, h: f64) -> f64 {
    rigid.min(RIGID_OF_STEPS / h)
}
