//! Grippers: which hand holds what, and which of the hands the physics follows.
//!
//! Fingers close until they meet something or each other. A body that is pressed from two sides is held: a rigid joint stands for the
//! friction, since friction alone creeps in the engine's steps, and bears what friction would. Beyond that the body slips: it moves
//! freely between the fingers until it is slow again.
//!
//! A body may be held by several hands. A hand on a dynamic palm (a robot's) is fixed to what it holds by a joint. A hand
//! on a kinematic palm (a person's) is so fixed only while no dynamic hand, and no kinematic one before it, holds the
//! same body: a moved hand would otherwise win against any motor. Meanwhile it holds in name; when the others let go,
//! the body is fixed to it where it is.

use hrdsl_ir::Nanos;
use hrdsl_ir::value::seconds;
use hrdsl_ir::world::{BodyId, BodyMotion, Gripper, Joint, JointId, JointMotion, World};
use rapier3d::prelude::ImpulseJointHandle;

use hrdsl_harness::CommandId;

use crate::{
    error::{CommandError, SimulationError},
    math::{SpaceVector, v3},
    physics::{PhysicsAdapter, bad, body_id, index},
};

/// Beyond its reach by this much (m), a hand loses what it holds.
const SLACK: f64 = 0.05;

pub(crate) struct GripperHand {
    pub name: String,
    palm: BodyId,
    tool: SpaceVector,
    reach: f64,
    delay: Nanos,
    holds: Vec<BodyId>,
    dynamic: bool,
    guided: bool,
    force: f64,
    fingers: Vec<Finger>,
    /// Where its fingers are going: 1 closes, −1 opens.
    direction: f64,
    /// All bodies that can press what it holds.
    parts: Vec<BodyId>,
    phase: GripPhase,
    /// Takes the first thing it can from now on.
    grasping: bool,
    held: Option<BodyId>,
    joint: Option<ImpulseJointHandle>,
    /// For how many steps the joint has borne more than it can.
    overloaded: u32,
}

struct Finger {
    joint: usize,
    body: BodyId,
    /// m/s or rad/s; negative if it closes downwards.
    speed: f64,
    /// The force or torque with which it presses, N or N·m: of one that others follow, also with theirs.
    force: f64,
    /// Another moves it.
    follows: bool,
    /// How far it may be ahead of those that follow it; `None`: none does.
    lag: Option<f64>,
    /// How near its end it counts as there, m or rad.
    end: f64,
}

/// How near its end a finger counts as there, m and rad.
const END: f64 = 1e-3;
const END_ANGLE: f64 = 1e-2;
/// How far a finger may be ahead of those that follow it, m and rad: as much as there is play in a gear.
const PLAY: f64 = 2e-3;
const PLAY_ANGLE: f64 = 2e-2;
/// The least time for the way of fingers, s.
const MIN_STROKE: f64 = 0.05;
/// For how long, beyond twice the time of their way, fingers are waited for.
const LONGEST_PUSH: Nanos = 500_000_000;

/// What friction is between fingers and what they hold.
const FRICTION: f64 = 0.8;
/// How far the pads of fingers reach from the middle of what they hold, m: their lever against its turning.
const PAD: f64 = 0.02;
/// For how many steps more than it can bear makes a body slip: impacts are shorter.
const SLIPS_AFTER: u32 = 3;
/// How slow a body must be in the hand to be held, m/s.
const STILL: f64 = 0.05;

/// How fast a person's hand goes on to take hold of something, m/s, and how near it must come, m.
const REACHES: f64 = 0.3;
const TOUCHES: f64 = 4e-3;

enum GripPhase {
    Open,
    Closed,
    Closing { until: Nanos, id: Option<CommandId> },
    Opening { until: Nanos, id: Option<CommandId> },
}

type FinishedCommands = Vec<(CommandId, Result<(), CommandError>)>;

