//! What can go wrong with a program under test: each is an error verdict for its test, and none stops a campaign.

use std::{fmt, io};

use thiserror::Error;

use crate::{exit::ProgramExit, limits::LimitOverrun, output::CapturedOutput};

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
    #[error("the program ended ({exit}) before the test was over{silence}{output}")]
    Exited {
        exit: ProgramExit,
        /// What is to be said of one that had never made a request.
        silence: &'static str,
        output: Box<CapturedOutput>,
    },
    /// The program went over one of its limits while it was to `what`.
    #[error("{}{silence}{output}", OverrunSentence(*overrun, what))]
    Overrun {
        what: &'static str,
        overrun: LimitOverrun,
        /// What is to be said of one that had never made a request.
        silence: &'static str,
        output: Box<CapturedOutput>,
    },
    /// The campaign is to end.
    #[error("the run was interrupted")]
    Stopped { output: Box<CapturedOutput> },
    /// The program wrote something that is no request.
    #[error("the program wrote rubbish to the harness: {why}: {line:?}{output}")]
    Rubbish {
        /// The beginning of the line.
        line: String,
        why: String,
        output: Box<CapturedOutput>,
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
    pub fn output(&self) -> Option<&CapturedOutput> {
        match self {
            SutError::Exited { output, .. }
            | SutError::Overrun { output, .. }
            | SutError::Stopped { output }
            | SutError::Rubbish { output, .. } => Some(output),
            SutError::Absent { .. } | SutError::Environment { .. } | SutError::Io { .. } => None,
        }
    }
}

/// What went over a limit, as a sentence.
struct OverrunSentence<'a>(LimitOverrun, &'a str);

impl fmt::Display for OverrunSentence<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.describe(self.1, f)
    }
}

/// A program that never made a request may not know how to: what it should have done, by the client library that it has.
pub(crate) fn silence(middleware: Option<&str>, is_python: bool) -> &'static str {
    match middleware {
        Some("ros1") if is_python => {
            "; it never spoke to the harness (does it make a node, by `rospy.init_node`?)"
        }
        Some("ros2") if is_python => {
            "; it never spoke to the harness (does it make a node of `rclpy`, and spin it?)"
        }
        Some(_) | None if is_python => "; it never spoke to the harness (does it make a `hrdsl.Node`?)",
        Some(_) | None => {
            "; it never spoke to the harness (does it write requests to the descriptor in `HRDSL_REQUEST_FD`?)"
        }
    }
}
