//! One test of a campaign.

use hrdsl_ir::{coverage::BinName, test::TestMethod};
use hrdsl_trace::RunEnd;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    code::CoverageRatios,
    interface::UnservedWait,
    judgement::TraceJudgement,
    log::LogSummary,
    names::{SuiteName, TestName},
    prediction::{PredictionVerdict, UnmetAwait},
    schema,
};

/// One test.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TestResult {
    pub name: TestName,
    pub suite: SuiteName,
    #[schemars(schema_with = "schema::test_method")]
    pub method: TestMethod,
    pub seed: u64,
    #[schemars(schema_with = "schema::run_end")]
    pub ended: RunEnd,
    /// Of a test in error: what happened, with the program's last output.
    pub error: Option<String>,
    /// What must be known about the run to trust it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub marks: Vec<RunMark>,
    /// What programs waited for in vain until the test was over.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub waits: Vec<UnservedWait>,
    /// What its programs have logged; left out if they have not.
    #[serde(default, skip_serializing_if = "LogSummary::is_empty")]
    pub log: LogSummary,
    /// Simulated seconds.
    pub duration: f64,
    #[serde(flatten)]
    pub judgement: TraceJudgement,
    /// The bins that the model predicted.
    #[schemars(with = "Vec<String>")]
    pub predicted: Vec<BinName>,
    /// Whether the run went as the model said; left out where nothing was predicted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub prediction: Option<PredictionVerdict>,
    /// The awaits of the test that came to nothing, in the order in which they were given up.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unmet: Vec<UnmetAwait>,
    /// Where the test came from.
    pub because: Vec<String>,
    pub code: CoverageRatios,
    /// The test's steps as they are written.
    pub steps: Vec<String>,
    /// What the program wrote.
    pub output: OutputSummary,
    /// How exact the physics was; left out where there is none, or where it was exact.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub physics: Option<PhysicsAccuracy>,
}

/// How far the physics strayed at worst in a run from what cannot be: rigid bodies in each other, joints beyond their limits or
/// apart.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PhysicsAccuracy {
    /// Of two bodies of one robot.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub self_penetration: Option<BodyPenetration>,
    /// Of any two others. Surfaces that yield are meant to be pressed in, and do not count.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub penetration: Option<BodyPenetration>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub beyond_limit: Option<LimitExcess>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joint_gap: Option<JointGap>,
}

/// Two rigid bodies that were in each other.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BodyPenetration {
    /// m
    pub depth: f64,
    pub bodies: [String; 2],
}

/// A joint that was beyond one of its limits.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LimitExcess {
    /// rad, or m of a slider
    pub by: f64,
    pub joint: String,
}

/// A joint whose two sides were apart.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct JointGap {
    /// m
    pub apart: f64,
    pub joint: String,
}

/// Something about a run that limits what its verdicts say.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
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
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct OutputSummary {
    pub stdout_bytes: u64,
    pub stderr_bytes: u64,
    /// The last lines on standard error.
    pub stderr_end: String,
}

impl TestResult {
    /// Whether any requirement was violated.
    #[must_use]
    pub fn has_failed(&self) -> bool {
        self.judgement.has_failed()
    }

    /// The test is in error after all: what befell it besides its run. A violation still counts.
    pub fn break_off(&mut self, why: String) {
        self.ended = RunEnd::Error;
        self.error.get_or_insert(why);
        self.judgement.break_off();
        self.prediction = self.prediction.as_ref().map(|_| PredictionVerdict::broken_off());
    }
}
