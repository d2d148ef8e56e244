//! The bodies of those who are alive, drawn to where they are to be, in each part of a step.

use hrdsl_ir::world::BodyId;
use rapier3d::prelude::*;

use super::state::{adapter::PhysicsAdapter, bodies::index, guide::StepPart};
use crate::math::{BodyFrame, SpaceVector, from_pose, from_vector, to_vector};

/// How much the swing of a relaxed limb is damped, of the critical: the peaks of a healthy leg that was let fall from the knee are 0.94,
/// 0.60, 0.38 and 0.26 rad (Wartenberg's pendulum test; J. Nov. Physiother. S6-001, figure 1), each 0.64 of the one before.
const SWING_DAMPING: f64 = 0.07;
/// What limbs swing with, m/s².
const STANDARD_GRAVITY: f64 = 9.80665;

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
        for (guide, own) in self.guides.iter_mut().zip(&self.parts) {
            let Some(guide) = guide else { continue };
            let body = &self.world.bodies[own.handle];
            if guide.rests(body) {
                continue;
            }
            let at = from_pose(body.position());
            let impulse = guide.impulse(at.at, from_vector(body.linvel()), weight, part);
            let turn = guide.turn(&at.turn, part);
            let turns = turn.norm_squared() > 0.0 || body.angvel() != AngVector::ZERO;
            let is_pushed = impulse.norm_squared() > 0.0;
            guide.note_rest(body, turns || is_pushed);
            // The engine looks again at what is taken to be changed.
            if !turns && !is_pushed {
                continue;
            }
            let body = &mut self.world.bodies[own.handle];
            if turns {
                body.set_angvel(to_vector(turn), true);
            }
            if is_pushed {
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
        self.fallen.extend(bodies.first().map(|(body, _)| self.parts[index(*body)].handle));
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

    /// Joins two bodies at a point in the world, so that they turn about it, the second one as a pendulum that swings out.
    pub fn join_at(&mut self, first: BodyId, point: SpaceVector, second: BodyId) {
        let local = |body: BodyId| to_vector(self.pose(body).inverse().point(point));
        let resistance = self.swing_resistance(point, second) as f32;
        let mut joint = SphericalJointBuilder::new()
            .local_anchor1(local(first))
            .local_anchor2(local(second))
            .contacts_enabled(false);
        for axis in [JointAxis::AngX, JointAxis::AngY, JointAxis::AngZ] {
            joint = joint.motor_model(axis, MotorModel::ForceBased).motor_velocity(axis, 0.0, resistance);
        }
        let (a, b) = (self.parts[index(first)].handle, self.parts[index(second)].handle);
        self.world.insert_impulse_joint(a, b, joint.build());
    }

    /// By how much a body's swing about a point is damped, N·m·s/rad.
    fn swing_resistance(&self, point: SpaceVector, body: BodyId) -> f64 {
        let collider = &self.world.colliders[self.parts[index(body)].collider];
        let properties = collider.mass_properties();
        let mass = f64::from(properties.mass());
        let arm = (from_vector(*collider.position() * properties.local_com) - point).norm();
        let inertia = f64::from(properties.principal_inertia().max_element()) + mass * arm * arm;
        let frequency = (mass * STANDARD_GRAVITY * arm / inertia).sqrt();
        2.0 * SWING_DAMPING * inertia * frequency
    }
}
