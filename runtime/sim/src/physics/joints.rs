//! Joints of the engine: their motors, whose torque is limited, and what they measure.

use hrdsl_ir::world::{BodyId, BodyMotion, Joint, JointMotion, World};
use rapier3d::parry::bounding_volume::BoundingVolume;
use rapier3d::prelude::*;

use super::SUBSTEPS;
use super::division::JointStrain;
use super::dynamics::BorneLoad;
use super::state::{
    adapter::{PhysicsAdapter, PhysicsBody},
    bodies::{body_id, index},
    joint::{DrivenJoint, JointHold, JointStop, ToldEnds},
    pairs::JointGraph,
    place::JointPlace,
};
use super::stops::first_kept;
use crate::math::{
    BodyFrame, RotationQuat, SpaceVector, about, angle_between, from_vector, to_pose, to_vector, v3, wrap,
};

/// How a motor that keeps a speed answers to an error of it, N·s/m or N·m·s/rad.
const FIRM: f32 = 1e5;
/// How fast the solver puts right what has come apart at a joint, 1/s: at half of this rate in the shortest parts of a step, and slower in
/// longer ones. In a step that is divided it stays as slow as in one that is not: a loaded joint is a little apart, by as much as is put
/// right in the time in which it comes about, and an arm would be jolted whenever somebody is touched anywhere.
const MENDS: f64 = 2000.0;
/// So much damped that nothing but that is soft.
const STIFF: f32 = 1000.0;
/// A joint that is so far apart is torn, m and rad. What is led whatever is in its way can do that, which no joint would let happen: two
/// forces without limit are against each other. So a torn joint gives way, as a spring with a damper, and comes together no faster
/// than so, m/s and rad/s. Not so the joints of a robot that falls: what it falls on is not without limit, and the solver does more for
/// them instead.
const TORN: f64 = 4e-3;
const TORN_TURN: f64 = 0.04;
const MENDS_AT_MOST: f64 = 2.0;
const MENDS_AT_MOST_TURN: f64 = 10.0;
/// A joint is strained that is so far apart, m and rad.
pub(super) const STRAINED: f64 = 7e-4;
const STRAINED_TURN: f64 = 4e-3;
/// Light is a tip that has less than so much of the mass of what it is on.
const LIGHT: f64 = 0.25;
/// So far apart a joint is no joint any more, m: the run is at fault.
const BROKEN: f64 = 0.1;
/// A robot that leans so far from where it stood falls, or has fallen: the cosine of 10°.
const LEANS: f64 = 0.985;
/// How fast it stops what tears it, s.
const TORN_STOPS: f64 = 3e-3;
/// What is so near to a robot that sleeps wakes it, m: contacts begin before surfaces meet.
const APPROACHED: f32 = 0.02;
/// The effort of a motor without a limit, N·m or N.
const UNLIMITED: f64 = 1e9;

/// When the bodies of an arm may be left out of the steps.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum ArmSleep {
    Never,
    /// As soon as they stand still.
    Still,
    /// They press on something, and get nowhere by it: also while they tremble.
    Held,
}

impl ArmSleep {
    /// An arm whose every point stays slower for half a second may sleep, m/s and rad/s.
    fn below(self) -> (f32, f32) {
        match self {
            ArmSleep::Never => (-1.0, -1.0),
            ArmSleep::Still => (1e-3, 1e-3),
            ArmSleep::Held => (0.02, 0.1),
        }
    }
}

/// A rotor's inertia, as it is added to the body that it turns: about all axes, since the links between two axes of one shoulder
/// or wrist would otherwise be so much lighter than their neighbours that the solver could not hold them together.
pub(super) fn rotor_inertia(joint: &Joint) -> Mat3 {
    Mat3::from_diagonal(Vector::splat(joint.drive.rotor as f32))
}

