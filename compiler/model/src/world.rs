//! The resolved world: parts instantiated, bodies by id. Devices and figures are those of the Program already; bodies and joints are
//! still in the coordinates of their part, with its frame, since others are placed by them.

use hrdsl_ir::{
    device::DeviceBody,
    sensor::ImperfectSensor,
    solid::{SharedData, SolidBody},
    world::{Arm, Base, DeviceId, Figure, Gripper, JointDrive, JointMotion, Laser, Limb},
};
use hrdsl_source::Span;
use serde::Serialize;

use crate::{ActorId, BodyId, BodyMotion, BodyShape, CurrentBody, Type, TypedExpr, TypedWorldRule};

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TypedWorld {
    /// Seconds.
    pub step: f64,
    pub sample: f64,
    pub gravity: [f64; 3],
    pub bodies: Vec<TypedBody>,
    pub joints: Vec<TypedJoint>,
    pub arms: Vec<Arm>,
    pub grippers: Vec<Gripper>,
    pub bases: Vec<Base>,
    pub lasers: Vec<Laser>,
    /// Those that figures have, and those that none has.
    pub limbs: Vec<Limb>,
    pub figures: Vec<Figure>,
    pub currents: Vec<CurrentBody>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sensors: Vec<ImperfectSensor>,
    pub signals: Vec<TypedSignal>,
    pub rules: Vec<TypedWorldRule>,
    /// The parts that are put into it; what they are made of is in the lists above.
    #[serde(skip)]
    pub parts: Vec<PartInstance>,
    pub span: Span,
}

impl TypedWorld {
    /// A device's place among all of the world: the arms, then the grippers, the bases, the lasers.
    #[must_use]
    pub fn device_id(&self, body: DeviceBody) -> DeviceId {
        let (before, own) = match body {
            DeviceBody::Arm(arm) => (0, arm.0),
            DeviceBody::Gripper(gripper) => (self.arms.len(), gripper.0),
            DeviceBody::Base(base) => (self.arms.len() + self.grippers.len(), base.0),
            DeviceBody::Laser(laser) => (self.arms.len() + self.grippers.len() + self.bases.len(), laser.0),
        };
        DeviceId(u16::try_from(before).unwrap_or(u16::MAX).saturating_add(own))
    }
}

/// A part that is put somewhere.
#[derive(Clone, Debug, PartialEq)]
pub struct PartInstance {
    /// `left.hand`
    pub name: String,
    pub frame: PartFrame,
    /// Where it is in the part that it is in.
    pub inner: PartFrame,
    pub span: Span,
}

/// Where a part's coordinates lie in the world: turned about z by `yaw`, then moved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PartFrame {
    pub at: [f64; 3],
    pub yaw: f64,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TypedBody {
    /// `robot.palm`
    pub name: String,
    pub motion: BodyMotion,
    pub shape: BodyShape,
    pub frame: PartFrame,
    pub position: [f64; 3],
    pub rotation: [f64; 3],
    pub mass: f64,
    /// N/m
    pub stiffness: Option<f64>,
    pub ghost: bool,
    pub graspable: bool,
    pub solid: Option<SharedData<SolidBody>>,
    /// What its description calls it, if that is not the end of its name.
    pub own_name: Option<String>,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TypedJoint {
    pub name: String,
    pub parent: BodyId,
    pub child: BodyId,
    pub frame: PartFrame,
    pub anchor: [f64; 3],
    /// Not zero; not yet of length 1.
    pub axis: [f64; 3],
    pub motion: JointMotion,
    /// rad of a hinge, m of a slider
    pub lo: f64,
    pub hi: f64,
    pub drive: JointDrive,
    /// What its description calls it, if that is not the end of its name.
    pub own_name: Option<String>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TypedSignal {
    pub name: String,
    pub ty: Type,
    pub to: Vec<ActorId>,
    /// Over terms and earlier signals.
    pub value: TypedExpr,
    pub span: Span,
}

impl PartFrame {
    /// A direction of the part, in the world.
    #[must_use]
    pub fn turn(self, v: [f64; 3]) -> [f64; 3] {
        let (sin, cos) = sin_cos(self.yaw);
        [cos * v[0] - sin * v[1], sin * v[0] + cos * v[1], v[2]]
    }

    /// A place of the part, in the world.
    #[must_use]
    pub fn place(self, v: [f64; 3]) -> [f64; 3] {
        let turned = self.turn(v);
        [self.at[0] + turned[0], self.at[1] + turned[1], self.at[2] + turned[2]]
    }
}

/// Sine and cosine by power series on an eighth of a turn: the same bits on every platform, exact at quarter turns.
#[must_use]
pub fn sin_cos(angle: f64) -> (f64, f64) {
    let quarter = std::f64::consts::FRAC_PI_2;
    let turns = (angle / quarter).round();
    let x = angle - turns * quarter;
    let series = |mut term: f64, mut n: f64| {
        let mut sum = 0.0;
        // The 12th term is below 1e-20 for |x| <= π/4.
        for _ in 0..12 {
            sum += term;
            term *= -x * x / ((n + 1.0) * (n + 2.0));
            n += 2.0;
        }
        sum
    };
    let (sin, cos) = (series(x, 1.0), series(1.0, 0.0));
    match turns.rem_euclid(4.0) as u8 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn quarter_turns_are_exact() {
        let turned = |k: f64| PartFrame { at: [1.0, 2.0, 3.0], yaw: k * FRAC_PI_2 }.place([0.5, 0.25, 0.125]);
        assert_eq!(turned(0.0), [1.5, 2.25, 3.125]);
        assert_eq!(turned(1.0), [0.75, 2.5, 3.125]);
        assert_eq!(turned(2.0), [0.5, 1.75, 3.125]);
        assert_eq!(turned(-1.0), [1.25, 1.5, 3.125]);
    }

    proptest! {
        #[test]
        #[allow(clippy::disallowed_methods, reason = "the platform's own is the oracle here")]
        fn sin_cos_agree_with_the_platform(angle in -20.0f64..20.0) {
            let (sin, cos) = sin_cos(angle);
            prop_assert!((sin - angle.sin()).abs() < 1e-14);
            prop_assert!((cos - angle.cos()).abs() < 1e-14);
        }
    }
}
