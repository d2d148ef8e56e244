//! HR06xx: requirements.

use hrdsl_source::{Code, Diagnostic, Span};

/// HR0601
pub(crate) fn says_nothing(span: Span) -> Diagnostic {
    Diagnostic::error(Code::BAD_PATTERN, span, "this condition does not depend on the world")
        .help("compare something measured, such as `distance(a, b) < 5 cm`")
}
