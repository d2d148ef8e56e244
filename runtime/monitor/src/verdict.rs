//! Verdicts: what a monitor has to say about a trace.

use hrdsl_ir::{
    Nanos, Value,
    monitor::{MonitorEffect, MonitorOutcome},
    world::SignalId,
};
use hrdsl_trace::SeenStep;

/// One monitor's outcome with the figures and steps that support it.
#[derive(Clone, Debug, PartialEq)]
pub struct MonitorVerdict {
    /// Index into [`Program::monitors`](hrdsl_ir::Program::monitors).
    pub monitor: usize,
    pub outcome: MonitorOutcome,
    /// How often each effect was had.
    pub triggered: u32,
    pub discharged: u32,
    pub failures: u32,
    pub first_failure: Option<Violation>,
    /// The least margin, in the unit of the monitor's margin, and when it was first seen.
    pub worst_margin: Option<(f64, Nanos)>,
    /// The obligation that was pending at the end was made at this time. A failed requirement can have one, too.
    pub pending_since: Option<Nanos>,
    /// When one of its comparisons first had no value: what has not failed is inconclusive then.
    pub unvalued: Option<Nanos>,
}

/// The first violation of a requirement.
#[derive(Clone, Debug, PartialEq)]
pub struct Violation {
    pub time: Nanos,
    /// The step that violates; `None`: a deadline did.
    pub step: Option<usize>,
    /// When the violated obligation was made; `time` if there was none.
    pub trigger_time: Nanos,
    /// The trigger, the violating step, then the latest sample of each signal of the monitor; each step once.
    pub counterexample: Vec<SeenStep>,
    /// The values of the monitor's signals at that time, so far as they had any.
    pub values: Vec<(SignalId, Value)>,
}

/// What a monitor did at an instant, for those who tell its story.
#[derive(Clone, Debug, PartialEq)]
pub struct MonitorHappening {
    pub time: Nanos,
    /// The step that did it; `None`: a deadline.
    pub step: Option<usize>,
    pub effects: Vec<MonitorEffect>,
    /// Whether an obligation is pending from then on, and by when it has to be met.
    pub pending: bool,
    pub due: Option<Nanos>,
    /// The values of the monitor's signals, so far as they have any; only of what fails.
    pub values: Vec<(SignalId, Value)>,
}