impl Finger {
    fn new(id: JointId, joint: &Joint, gripper: &Gripper, world: &World, physics: &PhysicsAdapter) -> Finger {
        let time = seconds(gripper.delay).max(MIN_STROKE);
        let speed = (joint.hi - joint.lo) / time;
        let follower = |at: &&JointId| {
            world.joints.get(usize::from(at.0)).is_some_and(|j| j.drive.mimic.is_some_and(|m| m.joint == id))
        };
        let followers = gripper.fingers.iter().filter(follower).count();
        let (arm, play, end) = match joint.motion {
            JointMotion::Slider => (1.0, PLAY, END),
            JointMotion::Hinge => {
                let tool = physics.start(gripper.palm).point(v3(gripper.tool));
                let way = tool - v3(joint.anchor);
                (way.cross(&v3(joint.axis).normalize()).norm(), PLAY_ANGLE, END_ANGLE)
            }
        };
        let follows = joint.drive.mimic.is_some();
        let all = if follows { 1.0 } else { 1.0 + followers as f64 };
        Finger {
            joint: usize::from(id.0),
            body: joint.child,
            speed: if gripper.reversed.contains(&id) { -speed } else { speed },
            force: if follows || followers > 0 || joint.motion == JointMotion::Hinge {
                gripper.force * arm * all
            } else {
                gripper.force
            },
            follows,
            lag: (followers > 0).then_some(play),
            end,
        }
    }
}

impl GripperHand {
    fn new(
        gripper: &Gripper,
        world: &World,
        physics: &PhysicsAdapter,
    ) -> Result<GripperHand, SimulationError> {
        let what = || format!("gripper `{}`", gripper.name);
        for body in gripper.holds.iter().chain([&gripper.palm]) {
            if index(*body) >= world.bodies.len() {
                return Err(bad(what(), "body", index(*body)));
            }
        }
        let unfit = |b: &&BodyId| physics.motion(physics.root(**b)) != BodyMotion::Dynamic;
        if let Some(body) = gripper.holds.iter().find(unfit) {
            let body = world.bodies[index(*body)].name.clone();
            return Err(SimulationError::NotHoldable { gripper: gripper.name.clone(), body });
        }
        if !(gripper.reach.is_finite() && gripper.reach >= 0.0 && gripper.delay >= 0) {
            return Err(SimulationError::BadNumber { what: format!("reach or delay of {}", what()) });
        }
        if !(gripper.force.is_finite() && gripper.force > 0.0) {
            return Err(SimulationError::BadNumber { what: format!("the force of {}", what()) });
        }
        let mut fingers = Vec::new();
        for id in &gripper.fingers {
            let at = usize::from(id.0);
            let joint = world.joints.get(at).ok_or_else(|| bad(what(), "joint", at))?;
            fingers.push(Finger::new(*id, joint, gripper, world, physics));
        }
        let roots = fingers.iter().map(|f| f.body).chain([gripper.palm]).map(|b| physics.root(b));
        let parts = roots.flat_map(|root| physics.one_with(root)).filter(|b| !physics.is_ghost(*b)).collect();
        Ok(GripperHand {
            name: gripper.name.clone(),
            palm: gripper.palm,
            tool: v3(gripper.tool),
            reach: gripper.reach,
            delay: gripper.delay,
            holds: gripper.holds.clone(),
            dynamic: physics.motion(gripper.palm) == BodyMotion::Dynamic,
            guided: physics.motion(gripper.palm) == BodyMotion::Guided,
            force: gripper.force,
            fingers,
            direction: 0.0,
            parts,
            phase: GripPhase::Open,
            grasping: false,
            held: None,
            joint: None,
            overloaded: 0,
        })
    }

    fn distance(&self, body: BodyId, physics: &PhysicsAdapter) -> f64 {
        physics.distance_to_point(body, physics.pose(self.palm).point(self.tool))
    }

    /// Moves the fingers: 1 closes, −1 opens.
    fn run_fingers(&mut self, direction: f64, physics: &mut PhysicsAdapter) {
        for finger in self.fingers.iter().filter(|finger| !finger.follows) {
            physics.run_at(finger.joint, finger.speed * direction, finger.force);
        }
        self.direction = direction;
    }

