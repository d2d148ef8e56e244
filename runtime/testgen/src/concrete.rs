//! The second tier: abstract steps get the values of their samples from the test's seed.

use hrdsl_ir::{Program, test::TestStep};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use hrdsl_harness::draw_samples;

/// The seed of test `number` of a suite: the number itself with the default seed 0.
#[must_use]
pub fn seed_of(seed: u64, number: u64) -> u64 {
    seed.wrapping_mul(1_000_000).wrapping_add(number)
}

/// Draws all samples, in the order of the steps.
///
/// # Errors
/// A range without a value.
pub fn concretise(program: &Program, steps: &[TestStep], seed: u64) -> Result<Vec<TestStep>, String> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    steps
        .iter()
        .map(|step| match step {
            TestStep::Do { event, args, .. } => {
                let samples = draw_samples(program, *event, args, &mut rng).map_err(|e| e.to_string())?;
                Ok(TestStep::Do { event: *event, args: args.clone(), samples })
            }
            TestStep::Await { .. } | TestStep::Wait { .. } => Ok(step.clone()),
        })
        .collect()
}
