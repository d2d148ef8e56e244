//! HR07xx: coverage and suites.

use hrdsl_source::{Diagnostic, DiagnosticCode, Span};

/// HR0701
pub(crate) fn overlap(name: &str, span: Span, other: &str, first: Span) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::OVERLAPPING_BINS, span, format!("the bin `{name}` overlaps `{other}`"))
        .label(first, "this bin has a number of it too")
        .help("each number belongs to at most one bin")
}

/// HR0702
pub(crate) fn bad_suite(span: Span, message: impl Into<String>, help: impl Into<String>) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::BAD_SUITE, span, message).help(help)
}
