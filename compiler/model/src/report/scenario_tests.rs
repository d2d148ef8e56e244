//! HR09xx: tests.

use hrdsl_source::{Diagnostic, DiagnosticCode, Span};

/// HR0901
pub(crate) fn bad_test(span: Span, message: impl Into<String>, help: impl Into<String>) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::BAD_TEST, span, message).help(help)
}
