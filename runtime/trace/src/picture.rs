//! A picture of the world over a run: where its bodies were, for looking only. Nothing is ever judged by it.
//!
//! Numbers are whole, so that the same run gives the same picture: places in tenths of a millimetre, parts of quaternions in ten-thousandths
//! (0.01°), joints in ten-thousandths of a radian or a metre, forces in hundredths of a newton. Between two keyframes of a body, what was lies on
//! the straight line; before the first and after the last it rests. A force is in effect until the next keyframe.

use hrdsl_ir::{
    Nanos,
    world::{BodyId, JointId},
};

/// Of a metre, of 1 in a quaternion, and of a radian.
pub const FINE: f64 = 10_000.0;
/// Of a newton.
pub const FORCE: f64 = 100.0;

/// The nearest whole number of `1/scale`.
#[must_use]
pub fn whole(x: f64, scale: f64) -> i64 {
    (x * scale).round() as i64
}

/// All that was seen of the world in a run, each list in the order of its numbers.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WorldPicture {
    /// Of bodies that moved. Those that are rigidly one with another move with it, and are not among them.
    pub bodies: Vec<BodyKeyframes>,
    pub joints: Vec<JointKeyframes>,
    pub contacts: Vec<ContactKeyframes>,
}

impl WorldPicture {
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty() && self.joints.is_empty() && self.contacts.is_empty()
    }
}

/// Where a body was, in order of time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BodyKeyframes {
    pub body: BodyId,
    pub frames: Vec<BodyKeyframe>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BodyKeyframe {
    pub time: Nanos,
    /// x, y, z
    pub place: [i64; 3],
    /// x, y, z, w; each on the near side of the one before.
    pub turn: [i64; 4],
}

/// Where a joint was, in order of time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JointKeyframes {
    pub joint: JointId,
    pub frames: Vec<JointKeyframe>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JointKeyframe {
    pub time: Nanos,
    pub position: i64,
}

/// How two bodies pressed on each other, in order of time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ContactKeyframes {
    pub bodies: [BodyId; 2],
    pub frames: Vec<ContactKeyframe>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ContactKeyframe {
    pub time: Nanos,
    /// In the world.
    pub point: [i64; 3],
    /// On the first of the two; three zeros end the contact.
    pub force: [i64; 3],
}
