//! Abstract tests, and what there is to say about them.

use hrdsl_bdi::choose::BeliefSet;
use hrdsl_ir::{coverage::BinName, test::TestScript};
use hrdsl_results::{GoalName, GoalReport, ModelCoverage};

use crate::goals;

/// An abstract test: scripts without samples.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AbstractTest {
    pub scripts: Vec<TestScript>,
    pub because: Vec<String>,
    pub predicts: Vec<BinName>,
    /// Which of the suite's goals the run reached.
    pub reaches: goals::ReachedGoals,
    /// Of a suite by agents: the first run that it came from.
    pub origin: Option<TestOrigin>,
}

/// The run that a test by agents came from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TestOrigin {
    /// The number of its belief set, from 1.
    pub number: u64,
    pub beliefs: BeliefSet,
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
    pub goals: Vec<GoalName>,
    /// Why no test reaches a goal; empty for those that are reached.
    pub reasons: Vec<String>,
    pub coverage: ModelCoverage,
}
