//! Values of constants and defaults: reading them, and writing them so that they read as the same.

use std::fmt::Write as _;

use serde::{Serialize, Serializer, ser::SerializeSeq};

use crate::{name::RosVersion, primitive::PrimitiveType};

/// A value that a definition gives. Whole numbers of every type fit.
#[derive(Clone, Debug, PartialEq)]
pub enum MessageValue {
    Bool(bool),
    Integer(i128),
    Float(f64),
    Text(String),
    List(Vec<MessageValue>),
}

/// Why a text is no value, as far as it matters for the help.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum ValueProblem {
    /// What would be one.
    NotOne(&'static str),
    /// The least and the greatest.
    OutOfRange(String, String),
}

/// JSON has no number for these, so that they are texts: `"nan"`, `"inf"`, `"-inf"`.
impl Serialize for MessageValue {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Bool(value) => serializer.serialize_bool(*value),
            // All lie within the one or the other: the types have at most 64 bits.
            Self::Integer(value) => match (i64::try_from(*value), u64::try_from(*value)) {
                (Ok(value), _) => serializer.serialize_i64(value),
                (_, Ok(value)) => serializer.serialize_u64(value),
                (Err(_), Err(_)) => serializer.serialize_i128(*value),
            },
            Self::Float(value) if value.is_finite() => serializer.serialize_f64(*value),
            Self::Float(value) => serializer.serialize_str(&float_text(*value)),
            Self::Text(text) => serializer.serialize_str(text),
            Self::List(values) => {
                let mut list = serializer.serialize_seq(Some(values.len()))?;
                for value in values {
                    list.serialize_element(value)?;
                }
                list.end()
            }
        }
    }
}

/// Reads one value; the text has no blanks around it.
pub(crate) fn read_value(
    of: PrimitiveType,
    text: &str,
    version: RosVersion,
) -> Result<MessageValue, ValueProblem> {
    if of.is_text() {
        return match version {
            RosVersion::Ros1 => Ok(MessageValue::Text(text.to_owned())),
            RosVersion::Ros2 => read_text(text).map(MessageValue::Text),
        };
    }
    if let Some((least, greatest)) = of.range(version) {
        let value =
            read_integer(text).ok_or(ValueProblem::NotOne("a whole number, such as `5` or `0x1f`"))?;
        let fits = (least..=greatest).contains(&value);
        return if fits { Ok(MessageValue::Integer(value)) } else { Err(out_of_range(least, greatest)) };
    }
    if of == PrimitiveType::Bool {
        let is = |words: [&str; 2]| words.iter().any(|w| text.eq_ignore_ascii_case(w));
        return match (is(["true", "1"]), is(["false", "0"])) {
            (true, _) => Ok(MessageValue::Bool(true)),
            (_, true) => Ok(MessageValue::Bool(false)),
            (false, false) => Err(ValueProblem::NotOne("`true` or `false`")),
        };
    }
    let value = read_float(text).ok_or(ValueProblem::NotOne("a number, such as `0.5`"))?;
    let greatest = if of == PrimitiveType::Float32 { f64::from(f32::MAX) } else { f64::MAX };
    if value.is_finite() && value.abs() > greatest || value.is_infinite() && !text.contains(['i', 'I']) {
        return Err(out_of_range(float_text(-greatest), float_text(greatest)));
    }
    Ok(MessageValue::Float(value))
}

fn out_of_range(least: impl ToString, greatest: impl ToString) -> ValueProblem {
    ValueProblem::OutOfRange(least.to_string(), greatest.to_string())
}

/// A whole number, in the bases that Python reads. What begins with `0` and goes on is octal to some tools and decimal to
/// others, so that it is none.
fn read_integer(text: &str) -> Option<i128> {
    let (is_negative, digits) = match text.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, text.strip_prefix('+').unwrap_or(text)),
    };
    let lower = digits.to_ascii_lowercase();
    let (digits, radix) = [("0x", 16), ("0o", 8), ("0b", 2)]
        .into_iter()
        .find_map(|(prefix, radix)| Some((lower.strip_prefix(prefix)?, radix)))
        .unwrap_or((&lower, 10));
    let is_ambiguous = radix == 10 && digits.len() > 1 && digits.starts_with('0');
    // A second sign would be read as well.
    if is_ambiguous || !digits.starts_with(|c: char| c.is_ascii_hexdigit()) {
        return None;
    }
    // What is longer lies outside every type.
    let value = match i128::from_str_radix(digits, radix) {
        Ok(value) => value,
        Err(error) if *error.kind() == std::num::IntErrorKind::PosOverflow => i128::MAX,
        Err(_) => return None,
    };
    Some(if is_negative { -value } else { value })
}

