//! What comes of a formula's text.

use hrdsl_ir::{Unit, world::SignalId};

use crate::{atom::AtomSource, formula::MetricGoal};

/// A formula over the signals and events of a scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckedFormula {
    pub goal: MetricGoal,
    /// What the goal's atoms are.
    pub(crate) atoms: Vec<AtomSource>,
    /// The signals that they read.
    pub(crate) signals: Vec<SignalId>,
    /// The unit of all comparisons of numbers; `None`: there are none, or they are of different units, and no margin is told.
    pub unit: Option<Unit>,
}
