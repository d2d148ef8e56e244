//! HR0520: queries.

use hrdsl_source::{Diagnostic, DiagnosticCode, Span};

/// HR0520
pub(crate) fn bad_query(span: Span, message: impl Into<String>, help: impl Into<String>) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::BAD_QUERY, span, message).help(help)
}

/// HR0520
pub(crate) fn not_in_network(automaton: &str, network: &str, members: &[String], span: Span) -> Diagnostic {
    let help = format!("`{network}` has: `{}`", members.join("`, `"));
    bad_query(span, format!("`{automaton}` is not in the network `{network}`"), help)
}

/// HR0520
pub(crate) fn location_and_variable(automaton: &str, name: &str, span: Span) -> Diagnostic {
    let message = format!("`{name}` is a location and a variable of `{automaton}`");
    bad_query(span, message, "give one of them another name")
}

/// HR0520
pub(crate) fn clock_value(clock: &str, span: Span) -> Diagnostic {
    let help =
        format!("compare it with a time, or with another clock: `{clock} <= 3 s`, `{clock} - y < 1 s`");
    bad_query(span, format!("the clock `{clock}` has no value here"), help)
}

/// HR0520
pub(crate) fn state_value(what: &str, span: Span) -> Diagnostic {
    let help = "join what holds or not by `and`, `or`, `not`, `imply`";
    bad_query(span, format!("`{what}` holds or not: it has no value"), help)
}

/// HR0520
pub(crate) fn deadlock_along_run(span: Span) -> Diagnostic {
    let help = "ask `E<> deadlock` or `A[] not deadlock`; along runs, name the locations in which they end";
    bad_query(
        span,
        "`deadlock` is asked for in `E<>`, `A[]`, `sup` and `inf`, not in `A<>`, `E[]` and `-->`",
        help,
    )
}

/// HR0520
pub(crate) fn clock_sum(span: Span) -> Diagnostic {
    let help = "write `x - y < 3 s`, or give the model a clock that counts this";
    bad_query(span, "a comparison has one clock on each side at most", help)
}

/// HR0520: zones say more than can happen there, and splitting them along a difference relies on delays that leave it as it is.
pub(crate) fn clocks_compared(location: &str, span: Span) -> Diagnostic {
    let message =
        format!("a query cannot compare two clocks where clocks stand still, as one does in `{location}`");
    bad_query(span, message, "compare each of them with a time: `x >= 3 s and y < 1 s`")
}

/// HR0520
pub(crate) fn not_linear(span: Span) -> Diagnostic {
    let help = "write a sum of times, each perhaps multiplied by an integer: `n * 500 ms + 2 s`";
    bad_query(span, "a clock is compared with a time that is no sum of constants and multiples", help)
}

/// HR0101: a name of an automaton without the automaton's.
pub(crate) fn bare_member(automaton: &str, name: &str, span: Span) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::UNKNOWN_NAME, span, format!("`{name}` is known in its automaton only"))
        .help(format!("write `{automaton}.{name}`"))
}
