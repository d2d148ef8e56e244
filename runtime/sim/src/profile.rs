//! The ramp of a motion: how far along it is, and how fast, at each time.
//!
//! The speed rises from zero to its peak along a smooth step, stays, and falls the same way, so that neither speed nor
//! acceleration jumps. All joints share the ramp: they start and arrive together, and the one that has the farthest to go keeps
//! the limit.

/// Seconds to come to full speed, and to stop, if nobody asks for others.
pub(crate) const RISE: f64 = 0.5;

/// Of a motion from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MotionProfile {
    /// 1/s
    peak: f64,
    /// Seconds.
    length: f64,
    /// Seconds to come to full speed, and to stop.
    rise: f64,
}

impl MotionProfile {
    /// `travel` is the farthest that any joint goes (rad, or m); `limit` its greatest speed, to which it comes in `rise` seconds.
    pub fn new(travel: f64, limit: f64, rise: f64) -> Self {
        let travel = travel.abs();
        if travel < 1e-9 {
            return MotionProfile { peak: 0.0, length: 0.0, rise };
        }
        if travel >= limit * rise {
            MotionProfile { peak: limit / travel, length: travel / limit + rise, rise }
        } else {
            MotionProfile { peak: 1.0 / rise, length: 2.0 * rise, rise }
        }
    }

    /// Seconds from start to end.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// The part of the path done, 0..1, after `t` seconds.
    pub fn at(&self, t: f64) -> f64 {
        if t >= self.length {
            return 1.0;
        }
        let t = t.max(0.0);
        let left = self.length - t;
        if t < self.rise {
            self.peak * self.rise * risen(t / self.rise)
        } else if left < self.rise {
            1.0 - self.peak * self.rise * risen(left / self.rise)
        } else {
            self.peak * (self.rise / 2.0 + t - self.rise)
        }
    }
}

/// The pace along a path with limits of its own, such as at corners: as fast as they and the acceleration of [`MotionProfile`]'s mean
/// allow (Bobrow, Dubowsky and Gibson 1985, with a limit that does not depend on the place).
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LimitedPace {
    grid: f64,
    /// At each point of the grid: how fast, and when (s).
    points: Vec<(f64, f64)>,
}

impl LimitedPace {
    /// `limit` is the greatest speed so far along the path, 0 to 1, and never 0; full speed is come to in `rise` seconds.
    pub fn new(length: f64, rise: f64, limit: impl Fn(f64) -> f64) -> LimitedPace {
        let cells = (length / 0.005).ceil().max(1.0) as usize;
        let grid = length / cells as f64;
        let gain = 2.0 * grid / rise;
        let mut speeds: Vec<f64> = (0..=cells).map(|i| limit(grid * i as f64)).collect();
        speeds[0] = 0.0;
        speeds[cells] = 0.0;
        for i in 1..=cells {
            speeds[i] = speeds[i].min((speeds[i - 1].powi(2) + gain).sqrt());
        }
        for i in (0..cells).rev() {
            speeds[i] = speeds[i].min((speeds[i + 1].powi(2) + gain).sqrt());
        }
        let mut time = 0.0;
        let mut points = vec![(speeds[0], 0.0)];
        for pair in speeds.windows(2) {
            time += 2.0 * grid / (pair[0] + pair[1]);
            points.push((pair[1], time));
        }
        LimitedPace { grid, points }
    }

    /// Seconds from start to end.
    pub fn length(&self) -> f64 {
        self.points[self.points.len() - 1].1
    }

    /// How far along the path after `t` seconds.
    pub fn at(&self, t: f64) -> f64 {
        let next = self.points.partition_point(|(_, time)| *time <= t);
        if next == self.points.len() {
            return self.grid * (next - 1) as f64;
        }
        let Some(at) = next.checked_sub(1) else { return 0.0 };
        let ((from, begin), (to, end)) = (self.points[at], self.points[next]);
        let (passed, whole) = (t - begin, end - begin);
        self.grid * at as f64 + from * passed + (to - from) / whole * passed * passed / 2.0
    }
}

/// Seconds in which a motion that is given up comes to a stop.
const BRAKE: f64 = 0.25;

/// How far a motion with speed 1 goes on, `t` seconds after it was given up, and how fast.
pub(crate) fn braking(t: f64) -> (f64, f64) {
    let u = (t / BRAKE).clamp(0.0, 1.0);
    (BRAKE * (u - risen(u)), 1.0 - smooth(u))
}

/// Seconds after which a given-up motion has stopped.
pub(crate) fn brake_time() -> f64 {
    BRAKE
}

/// 0..1 with no slope at either end.
pub(crate) fn smooth(u: f64) -> f64 {
    u * u * (3.0 - 2.0 * u)
}

/// The integral of [`smooth`].
fn risen(u: f64) -> f64 {
    u * u * u * (1.0 - u / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn keeps_the_limit_and_arrives(travel in 1e-6f64..4.0, limit in 0.01f64..2.0, rise in 0.1f64..1.0) {
            let p = MotionProfile::new(travel, limit, rise);
            prop_assert!(p.at(0.0).abs() < 1e-12);
            prop_assert!((p.at(p.length()) - 1.0).abs() < 1e-12);
            let h = 1e-4;
            for i in 0..400 {
                let t = p.length() * f64::from(i) / 400.0;
                let mean = (p.at(t + h) - p.at(t)) / h;
                prop_assert!(mean >= -1e-9);
                prop_assert!(mean * travel <= limit * (1.0 + 1e-6));
            }
        }
    }

    #[test]
    fn limits_on_the_way_are_kept() {
        let limit = |s: f64| if (s - 1.0).abs() < 0.1 { 0.2 } else { 1.0 };
        let pace = LimitedPace::new(2.0, RISE, limit);
        assert!((pace.at(0.0), pace.at(pace.length() + 1.0)) == (0.0, 2.0));
        let h = 1e-3;
        let (mut before, mut last) = (0.0, 0.0);
        for i in 1..=(pace.length() / h) as usize {
            let now = pace.at(h * i as f64);
            let speed = (now - before) / h;
            let most = limit(now - 0.01).max(limit(now + 0.01));
            assert!(speed <= most + 1e-6, "{now}: {speed}");
            assert!((speed - last).abs() <= h / RISE * 1.1, "{now}");
            (before, last) = (now, speed);
        }
        assert!((pace.at(pace.length()) - 2.0).abs() < 1e-9);
    }

    #[test]
    fn no_way_takes_no_time() {
        let p = MotionProfile::new(0.0, 0.2, RISE);
        assert!(p.length() == 0.0 && p.at(0.0) == 1.0);
    }

    #[test]
    fn braking_goes_from_full_speed_to_none() {
        assert_eq!(braking(0.0), (0.0, 1.0));
        let (travel, speed) = braking(10.0);
        assert!((travel - BRAKE / 2.0).abs() < 1e-12 && speed.abs() < 1e-12);
    }
}
