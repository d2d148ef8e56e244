//! What an import has to say: what was left out, what is meant otherwise, what looks like a mistake.

use std::fmt;

/// How much a note matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum NoteSeverity {
    /// Good to know: a new name, an assumption.
    Info,
    /// It may behave differently, or looks like a mistake of the program.
    Warning,
    /// It is not in the scenario.
    LeftOut,
}

impl NoteSeverity {
    /// As it is written in reports.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Info => "info",
            Self::Warning => "warning",
            Self::LeftOut => "left out",
        }
    }
}

/// One row of the report. Lines and columns count from 1, columns in characters.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ImportNote {
    pub file: String,
    pub line: u32,
    pub column: u32,
    pub severity: NoteSeverity,
    pub message: String,
    /// What to do about it.
    pub help: Option<String>,
}

impl fmt::Display for ImportNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, line, column, severity, message, help } = self;
        write!(f, "{file}:{line}:{column}: {}: {message}", severity.word())?;
        help.iter().try_for_each(|help| write!(f, "\n  help: {help}"))
    }
}

/// A scenario, and the report.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ImportedScenario {
    /// The `.hri` text.
    pub text: String,
    /// By file, then by place.
    pub notes: Vec<ImportNote>,
}

/// A file that is not what it should be.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, thiserror::Error)]
#[error("{file}:{line}:{column}: {message}")]
pub struct SyntaxError {
    pub file: String,
    pub line: u32,
    pub column: u32,
    pub message: String,
}
