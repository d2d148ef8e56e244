//! Metric formulas beside the requirements: each has a name, and is judged, told and tallied as a requirement is.

use hrdsl_ir::{Nanos, Program, value::seconds, world::SignalId};
use hrdsl_metric::{CheckedFormula, FormulaError, FormulaJudgement, FormulaMonitor, read_formula};
use hrdsl_results::{FirstFailure, VerdictResult};
use hrdsl_trace::{TraceObserver, TraceStep};

use crate::{counterexample, outcome_of};

/// A formula that recordings are judged by.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedFormula {
    pub name: String,
    pub text: String,
    pub(crate) formula: CheckedFormula,
}

impl NamedFormula {
    /// # Errors
    /// A text that is no formula over the signals and events of the program.
    pub fn read(program: &Program, name: String, text: &str) -> Result<Self, FormulaError> {
        Ok(Self { name, text: text.to_owned(), formula: read_formula(program, text)? })
    }
}

/// A formula over one trace.
#[derive(Debug)]
pub(crate) struct FormulaJudge<'p> {
    named: &'p NamedFormula,
    monitor: FormulaMonitor,
}

/// What it comes to, and what is told besides.
pub(crate) struct JudgedFormula {
    pub verdict: VerdictResult,
    /// Signals without any value.
    pub unseen: Vec<SignalId>,
}

impl<'p> FormulaJudge<'p> {
    pub fn new(named: &'p NamedFormula) -> Self {
        Self { named, monitor: FormulaMonitor::new(&named.formula) }
    }

    pub fn step(&mut self, index: usize, step: &TraceStep) {
        self.monitor.step(index, step);
    }

    pub fn end(&mut self, time: Nanos) {
        self.monitor.end(time);
    }

    pub fn finish(self, program: &Program) -> JudgedFormula {
        let FormulaJudgement { outcome, steps, unseen } = self.monitor.finish();
        let unit = self.named.formula.unit.map(|unit| unit.symbol().to_owned());
        let verdict = VerdictResult {
            requirement: self.named.name.as_str().into(),
            outcome: outcome_of(outcome.outcome),
            triggered: outcome.triggered,
            failures: outcome.failures,
            failure: outcome.first_failure.map(|time| FirstFailure {
                time: seconds(time),
                triggered_at: seconds(time),
                deadline: false,
                counterexample: counterexample(program, &steps),
                around: Vec::new(),
            }),
            worst_margin: outcome.margin().zip(unit),
            unvalued: outcome.unvalued.map(seconds),
        };
        JudgedFormula { verdict, unseen }
    }
}
