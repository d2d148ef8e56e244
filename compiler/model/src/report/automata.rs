//! HR05xx: automata.

use hrdsl_source::{Diagnostic, DiagnosticCode, Span};

use crate::noun::Noun;

/// Why a sum is no time that an engine can count with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BadTime {
    /// A factor is no whole number of nanoseconds.
    Fraction,
    TooLong,
}

/// HR0501
pub(crate) fn no_initial(automaton: &str, span: Span) -> Diagnostic {
    Diagnostic::error(
        DiagnosticCode::NO_INITIAL_LOCATION,
        span,
        format!("`{automaton}` has no initial location"),
    )
    .help("write `init` before one of its locations")
}

/// HR0501
pub(crate) fn second_initial(location: &str, span: Span, first: Span) -> Diagnostic {
    Diagnostic::error(
        DiagnosticCode::NO_INITIAL_LOCATION,
        span,
        format!("`{location}` is a second initial location"),
    )
    .label(first, "the first is here")
    .help("an automaton starts in one location")
}

/// HR0502
pub(crate) fn clock_misused(clock: &str, span: Span) -> Diagnostic {
    let message = format!("the clock `{clock}` can only be compared with a time, as a part of a conjunction");
    Diagnostic::error(DiagnosticCode::BAD_CLOCK_CONSTRAINT, span, message)
        .help(format!("write a bound such as `{clock} >= 3 s && …`; for an alternative, use two edges"))
}

/// HR0502
pub(crate) fn clock_comparison(op: &str, span: Span) -> Diagnostic {
    Diagnostic::error(
        DiagnosticCode::BAD_CLOCK_CONSTRAINT,
        span,
        format!("a clock cannot be compared by `{op}`"),
    )
    .help("use `<`, `<=`, `==`, `>=` or `>`")
}

/// HR0502
pub(crate) fn clock_set(clock: &str, span: Span) -> Diagnostic {
    let message = format!("the clock `{clock}` can only be set to a time, or to another clock plus one");
    Diagnostic::error(DiagnosticCode::BAD_CLOCK_CONSTRAINT, span, message)
        .help(format!("write `{clock} = 0`, `{clock} = n * 1 s`, or `{clock} = y + 2 s`"))
}

/// HR0502: `stopped` of something else than one clock.
pub(crate) fn stopped_what(span: Span) -> Diagnostic {
    let message = "what stands still is one clock";
    Diagnostic::error(DiagnosticCode::BAD_CLOCK_CONSTRAINT, span, message)
        .help("write `invariant stopped(x)` with a clock `x` that the automaton knows; for another one, `&& stopped(y)`")
}

/// HR0502: `stopped` under an operator.
pub(crate) fn stopped_within(span: Span) -> Diagnostic {
    let message = "that a clock stands still is a part of an invariant by itself";
    Diagnostic::error(DiagnosticCode::BAD_CLOCK_CONSTRAINT, span, message)
        .help("join it by `&&`; where a clock stands only sometimes, make two locations of this one")
}

/// HR0502: `stopped` in a guard.
pub(crate) fn stopped_on_edge(span: Span) -> Diagnostic {
    let message = "a clock stands still in a location, and an edge takes no time";
    Diagnostic::error(DiagnosticCode::BAD_CLOCK_CONSTRAINT, span, message)
        .help("write it in the location: `location waiting { invariant stopped(x) }`")
}

/// HR0502: a comparison of something else than a clock or a difference.
pub(crate) fn clock_sum(span: Span) -> Diagnostic {
    let message = "a clock is compared, or the difference of two clocks, and this is neither";
    Diagnostic::error(DiagnosticCode::BAD_CLOCK_CONSTRAINT, span, message)
        .help("write a bound such as `x <= 3 s` or `x - y < n * 1 s`")
}

/// HR0502: a time that variables have another part in than that of a factor.
pub(crate) fn not_linear(span: Span) -> Diagnostic {
    let message =
        "a clock is compared with sums of constant times and of whole numbers that multiply such times";
    Diagnostic::error(DiagnosticCode::BAD_CLOCK_CONSTRAINT, span, message)
        .here("this is no such sum")
        .help("write sums and differences of `3 s` and `n * 1 s`, or an `if` between them")
}

/// HR0502: a time that cannot be counted in nanoseconds.
pub(crate) fn bad_time(why: BadTime, span: Span) -> Diagnostic {
    let (message, help) = match why {
        BadTime::Fraction => (
            "a variable multiplies a time that is no whole number of nanoseconds",
            "multiply it by a whole one: `n * 1 ms`",
        ),
        BadTime::TooLong => ("this time is longer than thirty years", "times are at most 1000000000 s"),
    };
    Diagnostic::error(DiagnosticCode::BAD_CLOCK_CONSTRAINT, span, message).help(help)
}

