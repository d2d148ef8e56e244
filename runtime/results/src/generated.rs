//! What comes of the generation of a suite: tests, and what was found on the way.

use hrdsl_ir::{
    abstract_test::{AbstractTest, TestOrigin},
    test::{Test, TestMethod},
};
use serde::Serialize;

use crate::{
    goal::SuiteGoalId,
    suite::{GoalReport, ModelCoverage, SuiteExplanation},
};

/// A generated suite.
#[derive(Clone, Debug)]
pub struct GeneratedSuite {
    pub suite: String,
    pub method: TestMethod,
    /// How many different abstract tests there are.
    pub abstract_tests: usize,
    pub tests: Vec<Test>,
    /// Of a suite by agents: where each test came from.
    pub origins: Vec<TestOrigin>,
    /// Of a suite by search: every goal's fate.
    pub goals: Vec<GoalReport>,
    /// Of a suite by agents: what was reached of their programs.
    pub coverage: Option<ModelCoverage>,
    /// Of a suite by agents: what each test is for, and why goals stayed uncovered.
    pub explanation: Option<SuiteExplanation>,
    /// Of a suite by agents that is to have all tuples: those that its tests are too few for.
    pub lost_tuples: Option<LostTuples>,
    /// What a user should know: runs left out, budgets that ran out.
    pub notes: Vec<String>,
}

/// Combinations of alternatives that are in no test, since there are fewer tests than all of them take.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct LostTuples {
    /// Of how many alternatives each is.
    pub strength: usize,
    /// How many the chosen belief sets have.
    pub all: usize,
    /// How many of them are in no test.
    pub lost: usize,
    /// With so many tests none would be lost.
    pub needed: usize,
}

/// Abstract tests with what there is to say about them.
#[derive(Default)]
pub struct AbstractTests {
    pub tests: Vec<AbstractTest>,
    pub goals: Vec<GoalReport>,
    pub notes: Vec<String>,
    /// Of a suite by agents.
    pub found: Option<AgentFindings>,
}

/// What the runs of agents found out.
pub struct AgentFindings {
    pub goals: Vec<SuiteGoalId>,
    /// Why no test reaches a goal; empty for those that are reached.
    pub reasons: Vec<String>,
    pub coverage: ModelCoverage,
}
