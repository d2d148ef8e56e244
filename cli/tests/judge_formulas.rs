//! `hrdsl judge --formula`: metric formulas over recordings.
#![allow(clippy::disallowed_methods, reason = "tests write files")]

mod support;

use serde_json::Value;
use support::{command, expect_code, folder, stderr, stdout};

const SCENARIO: &str = "scenario lift
actor guest : environment
actor robot : system
event asked from guest
event placed(gently: bool) from robot
require R1 safety \"the hand keeps away\" always distance(hand, post) > 1 cm
world {
  body hand: kinematic sphere(5 cm) at (1 m, 0 m, 1 m)
  body post: fixed sphere(5 cm) at (0 m, 0 m, 1 m)
  signal lifted: bool to robot = distance(hand, post) > 2 m
}
";

const RECORDING: &str = r#"{"hrdsl":"trace","version":2,"scenario":"lift"}
{"t":0,"signal":"distance(hand, post)","value":0.9}
{"t":1,"event":"asked"}
{"t":2,"signal":"distance(hand, post)","value":0.1}
{"t":4.5,"event":"placed","args":{"gently":true}}
{"t":5,"signal":"distance(hand, post)","value":0.6}
{"t":6,"event":"asked"}
{"t":9,"event":"placed","args":{"gently":false}}
{"end":20,"ended":"quiescent"}
"#;

/// The exit code, and what is printed to each stream.
fn judged(formulas: &[&str], more: &[&str]) -> (i32, String, String) {
    let folder = folder(&[("lift.hri", SCENARIO), ("run.jsonl", RECORDING)]);
    let mut command = command();
    command.current_dir(folder.path()).args(["judge", "lift.hri", "run.jsonl"]).args(more);
    formulas.iter().for_each(|formula| {
        command.args(["--formula", formula]);
    });
    let output = command.output().unwrap();
    (output.status.code().unwrap(), stdout(&output), stderr(&output))
}

/// The verdict on a formula, as `--json` has it.
fn verdict(formula: &str) -> Value {
    let (_, out, err) = judged(&[formula], &["--json"]);
    let document: Value = serde_json::from_str(&out).unwrap_or_else(|e| panic!("{e}: {out}{err}"));
    let verdict = document["tests"][0]["verdicts"][1].clone();
    assert_eq!(verdict["requirement"], "formula 1");
    assert_eq!(document["requirements"][1]["text"], formula);
    verdict
}

#[test]
fn a_formula_is_judged_told_and_tallied_as_a_requirement() {
    let near = "always distance(hand, post) > 20 cm";
    let (code, out, _) = judged(&[near, "always (asked implies eventually[0 s, 4 s] placed(_))"], &[]);
    assert_eq!(code, 3, "{out}");
    assert!(out.contains("✗ formula 1 always distance(hand, post) > 20 cm"), "{out}");
    assert!(
        out.contains("✗ formula 1     2.00 s")
            && out.contains("distance(hand, post) = 0.1 m, margin −0.100 m"),
        "{out}"
    );
    assert!(out.contains("✓ formula 2 always (asked implies"), "{out}");
    let (code, out, _) = judged(&[near], &["--exit-zero"]);
    assert_eq!(code, 0, "{out}");
    let (code, out, _) = judged(&[], &[]);
    assert!(code == 0 && !out.contains("formula"), "{out}");
}

#[test]
fn verdicts_have_times_margins_and_what_bears_them_out() {
    let failed = verdict("always (asked implies always[0 s, 4 s] distance(hand, post) > 20 cm)");
    assert_eq!((failed["outcome"].as_str(), failed["failures"].as_u64()), (Some("fail"), Some(1)));
    assert_eq!(failed["failure"]["time"], 1.0, "of the moment that is asked of, not of the sample");
    let steps = failed["failure"]["counterexample"].as_array().unwrap();
    let texts: Vec<&str> = steps.iter().map(|s| s["text"].as_str().unwrap()).collect();
    assert_eq!(texts, ["signal distance(hand, post) = 0.9 m", "guest asked"]);
    let margin = failed["worst_margin"][0].as_f64().unwrap();
    assert!((margin + 0.1).abs() < 1e-12 && failed["worst_margin"][1] == "m", "{failed}");

    let passed = verdict("always (asked implies historically[0 s, 1 s] distance(hand, post) > 20 cm)");
    assert_eq!((passed["outcome"].as_str(), passed["triggered"].as_u64()), (Some("pass"), Some(2)));
    assert_eq!(
        verdict("always (placed(false) implies eventually[0 s, 60 s] asked)")["outcome"],
        "inconclusive"
    );
    assert_eq!(verdict("always (placed(false) and asked implies false)")["outcome"], "vacuous");
    assert_eq!(verdict("eventually distance(hand, post) > 2 m")["outcome"], "inconclusive");
    let mixed = verdict("always (distance(hand, post) > 20 cm or 1 s < 2 s)");
    assert!(mixed["outcome"] == "pass" && mixed["worst_margin"].is_null(), "metres and seconds: {mixed}");
}

#[test]
fn a_signal_without_samples_is_told() {
    let (code, out, err) = judged(&["always not lifted"], &[]);
    assert_eq!(code, 0, "{out}");
    assert!(err.contains("warning: formula 1: `lifted` has no sample in 1 of 1 recordings"), "{err}");
    assert!(out.contains("○ formula 1"), "vacuous: {out}");
}

#[test]
fn what_is_wrong_is_marked() {
    let (code, out, err) =
        judged(&["always p", "always asked", "always (asked implies eventually placed(_))"], &[]);
    assert_eq!(code, 2);
    assert_eq!(out, "", "nothing is judged");
    assert!(err.contains("no signal or event is called `p`") && err.contains("formula 1:1:8"), "{err}");
    assert!(err.contains("`eventually` without a window can stand outermost only"), "{err}");
    assert!(err.contains("help: say how far it looks, as in `eventually[0 s, 10 s]`"), "{err}");
    assert!(!err.contains("formula 2"), "that one is right: {err}");
}

#[test]
fn runs_that_broke_off_can_only_fail() {
    let broken = RECORDING.replace("\"quiescent\"", "\"error\"");
    let folder = folder(&[("lift.hri", SCENARIO), ("run.jsonl", &broken)]);
    let judged = |formula: &str| {
        let mut command = command();
        command.current_dir(folder.path()).args([
            "judge",
            "lift.hri",
            "run.jsonl",
            "--json",
            "--formula",
            formula,
        ]);
        let output = command.output().unwrap();
        expect_code(&output, 3);
        let document: Value = serde_json::from_str(&stdout(&output)).unwrap();
        document["tests"][0]["verdicts"][1]["outcome"].clone()
    };
    assert_eq!(judged("always distance(hand, post) > 20 cm"), "fail");
    assert_eq!(judged("always distance(hand, post) > 2 cm"), "error");
}
