//! What comes of a formula's text.

use hrdsl_ir::{EventPattern, Expr, Unit, formula::MetricGoal, monitor::Monitor, world::SignalId};

use crate::atom::AtomSource;

/// A formula over the signals and events of a scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckedFormula {
    pub goal: MetricGoal,
    /// What the goal's atoms are.
    pub(crate) atoms: Vec<AtomSource>,
    /// As they are written.
    pub(crate) texts: Vec<String>,
    /// The signals that they read.
    pub(crate) signals: Vec<SignalId>,
    /// The unit of all comparisons of numbers; `None`: there are none, or they are of different units, and no margin is told.
    pub unit: Option<Unit>,
}

impl CheckedFormula {
    /// That of a requirement, if it is a formula.
    #[must_use]
    pub fn of_monitor(monitor: &Monitor) -> Option<Self> {
        let formula = monitor.formula.as_ref()?;
        Some(Self {
            goal: formula.goal.clone(),
            atoms: formula.atoms.iter().map(|atom| AtomSource::of(&atom.what)).collect(),
            texts: formula.atoms.iter().map(|atom| atom.text.clone()).collect(),
            signals: monitor.signals.clone(),
            unit: formula.unit,
        })
    }

    /// Whether an atom is an event, or a signal and nothing else.
    #[must_use]
    pub fn is_told_by_itself(&self, atom: usize) -> bool {
        match self.atoms.get(atom) {
            Some(AtomSource::Happens(_) | AtomSource::Truth(_)) => true,
            Some(AtomSource::Holds(condition)) => matches!(condition, Expr::Var(_)),
            Some(AtomSource::Less { .. } | AtomSource::Equal { .. } | AtomSource::Is { .. }) | None => false,
        }
    }

    /// How an atom is written.
    #[must_use]
    pub fn atom_text(&self, atom: usize) -> &str {
        self.texts.get(atom).map_or("?", String::as_str)
    }

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
            | AtomSource::Holds(_)
            | AtomSource::Is { .. } => None,
        })
    }
}
