//! What several rules ask about a scenario: who makes an event, and who takes it.

use crate::Scenario;

/// Answers that are worked out once for all rules.
pub(crate) struct Facts {}

impl Facts {
    pub fn of(_scenario: &Scenario) -> Self {
        Self {}
    }
}
