//! The topics that the scenario itself publishes: when it speaks, and why no program may. What it says there is what the world says,
//! and a program that spoke there, too, would be taken for the world by all who hear it.

use hrdsl_ir::{Nanos, binding::MiddlewareBinding};

use crate::port::{PortDeclaration, PortKind};

/// The last parts of the names of topics that many nodes publish together, each its own part of the whole.
const SHARED: [&str; 6] = ["tf", "tf_static", "joint_states", "rosout", "diagnostics", "parameter_events"];

/// # Errors
/// The topic, if a program is about to publish what the scenario alone says.
pub(super) fn refuse(declared: &PortDeclaration, binding: &MiddlewareBinding) -> Result<(), String> {
    let name = declared.name.as_str();
    let is_shared = SHARED.contains(&name.rsplit('/').next().unwrap_or_default());
    let is_said = binding.inputs.iter().any(|input| input.topic == name);
    let is_heard = binding.outputs.iter().any(|output| output.topic == name);
    if declared.kind != PortKind::Publisher || is_shared || !is_said || is_heard {
        return Ok(());
    }
    Err(format!(
        "the scenario itself publishes the topic `{name}`, and whoever hears it could not tell a program from the world: \
         publish at another name, or let the scenario not bind this one `in`"
    ))
}

/// The next point of the grid, unless the message of this instant has not gone yet.
pub(super) fn next_after(now: Nanos, sent: Option<Nanos>, period: Nanos) -> Nanos {
    let period = period.max(1);
    let is_due = now > 0 && now % period == 0 && sent != Some(now);
    if is_due { now } else { (now / period + 1) * period }
}
