//! HR04xx: agents.

use hrdsl_source::{Diagnostic, DiagnosticCode, Span, SpanLabel, nearest};

use crate::{InferredType, noun::Noun, report::names::with_nearest};

/// HR0401: a variable is read before anything gives it a value.
pub(crate) fn unbound<'a>(name: &str, span: Span, others: impl IntoIterator<Item = &'a str>) -> Diagnostic {
    let error =
        Diagnostic::error(DiagnosticCode::UNBOUND_VARIABLE, span, format!("`{name}` never has a value here"))
            .here("read before the trigger, a belief or a query binds it");
    with_nearest(error, Noun::Variable, name, others)
}

/// Of a name without a value that may have been meant as a variable: variables begin with a capital letter. Of other names that
/// are near, only long ones tell what was meant.
pub(crate) fn small_variable(issue: &mut Diagnostic, name: &str, names: &[String]) {
    if issue.code != DiagnosticCode::UNKNOWN_NAME {
        return;
    }
    let rule = "variables of agents begin with a capital letter";
    if let Some(same) = names.iter().find(|other| other.eq_ignore_ascii_case(name)) {
        issue.help = Some(format!("{rule}: write `{same}`"));
    } else if name.len() <= 2 || nearest(name, names.iter().map(String::as_str)).is_none() {
        let capital: String =
            name.chars().take(1).map(|c| c.to_ascii_uppercase()).chain(name.chars().skip(1)).collect();
        issue.help = Some(format!("{rule}: write `{capital}` here and where it gets its value"));
        issue.fixes.clear();
    }
}

/// HR0403
pub(crate) fn not_adopted<'a>(
    name: &str,
    span: Span,
    adopted: impl IntoIterator<Item = &'a str>,
) -> Diagnostic {
    let warning =
        Diagnostic::warning(DiagnosticCode::NOT_ADOPTED, span, format!("nothing adopts the goal `{name}`"));
    with_nearest(warning, Noun::Goal, name, adopted)
}

/// HR0402: a goal without a plan.
pub(crate) fn no_plan<'a>(name: &str, span: Span, goals: impl IntoIterator<Item = &'a str>) -> Diagnostic {
    let error =
        Diagnostic::error(DiagnosticCode::NO_PLAN, span, format!("no plan achieves the goal `{name}`"));
    with_nearest(error, Noun::Goal, name, goals)
}

/// HR0402 and HR0403 about a goal whose types are declared: perhaps it was to be adopted. `written`: the goal as `goal` has
/// it, `deliver(…)`.
pub(crate) fn only_declared(issue: Diagnostic, written: &str, declared: Span) -> Diagnostic {
    if issue.fixes.is_empty() {
        let here = if issue.span() == declared {
            issue
        } else {
            issue.label(declared, "this declares its types only")
        };
        return here.help(format!("write `goal !{written}` to adopt it at the start"));
    }
    issue
}

/// HR0401: a rule reads an argument that has no value where the belief is asked.
pub(crate) fn rule_needs(name: &str, index: usize, span: Span) -> Diagnostic {
    let message = format!("the rules for `{name}` need a value for argument {}", index + 1);
    Diagnostic::error(DiagnosticCode::UNBOUND_VARIABLE, span, message)
        .here("this has none here")
        .help("bind it first, by a belief or with `X = …`")
}

/// HR0107: a variable that a goal gives a value to, which nothing reads.
pub(crate) fn given_unread<'a>(
    name: &str,
    span: Span,
    others: impl IntoIterator<Item = &'a str>,
) -> Diagnostic {
    let message = format!("nothing reads `{name}`, to which the goal gives a value");
    let warning = Diagnostic::warning(DiagnosticCode::UNUSED, span, message);
    let others: Vec<&str> = others.into_iter().collect();
    if nearest(name, others.iter().copied()).is_some() {
        with_nearest(warning, Noun::Variable, name, others)
    } else {
        warning.help("write `_` if the value does not matter")
    }
}

/// HR0401 of a goal's argument: why the goal does not give it a value.
pub(crate) fn not_given(issue: &mut Diagnostic, goal: &str, argument: usize, plan: Span, reads: bool) {
    let at = argument + 1;
    let text = if reads {
        format!("this plan reads argument {at} of `{goal}` before it has a value")
    } else {
        format!("this plan gives argument {at} of `{goal}` no value")
    };
    issue.labels.push(SpanLabel { span: plan, text });
    if issue.fixes.is_empty() {
        issue.help = Some("bind it first, or let each plan of the goal give it a value".to_owned());
    }
}

/// HR0201: a variable that is of one kind on one way, and of another on the other.
pub(crate) fn two_kinds(name: &str, one: InferredType, other: InferredType, span: Span) -> Diagnostic {
    let message = format!("`{name}` is {one} on one path, and {other} on the other");
    Diagnostic::error(DiagnosticCode::TYPE_MISMATCH, span, message).help("use two names")
}

/// HR0411: something that is no annotation.
pub(crate) fn no_annotation(span: Span) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::OUT_OF_PLACE, span, "this is no annotation")
        .help("an annotation is a name with one value: `[source(S)]`")
}

/// HR0411: annotations where there are none.
pub(crate) fn not_annotated(what: &str, span: Span) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::OUT_OF_PLACE, span, format!("{what} has no annotations"))
        .help("remove the brackets: beliefs and goals have annotations")
}

/// HR0411: a strong negation of what is no belief.
pub(crate) fn not_negated(what: &str, span: Span) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::OUT_OF_PLACE, span, format!("{what} has no strong negation"))
        .help("remove the `~`: beliefs alone have one")
}

/// HR0411: `X = e` where a value is needed.
pub(crate) fn no_binding(span: Span, in_plan: bool) -> Diagnostic {
    let message = if in_plan { "`=` binds a variable, and has no value" } else { "`=` compares nothing" };
    let help = if in_plan {
        "to compare, use `==`; to bind, write it as a part of its own: `X = e && …`"
    } else {
        "to compare, use `==`"
    };
    Diagnostic::error(DiagnosticCode::OUT_OF_PLACE, span, message).help(help)
}

/// HR0411: a formula where a value is needed.
pub(crate) fn no_formula(what: &str, span: Span, help: impl Into<String>) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::OUT_OF_PLACE, span, format!("{what} has no value")).help(help)
}

/// HR0411: an internal action that does something, in a formula.
pub(crate) fn is_a_step(name: &str, usage: &str, span: Span) -> Diagnostic {
    let message = format!("`.{name}` does something: it is a step, and no part of a formula");
    Diagnostic::error(DiagnosticCode::OUT_OF_PLACE, span, message)
        .help(format!("write `{usage}` in the body of a plan"))
}

/// HR0412
pub(crate) fn bad_message(span: Span, message: impl Into<String>, help: impl Into<String>) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::BAD_MESSAGE, span, message).help(help)
}
