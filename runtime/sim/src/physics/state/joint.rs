//! A joint of the engine, with what its motor does.

use hrdsl_ir::world::{BodyId, JointMotion};
use rapier3d::prelude::*;

use super::place::JointPlace;
use crate::math::SpaceVector;

/// How a joint holds its two sides together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointHold {
    Firm,
    /// A blow, which a light tip takes from what is heavy: the solver does more for it, since so many parts of a step.
    Strained {
        parts: u8,
    },
    /// Its sides are far apart, and nothing helps.
    Torn,
}

/// What strains a joint for longer than so many parts of a step is no blow, but led whatever is in its way.
const BLOW: u8 = 20;

impl JointHold {
    /// How it holds next: its sides may be far apart, or it be strained.
    pub fn next(self, is_apart: bool, is_strained: bool) -> JointHold {
        match self {
            _ if !is_apart && !is_strained => JointHold::Firm,
            JointHold::Firm if is_strained => JointHold::Strained { parts: 1 },
            JointHold::Strained { parts } if parts < BLOW => JointHold::Strained { parts: parts + 1 },
            _ if is_apart => JointHold::Torn,
            // Not before it has recovered is there another blow.
            JointHold::Firm | JointHold::Strained { .. } | JointHold::Torn => {
                JointHold::Strained { parts: BLOW }
            }
        }
    }

    /// Whether the solver is to do more.
    pub fn takes_blow(self) -> bool {
        matches!(self, JointHold::Strained { parts } if parts < BLOW)
    }
}

/// A joint of the engine.
pub(crate) struct DrivenJoint {
    pub name: String,
    pub handle: ImpulseJointHandle,
    pub parent: RigidBodyHandle,
    pub child: RigidBodyHandle,
    /// What bears the torque of a hinge's motor: the parent, or what that slides on. It cannot turn against it, so that it is the same,
    /// but for the solver, which would have to hand on what a light torso cannot bear.
    pub bearer: RigidBodyHandle,
    pub motion: JointMotion,
    /// At the start, in the world.
    pub axis: SpaceVector,
    pub anchor: SpaceVector,
    /// The numbers of parent and child among the bodies that joints are on, and where it is now.
    pub bodies: [usize; 2],
    pub place: JointPlace,
    /// What it carries: bodies on the child's side.
    pub carried: Vec<RigidBodyHandle>,
    /// Its child is the last of a chain, such as a finger, and light.
    pub is_tip: bool,
    /// The most that its motor can do, and what it does.
    pub limit: f64,
    pub effort: f64,
    /// Where it is at the start, and its limits, rad or m.
    pub start: f64,
    pub lo: f64,
    pub hi: f64,
    /// Of a hinge that may turn farther than half round: where it was last.
    pub wound: Option<f64>,
    /// The engine's frame on the parent, with its zero at the start; and where such a hinge is stopped.
    pub first_frame: Pose,
    pub stop: JointStop,
    pub ends: ToldEnds,
    /// How the solver mends what has come apart at it; and whether it has come so far apart that it gives way.
    pub softness: SpringCoefficients<f32>,
    /// Whether that is as fast in short parts of a step as in long ones.
    pub keeps_rate: bool,
    pub hold: JointHold,
    /// What its robot stands on, if that can fall.
    pub loose: Option<BodyId>,
    /// The engine's motor runs it.
    pub is_run: bool,
}

/// Between which ends the engine keeps a joint, and what that rests on.
pub(crate) struct ToldEnds {
    /// From its start, rad or m: where it is to be kept, and what the engine was told last, which may be earlier.
    pub kept: (f64, f64),
    pub between: (f64, f64),
    /// How fast it was as the last part of a step began, rad/s or m/s, and how long that part took, s.
    pub last: (f64, f64),
    /// How far it was beyond one of those where it is to be kept as the last step ended, rad or m; less than 0 within them.
    pub beyond: f64,
}

impl ToldEnds {
    /// Of a joint that stands still before the first step, which takes so long, s.
    pub fn at_start(kept: (f64, f64), step: f64) -> ToldEnds {
        ToldEnds { kept, between: kept, last: (0.0, step), beyond: 0.0 }
    }

    /// Whether it was near one of its ends, or beyond it, as the last step ended.
    pub fn is_near(&self) -> bool {
        self.beyond > -NEAR_END
    }
}

/// A joint is near its end, rad or m.
const NEAR_END: f64 = 1e-3;
/// How far from its zero the engine can limit a hinge, rad.
const MOST_LIMIT: f64 = 3.1;
/// So near to an end a hinge of more than a turn is stopped there, rad: less than half a turn, and more than any goes in a step.
const STOP_NEAR: f64 = 1.5;

/// Where the engine stops a hinge that may turn farther than half round: it is told of limits about a zero of its own, and of one end at
/// a time if they are more than a turn apart. Angles count from the start, rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum JointStop {
    /// Both ends are within half a turn of the middle: the middle, and how far they are from it.
    Both {
        middle: f64,
        half: f64,
    },
    Low(f64),
    High(f64),
    /// Neither is near.
    Nowhere,
}

impl JointStop {
    /// Of a hinge that is at `way` and ends at `lo` and `hi`.
    pub fn about(way: f64, lo: f64, hi: f64) -> JointStop {
        let (middle, half) = (f64::midpoint(lo, hi), (hi - lo) / 2.0);
        if half < MOST_LIMIT {
            JointStop::Both { middle, half }
        } else if way - lo < STOP_NEAR {
            JointStop::Low(lo)
        } else if hi - way < STOP_NEAR {
            JointStop::High(hi)
        } else {
            JointStop::Nowhere
        }
    }

    /// Whether the engine's own zero, at the start, will do.
    pub fn is_plain(lo: f64, hi: f64) -> bool {
        lo > -MOST_LIMIT && hi < MOST_LIMIT
    }

    /// Tells a joint of the engine, whose frame on the parent has its zero at the start, that it ends at `lo` and `hi`.
    pub fn set(self, joint: &mut GenericJoint, first_frame: &Pose, ends: (f64, f64)) {
        let zero = match self {
            JointStop::Both { middle, .. } => middle,
            JointStop::Low(lo) => lo,
            JointStop::High(hi) => hi,
            JointStop::Nowhere => {
                joint.limit_axes.remove(JointAxesMask::ANG_X);
                return;
            }
        };
        // The function of the engine's quaternions differs between platforms.
        let (sin, cos) = libm::sincos(zero / 2.0);
        let turn = Rotation::from_xyzw(sin as f32, 0.0, 0.0, cos as f32);
        joint.local_frame1 = Pose::from_parts(first_frame.translation, first_frame.rotation * turn);
        self.limit(joint, ends);
    }

    /// Tells a joint of the engine, which knows the stop's zero, that it ends at `lo` and `hi`.
    pub fn limit(self, joint: &mut GenericJoint, (lo, hi): (f64, f64)) {
        let limits = match self {
            JointStop::Both { middle, .. } => [lo - middle, hi - middle],
            JointStop::Low(zero) => [lo - zero, MOST_LIMIT],
            JointStop::High(zero) => [-MOST_LIMIT, hi - zero],
            JointStop::Nowhere => return,
        };
        joint.set_limits(JointAxis::AngX, limits.map(|end| end as f32));
    }
}
