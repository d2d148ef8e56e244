//! What joints have besides motors: damping, friction, and gears to other joints.

use hrdsl_ir::world::{JointMimic, World};

use super::PhysicsAdapter;

/// How fast a follower makes good what it is behind, as a part of it in each step.
const CATCH_UP: f64 = 0.5;

/// The joints of which the engine must be told anew at each step; none in most worlds.
#[derive(Default)]
pub(super) struct JointLosses {
    gears: Vec<JointGear>,
    brakes: Vec<JointBrake>,
}

struct JointGear {
    follower: usize,
    leader: usize,
    factor: f64,
    offset: f64,
    /// The most that it bears, N·m or N.
    force: f64,
}

struct JointBrake {
    joint: usize,
    damping: f64,
    friction: f64,
}

/// A gear without a limit bears this, N·m or N.
const STRONGEST: f64 = 1e4;

impl JointLosses {
    pub fn of(world: &World) -> JointLosses {
        let mut losses = JointLosses::default();
        for (at, joint) in world.joints.iter().enumerate().filter(|(_, joint)| !joint.is_rigid()) {
            if let Some(JointMimic { joint: leader, factor, offset }) = joint.drive.mimic {
                let force = joint.drive.effort.filter(|effort| *effort > 0.0).unwrap_or(STRONGEST);
                let leader = usize::from(leader.0);
                losses.gears.push(JointGear { follower: at, leader, factor, offset, force });
            } else if joint.drive.damping > 0.0 || joint.drive.friction > 0.0 {
                let (damping, friction) = (joint.drive.damping, joint.drive.friction);
                losses.brakes.push(JointBrake { joint: at, damping, friction });
            }
        }
        losses
    }
}

impl PhysicsAdapter {
    /// Tells the engine what followers are to do in the next step, and how hard joints are braked in it.
    pub(super) fn keep_gears(&mut self) {
        let dt = f64::from(self.world.integration_parameters.dt);
        let losses = std::mem::take(&mut self.losses);
        for gear in &losses.gears {
            let (at, speed) = (self.joint_position(gear.leader), self.joint_speed(gear.leader));
            let behind = gear.factor * at + gear.offset - self.joint_position(gear.follower);
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

    /// How far a joint is from where those are that follow it, at most, as they count it, rad or m.
    pub fn gear_lag(&self, leader: usize) -> f64 {
        let lag = |gear: &JointGear| {
            let wanted = gear.factor * self.joint_position(gear.leader) + gear.offset;
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
