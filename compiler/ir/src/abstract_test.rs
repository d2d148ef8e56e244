//! Abstract tests: what a suite has before values are drawn, and where each test came from.

use std::collections::BTreeSet;

use crate::{
    bdi::{AgentId, InitialFact},
    coverage::BinName,
    test::TestScript,
};

/// The goals of a suite that were reached, by their places.
pub type ReachedGoals = BTreeSet<usize>;

/// An abstract test: scripts without samples.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AbstractTest {
    pub scripts: Vec<TestScript>,
    pub because: Vec<String>,
    pub predicts: Vec<BinName>,
    /// Which of the suite's goals the run reached.
    pub reaches: ReachedGoals,
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

/// What the agents of one abstract test start with.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BeliefSet {
    /// In the order of the factors.
    pub facts: Vec<(AgentId, InitialFact)>,
    /// Each fact as it is written.
    pub text: Vec<String>,
}
