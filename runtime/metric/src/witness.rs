//! A formula over a trace, with what it read at its first violation: the latest samples of its signals, and the events that happened.
//!
//! A window into the future shows only later that a moment failed. So the steps of so much time are kept, and no more.

use std::collections::VecDeque;

use hrdsl_ir::{Nanos, world::SignalId};
use hrdsl_trace::{SeenStep, TraceObserver, TraceStep, TraceStepKind};

use crate::{evaluator::MetricOutcome, run::MetricRunner, text::CheckedFormula};

/// So many steps are kept before it is asked which of them are still needed.
const BLOCK: usize = 1024;

/// What a formula comes to on a trace, and what is told besides.
#[derive(Clone, Debug)]
pub struct FormulaJudgement {
    pub outcome: MetricOutcome,
    /// What it read at its first violation, in the order of the trace.
    pub steps: Vec<SeenStep>,
    /// Signals without any value.
    pub unseen: Vec<SignalId>,
}

/// A formula at work on one trace.
#[derive(Clone, Debug)]
pub struct FormulaMonitor {
    formula: CheckedFormula,
    runner: MetricRunner,
    kept: KeptSteps,
    /// When so many steps are kept, it is asked which are needed.
    full: usize,
    /// The first violation that is known, with what it read.
    found: Option<(Nanos, Vec<SeenStep>)>,
}

/// The steps that a formula has read, as far as they may still be asked for.
#[derive(Clone, Debug)]
struct KeptSteps {
    /// For each signal of the formula the last sample that is not kept any more.
    before: Vec<Option<SeenStep>>,
    steps: VecDeque<SeenStep>,
}

impl FormulaMonitor {
    #[must_use]
    pub fn new(formula: &CheckedFormula) -> Self {
        let before = vec![None; formula.signals.len()];
        Self {
            runner: MetricRunner::new(formula),
            formula: formula.clone(),
            kept: KeptSteps { before, steps: VecDeque::new() },
            full: BLOCK,
            found: None,
        }
    }

    #[must_use]
    pub fn formula(&self) -> &CheckedFormula {
        &self.formula
    }

    /// What the run comes to, once it has ended; up to then, what it would come to if it ended with its latest step.
    #[must_use]
    pub fn finish(self) -> FormulaJudgement {
        let unseen = self.runner.unseen().collect();
        let outcome = self.runner.outcome();
        let steps = match (outcome.first_failure, self.found) {
            (Some(time), Some((found, steps))) if time == found => steps,
            (Some(time), _) => self.kept.at(&self.formula, time),
            (None, _) => Vec::new(),
        };
        FormulaJudgement { outcome, steps, unseen }
    }

    /// Whether the formula names what happens in this step.
    fn reads(&self, what: &TraceStepKind) -> bool {
        match what {
            TraceStepKind::Sample { signal, .. } => self.formula.signals.contains(signal),
            TraceStepKind::Event { event, args } => {
                self.formula.events().any(|pattern| pattern.matches(*event, args))
            }
            TraceStepKind::Machine(_) => false,
        }
    }

    /// Of a violation that is known by now, what it read is put aside; then what no later one can be at is dropped.
    fn drop_what_is_decided(&mut self) {
        let (known, failure) = self.runner.settle();
        if let Some(time) = failure
            && self.found.as_ref().is_none_or(|(found, _)| *found != time)
        {
            self.found = Some((time, self.kept.at(&self.formula, time)));
        }
        // What comes to light later lies no further back.
        self.kept.drop_before(&self.formula, known.saturating_sub(self.formula.goal.horizon()));
        self.full = BLOCK.max(self.kept.steps.len().saturating_mul(2));
    }
}

impl KeptSteps {
    /// What the formula read at this time.
    fn at(&self, formula: &CheckedFormula, time: Nanos) -> Vec<SeenStep> {
        let mut samples = self.before.clone();
        let mut events = Vec::new();
        for seen in self.steps.iter().take_while(|seen| seen.step.time <= time) {
            match &seen.step.what {
                TraceStepKind::Sample { signal, .. } => {
                    if let Some(place) = slot(formula, *signal).and_then(|at| samples.get_mut(at)) {
                        *place = Some(seen.clone());
                    }
                }
                TraceStepKind::Event { .. } if seen.step.time == time => events.push(seen.clone()),
                TraceStepKind::Event { .. } | TraceStepKind::Machine(_) => {}
            }
        }
        let mut steps: Vec<SeenStep> = samples.into_iter().flatten().chain(events).collect();
        steps.sort_by_key(|step| step.index);
        steps
    }

    fn drop_before(&mut self, formula: &CheckedFormula, time: Nanos) {
        while let Some(seen) = self.steps.pop_front_if(|seen| seen.step.time < time) {
            let TraceStepKind::Sample { signal, .. } = &seen.step.what else { continue };
            if let Some(place) = slot(formula, *signal).and_then(|at| self.before.get_mut(at)) {
                *place = Some(seen);
            }
        }
    }
}

fn slot(formula: &CheckedFormula, signal: SignalId) -> Option<usize> {
    formula.signals.iter().position(|of| *of == signal)
}

impl TraceObserver for FormulaMonitor {
    fn step(&mut self, index: usize, step: &TraceStep) {
        self.runner.step(index, step);
        if self.reads(&step.what) {
            self.kept.steps.push_back(SeenStep { index, step: step.clone() });
            if self.kept.steps.len() >= self.full {
                self.drop_what_is_decided();
            }
        }
    }

    fn end(&mut self, time: Nanos) {
        self.runner.end(time);
    }
}
