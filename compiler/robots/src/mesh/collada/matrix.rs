//! Affine maps of COLLADA's nodes: four by four, row by row.

use crate::space::transform::{RigidTransform, RobotVector, dot};

/// Three rows of four; the fourth row is 0 0 0 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct AffineMap {
    pub rows: [[f64; 4]; 3],
}

impl AffineMap {
    pub fn scale([x, y, z]: RobotVector) -> Self {
        Self { rows: [[x, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], [0.0, 0.0, z, 0.0]] }
    }

    pub fn translate([x, y, z]: RobotVector) -> Self {
        Self { rows: [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z]] }
    }

    /// Degrees about an axis of any length.
    pub fn rotate([x, y, z, degrees]: [f64; 4]) -> Self {
        let length = libm::sqrt(dot([x, y, z], [x, y, z]));
        if length == 0.0 {
            return Self::scale([1.0; 3]);
        }
        let turn = RigidTransform::about_axis([x / length, y / length, z / length], degrees.to_radians());
        Self { rows: turn.rotation.map(|[a, b, c]| [a, b, c, 0.0]) }
    }

    /// `other` first, then this.
    pub fn after(&self, other: &Self) -> Self {
        let [p, q, r] = other.rows;
        let row = |[a, b, c, d]: [f64; 4]| {
            let sum = |x: f64, y: f64, z: f64| a * x + b * y + c * z;
            [sum(p[0], q[0], r[0]), sum(p[1], q[1], r[1]), sum(p[2], q[2], r[2]), sum(p[3], q[3], r[3]) + d]
        };
        Self { rows: self.rows.map(row) }
    }

    pub fn place(&self, point: RobotVector) -> RobotVector {
        self.rows.map(|[a, b, c, d]| dot([a, b, c], point) + d)
    }

    /// Whether it turns things inside out.
    pub fn mirrors(&self) -> bool {
        let [[a, b, c, _], [d, e, f, _], [g, h, i, _]] = self.rows;
        a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g) < 0.0
    }
}
