//! Kinematic bodies: the way of a body that an environment actor moves.

use hrdsl_ir::Nanos;
use hrdsl_ir::value::{nanos, seconds};

use crate::math::{BodyFrame, RotationQuat, SpaceVector, about, angle_between, wrap};
use crate::profile::smooth;

/// How long a look takes.
pub(crate) const LOOK_TIME: f64 = 0.5;
/// How far above its target a looking body stays at most, m.
const LOOK_HEIGHT: f64 = 0.1;
/// The same of a figure, of how far the target is: who looks down more steeply bows less.
const LOOK_STEEP: f64 = 0.7;

/// What is asked of a look.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LookRequest {
    pub target: SpaceVector,
    /// m, m and rad
    pub offset: f64,
    pub distance: f64,
    pub angle: f64,
    /// Whether all of a figure bows to it.
    pub bows: bool,
}

/// A motion from one pose to another, on a straight line, smooth at both ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct KinematicPath {
    from: BodyFrame,
    to: BodyFrame,
    start: Nanos,
    end: Nanos,
}

impl KinematicPath {
    pub fn new(from: BodyFrame, to: BodyFrame, start: Nanos, over: f64) -> KinematicPath {
        KinematicPath { from, to, start, end: start + nanos(over.max(0.0)) }
    }

    pub fn at(&self, now: Nanos) -> BodyFrame {
        if now >= self.end {
            return self.to;
        }
        let part = smooth(seconds(now - self.start) / seconds(self.end - self.start));
        let between = self.from.turn.inverse() * self.to.turn;
        // The shorter way round: q and -q are the same rotation.
        let (w, v) = (between.w, SpaceVector::new(between.i, between.j, between.k));
        let (w, v) = if w < 0.0 { (-w, -v) } else { (w, v) };
        let angle = 2.0 * libm::atan2(v.norm(), w);
        let turn =
            if v.norm() < 1e-12 { RotationQuat::identity() } else { about(v.normalize(), angle * part) };
        BodyFrame::new(self.from.at + (self.to.at - self.from.at) * part, self.from.turn * turn)
    }

    pub fn is_over(&self, now: Nanos) -> bool {
        now >= self.end
    }
}

/// Where a looking body goes: see [`WorldAction::Look`](hrdsl_ir::world::WorldAction::Look).
///
/// `facing` is the body's own x axis at the start of the run. The line of sight is level and along it; the body goes to
/// that end of the line where it is now, seen from the target, then `offset` to the left as seen from the target. Its
/// height is its present one, but at least the target's, and at most 10 cm above it, or, of a figure, seven tenths of the distance that
/// the offset leaves; the distance between the centres is exact. It turns its x axis to the target, then about the vertical, to its left, until the angle is the one asked for.
pub(crate) fn look(now: &BodyFrame, facing: SpaceVector, request: &LookRequest) -> BodyFrame {
    let LookRequest { target, offset, distance, angle, bows } = *request;
    let here = now.at - target;
    let level = |v: SpaceVector| SpaceVector::new(v.x, v.y, 0.0);
    let line = [level(facing), level(here), SpaceVector::x()].into_iter().find(|v| v.norm() > 1e-6);
    let line = line.unwrap_or_else(SpaceVector::x).normalize();
    let line = if here.dot(&line) < 0.0 { -line } else { line };
    let left = SpaceVector::z().cross(&line);
    let offset = offset.clamp(-distance, distance);
    let rest = distance * distance - offset * offset;
    let most = if bows { LOOK_STEEP * rest.sqrt() } else { LOOK_HEIGHT };
    let height = here.z.clamp(0.0, most).min(rest.sqrt());
    let away = (rest - height * height).max(0.0).sqrt();
    let at = target + line * away + left * offset + SpaceVector::z() * height;
    BodyFrame::new(at, face(target - at, angle))
}

/// A rotation without roll, whose x axis is at `angle` from `sight`, to its left.
fn face(sight: SpaceVector, angle: f64) -> RotationQuat {
    if sight.norm() < 1e-9 {
        return RotationQuat::identity();
    }
    let level = SpaceVector::new(sight.x, sight.y, 0.0).norm();
    let elevation = libm::atan2(sight.z, level);
    let heading = libm::atan2(sight.y, sight.x);
    let (se, ce) = (libm::sin(elevation), libm::cos(elevation));
    // Turning by t about the vertical: cos angle = sin² e + cos² e cos t.
    let cos = ((libm::cos(angle) - se * se) / (ce * ce).max(1e-12)).clamp(-1.0, 1.0);
    let yaw = wrap(heading + libm::acos(cos));
    about(SpaceVector::z(), yaw) * about(SpaceVector::y(), -elevation)
}

/// What `angle(a, b)` measures.
pub(crate) fn sight_angle(a: &BodyFrame, b: SpaceVector) -> f64 {
    angle_between(&a.x_axis(), &(b - a.at))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::from_rpy;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_look_is_as_asked(
            offset in -0.4f64..0.4, distance in 0.5f64..0.8, angle in 0.0f64..1.5,
            x in 0.7f64..1.5, y in -0.5f64..0.5, z in 0.5f64..1.6, bows: bool,
        ) {
            let head = BodyFrame::new(SpaceVector::new(x, y, z), from_rpy([0.0, 0.0, 2.8]));
            let target = SpaceVector::new(0.48, 0.17, 0.705);
            let request = LookRequest { target, offset, distance, angle, bows };
            let there = look(&head, -SpaceVector::x(), &request);
            let offset_there = there.at - target;
            prop_assert!((offset_there.norm() - distance).abs() < 1e-9);
            prop_assert!((offset_there.y - offset).abs() < 1e-9, "left of the line is +y here");
            let most = if bows { 0.7 * distance } else { 0.1 };
            prop_assert!(offset_there.x > 0.0 && (-1e-9..=most + 1e-9).contains(&offset_there.z));
            prop_assert!((sight_angle(&there, target) - angle).abs() < 1e-6);
        }
    }

    #[test]
    fn a_way_ends_where_it_should() {
        let a = BodyFrame::new(SpaceVector::zeros(), RotationQuat::identity());
        let b = BodyFrame::new(SpaceVector::new(1.0, 0.0, 2.0), from_rpy([0.0, 0.0, 3.0]));
        let path = KinematicPath::new(a, b, 10, 1.0);
        assert!((path.at(10).at - a.at).norm() < 1e-12);
        assert!((path.at(10 + 500_000_000).at - SpaceVector::new(0.5, 0.0, 1.0)).norm() < 1e-9);
        assert_eq!(path.at(10 + 1_000_000_000), b);
        assert!(path.is_over(1_000_000_010) && !path.is_over(1_000_000_009));
    }

    #[test]
    fn a_way_without_time_is_over_at_once() {
        let a = BodyFrame::new(SpaceVector::zeros(), RotationQuat::identity());
        let path = KinematicPath::new(a, a, 5, -1.0);
        assert!(path.is_over(5) && path.at(5) == a);
    }
}
