//! What a campaign found, as data: `results.json`, and what every report is made from.
//!
//! Nothing in it depends on wall-clock time, on the machine or on the number of workers: the same campaign gives the same
//! bytes.

use hrdsl_ir::{Nanos, Program, Span, value::seconds};
use hrdsl_sut::FileCoverage;
use serde::Serialize;
use sha2::{Digest, Sha256};

use crate::testgen::{Explanation, GoalReport, ModelCoverage};

/// A whole campaign.
#[derive(Clone, Debug, Serialize)]
pub struct Results {
    pub scenario: String,
    /// The version of hrdsl that made it.
    pub version: String,
    /// The seed of the campaign.
    pub seed: u64,
    /// Whether the campaign was interrupted: then `tests` are those that had ended.
    pub interrupted: bool,
    /// How many tests were to be run.
    pub planned: usize,
    pub requirements: Vec<Requirement>,
    pub suites: Vec<SuiteInfo>,
    pub bins: Vec<BinResult>,
    pub code: Vec<CodeFile>,
    /// In the order in which they were given.
    pub tests: Vec<TestResult>,
    /// The command that runs one test again, up to its name, as it is typed in the folder of the results; empty if there is
    /// none.
    #[serde(skip)]
    pub rerun: String,
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
    /// What must be known about the run to trust it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub marks: Vec<RunMark>,
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
    /// What the program wrote.
    pub output: OutputSummary,
    #[serde(skip)]
    pub files: Vec<FileCoverage>,
}

/// Something about a run that limits what its verdicts say.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RunMark {
    /// Wall time ended it once, and it came to another end when it ran alone.
    DependsOnLoad,
    /// The program started other processes: their clocks and chance are not simulated.
    OtherProcesses,
}

impl RunMark {
    /// The sentence about it.
    #[must_use]
    pub fn sentence(self) -> &'static str {
        match self {
            RunMark::DependsOnLoad => "depends on load: wall time ended it, and alone it came to another end",
            RunMark::OtherProcesses => "started other processes: their clocks and chance are not simulated",
        }
    }
}

/// How much a program wrote, and the end of what it complained about.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct OutputSummary {
    pub stdout_bytes: u64,
    pub stderr_bytes: u64,
    /// The last lines on standard error.
    pub stderr_end: String,
}

impl Results {
    /// The command that runs a test again, as it is typed in the folder of the results; `None` if there is none.
    #[must_use]
    pub fn rerun_of(&self, test: &TestResult) -> Option<String> {
        let name =
            test.name.strip_prefix(&self.scenario).and_then(|n| n.strip_prefix('.')).unwrap_or(&test.name);
        let plain = name.chars().all(|c| c.is_alphanumeric() || matches!(c, '.' | '_' | '-'));
        let name = if plain { name.to_owned() } else { format!("'{}'", name.replace('\'', "'\\''")) };
        (!self.rerun.is_empty()).then(|| format!("{} {name}", self.rerun))
    }
}

impl TestResult {
    /// Whether any requirement was violated.
    #[must_use]
    pub fn has_failed(&self) -> bool {
        self.verdicts.iter().any(|v| v.outcome == "fail")
    }

    /// The test is in error after all: what befell it besides its run. A violation still counts.
    pub fn break_off(&mut self, why: String) {
        self.ended = "error";
        self.error.get_or_insert(why);
        self.bins.clear();
        for verdict in self.verdicts.iter_mut().filter(|v| v.outcome != "fail") {
            verdict.outcome = "error";
        }
    }

    /// The name of the test's files, without folder and ending: its own name, or if that is too long or cannot be the name
    /// of a file, a part of it and a digest.
    #[must_use]
    pub fn file_stem(&self) -> String {
        file_stem(&self.name)
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

/// The longest name that leaves room for an ending in any file system.
const LONGEST_STEM: usize = 200;

/// The name of a test's files, as [`TestResult::file_stem`] says.
pub(crate) fn file_stem(name: &str) -> String {
    let fits = |c: char| c.is_alphanumeric() || matches!(c, '.' | '_' | '-');
    if name.len() <= LONGEST_STEM && name.chars().all(fits) && !name.starts_with('.') {
        return name.to_owned();
    }
    let digest = Sha256::digest(name).iter().take(8).fold(0_u64, |n, byte| n << 8 | u64::from(*byte));
    let mut stem = String::new();
    for c in name.chars().map(|c| if fits(c) { c } else { '_' }) {
        if stem.len() + c.len_utf8() > LONGEST_STEM - 17 {
            break;
        }
        stem.push(c);
    }
    format!("{}-{digest:016x}", stem.trim_start_matches('.'))
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

#[cfg(test)]
mod tests {
    use super::file_stem;

    #[test]
    fn names_of_files_are_short_and_differ() {
        assert_eq!(file_stem("bdi_tests.t017"), "bdi_tests.t017");
        let (a, b) =
            (file_stem(&format!("{}a", "x".repeat(300))), file_stem(&format!("{}b", "x".repeat(300))));
        assert!(a.len() <= 200 && b.len() <= 200 && a != b, "{a} {b}");
        for odd in ["../up", "a/b", ".hidden", "a b", "ä".repeat(150).as_str()] {
            let stem = file_stem(odd);
            assert!(stem.len() <= 200 && !stem.contains('/') && !stem.starts_with('.'), "{odd}: {stem}");
        }
    }
}
