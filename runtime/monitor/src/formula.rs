//! Requirements that are formulas, among those that are automata.

use hrdsl_ir::{Nanos, Program, monitor::MonitorEffect};
use hrdsl_metric::{CheckedFormula, FormulaJudgement, FormulaMonitor};
use hrdsl_trace::{TraceObserver, TraceStep, TraceStepKind};

use crate::{
    enter, pattern_key,
    verdict::{MonitorHappening, MonitorVerdict, Violation},
};

/// The formulas among a program's requirements, each with its place among them.
#[derive(Clone, Debug)]
pub(crate) struct RequiredFormulas {
    formulas: Vec<(usize, FormulaMonitor)>,
    /// For each event, and for each signal, of the program the formulas that name it.
    by_event: Vec<Vec<usize>>,
    by_signal: Vec<Vec<usize>>,
}

impl RequiredFormulas {
    pub fn new(program: &Program) -> Self {
        let checked = program.monitors.iter().enumerate();
        let formulas: Vec<(usize, FormulaMonitor)> = checked
            .filter_map(|(index, monitor)| {
                CheckedFormula::of_monitor(monitor).map(|formula| (index, FormulaMonitor::new(&formula)))
            })
            .collect();
        let mut by_event = vec![Vec::new(); program.events.len()];
        let mut by_signal = vec![Vec::new(); program.signals.len()];
        for (place, (_, formula)) in formulas.iter().enumerate() {
            formula.formula().events().for_each(|p| enter(&mut by_event, pattern_key(p), place));
            let signals = formula.formula().signals().iter();
            signals.for_each(|signal| enter(&mut by_signal, usize::from(signal.0), place));
        }
        Self { formulas, by_event, by_signal }
    }

    pub fn step(&mut self, index: usize, step: &TraceStep) {
        let readers = match &step.what {
            TraceStepKind::Event { event, .. } => self.by_event.get(usize::from(event.0)),
            TraceStepKind::Sample { signal, .. } => self.by_signal.get(usize::from(signal.0)),
            TraceStepKind::Machine(_) => None,
        };
        for place in readers.into_iter().flatten() {
            if let Some((_, formula)) = self.formulas.get_mut(*place) {
                formula.step(index, step);
            }
        }
    }

    /// The verdicts at the end of the run, each with what there is to tell of it: its first violation.
    pub fn finish(self, end: Nanos) -> Vec<(MonitorVerdict, Vec<MonitorHappening>)> {
        let told = |(index, mut formula): (usize, FormulaMonitor)| {
            formula.end(end);
            // Of comparisons of different units there is no least.
            let is_measured = formula.formula().unit.is_some();
            told(index, formula.finish(), is_measured)
        };
        self.formulas.into_iter().map(told).collect()
    }
}

fn told(
    index: usize,
    judged: FormulaJudgement,
    is_measured: bool,
) -> (MonitorVerdict, Vec<MonitorHappening>) {
    let FormulaJudgement { outcome, steps, unseen: _ } = judged;
    let first_failure = outcome.first_failure.map(|time| {
        let here = steps.iter().rfind(|seen| seen.step.time == time);
        let sample = |what: &TraceStepKind| match what {
            TraceStepKind::Sample { signal, value } => Some((*signal, *value)),
            TraceStepKind::Event { .. } | TraceStepKind::Machine(_) => None,
        };
        Violation {
            time,
            step: here.map(|seen| seen.index),
            trigger_time: time,
            values: steps.iter().filter_map(|seen| sample(&seen.step.what)).collect(),
            counterexample: steps,
        }
    });
    let happenings = first_failure.iter().map(|violation| MonitorHappening {
        time: violation.time,
        step: violation.step,
        effects: vec![MonitorEffect::Fail],
        pending: false,
        due: None,
        values: violation.values.clone(),
    });
    let happenings = happenings.collect();
    let verdict = MonitorVerdict {
        monitor: index,
        outcome: outcome.outcome,
        triggered: outcome.triggered,
        discharged: 0,
        failures: outcome.failures,
        worst_margin: outcome
            .margin()
            .filter(|_| is_measured)
            .map(|margin| (margin, outcome.first_failure.unwrap_or_default())),
        first_failure,
        pending_since: None,
        unvalued: outcome.unvalued,
    };
    (verdict, happenings)
}
