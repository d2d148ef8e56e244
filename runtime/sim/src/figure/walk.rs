//! Walking: how a figure goes along points, at a stated speed, and turns to where it goes; and how it turns at all.

use crate::figure::PlanarStance;
use crate::math::wrap;

/// How fast somebody gets to speed, and comes to rest, m/s² and rad/s².
const ACCELERATION: f64 = 1.5;
const TURN_ACCELERATION: f64 = 10.0;
/// Whoever has to turn farther than this does so before walking on, rad.
const ON_THE_SPOT: f64 = 0.5;
/// There, m and rad.
const THERE: f64 = 1e-3;
/// Slower than this it does not turn, rad/s.
const TURNS_NO_MORE: f64 = 0.11;

/// A walk that is under way, or a turn, if there is nowhere to go.
#[derive(Clone, Debug)]
pub(super) struct WalkPlan {
    /// Where to go yet, the next last, m.
    left: Vec<[f64; 2]>,
    /// How to be turned in the end, if not as the walk comes.
    heading: Option<f64>,
    /// The most, m/s.
    speed: f64,
    /// Now, m/s.
    pace: f64,
}

impl WalkPlan {
    pub fn along(points: &[[f64; 2]], speed: f64) -> WalkPlan {
        let left = points.iter().rev().copied().collect();
        WalkPlan { left, heading: None, speed, pace: 0.0 }
    }

    pub fn turn_to(heading: f64) -> WalkPlan {
        WalkPlan { left: Vec::new(), heading: Some(heading), speed: 0.0, pace: 0.0 }
    }

    pub fn is_over(&self) -> bool {
        self.left.is_empty() && self.heading.is_none()
    }

    /// Whereto it wants to be turned.
    pub fn facing(&self, stance: &PlanarStance) -> Option<f64> {
        let Some(next) = self.left.last() else { return self.heading };
        let (dx, dy) = (next[0] - stance.x, next[1] - stance.y);
        (libm::hypot(dx, dy) >= THERE).then(|| libm::atan2(dy, dx))
    }

    /// A time later, s, in which it was turned.
    pub fn go_on(&mut self, stance: &mut PlanarStance, h: f64) {
        let Some(next) = self.left.last().copied() else {
            if self.heading.is_some_and(|heading| stance.faces(heading)) {
                self.heading = None;
            }
            return;
        };
        let (dx, dy) = (next[0] - stance.x, next[1] - stance.y);
        let far = (dx * dx + dy * dy).sqrt();
        if far < THERE {
            (stance.x, stance.y) = (next[0], next[1]);
            self.left.pop();
            return;
        }
        let bearing = libm::atan2(dy, dx);
        let off = wrap(bearing - stance.heading).abs();
        // Where the way bends, the walk is slow enough to bend with it; it ends at rest.
        let ahead = if off > ON_THE_SPOT { 0.0 } else { self.speed * libm::cos(off) };
        let stops = (2.0 * ACCELERATION * far).sqrt();
        let wanted = if self.left.len() == 1 { ahead.min(stops) } else { ahead };
        let change = ACCELERATION * h;
        self.pace = wanted.clamp(self.pace - change, self.pace + change).min(far / h);
        stance.x += self.pace * h * dx / far;
        stance.y += self.pace * h * dy / far;
    }
}

impl PlanarStance {
    /// Turns towards a heading for a time (s) at a most (rad/s), or comes to rest.
    pub(super) fn turn(&mut self, to: Option<f64>, most: f64, h: f64) {
        if h <= 0.0 {
            return;
        }
        let off = to.map_or(0.0, |heading| wrap(heading - self.heading));
        // As fast as it can still be stopped, and no farther than it has to go.
        let stops = (2.0 * TURN_ACCELERATION * off.abs()).sqrt().min(off.abs() / h);
        let (wanted, change) = (stops.min(most).copysign(off), TURN_ACCELERATION * h);
        self.spin = wanted.clamp(self.spin - change, self.spin + change);
        self.heading = wrap(self.heading + self.spin * h);
    }

    /// Whether it stands turned so.
    fn faces(&self, heading: f64) -> bool {
        wrap(heading - self.heading).abs() <= THERE && self.spin.abs() <= TURNS_NO_MORE
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const H: f64 = 0.01;

    proptest! {
        #[test]
        fn a_walk_comes_to_its_end_and_is_no_faster_than_it_may(
            points in proptest::collection::vec((-5.0f64..5.0, -5.0f64..5.0), 1..5),
            speed in 0.2f64..2.0, heading in -3.0f64..3.0,
        ) {
            let points: Vec<[f64; 2]> = points.into_iter().map(|(x, y)| [x, y]).collect();
            let mut stance = PlanarStance { x: 0.0, y: 0.0, heading, spin: 0.0 };
            let mut walk = WalkPlan::along(&points, speed);
            let mut steps = 0;
            while !walk.is_over() {
                let before = stance;
                stance.turn(walk.facing(&stance), 2.0, H);
                walk.go_on(&mut stance, H);
                let way = (stance.x - before.x).hypot(stance.y - before.y);
                prop_assert!(way <= speed * H + THERE + 1e-9, "{}", way / H);
                prop_assert!(stance.spin.abs() <= 2.0);
                prop_assert!((stance.spin - before.spin).abs() <= TURN_ACCELERATION * H + 1e-9);
                steps += 1;
                prop_assert!(steps < 30_000, "{:?}", stance);
            }
            let last = points[points.len() - 1];
            prop_assert!((stance.x - last[0]).hypot(stance.y - last[1]) < 1e-9);
        }
    }

    #[test]
    fn a_turn_ends_as_asked() {
        let mut stance = PlanarStance { x: 1.0, y: 2.0, heading: 3.0, spin: 0.0 };
        let mut turn = WalkPlan::turn_to(-3.0);
        let mut time = 0.0;
        while !turn.is_over() {
            stance.turn(turn.facing(&stance), 1.0, H);
            turn.go_on(&mut stance, H);
            time += H;
        }
        assert!((stance.heading + 3.0).abs() < 2.0 * THERE && time < 0.45, "{stance:?} {time}");
        assert_eq!((stance.x, stance.y), (1.0, 2.0));
    }
}