impl PhysicsAdapter {
    pub(super) fn add_joint(&mut self, joint: &Joint, world: &World, graph: &JointGraph) -> DrivenJoint {
        let (axis, anchor) = (v3(joint.axis).normalize(), v3(joint.anchor));
        let frame = BodyFrame::new(anchor, x_to(&axis));
        let (parent, child) = (self.root(joint.parent), self.root(joint.child));
        let (p, c) = (&self.parts[index(parent)], &self.parts[index(child)]);
        let (mut data, moving) = free_joint(joint.motion, &frame, [&p.start, &c.start]);
        // The light links of a described robot would shake.
        if world.bodies[index(child)].solid.is_none() {
            data.softness = stiff(MENDS as f32);
        }
        let start = joint.drive.start;
        let (least, most) = (joint.lo - start, joint.hi - start);
        let kept = first_kept(joint);
        let is_wide = joint.motion == JointMotion::Hinge && !JointStop::is_plain(least, most);
        // The engine knows an angle within half a turn of its zero, which is where the joint is at the start, if that will do.
        let first_frame = data.local_frame1;
        if is_wide {
            JointStop::about(0.0, least, most).set(&mut data, &first_frame, kept);
        } else {
            data.set_limits(moving, [kept.0 as f32, kept.1 as f32]);
        }
        let bearer = self.parts[index(self.bearer_of(parent, world))].handle;
        let handle = self.world.insert_impulse_joint(p.handle, c.handle, data);
        let dynamic = graph
            .beyond(joint, parent, child)
            .into_iter()
            .filter(|b| world.bodies[index(*b)].motion == BodyMotion::Dynamic);
        let carried: Vec<RigidBodyHandle> = dynamic.map(|b| self.parts[index(b)].handle).collect();
        let sides = [p, c].map(|part| (part.handle, part.start));
        let (bodies, place) = self.jointed.place(sides, &self.world.bodies, (&axis, &anchor));
        DrivenJoint {
            name: joint.name.clone(),
            handle,
            parent: p.handle,
            child: c.handle,
            bearer,
            motion: joint.motion,
            axis,
            anchor,
            bodies,
            place,
            is_tip: carried.len() == 1
                && world.bodies[index(child)].mass < LIGHT * world.bodies[index(parent)].mass,
            carried,
            limit: joint.drive.effort.unwrap_or(UNLIMITED),
            effort: 0.0,
            start,
            lo: joint.lo,
            hi: joint.hi,
            wound: is_wide.then_some(0.0),
            first_frame,
            stop: JointStop::about(0.0, least, most),
            ends: ToldEnds::at_start(kept, self.step),
            softness: data.softness,
            keeps_rate: world.bodies[index(child)].solid.is_none(),
            loose: self.loose_root(child, world),
            hold: JointHold::Firm,
            is_run: false,
        }
    }

    /// A body, or what it slides on in the end.
    fn bearer_of(&self, body: BodyId, world: &World) -> BodyId {
        let mut at = body;
        // No more often than there are joints: a chain of sliders may be closed.
        for _ in &world.joints {
            let slides =
                |j: &&Joint| j.motion == JointMotion::Slider && !j.is_rigid() && self.root(j.child) == at;
            let Some(slider) = world.joints.iter().find(slides) else { break };
            at = self.root(slider.parent);
        }
        at
    }

    /// Whether a loose body leans far from how it stood at the start.
    fn leans(&self, loose: BodyId) -> bool {
        let upright = self.start(loose).turn.inverse() * SpaceVector::z();
        (self.pose(loose).turn * upright).z < LEANS
    }

    /// Whether a body, and what it hangs on in the end, is held by nothing fixed or led.
    pub fn is_loose(&self, body: BodyId, world: &World) -> bool {
        self.loose_root(body, world).is_some()
    }

    /// What a body hangs on in the end, if that is held by nothing fixed or led.
    fn loose_root(&self, body: BodyId, world: &World) -> Option<BodyId> {
        let mut at = self.root(body);
        for _ in &world.joints {
            let Some(above) = world.joints.iter().find(|j| !j.is_rigid() && self.root(j.child) == at) else {
                break;
            };
            at = self.root(above.parent);
        }
        (world.bodies[index(at)].motion == BodyMotion::Dynamic).then_some(at)
    }

