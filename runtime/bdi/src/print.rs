//! Values as they are printed.

use hrdsl_ir::Value;

/// A value as it is printed: a string without its quotes.
pub(crate) fn plain(value: Value) -> String {
    match value {
        Value::Text(text) => text.as_str().to_owned(),
        Value::Bool(_) | Value::Int(_) | Value::Float(_) | Value::Symbol(_) | Value::List(_) => {
            value.to_string()
        }
    }
}

/// The same as Jason prints it: lists without spaces, numbers as Java writes them.
pub(crate) fn as_jason(value: Value) -> String {
    let within = |v: Value| match v {
        Value::Text(_) => v.to_string(),
        Value::Bool(_) | Value::Int(_) | Value::Float(_) | Value::Symbol(_) | Value::List(_) => as_jason(v),
    };
    match value {
        Value::Float(x) => as_java(x),
        Value::List(list) => format!("[{}]", list.iter().map(within).collect::<Vec<_>>().join(",")),
        Value::Text(_) | Value::Bool(_) | Value::Int(_) | Value::Symbol(_) => plain(value),
    }
}

/// A number: whole ones without a point, very small and large ones with an exponent.
fn as_java(x: f64) -> String {
    /// Up to here a float is one whole number.
    const WHOLE: f64 = 9.0e18;
    if x.fract() == 0.0 && x.abs() < WHOLE {
        return if x == 0.0 { "0".to_owned() } else { format!("{x:.0}") };
    }
    if (1e-3..1e7).contains(&x.abs()) || !x.is_finite() {
        return x.to_string();
    }
    let text = format!("{x:E}");
    match text.split_once('E') {
        Some((digits, exponent)) if !digits.contains('.') => format!("{digits}.0E{exponent}"),
        _ => text,
    }
}
