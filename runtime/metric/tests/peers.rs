//! Robustness as other tools compute it: rtamt, reelay and SENTIL, on formulas and signals that all understand alike.
//!
//! Python does the comparison (`peers.py`), with pinned versions that pip fetches once, into the target folder; where it cannot, the test says so and
//! compares nothing. `HRDSL_CASES=5000 cargo test --workspace --test peers -- --nocapture` compares more.

#![allow(clippy::disallowed_methods, reason = "the test runs Python on files that it writes")]

mod dice;

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use dice::Dice;
use hrdsl_ir::{Nanos, value::SECOND};
use hrdsl_metric::{FutureWindow, MetricFormula, PastWindow, Robustness, SignalPiece, robustness_over_time};
use serde_json::{Value, json};

const PINNED: [&str; 3] = ["rtamt==0.4.10", "reelay==25.0.0", "sentil==0.3.1"];

/// The folder that holds them, which is made once; or why there is none.
fn installed() -> Result<PathBuf, String> {
    let cache = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let place = cache.join("metric-peers");
    if place.exists() {
        return Ok(place);
    }
    let scratch = cache.join(format!("metric-peers-{}", std::process::id()));
    let mut command = Command::new("python3");
    command.args([
        "-m",
        "pip",
        "install",
        "--no-input",
        "--disable-pip-version-check",
        "--quiet",
        "--target",
    ]);
    command.arg(&scratch).args(PINNED).env("PIP_ROOT_USER_ACTION", "ignore").env("PIP_USER", "0");
    let output = command.output().map_err(|e| format!("{command:?} cannot be run: {e}"))?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    // Another run of the test may have been faster: then the folder is there.
    match fs::rename(&scratch, &place) {
        Ok(()) => Ok(place),
        Err(_) if place.exists() => Ok(place),
        Err(error) => Err(error.to_string()),
    }
}

/// A formula in our form, and in the words of the others; `None`: it does not have this.
#[derive(Clone)]
struct SharedFormula {
    formula: MetricFormula,
    rtamt: String,
    reelay: Option<String>,
    sentil: String,
    /// It has a `since`, or inside another operator an `until`, with a window that does not begin now: samples and signals that keep their values
    /// differ in it.
    is_apart: bool,
    /// It is such an `until`.
    is_late_until: bool,
}

impl SharedFormula {
    fn atom(index: usize) -> Self {
        let text = format!("({} < 1)", ["x", "y"][index]);
        let reelay = Some(format!("{{{} < 1}}", ["x", "y"][index]));
        Self {
            formula: MetricFormula::Atom(index),
            rtamt: text.clone(),
            reelay,
            sentil: text,
            is_apart: false,
            is_late_until: false,
        }
    }

    /// Words of the three, each with `A` for the operand, and `B` for the second.
    fn of(formula: MetricFormula, words: [&str; 3], a: &Self, b: Option<&Self>) -> Self {
        let fill = |word: &str, a: &str, b: Option<&str>| {
            let text = word.replace('A', &format!("({a})"));
            b.map_or(text.clone(), |b| text.replace('B', &format!("({b})")))
        };
        let reelay = match (words[1], &a.reelay, b.map(|b| &b.reelay)) {
            ("", ..) | (_, None, _) | (_, _, Some(None)) => None,
            (word, Some(a), b) => Some(fill(word, a, b.and_then(|b| b.as_deref()))),
        };
        Self {
            formula,
            rtamt: fill(words[0], &a.rtamt, b.map(|b| b.rtamt.as_str())),
            reelay,
            sentil: fill(words[2], &a.sentil, b.map(|b| b.sentil.as_str())),
            is_apart: [Some(a), b].into_iter().flatten().any(|of| of.is_apart || of.is_late_until),
            is_late_until: false,
        }
    }