    // ── What joints measure ──

    /// The measured angle (rad) or way (m); of a hand-made joint from the start.
    pub fn joint_position(&self, joint: usize) -> f64 {
        let Some(driven) = &self.joints[joint] else { return 0.0 };
        let way = self.way(driven);
        if driven.start == 0.0 { way } else { driven.start + way }
    }

    /// How far a joint is from its start.
    pub(super) fn way(&self, driven: &DrivenJoint) -> f64 {
        match driven.motion {
            JointMotion::Hinge => {
                let [parent, child] = driven.bodies.map(|body| self.jointed.moved(body));
                let angle = driven.place.angle(&driven.axis, parent, child);
                driven.wound.map_or(angle, |last| last + wrap(angle - wrap_far(last)))
            }
            JointMotion::Slider => driven.place.way(),
        }
    }

    /// The engine has moved bodies: finds where the joints on them are now.
    pub(super) fn place_joints(&mut self) {
        self.jointed.look(&self.world.bodies);
        for driven in self.joints.iter_mut().flatten() {
            let [parent, child] = driven.bodies;
            if self.jointed.is_news(parent) || self.jointed.is_news(child) {
                let (parent, child) = (self.jointed.moved(parent), self.jointed.moved(child));
                driven.place = JointPlace::of((&driven.axis, &driven.anchor), parent, child);
            }
        }
    }

    /// The measured speed about or along the axis, rad/s or m/s.
    pub fn joint_speed(&self, joint: usize) -> f64 {
        let Some(driven) = &self.joints[joint] else { return 0.0 };
        let (p, c) = (&self.world.bodies[driven.parent], &self.world.bodies[driven.child]);
        let axis = driven.place.axis;
        match driven.motion {
            JointMotion::Hinge => (from_vector(c.angvel()) - from_vector(p.angvel())).dot(&axis),
            JointMotion::Slider => {
                let at = to_vector(driven.place.anchor);
                (from_vector(c.velocity_at_point(at)) - from_vector(p.velocity_at_point(at))).dot(&axis)
            }
        }
    }

    /// The torque (N·m) or force (N) of its motor over the last step.
    pub fn joint_effort(&self, joint: usize) -> f64 {
        self.joints[joint].as_ref().map_or(0.0, |driven| driven.effort)
    }

    // ── Motors ──

    /// Lets a motor turn (N·m) or push (N) as hard as it is told, and can, over the next step; gives what it does.
    pub fn drive(&mut self, joint: usize, effort: f64) -> f64 {
        let Some(driven) = &mut self.joints[joint] else { return 0.0 };
        driven.effort = effort.clamp(-driven.limit, driven.limit);
        let Some(driven) = &self.joints[joint] else { return 0.0 };
        let axis = driven.place.axis;
        // A slider is pushed through its middle, so that the solver need not keep it from tilting.
        let at = self.world.bodies[driven.child].center_of_mass();
        let pull = to_vector(axis * driven.effort);
        let (effort, motion) = (driven.effort, driven.motion);
        let against = if motion == JointMotion::Hinge { driven.bearer } else { driven.parent };
        for (body, pull) in [(driven.child, pull), (against, -pull)] {
            let body = &mut self.world.bodies[body];
            match motion {
                JointMotion::Hinge => body.add_torque(pull, false),
                JointMotion::Slider => body.add_force_at_point(pull, at, false),
            }
        }
        effort
    }

