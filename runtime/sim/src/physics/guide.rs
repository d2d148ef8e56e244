//! The bodies of those who are alive, drawn to where they are to be, in each part of a step.

use hrdsl_ir::world::BodyId;
use rapier3d::prelude::*;

use super::state::{adapter::PhysicsAdapter, bodies::index, guide::StepPart};
use crate::math::{BodyFrame, SpaceVector, from_vector, to_vector};

impl PhysicsAdapter {
    /// A guided body is to be there at the end of the next step.
    pub(super) fn guide(&mut self, body: BodyId, to: &BodyFrame) {
        if let Some(guide) = &mut self.guides[index(body)] {
            guide.to = *to;
        }
    }

    /// How far a guided body is from where it is to be, m; null of others.
    pub fn strayed(&self, body: BodyId) -> SpaceVector {
        let aim = self.guides[index(body)].as_ref();
        aim.map_or_else(SpaceVector::zeros, |guide| self.pose(body).at - guide.from.at)
    }

    /// Where a guided body is to be; of another where it is.
    pub fn aim(&self, body: BodyId) -> BodyFrame {
        self.guides[index(body)].as_ref().map_or_else(|| self.pose(body), |guide| guide.from)
    }

    /// Where a guided body is to be at the end of the next step; of another where it is.
    pub fn aimed(&self, body: BodyId) -> BodyFrame {
        self.guides[index(body)].as_ref().map_or_else(|| self.pose(body), |guide| guide.to)
    }

    /// A guided body carries so much from now on, kg.
    pub(super) fn load(&mut self, body: BodyId, mass: f64) {
        if let Some(guide) = &mut self.guides[index(body)] {
            guide.load = mass;
        }
    }

    /// Draws all guided bodies for a part of a step.
    pub(super) fn draw_guided(&mut self, part: StepPart) {
        let weight = from_vector(self.world.gravity);
        for (guide, own) in self.guides.iter().zip(&self.parts) {
            let Some(guide) = guide else { continue };
            let body = &mut self.world.bodies[own.handle];
            let (impulse, turn) = (guide.impulse(body, weight, part), guide.turn(body, part));
            if turn.norm() > 0.0 || body.angvel() != AngVector::ZERO {
                body.set_angvel(to_vector(turn), true);
            }
            if impulse.norm() > 0.0 {
                body.apply_impulse(to_vector(impulse), true);
            }
        }
    }

    /// The step is over: where the bodies were to be is where the next one begins.
    pub(super) fn end_guided(&mut self, dt: f64) {
        for guide in self.guides.iter_mut().flatten() {
            guide.pace = (guide.to.at - guide.from.at) / dt;
            guide.from = guide.to;
        }
    }

    /// Nothing draws these bodies any more, and each has the mass that is given with it, kg: they fall.
    pub fn let_fall(&mut self, bodies: &[(BodyId, f64)]) {
        for (id, mass) in bodies {
            self.guides[index(*id)] = None;
            let part = &self.parts[index(*id)];
            self.world.colliders[part.collider].set_mass(*mass as f32);
            let body = &mut self.world.bodies[part.handle];
            body.set_gravity_scale(1.0, true);
        }
    }

    /// How much room a body takes, m³.
    pub fn volume(&self, body: BodyId) -> f64 {
        f64::from(self.world.colliders[self.parts[index(body)].collider].shape().mass_properties(1.0).mass())
    }

    /// Joins two bodies at a point in the world, so that they turn freely about it.
    pub fn join_at(&mut self, first: BodyId, point: SpaceVector, second: BodyId) {
        let local = |body: BodyId| to_vector(self.pose(body).inverse().point(point));
        let joint = SphericalJointBuilder::new()
            .local_anchor1(local(first))
            .local_anchor2(local(second))
            .contacts_enabled(false)
            .build();
        let (a, b) = (self.parts[index(first)].handle, self.parts[index(second)].handle);
        self.world.insert_impulse_joint(a, b, joint);
    }
}
