//! HR05xx: automata.

use hrdsl_source::{Code, Diagnostic, Span};

/// HR0501
pub(crate) fn no_initial(automaton: &str, span: Span) -> Diagnostic {
    Diagnostic::error(Code::NO_INITIAL_LOCATION, span, format!("`{automaton}` has no initial location"))
        .help("write `init` before one of its locations")
}

/// HR0501
pub(crate) fn second_initial(location: &str, span: Span, first: Span) -> Diagnostic {
    Diagnostic::error(Code::NO_INITIAL_LOCATION, span, format!("`{location}` is a second initial location"))
        .label(first, "the first is here")
        .help("an automaton starts in one location")
}

/// HR0502
pub(crate) fn clock_misused(clock: &str, span: Span) -> Diagnostic {
    let message =
        format!("the clock `{clock}` can only be compared with a constant, as a part of a conjunction");
    Diagnostic::error(Code::BAD_CLOCK_CONSTRAINT, span, message)
        .help(format!("write a bound such as `{clock} >= 3 s && …`; for an alternative, use two edges"))
}

/// HR0502
pub(crate) fn clock_comparison(op: &str, span: Span) -> Diagnostic {
    Diagnostic::error(Code::BAD_CLOCK_CONSTRAINT, span, format!("a clock cannot be compared by `{op}`"))
        .help("use `<`, `<=`, `==`, `>=` or `>`")
}

/// HR0502
pub(crate) fn clock_set(clock: &str, span: Span) -> Diagnostic {
    Diagnostic::error(Code::BAD_CLOCK_CONSTRAINT, span, format!("the clock `{clock}` can only be set to 0"))
        .help(format!("write `{clock} = 0`"))
}

/// HR0502
pub(crate) fn bad_invariant(span: Span) -> Diagnostic {
    Diagnostic::error(Code::BAD_CLOCK_CONSTRAINT, span, "an invariant is an upper bound on a clock")
        .help("write `x <= 3 s` or `x < 3 s`, several joined by `&&`")
}

/// HR0503
pub(crate) fn two_sends(span: Span, first: Span) -> Diagnostic {
    Diagnostic::error(Code::TWO_SENDS, span, "the edge sends a second time")
        .label(first, "it sends this already")
        .help("put a committed location between the two")
}

/// HR0503
pub(crate) fn takes_and_sends(span: Span, on: Span) -> Diagnostic {
    Diagnostic::error(Code::TWO_SENDS, span, "the edge takes an event and sends one")
        .label(on, "it takes this")
        .help("put a committed location between the two")
}

/// HR0504
pub(crate) fn sampled_emit(stimulus: &str, span: Span) -> Diagnostic {
    let message = format!("what `{stimulus}` emits depends on a sample, which an automaton does not draw");
    Diagnostic::error(Code::SAMPLED_EVENT, span, message)
        .help("let what it emits depend on a parameter of the stimulus")
}

/// HR0103: an assignment to what the edge binds.
pub(crate) fn bound_by_edge(name: &str, span: Span) -> Diagnostic {
    let message = format!("`{name}` is bound by the edge: it cannot be assigned");
    Diagnostic::error(Code::WRONG_KIND, span, message).help("assign a variable declared by `var`")
}

/// HR0201: an assignment of several parts that needs the old value of a part that it has set.
pub(crate) fn read_while_set(name: &str, span: Span) -> Diagnostic {
    let message = format!("`{name}` is read while its parts are being set");
    Diagnostic::error(Code::TYPE_MISMATCH, span, message)
        .help("set the parts one by one, or keep the old value in a variable")
}
