//! What a formula read at a moment: the latest samples of its signals, and the events that happened.

use hrdsl_ir::Nanos;
use hrdsl_monitor::SeenStep;
use hrdsl_trace::{TraceObserver, TraceStep, TraceStepKind};

use crate::{atom::AtomSource, text::CheckedFormula};

/// Looks for the steps that a formula read at one moment, in the trace in which it was judged.
#[derive(Clone, Debug)]
pub struct FormulaWitness {
    formula: CheckedFormula,
    time: Nanos,
    /// For each signal of the formula.
    samples: Vec<Option<SeenStep>>,
    events: Vec<SeenStep>,
}

impl FormulaWitness {
    #[must_use]
    pub fn new(formula: &CheckedFormula, time: Nanos) -> Self {
        let samples = vec![None; formula.signals.len()];
        Self { formula: formula.clone(), time, samples, events: Vec::new() }
    }

    /// The steps, in order.
    #[must_use]
    pub fn steps(self) -> Vec<SeenStep> {
        let mut steps: Vec<SeenStep> = self.samples.into_iter().flatten().chain(self.events).collect();
        steps.sort_by_key(|step| step.index);
        steps
    }
}

impl TraceObserver for FormulaWitness {
    fn step(&mut self, index: usize, step: &TraceStep) {
        if step.time > self.time {
            return;
        }
        let seen = || SeenStep { index, step: step.clone() };
        match &step.what {
            TraceStepKind::Sample { signal, .. } => {
                let places = self.formula.signals.iter().zip(&mut self.samples);
                places.filter(|(of, _)| **of == *signal).for_each(|(_, place)| *place = Some(seen()));
            }
            TraceStepKind::Event { event, args } if step.time == self.time => {
                let happens = |atom: &AtomSource| match atom {
                    AtomSource::Happens(pattern) => pattern.matches(*event, args),
                    AtomSource::Less { .. }
                    | AtomSource::Equal { .. }
                    | AtomSource::Truth(_)
                    | AtomSource::Is { .. } => false,
                };
                if self.formula.atoms.iter().any(happens) {
                    self.events.push(seen());
                }
            }
            TraceStepKind::Event { .. } | TraceStepKind::Machine(_) => {}
        }
    }

    fn end(&mut self, _: Nanos) {}
}
