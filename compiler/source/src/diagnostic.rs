//! What the compiler has to say about a piece of text.

use serde::Serialize;

use crate::{DiagnosticCode, Span};

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    Warning,
    Error,
}

/// A code, a lower-case message, labelled spans, and help that says what to type.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Diagnostic {
    pub code: DiagnosticCode,
    pub severity: Severity,
    pub message: String,
    /// The first is the place of the fault; others show what it clashes with.
    pub labels: Vec<SpanLabel>,
    pub help: Option<String>,
    /// Changes of the text that would fix it, the likeliest first.
    pub fixes: Vec<SuggestedFix>,
}

/// A change of the text that fixes a fault.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SuggestedFix {
    /// What it does, as a command: "replace `wats` by `wants`".
    pub title: String,
    /// In order of place, not overlapping.
    pub edits: Vec<TextEdit>,
    /// Nothing else can have been meant, so that a tool may apply it unasked.
    pub certain: bool,
}

/// A piece of text and what is to stand there; an empty span inserts, an empty text deletes.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct TextEdit {
    pub span: Span,
    pub text: String,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SpanLabel {
    pub span: Span,
    pub text: String,
}

impl Diagnostic {
    #[must_use]
    pub fn error(code: DiagnosticCode, span: Span, message: impl Into<String>) -> Self {
        Self::new(Severity::Error, code, span, message.into())
    }

    #[must_use]
    pub fn warning(code: DiagnosticCode, span: Span, message: impl Into<String>) -> Self {
        Self::new(Severity::Warning, code, span, message.into())
    }

    fn new(severity: Severity, code: DiagnosticCode, span: Span, message: String) -> Self {
        let labels = vec![SpanLabel { span, text: String::new() }];
        Self { code, severity, message, labels, help: None, fixes: Vec::new() }
    }

    /// The text at the primary span.
    #[must_use]
    #[expect(clippy::indexing_slicing, reason = "the first label is made with the diagnostic")]
    pub fn here(mut self, text: impl Into<String>) -> Self {
        self.labels[0].text = text.into();
        self
    }

    /// A further place.
    #[must_use]
    pub fn label(mut self, span: Span, text: impl Into<String>) -> Self {
        self.labels.push(SpanLabel { span, text: text.into() });
        self
    }

    #[must_use]
    pub fn help(mut self, text: impl Into<String>) -> Self {
        self.help = Some(text.into());
        self
    }

    /// A change of one piece of text that would fix it.
    #[must_use]
    pub fn fix(
        mut self,
        title: impl Into<String>,
        span: Span,
        text: impl Into<String>,
        certain: bool,
    ) -> Self {
        let edits = vec![TextEdit { span, text: text.into() }];
        self.fixes.push(SuggestedFix { title: title.into(), edits, certain });
        self
    }

    /// The place of the fault.
    #[must_use]
    #[expect(clippy::indexing_slicing, reason = "the first label is made with the diagnostic")]
    pub fn span(&self) -> Span {
        self.labels[0].span
    }

    #[must_use]
    pub fn is_error(&self) -> bool {
        self.severity == Severity::Error
    }
}
