//! The second tier: abstract steps get the values of their samples from the test's seed.

use hrdsl_ir::{
    Program,
    test::{TestScript, TestStep},
};
use rand_chacha::ChaCha8Rng;

use hrdsl_harness::{draw_samples, script_rng};

/// The seed of test `number` of a suite: the number itself with the default seed 0.
#[must_use]
pub fn seed_of(seed: u64, number: u64) -> u64 {
    seed.wrapping_mul(1_000_000).wrapping_add(number)
}

/// Draws all samples, in the order of each script's steps.
///
/// # Errors
/// A range without a value.
pub fn concretise(program: &Program, scripts: &[TestScript], seed: u64) -> Result<Vec<TestScript>, String> {
    let drawn = scripts.iter().enumerate().map(|(at, script)| {
        let mut rng = script_rng(seed, at);
        let steps = script.steps.iter().map(|step| drawn(program, step, &mut rng));
        Ok(TestScript { actor: script.actor, steps: steps.collect::<Result<_, String>>()? })
    });
    drawn.collect()
}

fn drawn(program: &Program, step: &TestStep, rng: &mut ChaCha8Rng) -> Result<TestStep, String> {
    match step {
        TestStep::Do { event, args, meanwhile, .. } => {
            let samples = draw_samples(program, *event, args, rng).map_err(|e| e.to_string())?;
            Ok(TestStep::Do { event: *event, args: args.clone(), samples, meanwhile: *meanwhile })
        }
        TestStep::Await { .. } | TestStep::Wait { .. } => Ok(step.clone()),
    }
}
