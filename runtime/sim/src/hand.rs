//! Grippers: which hand holds what, and which of the hands the physics follows.
//!
//! A body may be held by several hands. A hand on a dynamic palm (a robot's) is fixed to what it holds by a joint. A hand
//! on a kinematic palm (a person's) is so fixed only while no dynamic hand, and no kinematic one before it, holds the
//! same body: a moved hand would otherwise win against any motor. Meanwhile it holds in name; when the others let go,
//! the body is fixed to it where it is.

use hrdsl_ir::Nanos;
use hrdsl_ir::world::{BodyId, Gripper, Motion, World};
use rapier3d::prelude::ImpulseJointHandle;

use crate::command::CommandId;
use crate::error::{CommandError, SimError};
use crate::math::{V3, v3};
use crate::stage::{Stage, bad, index};

/// Beyond its reach by this much (m), a hand loses what it holds.
const SLACK: f64 = 0.05;

pub(crate) struct Hand {
    pub name: String,
    palm: BodyId,
    tool: V3,
    reach: f64,
    delay: Nanos,
    holds: Vec<BodyId>,
    dynamic: bool,
    phase: Phase,
    /// Takes the first thing it can from now on.
    grasping: bool,
    held: Option<BodyId>,
    joint: Option<ImpulseJointHandle>,
}

enum Phase {
    Open,
    Closed,
    Closing { until: Nanos, id: Option<CommandId> },
    Opening { until: Nanos, id: Option<CommandId> },
}

type Finished = Vec<(CommandId, Result<(), CommandError>)>;

impl Hand {
    fn new(gripper: &Gripper, world: &World, stage: &Stage) -> Result<Hand, SimError> {
        let what = || format!("gripper `{}`", gripper.name);
        for body in gripper.holds.iter().chain([&gripper.palm]) {
            if index(*body) >= world.bodies.len() {
                return Err(bad(what(), "body", index(*body)));
            }
        }
        let jointed = |b: BodyId| world.joints.iter().any(|j| j.parent == b || j.child == b);
        let unfit = |b: &&BodyId| stage.motion(**b) != Motion::Dynamic || jointed(**b);
        if let Some(body) = gripper.holds.iter().find(unfit) {
            let body = world.bodies[index(*body)].name.clone();
            return Err(SimError::NotHoldable { gripper: gripper.name.clone(), body });
        }
        if !(gripper.reach.is_finite() && gripper.reach >= 0.0 && gripper.delay >= 0) {
            return Err(SimError::BadNumber { what: format!("reach or delay of {}", what()) });
        }
        Ok(Hand {
            name: gripper.name.clone(),
            palm: gripper.palm,
            tool: v3(gripper.tool),
            reach: gripper.reach,
            delay: gripper.delay,
            holds: gripper.holds.clone(),
            dynamic: stage.motion(gripper.palm) == Motion::Dynamic,
            phase: Phase::Open,
            grasping: false,
            held: None,
            joint: None,
        })
    }

    fn distance(&self, body: BodyId, stage: &Stage) -> f64 {
        stage.distance_to_point(body, stage.pose(self.palm).point(self.tool))
    }

    /// The nearest body in reach; of equally near ones the first.
    fn choose(&self, stage: &Stage) -> Option<BodyId> {
        let mut best: Option<(f64, BodyId)> = None;
        for body in &self.holds {
            let d = self.distance(*body, stage);
            if d <= self.reach && best.is_none_or(|(b, _)| d < b) {
                best = Some((d, *body));
            }
        }
        best.map(|(_, body)| body)
    }

    fn is_busy(&self) -> bool {
        matches!(self.phase, Phase::Closing { .. } | Phase::Opening { .. })
    }
}

/// All hands of a world.
pub(crate) struct Hands {
    hands: Vec<Hand>,
    /// By body: whether any hand has ever taken it.
    taken: Vec<bool>,
}

impl Hands {
    pub fn new(world: &World, stage: &Stage) -> Result<Hands, SimError> {
        let hands = world.grippers.iter().map(|g| Hand::new(g, world, stage));
        Ok(Hands { hands: hands.collect::<Result<_, _>>()?, taken: vec![false; world.bodies.len()] })
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
        self.hands.iter().any(Hand::is_busy)
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
        replace(&mut h.phase, Phase::Closing { until, id })
    }

    /// Tells a hand to open; gives the command that this one replaces.
    pub fn open(&mut self, hand: usize, now: Nanos, id: Option<CommandId>) -> Option<CommandId> {
        let h = &mut self.hands[hand];
        h.grasping = false;
        let until = now + h.delay;
        replace(&mut h.phase, Phase::Opening { until, id })
    }

    /// What the hands do at the end of a step, in the order of the grippers.
    pub fn update(&mut self, now: Nanos, stage: &mut Stage, finished: &mut Finished) {
        for i in 0..self.hands.len() {
            match self.hands[i].phase {
                Phase::Closing { until, id } if now >= until => {
                    self.hands[i].phase = Phase::Closed;
                    self.take(i, stage);
                    finished.extend(id.map(|id| (id, Ok(()))));
                }
                Phase::Opening { until, id } if now >= until => {
                    self.hands[i].phase = Phase::Open;
                    self.release(i, stage);
                    finished.extend(id.map(|id| (id, Ok(()))));
                }
                Phase::Closed if self.hands[i].grasping => self.take(i, stage),
                Phase::Open | Phase::Closed | Phase::Closing { .. } | Phase::Opening { .. } => {}
            }
            let hand = &self.hands[i];
            if hand.held.is_some_and(|b| hand.distance(b, stage) > hand.reach + SLACK) {
                self.release(i, stage);
            }
        }
    }

    fn take(&mut self, hand: usize, stage: &mut Stage) {
        if self.hands[hand].held.is_some() {
            return;
        }
        if let Some(body) = self.hands[hand].choose(stage) {
            self.hands[hand].held = Some(body);
            self.taken[index(body)] = true;
            self.rejoin(body, stage);
        }
    }

    fn release(&mut self, hand: usize, stage: &mut Stage) {
        let hand = &mut self.hands[hand];
        if let Some(joint) = hand.joint.take() {
            stage.detach(joint);
        }
        if let Some(body) = hand.held.take() {
            self.rejoin(body, stage);
        }
    }

    /// Makes the joints of a body those of the hands that shall lead it.
    fn rejoin(&mut self, body: BodyId, stage: &mut Stage) {
        let holders = || (0..self.hands.len()).filter(|&i| self.hands[i].held == Some(body));
        let motorised = holders().any(|i| self.hands[i].dynamic);
        let first = holders().next();
        stage.set_held(body, first.is_some(), motorised);
        for (i, hand) in self.hands.iter_mut().enumerate() {
            let leads = hand.held == Some(body) && if motorised { hand.dynamic } else { first == Some(i) };
            if leads && hand.joint.is_none() {
                hand.joint = Some(stage.attach(hand.palm, body));
            } else if hand.held == Some(body)
                && !leads
                && let Some(joint) = hand.joint.take()
            {
                stage.detach(joint);
            }
        }
    }
}

fn replace(phase: &mut Phase, next: Phase) -> Option<CommandId> {
    match std::mem::replace(phase, next) {
        Phase::Closing { id, .. } | Phase::Opening { id, .. } => id,
        Phase::Open | Phase::Closed => None,
    }
}
