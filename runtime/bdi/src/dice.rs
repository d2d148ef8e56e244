//! An agent's own source of chance.

use hrdsl_ir::Value;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// ChaCha8 with the run's seed, on a stream of the agent's own; made when it is first asked.
#[derive(Debug)]
pub(crate) struct AgentRng {
    seed: u64,
    stream: u64,
    rng: Option<ChaCha8Rng>,
    /// How often it was asked.
    pub draws: u64,
}

impl AgentRng {
    pub fn new(seed: u64, stream: u64) -> Self {
        Self { seed, stream, rng: None, draws: 0 }
    }

    fn rng(&mut self) -> &mut ChaCha8Rng {
        self.draws += 1;
        let (seed, stream) = (self.seed, self.stream);
        self.rng.get_or_insert_with(|| {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            rng.set_stream(stream);
            rng
        })
    }

    /// Evenly in [0, 1), on a grid of 2⁻⁵³.
    pub fn fraction(&mut self) -> f64 {
        (self.rng().next_u64() >> 11) as f64 / 9_007_199_254_740_992.0
    }

    /// Evenly below `n`, which is not 0.
    pub fn below(&mut self, n: usize) -> usize {
        let n = u32::try_from(n).unwrap_or(u32::MAX);
        self.rng().random_range(0..n) as usize
    }

    /// Fisher and Yates, from the last place down.
    pub fn shuffle(&mut self, all: &mut [Value]) {
        for i in (1..all.len()).rev() {
            let j = self.below(i + 1);
            all.swap(i, j);
        }
    }
}
