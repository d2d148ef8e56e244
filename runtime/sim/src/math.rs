//! Rotations and poses in double precision, and the way to and from the physics engine's single precision.
//!
//! Angles go through `libm`, whose results do not depend on the platform.

use hrdsl_ir::world::Vec3;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use rapier3d::math::{Pose, Rotation, Vector};

pub(crate) type SpaceVector = Vector3<f64>;
pub(crate) type RotationQuat = UnitQuaternion<f64>;

/// A rigid motion, or where a body is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BodyFrame {
    pub at: SpaceVector,
    pub turn: RotationQuat,
}

impl BodyFrame {
    pub fn new(at: SpaceVector, turn: RotationQuat) -> Self {
        BodyFrame { at, turn }
    }

    /// Whether it is the very same to the last bit; a quaternion equals its negative otherwise.
    pub fn is_same(&self, other: &BodyFrame) -> bool {
        self.at == other.at && self.turn.coords == other.turn.coords
    }

    pub fn point(&self, p: SpaceVector) -> SpaceVector {
        self.at + self.turn * p
    }

    pub fn inverse(&self) -> BodyFrame {
        let turn = self.turn.inverse();
        BodyFrame { at: -(turn * self.at), turn }
    }

    pub fn then(&self, next: &BodyFrame) -> BodyFrame {
        BodyFrame { at: self.point(next.at), turn: self.turn * next.turn }
    }

    pub fn x_axis(&self) -> SpaceVector {
        self.turn * SpaceVector::x()
    }
}

pub(crate) fn v3(v: Vec3) -> SpaceVector {
    SpaceVector::new(v[0], v[1], v[2])
}

pub(crate) fn arr(v: SpaceVector) -> Vec3 {
    [v.x, v.y, v.z]
}

pub(crate) fn about(axis: SpaceVector, angle: f64) -> RotationQuat {
    let (s, c) = (libm::sin(angle / 2.0), libm::cos(angle / 2.0));
    UnitQuaternion::new_normalize(Quaternion::new(c, axis.x * s, axis.y * s, axis.z * s))
}

/// Roll, pitch, yaw about the fixed axes.
pub(crate) fn from_rpy(rpy: Vec3) -> RotationQuat {
    about(SpaceVector::z(), rpy[2]) * about(SpaceVector::y(), rpy[1]) * about(SpaceVector::x(), rpy[0])
}

/// The angle of a rotation about a (unit) axis: its twist, -π..π.
pub(crate) fn twist(q: &RotationQuat, axis: &SpaceVector) -> f64 {
    let along = q.i * axis.x + q.j * axis.y + q.k * axis.z;
    let angle = 2.0 * libm::atan2(along, q.w);
    wrap(angle)
}

/// The same direction within -π..π.
pub(crate) fn wrap(angle: f64) -> f64 {
    let turn = 2.0 * std::f64::consts::PI;
    if angle > std::f64::consts::PI {
        angle - turn
    } else if angle < -std::f64::consts::PI {
        angle + turn
    } else {
        angle
    }
}

/// Between two vectors, 0..π; 0 if one of them is null.
pub(crate) fn angle_between(a: &SpaceVector, b: &SpaceVector) -> f64 {
    let cross = a.cross(b).norm();
    let dot = a.dot(b);
    if cross == 0.0 && dot == 0.0 { 0.0 } else { libm::atan2(cross, dot) }
}

pub(crate) fn to_vector(v: SpaceVector) -> Vector {
    Vector::new(v.x as f32, v.y as f32, v.z as f32)
}

pub(crate) fn from_vector(v: Vector) -> SpaceVector {
    SpaceVector::new(f64::from(v.x), f64::from(v.y), f64::from(v.z))
}

pub(crate) fn to_pose(f: &BodyFrame) -> Pose {
    let q = f.turn;
    let turn = Rotation::from_xyzw(q.i as f32, q.j as f32, q.k as f32, q.w as f32);
    Pose::from_parts(to_vector(f.at), turn)
}

pub(crate) fn from_pose(p: &Pose) -> BodyFrame {
    let r = p.rotation;
    let q = Quaternion::new(f64::from(r.w), f64::from(r.x), f64::from(r.y), f64::from(r.z));
    BodyFrame { at: from_vector(p.translation), turn: UnitQuaternion::new_normalize(q) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn yaw_turns_x_to_y() {
        let y = from_rpy([0.0, 0.0, FRAC_PI_2]) * SpaceVector::x();
        assert!((y - SpaceVector::y()).norm() < 1e-12);
    }

    #[test]
    fn roll_comes_before_yaw() {
        let v = from_rpy([FRAC_PI_2, 0.0, FRAC_PI_2]) * SpaceVector::y();
        assert!((v - SpaceVector::z()).norm() < 1e-12, "{v}");
    }

    #[test]
    fn twist_is_the_angle_about_the_axis() {
        for angle in [-3.0, -1.0, 0.0, 0.2, 3.1] {
            assert!((twist(&about(SpaceVector::z(), angle), &SpaceVector::z()) - angle).abs() < 1e-12);
            assert!((twist(&about(SpaceVector::z(), angle), &-SpaceVector::z()) + angle).abs() < 1e-12);
        }
    }

    #[test]
    fn angles_are_between_0_and_pi() {
        assert!((angle_between(&SpaceVector::x(), &-SpaceVector::x()) - PI).abs() < 1e-12);
        assert!((angle_between(&SpaceVector::x(), &SpaceVector::y()) - FRAC_PI_2).abs() < 1e-12);
        assert!(angle_between(&SpaceVector::x(), &SpaceVector::zeros()).abs() < 1e-12);
    }

    #[test]
    fn a_frame_and_its_inverse_cancel() {
        let f = BodyFrame::new(SpaceVector::new(1.0, 2.0, 3.0), from_rpy([0.3, -0.4, 1.2]));
        let p = SpaceVector::new(-0.1, 0.2, 0.7);
        assert!((f.inverse().point(f.point(p)) - p).norm() < 1e-12);
        assert!((f.then(&f.inverse()).at).norm() < 1e-12);
    }
}
