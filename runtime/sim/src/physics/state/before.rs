//! What moves, as it was before a part of a step: so that it can be put back, and the part be done again.

use rapier3d::prelude::*;

/// What moves, as it was before a part of a step.
#[derive(Default)]
pub(crate) struct MotionBefore {
    pub bodies: Vec<BodyBefore>,
    /// By number, the joints that might come to their ends, and where they were, from their start, rad or m.
    pub joints: Vec<(usize, f64)>,
}

/// One of the engine's bodies.
pub(crate) struct BodyBefore {
    pub handle: RigidBodyHandle,
    pub pose: Pose,
    /// Where one that is led is to be after it.
    pub next: Pose,
    pub velocity: RigidBodyVelocity<f32>,
    pub sleeps: bool,
}
