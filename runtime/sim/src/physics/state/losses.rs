//! Gears and brakes of a world's joints, as they were declared.

use hrdsl_ir::world::{JointMimic, World};

/// The joints of which the engine must be told anew at each step; none in most worlds.
#[derive(Default)]
pub struct JointLosses {
    pub gears: Vec<JointGear>,
    pub brakes: Vec<JointBrake>,
}

pub struct JointGear {
    pub follower: usize,
    pub leader: usize,
    pub factor: f64,
    pub offset: f64,
    /// The most that it bears, N·m or N.
    pub force: f64,
}

pub struct JointBrake {
    pub joint: usize,
    pub damping: f64,
    pub friction: f64,
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