    /// As [`Self::drive`], and lets the joint bear what its bodies weigh. The solver would find that by itself, as the force that keeps the
    /// two sides together; but it begins with nothing in each part of a step, goes over a chain of seven joints twice, and leaves them as
    /// far apart as what it did not find pulls them. So it is told what is known, and finds the rest.
    pub fn drive_bearing(&mut self, joint: usize, effort: f64, load: &BorneLoad) -> f64 {
        let done = self.drive(joint, effort);
        let Some(driven) = &self.joints[joint] else { return done };
        let at = to_vector(driven.place.anchor);
        let (force, torque) = (to_vector(load.force), to_vector(load.torque));
        for (handle, sign) in [(driven.child, 1.0), (driven.parent, -1.0)] {
            let body = &mut self.world.bodies[handle];
            body.add_force_at_point(force * sign, at, false);
            body.add_torque(torque * sign, false);
        }
        done
    }

    /// Lets a motor go at a speed (m/s or rad/s) from now on, with no more than this force or torque (N or N·m).
    pub fn run_at(&mut self, joint: usize, speed: f64, force: f64) {
        if let Some(driven) = &mut self.joints[joint] {
            driven.is_run = true;
        }
        self.set_motor(joint, speed, force);
    }

    /// Brakes a joint with no more than this force or torque (N or N·m).
    pub(super) fn brake(&mut self, joint: usize, force: f64) {
        self.set_motor(joint, 0.0, force);
    }

    fn set_motor(&mut self, joint: usize, speed: f64, force: f64) {
        let Some(driven) = &self.joints[joint] else { return };
        let moving = match driven.motion {
            JointMotion::Hinge => JointAxis::AngX,
            JointMotion::Slider => JointAxis::LinX,
        };
        if let Some(joint) = self.world.impulse_joints.get_mut(driven.handle, true) {
            joint.data.set_motor_model(moving, MotorModel::ForceBased);
            joint.data.set_motor(moving, 0.0, speed as f32, 0.0, FIRM);
            joint.data.set_motor_max_force(moving, force as f32);
        }
    }

    /// Lets the solver mend joints as fast in the parts of a divided step as in those of one that is not.
    pub(super) fn keep_mending(&mut self) {
        if self.mended == self.part {
            return;
        }
        self.mended = self.part;
        let (h, longest) = (self.part.0 / self.part.1 as f64, self.step / SUBSTEPS as f64);
        let rate = MENDS / (longest.max(h) * MENDS + 2.0);
        let softness = stiff((2.0 * rate / (1.0 - h * rate)) as f32);
        for driven in self.joints.iter_mut().flatten().filter(|driven| driven.keeps_rate) {
            driven.softness = softness;
            if let Some(joint) = self.world.impulse_joints.get_mut(driven.handle, false) {
                joint.data.softness = softness;
            }
        }
    }

    /// Lets torn joints give way, and those that have come together again not; gives how much the joints ask of the solver.
    pub(super) fn ease_joints(&mut self) -> JointStrain {
        let falls = |body: &RigidBodyHandle| !self.world.bodies[*body].is_sleeping();
        let (falls, blow) = (self.fallen.iter().any(falls), self.pressed > 0);
        let mut strain = JointStrain { falls, blow, ..JointStrain::default() };
        let h = self.part.0 / self.part.1 as f64;
        for at in 0..self.joints.len() {
            let Some(driven) = &self.joints[at] else { continue };
            let apart = driven.place.apart(driven.motion);
            self.accuracy.look_at_gap(at, apart);
            let falls = driven.loose.is_some_and(|loose| self.leans(loose)) && !self.is_asleep(at);
            if falls {
                strain.falls = true;
                strain.apart = strain.apart.max(apart);
            }
            if self.energy.fault.is_none() && apart > BROKEN {
                let (name, by) = (&driven.name, 1e3 * apart);
                self.energy.fault = Some(format!(
                    "the physics failed: joint `{name}` is torn, its bodies are {by:.0} mm apart"
                ));
            }
            let [parent, child] = driven.bodies.map(|body| self.jointed.moved(body));
            let tilts = |by: f64| driven.place.is_tilted(driven.motion, by, parent, child);
            let is_apart = !falls && (apart > TORN || tilts(TORN_TURN));
            let is_strained = driven.is_tip && !falls && (apart > STRAINED || tilts(STRAINED_TURN));
            let hold = driven.hold.next(is_apart, is_strained);
            strain.blow |= hold.takes_blow();
            if hold == JointHold::Firm && driven.hold == hold {
                continue;
            }
            let tilted = driven.place.tilt(driven.motion, parent, child);
            let usual = f64::from(driven.softness.erp_inv_dt(h as f32));
            let rate = usual.min(MENDS_AT_MOST / apart).min(MENDS_AT_MOST_TURN / tilted);
            let softness = match hold {
                JointHold::Strained { .. } if is_apart => stiff(rate as f32),
                JointHold::Firm | JointHold::Strained { .. } => driven.softness,
                JointHold::Torn => giving(rate, h),
            };
            if let Some(joint) = self.world.impulse_joints.get_mut(driven.handle, false) {
                joint.data.softness = softness;
            }
            if let Some(driven) = &mut self.joints[at] {
                driven.hold = hold;
            }
        }
        strain
    }

