//! Contacts: which bodies press on each other, and how hard, as the solver found it in the last step.
//!
//! The solver gives an impulse at each point of a contact, along its normal; over the time of the step it is a force. Friction,
//! which acts across the normal, is not counted. Where a surface yields, it is the greatest force of the step. Bodies that the physics
//! lets pass through each other never press.

use hrdsl_ir::world::BodyId;
use rapier3d::prelude::*;

use super::state::{
    adapter::PhysicsAdapter,
    bodies::{body_id, index},
};
use crate::math::{SpaceVector, from_vector};

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
        let own = self.parts[index(body)].collider;
        let rigid = self.world.contact_pairs_with(own).filter_map(move |pair| {
            let other = if pair.collider1 == own { pair.collider2 } else { pair.collider1 };
            let force = self.push(pair).norm();
            let number = usize::try_from(self.world.colliders[other].user_data).ok()?;
            (force > 0.0).then_some(Pressing { other: body_id(number), force })
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
        let (a, b) = (self.parts[index(a)].collider, self.parts[index(b)].collider);
        yielding + self.world.narrow_phase.contact_pair(a, b).map_or(0.0, |pair| self.push(pair).norm())
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
        let own = self.parts[index(body)].collider;
        let pairs = self.world.contact_pairs_with(own).filter(|pair| pair.has_any_active_contact());
        let mut found: Vec<(u128, SpaceVector)> = pairs
            .filter_map(|pair| {
                let is_first = pair.collider1 == own;
                let other =
                    self.world.colliders.get(if is_first { pair.collider2 } else { pair.collider1 })?;
                let push = self.push(pair);
                Some((other.user_data, if is_first { -push } else { push }))
            })
            .collect();
        // In the order of the bodies: what floats add up to must not depend on the engine's own order.
        found.sort_by_key(|(other, _)| *other);
        found.into_iter().map(|(_, push)| push)
    }

    /// The time in which the solver last did what it did to a pair, s: that of the one that can move.
    fn solved_for(&self, pair: &ContactPair) -> f64 {
        let number = |handle| self.world.colliders.get(handle).map(|c| c.user_data as usize);
        let of = |at: usize| self.parts.get(at).filter(|part| self.world.bodies[part.handle].is_dynamic());
        let moves =
            [pair.collider1, pair.collider2].into_iter().filter_map(number).find(|at| of(*at).is_some());
        moves.map_or(self.part, |at| self.solved[at]).0
    }

    /// The force on the second of a pair; its opposite is on the first.
    fn push(&self, pair: &ContactPair) -> SpaceVector {
        let mut sum = SpaceVector::zeros();
        for manifold in pair.solver_manifolds().iter().filter(|m| m.data.num_active_contacts() > 0) {
            let impulse: f64 = manifold.points.iter().map(|point| f64::from(point.data.impulse)).sum();
            sum += from_vector(manifold.data.normal) * impulse;
        }
        sum / self.solved_for(pair)
    }
}
