//! The system under test: what runs, within which limits, and what is bound to its middleware.

use hrdsl_source::Span;
use serde::{Deserialize, Serialize};

use crate::{binding::MiddlewareBinding, event::ActorId, expr::Expr, value::Nanos};

/// One of the codes that tests can be run against.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SystemUnderTest<E = Expr> {
    /// As it is chosen by; that of the actor, if nothing else is said.
    pub name: String,
    /// The actor that the code plays.
    pub actor: ActorId,
    /// At least one, in the order in which they are served.
    pub programs: Vec<SystemProgram>,
    /// Every test ends at this simulated time.
    pub limit: Nanos,
    /// Processor time, or else sleep, in which a program must make its next request.
    pub budget: Nanos,
    /// Processor time for each program of a test; where nothing is said here, what runs the tests decides.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cpu: Option<Nanos>,
    /// Wall time for a test.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wall: Option<Nanos>,
    /// Bytes of memory for each process.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub memory: Option<u64>,
    /// Bytes of output for each program of a test.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub output: Option<u64>,
    /// Variables of the environment that are handed on.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub env: Vec<String>,
    /// Whether the programs use the machine's network, not one of their own.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub online: bool,
    #[serde(default = "Option::default", skip_serializing_if = "Option::is_none")]
    pub binding: Option<MiddlewareBinding<E>>,
    pub origin: Span,
}

/// A program of the system: a process of its own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SystemProgram {
    pub name: String,
    /// The command, split into words; paths are relative to the scenario's folder.
    pub run: Vec<String>,
    /// Files whose code coverage is measured, or patterns of their names (`src/*.py`), relative to the scenario's folder; empty: none.
    pub coverage: Vec<String>,
    pub origin: Span,
}

impl<E> SystemUnderTest<E> {
    /// The files whose coverage is measured, each once, in the order in which they are named.
    #[must_use]
    pub fn coverage(&self) -> Vec<String> {
        let mut files: Vec<String> = Vec::new();
        for file in self.programs.iter().flat_map(|p| &p.coverage) {
            if !files.contains(file) {
                files.push(file.clone());
            }
        }
        files
    }
}
