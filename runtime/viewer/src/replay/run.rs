//! A run as it was read from a recording, and what all that shows it asks of it.

use hrdsl_ir::{Nanos, Program};
use hrdsl_recording::{RecordingFile, scene::RecordedScene};
use hrdsl_trace::{RunEnd, Trace};

use super::units::WrittenUnits;

/// The length of a tick, ns.
pub(super) const TICK: Nanos = 1_000_000;

/// The tick that is nearest to a time.
pub(super) fn tick(time: Nanos) -> u64 {
    ((time.max(0) + TICK / 2) / TICK).unsigned_abs()
}

/// A run as it was read, and what it is shown with.
pub(super) struct ReplayedRun<'a> {
    pub program: &'a Program,
    pub scene: RecordedScene,
    pub file: &'a RecordingFile,
    pub trace: Trace,
    /// In which units the scenario writes its limits.
    pub units: &'a WrittenUnits,
    /// Whether it was read to its end, and the run did not break off.
    pub is_whole: bool,
    pub ended: RunEnd,
}

/// The actor of a name such as `robot.palm`, if there is one.
pub(super) fn actor_of(program: &Program, name: &str) -> Option<String> {
    let owner = name.split('.').next()?;
    program.actors.iter().find(|actor| actor.name == owner).map(|actor| actor.name.clone())
}
