//! The system under test.

use hrdsl_source::Span;
use serde::{Deserialize, Serialize};

use crate::{event::ActorId, value::Nanos};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SystemUnderTest {
    /// The actor that the code plays.
    pub actor: ActorId,
    /// The command, split into words; paths are relative to the scenario's folder.
    pub run: Vec<String>,
    /// Files whose code coverage is measured, relative to the scenario's folder; empty: none.
    pub coverage: Vec<String>,
    /// Every test ends at this simulated time.
    pub limit: Nanos,
    /// Processor time, or else sleep, in which the program must make its next request.
    pub budget: Nanos,
    /// Processor time for a test; where nothing is said here, what runs the tests decides.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cpu: Option<Nanos>,
    /// Wall time for a test.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wall: Option<Nanos>,
    /// Bytes of memory for each process.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub memory: Option<u64>,
    /// Bytes of output for a test.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub output: Option<u64>,
    /// Variables of the environment that are handed on.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub env: Vec<String>,
    /// Whether the program uses the machine's network, not one of its own.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub online: bool,
    pub origin: Span,
}
