//! A digest of the names that a scenario's recordings are written in: its events and signals, with their types.
//!
//! Two scenarios with the same vocabulary can read each other's recordings. What else they say (requirements, coverage, agents,
//! the order of declarations) does not matter, so that a recording can be judged again by changed requirements.

use std::fmt::Write as _;

use hrdsl_ir::{
    Program, Type,
    binding::MiddlewareBinding,
    world::{Signal, SignalId},
};
use sha2::{Digest, Sha256};

/// The digest: sixteen hexadecimal digits, the beginning of the SHA-256 of [`listed`].
#[must_use]
pub fn digest(program: &Program) -> String {
    let digest = Sha256::digest(listed(program));
    digest.iter().take(8).fold(String::new(), |mut hex, byte| {
        // Writing to a string cannot fail.
        let _ = write!(hex, "{byte:02x}");
        hex
    })
}

/// The vocabulary as text: a line for each event and signal, in the order of their bytes, each with a line break.
///
/// ```text
/// event sensed gaze:bool legs:int 1..4 far:float m
/// signal state:enum idle|busy
/// ```
#[must_use]
pub fn listed(program: &Program) -> String {
    let events = program.events.iter().map(|event| {
        let params = event.params.iter().map(|p| format!(" {}:{}", p.name, described(p.ty)));
        format!("event {}{}\n", event.name, params.collect::<String>())
    });
    let judged = program.signals.iter().zip(0..).filter(|(s, id)| !is_of_bindings(program, s, SignalId(*id)));
    let signals = judged.map(|(s, _)| format!("signal {}:{}\n", s.name, described(s.ty)));
    let mut lines: Vec<String> = events.chain(signals).collect();
    lines.sort_unstable();
    lines.concat()
}

/// Whether only what is bound to a middleware reads it: no recording has it, whichever system was tested.
fn is_of_bindings(program: &Program, signal: &Signal, id: SignalId) -> bool {
    let rules = program.world.iter().flat_map(|world| &world.rules);
    let bound = program.systems.iter().filter_map(|s| s.binding.as_ref());
    !signal.recorded
        && signal.to.is_empty()
        && !rules.flat_map(|rule| &rule.signals).any(|read| *read == id)
        && bound.flat_map(MiddlewareBinding::signals).any(|read| read == id)
}

fn described(ty: Type) -> String {
    match ty {
        Type::Bool => "bool".to_owned(),
        Type::Int { lo, hi } => format!("int {lo}..{hi}"),
        Type::Float(unit) => format!("float {}", unit.symbol()),
        Type::Enum(e) => {
            format!("enum {}", e.values().iter().map(|v| v.name()).collect::<Vec<_>>().join("|"))
        }
        Type::Text => "string".to_owned(),
        Type::List(_) => "list".to_owned(),
    }
}
