//! HR08xx: world and system.

use hrdsl_source::{Code, Diagnostic, Span};

/// HR0801
pub(crate) fn bad_world(span: Span, message: impl Into<String>, help: impl Into<String>) -> Diagnostic {
    Diagnostic::error(Code::BAD_WORLD, span, message).help(help)
}
