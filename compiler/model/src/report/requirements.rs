//! HR06xx: requirements.

use hrdsl_source::{Diagnostic, DiagnosticCode, Span};

/// HR0601
pub(crate) fn says_nothing(span: Span) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::BAD_PATTERN, span, "this condition does not depend on the world")
        .help("compare something measured, such as `distance(a, b) < 5 cm`")
}
