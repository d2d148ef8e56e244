//! Poses: a rotation and then a displacement.

/// Metres, or a direction.
pub type RobotVector = [f64; 3];

/// Where a frame lies in another: a point `p` of it is `rotation * p + translation` there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidTransform {
    /// Row by row; orthonormal.
    pub rotation: [RobotVector; 3],
    pub translation: RobotVector,
}

impl RigidTransform {
    pub const IDENTITY: Self =
        Self { rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], translation: [0.0; 3] };

    /// An `origin` of URDF: turned about the fixed axes x, y, z, in this order, then displaced. Metres and radians.
    #[must_use]
    pub fn from_origin(xyz: RobotVector, rpy: RobotVector) -> Self {
        let [(sr, cr), (sp, cp), (sy, cy)] = rpy.map(|angle| (libm::sin(angle), libm::cos(angle)));
        let rotation = [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ];
        Self { rotation, translation: xyz }
    }

    /// Turned by an angle about an axis of length 1 through the origin.
    #[must_use]
    pub fn about_axis([x, y, z]: RobotVector, angle: f64) -> Self {
        let (s, c) = (libm::sin(angle), libm::cos(angle));
        let t = 1.0 - c;
        let rotation = [
            [t * x * x + c, t * x * y - s * z, t * x * z + s * y],
            [t * x * y + s * z, t * y * y + c, t * y * z - s * x],
            [t * x * z - s * y, t * y * z + s * x, t * z * z + c],
        ];
        Self { rotation, translation: [0.0; 3] }
    }

    /// Displaced without a turn.
    #[must_use]
    pub fn along(translation: RobotVector) -> Self {
        Self { translation, ..Self::IDENTITY }
    }

    /// `other`, which lies in this frame, as it lies in that in which this frame lies.
    #[must_use]
    pub fn then(&self, other: &Self) -> Self {
        let [[a, b, c], [d, e, f], [g, h, i]] = other.rotation;
        let columns = [[a, d, g], [b, e, h], [c, f, i]].map(|column| self.turned(column));
        let [[a, d, g], [b, e, h], [c, f, i]] = columns;
        Self { rotation: [[a, b, c], [d, e, f], [g, h, i]], translation: self.place(other.translation) }
    }

    /// Where a direction of this frame points.
    #[must_use]
    pub fn turned(&self, direction: RobotVector) -> RobotVector {
        self.rotation.map(|row| dot(row, direction))
    }

    /// Where a point of this frame is.
    #[must_use]
    pub fn place(&self, point: RobotVector) -> RobotVector {
        let ([x, y, z], [a, b, c]) = (self.turned(point), self.translation);
        [x + a, y + b, z + c]
    }

    /// The way back.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let [[a, b, c], [d, e, f], [g, h, i]] = self.rotation;
        let back = Self { rotation: [[a, d, g], [b, e, h], [c, f, i]], translation: [0.0; 3] };
        let [x, y, z] = back.turned(self.translation);
        Self { translation: [-x, -y, -z], ..back }
    }

    /// Roll, pitch and yaw; with the nose straight up or down, roll is 0.
    #[must_use]
    pub fn rpy(&self) -> RobotVector {
        let [[a, b, _], [d, e, _], [g, h, i]] = self.rotation;
        let level = libm::hypot(a, d);
        let pitch = libm::atan2(-g, level);
        if level > 1e-9 {
            [libm::atan2(h, i), pitch, libm::atan2(d, a)]
        } else {
            [0.0, pitch, libm::atan2(-b, e)]
        }
    }

    /// The unit quaternion x, y, z, w of the rotation, whose w is not negative.
    #[must_use]
    pub fn quaternion(&self) -> [f64; 4] {
        let [[a, b, c], [d, e, f], [g, h, i]] = self.rotation;
        // Of the four ways to begin, the one with the largest divisor.
        let candidates = [
            [1.0 + a - e - i, b + d, c + g, h - f],
            [b + d, 1.0 - a + e - i, f + h, c - g],
            [c + g, f + h, 1.0 - a - e + i, d - b],
            [h - f, c - g, d - b, 1.0 + a + e + i],
        ];
        let norm = |q: &[f64; 4]| q.iter().map(|x| x * x).sum::<f64>();
        let best = candidates.into_iter().max_by(|p, q| norm(p).total_cmp(&norm(q)));
        let best = best.unwrap_or([0.0, 0.0, 0.0, 1.0]);
        let length = libm::sqrt(norm(&best));
        let sign = if best[3] < 0.0 { -length } else { length };
        best.map(|x| x / sign)
    }
}

/// The scalar product.
#[must_use]
pub(crate) fn dot([a, b, c]: RobotVector, [x, y, z]: RobotVector) -> f64 {
    a * x + b * y + c * z
}

/// The vector product.
#[must_use]
pub(crate) fn cross([a, b, c]: RobotVector, [x, y, z]: RobotVector) -> RobotVector {
    [b * z - c * y, c * x - a * z, a * y - b * x]
}

pub(crate) fn minus([a, b, c]: RobotVector, [x, y, z]: RobotVector) -> RobotVector {
    [a - x, b - y, c - z]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn near(a: &RigidTransform, b: &RigidTransform) -> bool {
        let numbers = |t: &RigidTransform| {
            t.rotation.iter().flatten().chain(&t.translation).copied().collect::<Vec<_>>()
        };
        numbers(a).iter().zip(numbers(b)).all(|(x, y)| (x - y).abs() < 1e-9)
    }

    proptest! {
        #[test]
        fn a_pose_and_its_inverse_meet(xyz in [-2.0..2.0f64, -2.0..2.0, -2.0..2.0], rpy in [-3.1..3.1f64, -1.5..1.5, -3.1..3.1]) {
            let pose = RigidTransform::from_origin(xyz, rpy);
            prop_assert!(near(&pose.then(&pose.inverse()), &RigidTransform::IDENTITY));
            let again = RigidTransform::from_origin(xyz, pose.rpy());
            prop_assert!(near(&pose, &again));
            let steps = RigidTransform::along(xyz)
                .then(&RigidTransform::about_axis([0.0, 0.0, 1.0], rpy[2]))
                .then(&RigidTransform::about_axis([0.0, 1.0, 0.0], rpy[1]))
                .then(&RigidTransform::about_axis([1.0, 0.0, 0.0], rpy[0]));
            prop_assert!(near(&pose, &steps));
            let [x, y, z, w] = pose.quaternion();
            let angle = 2.0 * libm::acos(w.min(1.0));
            let length = libm::sqrt(x * x + y * y + z * z);
            if length > 1e-6 {
                let turned = RigidTransform::about_axis([x / length, y / length, z / length], angle);
                let turned = RigidTransform { translation: xyz, ..turned };
                prop_assert!(near(&turned, &pose));
            }
        }
    }

    #[test]
    fn straight_up_has_no_roll() {
        let up = RigidTransform::from_origin([0.0; 3], [0.3, std::f64::consts::FRAC_PI_2, 0.5]);
        let [roll, pitch, yaw] = up.rpy();
        let again = RigidTransform::from_origin([0.0; 3], [roll, pitch, yaw]);
        assert_eq!(roll, 0.0);
        assert!(near(&up, &again));
    }
}
