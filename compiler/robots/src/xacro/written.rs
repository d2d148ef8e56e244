//! How values are written out, and what a text means as a value: both as Python does it.

use super::value::XacroValue;

/// `str(value)`.
pub(super) fn written(value: &XacroValue) -> String {
    let mut out = String::new();
    write_value(value, false, &mut out);
    out
}

/// `repr(value)`: texts in quotes.
pub(super) fn represented(value: &XacroValue) -> String {
    let mut out = String::new();
    write_value(value, true, &mut out);
    out
}

fn write_value(value: &XacroValue, quoted: bool, out: &mut String) {
    match value {
        XacroValue::None => out.push_str("None"),
        XacroValue::Bool(true) => out.push_str("True"),
        XacroValue::Bool(false) => out.push_str("False"),
        XacroValue::Int(number) => out.push_str(&number.to_string()),
        XacroValue::Float(number) => out.push_str(&float(*number)),
        XacroValue::Text(text) if quoted => quote(text, out),
        XacroValue::Text(text) => out.push_str(text),
        XacroValue::List(items) => write_all(items.as_slice(), "[", "]", out),
        XacroValue::Tuple(items) => {
            write_all(items.as_slice(), "(", if items.as_slice().len() == 1 { ",)" } else { ")" }, out);
        }
        XacroValue::Dict(pairs) => {
            out.push('{');
            for (at, (key, value)) in pairs.iter().enumerate() {
                out.push_str(if at > 0 { ", " } else { "" });
                write_value(key, true, out);
                out.push_str(": ");
                write_value(value, true, out);
            }
            out.push('}');
        }
        XacroValue::Function(name) => {
            out.push_str("<built-in function ");
            out.push_str(name);
            out.push('>');
        }
    }
}

fn write_all(items: &[XacroValue], open: &str, close: &str, out: &mut String) {
    out.push_str(open);
    for (at, item) in items.iter().enumerate() {
        out.push_str(if at > 0 { ", " } else { "" });
        write_value(item, true, out);
    }
    out.push_str(close);
}

fn quote(text: &str, out: &mut String) {
    let mark = if text.contains('\'') && !text.contains('"') { '"' } else { '\'' };
    out.push(mark);
    for c in text.chars() {
        match c {
            '\n' => out.push_str("\\n"),
            '\t' => out.push_str("\\t"),
            '\r' => out.push_str("\\r"),
            '\\' => out.push_str("\\\\"),
            c if c == mark => {
                out.push('\\');
                out.push(c);
            }
            c => out.push(c),
        }
    }
    out.push(mark);
}

/// The shortest digits that read back as the number; in the form that Python chooses.
pub(super) fn float(number: f64) -> String {
    if number.is_nan() {
        return "nan".to_owned();
    }
    if number.is_infinite() {
        return if number > 0.0 { "inf" } else { "-inf" }.to_owned();
    }
    let shortest = format!("{number:e}");
    let (digits, exponent) = shortest.split_once('e').unwrap_or((&shortest, "0"));
    let power: i32 = exponent.parse().unwrap_or_default();
    if (-4..16).contains(&power) {
        let fixed = format!("{number}");
        if fixed.contains('.') { fixed } else { format!("{fixed}.0") }
    } else {
        let sign = if power < 0 { '-' } else { '+' };
        format!("{digits}e{sign}{:02}", power.abs())
    }
}

/// What a text is as a property or parameter: a number or a boolean if it looks like one, or else itself, without single
/// quotes around it.
pub(super) fn literal(text: &str) -> Option<XacroValue> {
    if let Some(inner) = text.strip_prefix('\'').and_then(|rest| rest.strip_suffix('\'')) {
        return XacroValue::text(inner).ok();
    }
    if text.contains('_') {
        return None;
    }
    let trimmed = text.trim();
    if let Some(whole) = whole(trimmed) {
        return Some(XacroValue::Int(whole));
    }
    match number(trimmed) {
        Some(number) => Some(XacroValue::Float(number)),
        None => match text {
            "true" | "True" => Some(XacroValue::Bool(true)),
            "false" | "False" => Some(XacroValue::Bool(false)),
            _ => None,
        },
    }
}

/// `int(text)`.
pub(super) fn whole(text: &str) -> Option<i64> {
    let digits = text.strip_prefix(['+', '-']).unwrap_or(text);
    let only_digits = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit());
    only_digits.then(|| text.parse().ok()).flatten()
}

/// `float(text)`.
pub(super) fn number(text: &str) -> Option<f64> {
    let starts = text.chars().next()?;
    // Rust reads the same words as Python: digits, `inf`, `infinity`, `nan`.
    if starts.is_ascii_digit() || matches!(starts, '+' | '-' | '.' | 'i' | 'I' | 'n' | 'N') {
        text.parse().ok()
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floats_are_written_as_python_writes_them() {
        for (number, expected) in [
            (1.0, "1.0"),
            (0.1 + 0.2, "0.30000000000000004"),
            (1e16, "1e+16"),
            (1e15, "1000000000000000.0"),
            (1e-4, "0.0001"),
            (1e-5, "1e-05"),
            (-1.5e-10, "-1.5e-10"),
            (1.7976931348623157e308, "1.7976931348623157e+308"),
            (0.0, "0.0"),
            (-0.0, "-0.0"),
            (123456.789, "123456.789"),
            (f64::NAN, "nan"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(float(number), expected);
        }
    }

    #[test]
    fn texts_that_look_like_values_are_values() {
        let read = |text| literal(text).map(|value| represented(&value));
        for (text, expected) in [
            ("1", "1"),
            (" 2 ", "2"),
            ("-1.50", "-1.5"),
            ("1e3", "1000.0"),
            ("true", "True"),
            ("'1'", "'1'"),
            ("''", "''"),
            (".5", "0.5"),
        ] {
            assert_eq!(read(text).as_deref(), Some(expected), "{text}");
        }
        for text in ["1_0", "a", "", "1 2", "TRUE", "nope"] {
            assert_eq!(read(text), None, "{text}");
        }
    }
}
