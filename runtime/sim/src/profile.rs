//! The ramp of a motion: how far along it is, and how fast, at each time.
//!
//! The speed rises from zero to its peak along a smooth step, stays, and falls the same way, so that neither speed nor
//! acceleration jumps. All joints share the ramp: they start and arrive together, and the one with the longest way keeps
//! the limit.

/// Seconds to come to full speed, and to stop.
const RISE: f64 = 0.5;

/// Of a motion from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MotionProfile {
    /// 1/s
    peak: f64,
    /// Seconds.
    length: f64,
}

impl MotionProfile {
    /// `way` is the longest way of any joint (rad, or m); `limit` its greatest speed.
    pub fn new(travel: f64, limit: f64) -> Self {
        let travel = travel.abs();
        if travel < 1e-9 {
            return MotionProfile { peak: 0.0, length: 0.0 };
        }
        if travel >= limit * RISE {
            MotionProfile { peak: limit / travel, length: travel / limit + RISE }
        } else {
            MotionProfile { peak: 1.0 / RISE, length: 2.0 * RISE }
        }
    }

    /// Seconds from start to end.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// The part of the way done, 0..1, after `t` seconds.
    pub fn at(&self, t: f64) -> f64 {
        if t >= self.length {
            return 1.0;
        }
        let t = t.max(0.0);
        let left = self.length - t;
        if t < RISE {
            self.peak * RISE * risen(t / RISE)
        } else if left < RISE {
            1.0 - self.peak * RISE * risen(left / RISE)
        } else {
            self.peak * (RISE / 2.0 + t - RISE)
        }
    }

    /// The speed, 1/s, after `t` seconds.
    pub fn speed(&self, t: f64) -> f64 {
        if t <= 0.0 || t >= self.length {
            return 0.0;
        }
        self.peak * smooth((t / RISE).min((self.length - t) / RISE).min(1.0))
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
        fn keeps_the_limit_and_arrives(travel in 1e-6f64..4.0, limit in 0.01f64..2.0) {
            let p = MotionProfile::new(travel, limit);
            prop_assert!(p.at(0.0).abs() < 1e-12);
            prop_assert!((p.at(p.length()) - 1.0).abs() < 1e-12);
            let h = 1e-4;
            for i in 0..400 {
                let t = p.length() * f64::from(i) / 400.0;
                let mean = (p.at(t + h) - p.at(t)) / h;
                prop_assert!(mean >= -1e-9);
                prop_assert!(mean * travel <= limit * (1.0 + 1e-6));
                prop_assert!((mean - p.speed(t + h / 2.0)).abs() <= 1e-3 / p.length() + 1e-6);
            }
        }
    }

    #[test]
    fn no_way_takes_no_time() {
        let p = MotionProfile::new(0.0, 0.2);
        assert!(p.length() == 0.0 && p.at(0.0) == 1.0 && p.speed(0.0) == 0.0);
    }

    #[test]
    fn braking_goes_from_full_speed_to_none() {
        assert_eq!(braking(0.0), (0.0, 1.0));
        let (travel, speed) = braking(10.0);
        assert!((travel - BRAKE / 2.0).abs() < 1e-12 && speed.abs() < 1e-12);
    }
}
