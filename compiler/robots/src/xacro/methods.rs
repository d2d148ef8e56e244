//! Methods of texts and dictionaries.

use super::{
    operate::equal,
    value::{EvalResult, XacroValue, not_done, wrong},
    written::written,
};
use crate::limits::MOST_VALUE_SIZE;

pub(super) fn call_method(of: &XacroValue, name: &str, arguments: &[XacroValue]) -> EvalResult<XacroValue> {
    match of {
        XacroValue::Text(text) => of_text(text, name, arguments),
        XacroValue::Dict(pairs) => of_dict(pairs.as_slice(), name, arguments),
        XacroValue::List(items) | XacroValue::Tuple(items) => match (name, arguments) {
            ("index", [one]) => match items.iter().position(|item| equal(item, one)) {
                Some(at) => Ok(XacroValue::Int(at as i64)),
                None => wrong(format!("`{}` is not in the list", written(one)), "ask before: `x in list`"),
            },
            ("count", [one]) => {
                Ok(XacroValue::Int(items.iter().filter(|item| equal(item, one)).count() as i64))
            }
            _ => not_done(format!("method `{name}` of a list"), "compute it otherwise"),
        },
        XacroValue::None
        | XacroValue::Bool(_)
        | XacroValue::Int(_)
        | XacroValue::Float(_)
        | XacroValue::Function(_) => {
            wrong(format!("{} has no `{name}`", of.noun()), "take it of a text, a list or a dictionary")
        }
    }
}

fn of_text(text: &str, name: &str, arguments: &[XacroValue]) -> EvalResult<XacroValue> {
    let texts: Option<Vec<&str>> = arguments
        .iter()
        .map(|argument| if let XacroValue::Text(text) = argument { Some(&**text) } else { None })
        .collect();
    let list = |parts: Vec<&str>| {
        XacroValue::list(parts.into_iter().map(XacroValue::text).collect::<EvalResult<_>>()?)
    };
    match (name, texts.as_deref()) {
        ("split", Some([])) => list(text.split_whitespace().collect()),
        ("split", Some([by])) if !by.is_empty() => list(text.split(by).collect()),
        ("strip", Some([])) => XacroValue::text(text.trim()),
        ("lstrip", Some([])) => XacroValue::text(text.trim_start()),
        ("rstrip", Some([])) => XacroValue::text(text.trim_end()),
        ("lower", Some([])) => XacroValue::text(text.to_lowercase()),
        ("upper", Some([])) => XacroValue::text(text.to_uppercase()),
        ("startswith", Some([part])) => Ok(XacroValue::Bool(text.starts_with(part))),
        ("endswith", Some([part])) => Ok(XacroValue::Bool(text.ends_with(part))),
        ("find", Some([part])) => {
            let at =
                text.find(part).map_or(-1, |at| text.get(..at).unwrap_or_default().chars().count() as i64);
            Ok(XacroValue::Int(at))
        }
        ("replace", Some([from, to])) => {
            let places = text.matches(from).count();
            if places.saturating_mul(to.len()) > MOST_VALUE_SIZE {
                return wrong("a text becomes too long", "replace less of it");
            }
            XacroValue::text(text.replace(from, to))
        }
        ("isdigit", Some([])) => {
            Ok(XacroValue::Bool(!text.is_empty() && text.chars().all(|c| c.is_ascii_digit())))
        }
        ("join", None) => match arguments {
            [list] => {
                let mut parts = Vec::new();
                for value in list.iterated()? {
                    let XacroValue::Text(part) = value else {
                        return wrong(
                            format!("`join` meets {}", value.noun()),
                            "write `[str(x) for x in list]`",
                        );
                    };
                    parts.push(part);
                }
                XacroValue::text(parts.join(text))
            }
            _ => wrong("`join` takes one list", "write `', '.join(list)`"),
        },
        _ => not_done(format!("method `{name}` of a text, or its arguments,"), "compute it otherwise"),
    }
}

fn of_dict(
    pairs: &[(XacroValue, XacroValue)],
    name: &str,
    arguments: &[XacroValue],
) -> EvalResult<XacroValue> {
    let find = |key: &XacroValue| pairs.iter().find(|(k, _)| equal(k, key)).map(|(_, value)| value.clone());
    match (name, arguments) {
        ("get", [key]) => Ok(find(key).unwrap_or(XacroValue::None)),
        ("get", [key, otherwise]) => Ok(find(key).unwrap_or_else(|| otherwise.clone())),
        ("keys", []) => XacroValue::list(pairs.iter().map(|(key, _)| key.clone()).collect()),
        ("values", []) => XacroValue::list(pairs.iter().map(|(_, value)| value.clone()).collect()),
        ("items", []) => {
            let items = pairs.iter().map(|(key, value)| XacroValue::tuple(vec![key.clone(), value.clone()]));
            XacroValue::list(items.collect::<EvalResult<_>>()?)
        }
        _ => not_done(format!("method `{name}` of a dictionary, or its arguments,"), "compute it otherwise"),
    }
}
