//! The picture of the world that a run leaves for those who look: keyframes of what moves, and of what presses.
//!
//! It looks at the world after its steps and asks for nothing that would change it, so that a run is the same with a picture and without.

use std::collections::BTreeMap;

use hrdsl_ir::{
    Nanos,
    world::{BodyId, JointId, Vec3},
};
use hrdsl_trace::picture::{
    BodyKeyframe, BodyKeyframes, ContactKeyframe, ContactKeyframes, FINE, FORCE, JointKeyframe,
    JointKeyframes, WorldPicture, whole,
};

use crate::{
    keyframes::KeyframeTrack,
    world::{BodyPose, WorldBackend},
};

/// How often poses are looked at.
const PERIOD: Nanos = 40_000_000;
/// How far a body may be drawn from where it was: a millimetre, and about a quarter of a degree.
const PLACE: f64 = 0.001;
const TURN: f64 = 0.002;
/// The same of a joint, rad or m.
const JOINT: f64 = 0.003;
/// What presses with less is not shown, N.
const LEAST_FORCE: f64 = 1.0;
/// A force is told again when it has changed by this part of it.
const CHANGE: f64 = 0.3;

/// Takes the picture of one run.
#[derive(Debug, Default)]
pub(crate) struct PictureRecorder {
    next: Nanos,
    bodies: BTreeMap<BodyId, KeyframeTrack<7>>,
    joints: BTreeMap<JointId, KeyframeTrack<1>>,
    contacts: BTreeMap<[BodyId; 2], ContactTake>,
}

/// What is known of two bodies that press, or have pressed, on each other.
#[derive(Debug, Default)]
struct ContactTake {
    frames: Vec<ContactKeyframe>,
    /// The force that was told last; none after its end.
    told: Option<Vec3>,
    /// When it was last seen.
    seen: Nanos,
}

impl PictureRecorder {
    /// Time has come to this, and the world has changed.
    pub fn look(&mut self, now: Nanos, world: &dyn WorldBackend) {
        // A blow is over before poses are looked at again.
        self.look_at_contacts(now, world);
        if now < self.next {
            return;
        }
        self.next = now - now % PERIOD + PERIOD;
        let bodies = &mut self.bodies;
        world.poses(&mut |pose| {
            let track = bodies.entry(pose.body).or_insert_with(pose_track);
            let values = continued(&pose, track.last());
            track.add(now, values, PERIOD);
        });
        let joints = &mut self.joints;
        world.joints(&mut |joint, position| {
            let track = joints.entry(joint).or_insert_with(|| KeyframeTrack::new([JOINT]));
            track.add(now, [position], PERIOD);
        });
    }

    fn look_at_contacts(&mut self, now: Nanos, world: &dyn WorldBackend) {
        let contacts = &mut self.contacts;
        world.contacts(LEAST_FORCE, &mut |bodies, force| {
            let take = contacts.entry(bodies).or_default();
            take.seen = now;
            if take.told.is_none_or(|told| has_changed(told, force))
                && let Some(point) = world.contact_point(bodies)
            {
                take.told = Some(force);
                // The force on the first is the opposite.
                let force = force.map(|x| whole(-x, FORCE));
                take.frames.push(ContactKeyframe { time: now, point: point.map(|x| whole(x, FINE)), force });
            }
        });
        for take in contacts.values_mut().filter(|take| take.seen < now) {
            if take.told.take().is_some()
                && let Some(last) = take.frames.last().copied()
            {
                take.frames.push(ContactKeyframe { time: now, force: [0; 3], ..last });
            }
        }
    }

    /// All that was seen.
    pub fn finish(self) -> WorldPicture {
        let body = |(body, track): (BodyId, KeyframeTrack<7>)| {
            let frames = track.finish().into_iter().map(|(time, [x, y, z, turn @ ..])| BodyKeyframe {
                time,
                place: [x, y, z].map(|x| whole(x, FINE)),
                turn: turn.map(|x| whole(x, FINE)),
            });
            BodyKeyframes { body, frames: frames.collect() }
        };
        let joint = |(joint, track): (JointId, KeyframeTrack<1>)| {
            let frames = track.finish().into_iter();
            let frames = frames.map(|(time, [at])| JointKeyframe { time, position: whole(at, FINE) });
            JointKeyframes { joint, frames: frames.collect() }
        };
        let contact =
            |(bodies, take): ([BodyId; 2], ContactTake)| ContactKeyframes { bodies, frames: take.frames };
        WorldPicture {
            bodies: self.bodies.into_iter().map(body).filter(|b| !b.frames.is_empty()).collect(),
            joints: self.joints.into_iter().map(joint).filter(|j| !j.frames.is_empty()).collect(),
            contacts: self.contacts.into_iter().map(contact).filter(|c| !c.frames.is_empty()).collect(),
        }
    }
}

