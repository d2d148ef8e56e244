//! When an arm stands still, and may be left out of the steps: also one that something keeps from its set-points.
//!
//! Its motors go on pressing, for ever if nobody tells them otherwise: the arms of a robot that lies on the floor do. Nothing changes by
//! that, so such an arm may rest like one that has got to where it was to be, and its motors hold what they held.

use hrdsl_ir::world::BodyId;

use super::ArmControl;
use crate::physics::{ArmSleep, PhysicsAdapter};

/// What moves less far in [`STANDS_AFTER`] stands, as a part of how far it may lag behind its aim.
const WITHIN: f64 = 0.05;
/// s
const STANDS_AFTER: f64 = 1.0;

/// Where the joints, and what their motors aim at, have been for some time.
#[derive(Default)]
pub(super) struct ArmStandstill {
    /// Of each joint: where it was when that time began, and its motor's aim, rad or m. Empty as long as nobody has looked.
    began: Vec<(f64, f64)>,
    /// How long ago that is, s.
    lasts: f64,
}

impl ArmStandstill {
    /// Looks where joints and aims are, which may be so far apart, some time after it last did, s.
    fn look(&mut self, positions: &[f64], aims: &[f64], lags: &[f64], after: f64) {
        let is_near = |(joint, was): (usize, &(f64, f64))| {
            let way = (was.0 - positions[joint]).abs().max((was.1 - aims[joint]).abs());
            way < WITHIN * lags[joint]
        };
        if self.began.len() == positions.len() && self.began.iter().enumerate().all(is_near) {
            self.lasts += after;
        } else {
            let began = positions.iter().copied().zip(aims.iter().copied()).collect();
            *self = ArmStandstill { began, lasts: 0.0 };
        }
    }

    /// Whether nothing has moved for so long that nothing will.
    pub(super) fn is_reached(&self) -> bool {
        self.lasts >= STANDS_AFTER
    }
}

impl ArmControl {
    /// Looks at joints and aims some time after it last did, s. An arm that is where it was to be rests without that.
    pub(super) fn look_whether_it_stands(&mut self, after: f64, physics: &PhysicsAdapter) {
        if self.aimed == self.rest {
            self.standstill = ArmStandstill::default();
        } else {
            self.standstill.look(&self.positions(physics), &self.rest, &self.lags, after);
        }
    }

    /// Whether it stands still, and is left out of the next step, with what it holds. It wakes when it has something to do, while its
    /// hand is used, since fingers would sleep with it on their way, and before anything touches it.
    pub fn sleeps(&self, held: &[BodyId], is_used: bool, physics: &mut PhysicsAdapter) -> bool {
        let own = self.joints.iter().map(|id| usize::from(id.0));
        let sleep = if self.aimed == self.rest { ArmSleep::Still } else { ArmSleep::Held };
        let is_left = !is_used && !self.is_busy() && !physics.is_approached(self.base(), held, sleep);
        let sleep = if is_left { sleep } else { ArmSleep::Never };
        own.clone().for_each(|joint| physics.let_sleep(joint, sleep));
        let sleeps = is_left && own.clone().all(|joint| physics.is_asleep(joint));
        if !sleeps {
            own.for_each(|joint| physics.wake(joint));
        }
        sleeps
    }

    /// It sleeps: as soon as it wakes its motors are told anew.
    pub fn rest(&mut self) {
        self.told_until = 0;
    }

    /// Whether its motors may still move it.
    pub fn is_busy(&self) -> bool {
        self.motion.is_some() || self.aimed != self.rest && !self.standstill.is_reached()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_trembles_stands_and_what_creeps_does_not() {
        let (mut trembles, mut creeps) = (ArmStandstill::default(), ArmStandstill::default());
        for step in 0..300 {
            let at = f64::from(step) * 1e-2;
            trembles.look(&[1.0 + 1e-3 * f64::from(step % 2)], &[1.04], &[0.04], 1e-2);
            creeps.look(&[1.0 + 3e-3 * at], &[1.04 + 3e-3 * at], &[0.04], 1e-2);
            assert!(!creeps.is_reached(), "after {at} s");
        }
        assert!(trembles.is_reached());
    }
}
