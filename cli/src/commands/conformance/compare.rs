//! What a driver said beside what it should have said.

use serde_json::Value;

use super::case::{CaseProgram, ConformanceCase};

/// Members whose text a library may say in more words.
const IN_MORE_WORDS: [&str; 2] = ["error", "refused"];

/// How far numbers with a fraction may be apart.
const TOLERANCE: f64 = 1e-5;

/// The first difference.
#[derive(Debug, PartialEq)]
pub struct CaseDifference {
    /// What was looked at: a step, an event.
    pub at: String,
    pub expected: String,
    pub got: String,
    /// In the case's file.
    pub place: String,
}

/// Why a driver has left a case out, if its output says so.
pub fn skipped(output: &str) -> Option<String> {
    let first: Value = serde_json::from_str(output.lines().next()?).ok()?;
    first.get("skip")?.as_str().map(str::to_owned)
}

/// The first line of a program's output that is not what it should be.
pub fn of_output(case: &ConformanceCase, program: &CaseProgram, output: &str) -> Option<CaseDifference> {
    let of = if case.programs.len() > 1 { format!("program {}, ", program.name) } else { String::new() };
    let mut lines = output.lines();
    for (number, step) in (1..).zip(&program.steps) {
        let line = lines.next();
        let said = line.map(serde_json::from_str::<Value>);
        if !matches!(&said, Some(Ok(said)) if fits(&step.expected, said)) {
            return Some(CaseDifference {
                at: format!("{of}line {number} of the output, for the step {}", step.told),
                expected: step.expected.to_string(),
                got: line.map_or("nothing: the output ends there".to_owned(), str::to_owned),
                place: case.place(step.line),
            });
        }
    }
    lines.next().map(|line| CaseDifference {
        at: format!("{of}line {} of the output, for which there is no step", program.steps.len() + 1),
        expected: "nothing".to_owned(),
        got: line.to_owned(),
        place: case.place(program.steps.last().map_or(1, |step| step.line)),
    })
}

/// What the results say of the log, if it is not what it should be.
pub fn of_log(case: &ConformanceCase, made: &Value) -> Option<CaseDifference> {
    let expected = case.log.as_ref().filter(|expected| !fits(expected, made))?;
    Some(CaseDifference {
        at: "the log in the results".to_owned(),
        expected: expected.to_string(),
        got: made.to_string(),
        place: case.place(1),
    })
}

/// The first event that the system has made otherwise; `made` are lines of the recording.
pub fn of_events(case: &ConformanceCase, made: &[Value]) -> Option<CaseDifference> {
    let count = case.events.len().max(made.len());
    (0..count).find_map(|at| {
        let (expected, got) = (case.events.get(at), made.get(at));
        let same = expected.zip(got).is_some_and(|(expected, got)| fits(expected, got));
        let shown = |event: Option<&Value>| event.map_or("no further event".to_owned(), Value::to_string);
        (!same).then(|| CaseDifference {
            at: format!("event {} of the recording", at + 1),
            expected: shown(expected),
            got: shown(got),
            place: case.place(1),
        })
    })
}

/// Whether a line says what it should.
fn fits(expected: &Value, got: &Value) -> bool {
    match (expected, got) {
        (Value::Object(expected), Value::Object(got)) => {
            expected.len() == got.len()
                && expected.iter().all(|(key, value)| {
                    got.get(key).is_some_and(|other| {
                        if IN_MORE_WORDS.contains(&key.as_str()) {
                            contains(value, other)
                        } else {
                            fits(value, other)
                        }
                    })
                })
        }
        (Value::Array(expected), Value::Array(got)) => {
            expected.len() == got.len() && expected.iter().zip(got).all(|(e, g)| fits(e, g))
        }
        (Value::Number(a), Value::Number(b)) => {
            if a.is_f64() || b.is_f64() {
                a.as_f64().zip(b.as_f64()).is_some_and(|(a, b)| (a - b).abs() <= TOLERANCE)
            } else {
                a == b
            }
        }
        (expected, got) => expected == got,
    }
}

/// Whether a text is part of another, or each of several of the one at its place.
fn contains(expected: &Value, got: &Value) -> bool {
    match (expected, got) {
        (Value::String(expected), Value::String(got)) => got.contains(expected.as_str()),
        (Value::Array(expected), Value::Array(got)) => {
            expected.len() == got.len() && expected.iter().zip(got).all(|(e, g)| contains(e, g))
        }
        (expected, got) => expected == got,
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn numbers_may_be_written_otherwise_and_errors_said_in_more_words() {
        for (expected, got, same) in [
            (json!({"t": 1, "x": 0.5}), json!({"x": 0.500_000_1, "t": 1}), true),
            (json!({"t": 1_000_000_000}), json!({"t": 1_000_000_001}), false),
            (json!({"t": 1}), json!({"t": 1, "more": 2}), false),
            (json!({"error": "no port"}), json!({"error": "publisher: no port 9 is open"}), true),
            (json!({"error": "no port"}), json!({"error": "no door"}), false),
            (json!({"text": "a"}), json!({"text": "ab"}), false),
            (json!({"refused": ["a", "b"]}), json!({"refused": ["a!", "b!"]}), true),
            (json!({"refused": ["a", "b"]}), json!({"refused": ["a!"]}), false),
            (json!([1, [2]]), json!([1, [3]]), false),
            (json!(null), json!(false), false),
        ] {
            assert_eq!(fits(&expected, &got), same, "{expected} {got}");
        }
    }

    #[test]
    fn a_driver_that_cannot_do_something_says_so() {
        assert_eq!(skipped("{\"skip\": \"no actions\"}\n"), Some("no actions".to_owned()));
        assert_eq!((skipped("{}\n"), skipped(""), skipped("skip")), (None, None, None));
    }
}
