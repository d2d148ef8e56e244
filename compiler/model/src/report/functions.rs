//! HR052x: functions of automata.

use hrdsl_source::{Diagnostic, DiagnosticCode, Span};

use crate::noun::Noun;

/// HR0102: the name of a function that the language has.
pub(crate) fn built_in(name: &str, span: Span) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::DUPLICATE_NAME, span, format!("`{name}` is a function of the language"))
        .help("give it another name")
}

/// HR0521
pub(crate) fn recursion(cycle: &[&str], span: Span) -> Diagnostic {
    let first = cycle.first().copied().unwrap_or_default();
    let message = format!("`{first}` calls itself: `{}`", cycle.join("` → `"));
    Diagnostic::error(DiagnosticCode::RECURSION, span, message).help("say it by a loop: `while … { … }`")
}

/// HR0522
pub(crate) fn ends_without_value(name: &str, span: Span) -> Diagnostic {
    Diagnostic::error(
        DiagnosticCode::BAD_RETURN,
        span,
        format!("`{name}` can end without the value that it promises"),
    )
    .help("let every path through it end with `return …`")
}

/// HR0522
pub(crate) fn returns_nothing(name: &str, span: Span) -> Diagnostic {
    Diagnostic::error(
        DiagnosticCode::BAD_RETURN,
        span,
        format!("this `return` lacks the value that `{name}` promises"),
    )
    .help("write the value after it: `return …`")
}

/// HR0522
pub(crate) fn returns_something(name: &str, span: Span) -> Diagnostic {
    Diagnostic::error(
        DiagnosticCode::BAD_RETURN,
        span,
        format!("`{name}` has no value, but this returns one"),
    )
    .help(format!("write its type after the parameters: `fn {name}(…) -> …`, or just `return`"))
}

/// HR0522: an update function where a value is needed.
pub(crate) fn has_no_value(name: &str, span: Span) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::BAD_RETURN, span, format!("`{name}` has no value")).help(format!(
        "call it as a statement, or after `do`; or give it a value: `fn {name}(…) -> …` with `return …`"
    ))
}

/// HR0523
pub(crate) fn impure(name: &str, assigns: &str, span: Span) -> Diagnostic {
    let message = format!("`{name}` changes `{assigns}`, but here a value is only looked at");
    Diagnostic::error(DiagnosticCode::IMPURE, span, message)
        .help("call it after `do`, or in another function; here a function may only read")
}

/// HR0103: a clock in a function.
pub(crate) fn clock(name: &str, span: Span) -> Diagnostic {
    let message = format!("`{name}` is a clock, which a function neither reads nor sets");
    Diagnostic::error(DiagnosticCode::WRONG_KIND, span, message)
        .help(format!("compare and set it on the edge: `when {name} >= 3 s do {name} = 0`"))
}

/// HR0103: an event in a function.
pub(crate) fn event(name: &str, is: Noun, span: Span) -> Diagnostic {
    let message = format!("`{name}` is {}, which a function does not send", is.with_article());
    Diagnostic::error(DiagnosticCode::WRONG_KIND, span, message)
        .help(format!("send it on the edge: `do {name}`"))
}

/// HR0103: an assignment to the variable of a loop.
pub(crate) fn loop_variable(name: &str, span: Span) -> Diagnostic {
    let message = format!("`{name}` is the variable of a loop: it cannot be assigned");
    Diagnostic::error(DiagnosticCode::WRONG_KIND, span, message)
        .help("count by a variable of your own: `var i: 0..5 = 0; while i < 5 { …; i += 1 }`")
}

/// HR0103: a function of automata where there are none.
pub(crate) fn not_here(name: &str, span: Span) -> Diagnostic {
    let message = format!("`{name}` is a function of automata, which cannot be called here");
    Diagnostic::error(DiagnosticCode::WRONG_KIND, span, message).help("write the value itself, or a constant")
}

/// HR0206: a loop without an upper end.
pub(crate) fn open_range(span: Span) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::OUT_OF_RANGE, span, "the range of a loop needs an end")
        .help("write both ends: `0..5`; both belong to it")
}
