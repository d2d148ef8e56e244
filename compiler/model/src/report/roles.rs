//! HR03xx: who does what.

use hrdsl_source::{Diagnostic, DiagnosticCode, Span};

use crate::noun::Noun;

/// HR0301: a stimulus of the system.
pub(crate) fn stimulus_by_system(actor: &str, span: Span) -> Diagnostic {
    Diagnostic::error(
        DiagnosticCode::WRONG_ROLE,
        span,
        format!("`{actor}` is the system: it does not stimulate itself"),
    )
    .help("a stimulus is done by an actor with the role `environment`")
}

/// HR0301: code under test for an actor of the environment.
pub(crate) fn system_plays_environment(actor: &str, span: Span) -> Diagnostic {
    Diagnostic::error(
        DiagnosticCode::WRONG_ROLE,
        span,
        format!("`{actor}` is environment: no code under test plays it"),
    )
    .help(format!("declare `actor {actor} : system`, or name an actor with that role"))
}

/// HR0301: a test or a random suite would do what the system does.
pub(crate) fn test_acts_for_system(event: &str, actor: &str, span: Span) -> Diagnostic {
    let message =
        format!("`{event}` is made by `{actor}`, the system: a test does only what the environment does");
    Diagnostic::error(DiagnosticCode::WRONG_ROLE, span, message)
        .help(format!("to wait for it, write `await {event}`"))
}

/// HR0302: an agent or automaton does what another actor does.
pub(crate) fn not_its_event(event: &str, owner: &str, player: &str, span: Span) -> Diagnostic {
    let message = format!("`{event}` is made by `{owner}`, but this plays `{player}`");
    Diagnostic::error(DiagnosticCode::NOT_ITS_EVENT, span, message)
        .help(format!("only what plays `{owner}` can do it; to react to it, use `on {event}`"))
}

/// HR0302: a step in the block of another actor.
pub(crate) fn not_its_step(event: &str, owner: &str, actor: &str, span: Span) -> Diagnostic {
    let message = format!("`{event}` is done by `{owner}`, but this is the block of `{actor}`");
    Diagnostic::error(DiagnosticCode::NOT_ITS_EVENT, span, message)
        .help(format!("move it to the block of `{owner}`; to wait for it here, write `await {event}`"))
}

/// HR0302: the event of an `emit` in a stimulus of another actor.
pub(crate) fn emits_for_other(event: &str, owner: &str, actor: &str, span: Span) -> Diagnostic {
    let message = format!("`{event}` is made by `{owner}`, but the stimulus is by `{actor}`");
    Diagnostic::error(DiagnosticCode::NOT_ITS_EVENT, span, message)
}

/// HR0303: an event that does not reach its receiver.
pub(crate) fn not_perceived(noun: Noun, event: &str, actor: &str, why: &str, span: Span) -> Diagnostic {
    Diagnostic::error(
        DiagnosticCode::NOT_PERCEIVED,
        span,
        format!("`{actor}` never perceives the {noun} `{event}`"),
    )
    .help(why.to_owned())
}