fn pose_track() -> KeyframeTrack<7> {
    KeyframeTrack::new([PLACE, PLACE, PLACE, TURN, TURN, TURN, TURN])
}

/// A pose as numbers, with the sign of its quaternion by which it is on the near side of the one before.
fn continued(pose: &BodyPose, before: Option<&[f64; 7]>) -> [f64; 7] {
    let ([x, y, z], [i, j, k, w]) = (pose.place, pose.turn);
    let is_far = before.is_some_and(|[_, _, _, bi, bj, bk, bw]| i * bi + j * bj + k * bk + w * bw < 0.0);
    if is_far { [x, y, z, -i, -j, -k, -w] } else { [x, y, z, i, j, k, w] }
}

fn has_changed(told: Vec3, force: Vec3) -> bool {
    let square = |v: Vec3| v.iter().map(|x| x * x).sum::<f64>();
    let [x, y, z] = told;
    let [i, j, k] = force;
    let by = square([i - x, j - y, k - z]);
    by > LEAST_FORCE * LEAST_FORCE && by > CHANGE * CHANGE * square(told)
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::{
        Nanos, Value,
        world::{BodyId, JointId, SignalId, Vec3, WorldAction},
    };

    use super::PictureRecorder;
    use crate::{
        command::CheckedCommand,
        world::{BodyPose, CommandId, WorldBackend},
    };

    /// A body that goes along x with 1 m/s until 1 s, with a joint that turns with it, and is pushed from 0.5 s to 0.6 s.
    struct Sliding(Nanos);

    impl WorldBackend for Sliding {
        fn next_wake(&self) -> Option<Nanos> {
            None
        }

        fn advance(&mut self, to: Nanos) {
            self.0 = to;
        }

        fn read(&mut self, _: SignalId) -> Value {
            Value::Bool(false)
        }

        fn act(&mut self, _: &WorldAction, _: &[Value]) -> Result<(), String> {
            Ok(())
        }

        fn command(&mut self, _: &CheckedCommand<'_>) -> Result<CommandId, String> {
            Err("nothing is commanded here".to_owned())
        }

        fn take_ended(&mut self) -> Vec<(CommandId, Result<(), String>)> {
            Vec::new()
        }

        fn poses(&self, tell: &mut dyn FnMut(BodyPose)) {
            let x = (self.0 as f64 / 1e9).min(1.0);
            tell(BodyPose { body: BodyId(3), place: [x, 0.0, 0.5], turn: [0.0, 0.0, 0.0, 1.0] });
        }

        fn joints(&self, tell: &mut dyn FnMut(JointId, f64)) {
            tell(JointId(1), (self.0 as f64 / 1e9).min(1.0) / 2.0);
            tell(JointId(2), 0.25);
        }

        fn contacts(&self, least: f64, tell: &mut dyn FnMut([BodyId; 2], Vec3)) {
            if (500_000_000..600_000_000).contains(&self.0) && least <= 5.0 {
                tell([BodyId(0), BodyId(3)], [-5.0, 0.0, 0.0]);
            }
        }

        fn contact_point(&self, _: [BodyId; 2]) -> Option<Vec3> {
            Some([0.75, 0.0, 0.5])
        }
    }

    #[test]
    fn a_picture_has_what_moved_and_what_pressed() {
        let (mut world, mut recorder) = (Sliding(0), PictureRecorder::default());
        for step in 0..=400 {
            world.advance(step * 5_000_000);
            recorder.look(world.0, &world);
        }
        let picture = recorder.finish();
        let [body] = &picture.bodies[..] else { panic!("{picture:?}") };
        assert_eq!(body.body, BodyId(3));
        let frames: Vec<(Nanos, i64)> = body.frames.iter().map(|f| (f.time, f.place[0])).collect();
        assert_eq!(frames, [(0, 0), (1_000_000_000, 10_000), (2_000_000_000, 10_000)]);
        let joints: Vec<(JointId, usize)> =
            picture.joints.iter().map(|j| (j.joint, j.frames.len())).collect();
        assert_eq!(joints, [(JointId(1), 3)], "one that rests is left out");
        let [contact] = &picture.contacts[..] else { panic!("{picture:?}") };
        let frames: Vec<(Nanos, [i64; 3])> = contact.frames.iter().map(|f| (f.time, f.force)).collect();
        assert_eq!(frames, [(500_000_000, [500, 0, 0]), (600_000_000, [0, 0, 0])]);
        assert_eq!(contact.frames[0].point, [7_500, 0, 5_000]);
    }
}
