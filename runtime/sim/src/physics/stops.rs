//! Where joints end, and where the engine is told that they do.
//!
//! The engine stops a joint once it is beyond its end, and looks once in each of its own steps: a wrist that whirls about, or is struck
//! at its end, would be beyond it by as much as it goes in one of them. So it is told of an end that lies before the true one by just
//! that, as long as the joint comes to it; what goes very fast, besides, asks for shorter steps. What a motor presses against its end, or
//! what a blow throws there, goes a little beyond it all the same, by fractions of a milliradian: so no joint is kept at its true end
//! either, but at one just so far before it, and none is ever where the scenario says that it cannot be.

use hrdsl_ir::world::{Joint, JointMotion};
use rapier3d::prelude::*;

use super::state::{
    adapter::PhysicsAdapter,
    joint::{DrivenJoint, JointStop},
};

/// What a joint may go beyond its end unnoticed, rad or m: one that goes farther is pressed, and the solver then does more.
pub(super) const UNNOTICED: f64 = 3e-4;
/// For so long after that, s: what pressed it has hardly gone.
const PRESSED_FOR: f64 = 0.5;
/// So far before its true end a joint is kept, rad or m, or by this part of its way, if that is less.
const MARGIN: f64 = 5e-4;
const MARGIN_PART: f64 = 0.02;
/// How fast a joint that starts at its true end is brought to where it is kept, rad/s or m/s.
const DRAWN_IN: f64 = 0.02;
/// So exactly the engine knows where a joint is, rad or m: it must not miss that one is where it ends.
pub(super) const ROUNDING: f64 = 1e-5;
/// How far before its end a joint is stopped at most because it is fast, rad and m.
const EARLY_TURN: f64 = 5e-3;
const EARLY_WAY: f64 = 1e-3;
/// A blow may turn, within a part of a step, what is at the end of an arm so long, by the way that surfaces go in it, m.
const SHORT_ARM: f64 = 0.1;
/// How much faster a joint may have become before the engine looks again.
const FASTER: f64 = 1.2;

/// How a joint comes to one of its ends: rad or m.
struct StopApproach {
    /// How far it goes before the engine looks again, and in the whole time in which it is told nothing else.
    next: f64,
    whole: f64,
    /// How far a blow may throw it before the engine looks again.
    thrown: f64,
}

impl StopApproach {
    /// How far before the end at `left` from the joint it is to be stopped; 0: at the end.
    fn early(&self, left: f64) -> f64 {
        let coming = if self.next > UNNOTICED && left < self.whole + self.next { self.next } else { 0.0 };
        // No farther back than where it is: it would be thrown back.
        (coming + self.thrown).min(left.max(0.0) + ROUNDING)
    }
}

/// Where a joint is kept that is to be within `lo` and `hi`.
fn within(lo: f64, hi: f64) -> (f64, f64) {
    let margin = MARGIN.min(MARGIN_PART * (hi - lo));
    (lo + margin, hi - margin)
}

/// Between which ends a joint is kept at first, from its start: one that starts at its true end is not thrown back from it.
pub(super) fn first_kept(joint: &Joint) -> (f64, f64) {
    let ((lo, hi), start) = (within(joint.lo, joint.hi), joint.drive.start);
    ((lo - start).min(0.0), (hi - start).max(0.0))
}

impl DrivenJoint {
    /// Between which angles or ways it is kept, rad or m.
    pub(super) fn kept_limits(&self) -> (f64, f64) {
        within(self.lo, self.hi)
    }

    /// The ends at which it is kept, from its start.
    pub(super) fn kept_ends(&self) -> (f64, f64) {
        self.ends.kept
    }

    /// A joint that started at its true end is brought nearer to where it is to be kept, for so long, s.
    fn draw_in(&mut self, time: f64) {
        let ((lo, hi), way) = (self.kept_limits(), DRAWN_IN * time);
        let kept = &mut self.ends.kept;
        *kept = ((kept.0 + way).min(lo - self.start), (kept.1 - way).max(hi - self.start));
    }

    /// What a joint goes through as a surface is moved so far, rad or m. At the very end a motor that pushes on does not get it farther:
    /// no earlier, since a motor that is to bring it to its end would push ever harder.
    fn thrown(&self, way: f64) -> f64 {
        let thrown = match self.motion {
            JointMotion::Hinge => way / SHORT_ARM,
            JointMotion::Slider => way,
        };
        thrown.max(ROUNDING)
    }

    fn early_at_most(&self) -> f64 {
        match self.motion {
            JointMotion::Hinge => EARLY_TURN,
            JointMotion::Slider => EARLY_WAY,
        }
    }

