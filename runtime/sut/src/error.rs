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
    /// Something of the program has failed, as it says itself.
    #[error("{failure}{output}")]
    Failed { failure: ProgramFailure, output: Box<CapturedOutput> },
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
            | SutError::Failed { output, .. }
            | SutError::Stopped { output }
            | SutError::Rubbish { output, .. } => Some(output),
            SutError::Absent { .. } | SutError::Environment { .. } | SutError::Io { .. } => None,
        }
    }
}

/// So many characters of what a program says of a failure are kept.
const LONGEST_FAILURE: usize = 2_000;

/// What of a program has failed, in its own words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProgramFailure {
    /// Empty: it does not say.
    node: String,
    text: String,
}

impl ProgramFailure {
    #[must_use]
    pub fn new(node: &str, text: &str) -> Self {
        let kept = |words: &str| match words.char_indices().nth(LONGEST_FAILURE) {
            Some((end, _)) => format!("{}…", words.get(..end).unwrap_or_default()),
            None => words.to_owned(),
        };
        Self { node: kept(node), text: kept(text) }
    }
}

impl fmt::Display for ProgramFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.node.as_str() {
            "" => write!(f, "the program has failed: {}", self.text),
            node => write!(f, "the node {node} has failed: {}", self.text),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failure_names_its_node_and_is_no_longer_than_people_read() {
        let shown = |node: &str, text: &str| ProgramFailure::new(node, text).to_string();
        assert_eq!(shown("/brain", "no table"), "the node /brain has failed: no table");
        assert_eq!(shown("", "no table"), "the program has failed: no table");
        let long = shown("", &"ä".repeat(LONGEST_FAILURE + 1));
        assert_eq!(long.chars().filter(|c| *c == 'ä').count(), LONGEST_FAILURE);
        assert!(long.ends_with("ä…"));
    }
}