    /// When the bodies that a joint moves may be left out of the steps; if never, they wake. What their motors do then goes on.
    pub fn let_sleep(&mut self, joint: usize, sleep: ArmSleep) {
        let Some(driven) = &self.joints[joint] else { return };
        let (linear, angular) = sleep.below();
        let is_told = |body: &RigidBody| body.activation().normalized_linear_threshold == linear;
        if self.world.bodies.get(driven.child).is_none_or(is_told) {
            return;
        }
        let Some(body) = self.world.bodies.get_mut(driven.child) else { return };
        let activation = body.activation_mut();
        (activation.normalized_linear_threshold, activation.angular_threshold) = (linear, angular);
        if sleep == ArmSleep::Never {
            body.wake_up(true);
        }
    }

    /// Whether something that moves, and is not of the robot that a body is of, could touch that robot, or what it holds, in the next
    /// step. The engine would wake what is touched, and solve its joints a step too late. What loosely trembles beside one that is held
    /// does so because that does, and is as still as it.
    pub fn is_approached(&self, of: BodyId, held: &[BodyId], sleep: ArmSleep) -> bool {
        let is_own = |at: usize| {
            self.are_joined(of, body_id(at))
                || held.iter().any(|body| index(*body) == at)
                || sleep == ArmSleep::Held && self.is_loose_and_slow(at)
        };
        let solid = || (0..self.parts.len()).filter(|at| !self.parts[*at].ghost);
        let own = || solid().filter(|at| is_own(*at)).filter_map(|at| self.box_now(at));
        let Some(all) = own().reduce(|a, b| a.merged(&b)) else { return false };
        solid().filter(|at| self.moves(*at) && !is_own(*at)).any(|at| {
            let swept = self.box_in_step(at, self.step).loosened(APPROACHED);
            all.intersects(&swept) && own().any(|own| own.intersects(&swept))
        })
    }

    fn is_loose_and_slow(&self, part: usize) -> bool {
        let body = &self.world.bodies[self.parts[part].handle];
        let slow = f64::from(ArmSleep::Held.below().0);
        body.is_dynamic() && self.guides[index(self.parts[part].root)].is_none() && self.speed_of(part) < slow
    }

    fn moves(&self, part: usize) -> bool {
        if self.parts[part].motion == BodyMotion::Fixed {
            return false;
        }
        let body = &self.world.bodies[self.parts[part].handle];
        body.is_dynamic_or_kinematic() && !body.is_sleeping()
    }

    /// Wakes the body that a joint moves, if it sleeps.
    pub fn wake(&mut self, joint: usize) {
        let Some(driven) = &self.joints[joint] else { return };
        if self.world.bodies[driven.child].is_sleeping() {
            self.world.bodies[driven.child].wake_up(true);
        }
    }

    /// Whether the body that a joint moves is left out of the steps, since it stands still.
    pub fn is_asleep(&self, joint: usize) -> bool {
        self.joints[joint].as_ref().is_some_and(|driven| self.world.bodies[driven.child].is_sleeping())
    }

