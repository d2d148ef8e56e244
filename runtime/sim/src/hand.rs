//! Grippers: which hand holds what, and which of the hands the physics follows.
//!
//! A body may be held by several hands. A hand on a dynamic palm (a robot's) is fixed to what it holds by a joint. A hand
//! on a kinematic palm (a person's) is so fixed only while no dynamic hand, and no kinematic one before it, holds the
//! same body: a moved hand would otherwise win against any motor. Meanwhile it holds in name; when the others let go,
//! the body is fixed to it where it is.

use hrdsl_ir::Nanos;
use hrdsl_ir::world::{BodyId, BodyMotion, Gripper, World};
use rapier3d::prelude::ImpulseJointHandle;

use hrdsl_harness::CommandId;

use crate::{
    error::{CommandError, SimError},
    math::{SpaceVector, v3},
    physics::{PhysicsAdapter, bad, index},
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
    phase: GripPhase,
    /// Takes the first thing it can from now on.
    grasping: bool,
    held: Option<BodyId>,
    joint: Option<ImpulseJointHandle>,
}

enum GripPhase {
    Open,
    Closed,
    Closing { until: Nanos, id: Option<CommandId> },
    Opening { until: Nanos, id: Option<CommandId> },
}

type FinishedCommands = Vec<(CommandId, Result<(), CommandError>)>;

impl GripperHand {
    fn new(gripper: &Gripper, world: &World, physics: &PhysicsAdapter) -> Result<GripperHand, SimError> {
        let what = || format!("gripper `{}`", gripper.name);
        for body in gripper.holds.iter().chain([&gripper.palm]) {
            if index(*body) >= world.bodies.len() {
                return Err(bad(what(), "body", index(*body)));
            }
        }
        let jointed = |b: BodyId| world.joints.iter().any(|j| j.parent == b || j.child == b);
        let unfit = |b: &&BodyId| physics.motion(**b) != BodyMotion::Dynamic || jointed(**b);
        if let Some(body) = gripper.holds.iter().find(unfit) {
            let body = world.bodies[index(*body)].name.clone();
            return Err(SimError::NotHoldable { gripper: gripper.name.clone(), body });
        }
        if !(gripper.reach.is_finite() && gripper.reach >= 0.0 && gripper.delay >= 0) {
            return Err(SimError::BadNumber { what: format!("reach or delay of {}", what()) });
        }
        Ok(GripperHand {
            name: gripper.name.clone(),
            palm: gripper.palm,
            tool: v3(gripper.tool),
            reach: gripper.reach,
            delay: gripper.delay,
            holds: gripper.holds.clone(),
            dynamic: physics.motion(gripper.palm) == BodyMotion::Dynamic,
            phase: GripPhase::Open,
            grasping: false,
            held: None,
            joint: None,
        })
    }

    fn distance(&self, body: BodyId, physics: &PhysicsAdapter) -> f64 {
        physics.distance_to_point(body, physics.pose(self.palm).point(self.tool))
    }

    /// The nearest body in reach; of equally near ones the first.
    fn choose(&self, physics: &PhysicsAdapter) -> Option<BodyId> {
        let mut best: Option<(f64, BodyId)> = None;
        for body in &self.holds {
            let d = self.distance(*body, physics);
            if d <= self.reach && best.is_none_or(|(b, _)| d < b) {
                best = Some((d, *body));
            }
        }
        best.map(|(_, body)| body)
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
}

impl HandSet {
    pub fn new(world: &World, physics: &PhysicsAdapter) -> Result<HandSet, SimError> {
        let hands = world.grippers.iter().map(|g| GripperHand::new(g, world, physics));
        Ok(HandSet { hands: hands.collect::<Result<_, _>>()?, taken: vec![false; world.bodies.len()] })
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

    pub fn was_taken(&self, body: BodyId) -> bool {
        self.taken[index(body)]
    }

    pub fn is_busy(&self) -> bool {
        self.hands.iter().any(GripperHand::is_busy)
    }

    /// Tells a hand to close; gives the command that this one replaces.
    pub fn close(
        &mut self,
        hand: usize,
        now: Nanos,
        id: Option<CommandId>,
        grasping: bool,
    ) -> Option<CommandId> {
        let h = &mut self.hands[hand];
        h.grasping = grasping;
        let until = now + h.delay;
        replace(&mut h.phase, GripPhase::Closing { until, id })
    }

    /// Tells a hand to open; gives the command that this one replaces.
    pub fn open(&mut self, hand: usize, now: Nanos, id: Option<CommandId>) -> Option<CommandId> {
        let h = &mut self.hands[hand];
        h.grasping = false;
        let until = now + h.delay;
        replace(&mut h.phase, GripPhase::Opening { until, id })
    }

    /// What the hands do at the end of a step, in the order of the grippers.
    pub fn update(&mut self, now: Nanos, physics: &mut PhysicsAdapter, finished: &mut FinishedCommands) {
        for i in 0..self.hands.len() {
            match self.hands[i].phase {
                GripPhase::Closing { until, id } if now >= until => {
                    self.hands[i].phase = GripPhase::Closed;
                    self.take(i, physics);
                    finished.extend(id.map(|id| (id, Ok(()))));
                }
                GripPhase::Opening { until, id } if now >= until => {
                    self.hands[i].phase = GripPhase::Open;
                    self.release(i, physics);
                    finished.extend(id.map(|id| (id, Ok(()))));
                }
                GripPhase::Closed if self.hands[i].grasping => self.take(i, physics),
                GripPhase::Open
                | GripPhase::Closed
                | GripPhase::Closing { .. }
                | GripPhase::Opening { .. } => {}
            }
            let hand = &self.hands[i];
            if hand.held.is_some_and(|b| hand.distance(b, physics) > hand.reach + SLACK) {
                self.release(i, physics);
            }
        }
    }

    fn take(&mut self, hand: usize, physics: &mut PhysicsAdapter) {
        if self.hands[hand].held.is_some() {
            return;
        }
        if let Some(body) = self.hands[hand].choose(physics) {
            self.hands[hand].held = Some(body);
            self.taken[index(body)] = true;
            self.rejoin(body, physics);
        }
    }

    fn release(&mut self, hand: usize, physics: &mut PhysicsAdapter) {
        let hand = &mut self.hands[hand];
        if let Some(joint) = hand.joint.take() {
            physics.detach(joint);
        }
        if let Some(body) = hand.held.take() {
            self.rejoin(body, physics);
        }
    }

    /// Makes the joints of a body those of the hands that shall lead it.
    fn rejoin(&mut self, body: BodyId, physics: &mut PhysicsAdapter) {
        let holders = || (0..self.hands.len()).filter(|&i| self.hands[i].held == Some(body));
        let motorised = holders().any(|i| self.hands[i].dynamic);
        let first = holders().next();
        physics.set_held(body, first.is_some(), motorised);
        for (i, hand) in self.hands.iter_mut().enumerate() {
            let leads = hand.held == Some(body) && if motorised { hand.dynamic } else { first == Some(i) };
            if leads && hand.joint.is_none() {
                hand.joint = Some(physics.attach(hand.palm, body));
            } else if hand.held == Some(body)
                && !leads
                && let Some(joint) = hand.joint.take()
            {
                physics.detach(joint);
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
