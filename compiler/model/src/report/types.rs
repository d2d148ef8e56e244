//! HR02xx: types, units, constants, arguments, ranges.

use hrdsl_source::{Diagnostic, DiagnosticCode, Span};

use crate::{
    Dimension, EvalError, InferredType, Type, TypedExpr, Value,
    noun::Noun,
    report::names::{replace, with_nearest},
    types::UNITS,
};

/// HR0201: something of another shape.
pub(crate) fn other_shape(want: &str, got: &str, span: Span) -> Diagnostic {
    Diagnostic::error(
        DiagnosticCode::TYPE_MISMATCH,
        span,
        format!("{want} is needed here, but this is {got}"),
    )
}

/// HR0201: several values where one is needed.
pub(crate) fn several_values(got: &str, span: Span) -> Diagnostic {
    other_shape("one value", got, span).help("name one part of it, such as `p.x` or `a[0]`")
}

/// HR0201: a goal's argument, of which nothing is known, where something of several parts is needed.
pub(crate) fn not_known(span: Span) -> Diagnostic {
    let message = "the type of this is not known: the arguments of a goal are single values";
    Diagnostic::error(DiagnosticCode::TYPE_MISMATCH, span, message)
        .help("hand over the parts one by one, or keep the whole in a belief")
}

/// HR0201: a variable that stands for something of another shape already.
pub(crate) fn other_before(name: &str, want: &str, got: &str, span: Span) -> Diagnostic {
    let message = format!("{want} is needed here, but `{name}` stands for {got} already");
    Diagnostic::error(DiagnosticCode::TYPE_MISMATCH, span, message).help("use another name")
}

/// HR0201: `norm` of what is no vector.
pub(crate) fn not_a_vector(got: &str, span: Span) -> Diagnostic {
    other_shape("a vector", got, span).help("write numbers of one dimension: `norm((3 m, 4 m))`")
}

/// HR0206
pub(crate) fn too_many_parts(size: usize, most: usize, span: Span) -> Diagnostic {
    let message = format!("this has {size} single values, and {most} are the most");
    Diagnostic::error(DiagnosticCode::OUT_OF_RANGE, span, message).help("declare it in several pieces")
}

/// HR0201: operands that cannot be combined.
pub(crate) fn shapes(op: &str, span: Span, left: (&str, Span), right: (&str, Span)) -> Diagnostic {
    Diagnostic::error(
        DiagnosticCode::TYPE_MISMATCH,
        span,
        format!("`{op}` between {} and {}", left.0, right.0),
    )
    .label(left.1, format!("this is {}", left.0))
    .label(right.1, format!("this is {}", right.0))
}

/// HR0201
pub(crate) fn no_elements(message: String, span: Span) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::TYPE_MISMATCH, span, message).help("only an array is indexed: `a[0]`")
}

/// HR0206: an index that may lie outside of its array.
pub(crate) fn bad_index(at: &TypedExpr, last: i64) -> Diagnostic {
    let message = match at.constant() {
        Some(n) => format!("the index {n} is outside of the array, whose last is {last}"),
        None => format!("the index may be outside of the array, whose last is {last}"),
    };
    Diagnostic::error(DiagnosticCode::OUT_OF_RANGE, at.span, message).help(if at.constant().is_some() {
        format!("write an index of 0..{last}: the first element is 0")
    } else {
        format!("use a variable of the type `0..{last}`, or limit it: `max(0, min({last}, …))`")
    })
}

/// HR0202
pub(crate) fn unknown_unit(text: &str, span: Span) -> Diagnostic {
    let error = Diagnostic::error(DiagnosticCode::UNKNOWN_UNIT, span, format!("no unit is called `{text}`"));
    let caret = text.replace("s2", "s^2").replace("cm2", "cm^2");
    if caret != text && UNITS.iter().any(|u| u.symbol == caret) {
        return replace(error.help(format!("did you mean `{caret}`?")), text, &caret);
    }
    let error = with_nearest(error, Noun::Unit, text, UNITS.iter().map(|u| u.symbol));
    // `sec`, `meters`: a unit written out
    let start = UNITS.iter().map(|u| u.symbol).filter(|u| text.starts_with(u)).max_by_key(|u| u.len());
    match (&error.help, start) {
        (None, Some(unit)) => replace(error.help(format!("did you mean `{unit}`?")), text, unit),
        (Some(_), _) | (None, None) => error,
    }
}

