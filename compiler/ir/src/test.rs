//! Tests: the stimulus of one run, abstract or made concrete.

use serde::{Deserialize, Serialize};

use crate::{EventId, EventPattern, Nanos, Span, Value};

/// A test is a value: everything that a run of it depends on, but the scenario, is in it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Test {
    /// `handover.bdi_tests.t017`
    pub name: String,
    pub seed: u64,
    pub provenance: Provenance,
    pub steps: Vec<TestStep>,
    pub origin: Span,
}

/// Where a test came from.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    pub suite: String,
    /// `agents`, `search`, `random`, `hand`
    pub method: String,
    /// One line for each fact: the beliefs chosen, the goal and its witness.
    pub because: Vec<String>,
    /// The cross-product bins that the model predicts, as `cross.bin`.
    pub predicts: Vec<String>,
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
