//! A joint of the engine, with what its motor does.

use hrdsl_ir::world::JointMotion;
use rapier3d::prelude::*;

use crate::math::{BodyFrame, SpaceVector};

/// A joint of the engine.
pub(crate) struct DrivenJoint {
    pub name: String,
    pub handle: ImpulseJointHandle,
    pub parent: RigidBodyHandle,
    pub child: RigidBodyHandle,
    /// What bears the torque of a hinge's motor: the parent, or what that slides on. It cannot turn against it, so that it is the same,
    /// but for the solver, which would have to hand on what a light torso cannot bear.
    pub bearer: RigidBodyHandle,
    pub motion: JointMotion,
    /// At the start, in the world.
    pub axis: SpaceVector,
    pub anchor: SpaceVector,
    pub parent_start: BodyFrame,
    pub child_start: BodyFrame,
    /// What it carries: bodies on the child's side.
    pub carried: Vec<RigidBodyHandle>,
    /// The most that its motor can do, and what it does.
    pub limit: f64,
    pub effort: f64,
    /// Where it is at the start, and its limits, rad or m.
    pub start: f64,
    pub lo: f64,
    pub hi: f64,
    /// Of a hinge that may turn farther than half round: where it was last.
    pub wound: Option<f64>,
    /// How the solver mends what has come apart at it; and whether it has come so far apart that it gives way.
    pub softness: SpringCoefficients<f32>,
    pub is_torn: bool,
    /// The engine's motor runs it.
    pub is_run: bool,
}
