//! The watch over energy: nothing gains any without cause.
//!
//! After each step the energy of motion, and that of height, of everything that forces move is compared with what it was before. What
//! motors, wheels, muscles and moved bodies can have done is allowed for, generously: what is found is a solver that has gone wrong, not a
//! joule too many. Such a run says nothing any more, and ends as an error.

use super::state::{
    adapter::PhysicsAdapter,
    bodies::index,
    energy::{BodyEnergy, EnergyAfterStep},
};
use crate::math::from_vector;

/// What may come from nowhere in a step: so many J, and this part of the energy of motion.
const SLACK: f64 = 0.5;
const SLACK_PART: f64 = 0.2;
/// How far bodies may be lifted in a step, m: those that have sunk into each other are put apart.
const LIFTED: f64 = 0.01;
/// What has been moved still pushes in the steps after: it may have come to be inside of something.
const OF_LATE: f64 = 0.95;
/// How many times as fast as what strikes or pulls it the end of something struck may be, squared, and halved.
const LEVERS: f64 = 20.0;
/// Faster than this nothing is, m/s.
const FASTEST: f64 = 100.0;

impl PhysicsAdapter {
    /// Looks at everything after a step.
    pub(super) fn watch_energy(&mut self) {
        if self.energy.fault.is_some() {
            return;
        }
        let Some(EnergyAfterStep { loose, fastest }) = self.look_at_energies() else { return };
        let gravity = from_vector(self.world.gravity);
        // What is struck by something that is moved leaves at twice its speed, and at more at the end of a lever.
        let struck = LEVERS * loose * fastest * fastest;
        self.energy.fastest_moved = fastest;
        let (before, now) = (&self.energy.before, &self.energy.known);
        let gains = || {
            (0..)
                .zip(before.iter().zip(now))
                .filter_map(|(i, (old, new))| Some((i, old.as_ref()?, new.as_ref()?)))
                .map(|(i, old, new): (usize, _, _)| (i, new.motion + new.height - old.motion - old.height))
        };
        let motion: f64 = before.iter().flatten().map(|known| known.motion).sum();
        let allowed = SLACK
            + SLACK_PART * motion
            + loose * gravity.norm() * LIFTED
            + struck
            + self.motor_work()
            + self.energy.wheels;
        let gained: f64 = gains().map(|(_, gain)| gain).sum();
        let most = (gained > allowed).then(|| gains().max_by(|a, b| a.1.total_cmp(&b.1))).flatten();
        self.energy.wheels = 0.0;
        if let Some((most, _)) = most {
            let name = &self.parts[most].name;
            self.energy.fault =
                Some(format!("the physics failed: `{name}` gains {gained:.0} J in a step without cause"));
        }
    }

    /// Finds the energies after a step; `None`: something is too fast, or nowhere, and that is the fault.
    fn look_at_energies(&mut self) -> Option<EnergyAfterStep> {
        let gravity = from_vector(self.world.gravity);
        let mut known = std::mem::take(&mut self.energy.before);
        known.clear();
        let mut after = EnergyAfterStep { loose: 0.0, fastest: self.energy.fastest_moved * OF_LATE };
        for (i, part) in self.parts.iter().enumerate() {
            let body = &self.world.bodies[part.handle];
            let speed = f64::from(body.linvel().length());
            if !(speed.is_finite() && body.translation().is_finite()) || speed > FASTEST {
                let found =
                    if speed > FASTEST { format!("goes at {speed:.0} m/s") } else { "is nowhere".to_owned() };
                self.energy.fault = Some(format!("the physics failed: `{}` {found}", part.name));
                return None;
            }
            let is_loose = body.is_dynamic() && self.guides[i].is_none() && index(part.root) == i;
            if !is_loose {
                let is_moved = !body.is_dynamic() || self.guides[i].is_some();
                if is_moved && speed > after.fastest && self.meets_loose(i) {
                    after.fastest = speed;
                }
                known.push(None);
                continue;
            }
            let mass = f64::from(body.mass());
            after.loose += mass;
            // What sleeps is as it was.
            let (was, sleeps) = (self.energy.known.get(i).copied().flatten(), body.is_sleeping());
            known.push(was.filter(|was| was.sleeps && sleeps).or_else(|| {
                let height = -mass * gravity.dot(&from_vector(body.center_of_mass()));
                Some(BodyEnergy { motion: f64::from(body.kinetic_energy()), height, sleeps })
            }));
        }
        self.energy.before = std::mem::replace(&mut self.energy.known, known);
        Some(after)
    }

    /// Whether a body touches, or is joined to, what forces alone move. Of what is led or drawn only that can give energy.
    fn meets_loose(&self, part: usize) -> bool {
        let is_loose =
            |at: usize| self.world.bodies[self.parts[at].handle].is_dynamic() && self.guides[at].is_none();
        let rigid = self.loads.on(part).map(|(other, _)| other);
        let yielding = self.yielding.touching().filter_map(|(_, pair, _)| {
            if pair.soft == part { Some(pair.other) } else { (pair.other == part).then_some(pair.soft) }
        });
        self.world.impulse_joints.attached_joints(self.parts[part].handle).next().is_some()
            || rigid.chain(yielding).any(is_loose)
    }