/// HR0502
pub(crate) fn clock_init(clock: &str, span: Span) -> Diagnostic {
    let message = format!("the clock `{clock}` starts at 0 as all clocks do");
    Diagnostic::error(DiagnosticCode::BAD_CLOCK_CONSTRAINT, span, message)
        .help("set it on an edge that leaves `init`")
}

/// HR0502: an array of clocks without an index, or a clock with one.
pub(crate) fn clock_indices(clock: &str, sizes: usize, span: Span) -> Diagnostic {
    let (message, form) = match sizes {
        0 => (format!("`{clock}` is one clock: it has no elements"), format!("write `{clock}`")),
        n => (
            format!("`{clock}` is an array of clocks"),
            format!("name one of them: `{clock}{}`", "[0]".repeat(n)),
        ),
    };
    Diagnostic::error(DiagnosticCode::BAD_CLOCK_CONSTRAINT, span, message).help(form)
}

/// HR0502: `clock` as the type of something else than a shared variable.
pub(crate) fn clock_type(span: Span) -> Diagnostic {
    let message = "`clock` is only the type of a variable that all automata share";
    Diagnostic::error(DiagnosticCode::BAD_CLOCK_CONSTRAINT, span, message)
        .help("write `var t: clock` outside of automata, and `clock x` inside of one")
}

/// HR0503
pub(crate) fn two_sends(span: Span, first: Span) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::TWO_SENDS, span, "the edge sends a second time")
        .label(first, "it sends this already")
        .help("put a committed location between the two")
}

/// HR0503
pub(crate) fn takes_and_sends(span: Span, on: Span) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::TWO_SENDS, span, "the edge has a part with `on`, and sends as well")
        .label(on, "it takes this")
        .help("put a committed location between the two")
}

/// HR0504
pub(crate) fn sampled_emit(stimulus: &str, span: Span) -> Diagnostic {
    let message = format!("what `{stimulus}` emits depends on a sample, which an automaton does not draw");
    Diagnostic::error(DiagnosticCode::SAMPLED_EVENT, span, message)
        .help("let what it emits depend on a parameter of the stimulus")
}

/// HR0103: an assignment to what the edge binds.
pub(crate) fn bound_by_edge(name: &str, span: Span) -> Diagnostic {
    let message = format!("`{name}` is bound by the edge: it cannot be assigned");
    Diagnostic::error(DiagnosticCode::WRONG_KIND, span, message).help("assign a variable declared by `var`")
}

/// HR0201: an assignment of several parts that needs the old value of a part that it has set.
pub(crate) fn read_while_set(name: &str, span: Span) -> Diagnostic {
    let message = format!("`{name}` is read while its parts are being set");
    Diagnostic::error(DiagnosticCode::TYPE_MISMATCH, span, message)
        .help("set the parts one by one, or keep the old value in a variable")
}

/// HR0511
pub(crate) fn urgent_guard(channel: &str, span: Span, declared: Span) -> Diagnostic {
    let message = format!("an edge of the urgent channel `{channel}` has no clock guard");
    Diagnostic::error(DiagnosticCode::URGENT_GUARD, span, message)
        .label(declared, "it is declared here")
        .help("guard it by variables alone, or let the channel not be urgent")
}

/// HR0512: an edge of an automaton that has no part in the channel.
pub(crate) fn not_a_participant(automaton: &str, channel: &str, span: Span, declared: Span) -> Diagnostic {
    let message = format!("`{automaton}` has no part in the multi-way channel `{channel}`");
    Diagnostic::error(DiagnosticCode::BAD_JOINT, span, message)
        .label(declared, "its participants are named here")
        .help(format!("add `| {automaton}` to them, or use another channel"))
}

/// HR0512
pub(crate) fn multi_way_offered(channel: &str, span: Span) -> Diagnostic {
    let message = format!("nobody offers the multi-way channel `{channel}`: all its participants are alike");
    Diagnostic::error(DiagnosticCode::BAD_JOINT, span, message)
        .help(format!("write `on {channel}` on the edge of each"))
}

/// HR0512
pub(crate) fn multi_way_params(channel: &str, span: Span) -> Diagnostic {
    let message = format!("the multi-way channel `{channel}` carries nothing: nobody sends");
    Diagnostic::error(DiagnosticCode::BAD_JOINT, span, message)
        .help("hand values over in shared variables, or declare a channel for each value")
}

/// HR0513
pub(crate) fn no_actor(automaton: &str, noun: Noun, name: &str, span: Span) -> Diagnostic {
    let message = format!("`{automaton}` plays no actor, so that it knows no {}", noun.plural());
    Diagnostic::error(DiagnosticCode::NO_ACTOR, span, message)
        .here(format!("`{name}` is {}", noun.with_article()))
        .help(format!("write `automaton {automaton} plays ACTOR`, or use a channel"))
}
