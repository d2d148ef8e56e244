//! The arm's controller: has a path planned, lets the motors follow it as far as they can, and tells when it has arrived, or why
//! not.

mod plan;
mod standstill;

use hrdsl_ir::Nanos;
use hrdsl_ir::value::seconds;
use hrdsl_ir::world::{Arm, BodyId, JointId, JointMotion, Vec3, World};

use hrdsl_harness::CommandId;
use nalgebra::DVector;

use crate::{
    clearance::ArmFigure,
    error::{CommandError, SimulationError},
    kinematics::{KinematicChain, KinematicLink},
    math::{BodyFrame, SpaceVector, v3},
    motion::{ArmGoal, ArmMotion, ArmPath},
    physics::{
        CONTROL_PERIOD, PhysicsAdapter, bad,
        dynamics::{ArmDynamics, BorneLoad},
        index,
    },
    profile::{RISE, brake_time, braking},
    rigidity,
    route::{JointRoute, JointTrack},
};
use standstill::ArmStandstill;

/// How near the tool must come to its place, m.
const ARRIVED: f64 = 0.005;
/// How near each joint must come to its position where positions were asked for, rad or m.
const ARRIVED_JOINT: f64 = 0.01;
/// Below this an arm counts as standing, rad/s or m/s.
const SETTLED: f64 = 0.02;
/// For how long an arm may fail to follow, or to arrive, s.
const PATIENCE: f64 = 1.0;
/// How far a joint may lag behind its aim: from half of it on the aim waits, rad and m. So a motor that is blocked pushes with no
/// more than its effort, and does not leap when it comes free.
const LAG: f64 = 0.04;
const SLIDER_LAG: f64 = 0.01;

/// How fast the aim comes to set-points, 1/s: they come between steps, now none in one and now two, and their joint goes evenly.
const SMOOTHING: f64 = 10.0;
/// How near it must be to be there, rad or m.
const THERE: f64 = 1e-6;
/// Below this rate an arm counts as held up, and its errors are not made good.
const HELD_UP: f64 = 0.2;
/// Below this speed the friction that is expected is less, rad/s or m/s.
const SLOW: f64 = 0.02;
/// And so it is when the joint is no farther behind than this, rad or m.
const NEAR: f64 = 0.005;
/// How fast lasting errors are made good, as a part of that.
const LEARNING: f64 = 0.3;

/// How much of its pace an aim keeps, 0 to 1, when a joint is so far behind, as a part of what it may be: all of it up to a half.
fn pace_kept(behind: f64) -> f64 {
    (2.0 - 2.0 * behind).clamp(0.0, 1.0)
}

fn largest(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}

pub(crate) struct ArmControl {
    pub name: String,
    joints: Vec<JointId>,
    tip: BodyId,
    tool: SpaceVector,
    figure: ArmFigure,
    /// The frequency of its controlled joints, 1/s.
    rigid: f64,
    /// Of each joint, rad/s or m/s.
    speeds: Vec<f64>,
    /// How far each joint may lag behind.
    lags: Vec<f64>,
    /// What brakes each: at a speed of 1, and at any.
    losses: Vec<(f64, f64)>,
    contact_limit: Option<f64>,
    chain: KinematicChain,
    /// The motors' aim while no motion is under way.
    rest: Vec<f64>,
    /// Where set-points want the joints; the motors' aim follows no faster than the arm may.
    aimed: Vec<f64>,
    motion: Option<ArmMotion>,
    standstill: ArmStandstill,
    dynamics: ArmDynamics,
    /// What the joints are wanted to have, at the end of the last step, rad/s or m/s.
    pace: Vec<f64>,
    /// The accelerations that make good lasting errors, rad/s² or m/s²; and as they were when the arm was last free.
    lasting: Vec<f64>,
    lasting_free: Vec<f64>,
    /// What the motors were last told, N·m or N, with what their joints bear besides, and until when that holds.
    told: Vec<(f64, BorneLoad)>,
    told_until: Nanos,
}

