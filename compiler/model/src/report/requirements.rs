//! HR06xx: requirements.

use hrdsl_source::{Diagnostic, DiagnosticCode, Span};

/// HR0601
pub(crate) fn says_nothing(span: Span) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::BAD_PATTERN, span, "this condition does not depend on the world")
        .help("compare something measured, such as `distance(a, b) < 5 cm`")
}

/// HR0207
pub(crate) fn no_time(early: f64, late: f64, span: Span) -> Diagnostic {
    let message = format!("no answer comes not before {early} s and within {late} s");
    Diagnostic::error(DiagnosticCode::EMPTY_RANGE, span, message)
        .help("write the shorter time after `not before`")
}

/// HR0207
pub(crate) fn backwards(from: f64, to: f64, span: Span) -> Diagnostic {
    let message = format!("the window from {from} s to {to} s ends before it begins");
    Diagnostic::error(DiagnosticCode::EMPTY_RANGE, span, message)
        .help(format!("write the nearer bound first, as in `[{to} s, {from} s]`"))
}

/// HR0601
pub(crate) fn only_now(span: Span) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::BAD_PATTERN, span, "this window is the present moment alone")
        .help("say how far it looks, as in `[0 s, 500 ms]`, or leave the operator away")
}

/// HR0601
pub(crate) fn without_a_window(word: &str, span: Span) -> Diagnostic {
    let message =
        format!("`{word}` without a window can stand outermost only, and this is asked of every moment");
    Diagnostic::error(DiagnosticCode::BAD_PATTERN, span, message)
        .help(format!("say how far it looks, as in `{word}[0 s, 10 s]`"))
}

/// HR0601
pub(crate) fn two_clocks(span: Span) -> Diagnostic {
    let message = "`not before` counts from the first of the events that come before, `within` from the last";
    Diagnostic::error(DiagnosticCode::BAD_PATTERN, span, message)
        .help("make two requirements of it, one with each bound")
}
