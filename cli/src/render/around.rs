//! What violated requirements consist of, around their first violations, for people.

use std::fmt::Write as _;

use hrdsl_runtime::{
    report::text,
    results::{FirstFailure, SubformulaReading, SubformulaValue, SubformulaValues, TestResult},
};

/// So many values of a part are shown, at most: those nearest to the violation.
const SHOWN: usize = 8;
/// Seconds: what is less before a violation is at it.
const SAME: f64 = 5e-10;

/// The values of the parts of each violated requirement, as far as they were asked for.
#[must_use]
pub fn around(tests: &[TestResult]) -> String {
    let mut out = String::new();
    for test in tests {
        for verdict in &test.judgement.verdicts {
            let Some(failure) = verdict.failure.as_ref().filter(|f| !f.around.is_empty()) else { continue };
            let (name, requirement) = (text::line(&test.name), text::line(&verdict.requirement));
            let _ = writeln!(out, "\n{name}: {requirement} around {}", text::moment(failure.time));
            failure.around.iter().for_each(|part| lines(part, failure, &mut out));
        }
    }
    out
}

fn lines(part: &SubformulaValues, failure: &FirstFailure, out: &mut String) {
    let _ = writeln!(out, "  {}", text::line(&part.text));
    if part.values.is_empty() {
        out.push_str("      –\n");
        return;
    }
    // What it is at the violation, and those around that.
    let at = part.values.iter().take_while(|value| value.time <= failure.time + SAME).count();
    let last = (at + SHOWN / 2).min(part.values.len()).max(SHOWN.min(part.values.len()));
    let first = last.saturating_sub(SHOWN);
    let told = |value: &SubformulaValue| {
        let time = format!("{:.3} s", value.time);
        if part.event { time } else { format!("{time}: {}", reading(&value.value, &part.unit)) }
    };
    let mut shown: Vec<String> = part.values.iter().skip(first).take(last - first).map(told).collect();
    if first > 0 {
        shown.insert(0, format!("{first} earlier"));
    }
    if last < part.values.len() {
        shown.push(format!("{} later", part.values.len() - last));
    }
    let _ = writeln!(out, "      {}", shown.join(" · "));
}

fn reading(value: &SubformulaReading, unit: &str) -> String {
    match value {
        SubformulaReading::Truth(truth) => truth.to_string(),
        SubformulaReading::Number(number) => {
            format!("{} {unit}", text::number(*number)).trim_end().to_owned()
        }
        SubformulaReading::Word(word) => text::line(word),
    }
}
