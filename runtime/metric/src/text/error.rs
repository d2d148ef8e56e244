//! What is wrong with a formula's text.

use std::{fmt, ops::Range};

/// A part of the text, in bytes.
pub type TextRange = Range<usize>;

/// What is wrong with a formula, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FormulaError {
    pub message: String,
    /// Bytes of the text.
    pub range: TextRange,
    /// What to write instead.
    pub help: Option<String>,
}

impl FormulaError {
    pub(crate) fn new(range: &TextRange, message: impl Into<String>) -> Self {
        Self { message: message.into(), range: range.clone(), help: None }
    }

    pub(crate) fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }
}

impl fmt::Display for FormulaError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)?;
        self.help.iter().try_for_each(|help| write!(f, "; {help}"))
    }
}

impl std::error::Error for FormulaError {}