    /// Takes back what the motors did in the last step, but for those of arms that sleep: whoever wakes one finds it held.
    pub fn release_motors(&mut self, sleeps: impl Fn(usize) -> bool) {
        for (_, driven) in self.joints.iter().enumerate().filter(|(at, _)| !sleeps(*at)) {
            let Some(driven) = driven else { continue };
            for handle in [driven.parent, driven.child, driven.bearer] {
                let body = &self.world.bodies[handle];
                if body.user_torque() != AngVector::ZERO || body.user_force() != Vector::ZERO {
                    let body = &mut self.world.bodies[handle];
                    body.reset_torques(false);
                    body.reset_forces(false);
                }
            }
        }
    }

    /// The body that leads those that a joint carries first.
    pub fn child_of(&self, joint: usize) -> BodyId {
        let child = self.joints[joint].as_ref().map(|driven| driven.child);
        // INVARIANT: arms have joints that can move, each with a child.
        let at = self.parts.iter().position(|part| Some(part.handle) == child).unwrap_or_default();
        self.parts[at].root
    }

    /// The bodies that a joint carries, by the body of the scenario that leads each.
    pub fn carried_by(&self, joint: usize) -> Vec<BodyId> {
        let Some(driven) = &self.joints[joint] else { return Vec::new() };
        let carried = |part: &&PhysicsBody| driven.carried.contains(&part.handle);
        let mut roots: Vec<BodyId> = self.parts.iter().filter(carried).map(|part| part.root).collect();
        roots.dedup();
        roots
    }
}

/// A joint of the engine between two bodies that start so, whose axis is the x axis of a frame; and which of its axes moves.
fn free_joint(motion: JointMotion, frame: &BodyFrame, starts: [&BodyFrame; 2]) -> (GenericJoint, JointAxis) {
    let (locked, moving) = match motion {
        JointMotion::Hinge => (JointAxesMask::LOCKED_REVOLUTE_AXES, JointAxis::AngX),
        JointMotion::Slider => (JointAxesMask::LOCKED_PRISMATIC_AXES, JointAxis::LinX),
    };
    let [parent, child] = starts.map(|start| to_pose(&start.inverse().then(frame)));
    let joint = GenericJointBuilder::new(locked).local_frame1(parent).local_frame2(child);
    (joint.contacts_enabled(false).build(), moving)
}

/// The softness of a joint that holds, and of whose gap `rate / (h · rate + 2)` is mended in a second, in parts of a step of the time h.
fn stiff(rate: f32) -> SpringCoefficients<f32> {
    SpringCoefficients { natural_frequency: STIFF * rate / std::f32::consts::TAU, damping_ratio: STIFF }
}

/// The softness of a torn joint, of whose gap so much is mended in a second, in parts of a step of the time `h`.
fn giving(rate: f64, h: f64) -> SpringCoefficients<f32> {
    // The engine's rate is ω/(hω + 2ζ), and a speed is less by 1 of 1 + 1/(4ζ² h · rate) after each time h.
    let damping = 0.5 / (rate * TORN_STOPS).sqrt();
    let frequency = 2.0 * damping * rate / (1.0 - h * rate).max(1e-3);
    SpringCoefficients {
        natural_frequency: (frequency / std::f64::consts::TAU) as f32,
        damping_ratio: damping as f32,
    }
}

/// The same direction within -π..π, however often it is wound.
fn wrap_far(angle: f64) -> f64 {
    let turn = 2.0 * std::f64::consts::PI;
    angle - turn * (angle / turn).round()
}

/// A rotation that takes the x axis to the given unit vector.
fn x_to(axis: &SpaceVector) -> RotationQuat {
    let turn = SpaceVector::x().cross(axis);
    let angle = angle_between(&SpaceVector::x(), axis);
    let over = if turn.norm() < 1e-9 { SpaceVector::z() } else { turn.normalize() };
    about(over, angle)
}