    /// A finger does not run ahead of those that follow it, nor into its end: one motor moves them all.
    fn keep_together(&self, physics: &mut PhysicsAdapter) {
        for finger in &self.fingers {
            let Some(play) = finger.lag else { continue };
            let rate = (2.0 - 2.0 * physics.gear_lag(finger.joint) / play).clamp(0.0, 1.0);
            let speed = physics.slower_near_ends(finger.joint, finger.speed * self.direction * rate);
            physics.run_at(finger.joint, speed, finger.force);
        }
    }

    /// Whether all fingers are at an end of their way.
    fn fingers_are_at_end(&self, closed: bool, physics: &PhysicsAdapter) -> bool {
        self.fingers.iter().all(|finger| {
            let (lo, hi) = physics.joint_limits(finger.joint);
            let end = if closed == (finger.speed >= 0.0) { hi } else { lo };
            (physics.joint_position(finger.joint) - end).abs() < finger.end
        })
    }

    /// What the hand would hold.
    fn choose(&self, physics: &PhysicsAdapter) -> Option<BodyId> {
        if !self.fingers.is_empty() {
            return self.pressed(physics);
        }
        // A person's hand holds what it touches.
        self.nearest(physics).filter(|body| !self.guided || physics.distance(self.palm, *body) <= TOUCHES)
    }

    /// What is touched from two sides, by a finger at least, and lies still in the hand.
    fn pressed(&self, physics: &PhysicsAdapter) -> Option<BodyId> {
        self.holds.iter().copied().find(|body| {
            let touches = |part: &&BodyId| physics.pressings(**part).any(|p| p.other == *body);
            let mut sides: Vec<BodyId> =
                self.parts.iter().filter(touches).map(|part| physics.root(*part)).collect();
            sides.dedup();
            let of_finger = |side: &BodyId| self.fingers.iter().any(|f| physics.root(f.body) == *side);
            sides.len() > 1 && sides.iter().any(of_finger) && physics.slip(self.palm, *body) < STILL
        })
    }

    /// The nearest body in reach; of equally near ones the first.
    fn nearest(&self, physics: &PhysicsAdapter) -> Option<BodyId> {
        let mut best: Option<(f64, BodyId)> = None;
        for body in &self.holds {
            let d = self.distance(*body, physics);
            if d <= self.reach && best.is_none_or(|(b, _)| d < b) {
                best = Some((d, *body));
            }
        }
        best.map(|(_, body)| body)
    }

    /// How much farther a person's hand goes, which has been told to take hold and does not touch anything yet.
    fn reaches(&self, step: Nanos, physics: &PhysicsAdapter) -> Option<(BodyId, SpaceVector)> {
        let is_taking = matches!(self.phase, GripPhase::Closing { .. }) || self.grasping;
        if !self.guided || !is_taking || self.held.is_some() {
            return None;
        }
        let body = self.nearest(physics)?;
        let far = physics.distance(self.palm, body);
        let palm = physics.pose(self.palm).at;
        let way = physics.nearest_point(body, palm) - palm;
        (far > 0.0 && way.norm() > 0.0).then(|| {
            let size = far.min(REACHES * seconds(step));
            (self.palm, way * (size / way.norm()))
        })
    }

    /// Whether a hand that closes is done: it holds something, its fingers met, or they push in vain.
    fn has_closed(&self, now: Nanos, until: Nanos, physics: &PhysicsAdapter) -> bool {
        if self.fingers.is_empty() {
            return now >= until;
        }
        let in_vain = now >= until + self.delay + LONGEST_PUSH;
        in_vain || self.pressed(physics).is_some() || self.fingers_are_at_end(true, physics)
    }

    fn has_opened(&self, now: Nanos, until: Nanos, physics: &PhysicsAdapter) -> bool {
        let in_vain = now >= until + self.delay + LONGEST_PUSH;
        if self.fingers.is_empty() {
            now >= until
        } else {
            in_vain || self.fingers_are_at_end(false, physics)
        }
    }

    fn is_busy(&self) -> bool {
        matches!(self.phase, GripPhase::Closing { .. } | GripPhase::Opening { .. })
    }
}

