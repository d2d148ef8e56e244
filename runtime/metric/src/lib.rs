//! Metric temporal formulas over a run: whether they hold, and by how much.
//!
//! Operators with windows look into the past (`once`, `historically`, `since`) and into the future (`eventually`, `always`, `until`), over signals that
//! keep their value from sample to sample and events that happen at one moment. Time is whole nanoseconds, and so one semantics serves signals that are sampled
//! regularly and irregularly, a run that goes on and one that has ended: `spec/metric.md` defines it.
//!
//! # Steps
//! 1. [`read_formula`] gives the names, types and units of a scenario to a text; a requirement that is a formula has them already;
//! 2. [`MetricRunner`] is shown the trace, step by step, and makes numbers of what the formula names;
//! 3. [`MetricEvaluator`] takes these numbers, each change once, and carries along what comes of the [`MetricGoal`]: windows of any length cost a constant
//!    time for each change, and memory for the changes inside;
//! 4. [`FormulaMonitor`] keeps what its windows hold of the trace, so that a violation is told with the steps that bear it out;
//! 5. [`MetricOutcome`] is what it comes to, with bounds of the [`Robustness`] where windows go beyond the end.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::wildcard_enum_match_arm))]

mod atom;
mod engine;
mod evaluator;
mod fold;
mod measured;
mod robustness;
mod run;
mod story;
mod text;
mod witness;

pub use engine::piece::SignalPiece;
pub use evaluator::{MetricEvaluator, MetricOutcome, RobustnessOverTime, robustness_over_time};
pub use hrdsl_ir::formula::{FutureWindow, MetricFormula, MetricGoal, PastWindow};
pub use measured::{MeasuredTruth, outcome_of_measured};
pub use robustness::Robustness;
pub use run::{AtomsOverTime, MetricRunner};
pub use story::{AskedSpan, FormulaSpan, FormulaStory};
pub use text::{
    CheckedFormula, FormulaError, TextRange, read_formula,
    units::{LITERAL_UNITS, LiteralUnit},
};
pub use witness::{FormulaJudgement, FormulaMonitor};
