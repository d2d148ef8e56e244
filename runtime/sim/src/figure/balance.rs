//! Balance: what a push does to somebody who stands, by the rule of the capture point (Pratt, Carff, Drakunov and Goswami 2006).
//!
//! The figure is a linear inverted pendulum: its mass M at the height h, x away from the middle of its feet, moves by
//! ẍ = ω² (x − p) + F/M, where ω² = g/h. Ankles bring the pressure p to where it holds the capture point ξ = x + ẋ/ω, within the
//! length of a foot. Whoever has the capture point outside of the feet makes a step to where it will be; whoever cannot reach it falls.

use crate::math::SpaceVector;

/// From the middle of the feet to where pressure can be, m.
const FOOT: f64 = 0.1;
/// How much farther than the capture point the pressure goes.
const EAGER: f64 = 4.0;
/// From the push to the step, and of the step, s.
const REACTION: f64 = 0.15;
const STEP_TIME: f64 = 0.3;
/// The longest step, of the height of the hip.
const LONGEST_STEP: f64 = 0.7;
/// Below this it stands, m and m/s.
const STILL: f64 = 5e-4;

/// A step that is being made, or about to be.
#[derive(Clone, Copy, Debug)]
struct RecoveryStep {
    age: f64,
    /// Set when the foot is lifted, m; and how much of it is done.
    way: Option<SpaceVector>,
    gone: SpaceVector,
}

/// How somebody keeps upright.
#[derive(Clone, Debug)]
pub(super) struct Balance {
    mass: f64,
    /// Of the pendulum, 1/s.
    frequency: f64,
    longest: f64,
    /// From above the feet, m, and its speed, m/s.
    sway: SpaceVector,
    speed: SpaceVector,
    step: Option<RecoveryStep>,
}

/// What a moment of balancing comes to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum BalanceOutcome {
    /// The feet move by so much, m.
    Stands(SpaceVector),
    Falls,
}

impl Balance {
    pub fn new(mass: f64, hip: f64, gravity: f64) -> Balance {
        Balance {
            mass,
            frequency: (gravity / hip).sqrt(),
            longest: LONGEST_STEP * hip,
            sway: SpaceVector::zeros(),
            speed: SpaceVector::zeros(),
            step: None,
        }
    }

    /// From above the feet, level, m.
    pub fn sway(&self) -> SpaceVector {
        self.sway
    }

    pub fn is_still(&self) -> bool {
        self.step.is_none() && self.sway == SpaceVector::zeros() && self.speed == SpaceVector::zeros()
    }

    /// A time later, s, in which it was pushed, N·s, level.
    pub fn go_on(&mut self, push: SpaceVector, h: f64) -> BalanceOutcome {
        if self.is_still() && push == SpaceVector::zeros() {
            return BalanceOutcome::Stands(SpaceVector::zeros());
        }
        // Until the foot is down, the other one bears all the weight.
        let gone = self.step.map_or_else(SpaceVector::zeros, |step| step.gone);
        let pressure = within((self.capture() + gone) * EAGER, FOOT) - gone;
        self.speed += (self.sway - pressure) * (self.frequency * self.frequency * h) + push / self.mass;
        self.sway += self.speed * h;
        let capture = self.capture();
        if capture.norm() > FOOT + self.longest {
            return BalanceOutcome::Falls;
        }
        let moved = self.make_step(capture, h);
        self.sway -= moved;
        if self.step.is_none() && self.sway.norm() < STILL && self.speed.norm() < STILL && push.norm() == 0.0
        {
            (self.sway, self.speed) = (SpaceVector::zeros(), SpaceVector::zeros());
        }
        BalanceOutcome::Stands(moved)
    }

    fn capture(&self) -> SpaceVector {
        self.sway + self.speed / self.frequency
    }

    /// How far the feet move in the time `h`.
    fn make_step(&mut self, capture: SpaceVector, h: f64) -> SpaceVector {
        let Some(step) = &mut self.step else {
            if capture.norm() > FOOT {
                self.step = Some(RecoveryStep { age: 0.0, way: None, gone: SpaceVector::zeros() });
            }
            return SpaceVector::zeros();
        };
        step.age += h;
        if step.age < REACTION {
            return SpaceVector::zeros();
        }
        let (frequency, longest) = (self.frequency, self.longest);
        let way = *step.way.get_or_insert_with(|| {
            // Meanwhile the capture point runs away from the pressure, which is at the edge of the foot.
            let edge = within(capture, FOOT);
            within(edge + (capture - edge) * libm::exp(frequency * STEP_TIME), longest)
        });
        let moved = way * (h / STEP_TIME).min(1.0);
        step.gone += moved;
        if step.age >= REACTION + STEP_TIME {
            self.step = None;
        }
        moved
    }
}

/// The vector, shortened to this length if it is longer.
fn within(v: SpaceVector, length: f64) -> SpaceVector {
    let norm = v.norm();
    if norm > length { v * (length / norm) } else { v }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The longest time in which somebody who does not fall comes to rest, s.
    const PATIENCE: f64 = 10.0;

    /// The way of the feet after a push of so many N for so long, s; `None`: a fall.
    fn after(force: f64, time: f64) -> Option<f64> {
        let mut balance = Balance::new(75.0, 0.9, 9.81);
        let (mut way, mut now) = (0.0, 0.0);
        while now < time || !balance.is_still() {
            assert!(now < time + PATIENCE, "{force} N, {time} s: {balance:?}");
            let push = if now < time { SpaceVector::x() * (force * 0.01) } else { SpaceVector::zeros() };
            match balance.go_on(push, 0.01) {
                BalanceOutcome::Stands(moved) => way += moved.x,
                BalanceOutcome::Falls => return None,
            }
            now += 0.01;
        }
        Some(way)
    }

    #[test]
    fn a_light_push_is_stood() {
        assert_eq!(after(40.0, 10.0), Some(0.0));
        assert_eq!(after(300.0, 0.04), Some(0.0));
    }

    #[test]
    fn a_harder_one_makes_a_step() {
        let way = after(150.0, 0.25).expect("no fall");
        assert!((0.1..0.7).contains(&way), "{way}");
    }

    #[test]
    fn whoever_is_thrown_falls() {
        assert_eq!(after(1000.0, 0.3), None);
    }

    #[test]
    fn a_push_that_lasts_is_walked_away_from() {
        let way = after(90.0, 3.0).expect("no fall");
        assert!(way > 0.5, "{way}");
    }

    proptest! {
        #[test]
        fn a_push_never_pulls(force in 0.0f64..400.0, time in 0.0f64..0.5) {
            // Pushes that almost make one fall are caught by many steps: there is a bound for each, and time for so many.
            let steps = (time + PATIENCE) / (REACTION + STEP_TIME);
            if let Some(way) = after(force, time) {
                prop_assert!((-1e-9..=steps * LONGEST_STEP * 0.9).contains(&way), "{}", way);
            }
        }
    }
}