/// All hands of a world.
pub(crate) struct HandSet {
    hands: Vec<GripperHand>,
    /// By body: whether any hand has ever taken it.
    taken: Vec<bool>,
    /// By body: whether it hangs on a joint that moves, as a handle does.
    hung: Vec<bool>,
}

impl HandSet {
    pub fn new(world: &World, physics: &mut PhysicsAdapter) -> Result<HandSet, SimulationError> {
        let hands = world.grippers.iter().map(|g| GripperHand::new(g, world, physics));
        let mut hands = hands.collect::<Result<Vec<_>, _>>()?;
        hands.iter().flat_map(|hand| &hand.fingers).filter(|finger| finger.follows).for_each(|finger| {
            physics.limit_gear(finger.joint, finger.force);
        });
        hands.iter_mut().for_each(|hand| hand.run_fingers(-1.0, physics));
        let moving = || world.joints.iter().filter(|joint| !joint.is_rigid());
        let hangs = |body: BodyId| moving().any(|joint| physics.root(joint.child) == physics.root(body));
        let hung = (0..world.bodies.len()).map(|at| hangs(body_id(at))).collect();
        Ok(HandSet { hands, taken: vec![false; world.bodies.len()], hung })
    }

    /// Whether a body hangs on a joint that moves, so that whoever holds it does not carry it.
    pub fn is_hung(&self, body: BodyId) -> bool {
        self.hung[index(body)]
    }

    pub fn named(&self, name: &str) -> Option<usize> {
        self.hands.iter().position(|h| h.name == name)
    }

    pub fn count(&self) -> usize {
        self.hands.len()
    }

    pub fn held_by(&self, hand: usize) -> Option<BodyId> {
        self.hands[hand].held
    }

    /// What some of the hands hold.
    pub fn held_by_any(&self, hands: &[usize]) -> Vec<BodyId> {
        hands.iter().filter_map(|hand| self.hands[*hand].held).collect()
    }

    /// What the hands of the robot hold that a body is of.
    pub fn held_by_robot(&self, of: BodyId, physics: &PhysicsAdapter) -> Vec<BodyId> {
        let own = self.hands.iter().filter(|hand| physics.are_joined(of, hand.palm));
        own.filter_map(|hand| hand.held).collect()
    }

    pub fn was_taken(&self, body: BodyId) -> bool {
        self.taken[index(body)]
    }

    pub fn is_busy(&self) -> bool {
        self.hands.iter().any(GripperHand::is_busy)
    }

    /// Whether the fingers of some of the hands are on their way.
    pub fn is_any_busy(&self, hands: &[usize]) -> bool {
        hands.iter().any(|hand| self.hands[*hand].is_busy())
    }

    /// Tells a hand to close; gives the command that this one replaces.
    pub fn close(
        &mut self,
        hand: usize,
        now: Nanos,
        id: Option<CommandId>,
        grasping: bool,
        physics: &mut PhysicsAdapter,
    ) -> Option<CommandId> {
        let h = &mut self.hands[hand];
        h.grasping = grasping;
        h.run_fingers(1.0, physics);
        let until = now + h.delay;
        replace(&mut h.phase, GripPhase::Closing { until, id })
    }

    /// Tells a hand to open; gives the command that this one replaces.
    pub fn open(
        &mut self,
        hand: usize,
        now: Nanos,
        id: Option<CommandId>,
        physics: &mut PhysicsAdapter,
    ) -> Option<CommandId> {
        let h = &mut self.hands[hand];
        h.grasping = false;
        if !h.fingers.is_empty() {
            // Fingers that part no longer hold.
            h.run_fingers(-1.0, physics);
            self.release(hand, physics);
        }
        let h = &mut self.hands[hand];
        let until = now + h.delay;
        replace(&mut h.phase, GripPhase::Opening { until, id })
    }