/// HR0201, HR0203 or the bare number: `want` is needed and `got` is there.
pub(crate) fn mismatch(
    want: InferredType,
    got: InferredType,
    value: Option<Value>,
    span: Span,
) -> Diagnostic {
    let message = format!("{want} is needed here, but this is {got}");
    match (want, got.dim()) {
        (InferredType::Float(dim), Some(_)) if got.is_bare() => bare_number(dim, value, span),
        (InferredType::Float(_), Some(_)) => Diagnostic::error(DiagnosticCode::UNIT_MISMATCH, span, message),
        (InferredType::Enum(of), _) => Diagnostic::error(DiagnosticCode::TYPE_MISMATCH, span, message)
            .help(format!("its values are: {}", of.listed())),
        (
            InferredType::Float(_)
            | InferredType::Bool
            | InferredType::Int
            | InferredType::Text
            | InferredType::List(_)
            | InferredType::Unknown,
            _,
        ) => Diagnostic::error(DiagnosticCode::TYPE_MISMATCH, span, message),
    }
}

/// HR0203: a number without the unit that the place needs.
pub(crate) fn bare_number(dim: Dimension, value: Option<Value>, span: Span) -> Diagnostic {
    let error = Diagnostic::error(
        DiagnosticCode::UNIT_MISMATCH,
        span,
        format!("{dim} needs a unit, but this is a bare number"),
    );
    match (value, dim.symbol()) {
        (Some(value), Some(unit)) => error.help(format!("write `{value} {unit}`")),
        (None, Some(unit)) => error.help(format!("give it the unit `{unit}`")),
        (_, None) => error,
    }
}

/// HR0203: the operands have different dimensions.
pub(crate) fn dimensions(op: &str, left: (InferredType, Span), right: (InferredType, Span)) -> Diagnostic {
    let (l, r) = (left.0, right.0);
    Diagnostic::error(
        DiagnosticCode::UNIT_MISMATCH,
        left.1.to(right.1),
        format!("`{op}` between {l} and {r}"),
    )
    .label(left.1, format!("this is {l}"))
    .label(right.1, format!("this is {r}"))
    .help("both sides must have the same dimension")
}

/// HR0201: the operands have different types.
pub(crate) fn operands(op: &str, left: (InferredType, Span), right: (InferredType, Span)) -> Diagnostic {
    let (l, r) = (left.0, right.0);
    let issue = Diagnostic::error(
        DiagnosticCode::TYPE_MISMATCH,
        left.1.to(right.1),
        format!("`{op}` between {l} and {r}"),
    )
    .label(left.1, format!("this is {l}"))
    .label(right.1, format!("this is {r}"));
    match (l, r) {
        (InferredType::Enum(a), InferredType::Enum(b)) if a == b => {
            issue.help("the values of an enumeration are compared by `==` and `!=` alone")
        }
        (_, _) => issue,
    }
}

/// HR0201: something that has no value.
pub(crate) fn no_value(what: &str, span: Span) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::TYPE_MISMATCH, span, format!("{what} is not a value"))
}

/// HR0201: floats where the models need finitely many values.
pub(crate) fn not_finite(what: &str, span: Span) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::TYPE_MISMATCH, span, format!("{what} must have finitely many values"))
        .help("use `bool` or a range such as `0..4`")
}

/// HR0204
pub(crate) fn not_constant(span: Span) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::NOT_CONSTANT, span, "a constant is needed here")
        .help("use a literal or a name declared by `const`")
}

/// HR0208
pub(crate) fn record_cycle(name: &str, span: Span) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::CONSTANT_CYCLE, span, format!("the record `{name}` contains itself"))
        .help("remove the field, or give it another type")
}

