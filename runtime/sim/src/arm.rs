//! The arm's controller: plans a posture, generates the ramp that its motors follow, and tells when it has arrived.

use hrdsl_ir::Nanos;
use hrdsl_ir::value::{nanos, seconds};
use hrdsl_ir::world::{Arm, BodyId, JointId, Vec3, World};

use hrdsl_harness::CommandId;

use crate::{
    error::{CommandError, SimError},
    kinematics::{KinematicChain, KinematicLink},
    math::{SpaceVector, v3},
    physics::{PhysicsAdapter, bad, index},
    profile::{MotionProfile, brake_time, braking},
};

/// How near the tool must come to its place, m.
const ARRIVED: f64 = 0.005;
/// How near each joint must come to its angle where angles were asked for, rad.
const ARRIVED_JOINT: f64 = 0.01;
/// Below this an arm counts as standing, rad/s.
const SETTLED: f64 = 0.02;
/// How long after its ramp an arm may take to arrive.
const PATIENCE: Nanos = 1_000_000_000;

pub(crate) struct ArmControl {
    pub name: String,
    joints: Vec<JointId>,
    tip: BodyId,
    tool: SpaceVector,
    base: BodyId,
    max_speed: f64,
    chain: KinematicChain,
    /// The motors' aim while no motion is under way.
    rest: Vec<f64>,
    /// Where set-points want the joints; the motors' aim follows no faster than the arm may.
    aimed: Vec<f64>,
    motion: Option<ArmMotion>,
}

struct ArmMotion {
    id: CommandId,
    goal: ArmGoal,
    start: Nanos,
    /// Where the arm was and how fast it went when the motion was asked for.
    from: Vec<f64>,
    speed: Vec<f64>,
    /// From when on it goes to its goal: at once, or after it has come to a stop.
    go: Nanos,
    stop: Vec<f64>,
    to: Vec<f64>,
    path: ArmPath,
}

/// How an arm goes to its goal.
enum ArmPath {
    Ramp(MotionProfile),
    Track(JointTrack),
}

/// Postures, each at its time in seconds; between two of them each joint goes at an even speed.
pub(crate) struct JointTrack {
    points: Vec<(f64, Vec<f64>)>,
}

impl JointTrack {
    /// Angles and speeds at a time, for an arm that begins at `from`.
    fn at(&self, t: f64, from: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let next = self.points.partition_point(|(time, _)| *time <= t);
        let Some((end, to)) = self.points.get(next) else {
            let last = self.points.last().map_or(from, |(_, angles)| angles);
            return (last.to_vec(), vec![0.0; from.len()]);
        };
        let (begin, before) = match next.checked_sub(1).and_then(|at| self.points.get(at)) {
            Some((time, angles)) => (*time, angles.as_slice()),
            None => (0.0, from),
        };
        let part = (t - begin) / (end - begin);
        let angle = before.iter().zip(to).map(|(a, b)| a + part * (b - a));
        let speed = before.iter().zip(to).map(|(a, b)| (b - a) / (end - begin));
        (angle.collect(), speed.collect())
    }
}

enum ArmGoal {
    Place(SpaceVector),
    Joints,
}

impl ArmMotion {
    /// Angles and speeds aimed at.
    fn at(&self, time: Nanos) -> (Vec<f64>, Vec<f64>) {
        if time < self.go {
            let (travel, rate) = braking(seconds(time - self.start));
            let angle = self.from.iter().zip(&self.speed).map(|(q, v)| q + v * travel);
            return (angle.collect(), self.speed.iter().map(|v| v * rate).collect());
        }
        let t = seconds(time - self.go);
        let profile = match &self.path {
            ArmPath::Ramp(profile) => profile,
            ArmPath::Track(track) => return track.at(t, &self.from),
        };
        let (part, rate) = (profile.at(t), profile.speed(t));
        let angle = self.stop.iter().zip(&self.to).map(|(a, b)| a + part * (b - a));
        let speed = self.stop.iter().zip(&self.to).map(|(a, b)| rate * (b - a));
        (angle.collect(), speed.collect())
    }

    fn end(&self) -> Nanos {
        let length = match &self.path {
            ArmPath::Ramp(profile) => profile.length(),
            ArmPath::Track(track) => track.points.last().map_or(0.0, |(time, _)| *time),
        };
        self.go + nanos(length)
    }
}

