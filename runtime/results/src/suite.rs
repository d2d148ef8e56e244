//! How the tests of a suite were made, and what of its model they reach.

use hrdsl_ir::{suite::CoverItemKind, test::TestMethod};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    code::CoverageRatios,
    goal::SuiteGoalId,
    names::{SuiteName, TestName},
    schema,
};

/// A suite, as far as its tests were made in this campaign.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SuiteInfo {
    pub name: SuiteName,
    #[schemars(schema_with = "schema::test_method")]
    pub method: TestMethod,
    /// How many different abstract tests; `None` if the tests were read from a file.
    pub abstract_tests: Option<usize>,
    pub tests: u32,
    pub errors: u32,
    pub goals: Vec<GoalReport>,
    /// Of a suite by agents: what was reached of their programs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<ModelCoverage>,
    /// Of a suite by agents: what each test is for, and why goals stayed uncovered.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub explanation: Option<SuiteExplanation>,
    pub notes: Vec<String>,
    /// Lines and branches executed by any of the suite's tests, over all files.
    pub code: CoverageRatios,
    /// Accumulated percentage of lines after each test, in order.
    pub code_accumulated: Vec<f64>,
    /// Percentage of lines of each test alone, in order.
    pub code_per_test: Vec<f64>,
}

/// What became of one goal of a suite by search.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GoalReport {
    pub goal: SuiteGoalId,
    pub status: GoalStatus,
    /// For an unreachable goal, why; for an inconclusive one, which budget ran out.
    pub reason: String,
    /// For one that is reached: the first test whose witness reaches it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub test: Option<TestName>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GoalStatus {
    Reached,
    Unreachable,
    Inconclusive,
}

/// What the runs of a suite's agents reached of their programs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ModelCoverage {
    /// Runs that count.
    pub runs: usize,
    /// The suite's goals: how many were reached, and how many there are.
    pub goals_reached: usize,
    pub goals: usize,
    pub agents: Vec<AgentCoverage>,
}

/// What was reached of an agent.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AgentCoverage {
    pub agent: String,
    /// One for each kind, in order.
    pub kinds: Vec<KindCoverage>,
    pub unreached: Vec<UnreachedItem>,
}

/// Items of a kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct KindCoverage {
    #[schemars(schema_with = "schema::item_kind")]
    pub kind: CoverItemKind,
    pub reached: usize,
    pub all: usize,
}

/// An item that no run reached.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct UnreachedItem {
    #[schemars(schema_with = "schema::item_kind")]
    pub kind: CoverItemKind,
    /// `plan Human.leg#2 failed`
    pub item: SuiteGoalId,
    pub reason: String,
}

/// What each test of a suite is for, and why goals stayed uncovered.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct SuiteExplanation {
    /// One for each abstract test that was made concrete, in order.
    pub tests: Vec<TestExplanation>,
    /// The goals that no test reaches.
    pub uncovered: Vec<UncoveredGoal>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct TestExplanation {
    /// The first concrete test made of it.
    pub test: TestName,
    /// The belief sets that it came from.
    pub because: Vec<String>,
    /// How many goals it reaches.
    pub reaches: usize,
    /// The goals that no test before it reaches.
    pub first: Vec<SuiteGoalId>,
    /// Those that no other test reaches.
    pub only: Vec<SuiteGoalId>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct UncoveredGoal {
    pub goal: SuiteGoalId,
    pub reason: String,
}
