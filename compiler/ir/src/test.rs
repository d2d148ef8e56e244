//! Tests: the stimulus of one run, abstract or made concrete.

use hrdsl_source::Span;
use serde::{Deserialize, Serialize};

use crate::{
    coverage::BinName,
    event::{ActorId, EventId, EventPattern},
    value::{Nanos, Value},
};

/// A test is a value: everything that a run of it depends on, but the scenario, is in it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Test {
    /// `handover.bdi_tests.t017`
    pub name: String,
    pub seed: u64,
    pub provenance: TestProvenance,
    /// One that plays all environment actors, or one for each actor that does something; they run at once.
    pub scripts: Vec<TestScript>,
    pub origin: Span,
}

/// What is done in a test, one step after the other.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TestScript {
    /// None: it plays all environment actors, and is the only script of its test.
    pub actor: Option<ActorId>,
    pub steps: Vec<TestStep>,
}

impl TestScript {
    /// The only script of a test, of all environment actors.
    #[must_use]
    pub fn of_all(steps: Vec<TestStep>) -> Vec<Self> {
        vec![Self { actor: None, steps }]
    }
}

/// Where a test came from.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TestProvenance {
    pub suite: String,
    pub method: TestMethod,
    /// One line for each fact: the beliefs chosen, the goal and its witness.
    pub because: Vec<String>,
    /// The cross-product bins that the model predicts.
    pub predicts: Vec<BinName>,
}

/// How a test was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TestMethod {
    /// By running agents.
    Agents,
    /// From a witness of a search.
    Search,
    /// At random.
    Random,
    /// By a person.
    #[default]
    Hand,
}

impl TestMethod {
    pub const ALL: [TestMethod; 4] =
        [TestMethod::Agents, TestMethod::Search, TestMethod::Random, TestMethod::Hand];

    /// The word for it in the language and in results.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            TestMethod::Agents => "agents",
            TestMethod::Search => "search",
            TestMethod::Random => "random",
            TestMethod::Hand => "hand",
        }
    }

    /// The method that a word stands for.
    #[must_use]
    pub fn of_word(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.word() == word)
    }
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TestStep {
    /// An environment actor does a stimulus. `samples` are the values of the second tier, by the order of the stimulus's
    /// samples; empty: they are drawn from the seed when the test runs.
    Do {
        event: EventId,
        args: Vec<Value>,
        samples: Vec<Value>,
        /// The next step begins at once, and the stimulus goes on beside it.
        meanwhile: bool,
    },
    /// Go on when one of the events has happened since the last await ended (or the test began), or when the time,
    /// counted from the start of this step, is over.
    Await {
        events: Vec<EventPattern>,
        within: Nanos,
    },
    Wait {
        time: Nanos,
    },
}
