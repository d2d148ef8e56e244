//! Scalars: what a word without quotes means.

use super::value::YamlValue;

/// A word without quotes, as YAML 1.1 takes it: `yes` and `on` are booleans, `0x1F` a number, `~` nothing.
pub(super) fn plain(text: &str) -> YamlValue {
    match text {
        "" | "~" | "null" | "Null" | "NULL" => return YamlValue::Null,
        "true" | "True" | "TRUE" | "yes" | "Yes" | "YES" | "on" | "On" | "ON" => {
            return YamlValue::Bool(true);
        }
        "false" | "False" | "FALSE" | "no" | "No" | "NO" | "off" | "Off" | "OFF" => {
            return YamlValue::Bool(false);
        }
        ".inf" | ".Inf" | ".INF" | "+.inf" => return YamlValue::Float(f64::INFINITY),
        "-.inf" | "-.Inf" | "-.INF" => return YamlValue::Float(f64::NEG_INFINITY),
        ".nan" | ".NaN" | ".NAN" => return YamlValue::Float(f64::NAN),
        _ => {}
    }
    if let Some(number) = whole(text) {
        return YamlValue::Int(number);
    }
    // A float has a point; a word such as `1e5` is a text to YAML 1.1.
    let digits = text.chars().all(|c| c.is_ascii_digit() || matches!(c, '.' | 'e' | 'E' | '+' | '-'));
    let signed_exponent = |text: &str| match text.find(['e', 'E']) {
        Some(at) => text.get(at + 1..).is_some_and(|rest| rest.starts_with(['+', '-'])),
        None => true,
    };
    if digits
        && text.contains('.')
        && signed_exponent(text)
        && let Ok(number) = text.parse()
    {
        return YamlValue::Float(number);
    }
    YamlValue::Text(text.to_owned())
}

fn whole(text: &str) -> Option<i64> {
    let (negative, digits) = match text.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, text.strip_prefix('+').unwrap_or(text)),
    };
    let starts = digits.chars().next().is_some_and(|c| c.is_ascii_digit());
    let number = if !starts {
        None
    } else if let Some(hex) = digits.strip_prefix("0x") {
        i64::from_str_radix(hex, 16).ok().filter(|_| hex.chars().all(|c| c.is_ascii_hexdigit()))
    } else if digits.len() > 1 && digits.starts_with('0') && digits.chars().all(|c| ('0'..='7').contains(&c))
    {
        i64::from_str_radix(digits, 8).ok()
    } else if digits.len() > 1 && digits.starts_with('0') {
        None
    } else {
        digits.chars().all(|c| c.is_ascii_digit()).then(|| digits.parse().ok()).flatten()
    };
    number.map(|number: i64| if negative { -number } else { number })
}
