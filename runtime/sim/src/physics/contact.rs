//! Contacts: which bodies press on each other, and how hard, as the solver found it in the last step.
//!
//! The solver gives an impulse at each point of a contact, along its normal; over the time of the step it is a force, the mean over
//! the parts of the step. Friction, which acts across the normal, is not counted. Where a surface yields, it is the greatest force of the step. Bodies that the physics
//! lets pass through each other never press.

use hrdsl_ir::world::BodyId;
use rapier3d::prelude::*;

use super::state::{
    adapter::PhysicsAdapter,
    bodies::{body_id, index},
    loads::ContactLoads,
};
use crate::math::{SpaceVector, from_vector};

/// Deeper, m, the points of a contact are not taken at their word: those of round bodies are the corners of the polygons that the engine takes them
/// for, and of two cylinders that cross may be centimetres in each other where the bodies are not. Then the shapes are asked.
const DOUBTED: f64 = 2e-3;

/// A contact of one body with another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pressing {
    pub other: BodyId,
    /// Along the surfaces' normals, N.
    pub force: f64,
}

impl PhysicsAdapter {
    /// What presses a body, and how hard.
    pub fn pressings(&self, body: BodyId) -> impl Iterator<Item = Pressing> + '_ {
        let rigid = self.loads.on(index(body)).filter_map(|(other, push)| {
            let force = push.norm();
            (force > 0.0).then_some(Pressing { other: body_id(other), force })
        });
        let yielding = self.yielding_pushes(body);
        rigid.chain(yielding.map(|(other, push)| Pressing { other, force: push.norm() }))
    }

    /// Whether two surfaces are in contact: one presses on the other, or they touch or overlap.
    pub fn touches(&self, a: BodyId, b: BodyId) -> bool {
        self.force_between(a, b) > 0.0 || self.distance(a, b) <= 0.0
    }

    /// How hard two bodies press on each other, N.
    pub fn force_between(&self, a: BodyId, b: BodyId) -> f64 {
        let yielding: f64 =
            self.yielding_pushes(a).filter(|(other, _)| *other == b).map(|(_, push)| push.norm()).sum();
        let rigid = self.loads.on(index(a)).find(|(other, _)| *other == index(b));
        yielding + rigid.map_or(0.0, |(_, push)| push.norm())
    }

    /// How hard all others press on the body: the sum over them, whatever the directions, N.
    pub fn force_on(&self, body: BodyId) -> f64 {
        self.pushes(body).map(|push| push.norm()).sum()
    }

    /// How hard others press down on the body: the vertical parts of what comes from above, N.
    pub fn load_on(&self, body: BodyId) -> f64 {
        self.pushes(body).map(|push| (-push.z).max(0.0)).sum()
    }

    /// How hard others press up on the body: the vertical parts of what comes from below, N.
    pub(super) fn load_from_below(&self, body: BodyId) -> f64 {
        self.rigid_pushes(body).map(|push| push.z.max(0.0)).sum()
    }

    /// The forces on the body, of each other one.
    pub(super) fn pushes(&self, body: BodyId) -> impl Iterator<Item = SpaceVector> + '_ {
        self.rigid_pushes(body).chain(self.yielding_pushes(body).map(|(_, push)| push))
    }

    /// What rigid bodies do to it together, N.
    pub fn borne_by_rigid(&self, body: BodyId) -> SpaceVector {
        self.rigid_pushes(body).sum()
    }

    fn rigid_pushes(&self, body: BodyId) -> impl Iterator<Item = SpaceVector> + '_ {
        self.loads.on(index(body)).map(|(_, push)| push)
    }

    // ── How they are found ──

    /// Looks at all contacts after a part of a step: how deep bodies were in each other as it began, and what the solver found for it.
    pub(super) fn look_at_contacts(&mut self) -> ContactLoads {
        let mut loads = ContactLoads::default();
        let (mut accuracy, mut deepest) = (std::mem::take(&mut self.accuracy), 0.0_f64);
        let number = |handle| self.world.colliders.get(handle).map(|c| c.user_data as usize);
        for pair in self.world.contact_pairs() {
            let manifolds = pair.solver_manifolds();
            let depths =
                manifolds.iter().flat_map(|manifold| &manifold.points).map(|point| -f64::from(point.dist));
            let depth = depths.fold(0.0, f64::max);
            let is_active = manifolds.iter().any(|manifold| !manifold.data.solver_contacts.is_empty());
            deepest = deepest.max(depth);
            if depth <= 0.0 && !is_active {
                continue;
            }
            let (Some(a), Some(b)) = (number(pair.collider1), number(pair.collider2)) else { continue };
            if depth > 0.0 {
                let is_own = self.robots.get(a) == self.robots.get(b);
                let (one, other) = (body_id(a), body_id(b));
                let depth =
                    if depth > DOUBTED { self.depth(one, &self.pose(one), other).min(depth) } else { depth };
                accuracy.look_at_depth(depth, (a, b), is_own);
            }
            if is_active && (self.is_solved(a) || self.is_solved(b)) {
                loads.add(a, b, self.push(manifolds));
            }
        }
        (self.accuracy, self.deepest) = (accuracy, deepest);
        loads
    }

    /// The step is over: pairs that sleep are as they were.
    pub(super) fn keep_loads(&mut self, mut loads: ContactLoads) {
        let before = std::mem::take(&mut self.loads);
        loads.take_over(before, |a, b| !self.is_solved(a) && !self.is_solved(b));
        self.loads = loads;
    }

    /// Whether the solver has to do with a body.
    fn is_solved(&self, part: usize) -> bool {
        if !self.parts[part].gives_way() {
            return false;
        }
        let body = &self.world.bodies[self.parts[part].handle];
        body.is_dynamic() && !body.is_sleeping()
    }

    /// The force on the second of a pair in the last part of the step; its opposite is on the first.
    fn push(&self, manifolds: &[ContactManifold]) -> SpaceVector {
        let mut sum = SpaceVector::zeros();
        for manifold in manifolds.iter().filter(|m| m.data.num_active_contacts() > 0) {
            let impulse: f64 = manifold.points.iter().map(|point| f64::from(point.data.impulse)).sum();
            sum += from_vector(manifold.data.normal) * impulse;
        }
        sum / self.part.0
    }
}
