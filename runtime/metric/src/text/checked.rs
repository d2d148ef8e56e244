//! What comes of a formula's text.

use hrdsl_ir::{EventPattern, Unit, world::SignalId};

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

impl CheckedFormula {
    /// The signals that it reads.
    #[must_use]
    pub fn signals(&self) -> &[SignalId] {
        &self.signals
    }

    /// The events that it names, each once.
    pub fn events(&self) -> impl Iterator<Item = &EventPattern> {
        self.atoms.iter().filter_map(|atom| match atom {
            AtomSource::Happens(pattern) => Some(pattern),
            AtomSource::Less { .. }
            | AtomSource::Equal { .. }
            | AtomSource::Truth(_)
            | AtomSource::Is { .. } => None,
        })
    }
}