/// What an arm and its planner are told of the moment.
pub(crate) struct ArmMoment<'a> {
    pub physics: &'a PhysicsAdapter,
    /// What the arm's hands hold.
    pub held: Vec<BodyId>,
    /// Whether the planner knows of a body.
    pub is_known: Box<dyn Fn(BodyId) -> bool + 'a>,
}

impl ArmControl {
    pub fn new(arm: &Arm, world: &World, physics: &PhysicsAdapter) -> Result<ArmControl, SimulationError> {
        let what = || format!("arm `{}`", arm.name);
        if index(arm.tip) >= world.bodies.len() {
            return Err(bad(what(), "body", index(arm.tip)));
        }
        if !(arm.max_speed.is_finite() && arm.max_speed > 0.0) {
            return Err(SimulationError::BadNumber { what: format!("the speed of arm `{}`", arm.name) });
        }
        let (mut links, mut speeds, mut lags, mut losses) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut end: Option<BodyId> = None;
        for id in &arm.joints {
            let at = usize::from(id.0);
            let joint = world.joints.get(at).ok_or_else(|| bad(what(), "joint", at))?;
            if end.is_some_and(|e| physics.root(e) != physics.root(joint.parent)) {
                return Err(SimulationError::NotAChain { arm: arm.name.clone(), joint: joint.name.clone() });
            }
            end = Some(joint.child);
            if joint.is_rigid() {
                return Err(SimulationError::NotAChain { arm: arm.name.clone(), joint: joint.name.clone() });
            }
            let axis = v3(joint.axis).normalize();
            let (motion, anchor) = (joint.motion, v3(joint.anchor));
            let (lo, hi, start) = (joint.lo, joint.hi, joint.drive.start);
            links.push(KinematicLink { motion, anchor, axis, lo, hi, start });
            speeds.push(joint.drive.speed.map_or(arm.max_speed, |v| v.min(arm.max_speed)));
            losses.push((joint.drive.damping, joint.drive.friction));
            lags.push(if motion == JointMotion::Slider { SLIDER_LAG } else { LAG });
        }
        if end.is_none_or(|e| physics.root(e) != physics.root(arm.tip)) {
            return Err(SimulationError::TipNotOnArm { arm: arm.name.clone() });
        }
        let tool = v3(arm.tool);
        let chain = KinematicChain { links, tool: physics.start(arm.tip).point(tool) };
        let numbers: Vec<usize> = arm.joints.iter().map(|id| usize::from(id.0)).collect();
        let base = world.joints[numbers[0]].parent;
        let rigid = rigidity::of_arm_on(base, physics, world);
        Ok(ArmControl {
            name: arm.name.clone(),
            joints: arm.joints.clone(),
            tip: arm.tip,
            tool,
            figure: ArmFigure::new(&numbers, base, physics),
            speeds,
            lags,
            rigid,
            losses,
            contact_limit: arm.contact_limit,
            rest: chain.links.iter().map(|link| link.start).collect(),
            aimed: chain.links.iter().map(|link| link.start).collect(),
            chain,
            motion: None,
            standstill: ArmStandstill::default(),
            dynamics: ArmDynamics::new(&numbers, physics),
            pace: vec![0.0; numbers.len()],
            lasting: vec![0.0; numbers.len()],
            lasting_free: vec![0.0; numbers.len()],
            told: Vec::new(),
            told_until: 0,
        })
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

    /// Begins to go along a path; what the arm was doing is given up, and its command is returned.
    pub fn go(&mut self, id: CommandId, route: JointRoute, place: Option<Vec3>) -> Option<CommandId> {
        let goal = place.map_or(ArmGoal::Joints, |p| ArmGoal::Place(v3(p)));
        self.begin(ArmMotion::new(id, goal, self.aim(), ArmPath::along(route, RISE)))
    }

    fn begin(&mut self, motion: ArmMotion) -> Option<CommandId> {
        self.motion.replace(motion).map(|old| old.id)
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
    pub fn follow(&mut self, id: CommandId, track: JointTrack) -> Option<CommandId> {
        self.begin(ArmMotion::new(id, ArmGoal::Joints, self.aim(), ArmPath::Track(track)))
    }

    /// Brakes; what the arm was doing is given up, and its command is returned.
    pub fn halt(&mut self, id: CommandId) -> Option<CommandId> {
        let route = JointRoute::new(vec![self.stop()], &self.speeds);
        self.go(id, route, None)
    }

    /// Lets one motor aim at an angle; what the arm was doing is given up, and its command is returned.
    pub fn aim_joint(
        &mut self,
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
        let (aim, _) = self.aim();
        let mut posture = if self.motion.is_some() { aim.clone() } else { self.aimed.clone() };
        // INVARIANT: a whole number below the number of joints.
        posture[joint as usize] = to;
        self.check(&posture, world)?;
        let replaced = self.motion.take().map(|old| {
            self.rest = aim;
            old.id
        });
        self.aimed = posture;
        self.standstill = ArmStandstill::default();
        Ok(replaced)
    }

    /// Where the arm would stand if it were stopped now.
    fn stop(&self) -> Vec<f64> {
        let (from, speed) = self.aim();
        let (travel, _) = braking(brake_time());
        let limits = self.chain.links.iter().map(|link| (link.lo, link.hi));
        from.iter().zip(&speed).zip(limits).map(|((q, v), (lo, hi))| (q + v * travel).clamp(lo, hi)).collect()
    }

    /// The posture and the speeds aimed at.
    fn aim(&self) -> (Vec<f64>, Vec<f64>) {
        match &self.motion {
            Some(motion) => (motion.aim(), motion.speed()),
            None => (self.rest.clone(), vec![0.0; self.rest.len()]),
        }
    }

    /// How far each joint is behind an aim, as a part of what it may be.
    fn behind(&self, aim: &[f64], physics: &PhysicsAdapter) -> Vec<f64> {
        let measured = self.joints.iter().map(|id| physics.joint_position(usize::from(id.0)));
        measured.zip(aim).zip(&self.lags).map(|((q, aim), lag)| (aim - q).abs() / lag).collect()
    }

    /// Sets the motors for the step from `now` to `next`: as they were last told, or, if that is over, anew.
    pub fn drive(&mut self, now: Nanos, next: Nanos, physics: &mut PhysicsAdapter) {
        if now < self.told_until {
            for (id, (effort, load)) in self.joints.iter().zip(&self.told) {
                physics.drive_bearing(usize::from(id.0), *effort, load);
            }
            return;
        }
        self.told_until = next.max(now + CONTROL_PERIOD);
        let h = seconds(self.told_until - now);
        let (a, _) = self.aim();
        let most = largest(&self.behind(&a, physics));
        let rate = pace_kept(most);
        // An aim that comes back to where the arm is need not wait for it: so an arm that presses on something can be freed.
        let comes_back = rate < 1.0
            && self
                .motion
                .as_ref()
                .is_some_and(|motion| largest(&self.behind(&motion.aim_after(h), physics)) < most);
        if let Some(motion) = &mut self.motion {
            motion.pass(h, if comes_back { 1.0 } else { rate });
        } else {
            self.approach_set_points(h);
        }
        let (b, _) = self.aim();
        let (a, b) = (self.within_ends(a, physics), self.within_ends(b, physics));
        self.steer(&a, &b, (h, rate), physics);
        self.give_way(physics);
        self.look_whether_it_stands(h, physics);
    }

    /// What the motors aim at if a posture is wanted: they do not press joints against their ends.
    fn within_ends(&self, mut aim: Vec<f64>, physics: &PhysicsAdapter) -> Vec<f64> {
        for (q, id) in aim.iter_mut().zip(&self.joints) {
            let (lo, hi) = physics.kept_limits(usize::from(id.0));
            *q = q.clamp(lo, hi);
        }
        aim
    }

    /// Brings the motors' aims nearer to the set-points, each by itself, as fast as its joint may.
    fn approach_set_points(&mut self, h: f64) {
        let part = (SMOOTHING * h).min(1.0);
        for ((q, aimed), speed) in self.rest.iter_mut().zip(&self.aimed).zip(&self.speeds) {
            let (left, most) = (aimed - *q, speed * h);
            *q = if left.abs() < THERE { *aimed } else { *q + (left * part).clamp(-most, most) };
        }
    }

    /// No aim at set-points is farther from its joint than it may be. One that is left behind would have its joint press on, and leap
    /// when it comes free; this one goes with what pushes the joint, and back to its set-point after it.
    fn give_way(&mut self, physics: &PhysicsAdapter) {
        if self.motion.is_some() {
            return;
        }
        for ((q, id), lag) in self.rest.iter_mut().zip(&self.joints).zip(&self.lags) {
            let is = physics.joint_position(usize::from(id.0));
            *q = q.clamp(is - lag, is + lag);
        }
    }

    /// Computed torque (Luh, Walker and Paul 1980): the accelerations that bring the joints from `a` to `b` in the time `h`, with
    /// those that make good their errors, and of these the torques.
    fn steer(&mut self, a: &[f64], b: &[f64], (h, rate): (f64, f64), physics: &mut PhysicsAdapter) {
        let (positions, speeds) = (self.positions(physics), self.speeds(physics));
        let (n, rigid) = (self.joints.len(), rigidity::in_steps(self.rigid, h));
        let mut wanted = DVector::zeros(n);
        for i in 0..n {
            let pace = (b[i] - a[i]) / h;
            // A motor that can do no more would have the others make good its error, through the inertia that they share.
            let error = (a[i] - positions[i]).clamp(-self.lags[i], self.lags[i]);
            let slip = self.pace[i] - speeds[i];
            wanted[i] =
                (pace - self.pace[i]) / h + rigid * rigid * error + 2.0 * rigid * slip + self.lasting[i];
            self.pace[i] = pace;
        }
        if rate == 1.0 {
            self.lasting_free.clone_from(&self.lasting);
        }
        let equation = self.dynamics.equation(physics);
        let mut efforts = &equation.inertia * wanted + equation.bias;
        for (i, (damping, friction)) in self.losses.iter().enumerate() {
            if *damping > 0.0 || *friction > 0.0 {
                // Friction turns round where the way does, and not at once.
                let way = self.pace[i] / SLOW + (a[i] - positions[i]) / NEAR;
                efforts[i] += damping * self.pace[i] + friction * way.clamp(-1.0, 1.0);
            }
        }
        self.told = efforts.iter().copied().zip(equation.borne).collect();
        for (i, id) in self.joints.iter().enumerate() {
            let done = physics.drive_bearing(usize::from(id.0), efforts[i], &self.told[i].1);
            // An arm that is held up, or a motor that can do no more, has nothing to learn from it.
            if done == efforts[i] && rate > HELD_UP {
                self.lasting[i] += LEARNING * rigid.powi(3) * (a[i] - positions[i]) * h;
            }
        }
    }

    /// Ends the motion if it has arrived, does not in time, is blocked, or presses harder than it may.
    pub fn check_arrival(
        &mut self,
        held: &[BodyId],
        physics: &PhysicsAdapter,
    ) -> Option<(CommandId, Result<(), CommandError>)> {
        let stopped =
            self.contact_limit.and_then(|limit| self.pressed(held, physics).filter(|p| p.1 > limit));
        if let Some((body, force)) = stopped {
            self.hold(physics);
            let by = physics.name(body).to_owned();
            return self.motion.take().map(|m| (m.id, Err(CommandError::Pressed { by, force })));
        }
        let motion = self.motion.as_ref()?;
        if motion.stuck > PATIENCE {
            let by = self.pressed(held, physics).map(|(body, _)| physics.name(body).to_owned());
            self.hold(physics);
            return self.motion.take().map(|m| (m.id, Err(CommandError::Blocked { by })));
        }
        if !motion.is_over() {
            return None;
        }
        let speed = self.speed(physics);
        let end = motion.end();
        let (there, distance) = match motion.goal {
            ArmGoal::Place(place) => {
                let distance = (self.tool_at(physics) - place).norm();
                (distance <= ARRIVED, distance)
            }
            ArmGoal::Joints => {
                let angles = self.positions(physics);
                let off = angles.iter().zip(&end).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
                (off <= ARRIVED_JOINT, (self.chain.tool_at(&angles) - self.chain.tool_at(&end)).norm())
            }
        };
        let result = match (there, speed < SETTLED) {
            (true, true) => Ok(()),
            _ if motion.overdue() < PATIENCE => return None,
            (true, false) => Err(CommandError::Unsettled { speed }),
            (false, _) => Err(CommandError::Missed { distance }),
        };
        let id = motion.id;
        if result.is_ok() {
            self.rest.clone_from(&end);
            self.aimed = end;
        } else {
            self.hold(physics);
        }
        self.motion = None;
        Some((id, result))
    }

    /// The motors keep the arm where it is.
    fn hold(&mut self, physics: &PhysicsAdapter) {
        let limits = self.chain.links.iter().map(|link| (link.lo, link.hi));
        self.rest =
            self.positions(physics).into_iter().zip(limits).map(|(q, (lo, hi))| q.clamp(lo, hi)).collect();
        self.aimed.clone_from(&self.rest);
        self.lasting.clone_from(&self.lasting_free);
    }

    /// What presses the arm, or what it holds, hardest that is neither of it nor held by it, and by how much, N.
    fn pressed(&self, held: &[BodyId], physics: &PhysicsAdapter) -> Option<(BodyId, f64)> {
        let own = self.figure.bodies.iter().map(|(body, _)| *body).chain(held.iter().copied());
        let pressings = own.flat_map(|body| physics.pressings(body));
        let others = pressings.filter(|p| !self.figure.has(p.other) && !held.contains(&p.other));
        others.max_by(|a, b| a.force.total_cmp(&b.force)).map(|p| (p.other, p.force))
    }

    /// Whether it moves a body.
    pub fn moves(&self, body: BodyId) -> bool {
        self.figure.has(body)
    }

    /// What it hangs on.
    pub fn base(&self) -> BodyId {
        self.figure.base
    }

    /// Whether a joint is one of its own.
    pub fn has_joint(&self, joint: usize) -> bool {
        self.joints.iter().any(|id| usize::from(id.0) == joint)
    }

    /// Measured, rad or m.
    pub fn positions(&self, physics: &PhysicsAdapter) -> Vec<f64> {
        self.joints.iter().map(|id| physics.joint_position(usize::from(id.0))).collect()
    }

    /// Measured, rad/s or m/s.
    pub fn speeds(&self, physics: &PhysicsAdapter) -> Vec<f64> {
        self.joints.iter().map(|id| physics.joint_speed(usize::from(id.0))).collect()
    }

    /// What the motors did over the last step, N·m or N.
    pub fn efforts(&self, physics: &PhysicsAdapter) -> Vec<f64> {
        self.joints.iter().map(|id| physics.joint_effort(usize::from(id.0))).collect()
    }

    /// The largest measured speed of a joint, rad/s or m/s.
    pub fn speed(&self, physics: &PhysicsAdapter) -> f64 {
        self.joints.iter().fold(0.0, |m, id| m.max(physics.joint_speed(usize::from(id.0)).abs()))
    }

    /// How what the arm hangs on was moved from where it was at the start.
    pub fn moved(&self, physics: &PhysicsAdapter) -> BodyFrame {
        let base = self.figure.base;
        physics.pose(base).then(&physics.start(base).inverse())
    }

    /// The motion that takes what hangs on the last joint from where it is with some positions to where it would be with others.
    pub fn carried(&self, base: &BodyFrame, (from, to): (&[f64], &[f64])) -> BodyFrame {
        let last = |q: &[f64]| self.chain.frames(q, base).pop().unwrap_or(*base);
        last(to).then(&last(from).inverse())
    }

    pub fn tool_at(&self, physics: &PhysicsAdapter) -> SpaceVector {
        physics.pose(self.tip).point(self.tool)
    }
}