    /// Tells the engine's joint where it ends.
    pub(super) fn tell(&self, joint: &mut GenericJoint, ends: (f64, f64)) {
        match self.motion {
            JointMotion::Hinge if self.wound.is_some() => self.stop.limit(joint, ends),
            JointMotion::Hinge => {
                joint.set_limits(JointAxis::AngX, [ends.0 as f32, ends.1 as f32]);
            }
            JointMotion::Slider => {
                joint.set_limits(JointAxis::LinX, [ends.0 as f32, ends.1 as f32]);
            }
        }
    }
}

impl PhysicsAdapter {
    /// Where a joint ends, rad or m.
    pub fn joint_limits(&self, joint: usize) -> (f64, f64) {
        self.joints[joint].as_ref().map_or((0.0, 0.0), |driven| (driven.lo, driven.hi))
    }

    /// Between which angles or ways the engine keeps a joint, rad or m.
    pub fn kept_limits(&self, joint: usize) -> (f64, f64) {
        self.joints[joint].as_ref().map_or((0.0, 0.0), DrivenJoint::kept_limits)
    }

    /// A joint is pressed against its end.
    pub(super) fn notice_press(&mut self) {
        self.pressed = (PRESSED_FOR / self.step).ceil() as usize;
    }

    /// How many parts of the step the joints ask for that come to their ends in it.
    pub(super) fn parts_for_stops(&self, dt: f64) -> f64 {
        let asked = |(at, driven): (usize, &Option<DrivenJoint>)| {
            let driven = driven.as_ref()?;
            let way = self.joint_speed(at) * dt;
            let parts = (way.abs() / driven.early_at_most()).ceil();
            if parts <= 1.0 || parts <= self.substeps() as f64 || self.is_asleep(at) {
                return None;
            }
            let (now, (lo, hi)) = (self.way(driven), driven.kept_ends());
            let left = if way > 0.0 { hi - now } else { now - lo };
            (left < FASTER * way.abs()).then_some(parts)
        };
        self.joints.iter().enumerate().filter_map(asked).fold(1.0, f64::max)
    }

    /// Tells the engine where the joints end in the next part of a step, in which a blow or a push may move surfaces so far, m.
    pub(super) fn tell_stops(&mut self, moved: f64) {
        let (time, times) = self.part;
        for at in 0..self.joints.len() {
            if self.is_asleep(at) {
                continue;
            }
            let Some(driven) = &mut self.joints[at] else { continue };
            driven.draw_in(time / times as f64);
            let Some(driven) = &self.joints[at] else { continue };
            let (speed, thrown, ends) = (self.joint_speed(at), driven.thrown(moved), driven.kept_ends());
            // A motor that pushes goes on pushing.
            let gain = (speed - driven.ends.last.0) / driven.ends.last.1 * time;
            let comes = |speed: f64, gain: f64| {
                let whole = FASTER * (speed + gain.max(0.0)).max(0.0) * time;
                StopApproach { next: whole / times as f64, whole, thrown }
            };
            let (down, up) = (comes(-speed, -gain), comes(speed, gain));
            let is_far = down.next.max(up.next) < UNNOTICED && moved <= 0.0 && !driven.ends.is_near();
            let told = if is_far {
                ends
            } else {
                let now = self.way(driven);
                (ends.0 + down.early(now - ends.0), ends.1 - up.early(ends.1 - now))
            };
            let is_news = told != driven.ends.between;
            if is_news && let Some(joint) = self.world.impulse_joints.get_mut(driven.handle, false) {
                driven.tell(&mut joint.data, told);
            }
            if let Some(driven) = &mut self.joints[at] {
                (driven.ends.between, driven.ends.last) = (told, (speed, time));
            }
        }
    }

    /// Follows the joints that may turn farther than half round, and puts the stops where they are.
    pub(super) fn wind_joints(&mut self) {
        for at in 0..self.joints.len() {
            let Some(driven) = self.joints[at].as_ref().filter(|driven| driven.wound.is_some()) else {
                continue;
            };
            let (way, ends) = (self.way(driven), driven.kept_ends());
            let stop = JointStop::about(way, ends.0, ends.1);
            let moves = stop != driven.stop;
            if moves && let Some(joint) = self.world.impulse_joints.get_mut(driven.handle, false) {
                stop.set(&mut joint.data, &driven.first_frame, ends);
            }
            if let Some(driven) = &mut self.joints[at] {
                (driven.wound, driven.stop) = (Some(way), stop);
                if moves {
                    driven.ends.between = ends;
                }
            }
        }
    }
}
