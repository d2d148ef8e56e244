//! What the adapter keeps of the engine and of each body, between one step and the next.

use hrdsl_harness::{SpentTime, ThreadClock};
use hrdsl_ir::world::{BodyId, BodyMotion, BodyShape};
use rapier3d::{parry::bounding_volume::Aabb, prelude::*};

use super::{
    accuracy::AccuracyWatch, before::MotionBefore, energy::EnergyWatch, guide::BodyGuide, joint::DrivenJoint,
    loads::ContactLoads, losses::JointLosses, pairs::ExemptPairs, place::JointedBodies, solid::SolidExtent,
    yielding::YieldingPairs,
};
use crate::math::BodyFrame;

/// One body of the scenario.
pub struct PhysicsBody {
    pub name: String,
    pub handle: RigidBodyHandle,
    pub collider: ColliderHandle,
    /// Within the engine's body.
    pub local: BodyFrame,
    pub start: BodyFrame,
    /// The body that this one is one with.
    pub root: BodyId,
    pub motion: BodyMotion,
    pub ghost: bool,
    pub shape: BodyShape,
    /// That of the engine.
    pub surface: SharedShape,
    /// Of a sphere around it, m.
    pub radius: f32,
    /// Of a body that has not just one shape.
    pub extent: Option<SolidExtent>,
}

impl PhysicsBody {
    /// Whether forces move it.
    pub fn gives_way(&self) -> bool {
        match self.motion {
            BodyMotion::Dynamic | BodyMotion::Guided => true,
            BodyMotion::Fixed | BodyMotion::Kinematic => false,
        }
    }
}

pub(crate) struct PhysicsAdapter {
    pub world: PhysicsWorld,
    pub parts: Vec<PhysicsBody>,
    /// By body: where the engine last had its collider, and the box around it then; of a mere frame none.
    pub boxes: Vec<Option<(Pose, Aabb)>>,
    /// By body: what draws those that are guided.
    pub guides: Vec<Option<BodyGuide>>,
    pub yielding: YieldingPairs,
    /// One body of each of those who have fallen and hang together.
    pub fallen: Vec<RigidBodyHandle>,
    /// By [`hrdsl_ir::world::JointId`]; none where the joint is rigid.
    pub joints: Vec<Option<DrivenJoint>>,
    /// What these are on.
    pub jointed: JointedBodies,
    pub losses: JointLosses,
    pub loads: ContactLoads,
    pub exempt: ExemptPairs,
    pub energy: EnergyWatch,
    pub accuracy: AccuracyWatch,
    /// By body: a number of what it is joined to.
    pub robots: Vec<usize>,
    /// Where kinematic bodies will be at the end of the next step.
    pub led: Vec<(RigidBodyHandle, Pose)>,
    /// What moved, as it was before the last part of a step, if a joint might come to its end in it.
    pub before: MotionBefore,
    /// The time of a step, s.
    pub step: f64,
    /// How often the solver goes over all joints and contacts in each part of one.
    pub sweeps: usize,
    /// The part of a step that the joints are told to mend in.
    pub mended: (f64, usize),
    /// For how many steps more a joint counts as pressed beyond its limit.
    pub pressed: usize,
    /// How deep two bodies were in each other as the last part of a step began, m.
    pub deepest: f64,
    /// The time of the last part of a step, s, and how often the solver divided it.
    pub part: (f64, usize),
    /// By body: the same of when the solver last had to do with it. What sleeps keeps the impulses of then.
    pub solved: Vec<(f64, usize)>,
    /// The corners of the box outside of which a body is lost, m.
    pub scene: (Vector, Vector),
    /// What measures the engine, if anybody asks.
    pub clock: Option<ThreadClock>,
    /// What the engine's steps took so far, by that clock.
    pub engine_time: SpentTime,
}
