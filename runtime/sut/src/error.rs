//! What can go wrong with a program under test: each is an error verdict for its test, and none stops a campaign.

use std::{io, time::Duration};

use thiserror::Error;

use crate::{Exit, Output};

/// Why there is no further request, or no process at all. Those about a running program carry its last output.
#[derive(Debug, Error)]
pub enum SutError {
    /// A file that must exist does not.
    #[error("{what} not found: looked for {looked_for}")]
    Absent {
        /// The program, script or folder, in words.
        what: &'static str,
        looked_for: String,
    },
    /// The program ended although the test had not.
    #[error("the program ended ({exit}) before the test was over{output}")]
    Exited { exit: Exit, output: Box<Output> },
    /// The program made no request, or took no reply, within its wall-clock budget.
    #[error("the program did not {what} within {} ms of wall time{output}", budget.as_millis())]
    Hung { what: &'static str, budget: Duration, output: Box<Output> },
    /// The program wrote something that is no request.
    #[error("the program wrote rubbish to the harness: {why}: {line:?}{output}")]
    Rubbish {
        /// The beginning of the line.
        line: String,
        why: String,
        output: Box<Output>,
    },
    /// What the program needs could not be installed.
    #[error("cannot prepare the Python environment: {what}\n{detail}")]
    Environment {
        what: String,
        /// The last lines of the tool that failed, and what to do.
        detail: String,
    },
    /// The system refused a pipe, a process or a file.
    #[error("{what}: {source}")]
    Io { what: String, source: io::Error },
}

impl SutError {
    pub(crate) fn io(what: impl Into<String>) -> impl FnOnce(io::Error) -> SutError {
        let what = what.into();
        move |source| SutError::Io { what, source }
    }

    /// The program's last output, for the errors that have one.
    #[must_use]
    pub fn output(&self) -> Option<&Output> {
        match self {
            SutError::Exited { output, .. }
            | SutError::Hung { output, .. }
            | SutError::Rubbish { output, .. } => Some(output),
            SutError::Absent { .. } | SutError::Environment { .. } | SutError::Io { .. } => None,
        }
    }
}
