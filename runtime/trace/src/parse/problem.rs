//! What can be wrong with a line of a recording.

use thiserror::Error;

use crate::record::VERSION;

/// The most bytes of one line, so that a file of another kind does not fill the memory.
pub(super) const LONGEST_LINE: u64 = 16 << 20;

/// What is wrong with a line.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum LineProblem {
    #[error("not a line of a recording: {0}")]
    Json(String),
    #[error(
        "the recording has to start with a header: {{\"hrdsl\":\"trace\",\"version\":2,\"scenario\":...}}"
    )]
    NoHeader,
    #[error("this is format version {0}; versions 1 to {VERSION} can be read")]
    Version(u64),
    #[error("`{0}` is not how a run ends; that is `quiescent`, `limit` or `error`")]
    End(String),
    #[error("the line is longer than {} MiB", LONGEST_LINE >> 20)]
    TooLong,
    #[error("the line is not text in UTF-8")]
    NotText,
    #[error("{0}")]
    Form(&'static str),
    #[error("unknown event `{name}`{}", hint(.near))]
    UnknownEvent { name: String, near: Option<String> },
    #[error("unknown signal `{name}`{}", hint(.near))]
    UnknownSignal { name: String, near: Option<String> },
    #[error("event `{event}` has no parameter `{name}`{}", hint(.near))]
    UnknownArgument { event: String, name: String, near: Option<String> },
    #[error("event `{event}` has the argument `{name}` twice")]
    DoubleArgument { event: String, name: String },
    #[error("event `{event}` lacks the argument `{name}`")]
    MissingArgument { event: String, name: String },
    #[error("`{of}` has to be {expected}, not {found}")]
    Type { of: String, expected: String, found: String },
    #[error("`{0}` is not a time in seconds, at least 0")]
    Time(String),
    #[error("time goes backwards: {now} s after {before} s")]
    Backwards { before: String, now: String },
    #[error("the recording is cut off: its last line has to be {{\"end\":...}}")]
    Truncated,
    #[error("there is something after the end")]
    AfterEnd,
}

fn hint(near: &Option<String>) -> String {
    near.as_ref().map_or(String::new(), |near| format!("; did you mean `{near}`?"))
}
