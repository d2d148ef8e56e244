//! The system under test.

use serde::{Deserialize, Serialize};

use crate::{ActorId, Nanos, Span};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct System {
    /// The actor that the code plays.
    pub actor: ActorId,
    /// The command, split into words; paths are relative to the scenario's folder.
    pub run: Vec<String>,
    /// Files whose code coverage is measured, relative to the scenario's folder; empty: none.
    pub coverage: Vec<String>,
    /// Every test ends at this simulated time.
    pub limit: Nanos,
    /// Wall-clock time in which the program must make its next request.
    pub budget: Nanos,
    pub origin: Span,
}
