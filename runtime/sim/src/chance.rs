//! The chance of sensors: draws that belong to a test's seed, a sensor and one of its samples, whoever reads it and how often.

use rand_chacha::{
    ChaCha8Rng,
    rand_core::{Rng, SeedableRng},
};

/// Each sample has so many blocks of the stream to itself, as a power of two: more than the beams of any laser take.
const BLOCKS: u32 = 20;

/// The stream of one sensor.
#[derive(Clone, Debug)]
pub(crate) struct SensorChance(ChaCha8Rng);

impl SensorChance {
    /// The stream's number is the hash (FNV-1a) of what tells the sensor from others.
    pub fn new(seed: u64, key: &str) -> Self {
        let hash = key.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
        });
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(hash);
        Self(rng)
    }

    /// The draws of a sample. Those before time 0 have negative numbers.
    pub fn of_sample(&self, number: i64) -> SampleDraws {
        let mut rng = self.0.clone();
        let block = number.cast_unsigned() << BLOCKS;
        rng.set_word_pos(u128::from(block) * 16);
        SampleDraws(rng)
    }
}

/// The draws of one sample, one after the other.
pub(crate) struct SampleDraws(ChaCha8Rng);

impl SampleDraws {
    /// Evenly in 0..1, on a grid of 2⁻⁵².
    fn fraction(&mut self) -> f64 {
        (self.0.next_u64() >> 12) as f64 / 4_503_599_627_370_496.0
    }

    /// Whether something happens; nothing is drawn for what never does.
    pub fn happens(&mut self, probability: f64) -> bool {
        probability > 0.0 && self.fraction() < probability
    }

    /// Evenly between two numbers.
    pub fn between(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * self.fraction()
    }

    /// With a mean of 0 (Box and Muller 1958); nothing is drawn for a deviation of 0.
    pub fn gaussian(&mut self, deviation: f64) -> f64 {
        if deviation <= 0.0 {
            return 0.0;
        }
        let (far, around) = (1.0 - self.fraction(), self.fraction());
        let radius = (-2.0 * libm::log(far)).sqrt();
        deviation * radius * libm::cos(2.0 * std::f64::consts::PI * around)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sample_has_its_own_draws() {
        let chance = SensorChance::new(7, "signal near");
        let draw = |chance: &SensorChance, n| chance.of_sample(n).fraction();
        assert_eq!(draw(&chance, 3), draw(&chance, 3));
        let others = [
            draw(&chance, 4),
            draw(&chance, -3),
            draw(&SensorChance::new(8, "signal near"), 3),
            draw(&SensorChance::new(7, "signal far"), 3),
        ];
        assert!(others.iter().all(|other| *other != draw(&chance, 3)), "{others:?}");
    }

    #[test]
    fn noise_has_its_mean_its_deviation_and_its_tails() {
        let chance = SensorChance::new(1, "laser eye");
        let drawn: Vec<f64> = (0..100_000).map(|n| chance.of_sample(n).gaussian(2.0)).collect();
        let mean = drawn.iter().sum::<f64>() / 1e5;
        let deviation = (drawn.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 1e5).sqrt();
        let beyond = |n: f64| drawn.iter().filter(|x| x.abs() > n * 2.0).count() as f64 / 1e5;
        assert!(mean.abs() < 0.02 && (deviation - 2.0).abs() < 0.02, "{mean} {deviation}");
        assert!((beyond(1.0) - 0.3173).abs() < 0.005 && (beyond(2.0) - 0.0455).abs() < 0.003);
        // One sample says nothing of the next.
        let together = drawn.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / 1e5;
        assert!((together / 4.0).abs() < 0.01, "{together}");
    }

    #[test]
    fn what_happens_happens_as_often_as_it_should() {
        let chance = SensorChance::new(2, "signal near");
        let rate = (0..100_000).filter(|n| chance.of_sample(*n).happens(0.02)).count() as f64 / 1e5;
        assert!((rate - 0.02).abs() < 0.0015, "{rate}");
        assert!((0..1000).all(|n| !chance.of_sample(n).happens(0.0) && chance.of_sample(n).happens(1.0)));
    }
}
