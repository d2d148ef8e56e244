//! What is wrong with a definition, where, and what to write instead.
//!
//! The checker gives each kind its code; here a kind has a word, which tests name it by.

use hrdsl_source::Span;
use thiserror::Error;

use crate::name::RosVersion;

/// A fault of a definition or of a workspace: what, where, and the next step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MessageFault {
    pub kind: MessageFaultKind,
    /// In the file that is at fault, or where the workspace is named if a folder is.
    pub span: Span,
    /// What to write.
    pub help: String,
    /// Where that stands which it repeats.
    pub first: Option<Span>,
}

/// What is wrong; its text is the message of the fault.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum MessageFaultKind {
    #[error("`{0}` is a type without a name")]
    MissingName(String),
    #[error("`{0}` is no type")]
    MalformedType(String),
    #[error("no type is called `{0}`")]
    UnknownType(String),
    #[error("{version} has no {what}")]
    OtherVersion { what: &'static str, version: RosVersion },
    #[error("`{name}` cannot be the name of a {part}")]
    BadName { part: &'static str, name: String },
    #[error("`{0}` is declared twice")]
    DuplicateName(String),
    #[error("`{0}` does not belong to the line")]
    UnexpectedText(String),
    #[error("{0} cannot be a constant")]
    ConstantType(String),
    #[error("a field of the type `{0}` has no default value")]
    DefaultOfMessage(String),
    #[error("`{value}` is no value of the type `{of}`")]
    BadValue { value: String, of: String },
    #[error("{value} lies outside `{of}`")]
    ValueOutOfRange { value: String, of: String },
    #[error("{what} has {expected}, and here is {found}")]
    WrongSections { what: &'static str, expected: &'static str, found: String },
    #[error("`{0}` contains itself")]
    RecursiveMessage(String),
    #[error("{what}: at most {limit}")]
    TooMuch { what: &'static str, limit: u64 },
    #[error("the package `{0}` is there twice")]
    DuplicatePackage(String),
    #[error("`package.xml` does not say the name of its package")]
    MalformedManifest,
    #[error("{path} cannot be read: {reason}")]
    Unreadable { path: String, reason: String },
    #[error("no package with definitions lies in {0}")]
    EmptyWorkspace(String),
    #[error("a line outside of a definition")]
    MisplacedText,
}

impl MessageFaultKind {
    /// One word for the kind, the same whatever it is said of.
    #[must_use]
    pub fn word(&self) -> &'static str {
        match self {
            Self::MissingName(_) => "missing-name",
            Self::MalformedType(_) => "malformed-type",
            Self::UnknownType(_) => "unknown-type",
            Self::OtherVersion { .. } => "other-version",
            Self::BadName { .. } => "bad-name",
            Self::DuplicateName(_) => "duplicate-name",
            Self::UnexpectedText(_) => "unexpected-text",
            Self::ConstantType(_) => "constant-type",
            Self::DefaultOfMessage(_) => "default-of-message",
            Self::BadValue { .. } => "bad-value",
            Self::ValueOutOfRange { .. } => "out-of-range",
            Self::WrongSections { .. } => "wrong-sections",
            Self::RecursiveMessage(_) => "recursive-message",
            Self::TooMuch { .. } => "too-much",
            Self::DuplicatePackage(_) => "duplicate-package",
            Self::MalformedManifest => "malformed-manifest",
            Self::Unreadable { .. } => "unreadable",
            Self::EmptyWorkspace(_) => "empty-workspace",
            Self::MisplacedText => "misplaced-text",
        }
    }

    /// The fault of this kind at a place.
    #[must_use]
    pub fn at(self, span: Span, help: impl Into<String>) -> MessageFault {
        MessageFault { kind: self, span, help: help.into(), first: None }
    }
}

impl MessageFault {
    /// It repeats what stands there.
    #[must_use]
    pub fn repeats(mut self, first: Span) -> Self {
        self.first = Some(first);
        self
    }
}
