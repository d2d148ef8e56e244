//! Messages that programs make: what stands at a place of one.

use hrdsl_ir::{
    Symbol, Type, Value,
    binding::{MessageRead, MessageStep, TextOperand, place_text},
};
use serde_json::Value as Json;

/// # Errors
/// That it is no JSON.
pub(super) fn parse(text: &str) -> Result<Json, String> {
    serde_json::from_str(text).map_err(|e| format!("the message is no JSON: {e}"))
}

/// What lies at a place.
pub(super) fn at<'m>(message: &'m Json, path: &[MessageStep]) -> Result<&'m Json, String> {
    let mut here = message;
    for (done, step) in path.iter().enumerate() {
        let next = match step {
            MessageStep::Field(name) => here.get(name),
            MessageStep::Element(at) => here.get(usize::try_from(*at).unwrap_or(usize::MAX)),
        };
        if let (None, MessageStep::Element(_), Json::Array(all), Some((_, whole))) =
            (next, step, here, path.get(..=done).and_then(<[MessageStep]>::split_last))
        {
            let (element, whole) = (place_text(path), place_text(whole));
            return Err(match all.len() {
                1 => format!("there is no `{element}`: `{whole}` has 1 element"),
                n => format!("there is no `{element}`: `{whole}` has {n} elements"),
            });
        }
        here = next.ok_or_else(|| format!("the message has no `{}`", place_text(path)))?;
    }
    Ok(here)
}

/// The value that a rule reads.
pub(super) fn value(message: &Json, read: &MessageRead) -> Result<Value, String> {
    if let Some(other) = &read.same_as {
        return same_text(message, &read.path, other).map(Value::Bool);
    }
    let json = at(message, &read.path)?;
    if read.length {
        let length = json.as_array().and_then(|all| i64::try_from(all.len()).ok());
        return length.map(Value::Int).ok_or_else(|| format!("`{}` is no sequence", place_text(&read.path)));
    }
    let found = match read.ty {
        Type::Bool => match json {
            Json::Bool(b) => Some(Value::Bool(*b)),
            // Python's clients write both.
            Json::Number(n) => n.as_i64().filter(|n| (0..=1).contains(n)).map(|n| Value::Bool(n == 1)),
            Json::Null | Json::String(_) | Json::Array(_) | Json::Object(_) => None,
        },
        Type::Int { .. } => match json {
            Json::Bool(b) => Some(Value::Int(i64::from(*b))),
            Json::Number(n) => n.as_i64().map(Value::Int),
            Json::Null | Json::String(_) | Json::Array(_) | Json::Object(_) => None,
        },
        Type::Float(_) => number(json).map(Value::Float),
        Type::Enum(of) => match json.as_str() {
            Some(name) => {
                let known: Option<Symbol> = of.symbol(name);
                let none = || format!("`{}` is {name:?}, which `{of}` does not have", place_text(&read.path));
                return known.map(Value::Symbol).ok_or_else(none);
            }
            None => None,
        },
        // INVARIANT: text is compared, and rules do not read lists.
        Type::Text | Type::List(_) => None,
    };
    found.filter(|v| read.ty.admits(*v)).ok_or_else(|| of_other_type(&read.path, json))
}

fn same_text(message: &Json, path: &[MessageStep], other: &TextOperand) -> Result<bool, String> {
    Ok(text_at(message, path)? == text(message, other)?)
}

/// A text, which stands in the message or in the scenario.
pub(super) fn text<'m>(message: &'m Json, of: &'m TextOperand) -> Result<&'m str, String> {
    match of {
        TextOperand::Literal(literal) => Ok(literal),
        TextOperand::Place(place) => text_at(message, place),
    }
}

fn text_at<'m>(message: &'m Json, path: &[MessageStep]) -> Result<&'m str, String> {
    let json = at(message, path)?;
    json.as_str().ok_or_else(|| of_other_type(path, json))
}

fn of_other_type(path: &[MessageStep], json: &Json) -> String {
    format!("`{}` is {json}, which is of another type than the interface says", place_text(path))
}

/// A number, or one of those that JSON does not have.
pub(super) fn number(json: &Json) -> Option<f64> {
    match json {
        Json::Number(n) => n.as_f64(),
        Json::Bool(b) => Some(f64::from(u8::from(*b))),
        Json::String(s) => match s.as_str() {
            "nan" => Some(f64::NAN),
            "inf" => Some(f64::INFINITY),
            "-inf" => Some(f64::NEG_INFINITY),
            _ => None,
        },
        Json::Null | Json::Array(_) | Json::Object(_) => None,
    }
}

/// All numbers of a sequence, or the one that stands there.
pub(super) fn numbers(message: &Json, path: &[MessageStep]) -> Result<Vec<f64>, String> {
    let json = at(message, path)?;
    let all = match json {
        Json::Array(items) => items.iter().map(number).collect(),
        Json::Null | Json::Bool(_) | Json::Number(_) | Json::String(_) | Json::Object(_) => {
            number(json).map(|n| vec![n])
        }
    };
    all.ok_or_else(|| format!("`{}` holds something else than numbers", place_text(path)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(name: &str) -> Vec<MessageStep> {
        vec![MessageStep::Field(name.to_owned())]
    }

    fn compared(message: &str, other: TextOperand) -> Result<Value, String> {
        let read = MessageRead { path: path("key"), length: false, ty: Type::Text, same_as: Some(other) };
        value(&parse(message).unwrap(), &read)
    }

    #[test]
    fn texts_are_compared_and_not_kept() {
        let literal = |text: &str| TextOperand::Literal(text.to_owned());
        let (go, same) = (r#"{"key":"go","value":"stop"}"#, r#"{"key":"é","value":"\u00e9"}"#);
        assert_eq!(compared(go, literal("go")), Ok(Value::Bool(true)));
        assert_eq!(compared(go, literal("g")), Ok(Value::Bool(false)));
        assert_eq!(compared(go, TextOperand::Place(path("value"))), Ok(Value::Bool(false)));
        assert_eq!(compared(same, TextOperand::Place(path("value"))), Ok(Value::Bool(true)));
        let wrong = "`key` is 1, which is of another type than the interface says";
        assert_eq!(compared(r#"{"key":1}"#, literal("go")), Err(wrong.to_owned()));
        let absent = "the message has no `other`".to_owned();
        assert_eq!(compared(go, TextOperand::Place(path("other"))), Err(absent));
    }
}
