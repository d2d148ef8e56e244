//! Parts of steps that are done once more, since a joint went beyond its end in them.
//!
//! Nobody can foretell how far a blow that comes through seven joints throws the eighth. So where a joint may come to its end, all that
//! moves is noted before a part of a step; and if one was found beyond, everything is put back, the engine is told that this joint ends
//! earlier by as much, and does the part again, more thoroughly.

use hrdsl_ir::world::JointMotion;

use super::division::MANY_SWEEPS;
use super::state::{adapter::PhysicsAdapter, before::BodyBefore, joint::DrivenJoint};
use super::stops::{ROUNDING, UNNOTICED};

/// How far from its end a joint may be thrown to it within a part of a step, rad and m: at 20 rad/s or 2 m/s in the longest.
const WITHIN_REACH_TURN: f64 = 0.2;
const WITHIN_REACH_WAY: f64 = 0.02;
/// How often a part of a step is done again at most.
const RETRIES: usize = 3;
/// How much more often the solver divides it then.
const FINER: usize = 4;
/// By how much more than it went beyond it a joint is told to end earlier.
const EARLIER: f64 = 1.25;

/// A joint that went beyond an end: by number, and where it was and is from its start, rad or m.
struct JointBeyond {
    at: usize,
    was: f64,
    is: f64,
}

impl DrivenJoint {
    /// How far a joint that is so far from its start is beyond an end at which it is kept, rad or m; less than 0 within them.
    pub(super) fn beyond(&self, way: f64) -> f64 {
        let (lo, hi) = self.kept_ends();
        (lo - way).max(way - hi)
    }

    fn is_in_reach(&self) -> bool {
        let reach = match self.motion {
            JointMotion::Hinge => WITHIN_REACH_TURN,
            JointMotion::Slider => WITHIN_REACH_WAY,
        };
        self.ends.beyond > -reach
    }
}

impl PhysicsAdapter {
    /// A step of the engine, in which no joint goes beyond its end that could be kept from it.
    pub(super) fn step_within_ends(&mut self) {
        self.note_motion();
        self.step_engine();
        self.place_joints();
        for retry in 0..RETRIES {
            let gone = self.gone_beyond();
            if gone.is_empty() {
                break;
            }
            self.put_back();
            for joint in gone {
                self.end_earlier(&joint);
            }
            if retry == 0 {
                self.divide(self.part.0, FINER * self.part.1);
                self.notice_press();
            }
            let sweeps = &mut self.world.integration_parameters.num_internal_pgs_iterations;
            *sweeps = MANY_SWEEPS.max(*sweeps);
            self.step_engine();
            self.place_joints();
        }
    }

    fn note_motion(&mut self) {
        let mut before = std::mem::take(&mut self.before);
        before.bodies.clear();
        before.joints.clear();
        let near = |(at, driven): (usize, &Option<DrivenJoint>)| {
            let driven = driven.as_ref().filter(|driven| driven.is_in_reach() && !self.is_asleep(at))?;
            Some((at, self.way(driven)))
        };
        before.joints.extend(self.joints.iter().enumerate().filter_map(near));
        if !before.joints.is_empty() {
            let moving = self.world.bodies.iter().filter(|(_, body)| body.is_dynamic_or_kinematic());
            before.bodies.extend(moving.map(|(handle, body)| BodyBefore {
                handle,
                pose: *body.position(),
                next: *body.next_position(),
                velocity: *body.vels(),
                sleeps: body.is_sleeping(),
            }));
        }
        self.before = before;
    }

    /// The joints that are beyond an end, and farther than before.
    fn gone_beyond(&self) -> Vec<JointBeyond> {
        let gone = |(at, way): &(usize, f64)| {
            let driven = self.joints[*at].as_ref()?;
            let (was, is) = (driven.beyond(*way), self.way(driven));
            let found = JointBeyond { at: *at, was: *way, is };
            (driven.beyond(is) > was.max(0.0) + UNNOTICED).then_some(found)
        };
        self.before.joints.iter().filter_map(gone).collect()
    }

    fn put_back(&mut self) {
        for before in &self.before.bodies {
            let body = &self.world.bodies[before.handle];
            let is_same = *body.position() == before.pose && *body.vels() == before.velocity;
            if is_same && body.is_sleeping() == before.sleeps {
                continue;
            }
            let body = &mut self.world.bodies[before.handle];
            body.set_position(before.pose, false);
            body.set_vels(before.velocity, false);
            body.set_next_kinematic_position(before.next);
            if !before.sleeps {
                body.wake_up(false);
            }
        }
        self.place_joints();
    }

    /// Tells the engine that a joint ends earlier than it last did, by as much as it went beyond that end: no farther back than where it
    /// is, since it would be thrown back.
    fn end_earlier(&mut self, &JointBeyond { at, was, is }: &JointBeyond) {
        let Some(driven) = &self.joints[at] else { return };
        let (lo, hi) = driven.ends.between;
        let by = EARLIER * driven.beyond(is);
        let told = if is < driven.kept_ends().0 {
            ((lo + by).min((was - ROUNDING).max(lo)), hi)
        } else {
            (lo, (hi - by).max((was + ROUNDING).min(hi)))
        };
        if let Some(joint) = self.world.impulse_joints.get_mut(driven.handle, false) {
            driven.tell(&mut joint.data, told);
        }
        if let Some(driven) = &mut self.joints[at] {
            driven.ends.between = told;
        }
    }
}
