//! `--physics-step` and `--physics-steps`: the same tests with other steps of the physics, to find verdicts that hang on them.

use std::time::Duration;

use hrdsl_ir::{Nanos, Program};
use hrdsl_runtime::campaign::CampaignSetup;

use super::comparison::{OtherWay, WayWords};
use crate::fault::CommandFault;

/// How a step is typed.
pub fn option(step: Duration) -> String {
    format!("--physics-step {}", told(step))
}

/// The program, whose world takes steps of this time.
///
/// # Errors
/// It has no world, or the time is zero or longer than a second.
pub fn with_step(program: &Program, step: Duration) -> Result<Program, CommandFault> {
    let mut program = program.clone();
    let told = told(step);
    let Some(world) = &mut program.world else {
        return Err(format!("a physics step of {told}: `{}` has no `world`", program.name));
    };
    if step.is_zero() || step > Duration::from_secs(1) {
        return Err(format!("a physics step of {told}: give one of more than 0 s, and of 1 s at most"));
    }
    world.step = Nanos::try_from(step.as_nanos()).map_err(|e| format!("a physics step of {told}: {e}"))?;
    Ok(program)
}

/// The program with each of these steps.
///
/// # Errors
/// As [`with_step`].
pub fn with_steps(program: &Program, steps: &[Duration]) -> Result<Vec<(Duration, Program)>, CommandFault> {
    steps.iter().map(|step| Ok((*step, with_step(program, *step)?))).collect()
}

/// The campaign with each of these programs, which were made with these steps.
pub fn others<'p>(campaign: &CampaignSetup<'p>, programs: &'p [(Duration, Program)]) -> Vec<OtherWay<'p>> {
    let other = |(step, program): &'p (Duration, Program)| OtherWay {
        option: option(*step),
        campaign: CampaignSetup { program, ..campaign.clone() },
    };
    programs.iter().map(other).collect()
}

/// What is said of other steps than the program's own.
pub fn words(program: &Program) -> WayWords {
    let own = program.world.as_ref().map(|world| Duration::from_nanos(world.step.unsigned_abs()));
    WayWords {
        topic: "physics steps",
        several: "other steps of the physics",
        one: "in another step of the physics",
        usual: own.map(|step| format!("with {}", told(step))).unwrap_or_default(),
        progress: "with other steps of the physics",
    }
}

fn told(step: Duration) -> String {
    let ms = step.as_secs_f64() * 1e3;
    format!("{ms}ms")
}