    /// What the hands do at the end of a step, in the order of the grippers.
    ///
    /// Gives the palms of people that are to go on towards what they would hold, and by how much, m.
    pub fn update(
        &mut self,
        now: Nanos,
        step: Nanos,
        physics: &mut PhysicsAdapter,
        finished: &mut FinishedCommands,
    ) -> Vec<(BodyId, SpaceVector)> {
        let mut reaching = Vec::new();
        for i in 0..self.hands.len() {
            self.hands[i].keep_together(physics);
            match self.hands[i].phase {
                GripPhase::Closing { until, id } => {
                    if self.hands[i].has_closed(now, until, physics) {
                        self.hands[i].phase = GripPhase::Closed;
                        self.take(i, physics);
                        finished.extend(id.map(|id| (id, Ok(()))));
                    }
                }
                GripPhase::Opening { until, id } => {
                    if self.hands[i].has_opened(now, until, physics) {
                        self.hands[i].phase = GripPhase::Open;
                        self.release(i, physics);
                        finished.extend(id.map(|id| (id, Ok(()))));
                    }
                }
                // What slipped, or was pressed late, is held when it lies still.
                GripPhase::Closed if self.hands[i].grasping || !self.hands[i].fingers.is_empty() => {
                    self.take(i, physics);
                }
                GripPhase::Open | GripPhase::Closed => {}
            }
            self.let_slip(i, physics);
            let hand = &self.hands[i];
            if hand.held.is_some_and(|b| hand.distance(b, physics) > hand.reach + SLACK) {
                self.release(i, physics);
            }
            reaching.extend(self.hands[i].reaches(step, physics));
        }
        reaching
    }

    /// What is heavier than friction can bear leaves the hand.
    fn let_slip(&mut self, hand: usize, physics: &mut PhysicsAdapter) {
        let held = &mut self.hands[hand];
        let Some(joint) = held.joint else { return };
        let (force, torque) = physics.borne(joint);
        let bears = 2.0 * FRICTION * held.force;
        held.overloaded = if force > bears || torque > bears * PAD { held.overloaded + 1 } else { 0 };
        if held.overloaded >= SLIPS_AFTER {
            held.overloaded = 0;
            self.release(hand, physics);
            self.hands[hand].run_fingers(1.0, physics);
        }
    }

    fn take(&mut self, hand: usize, physics: &mut PhysicsAdapter) {
        if self.hands[hand].held.is_some() {
            return;
        }
        if let Some(body) = self.hands[hand].choose(physics) {
            // From here on the joint stands for the fingers' force, which they keep up.
            self.hands[hand].run_fingers(0.0, physics);
            self.hands[hand].held = Some(body);
            physics.hold(self.hands[hand].palm, body, true);
            self.taken[index(body)] = true;
            self.rejoin(body, physics);
        }
    }

    fn release(&mut self, hand: usize, physics: &mut PhysicsAdapter) {
        let hand = &mut self.hands[hand];
        if let Some(joint) = hand.joint.take() {
            physics.detach(hand.palm, joint);
        }
        if let Some(body) = hand.held.take() {
            physics.hold(hand.palm, body, false);
            self.rejoin(body, physics);
        }
    }

    /// Makes the joints of a body those of the hands that shall lead it.
    fn rejoin(&mut self, body: BodyId, physics: &mut PhysicsAdapter) {
        let holders = || (0..self.hands.len()).filter(|&i| self.hands[i].held == Some(body));
        let motorised = holders().any(|i| self.hands[i].dynamic);
        let first = holders().next();
        for (i, hand) in self.hands.iter_mut().enumerate() {
            let leads = hand.held == Some(body) && if motorised { hand.dynamic } else { first == Some(i) };
            if leads && hand.joint.is_none() {
                hand.joint = Some(physics.attach(hand.palm, body, !self.hung[index(body)]));
            } else if hand.held == Some(body)
                && !leads
                && let Some(joint) = hand.joint.take()
            {
                physics.detach(hand.palm, joint);
            }
        }
    }
}

fn replace(phase: &mut GripPhase, next: GripPhase) -> Option<CommandId> {
    match std::mem::replace(phase, next) {
        GripPhase::Closing { id, .. } | GripPhase::Opening { id, .. } => id,
        GripPhase::Open | GripPhase::Closed => None,
    }
}
