//! Devices and their commands.

use hrdsl_source::{Diagnostic, DiagnosticCode, Span};
use hrdsl_syntax::ast::NameSyntax;

use super::names::with_nearest;
use crate::noun::Noun;

/// HR0101: a parameter that the primitive does not take.
pub(crate) fn not_taken<'n>(
    primitive: &str,
    name: &NameSyntax,
    all: impl IntoIterator<Item = &'n str>,
) -> Diagnostic {
    let message = format!("`{primitive}` takes no `{}`", name.text);
    let error = Diagnostic::error(DiagnosticCode::UNKNOWN_NAME, name.span, message);
    with_nearest(error, Noun::Parameter, &name.text, all)
}

/// HR0101: a command that devices of this kind do not know.
pub(crate) fn cannot<'n>(
    name: &NameSyntax,
    kind: &str,
    all: impl IntoIterator<Item = &'n str>,
) -> Diagnostic {
    let message = format!("{kind} has no command `{}`", name.text);
    let error = Diagnostic::error(DiagnosticCode::UNKNOWN_NAME, name.span, message);
    with_nearest(error, Noun::Command, &name.text, all)
}

/// HR0103: a primitive of devices of another kind.
pub(crate) fn of_another<'n>(
    name: &NameSyntax,
    does: Noun,
    kind: Noun,
    all: impl IntoIterator<Item = &'n str>,
) -> Diagnostic {
    let (does, kind) = (does.with_article(), kind.with_article());
    let message = format!("`{}` is done by {does}, not by {kind}", name.text);
    let error = Diagnostic::error(DiagnosticCode::WRONG_KIND, name.span, message);
    with_nearest(error, Noun::Primitive, &name.text, all)
}

/// HR0201: a parameter of another type than the primitive's.
pub(crate) fn other_type(primitive: &str, param: &str, want: &str, got: &str, span: Span) -> Diagnostic {
    let message = format!("`{primitive}` takes `{param}: {want}`, but this is {got}");
    Diagnostic::error(DiagnosticCode::TYPE_MISMATCH, span, message).help(format!("write `{param}: {want}`"))
}

/// HR0804: a command without a parameter that its primitive needs.
pub(crate) fn missing(primitive: &str, param: &str, ty: &str, command: &NameSyntax) -> Diagnostic {
    let message = format!("`{primitive}` needs `{param}`, which `{}` does not take", command.text);
    let help = format!("write `command {}({param}: {ty})`", command.text);
    Diagnostic::error(DiagnosticCode::BAD_COMMAND, command.span, message).help(help)
}

/// HR0804: a parameter that may be left out, and is needed.
pub(crate) fn needed(primitive: &str, param: &NameSyntax) -> Diagnostic {
    let message = format!("`{primitive}` needs `{}`, which cannot be left out", param.text);
    Diagnostic::error(DiagnosticCode::BAD_COMMAND, param.span, message).help("take the `?` away")
}
