//! Where a base believes that it is: its way and its turns, with errors that add up.

use hrdsl_ir::sensor::OdometryDrift;

use crate::{chance::SensorChance, math::wrap};

/// x and y (m), and the heading (rad).
pub(crate) type GroundPose = [f64; 3];

/// What counts a base's way.
#[derive(Clone, Debug)]
pub(crate) struct DriftingOdometer {
    drift: OdometryDrift,
    chance: SensorChance,
    truth: GroundPose,
    believed: GroundPose,
}

impl DriftingOdometer {
    pub fn new(drift: OdometryDrift, chance: SensorChance, start: GroundPose) -> Self {
        Self { drift, chance, truth: start, believed: start }
    }

    /// The base has come to a pose, in a step of this number.
    pub fn go_on(&mut self, step: u64, to: GroundPose) {
        let from = std::mem::replace(&mut self.truth, to);
        if from == to {
            return;
        }
        let (x, y, turn) = (to[0] - from[0], to[1] - from[1], wrap(to[2] - from[2]));
        let way = libm::hypot(x, y);
        let mut draws = self.chance.of_sample(step.cast_signed());
        // Errors of pieces of a way are independent: their squares add up, however it is cut.
        let longer = 1.0 + if way > 0.0 { draws.gaussian(self.drift.way * way.sqrt()) / way } else { 0.0 };
        let more = draws.gaussian(self.drift.turn * turn.abs().sqrt());
        let off = self.believed[2] - from[2];
        let (sin, cos) = (libm::sin(off), libm::cos(off));
        self.believed = [
            self.believed[0] + longer * (cos * x - sin * y),
            self.believed[1] + longer * (sin * x + cos * y),
            wrap(self.believed[2] + turn + more),
        ];
    }

    pub fn believed(&self) -> GroundPose {
        self.believed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(drift: OdometryDrift, seed: u64, pieces: u64, to: GroundPose) -> GroundPose {
        let mut odometer = DriftingOdometer::new(drift, SensorChance::new(seed, "drift base"), [0.0; 3]);
        for step in 1..=pieces {
            odometer.go_on(step, to.map(|x| x * step as f64 / pieces as f64));
        }
        odometer.believed()
    }

    fn deviation(values: impl Iterator<Item = f64>) -> f64 {
        let values: Vec<f64> = values.collect();
        (values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64).sqrt()
    }

    #[test]
    fn drift_is_as_large_as_is_said_and_grows_with_the_root_of_the_way() {
        let drift = OdometryDrift { way: 0.02, turn: 0.05 };
        for (pieces, metres) in [(10, 1.0), (100, 1.0), (100, 4.0)] {
            let off = (0..2000).map(|seed| after(drift, seed, pieces, [metres, 0.0, 0.0])[0] - metres);
            let want = 0.02 * metres.sqrt();
            let found = deviation(off);
            assert!((found - want).abs() < 0.05 * want, "{found} for {want}");
        }
        let off = (0..2000).map(|seed| after(drift, seed, 50, [0.0, 0.0, 1.0])[2] - 1.0);
        let found = deviation(off);
        assert!((found - 0.05).abs() < 0.003, "{found}");
    }

    #[test]
    fn without_drift_it_knows_where_it_is() {
        let there = after(OdometryDrift::default(), 1, 100, [3.0, -2.0, 2.5]);
        let near = there.iter().zip([3.0, -2.0, 2.5]).all(|(a, b)| (a - b).abs() < 1e-9);
        assert!(near, "{there:?}");
    }
}
