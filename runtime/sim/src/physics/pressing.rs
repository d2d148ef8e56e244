//! How hard bodies press each other, as the solver found it.

use hrdsl_ir::world::BodyId;
use rapier3d::prelude::*;

use super::{PhysicsAdapter, body_id, index};

/// A contact of one body with another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pressing {
    pub other: BodyId,
    /// Along the surfaces' normals, N.
    pub force: f64,
}

impl PhysicsAdapter {
    /// What presses a body, and how hard, over the last step.
    pub fn pressings(&self, body: BodyId) -> impl Iterator<Item = Pressing> + '_ {
        let own = self.parts[index(body)].collider;
        self.world.contact_pairs_with(own).filter_map(move |pair| {
            let other = if pair.collider1 == own { pair.collider2 } else { pair.collider1 };
            let force = self.normal_force(pair);
            let number = usize::try_from(self.world.colliders[other].user_data).ok()?;
            (force > 0.0).then_some(Pressing { other: body_id(number), force })
        })
    }

    fn normal_force(&self, pair: &ContactPair) -> f64 {
        let PairContacts::Rigid(contacts) = &pair.contacts else { return 0.0 };
        let points = contacts.solver_manifolds().iter().flat_map(|manifold| &manifold.points);
        let impulse: f32 = points.map(|point| point.data.impulse).sum();
        f64::from(impulse) / f64::from(self.world.integration_parameters.dt)
    }
}
