//! Systems under test and their programs.

use hrdsl_source::{Diagnostic, DiagnosticCode, Span};

/// HR0806: a program has a command and coverage, and nothing else of its own.
pub(crate) fn not_of_a_program(span: Span) -> Diagnostic {
    Diagnostic::error(
        DiagnosticCode::BAD_BINDING,
        span,
        "this is said of a system, not of one of its programs",
    )
    .help("move it to the `system`, where it holds for all of them")
}

/// HR0806: a command of the system beside programs with commands of their own.
pub(crate) fn beside_programs(span: Span) -> Diagnostic {
    let message = "the system has programs, each with a command and coverage of its own";
    Diagnostic::error(DiagnosticCode::BAD_BINDING, span, message).help("move this to one of them")
}

/// HR0102: a second block `ros1` or `ros2`.
pub(crate) fn second_binding(version: &str, span: Span, first_version: &str, first: Span) -> Diagnostic {
    let (message, help) = if version == first_version {
        (format!("a second `{version}`"), "put both into one".to_owned())
    } else {
        let help = format!(
            "give the actor a second system, for the programs of `{version}`: `system NAME plays ACTOR {{ … }}`"
        );
        (
            format!("`{version}` beside `{first_version}`: the programs of a system use one version of ROS"),
            help,
        )
    };
    Diagnostic::error(DiagnosticCode::DUPLICATE_NAME, span, message)
        .help(help)
        .label(first, "the first is here")
}