/// HR0103: a parameter that stands for several events, or for an event with certain arguments.
pub(crate) fn several_events(name: &str, span: Span) -> Diagnostic {
    let message = format!("`{name}` stands for a pattern, and one event is needed here");
    Diagnostic::error(DiagnosticCode::WRONG_KIND, span, message)
        .help("give the template the name of one event alone")
}

/// HR0201: an argument that must be a name.
pub(crate) fn needs_name(noun: Noun, span: Span) -> Diagnostic {
    let message = format!("{} is needed here", noun.with_article());
    Diagnostic::error(DiagnosticCode::TYPE_MISMATCH, span, message)
        .help(format!("write the name of {}", noun.with_article()))
}

/// HR0208
pub(crate) fn constant_cycle(name: &str, span: Span, declared: Span) -> Diagnostic {
    Diagnostic::error(
        DiagnosticCode::CONSTANT_CYCLE,
        span,
        format!("the constant `{name}` needs its own value"),
    )
    .label(declared, "declared here")
}

/// HR0206: arithmetic on constants that has no result.
pub(crate) fn fold(error: EvalError, span: Span) -> Diagnostic {
    let (message, help) = match error {
        EvalError::DivisionByZero => ("this divides by zero", Some("divide by a number that is never zero")),
        EvalError::Overflow => ("this number is too large", Some("use smaller numbers")),
        EvalError::Type
        | EvalError::Unbound(_)
        | EvalError::Index { .. }
        | EvalError::Endless
        | EvalError::Range(_)
        | EvalError::Outside { .. } => ("the operands do not fit the operator", None),
    };
    let issue = Diagnostic::error(DiagnosticCode::OUT_OF_RANGE, span, message);
    match help {
        Some(help) => issue.help(help),
        None => issue,
    }
}

/// HR0206
pub(crate) fn out_of_range(value: Value, lo: i64, hi: i64, span: Span) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::OUT_OF_RANGE, span, format!("{value} is outside {lo}..{hi}"))
        .help(format!("a value of {lo}..{hi} is needed"))
}

/// HR0206
pub(crate) fn must_be(what: &str, rule: &str, span: Span) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::OUT_OF_RANGE, span, format!("{what} must be {rule}"))
}

/// HR0207
pub(crate) fn empty_range(lo: Value, hi: Value, span: Span) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::EMPTY_RANGE, span, format!("no value lies in {lo}..{hi}"))
        .help(format!("write `{hi}..{lo}`, the smaller end first"))
}

/// HR0205
pub(crate) fn arity(noun: Noun, name: &str, names: &[&str], got: usize, span: Span) -> Diagnostic {
    counts(noun, name, names.len(), got, span).help(if names.is_empty() {
        format!("write `{name}`")
    } else {
        format!("write `{name}({})`", names.join(", "))
    })
}

/// HR0205
pub(crate) fn counts(noun: Noun, name: &str, want: usize, got: usize, span: Span) -> Diagnostic {
    let s = if want == 1 { "" } else { "s" };
    let what = if noun == Noun::Record { "field" } else { "argument" };
    Diagnostic::error(
        DiagnosticCode::ARITY,
        span,
        format!(
            "the {noun} `{name}` has {want} {what}{s}, but {got} {} given",
            if got == 1 { "is" } else { "are" }
        ),
    )
}

/// HR0211: a string or list in something that no agent has.
pub(crate) fn of_agents_only(name: &str, ty: Type, span: Span) -> Diagnostic {
    let message = format!("`{name}` is {}, which only agents know", InferredType::of(ty));
    let help = match ty {
        Type::Text => "declare an enumeration: `enum Word { first, second }`",
        Type::Bool | Type::Int { .. } | Type::Float(_) | Type::Enum(_) | Type::List(_) => {
            "use an array, such as `bool[4]`, or several parameters"
        }
    };
    Diagnostic::error(DiagnosticCode::OF_AGENTS_ONLY, span, message).help(help)
}
