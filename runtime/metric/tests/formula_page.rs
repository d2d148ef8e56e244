//! The runs of `spec/metric.md`, with the verdicts and margins that stand beside them; and what is wrong with texts that are no formulas.

#![allow(clippy::disallowed_methods, reason = "the test reads the page")]

mod watched;

use std::{fs, path::Path};

use hrdsl_metric::{MetricRunner, read_formula};
use watched::{program, run};

/// Formula, run, verdict and margin. A formula that is left out is that of the row before.
fn rows(page: &str) -> Vec<[String; 4]> {
    let (mut rows, mut inside, mut last) = (Vec::new(), false, String::new());
    for line in page.lines() {
        let cells: Vec<&str> =
            line.trim().trim_matches('|').split('|').map(|cell| cell.trim().trim_matches('`')).collect();
        match cells.as_slice() {
            ["formula", "run", "verdict", "margin"] => inside = true,
            ["---", ..] => {}
            [formula, run, verdict, margin] if inside => {
                if !formula.is_empty() {
                    last = (*formula).to_owned();
                }
                rows.push([&last, *run, *verdict, *margin].map(str::to_owned));
            }
            _ => inside = false,
        }
    }
    rows
}

#[test]
fn the_runs_on_the_page_have_their_verdicts() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../spec/metric.md");
    let rows = rows(&fs::read_to_string(page).unwrap());
    assert!(rows.len() >= 30, "{}", rows.len());
    let program = program();
    let mut wrong = String::new();
    for [text, trace, verdict, margin] in &rows {
        let formula = read_formula(&program, text).unwrap_or_else(|e| panic!("{text}: {e}"));
        let mut runner = MetricRunner::new(&formula);
        run(trace).replay(&mut runner);
        let outcome = runner.outcome();
        let number = outcome.margin().map(|n| n.to_string()).unwrap_or_default();
        if outcome.outcome.to_string() != *verdict || number != *margin {
            wrong += &format!("{text}: {trace}: {verdict} {margin}, and not {} {number}\n", outcome.outcome);
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn every_operator_has_runs_on_the_page() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../spec/metric.md");
    let rows = rows(&fs::read_to_string(page).unwrap());
    for word in [
        "once[",
        "historically[",
        "since[",
        "eventually[",
        "always[",
        "until[",
        "always ",
        "eventually ",
        "until ",
        "not ",
        "and ",
        "implies ",
    ] {
        for verdict in ["pass", "fail"] {
            let is_met = rows.iter().any(|[formula, _, v, _]| formula.contains(word) && v == verdict);
            let never = word == "eventually " && verdict == "fail";
            assert!(is_met || never, "`{word}` has no run with the verdict {verdict}");
        }
    }
}

#[test]
fn short_and_long_words_say_the_same() {
    let program = program();
    for (long, short) in [
        ("always (a implies eventually[0 s, 10 s] b)", "G (a -> F[0 s, 10 s] b)"),
        ("p since[1 s, 2 s] (x < 3 and not q)", "p S[1000 ms, 2 s] (x < 3 && !q)"),
        ("p until q or once[0 s, 1 s] historically a", "(p U q) || (O[0 s, 1 s] (H a))"),
        ("always x < 1 + 2 * y", "always (x < (1 + (2 * y)))"),
        ("always distance(hand,palm) > 30 cm", "G distance( hand, palm ) > 0.3 m"),
        ("p implies q implies p or q and p", "p -> (q -> (p || (q && p)))"),
        ("always abs(-x) >= max(y, 1, 2)", "G abs(-(x)) >= max(max(y, 1), 2)"),
    ] {
        // All but how its atoms are written.
        let meant = |text: &str| {
            let formula =
                format!("{:?}", read_formula(&program, text).unwrap_or_else(|e| panic!("{text}: {e}")));
            let (before, rest) = formula.split_once("texts: [").expect("how atoms are written");
            let (_, after) = rest.split_once("signals: [").expect("the signals");
            format!("{before}{after}")
        };
        assert_eq!(meant(long), meant(short), "{long}");
    }
}

#[test]
fn events_are_asked_for_with_their_arguments() {
    let program = program();
    for (text, is_right) in [
        ("eventually decided(true, _)", true),
        ("eventually decided(_, 3)", true),
        ("eventually decided", false),
        ("eventually decided(true)", false),
        ("eventually decided(true, 9)", false),
        ("eventually decided(yes, 1)", false),
    ] {
        assert_eq!(read_formula(&program, text).is_ok(), is_right, "{text}");
    }
}

#[test]
fn what_is_wrong_is_said_with_its_place_and_what_to_write() {
    let program = program();
    for (text, place, message, help) in [
        ("", "", "something is missing", ""),
        ("always (p", "", "something is missing", "`)`"),
        ("always p q", "q", "does not stand here", ""),
        ("always x = 3", "=", "does not stand here", "`==`"),
        ("p until q until p", "until", "does not stand here", "parentheses"),
        ("1 < x < 3", "<", "does not stand here", "joined by `and`"),
        ("always x ; p", ";", "is nothing", ""),
        ("always sped < 3 m/s", "sped", "no signal or event is called `sped`", "`speed`"),
        ("always speed < 3", "speed < 3", "`3` has no unit", "`3 m/s`"),
        ("always speed < 3 m", "speed < 3 m", "is in m/s", "the same unit"),
        (
            "always speed * distance(hand, palm) > 0",
            "speed * distance(hand, palm)",
            "unit",
            "declare a signal",
        ),
        ("always x", "x", "neither true nor false", "`x < 3`"),
        ("always p == true", "p == true", "not compared", "`not p`"),
        ("always x + 1", "x + 1", "a number", "compare it"),
        ("always (a implies eventually b)", "eventually b", "outermost only", "eventually[0 s, 10 s]"),
        ("always eventually[0, 10] b", "0", "no unit", "[0 s, 500 ms]"),
        ("always eventually[0 m, 10 s] b", "0 m", "no time", "[0 s, 500 ms]"),
        ("eventually[3 s, 1 s] b", "[3 s, 1 s]", "ends before it begins", "nearer bound first"),
        ("once[0 s 1 s] b", "1 s", "does not stand here", "`,`"),
        ("eventually[0 s, 1000000 h] b", "1000000 h", "thirty years", ""),
        ("always a < 3", "a", "an event", ""),
        ("decided(_)", "decided(_)", "has 2 parameters", "`decided(_, _)`"),
    ] {
        let error = read_formula(&program, text).expect_err(text);
        assert_eq!(&text[error.range.clone()], place, "{text}: {error}");
        assert!(error.message.contains(message), "{text}: {error}");
        assert!(error.help.unwrap_or_default().contains(help), "{text}");
    }
    let deep = format!("{}p{}", "(".repeat(5_000), ")".repeat(5_000));
    assert!(read_formula(&program, &deep).unwrap_err().message.contains("deep"));
    assert!(read_formula(&program, &"not ".repeat(5_000)).unwrap_err().message.contains("deep"));
}
