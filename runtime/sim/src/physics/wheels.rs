//! Wheels: what drives a base that can be pushed and toppled.
//!
//! The lowest bodies of the base stand for its wheels: they slide without friction, and the tyres' force acts on the ground below the
//! middle of the base. It is as much as brings the base to its velocity, but no more than friction of 0.8 times what the ground bears;
//! so a base that brakes hard nods, one whose wheels are in the air does not drive, and one that is held back slips. A base that has
//! tipped over lies, and its wheels have friction like everything else.

use hrdsl_ir::world::{BodyId, World};
use rapier3d::prelude::*;

use super::state::{adapter::PhysicsAdapter, bodies::index};
use crate::math::{SpaceVector, from_vector, to_vector};

/// Between tyres and the ground, and on all other surfaces.
const FRICTION: f64 = 0.8;
/// What is so near to the lowest point of a base is a wheel, m.
const WHEEL: f64 = 0.01;
/// Below this nothing is done, m/s and rad/s.
const STANDS: f64 = 1e-4;

/// A base on wheels, as its wheels know it.
#[derive(Clone, Debug)]
pub(crate) struct RollingBase {
    body: BodyId,
    wheels: Vec<BodyId>,
    /// With all that is joined to it, kg, and of the base alone about the vertical, kg·m².
    mass: f64,
    inertia: f64,
    /// From the middle to the wheels, m.
    radius: f64,
}

/// What the tyres of a base do to it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct TyrePush {
    /// N
    force: SpaceVector,
    /// About the vertical, N·m.
    torque: f64,
}

impl PhysicsAdapter {
    /// Puts a base on wheels.
    pub fn on_wheels(&mut self, body: BodyId, world: &World) -> RollingBase {
        let own: Vec<BodyId> = self.one_with(self.root(body)).filter(|b| !self.is_ghost(*b)).collect();
        let lowest = own.iter().map(|b| self.lowest(*b)).fold(f64::INFINITY, f64::min);
        let wheels: Vec<BodyId> = own.into_iter().filter(|b| self.lowest(*b) <= lowest + WHEEL).collect();
        self.weigh_described(world);
        let middle = self.pose(body).at;
        let reach = |b: &BodyId| {
            let (centre, radius) = self.sphere_around(*b);
            (centre.x - middle.x).hypot(centre.y - middle.y) + radius
        };
        let radius = wheels.iter().map(reach).fold(0.0, f64::max);
        let handle = self.parts[index(body)].handle;
        let principal = self.world.bodies[handle].mass_properties().local_mprops.reconstruct_inertia_matrix();
        let rolling = RollingBase {
            body,
            mass: self.mass_of_all(body, world),
            inertia: f64::from(principal.col(2).z),
            radius,
            wheels,
        };
        self.set_friction(&rolling.wheels, 0.0, CoefficientCombineRule::Min);
        rolling
    }

    /// Sums up what the bodies of descriptions weigh, which the engine does only as it begins its first step. Of others it knows.
    fn weigh_described(&mut self, world: &World) {
        for (part, _) in self.parts.iter().zip(&world.bodies).filter(|(_, body)| body.solid.is_some()) {
            let body = &mut self.world.bodies[part.handle];
            body.recompute_mass_properties_from_colliders(&self.world.colliders);
        }
    }

    /// The base rolls.
    pub fn on_wheels_again(&mut self, base: &RollingBase) {
        self.set_friction(&base.wheels, 0.0, CoefficientCombineRule::Min);
    }

    /// The base stands with its wheels braked, or lies on its side: its wheels rub like everything else.
    pub fn off_wheels(&mut self, base: &RollingBase) {
        self.set_friction(&base.wheels, FRICTION, CoefficientCombineRule::Average);
    }

    fn set_friction(&mut self, bodies: &[BodyId], friction: f64, rule: CoefficientCombineRule) {
        for body in bodies {
            let collider = &mut self.world.colliders[self.parts[index(*body)].collider];
            collider.set_friction(friction as f32);
            collider.set_friction_combine_rule(rule);
        }
    }

    /// Of a body with all that hangs together with it, kg.
    fn mass_of_all(&self, body: BodyId, world: &World) -> f64 {
        let mut all = vec![self.root(body)];
        let mut next = 0;
        while let Some(at) = all.get(next).copied() {
            next += 1;
            for joint in &world.joints {
                let (a, b) = (self.root(joint.parent), self.root(joint.child));
                for (one, other) in [(a, b), (b, a)] {
                    if one == at && !all.contains(&other) {
                        all.push(other);
                    }
                }
            }
        }
        let masses = all.iter().map(|b| f64::from(self.world.bodies[self.parts[index(*b)].handle].mass()));
        masses.sum()
    }

    /// The velocity of a base at its centre, m/s, and about the vertical, rad/s.
    pub fn rolling_velocity(&self, base: &RollingBase) -> (SpaceVector, f64) {
        let body = &self.world.bodies[self.parts[index(base.body)].handle];
        let centre = to_vector(self.pose(base.body).at);
        (from_vector(body.velocity_at_point(centre)), f64::from(body.angvel().z))
    }

    /// How the tyres must push to bring the base to a level velocity, m/s, and a turn, rad/s, in the time `h`, s, as far as they grip.
    pub fn roll(&mut self, base: &RollingBase, velocity: SpaceVector, turn: f64, h: f64) -> TyrePush {
        let (now, turning) = self.rolling_velocity(base);
        let change = SpaceVector::new(velocity.x - now.x, velocity.y - now.y, 0.0);
        let more = turn - turning;
        // What an arm's motors turn its base by in this step, the tyres bear: an arm is as heavy as its base, and motors that know of
        // no base that gives way would set both swinging.
        let handle = self.parts[index(base.body)].handle;
        let twist = f64::from(self.world.bodies[handle].user_torque().z) * h;
        if change.norm() < STANDS && more.abs() < STANDS && twist.abs() < STANDS * base.inertia {
            return TyrePush::default();
        }
        let load: f64 = base.wheels.iter().map(|wheel| self.load_from_below(*wheel)).sum();
        let grip = FRICTION * load * h;
        let impulse = change * base.mass;
        let spin = base.inertia * more - twist;
        // Wheels that must both push and turn share their grip.
        let asked = impulse.norm() + spin.abs() / base.radius.max(1e-3);
        let part = if asked > grip { grip / asked } else { 1.0 };
        let work = (impulse.norm() * velocity.norm().max(now.norm())
            + spin.abs() * turn.abs().max(turning.abs()))
            * part;
        self.energy.add_wheels(work);
        TyrePush { force: impulse * (part / h), torque: spin * part / h }
    }

    /// Lets the tyres push for a step, on the ground below the middle of the base.
    pub fn push_by_tyres(&mut self, base: &RollingBase, push: TyrePush) {
        if push == TyrePush::default() {
            return;
        }
        let mut at = self.pose(base.body).at;
        at.z = base.wheels.iter().map(|wheel| self.lowest(*wheel)).fold(f64::INFINITY, f64::min);
        let h = self.step;
        let body = &mut self.world.bodies[self.parts[index(base.body)].handle];
        body.apply_impulse_at_point(to_vector(push.force * h), to_vector(at), true);
        body.apply_torque_impulse(to_vector(SpaceVector::z() * (push.torque * h)), true);
    }
}
