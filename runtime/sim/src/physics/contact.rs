//! Contacts: which bodies press on each other, and how hard, as the solver found it in the last step.
//!
//! The solver gives an impulse at each point of a contact, along its normal; over the time of the step it is a force. Friction,
//! which acts across the normal, is not counted. Bodies that the physics lets pass through each other never press.

use hrdsl_ir::world::BodyId;
use rapier3d::prelude::*;

use super::{PhysicsAdapter, body_id, index};
use crate::math::{SpaceVector, from_vector};

impl PhysicsAdapter {
    /// Whether two surfaces are in contact: one presses on the other, or they touch or overlap.
    pub fn touches(&self, a: BodyId, b: BodyId) -> bool {
        self.force_between(a, b) > 0.0 || self.distance(a, b) <= 0.0
    }

    /// How hard two bodies press on each other, N.
    pub fn force_between(&self, a: BodyId, b: BodyId) -> f64 {
        let (a, b) = (self.parts[index(a)].collider, self.parts[index(b)].collider);
        self.world.narrow_phase.contact_pair(a, b).map_or(0.0, |pair| self.push(pair).norm())
    }

    /// How hard all others press on the body: the sum over them, whatever the directions, N.
    pub fn force_on(&self, body: BodyId) -> f64 {
        self.pushes(body).map(|push| push.norm()).sum()
    }

    /// How hard others press down on the body: the vertical parts of what comes from above, N.
    pub fn load_on(&self, body: BodyId) -> f64 {
        self.pushes(body).map(|push| (-push.z).max(0.0)).sum()
    }

    /// The forces on the body, of each other one.
    fn pushes(&self, body: BodyId) -> impl Iterator<Item = SpaceVector> + '_ {
        let own = self.parts[index(body)].collider;
        let others = (0..self.parts.len()).map(body_id).map(|other| self.parts[index(other)].collider);
        // In the order of the bodies: what floats add up to must not depend on the engine's own order.
        others.filter(move |other| *other != own).filter_map(move |other| {
            let pair = self.world.narrow_phase.contact_pair(own, other)?;
            let push = self.push(pair);
            Some(if pair.collider1 == own { -push } else { push })
        })
    }

    /// The force on the second of a pair; its opposite is on the first.
    fn push(&self, pair: &ContactPair) -> SpaceVector {
        let seconds = f64::from(self.world.integration_parameters.dt);
        let mut sum = SpaceVector::zeros();
        for manifold in pair.solver_manifolds().iter().filter(|m| m.data.num_active_contacts() > 0) {
            let impulse: f64 = manifold.points.iter().map(|point| f64::from(point.data.impulse)).sum();
            sum += from_vector(manifold.data.normal) * impulse;
        }
        sum / seconds
    }

    /// The torque by which a joint's motor turned the child in the last step, about the joint's axis, Nm; 0 of a joint without one.
    pub fn torque(&self, joint: usize) -> f64 {
        let Some(hinge) = &self.joints[joint] else { return 0.0 };
        let parameters = &self.world.integration_parameters;
        let joint = self.world.impulse_joints.get(hinge.handle);
        let impulse = joint.and_then(|joint| joint.data.motor(JointAxis::AngX)).map_or(0.0, |m| m.impulse);
        // The solver divides the step, and tells the impulse of the last of its parts, on the parent.
        -f64::from(impulse) / f64::from(parameters.dt) * parameters.num_solver_iterations as f64
    }
}