fn read_float(text: &str) -> Option<f64> {
    let unsigned = text.strip_prefix(['-', '+']).unwrap_or(text);
    if unsigned.starts_with(['-', '+']) {
        return None;
    }
    text.parse().ok()
}

/// A text of ROS 2: in quotes, or bare.
fn read_text(text: &str) -> Result<String, ValueProblem> {
    const HELP: &str = "a text in quotes, such as `\"left\"`";
    let Some(quote) = text.chars().next().filter(|c| matches!(c, '"' | '\'')) else {
        return if text.is_empty() { Err(ValueProblem::NotOne(HELP)) } else { Ok(text.to_owned()) };
    };
    let mut inner = String::new();
    let mut rest = text.chars().skip(1);
    while let Some(c) = rest.next() {
        match c {
            _ if c == quote => {
                return if rest.next().is_none() { Ok(inner) } else { Err(ValueProblem::NotOne(HELP)) };
            }
            '\\' => match rest.next() {
                Some(escaped) if escaped == quote || escaped == '\\' => inner.push(escaped),
                Some(other) => inner.extend(['\\', other]),
                None => break,
            },
            _ => inner.push(c),
        }
    }
    Err(ValueProblem::NotOne(HELP))
}

/// The pieces of `[a, b]`, each with where it begins; `None` if it is no such list. Commas in quotes divide nothing.
pub(crate) fn list_pieces(text: &str) -> Option<Vec<(usize, &str)>> {
    let inner = text.strip_prefix('[')?.strip_suffix(']')?;
    let mut pieces = Vec::new();
    let mut start = 0;
    let mut quotes = QuoteScan::default();
    for (at, c) in inner.char_indices() {
        if !quotes.is_inside_after(c) && c == ',' {
            pieces.push((start + 1, inner.get(start..at)?));
            start = at + 1;
        }
    }
    let last = inner.get(start..)?;
    if !(pieces.is_empty() && last.trim().is_empty()) {
        pieces.push((start + 1, last));
    }
    Some(pieces)
}

/// Which characters of a line of ROS 2 stand in quotes. A quote opens only where a value may begin, so that `it's` is a word.
#[derive(Default)]
pub(crate) struct QuoteScan {
    quote: Option<char>,
    is_escaped: bool,
    /// A value has begun, bare.
    is_bare: bool,
}

impl QuoteScan {
    /// Goes on by a character, and says whether it belongs to a quoted text, its quotes included.
    pub(crate) fn is_inside_after(&mut self, c: char) -> bool {
        if let Some(quote) = self.quote {
            match c {
                _ if self.is_escaped => self.is_escaped = false,
                '\\' => self.is_escaped = true,
                _ if c == quote => self.quote = None,
                _ => {}
            }
            return true;
        }
        if matches!(c, '"' | '\'') && !self.is_bare {
            self.quote = Some(c);
            return true;
        }
        self.is_bare = !(c.is_whitespace() || matches!(c, '=' | '[' | ','));
        false
    }
}

impl MessageValue {
    /// As it is written in a definition.
    #[must_use]
    pub fn written(&self, version: RosVersion) -> String {
        match self {
            Self::Bool(value) => match version {
                RosVersion::Ros1 => if *value { "True" } else { "False" }.to_owned(),
                RosVersion::Ros2 => value.to_string(),
            },
            Self::Integer(value) => value.to_string(),
            Self::Float(value) => float_text(*value),
            Self::Text(text) => match version {
                RosVersion::Ros1 => text.clone(),
                RosVersion::Ros2 => quoted(text),
            },
            Self::List(values) => {
                let values: Vec<String> = values.iter().map(|v| v.written(version)).collect();
                format!("[{}]", values.join(", "))
            }
        }
    }
}

fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        if matches!(c, '"' | '\\') {
            quoted.push('\\');
        }
        quoted.push(c);
    }
    quoted + "\""
}

