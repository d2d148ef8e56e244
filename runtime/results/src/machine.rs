//! Which states and transitions of the system's state machines were reached.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::names::TestName;

/// What a test reached of a state machine.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct MachineCoverage {
    pub machine: String,
    /// The states that were entered, as they were declared.
    pub states: Vec<String>,
    /// The transitions that were taken, as they were declared: `IDLE -asked-> GIVE`.
    pub transitions: Vec<String>,
}

/// A state machine of the system under test, over the whole campaign.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct MachineResult {
    /// One within another by the labels that lead to it: `SM_ROOT/GRASP`.
    pub machine: String,
    /// In the order in which they were declared.
    pub states: Vec<MachineStateResult>,
    pub transitions: Vec<MachineTransitionResult>,
    /// Its own outcomes.
    pub outcomes: Vec<String>,
}

/// A state of a state machine.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct MachineStateResult {
    pub state: String,
    /// Tests that entered it, one number for each suite, in their order.
    pub hits: Vec<u32>,
    /// The first of these tests, by the alphabet.
    pub first: Option<TestName>,
}

/// A transition of a state machine.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct MachineTransitionResult {
    pub from: String,
    pub outcome: String,
    /// A state, or an outcome of the machine.
    pub to: String,
    /// Tests that took it, one number for each suite, in their order.
    pub hits: Vec<u32>,
    /// The first of these tests, by the alphabet.
    pub first: Option<TestName>,
}

impl MachineResult {
    /// States that were entered, and all.
    #[must_use]
    pub fn states_reached(&self) -> (usize, usize) {
        (self.states.iter().filter(|s| s.hits.iter().any(|n| *n > 0)).count(), self.states.len())
    }

    /// Transitions that were taken, and all.
    #[must_use]
    pub fn transitions_reached(&self) -> (usize, usize) {
        (self.transitions.iter().filter(|t| t.hits.iter().any(|n| *n > 0)).count(), self.transitions.len())
    }
}

impl MachineTransitionResult {
    /// As [`MachineCoverage`] names it.
    #[must_use]
    pub fn name(&self) -> String {
        format!("{} -{}-> {}", self.from, self.outcome, self.to)
    }
}
