//! HR01xx: names.

use hrdsl_source::{Diagnostic, DiagnosticCode, Span, nearest};

use crate::noun::Noun;

/// HR0101: nothing of this kind has the name.
pub(crate) fn unknown<'a>(
    noun: Noun,
    text: &str,
    span: Span,
    names: impl IntoIterator<Item = &'a str>,
) -> Diagnostic {
    let error =
        Diagnostic::error(DiagnosticCode::UNKNOWN_NAME, span, format!("no {noun} is called `{text}`"));
    with_nearest(error, noun, text, names)
}

/// HR0103: the name belongs to something of another kind.
pub(crate) fn wrong_kind<'a>(
    noun: Noun,
    is: Noun,
    text: &str,
    span: Span,
    names: impl IntoIterator<Item = &'a str>,
) -> Diagnostic {
    let message = format!("`{text}` is {}, not {}", is.with_article(), noun.with_article());
    with_nearest(Diagnostic::error(DiagnosticCode::WRONG_KIND, span, message), noun, text, names)
}

/// Adds the nearest name as help and as a fix, or all names if none is near and they are few.
pub(crate) fn with_nearest<'a>(
    error: Diagnostic,
    noun: Noun,
    text: &str,
    names: impl IntoIterator<Item = &'a str>,
) -> Diagnostic {
    let names: Vec<&str> = names.into_iter().collect();
    if let Some(near) = nearest(text, names.iter().copied()) {
        return replace(error.help(format!("did you mean `{near}`?")), text, near);
    }
    match names.len() {
        0 => error.help(format!("there are no {} here", noun.plural())),
        1..=10 => error.help(format!("the {} are: `{}`", noun.plural(), names.join("`, `"))),
        _ => error,
    }
}

/// HR0101: a bare name that several enumerations have.
pub(crate) fn ambiguous(text: &str, of: &[&str], span: Span) -> Diagnostic {
    let message = format!("`{text}` is a value of several enumerations: `{}`", of.join("`, `"));
    Diagnostic::error(DiagnosticCode::UNKNOWN_NAME, span, message).help(format!("write `{}.{text}`", of[0]))
}

/// Offers another name in place of the one at fault, if its span holds just that name (and no quotes).
pub(crate) fn replace(error: Diagnostic, text: &str, near: &str) -> Diagnostic {
    let span = error.span();
    if span.range().len() != text.len() {
        return error;
    }
    error.fix(format!("replace `{text}` by `{near}`"), span, near, false)
}

/// HR0102: a second declaration.
pub(crate) fn duplicate(noun: Noun, text: &str, span: Span, first: Option<Span>) -> Diagnostic {
    let message = format!("{} is called `{text}` already", noun.with_article());
    let error = Diagnostic::error(DiagnosticCode::DUPLICATE_NAME, span, message)
        .help("give one of them another name");
    match first {
        Some(first) => error.label(first, "declared here first"),
        None => error,
    }
}

/// HR0102: a second declaration of something that has no name but can be there only once.
pub(crate) fn twice(what: &str, span: Span, first: Span) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::DUPLICATE_NAME, span, format!("a second {what}"))
        .label(first, "the first is here")
        .help("put both into one")
}

/// HR0105: a declaration is missing.
pub(crate) fn missing(span: Span, message: impl Into<String>, help: impl Into<String>) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::MISSING_DECLARATION, span, message).help(help)
}
