//! The judgement on one run: verdicts, bins, and conformance to models.

use hrdsl_ir::coverage::BinName;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{conformance::ConformanceVerdict, machine::MachineCoverage, names::RequirementName};

/// What a trace says about the requirements, and what it covers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TraceJudgement {
    /// One for each requirement, in order.
    pub verdicts: Vec<VerdictResult>,
    /// The cross-product bins that were hit, in order.
    #[schemars(with = "Vec<String>")]
    pub bins: Vec<BinName>,
    /// What was reached of the system's state machines.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub machines: Vec<MachineCoverage>,
    /// By each model of the system, whether what the code did is what the model does; left out if there is no model.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub conformance: Vec<ConformanceVerdict>,
}

/// What a run says about a requirement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum VerdictOutcome {
    /// It was triggered, and held.
    Pass,
    /// It was violated at least once.
    Fail,
    /// It was never triggered.
    Vacuous,
    /// It was not violated, but the run ended while an obligation was pending.
    Inconclusive,
    /// The run broke off before a violation.
    Error,
}

impl VerdictOutcome {
    /// As results, reports and recordings write it.
    pub fn name(self) -> &'static str {
        match self {
            VerdictOutcome::Pass => "pass",
            VerdictOutcome::Fail => "fail",
            VerdictOutcome::Vacuous => "vacuous",
            VerdictOutcome::Inconclusive => "inconclusive",
            VerdictOutcome::Error => "error",
        }
    }
}

impl VerdictOutcome {
    pub const ALL: [VerdictOutcome; 5] = [
        VerdictOutcome::Pass,
        VerdictOutcome::Fail,
        VerdictOutcome::Vacuous,
        VerdictOutcome::Inconclusive,
        VerdictOutcome::Error,
    ];
}

/// The verdict on a requirement, with what bears it out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct VerdictResult {
    pub requirement: RequirementName,
    pub outcome: VerdictOutcome,
    /// How often it was triggered.
    pub triggered: u32,
    /// How often it was violated.
    pub failures: u32,
    /// The first violation.
    pub failure: Option<FirstFailure>,
    /// The least margin, with the symbol of its unit.
    pub worst_margin: Option<(f64, String)>,
    /// When a comparison first had no value, in seconds: why what has not failed is inconclusive.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unvalued: Option<f64>,
}

/// The first violation in a test.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FirstFailure {
    /// Seconds.
    pub time: f64,
    /// When the violated obligation was made, in seconds.
    pub triggered_at: f64,
    /// `true`: a deadline passed; `false`: the last step of the counterexample violates.
    pub deadline: bool,
    /// The steps that show it, in order.
    pub counterexample: Vec<CounterexampleStep>,
    /// What the requirement consists of, around it; left out unless it was asked for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub around: Vec<SubformulaValues>,
}

/// A part of a requirement over time: a number, a condition or an event.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SubformulaValues {
    /// As the language writes it.
    pub text: String,
    /// The symbol of its unit; empty if it has none.
    pub unit: String,
    /// Whether it is an event, which happens at the times that are told.
    pub event: bool,
    /// In order of time, each new value: the first is at the beginning of the time that was asked for, if it had one then.
    pub values: Vec<SubformulaValue>,
}

/// The value of a part of a requirement from a time on, or that an event happens at it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SubformulaValue {
    /// Seconds.
    pub time: f64,
    /// `true` at the time of an event. A number in the unit of the part, a truth, or what else a signal says.
    pub value: SubformulaReading,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum SubformulaReading {
    Truth(bool),
    Number(f64),
    Word(String),
}

/// A step of the trace that bears out a verdict.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CounterexampleStep {
    /// Its place in the trace's steps, from 0: line `step + 2` of the recording.
    pub step: usize,
    /// Seconds.
    pub time: f64,
    /// For people.
    pub text: String,
}

impl TraceJudgement {
    /// Whether any requirement was violated.
    #[must_use]
    pub fn has_failed(&self) -> bool {
        self.verdicts.iter().any(|v| v.outcome == VerdictOutcome::Fail)
    }

    /// The run broke off: it can show a violation, but nothing else. What it did not do, it might have done.
    pub fn break_off(&mut self) {
        self.bins.clear();
        for verdict in self.verdicts.iter_mut().filter(|v| v.outcome != VerdictOutcome::Fail) {
            verdict.outcome = VerdictOutcome::Error;
        }
        self.conformance.iter_mut().for_each(ConformanceVerdict::break_off);
    }
}