    /// The most that motors can have done in a step, J.
    fn motor_work(&self) -> f64 {
        let dt = f64::from(self.world.integration_parameters.dt);
        (0..self.joints.len())
            .map(|joint| (self.joint_effort(joint) * self.joint_speed(joint)).abs() * dt)
            .sum()
    }

    /// What went wrong, if something did.
    pub fn fault(&self) -> Option<&str> {
        self.energy.fault.as_deref()
    }
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::world::{BodyMotion, BodyShape, World};

    use super::*;
    use crate::{
        math::{BodyFrame, RotationQuat, SpaceVector},
        physics::body_id,
        samples,
    };

    /// A ball of 1 kg that lies on a floor.
    fn lying_ball() -> (PhysicsAdapter, usize) {
        let ground =
            samples::body("floor", BodyMotion::Fixed, samples::cuboid(4.0, 4.0, 0.1), [0.0, 0.0, -0.05]);
        let ball =
            samples::body("ball", BodyMotion::Dynamic, BodyShape::Sphere { radius: 0.1 }, [0.0, 0.0, 0.1]);
        let world = World { bodies: vec![ground, ball], bases: Vec::new(), ..samples::flat(Vec::new()) };
        let mut physics = PhysicsAdapter::new(&world).expect("a world");
        (0..20).for_each(|_| physics.step());
        (physics, 1)
    }

    /// What a solver that has gone wrong would do: after it a body goes at a speed that nothing gave it.
    fn goes_wrong(physics: &mut PhysicsAdapter, body: usize, speed: f32) {
        let handle = physics.parts[body].handle;
        physics.world.bodies[handle].set_linvel(rapier3d::prelude::Vector::new(speed, 0.0, 0.0), true);
        physics.step();
    }

    #[test]
    fn energy_without_cause_is_found_and_names_its_body() {
        let (mut physics, ball) = lying_ball();
        assert_eq!(physics.fault(), None);
        goes_wrong(&mut physics, ball, 2.0);
        let fault = physics.fault().expect("a fault").to_owned();
        assert!(fault.contains("`ball` gains") && fault.contains("J in a step without cause"), "{fault}");
        // The first is kept.
        goes_wrong(&mut physics, ball, 300.0);
        assert_eq!(physics.fault(), Some(fault.as_str()));
    }

    #[test]
    fn what_is_too_fast_or_nowhere_is_found() {
        let (mut physics, ball) = lying_ball();
        goes_wrong(&mut physics, ball, 150.0);
        assert!(
            physics.fault().is_some_and(|fault| fault.contains("`ball` goes at")),
            "{:?}",
            physics.fault()
        );
    }

    /// A block that is led at 2 m/s past a ball, or through where it lies; and then the ball goes wrong.
    fn led_past(beside: f64) -> (PhysicsAdapter, usize) {
        let ground =
            samples::body("floor", BodyMotion::Fixed, samples::cuboid(8.0, 8.0, 0.1), [0.0, 0.0, -0.05]);
        let ball =
            samples::body("ball", BodyMotion::Dynamic, BodyShape::Sphere { radius: 0.1 }, [0.0, 0.0, 0.1]);
        let ram =
            samples::body("ram", BodyMotion::Kinematic, samples::cuboid(0.2, 0.2, 0.2), [-0.5, beside, 0.15]);
        let world = World { bodies: vec![ground, ball, ram], bases: Vec::new(), ..samples::flat(Vec::new()) };
        let mut physics = PhysicsAdapter::new(&world).expect("a world");
        for step in 1..=40 {
            let to = BodyFrame::new(
                SpaceVector::new(-0.5 + 0.02 * f64::from(step), beside, 0.15),
                RotationQuat::identity(),
            );
            physics.lead(body_id(2), &to);
            physics.step();
        }
        (physics, 1)
    }

    #[test]
    fn what_is_led_gives_energy_to_what_it_meets_only() {
        let (physics, ball) = led_past(0.0);
        assert!(physics.speed(body_id(ball)) > 1.0, "it is shoved");
        assert_eq!(physics.fault(), None);
        let (mut physics, ball) = led_past(1.0);
        assert_eq!((physics.speed(body_id(ball)) < 0.01, physics.fault()), (true, None));
        goes_wrong(&mut physics, ball, 2.0);
        assert!(physics.fault().is_some_and(|fault| fault.contains("`ball` gains")), "{:?}", physics.fault());
    }

    #[test]
    fn what_falls_and_bounces_gains_nothing() {
        let (mut physics, ball) = lying_ball();
        goes_wrong(&mut physics, ball, 0.3);
        (0..200).for_each(|_| physics.step());
        assert_eq!(physics.fault(), None, "0.05 J are within what a solver may add");
    }
}
