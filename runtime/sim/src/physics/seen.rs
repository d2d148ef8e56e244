//! What the physics shows to those who only look: poses of what moves, and where bodies press on each other.

use hrdsl_ir::world::{BodyId, BodyMotion};
use rapier3d::parry;

use super::state::{
    adapter::PhysicsAdapter,
    bodies::{body_id, index},
};
use crate::math::{BodyFrame, SpaceVector, from_pose, from_vector, to_pose};

/// So far apart surfaces may be that still press on each other, m.
const TOUCHING: f32 = 0.02;

impl PhysicsAdapter {
    /// Of each body of the engine that can move and is awake, that of the scenario which stands for it.
    pub fn moving_poses(&self) -> impl Iterator<Item = (BodyId, BodyFrame)> + '_ {
        self.parts.iter().enumerate().filter_map(|(at, part)| {
            if index(part.root) != at || part.motion == BodyMotion::Fixed {
                return None;
            }
            let body = &self.world.bodies[part.handle];
            (!body.is_sleeping()).then(|| (body_id(at), from_pose(body.position()).then(&part.local)))
        })
    }

    /// Pairs that press on each other with at least so much (N), each once, with the force on the second: rigid ones, then those that
    /// yield.
    pub fn each_contact(&self, least: f64, mut tell: impl FnMut([BodyId; 2], SpaceVector)) {
        for (a, b, force) in self.loads.pairs().filter(|(_, _, force)| force.norm_squared() >= least * least)
        {
            tell([body_id(a), body_id(b)], force);
        }
        for (_, pair, contact) in self.yielding.touching().filter(|(.., contact)| contact.peak() >= least) {
            // The normal is that of the force on what yields.
            tell([body_id(pair.other), body_id(pair.soft)], contact.normal * contact.peak());
        }
    }

    /// The middle between the points at which two bodies are nearest to each other, or deepest in each other.
    pub fn touching_point(&self, a: BodyId, b: BodyId) -> Option<SpaceVector> {
        let (one, two) = (&self.parts[index(a)], &self.parts[index(b)]);
        let (at, there) = (to_pose(&self.pose(a)), to_pose(&self.pose(b)));
        let found = parry::query::contact(&at, &*one.surface, &there, &*two.surface, TOUCHING);
        found.ok().flatten().map(|c| (from_vector(c.point1) + from_vector(c.point2)) / 2.0)
    }
}
