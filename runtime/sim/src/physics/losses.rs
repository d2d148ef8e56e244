//! What joints have besides motors: damping, friction, and gears to other joints.

use super::state::{adapter::PhysicsAdapter, losses::JointGear};

/// How fast a follower makes good what it is behind, as a part of it in each step.
const CATCH_UP: f64 = 0.5;

impl PhysicsAdapter {
    /// Tells the engine what followers are to do in the next step, and how hard joints are braked in it.
    pub(super) fn keep_gears(&mut self) {
        let dt = f64::from(self.world.integration_parameters.dt);
        let losses = std::mem::take(&mut self.losses);
        for gear in &losses.gears {
            let (at, speed) = (self.joint_position(gear.leader), self.joint_speed(gear.leader));
            let behind = self.wanted_by_gear(gear, at) - self.joint_position(gear.follower);
            self.run_at(gear.follower, gear.factor * speed + behind * CATCH_UP / dt, gear.force);
        }
        for brake in &losses.brakes {
            // What a motor of the engine runs is braked by that.
            let is_run = self.joints.get(brake.joint).and_then(Option::as_ref).is_some_and(|d| d.is_run);
            if !is_run {
                let speed = self.joint_speed(brake.joint).abs();
                self.brake(brake.joint, brake.friction + brake.damping * speed);
            }
        }
        self.losses = losses;
    }

    /// Where a follower is to be when its leader is there, as far as it may, rad or m.
    fn wanted_by_gear(&self, gear: &JointGear, leader: f64) -> f64 {
        let (lo, hi) = self.kept_limits(gear.follower);
        (gear.factor * leader + gear.offset).clamp(lo, hi)
    }

    /// A speed at which a joint comes to rest at its ends, and is not driven against them.
    pub fn slower_near_ends(&self, joint: usize, speed: f64) -> f64 {
        let Some(driven) = &self.joints[joint] else { return speed };
        let (at, rate, (lo, hi)) = (self.joint_position(joint), CATCH_UP / self.step, driven.kept_limits());
        speed.clamp(rate * (lo - at).min(0.0), rate * (hi - at).max(0.0))
    }

    /// How far a joint is from where those are that follow it, at most, as they count it, rad or m.
    pub fn gear_lag(&self, leader: usize) -> f64 {
        let lag = |gear: &JointGear| {
            let wanted = self.wanted_by_gear(gear, self.joint_position(gear.leader));
            (wanted - self.joint_position(gear.follower)).abs()
        };
        self.losses.gears.iter().filter(|gear| gear.leader == leader).map(lag).fold(0.0, f64::max)
    }

    /// With how much a follower is moved at most, N·m or N.
    pub fn limit_gear(&mut self, follower: usize, force: f64) {
        for gear in self.losses.gears.iter_mut().filter(|gear| gear.follower == follower) {
            gear.force = force;
        }
    }
}