impl ArmControl {
    pub fn new(arm: &Arm, world: &World, physics: &PhysicsAdapter) -> Result<ArmControl, SimError> {
        let what = || format!("arm `{}`", arm.name);
        if index(arm.tip) >= world.bodies.len() {
            return Err(bad(what(), "body", index(arm.tip)));
        }
        if !(arm.max_speed.is_finite() && arm.max_speed > 0.0) {
            return Err(SimError::BadNumber { what: format!("the speed of arm `{}`", arm.name) });
        }
        let mut links = Vec::new();
        let mut end: Option<BodyId> = None;
        for id in &arm.joints {
            let at = usize::from(id.0);
            let joint = world.joints.get(at).ok_or_else(|| bad(what(), "joint", at))?;
            if end.is_some_and(|e| physics.root(e) != physics.root(joint.parent)) {
                return Err(SimError::NotAChain { arm: arm.name.clone(), joint: joint.name.clone() });
            }
            end = Some(joint.child);
            let axis = v3(joint.axis).normalize();
            links.push(KinematicLink { anchor: v3(joint.anchor), axis, lo: joint.lo, hi: joint.hi });
        }
        if end.is_none_or(|e| physics.root(e) != physics.root(arm.tip)) {
            return Err(SimError::TipNotOnArm { arm: arm.name.clone() });
        }
        let tool = v3(arm.tool);
        let chain = KinematicChain { links, tool: physics.start(arm.tip).point(tool) };
        Ok(ArmControl {
            name: arm.name.clone(),
            joints: arm.joints.clone(),
            tip: arm.tip,
            tool,
            base: world.joints[usize::from(arm.joints[0].0)].parent,
            max_speed: arm.max_speed,
            rest: vec![0.0; chain.links.len()],
            aimed: vec![0.0; chain.links.len()],
            chain,
            motion: None,
        })
    }

    /// Plans a motion of the tool to a place.
    pub fn plan(&self, now: Nanos, target: Vec3) -> Result<Vec<f64>, CommandError> {
        let found = self.chain.plan(&self.stop(now), v3(target));
        if KinematicChain::arrives(&found) {
            Ok(found.joints)
        } else {
            Err(CommandError::Unreachable { distance: found.error })
        }
    }

    /// The place, as it would be if the arm's base were where it was at the start.
    pub fn relative(&self, physics: &PhysicsAdapter, target: Vec3) -> Vec3 {
        let now = physics.pose(self.base);
        let start = physics.start(self.base);
        if physics.motion(self.base) == hrdsl_ir::world::BodyMotion::Fixed {
            return target;
        }
        crate::math::arr(start.point(now.inverse().point(v3(target))))
    }

    pub fn check(&self, positions: &[f64], world: &World) -> Result<(), CommandError> {
        let expected = self.joints.len();
        if positions.len() != expected {
            return Err(CommandError::WrongJointCount { expected, given: positions.len() });
        }
        for ((link, id), q) in self.chain.links.iter().zip(&self.joints).zip(positions) {
            if !(link.lo..=link.hi).contains(q) {
                let joint = world.joints[usize::from(id.0)].name.clone();
                return Err(CommandError::OutOfLimits { joint });
            }
        }
        Ok(())
    }

    /// Begins a motion; what the arm was doing is given up, and its command is returned.
    pub fn go(
        &mut self,
        now: Nanos,
        id: CommandId,
        to: Vec<f64>,
        place: Option<Vec3>,
        limit: Option<f64>,
    ) -> Option<CommandId> {
        let limit = limit.map_or(self.max_speed, |l| l.min(self.max_speed));
        let (from, speed) = self.aim(now);
        let moving = speed.iter().any(|v| *v != 0.0);
        let go = if moving { now + nanos(brake_time()) } else { now };
        let stop = self.stop(now);
        let travel = stop.iter().zip(&to).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
        let profile = MotionProfile::new(travel, limit);
        let goal = place.map_or(ArmGoal::Joints, |p| ArmGoal::Place(v3(p)));
        let path = ArmPath::Ramp(profile);
        let next = ArmMotion { id, goal, start: now, from, speed, go, stop, to, path };
        self.motion.replace(next).map(|old| old.id)
    }

    /// A trajectory, if it can be followed: as many angles as joints for each time, within their limits, times that grow.
    pub fn track(&self, positions: &[f64], times: &[f64], world: &World) -> Result<JointTrack, CommandError> {
        if positions.iter().chain(times).any(|x| !x.is_finite()) {
            return Err(CommandError::NotFinite);
        }
        let joints = self.joints.len();
        if positions.len() != joints * times.len() {
            let (expected, given) = (joints * times.len(), positions.len());
            return Err(CommandError::WrongTrackLength { joints, times: times.len(), expected, given });
        }
        let mut points = Vec::new();
        let mut last = 0.0;
        for (time, angles) in times.iter().zip(positions.chunks(joints.max(1))) {
            // A first posture at time 0 is where the arm already should be.
            if *time < last || (*time == last && !points.is_empty()) {
                return Err(CommandError::TimesDoNotGrow);
            }
            self.check(angles, world)?;
            if *time > 0.0 {
                points.push((*time, angles.to_vec()));
            }
            last = *time;
        }
        Ok(JointTrack { points })
    }

    /// Begins to follow a trajectory at once; what the arm was doing is given up, and its command is returned.
    pub fn follow(&mut self, now: Nanos, id: CommandId, track: JointTrack) -> Option<CommandId> {
        let (from, speed) = self.aim(now);
        let to = track.points.last().map_or_else(|| from.clone(), |(_, angles)| angles.clone());
        let (goal, path, stop) = (ArmGoal::Joints, ArmPath::Track(track), from.clone());
        let next = ArmMotion { id, goal, start: now, from, speed, go: now, stop, to, path };
        self.motion.replace(next).map(|old| old.id)
    }

