//! Judgement: from a [`Program`] and a trace to verdicts, bins and conformance to models, whoever made the trace, and from tests to a campaign's results.
//!
//! A campaign judges the trace of each run, and `hrdsl judge` a recording; both do it here, so that a recording has the
//! verdicts of its run.
//!
//! # Steps
//! 1. [`TraceJudge::new`] readies the requirements' monitors, the coverpoints and the models of the system;
//! 2. the trace is shown to it, step by step ([`TraceObserver`]), in memory that does not grow with the trace;
//! 3. [`TraceJudge::finish`] gives the [`TraceJudgement`], and what the state machines of the system consist of.
//!
//! [`judge_recording`] does all three with a recording, which it reads in one pass; [`judge_by_formulas`] judges one by [`NamedFormula`]s, too. [`tell_values_around`] adds the values of what a violated requirement consists of. [`tally`] adds up the tests that were judged.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::wildcard_enum_match_arm))]

mod around;
mod formula;
mod formula_parts;
mod machines;
mod recording;
mod tally;

use hrdsl_conformance::{ConformanceChecker, ConformanceOptions};
use hrdsl_coverage::{CoverageCollector, MachineCollector, MachineHits};
use hrdsl_ir::{Nanos, Program, monitor::Monitor, value::seconds};
use hrdsl_monitor::{MonitorOutcome, MonitorRunner, MonitorVerdict, SeenStep};
use hrdsl_results::{
    CounterexampleStep, FirstFailure, MachineCoverage, TraceJudgement, VerdictOutcome, VerdictResult,
};
use hrdsl_trace::{MachineDeclaration, RunEnd, TraceObserver, TraceStep, TraceStepKind, print};

pub use around::tell_values_around;
pub use formula::NamedFormula;
pub use hrdsl_metric::FormulaError;
pub use recording::{
    JudgeError, JudgedRecording, UnseenSignal, judge_by_formulas, judge_recording, recorded_run,
};
pub use tally::{CampaignOutcome, FinishedTest, tally};

/// Judges one trace.
#[derive(Debug)]
pub struct TraceJudge<'p> {
    program: &'p Program,
    checker: MonitorRunner,
    collector: CoverageCollector,
    machines: MachineCollector,
    conformance: ConformanceChecker<'p>,
}

impl<'p> TraceJudge<'p> {
    /// `options` say how the trace shows what the code did.
    #[must_use]
    pub fn new(program: &'p Program, options: &ConformanceOptions) -> Self {
        Self {
            program,
            checker: MonitorRunner::new(program),
            collector: CoverageCollector::new(program),
            machines: MachineCollector::default(),
            conformance: ConformanceChecker::new(program, options),
        }
    }

    /// The judgement on a run that ended like this, and what the state machines in it consist of. A run that broke off can show
    /// a violation, and what was executed, but nothing else.
    #[must_use]
    pub fn finish(self, ended: RunEnd) -> (TraceJudgement, Vec<MachineDeclaration>) {
        let (machines, declared) = self.machines.finish().into_iter().map(machine_coverage).unzip();
        let verdicts = self.checker.verdicts();
        let mut judgement = TraceJudgement {
            verdicts: verdicts.iter().map(|v| verdict_result(self.program, v)).collect(),
            bins: self.collector.finish().cross_names(&self.program.coverage),
            machines,
            conformance: self.conformance.finish(ended),
        };
        if ended == RunEnd::Error {
            judgement.break_off();
        }
        (judgement, declared)
    }
}

impl TraceObserver for TraceJudge<'_> {
    fn step(&mut self, index: usize, step: &TraceStep) {
        self.checker.step(index, step);
        self.conformance.step(index, step);
        match &step.what {
            TraceStepKind::Event { event, args } => self.collector.event(*event, args),
            TraceStepKind::Machine(step) => self.machines.step(step),
            TraceStepKind::Sample { .. } => {}
        }
    }

    fn end(&mut self, time: Nanos) {
        self.checker.end(time);
        self.conformance.end(time);
    }
}

fn machine_coverage(hits: MachineHits) -> (MachineCoverage, MachineDeclaration) {
    let MachineHits { declared, entered, taken } = hits;
    let transitions = declared.transitions.iter().filter(|t| taken.contains(t));
    let coverage = MachineCoverage {
        machine: declared.machine.clone(),
        states: declared.states.iter().filter(|s| entered.contains(*s)).cloned().collect(),
        transitions: transitions.map(ToString::to_string).collect(),
    };
    (coverage, declared)
}

#[expect(clippy::indexing_slicing, reason = "the verdicts are of this program's monitors")]
fn verdict_result(program: &Program, verdict: &MonitorVerdict) -> VerdictResult {
    let monitor = &program.monitors[verdict.monitor];
    let unit = monitor.margin_unit().map_or("", |unit| unit.symbol());
    VerdictResult {
        requirement: monitor.name.as_str().into(),
        outcome: outcome_of(verdict.outcome),
        triggered: verdict.triggered,
        failures: verdict.failures,
        failure: failure(program, monitor, verdict),
        worst_margin: verdict.worst_margin.map(|(value, _)| (value, unit.to_owned())),
        unvalued: verdict.unvalued.map(seconds),
    }
}

fn failure(program: &Program, monitor: &Monitor, verdict: &MonitorVerdict) -> Option<FirstFailure> {
    let violation = verdict.first_failure.as_ref()?;
    Some(FirstFailure {
        time: seconds(violation.time),
        triggered_at: seconds(violation.trigger_time),
        // Of a formula the moment is told that failed, whatever showed it.
        deadline: violation.step.is_none() && monitor.formula.is_none(),
        counterexample: counterexample(program, &violation.counterexample),
        around: Vec::new(),
    })
}

fn outcome_of(outcome: MonitorOutcome) -> VerdictOutcome {
    match outcome {
        MonitorOutcome::Pass => VerdictOutcome::Pass,
        MonitorOutcome::Fail => VerdictOutcome::Fail,
        MonitorOutcome::Vacuous => VerdictOutcome::Vacuous,
        MonitorOutcome::Inconclusive => VerdictOutcome::Inconclusive,
    }
}

/// Steps as they are told, in order.
fn counterexample(program: &Program, steps: &[SeenStep]) -> Vec<CounterexampleStep> {
    let step = |seen: &SeenStep| {
        let (who, what) = print::who_did_what(program, &seen.step.what);
        CounterexampleStep { step: seen.index, time: seconds(seen.step.time), text: format!("{who} {what}") }
    };
    let mut counterexample: Vec<CounterexampleStep> = steps.iter().map(step).collect();
    counterexample.sort_by_key(|w| w.step);
    counterexample
}
