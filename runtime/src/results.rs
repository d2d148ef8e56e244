//! What a campaign found, as data: `results.json`, and what every report is made from.
//!
//! Nothing in it depends on wall-clock time, on the machine or on the number of workers: the same campaign gives the same
//! bytes.

use hrdsl_ir::{Nanos, Program, Span, value::seconds};
use hrdsl_sut::FileCoverage;
use serde::Serialize;

use crate::testgen::{Explanation, GoalReport, ModelCoverage};

/// A whole campaign.
#[derive(Clone, Debug, Serialize)]
pub struct Results {
    pub scenario: String,
    /// The version of hrdsl that made it.
    pub version: String,
    /// The seed of the campaign.
    pub seed: u64,
    pub requirements: Vec<Requirement>,
    pub suites: Vec<SuiteInfo>,
    pub bins: Vec<BinResult>,
    pub code: Vec<CodeFile>,
    /// In the order in which they were given.
    pub tests: Vec<TestResult>,
}

/// A requirement with its tally in each suite.
#[derive(Clone, Debug, Serialize)]
pub struct Requirement {
    pub name: String,
    /// `safety` or `functional`
    pub kind: String,
    pub title: String,
    pub text: String,
    /// One for each of [`Results::suites`].
    pub tally: Vec<Tally>,
    /// The tests with a violation, in order.
    pub failing: Vec<String>,
    /// The least margin over all tests, with its test.
    pub worst_margin: Option<Margin>,
    #[serde(skip)]
    pub origin: Span,
}

/// How many tests had each verdict.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Tally {
    pub pass: u32,
    pub fail: u32,
    pub not_checked: u32,
    pub open: u32,
    pub error: u32,
}

#[derive(Clone, Debug, Serialize)]
pub struct Margin {
    pub value: f64,
    pub unit: &'static str,
    pub test: String,
}

/// A suite, as far as its tests were made in this campaign.
#[derive(Clone, Debug, Serialize)]
pub struct SuiteInfo {
    pub name: String,
    /// `agents`, `search`, `random`, `hand`
    pub method: String,
    /// How many different abstract tests; `None` if the tests were read from a file.
    pub abstract_tests: Option<usize>,
    pub tests: u32,
    pub errors: u32,
    pub goals: Vec<GoalReport>,
    /// Of a suite by agents: what was reached of their programs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model: Option<ModelCoverage>,
    /// Of a suite by agents: what each test is for, and why goals stayed uncovered.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub explanation: Option<Explanation>,
    pub notes: Vec<String>,
    /// Lines and branches executed by any of the suite's tests, over all files.
    pub code: Ratios,
    /// Accumulated percentage of lines after each test, in order.
    pub code_accumulated: Vec<f64>,
    /// Percentage of lines of each test alone, in order.
    pub code_per_test: Vec<f64>,
}

/// A cross-product bin.
#[derive(Clone, Debug, Serialize)]
pub struct BinResult {
    /// `human_robot.4 legs, bored`
    pub name: String,
    pub cross: String,
    pub bin: String,
    /// Tests that hit it, one number for each of [`Results::suites`].
    pub hits: Vec<u32>,
    /// Tests for which the model predicted it, one number for each suite.
    pub predicted: Vec<u32>,
    /// The first test that hit it.
    pub first: Option<String>,
    /// If the search proved that the model cannot reach it: the reason.
    pub unreachable: Option<String>,
}

/// Executed and all, of lines and of branches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Ratios {
    pub lines: u32,
    pub lines_total: u32,
    pub branches: u32,
    pub branches_total: u32,
}

impl Ratios {
    /// Lines executed, in percent; 100 of nothing.
    #[must_use]
    pub fn line_percent(self) -> f64 {
        percent(self.lines, self.lines_total)
    }

    #[must_use]
    pub fn branch_percent(self) -> f64 {
        percent(self.branches, self.branches_total)
    }
}

fn percent(part: u32, whole: u32) -> f64 {
    if whole == 0 { 100.0 } else { (f64::from(part) * 1000.0 / f64::from(whole)).round() / 10.0 }
}

/// A source file of the system under test, over the whole campaign.
#[derive(Clone, Debug, Serialize)]
pub struct CodeFile {
    pub file: String,
    pub ratios: Ratios,
    /// For each executable line the number of tests that executed it.
    pub lines: Vec<(u32, u32)>,
    /// Branches that no test took, as (line, next line).
    pub missed_branches: Vec<(u32, i32)>,
    /// The text, for the report; empty if it could not be read.
    #[serde(skip)]
    pub source: String,
}

/// One test.
#[derive(Clone, Debug, Serialize)]
pub struct TestResult {
    pub name: String,
    pub suite: String,
    pub method: String,
    pub seed: u64,
    /// `quiet`: nothing more could happen; `limit`; `error`
    pub ended: &'static str,
    /// Of a test in error: what happened, with the program's last output.
    pub error: Option<String>,
    /// Simulated seconds.
    pub duration: f64,
    /// One for each requirement, in order.
    pub verdicts: Vec<VerdictResult>,
    /// The cross-product bins that were hit.
    pub bins: Vec<String>,
    /// Those that the model predicted.
    pub predicted: Vec<String>,
    /// Where the test came from.
    pub because: Vec<String>,
    pub code: Ratios,
    /// The test's steps as they are written.
    pub steps: Vec<String>,
    #[serde(skip)]
    pub files: Vec<FileCoverage>,
}

impl TestResult {
    /// Whether any requirement was violated.
    #[must_use]
    pub fn has_failed(&self) -> bool {
        self.verdicts.iter().any(|v| v.outcome == "fail")
    }
}

#[derive(Clone, Debug, Serialize)]
pub struct VerdictResult {
    pub requirement: String,
    /// `pass`, `fail`, `not_checked`, `open`; `error` if the test broke off before a violation
    pub outcome: &'static str,
    pub triggered: u32,
    pub failures: u32,
    pub failure: Option<Failure>,
    pub worst_margin: Option<(f64, &'static str)>,
}

/// The first violation in a test.
#[derive(Clone, Debug, Serialize)]
pub struct Failure {
    /// Seconds.
    pub time: f64,
    /// When the violated obligation was made.
    pub triggered_at: f64,
    /// `true`: a deadline passed; `false`: the last witness violates.
    pub deadline: bool,
    pub witness: Vec<WitnessStep>,
}

/// A step of the trace that bears out a verdict.
#[derive(Clone, Debug, Serialize)]
pub struct WitnessStep {
    /// Its place in the trace's steps, from 0: line `step + 2` of the recording.
    pub step: usize,
    /// Seconds.
    pub time: f64,
    /// For people.
    pub text: String,
}

/// Seconds for a report.
#[must_use]
pub fn in_seconds(time: Nanos) -> f64 {
    seconds(time)
}

/// The requirement table without tallies.
#[must_use]
pub fn requirements(program: &Program, suites: usize) -> Vec<Requirement> {
    let of = |m: &hrdsl_ir::monitor::Monitor| Requirement {
        name: m.name.clone(),
        kind: match m.kind {
            hrdsl_ir::monitor::RequirementKind::Safety => "safety".to_owned(),
            hrdsl_ir::monitor::RequirementKind::Functional => "functional".to_owned(),
        },
        title: m.title.clone(),
        text: m.text.clone(),
        tally: vec![Tally::default(); suites],
        failing: Vec::new(),
        worst_margin: None,
        origin: m.origin,
    };
    program.monitors.iter().map(of).collect()
}
