//! HR04xx: agents.

use hrdsl_source::{Code, Diagnostic, Span};

use crate::{noun::Noun, report::names::with_nearest};

/// HR0401: a variable is read before anything gives it a value.
pub(crate) fn unbound<'a>(name: &str, span: Span, others: impl IntoIterator<Item = &'a str>) -> Diagnostic {
    let error = Diagnostic::error(Code::UNBOUND_VARIABLE, span, format!("`{name}` never has a value here"))
        .here("read before the trigger, a belief or a query binds it");
    with_nearest(error, Noun::Variable, name, others)
}

/// HR0403
pub(crate) fn not_adopted<'a>(
    name: &str,
    span: Span,
    adopted: impl IntoIterator<Item = &'a str>,
) -> Diagnostic {
    let warning = Diagnostic::warning(Code::NOT_ADOPTED, span, format!("nothing adopts the goal `{name}`"));
    with_nearest(warning, Noun::Goal, name, adopted)
}

/// HR0402: a goal without a plan.
pub(crate) fn no_plan<'a>(name: &str, span: Span, goals: impl IntoIterator<Item = &'a str>) -> Diagnostic {
    let error = Diagnostic::error(Code::NO_PLAN, span, format!("no plan achieves the goal `{name}`"));
    with_nearest(error, Noun::Goal, name, goals)
}
