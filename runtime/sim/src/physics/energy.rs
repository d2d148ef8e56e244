//! The watch over energy: nothing gains any without cause.
//!
//! After each step the energy of motion, and that of height, of everything that forces move is compared with what it was before. What
//! motors, wheels, muscles and moved bodies can have done is allowed for, generously: what is found is a solver that has gone wrong, not a
//! joule too many. Such a run says nothing any more, and ends as an error.

use super::state::{adapter::PhysicsAdapter, bodies::index};
use crate::math::from_vector;

/// What may come from nowhere in a step: so many J, and this part of the energy of motion.
const SLACK: f64 = 2.0;
const SLACK_PART: f64 = 0.5;
/// How far bodies may be lifted in a step, m: those that have sunk into each other are put apart.
const LIFTED: f64 = 0.02;
/// What has been moved still pushes in the steps after: it may have come to be inside of something.
const OF_LATE: f64 = 0.95;
/// How many times as fast as what strikes it the end of something struck may be, squared, and halved.
const LEVERS: f64 = 20.0;
/// Faster than this nothing is, m/s.
const FASTEST: f64 = 100.0;

impl PhysicsAdapter {
    /// Looks at everything after a step.
    pub(super) fn watch_energy(&mut self) {
        if self.energy.fault.is_some() {
            return;
        }
        let gravity = from_vector(self.world.gravity);
        let mut known = Vec::with_capacity(self.parts.len());
        let (mut fastest, mut loose) = (self.energy.fastest_moved * OF_LATE, 0.0);
        for (i, part) in self.parts.iter().enumerate() {
            let body = &self.world.bodies[part.handle];
            let speed = f64::from(body.linvel().length());
            if !(speed.is_finite() && body.translation().is_finite()) || speed > FASTEST {
                let found =
                    if speed > FASTEST { format!("goes at {speed:.0} m/s") } else { "is nowhere".to_owned() };
                self.energy.fault = Some(format!("the physics failed: `{}` {found}", part.name));
                return;
            }
            let is_loose = body.is_dynamic() && self.guides[i].is_none() && index(part.root) == i;
            if !is_loose {
                let is_moved = !body.is_dynamic() || self.guides[i].is_some();
                fastest = fastest.max(if is_moved { speed } else { 0.0 });
                known.push(None);
                continue;
            }
            let mass = f64::from(body.mass());
            loose += mass;
            let height = -mass * gravity.dot(&from_vector(body.center_of_mass()));
            known.push(Some((f64::from(body.kinetic_energy()), height)));
        }
        let before = std::mem::replace(&mut self.energy.known, known);
        // What is struck by something that is moved leaves at twice its speed, and at more at the end of a lever.
        let struck = LEVERS * loose * fastest * fastest;
        self.energy.fastest_moved = fastest;
        let gains: Vec<(usize, f64)> = (0..)
            .zip(before.iter().zip(&self.energy.known))
            .filter_map(|(i, (old, new))| Some((i, old.as_ref()?, new.as_ref()?)))
            .map(|(i, old, new)| (i, new.0 + new.1 - old.0 - old.1))
            .collect();
        let motion: f64 = before.iter().flatten().map(|(motion, _)| motion).sum();
        let allowed = SLACK
            + SLACK_PART * motion
            + loose * gravity.norm() * LIFTED
            + struck
            + self.motor_work()
            + std::mem::take(&mut self.energy.wheels);
        let gained: f64 = gains.iter().map(|(_, gain)| gain).sum();
        if gained > allowed
            && let Some((most, _)) = gains.iter().max_by(|a, b| a.1.total_cmp(&b.1))
        {
            let name = &self.parts[*most].name;
            self.energy.fault =
                Some(format!("the physics failed: `{name}` gains {gained:.0} J in a step without cause"));
        }
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
