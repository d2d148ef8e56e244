//! What is wrong with a description, where, and what to write instead.
//!
//! Whoever reports a fault gives it a code; here a kind has a word, which tests name it by.

use hrdsl_source::{Diagnostic, DiagnosticCode, Severity, Span};
use thiserror::Error;

use crate::limits::MOST_FAULTS;

/// Where something stands: in the file that has the text, which may be the body of a macro.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RobotPlace {
    pub span: Span,
    /// Where the macro is called whose body it stands in; the innermost call.
    pub call: Option<Span>,
}

impl From<Span> for RobotPlace {
    fn from(span: Span) -> Self {
        Self { span, call: None }
    }
}

/// A fault of a description: what, how grave, where, and the next step.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotFault {
    pub kind: RobotFaultKind,
    /// An error keeps the description from being used; a warning says what was probably not meant.
    pub severity: Severity,
    pub place: RobotPlace,
    /// What to write.
    pub help: Box<str>,
    /// Where that stands which it repeats or clashes with.
    pub first: Option<Span>,
}

/// What is wrong; its text is the message of the fault.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RobotFaultKind {
    #[error("{path} cannot be read: {reason}")]
    Unreadable { path: String, reason: String },
    #[error("{what}: at most {limit}")]
    TooMuch { what: &'static str, limit: usize },
    #[error("this is no XML: {0}")]
    BrokenXml(String),
    #[error("`{found}` is no {wanted}")]
    WrongRoot { found: String, wanted: &'static str },
    #[error("`<{element}>` has no `{attribute}`")]
    MissingAttribute { element: String, attribute: &'static str },
    #[error("`<{element}>` has no `<{child}>`")]
    MissingElement { element: String, child: &'static str },
    #[error("`{0}` is no number")]
    BadNumber(String),
    #[error("`{0}` is not finite")]
    NotFinite(String),
    #[error("{expected} numbers are needed, and here are {found}")]
    WrongCount { expected: usize, found: usize },
    #[error("{what} is {value}")]
    BadSize { what: &'static str, value: String },
    #[error("`{word}` is no {what}")]
    UnknownWord { what: &'static str, word: String },
    #[error("the {what} `{name}` is declared twice")]
    DuplicateName { what: &'static str, name: String },
    #[error("no {what} is called `{name}`")]
    UnknownName { what: &'static str, name: String },
    #[error("the robot has no link")]
    NoLinks,
    #[error("the link `{0}` is the child of two joints")]
    TwoParents(String),
    #[error("the joint `{0}` closes a loop")]
    LinkLoop(String),
    #[error("`{0}` and `{1}` both have no parent")]
    SeveralRoots(String, String),
    #[error("the joint `{joint}` is {kind}, and its parent is not the root")]
    FreeJoint { joint: String, kind: &'static str },
    #[error("the axis of `{0}` has no length")]
    ZeroAxis(String),
    #[error("`lower` is {lower}, which is above `upper`, {upper}")]
    EmptyLimits { lower: f64, upper: f64 },
    #[error("the joint `{0}` has no limits")]
    MissingLimits(String),
    #[error("the limit of `{joint}` has no {what}")]
    NoBound { joint: String, what: &'static str },
    #[error("the joint `{0}` follows itself")]
    MimicLoop(String),
    #[error("the link `{0}` moves and has no mass")]
    NoInertial(String),
    #[error("the mass of `{link}` is {mass}")]
    BadMass { link: String, mass: f64 },
    #[error("no body has the inertia of `{link}`: {reason}")]
    BadInertia { link: String, reason: String },
    #[error("`{0}` leads to no file")]
    BadAddress(String),
    #[error("no package is called `{0}`")]
    UnknownPackage(String),
    #[error("the package `{0}` is there twice")]
    DuplicatePackage(String),
    #[error("`package.xml` does not say the name of its package")]
    MalformedManifest,
    #[error("there is no file {0}")]
    MissingFile(String),
    #[error("{0} is a mesh of a kind that is not read")]
    UnreadFormat(String),
    #[error("the mesh {path} is broken: {reason}")]
    BrokenMesh { path: String, reason: String },
    #[error("the mesh {path} is {size:.0} m large")]
    HugeMesh { path: String, size: f64 },
    #[error("in this expression: {0}")]
    BadExpression(String),
    #[error("xacro's {0} is not done here")]
    NotDone(String),
    #[error("the macro `{0}` does not exist")]
    UnknownMacro(String),
    #[error("the macro `{name}` {problem}")]
    WrongCall { name: String, problem: String },
    #[error("no argument is called `{0}`")]
    UnknownArgument(String),
    #[error("no block is called `{0}`")]
    UnknownBlock(String),
    #[error("`{0}` is neither true nor false")]
    NoCondition(String),
    #[error("`{0}` cannot be the name of a {1}")]
    BadName(String, &'static str),
    #[error("this is no YAML that is read here: {0}")]
    BadYaml(String),
    #[error("this is no map: {0}")]
    BadMap(String),
    #[error("the image {path} is broken: {reason}")]
    BrokenImage { path: String, reason: String },
    #[error("`{tip}` does not lie below `{base}`")]
    NoChain { base: String, tip: String },
}

impl RobotFaultKind {
    /// One word for the kind, the same whatever it is said of.
    #[must_use]
    pub fn word(&self) -> &'static str {
        match self {
            Self::Unreadable { .. } => "unreadable",
            Self::TooMuch { .. } => "too-much",
            Self::BrokenXml(_) => "broken-xml",
            Self::WrongRoot { .. } => "wrong-root",
            Self::MissingAttribute { .. } => "missing-attribute",
            Self::MissingElement { .. } => "missing-element",
            Self::BadNumber(_) => "bad-number",
            Self::NotFinite(_) => "not-finite",
            Self::WrongCount { .. } => "wrong-count",
            Self::BadSize { .. } => "bad-size",
            Self::UnknownWord { .. } => "unknown-word",
            Self::DuplicateName { .. } => "duplicate-name",
            Self::UnknownName { .. } => "unknown-name",
            Self::NoLinks => "no-links",
            Self::TwoParents(_) => "two-parents",
            Self::LinkLoop(_) => "link-loop",
            Self::SeveralRoots(..) => "several-roots",
            Self::FreeJoint { .. } => "free-joint",
            Self::ZeroAxis(_) => "zero-axis",
            Self::EmptyLimits { .. } => "empty-limits",
            Self::MissingLimits(_) => "missing-limits",
            Self::NoBound { .. } => "no-bound",
            Self::MimicLoop(_) => "mimic-loop",
            Self::NoInertial(_) => "no-inertial",
            Self::BadMass { .. } => "bad-mass",
            Self::BadInertia { .. } => "bad-inertia",
            Self::BadAddress(_) => "bad-address",
            Self::UnknownPackage(_) => "unknown-package",
            Self::DuplicatePackage(_) => "duplicate-package",
            Self::MalformedManifest => "malformed-manifest",
            Self::MissingFile(_) => "missing-file",
            Self::UnreadFormat(_) => "unread-format",
            Self::BrokenMesh { .. } => "broken-mesh",
            Self::HugeMesh { .. } => "huge-mesh",
            Self::BadExpression(_) => "bad-expression",
            Self::NotDone(_) => "not-done",
            Self::UnknownMacro(_) => "unknown-macro",
            Self::WrongCall { .. } => "wrong-call",
            Self::UnknownArgument(_) => "unknown-argument",
            Self::UnknownBlock(_) => "unknown-block",
            Self::NoCondition(_) => "no-condition",
            Self::BadName(..) => "bad-name",
            Self::BadYaml(_) => "bad-yaml",
            Self::BadMap(_) => "bad-map",
            Self::BrokenImage { .. } => "broken-image",
            Self::NoChain { .. } => "no-chain",
        }
    }

    /// The error of this kind at a place.
    #[must_use]
    pub fn at(self, place: impl Into<RobotPlace>, help: impl Into<Box<str>>) -> RobotFault {
        RobotFault {
            kind: self,
            severity: Severity::Error,
            place: place.into(),
            help: help.into(),
            first: None,
        }
    }

    /// The warning of this kind at a place.
    #[must_use]
    pub fn warned(self, place: impl Into<RobotPlace>, help: impl Into<Box<str>>) -> RobotFault {
        RobotFault { severity: Severity::Warning, ..self.at(place, help) }
    }
}

impl RobotFault {
    /// It repeats or clashes with what stands there.
    #[must_use]
    pub fn clashes(mut self, first: Span) -> Self {
        self.first = Some(first);
        self
    }

    #[must_use]
    pub fn is_error(&self) -> bool {
        self.severity == Severity::Error
    }

    /// The diagnostic of this fault, under the code that the caller has for it.
    #[must_use]
    pub fn diagnostic(&self, code: DiagnosticCode) -> Diagnostic {
        let message = self.kind.to_string();
        let mut diagnostic = match self.severity {
            Severity::Error => Diagnostic::error(code, self.place.span, message),
            Severity::Warning => Diagnostic::warning(code, self.place.span, message),
        };
        if let Some(first) = self.first {
            diagnostic = diagnostic.label(first, "the other one");
        }
        if let Some(call) = self.place.call {
            diagnostic = diagnostic.label(call, "the macro is called here");
        }
        diagnostic.help(&*self.help)
    }
}

/// Adds a fault, unless enough was said already.
pub(crate) fn say(faults: &mut Vec<RobotFault>, fault: RobotFault) {
    if faults.len() < MOST_FAULTS && !faults.contains(&fault) {
        faults.push(fault);
    }
}