    fn random(dice: &mut Dice, depth: usize) -> Self {
        if depth == 0 {
            return Self::atom(dice.below(2));
        }
        let a = Self::random(dice, depth - 1);
        let other = dice.below(depth);
        let b = Self::random(dice, other);
        let (from, to) = [(0, 2), (0, 5), (1, 3), (2, 2), (3, 7), (0, 0)][dice.below(6)];
        let past = PastWindow::new(from * SECOND, Some(to * SECOND)).unwrap();
        let future = FutureWindow::new(from * SECOND, to * SECOND).unwrap();
        let boxed = |f: &Self| Box::new(f.formula.clone());
        // A window of the present moment alone is something else to reelay.
        let unary = |make: MetricFormula, colon: &str, letter: &str| {
            let reelay = if to > 0 && (colon == "once" || colon == "historically") {
                format!("{colon}[{from}:{to}] A")
            } else {
                String::new()
            };
            let (rtamt, sentil) = (format!("{colon}[{from}:{to}] A"), format!("{letter}[{from},{to}] A"));
            Self::of(make, [&rtamt, &reelay, &sentil], &a, None)
        };
        match dice.below(9) {
            0 => Self::of(MetricFormula::Not(boxed(&a)), ["not A", "not A", "!A"], &a, None),
            1 => {
                let make = MetricFormula::And(boxed(&a), boxed(&b));
                Self::of(make, ["A and B", "A and B", "A && B"], &a, Some(&b))
            }
            2 => {
                let make = MetricFormula::Or(boxed(&a), boxed(&b));
                Self::of(make, ["A or B", "A or B", "A || B"], &a, Some(&b))
            }
            3 => unary(MetricFormula::Once(past, boxed(&a)), "once", "O"),
            4 => unary(MetricFormula::Historically(past, boxed(&a)), "historically", "H"),
            5 => unary(MetricFormula::Eventually(future, boxed(&a)), "eventually", "F"),
            6 => unary(MetricFormula::Always(future, boxed(&a)), "always", "G"),
            7 => {
                let make = MetricFormula::Until(future, boxed(&a), boxed(&b));
                let (rtamt, sentil) = (format!("A until[{from}:{to}] B"), format!("A U[{from},{to}] B"));
                Self { is_late_until: from > 0, ..Self::of(make, [&rtamt, "", &sentil], &a, Some(&b)) }
            }
            _ => {
                let make = MetricFormula::Since(past, boxed(&a), boxed(&b));
                let (rtamt, sentil) = (format!("A since[{from}:{to}] B"), format!("A S[{from},{to}] B"));
                // With a window that begins later, reelay does not ask the first of the moments in between.
                let reelay = if from == 0 && to > 0 { rtamt.clone() } else { String::new() };
                let made = Self::of(make, [&rtamt, &reelay, &sentil], &a, Some(&b));
                Self { is_apart: made.is_apart || from > 0, ..made }
            }
        }
    }
}

fn held(pieces: &[SignalPiece], time: Nanos) -> f64 {
    pieces.iter().rev().find(|p| p.start <= time).unwrap().value.number()
}

/// A case for the others: samples each second, or at multiples of a quarter of a second.
fn case(dice: &mut Dice, is_regular: bool) -> Value {
    let depth = 1 + dice.below(3);
    let shared = loop {
        let shared = SharedFormula::random(dice, depth);
        if !(is_regular && shared.is_apart) {
            break shared;
        }
    };
    let (mut times, mut x, mut y) = (Vec::new(), Vec::new(), Vec::new());
    let mut quarters = 0;
    for _ in 0..24 {
        times.push(quarters as Nanos * SECOND / 4);
        quarters += if is_regular { 4 } else { 1 + dice.below(8) };
        x.push(dice.below(24) as f64 / 4.0 - 2.0);
        y.push(dice.below(24) as f64 / 4.0 - 2.0);
    }
    let end = times[times.len() - 1];
    let signal = |values: &[f64]| -> Vec<SignalPiece> {
        let pieces = times.iter().zip(values);
        pieces
            .map(|(t, v)| SignalPiece { start: *t, value: Robustness::of(1.0 - v, true).unwrap() })
            .collect()
    };
    let found = robustness_over_time(&shared.formula, &[signal(&x), signal(&y)], (0, end));
    let step = if is_regular { SECOND } else { SECOND / 8 };
    let mut expected = Vec::new();
    // A last sample lasts no time in dense time.
    let known = end - shared.formula.horizon() + Nanos::from(is_regular);
    for time in (0..known).step_by(step as usize) {
        let (lower, upper) = (held(&found.lower, time), held(&found.upper, time));
        if lower == upper {
            let number = if lower.is_finite() { json!(lower) } else { json!(lower.to_string()) };
            expected.push(json!([time as f64 / SECOND as f64, number]));
        }
    }
    let seconds: Vec<f64> = times.iter().map(|t| *t as f64 / SECOND as f64).collect();
    // In dense time rtamt asks the first of `since` and `until` at the moment of the second, too.
    let reaches = shared.rtamt.contains("since") || shared.rtamt.contains("until");
    let rtamt = (is_regular || !reaches).then_some(shared.rtamt);
    json!({
        "regular": is_regular, "times": seconds, "x": x, "y": y, "expected": expected,
        "formulas": {"rtamt": rtamt, "reelay": shared.reelay, "sentil": shared.sentil},
    })
}

#[test]
fn robustness_is_that_of_rtamt_reelay_and_sentil() {
    let packages = match installed() {
        Ok(packages) => packages,
        Err(why) => {
            println!("skipped: {PINNED:?} cannot be installed: {why}");
            return;
        }
    };
    let count = std::env::var("HRDSL_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(300);
    let mut dice = Dice(4);
    let cases: Vec<Value> = (0..count).map(|n| case(&mut dice, n % 2 == 0)).collect();
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("peers-{}.json", std::process::id()));
    fs::write(&file, serde_json::to_string(&cases).unwrap()).unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/peers.py");
    let output = Command::new("python3").arg(&script).arg(&packages).arg(&file).output().unwrap();
    fs::remove_file(&file).unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    println!("{said}");
    assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stderr));
}
