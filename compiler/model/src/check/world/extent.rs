//! How far bodies extend: what is placed by others is placed by their surfaces.

use crate::{BodyShape, world::sin_cos};

type Triple = [f64; 3];

/// The rows of a rotation.
pub(super) type TurnMatrix = [Triple; 3];

/// What a top may be off the level, as a sine: from being written in decimal degrees.
const LEVEL: f64 = 1e-9;

/// Roll, pitch and yaw about the fixed axes, in this order.
pub(super) fn turned([roll, pitch, yaw]: Triple) -> TurnMatrix {
    let ((sr, cr), (sp, cp), (sy, cy)) = (sin_cos(roll), sin_cos(pitch), sin_cos(yaw));
    [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
}

pub(super) fn dot(a: Triple, b: Triple) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A body's shape, where it is.
#[derive(Clone, Copy)]
pub(super) struct PlacedShape {
    pub shape: BodyShape,
    pub at: Triple,
    pub turn: TurnMatrix,
}

impl PlacedShape {
    /// The shape's own axis in the coordinates in which it is placed.
    fn axis(&self, n: usize) -> Triple {
        self.turn.map(|row| row[n])
    }

    /// How far it reaches in a direction, from the origin.
    pub fn reach(&self, direction: Triple) -> f64 {
        let along = |n: usize| dot(self.axis(n), direction);
        let from_centre = match self.shape {
            BodyShape::Box { size } => (0..3).map(|n| along(n).abs() * size[n] / 2.0).sum(),
            BodyShape::Sphere { radius } => radius,
            BodyShape::Capsule { radius, length } => radius + along(2).abs() * length / 2.0,
            BodyShape::Cylinder { radius, length } => {
                let z = along(2);
                radius * (1.0 - z * z).max(0.0).sqrt() + z.abs() * length / 2.0
            }
        };
        dot(self.at, direction) + from_centre
    }

    /// Its top, if that is level.
    pub fn top(&self) -> Option<LevelTop> {
        let is_upright = |n: usize| self.axis(n)[2].abs() > 1.0 - LEVEL;
        match self.shape {
            BodyShape::Box { size } => {
                let up = (0..3).find(|n| is_upright(*n))?;
                let (a, b) = ((up + 1) % 3, (up + 2) % 3);
                let edges = [(self.axis(a), size[a]), (self.axis(b), size[b])];
                Some(LevelTop { middle: self.at, outline: TopOutline::Rectangle(edges) })
            }
            BodyShape::Cylinder { radius, .. } => {
                is_upright(2).then_some(LevelTop { middle: self.at, outline: TopOutline::Circle(radius) })
            }
            BodyShape::Sphere { .. } | BodyShape::Capsule { .. } => None,
        }
    }
}

/// A level top.
pub(super) struct LevelTop {
    /// Its x and y are those of its middle.
    pub middle: Triple,
    outline: TopOutline,
}

enum TopOutline {
    /// The directions of its edges, and their lengths.
    Rectangle([(Triple, f64); 2]),
    Circle(f64),
}

impl LevelTop {
    /// Whether what is over a place is over the top.
    pub fn is_under(&self, place: Triple) -> bool {
        let off = [place[0] - self.middle[0], place[1] - self.middle[1], 0.0];
        match self.outline {
            TopOutline::Rectangle(edges) => {
                edges.iter().all(|(edge, length)| dot(*edge, off).abs() <= length / 2.0 + LEVEL)
            }
            TopOutline::Circle(radius) => dot(off, off).sqrt() <= radius + LEVEL,
        }
    }

    /// `1 m by 0.8 m`
    pub fn size(&self) -> String {
        match self.outline {
            TopOutline::Rectangle([(_, a), (_, b)]) => format!("{a} m by {b} m"),
            TopOutline::Circle(radius) => format!("a circle of {} m", 2.0 * radius),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

    use super::*;

    fn placed(shape: BodyShape, rotation: Triple) -> PlacedShape {
        PlacedShape { shape, at: [1.0, 2.0, 3.0], turn: turned(rotation) }
    }

    #[test]
    fn shapes_reach_as_far_as_their_surfaces() {
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} for {b}");
        let box_ = BodyShape::Box { size: [2.0, 4.0, 6.0] };
        near(placed(box_, [0.0; 3]).reach([0.0, 1.0, 0.0]), 4.0);
        near(placed(box_, [0.0, 0.0, FRAC_PI_2]).reach([0.0, -1.0, 0.0]), -1.0);
        near(placed(box_, [0.0, FRAC_PI_2, 0.0]).reach([0.0, 0.0, 1.0]), 4.0);
        near(placed(box_, [0.0, 0.0, FRAC_PI_4]).reach([1.0, 0.0, 0.0]), 1.0 + 3.0 / 2.0_f64.sqrt());
        near(placed(BodyShape::Sphere { radius: 0.5 }, [1.0; 3]).reach([0.0, 0.0, -1.0]), -2.5);
        let capsule = BodyShape::Capsule { radius: 0.5, length: 2.0 };
        near(placed(capsule, [0.0; 3]).reach([0.0, 0.0, 1.0]), 4.5);
        let cylinder = BodyShape::Cylinder { radius: 0.5, length: 2.0 };
        near(placed(cylinder, [0.0; 3]).reach([1.0, 0.0, 0.0]), 1.5);
        near(placed(cylinder, [FRAC_PI_2, 0.0, 0.0]).reach([0.0, 0.0, 1.0]), 3.5);
    }

    #[test]
    fn level_tops_have_an_outline() {
        let box_ = BodyShape::Box { size: [2.0, 4.0, 6.0] };
        let top = placed(box_, [0.0, 0.0, FRAC_PI_2]).top().expect("level");
        assert!(
            top.is_under([3.0, 2.9, 0.0]) && !top.is_under([1.0, 3.1, 0.0]) && !top.is_under([3.1, 2.0, 0.0])
        );
        let side = placed(box_, [0.0, FRAC_PI_2, 0.0]).top().expect("on its side");
        assert!(side.is_under([4.0, 4.0, 0.0]) && !side.is_under([4.1, 2.0, 0.0]));
        assert!(placed(box_, [0.1, 0.0, 0.0]).top().is_none());
        assert!(placed(BodyShape::Sphere { radius: 1.0 }, [0.0; 3]).top().is_none());
        let cylinder = BodyShape::Cylinder { radius: 0.5, length: 2.0 };
        assert!(placed(cylinder, [0.0; 3]).top().is_some_and(|top| !top.is_under([1.4, 2.4, 0.0])));
        assert!(placed(cylinder, [FRAC_PI_2, 0.0, 0.0]).top().is_none());
    }
}
