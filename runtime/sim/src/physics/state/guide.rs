//! Guided bodies: what draws the body of somebody alive to where it is to be.
//!
//! A spring with a damper, whose force is limited, and a force that gives the body the acceleration of its aim: a body that nothing
//! touches is where it is to be, to the precision of the engine; one that is pushed gives way, with the mass that a contact feels. It
//! turns as it is to, as long as nothing keeps it from that.

use hrdsl_ir::world::Body;
use rapier3d::prelude::*;

use crate::math::{BodyFrame, RotationQuat, SpaceVector};

/// How fast a body is drawn back, 1/s: four times a second, if its surface is not soft.
const FREQUENCY: f64 = 25.0;
/// How stiff its spring is beside its surface: a blow is over before the spring takes part in it.
const BESIDE_SURFACE: f64 = 0.05;
/// Of what is critical.
const DAMPING: f64 = 0.7;
/// With how much a body is drawn at most, N, and how much more for each kg: a hand pushes with less than a trunk.
const STRENGTH: f64 = 60.0;
const STRENGTH_PER_MASS: f64 = 8.0;
/// How fast a body of a figure gets to the speed of its aim, m/s²: no muscle throws a limb off faster.
const QUICKEST: f64 = 20.0;
/// Nearer than this it is there, m, and slower than this it stands, m/s.
const THERE: f64 = 1e-6;
const STILL: f64 = 1e-5;
/// The fastest turn, rad/s.
const FASTEST_TURN: f64 = 20.0;

/// What draws one body.
pub struct BodyGuide {
    pub mass: f64,
    pub spring: f64,
    pub damper: f64,
    pub strength: f64,
    /// How fast it gets to the speed of its aim, m/s².
    pub quickest: f64,
    /// Where it was to be when the step began, and is to be at its end.
    pub from: BodyFrame,
    pub to: BodyFrame,
    /// The speed of its aim in the last step, m/s.
    pub pace: SpaceVector,
    /// What it carries, kg.
    pub load: f64,
    /// Where the body was, and was to be, as nothing had to be done, and nothing would change.
    at_rest: Option<(Pose, BodyFrame)>,
}

/// A part of a step: how much of the step is over when it begins, its time, and that of the step, s.
#[derive(Clone, Copy, Debug)]
pub struct StepPart {
    pub done: f64,
    pub h: f64,
    pub dt: f64,
}

impl BodyGuide {
    /// A body of a figure gets to its speed as muscles do; one that is led alone follows its aim at once.
    pub fn new(body: &Body, start: BodyFrame, has_muscles: bool) -> Self {
        let (mass, stiffness) = (body.mass, body.stiffness);
        let own = mass * FREQUENCY * FREQUENCY;
        let spring = stiffness.map_or(own, |k| own.min(BESIDE_SURFACE * k));
        BodyGuide {
            mass,
            spring,
            damper: 2.0 * DAMPING * (spring * mass).sqrt(),
            strength: STRENGTH + STRENGTH_PER_MASS * mass,
            quickest: if has_muscles { QUICKEST } else { f64::INFINITY },
            from: start,
            to: start,
            pace: SpaceVector::zeros(),
            load: 0.0,
            at_rest: None,
        }
    }

    /// Whether body and aim are where nothing has to be done, as was found before.
    pub fn rests(&self, body: &RigidBody) -> bool {
        self.at_rest
            .as_ref()
            .is_some_and(|(pose, aim)| pose == body.position() && self.to.is_same(aim) && self.is_still(body))
    }

    /// Takes down whether anything had to be done to the body.
    pub fn note_rest(&mut self, body: &RigidBody, is_drawn: bool) {
        let rests = !is_drawn && self.is_still(body);
        self.at_rest = rests.then(|| (*body.position(), self.to));
    }

    /// Whether neither the body nor its aim moves: what is done to it then is the same in each part of a step.
    fn is_still(&self, body: &RigidBody) -> bool {
        self.from.is_same(&self.to)
            && self.pace == SpaceVector::zeros()
            && self.load == 0.0
            && body.linvel() == Vector::ZERO
            && body.angvel() == AngVector::ZERO
    }

    /// The impulse over a part of a step on the body, which is there (m) and goes so (m/s): N·s.
    pub fn impulse(
        &self,
        at: SpaceVector,
        speed: SpaceVector,
        weight: SpaceVector,
        part: StepPart,
    ) -> SpaceVector {
        let pace = (self.to.at - self.from.at) / part.dt;
        let (before, ahead) =
            if part.done == 0.0 { (self.pace, pace - self.pace) } else { (pace, SpaceVector::zeros()) };
        let aim = self.from.at + (self.to.at - self.from.at) * part.done;
        let (behind, slow) = (aim - at, before - speed);
        // What is there and stands is left alone, so that it can rest.
        let may_be_there = behind.norm_squared() < 4.0 * THERE * THERE;
        if may_be_there
            && behind.norm() < THERE
            && slow.norm() < STILL
            && ahead.norm() == 0.0
            && self.load == 0.0
        {
            return SpaceVector::zeros();
        }
        // The spring alone is limited, too: who comes free from far behind is damped, and does not shoot back.
        let pull = limited(behind * self.spring, self.strength) + slow * self.damper;
        let pull = limited(pull, self.strength);
        let ahead = limited(ahead, self.quickest * part.dt);
        ahead * (self.mass + self.load) + (pull - weight * self.load) * part.h
    }

    /// The turn that brings the body, which is turned so, to its aim at the end of the step, rad/s.
    pub fn turn(&self, now: &RotationQuat, part: StepPart) -> SpaceVector {
        let left = (1.0 - part.done) * part.dt;
        let turn = turn_between(now, &self.to.turn) / left;
        let size = turn.norm();
        if size > FASTEST_TURN { turn * (FASTEST_TURN / size) } else { turn }
    }
}

/// The vector, no longer than so much.
fn limited(v: SpaceVector, most: f64) -> SpaceVector {
    // Mostly it is far from that: a root would be drawn for nothing.
    if v.norm_squared() < 0.9 * most * most {
        return v;
    }
    let size = v.norm();
    if size > most { v * (most / size) } else { v }
}

/// The rotation vector that turns one rotation into the other, rad.
fn turn_between(from: &RotationQuat, to: &RotationQuat) -> SpaceVector {
    let between = to * from.inverse();
    let (w, v) = (between.w, SpaceVector::new(between.i, between.j, between.k));
    let (w, v) = if w < 0.0 { (-w, -v) } else { (w, v) };
    let size = v.norm();
    // Below this the engine's own precision turns nothing.
    if size < 1e-7 { SpaceVector::zeros() } else { v * (2.0 * libm::atan2(size, w) / size) }
}
