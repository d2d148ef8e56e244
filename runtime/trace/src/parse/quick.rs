//! Steps in the very form in which recordings are written, read without a parser of JSON, which takes several times as long. Whatever is not
//! in this form, and whatever is wrong, is left to that parser.

use hrdsl_ir::{Type, Value};

/// What is left of a line.
#[derive(Clone, Copy)]
pub(super) struct QuickLine<'a> {
    rest: &'a str,
}

/// A value of a step, or of an argument.
#[derive(Clone, Copy)]
pub(super) enum QuickValue<'a> {
    Truth(bool),
    Number(&'a str),
    Name(&'a str),
}

impl<'a> QuickLine<'a> {
    pub fn new(line: &'a str) -> Self {
        Self { rest: line }
    }

    /// Goes over this text, if it stands here.
    pub fn over(&mut self, text: &str) -> Option<()> {
        self.rest = self.rest.strip_prefix(text)?;
        Some(())
    }

    pub fn is_over(self) -> bool {
        self.rest.is_empty()
    }

    fn take(&mut self, length: usize) -> Option<&'a str> {
        let (taken, rest) = self.rest.split_at_checked(length)?;
        self.rest = rest;
        Some(taken)
    }

    /// A string without anything that has to be escaped, and the quotation mark behind it; that before it is gone.
    pub fn name(&mut self) -> Option<&'a str> {
        let special = |b: &u8| *b == b'"' || *b == b'\\' || *b < b' ';
        let end = self.rest.as_bytes().iter().position(special)?;
        let name = self.take(end)?;
        self.over("\"")?;
        Some(name)
    }

    /// A number, as JSON writes numbers, without an exponent.
    pub fn number(&mut self) -> Option<&'a str> {
        let bytes = self.rest.as_bytes();
        let digits = |from: usize| {
            let rest = bytes.get(from..).unwrap_or_default();
            rest.iter().position(|b| !b.is_ascii_digit()).unwrap_or(rest.len())
        };
        let whole = usize::from(bytes.first() == Some(&b'-'));
        let count = digits(whole);
        if count == 0 || (count > 1 && bytes.get(whole) == Some(&b'0')) {
            return None;
        }
        let mut end = whole + count;
        if bytes.get(end) == Some(&b'.') {
            let fraction = digits(end + 1);
            if fraction == 0 {
                return None;
            }
            end += 1 + fraction;
        }
        if matches!(bytes.get(end), Some(b'e' | b'E')) {
            return None;
        }
        self.take(end)
    }

    pub fn value(&mut self) -> Option<QuickValue<'a>> {
        match self.rest.as_bytes().first()? {
            b't' => self.over("true").map(|()| QuickValue::Truth(true)),
            b'f' => self.over("false").map(|()| QuickValue::Truth(false)),
            b'"' => {
                self.over("\"")?;
                self.name().map(QuickValue::Name)
            }
            _ => self.number().map(QuickValue::Number),
        }
    }
}

/// The value of this type. `None`: it is none, or one that wants a closer look.
pub(super) fn quick_value(ty: Type, value: QuickValue<'_>) -> Option<Value> {
    let value = match (ty, value) {
        (Type::Bool, QuickValue::Truth(truth)) => Value::Bool(truth),
        (Type::Int { .. }, QuickValue::Number(digits)) => {
            if digits.contains('.') || digits.starts_with("-0") {
                return None;
            }
            Value::Int(digits.parse().ok()?)
        }
        (Type::Float(_), QuickValue::Number(digits)) => {
            Value::Float(digits.parse().ok().filter(|x: &f64| x.is_finite())?)
        }
        (Type::Enum(of), QuickValue::Name(name)) => Value::Symbol(of.symbol(name)?),
        (
            Type::Bool | Type::Int { .. } | Type::Float(_) | Type::Enum(_) | Type::Text | Type::List(_),
            QuickValue::Truth(_) | QuickValue::Number(_) | QuickValue::Name(_),
        ) => return None,
    };
    ty.admits(value).then_some(value)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::StepReader;
    use crate::{TraceStep, record::RecordingHeader, tests::program};

    /// What both ways make of a line, each from the same moment on.
    fn both(line: &str) -> (Option<TraceStep>, Option<TraceStep>) {
        let program = program();
        let reader = || {
            let mut reader = StepReader::new(&program, RecordingHeader::default());
            reader.now = 1_500_000_000;
            reader
        };
        (reader().quick(line), reader().any_line(line).ok().flatten())
    }

    const LINES: [&str; 9] = [
        r#"{"t":2,"event":"leg_request"}"#,
        r#"{"t":1.5,"event":"decided","args":{"ready":true}}"#,
        r#"{"t":33.000000001,"event":"sensed","args":{"gaze":true,"legs":2,"far":0.25}}"#,
        r#"{"t":33.000000001,"event":"sensed","args":{"gaze":false,"legs":0,"far":-12.5}}"#,
        r#"{"t":2,"event":"sensed","args":{"gaze":false,"legs":0,"far":7}}"#,
        r#"{"t":2,"signal":"gaze","value":false}"#,
        r#"{"t":2,"signal":"gaze","value":true}"#,
        r#"{"t":2,"signal":"far","value":0.1}"#,
        r#"{"t":2,"signal":"far","value":-0}"#,
    ];

    #[test]
    fn what_is_written_is_read_at_once() {
        let mut known = 0;
        for line in LINES {
            let (quick, other) = both(line);
            if other.is_some() {
                known += 1;
                assert_eq!(format!("{quick:?}"), format!("{other:?}"), "{line}");
            }
        }
        assert!(known >= 5, "{known}");
    }

    #[test]
    fn what_looks_alike_is_left_to_the_parser() {
        for line in [
            r#"{"t":1.4,"event":"leg_request"}"#,
            r#"{"t":02,"event":"leg_request"}"#,
            r#"{"t":2.,"event":"leg_request"}"#,
            r#"{"t":2e1,"event":"leg_request"}"#,
            r#"{"t": 2,"event":"leg_request"}"#,
            r#"{"t":2,"event":"leg\u005frequest"}"#,
            r#"{"t":2,"event":"nothing"}"#,
            r#"{"t":2,"event":"leg_request","args":{}}"#,
            r#"{"t":2,"event":"leg_request"} "#,
            r#"{"t":2,"event":"leg_request"}}"#,
        ] {
            assert_eq!(both(line).0, None, "{line}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, cases: 4_000, ..ProptestConfig::default() })]

        /// Lines with a few characters changed: the quick way says nothing, or what the parser says.
        #[test]
        fn it_never_says_anything_else(
            line in prop::sample::select(&LINES[..]),
            changes in prop::collection::vec((any::<prop::sample::Index>(), "[-0-9.eE\"\\\\{}:, a-z]?"), 0..3),
        ) {
            let mut line = line.to_owned();
            for (at, with) in changes {
                let at = at.index(line.len());
                line.replace_range(at..=at, &with);
            }
            let (quick, other) = both(&line);
            if quick.is_some() {
                prop_assert_eq!(format!("{quick:?}"), format!("{other:?}"), "{}", line);
            }
        }
    }
}