/// As Rust and Python read it back.
fn float_text(value: f64) -> String {
    let mut text = String::new();
    // Writing into a text never fails.
    let _ = if value.is_nan() { write!(text, "nan") } else { write!(text, "{value:?}") };
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use MessageValue::{Bool, Float, Integer, Text};

    fn read(of: PrimitiveType, text: &str) -> Result<MessageValue, ValueProblem> {
        read_value(of, text, RosVersion::Ros2)
    }

    #[test]
    fn numbers_are_read_in_the_bases_of_python() {
        for (text, value) in
            [("5", 5), ("-5", -5), ("+5", 5), ("0x1F", 31), ("-0b11", -3), ("0o17", 15), ("0", 0)]
        {
            assert_eq!(read(PrimitiveType::Int32, text), Ok(Integer(value)), "{text}");
        }
        for text in ["", "-", "+-5", "0x", "0x-1", "05", "1.0", "five", "1_000", "٣"] {
            assert!(matches!(read(PrimitiveType::Int32, text), Err(ValueProblem::NotOne(_))), "{text}");
        }
        assert_eq!(read(PrimitiveType::Uint64, "18446744073709551615"), Ok(Integer(u64::MAX.into())));
        let long = "9".repeat(300);
        for (of, text) in
            [(PrimitiveType::Uint8, "256"), (PrimitiveType::Uint64, &*long), (PrimitiveType::Char, "-1")]
        {
            assert!(matches!(read(of, text), Err(ValueProblem::OutOfRange(..))), "{text}");
        }
    }

    #[test]
    fn a_byte_has_a_sign_in_ros_1_alone() {
        assert_eq!(read_value(PrimitiveType::Byte, "-1", RosVersion::Ros1), Ok(Integer(-1)));
        assert!(read_value(PrimitiveType::Byte, "255", RosVersion::Ros1).is_err());
        assert_eq!(read(PrimitiveType::Byte, "255"), Ok(Integer(255)));
    }

    #[test]
    fn other_values_are_read() {
        assert_eq!(read(PrimitiveType::Bool, "True"), Ok(Bool(true)));
        assert_eq!(read(PrimitiveType::Bool, "0"), Ok(Bool(false)));
        assert!(read(PrimitiveType::Bool, "yes").is_err());
        assert_eq!(read(PrimitiveType::Float64, "-1.5e3"), Ok(Float(-1500.0)));
        assert_eq!(read(PrimitiveType::Float64, "inf"), Ok(Float(f64::INFINITY)));
        assert!(matches!(read(PrimitiveType::Float32, "1e39"), Err(ValueProblem::OutOfRange(..))));
        assert!(matches!(read(PrimitiveType::Float64, "1e999"), Err(ValueProblem::OutOfRange(..))));
        assert_eq!(read(PrimitiveType::String, r#""a \"b\" \\ \n""#), Ok(Text(r#"a "b" \ \n"#.to_owned())));
        assert_eq!(read(PrimitiveType::String, "it's"), Ok(Text("it's".to_owned())));
        for text in ["", "\"", "\"a", "\"a\" b", "'a\\'"] {
            assert!(read(PrimitiveType::String, text).is_err(), "{text}");
        }
    }

    #[test]
    fn lists_are_divided_outside_of_quotes() {
        assert_eq!(list_pieces("[]"), Some(vec![]));
        assert_eq!(list_pieces("[1, 2]"), Some(vec![(1, "1"), (3, " 2")]));
        assert_eq!(list_pieces(r#"["a,b", it's]"#), Some(vec![(1, r#""a,b""#), (7, " it's")]));
        assert_eq!(list_pieces("[1"), None);
    }

    #[test]
    fn json_holds_every_value() {
        let values = MessageValue::List(vec![
            Integer(u64::MAX.into()),
            Integer(i64::MIN.into()),
            Float(0.5),
            Float(f64::NAN),
            Float(f64::NEG_INFINITY),
            Text("a".to_owned()),
            Bool(true),
        ]);
        let json = serde_json::to_string(&values).unwrap();
        assert_eq!(json, r#"[18446744073709551615,-9223372036854775808,0.5,"nan","-inf","a",true]"#);
    }
}