    /// Brakes; what the arm was doing is given up, and its command is returned.
    pub fn halt(&mut self, now: Nanos, id: CommandId) -> Option<CommandId> {
        let stop = self.stop(now);
        self.go(now, id, stop, None, None)
    }

    /// Lets one motor aim at an angle; what the arm was doing is given up, and its command is returned.
    pub fn aim_joint(
        &mut self,
        now: Nanos,
        joint: f64,
        to: f64,
        world: &World,
    ) -> Result<Option<CommandId>, CommandError> {
        let count = self.joints.len();
        if !(0.0..count as f64).contains(&joint) || joint.fract() != 0.0 {
            return Err(CommandError::NoSuchJoint { joints: count });
        }
        if !to.is_finite() {
            return Err(CommandError::NotFinite);
        }
        let (aim, _) = self.aim(now);
        let mut posture = if self.motion.is_some() { aim.clone() } else { self.aimed.clone() };
        // INVARIANT: a whole number below the number of joints.
        posture[joint as usize] = to;
        self.check(&posture, world)?;
        let replaced = self.motion.take().map(|old| {
            self.rest = aim;
            old.id
        });
        self.aimed = posture;
        Ok(replaced)
    }

    /// Where the arm would stand if it were stopped now.
    fn stop(&self, now: Nanos) -> Vec<f64> {
        let (from, speed) = self.aim(now);
        let (travel, _) = braking(brake_time());
        from.iter().zip(&speed).map(|(q, v)| q + v * travel).collect()
    }

    fn aim(&self, time: Nanos) -> (Vec<f64>, Vec<f64>) {
        match &self.motion {
            Some(m) => m.at(time),
            None => (self.rest.clone(), vec![0.0; self.rest.len()]),
        }
    }

    /// Sets the motors for the step from `now` to `next`.
    ///
    /// The speed is the mean over the step, and the angle that of its middle: the solver divides the step, and would be
    /// pulled ahead or back by the angle at either end.
    pub fn drive(&mut self, now: Nanos, next: Nanos, physics: &mut PhysicsAdapter) {
        let h = seconds(next - now);
        if self.motion.is_none() {
            let most = self.max_speed * h;
            for ((id, q), aimed) in self.joints.iter().zip(&mut self.rest).zip(&self.aimed) {
                let step = (aimed - *q).clamp(-most, most);
                physics.drive(usize::from(id.0), *q + step / 2.0, step / h);
                *q += step;
            }
            return;
        }
        let (a, _) = self.aim(now);
        let (b, _) = self.aim(next);
        for ((id, a), b) in self.joints.iter().zip(&a).zip(&b) {
            physics.drive(usize::from(id.0), (a + b) / 2.0, (b - a) / h);
        }
    }

    /// Ends the motion if it has arrived, or does not in time.
    pub fn check_arrival(
        &mut self,
        now: Nanos,
        physics: &PhysicsAdapter,
    ) -> Option<(CommandId, Result<(), CommandError>)> {
        let motion = self.motion.as_ref()?;
        if now < motion.end() {
            return None;
        }
        let settled = self.speed(physics) < SETTLED;
        let (there, distance) = match motion.goal {
            ArmGoal::Place(place) => {
                let distance = (self.tool_at(physics) - place).norm();
                (distance <= ARRIVED, distance)
            }
            ArmGoal::Joints => {
                let angles = self.positions(physics);
                let off = angles.iter().zip(&motion.to).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
                (off <= ARRIVED_JOINT, (self.tool_at(physics) - self.chain.tool_at(&motion.to)).norm())
            }
        };
        let result = if there && settled {
            Ok(())
        } else if now >= motion.end() + PATIENCE {
            Err(CommandError::Missed { distance })
        } else {
            return None;
        };
        let id = motion.id;
        self.rest.clone_from(&motion.to);
        self.aimed.clone_from(&motion.to);
        self.motion = None;
        Some((id, result))
    }

    pub fn is_busy(&self) -> bool {
        self.motion.is_some() || self.aimed != self.rest
    }

    /// Measured, rad.
    pub fn positions(&self, physics: &PhysicsAdapter) -> Vec<f64> {
        self.joints.iter().map(|id| physics.joint_angle(usize::from(id.0))).collect()
    }

    /// Measured, rad/s.
    pub fn speeds(&self, physics: &PhysicsAdapter) -> Vec<f64> {
        self.joints.iter().map(|id| physics.joint_speed(usize::from(id.0))).collect()
    }

    /// The largest measured speed of a joint, rad/s.
    pub fn speed(&self, physics: &PhysicsAdapter) -> f64 {
        self.joints.iter().fold(0.0, |m, id| m.max(physics.joint_speed(usize::from(id.0)).abs()))
    }

    pub fn tool_at(&self, physics: &PhysicsAdapter) -> SpaceVector {
        physics.pose(self.tip).point(self.tool)
    }
}
