//! Requirements and bins over all tests.

use hrdsl_ir::{coverage::BinName, monitor::RequirementKind};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    judgement::VerdictOutcome,
    names::{RequirementName, TestName},
    schema,
    test::TestResult,
};

/// A requirement with its tally in each suite.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RequirementResult {
    pub name: RequirementName,
    #[schemars(schema_with = "schema::requirement_kind")]
    pub kind: RequirementKind,
    pub title: String,
    /// Its doc comment: where it comes from, such as a standard's clause.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub doc: String,
    pub text: String,
    /// One for each suite, in their order.
    pub tally: Vec<VerdictTally>,
    /// The tests with a violation, in order.
    pub failing: Vec<TestName>,
    /// How often it was triggered, and in how many tests.
    #[serde(default)]
    pub triggered: TriggerTotal,
    /// The least margin over all tests, with its test.
    pub worst_margin: Option<SmallestMargin>,
}

/// How often a requirement was triggered in all tests, and how many tests triggered it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct TriggerTotal {
    pub times: u64,
    pub tests: u32,
}

impl TriggerTotal {
    /// Counts one more test, which triggered it so often.
    pub fn add(&mut self, times: u32) {
        self.times += u64::from(times);
        self.tests += u32::from(times > 0);
    }

    /// Of a requirement in these tests.
    #[must_use]
    pub fn of<'a>(
        requirement: &RequirementName,
        tests: impl IntoIterator<Item = &'a TestResult>,
    ) -> TriggerTotal {
        let verdicts = tests.into_iter().flat_map(|test| &test.judgement.verdicts);
        let mut total = TriggerTotal::default();
        verdicts.filter(|v| v.requirement == *requirement).for_each(|v| total.add(v.triggered));
        total
    }
}

/// How many tests had each verdict.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct VerdictTally {
    pub pass: u32,
    pub fail: u32,
    pub vacuous: u32,
    pub inconclusive: u32,
    pub error: u32,
}

impl VerdictTally {
    /// Counts one more test.
    pub fn add(&mut self, outcome: VerdictOutcome) {
        *match outcome {
            VerdictOutcome::Pass => &mut self.pass,
            VerdictOutcome::Fail => &mut self.fail,
            VerdictOutcome::Vacuous => &mut self.vacuous,
            VerdictOutcome::Inconclusive => &mut self.inconclusive,
            VerdictOutcome::Error => &mut self.error,
        } += 1;
    }

    /// How many tests had this verdict.
    #[must_use]
    pub fn of(self, outcome: VerdictOutcome) -> u32 {
        match outcome {
            VerdictOutcome::Pass => self.pass,
            VerdictOutcome::Fail => self.fail,
            VerdictOutcome::Vacuous => self.vacuous,
            VerdictOutcome::Inconclusive => self.inconclusive,
            VerdictOutcome::Error => self.error,
        }
    }
}

/// How far a requirement was from being violated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SmallestMargin {
    pub value: f64,
    /// The symbol.
    pub unit: String,
    pub test: TestName,
}

/// A cross-product bin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BinResult {
    /// `human_robot.4 legs, bored`
    #[schemars(with = "String")]
    pub name: BinName,
    pub cross: String,
    pub bin: String,
    /// Tests that hit it, one number for each suite, in their order.
    pub hits: Vec<u32>,
    /// Tests for which the model predicted it, one number for each suite.
    pub predicted: Vec<u32>,
    /// The first test that hit it, by the alphabet.
    pub first: Option<TestName>,
    /// If the search proved that the model cannot reach it: the reason.
    pub unreachable: Option<String>,
}
