//! `hrdsl judge --around`: what a violated requirement consists of, around its first violation.
#![allow(clippy::disallowed_methods, reason = "tests write files")]

mod support;

use serde_json::{Value, json};
use support::{command, expect_code, folder, stderr, stdout};

const SCENARIO: &str = "scenario lift
actor guest : environment
actor robot : system
event asked from guest
event placed(gently: bool) from robot
require R1 safety \"it does not let go in the way of the hand\"
  never placed(_) while distance(hand, post) < 20 cm and not lifted
require R2 functional \"who asks is served\" asked causes placed(true) within 3 s
world {
  body hand: kinematic sphere(5 cm) at (1 m, 0 m, 1 m)
  body post: fixed sphere(5 cm) at (0 m, 0 m, 1 m)
  signal lifted: bool to robot = distance(hand, post) > 2 m
}
";

const RECORDING: &str = r#"{"hrdsl":"trace","version":2,"scenario":"lift"}
{"t":0,"signal":"distance(hand, post)","value":0.9}
{"t":0,"signal":"lifted","value":true}
{"t":1,"event":"asked"}
{"t":2,"signal":"distance(hand, post)","value":0.5}
{"t":3.5,"signal":"distance(hand, post)","value":0.1}
{"t":3.5,"signal":"lifted","value":false}
{"t":4.5,"event":"placed","args":{"gently":false}}
{"t":5,"signal":"distance(hand, post)","value":0.6}
{"t":6,"event":"asked"}
{"t":9,"event":"placed","args":{"gently":true}}
{"end":20,"ended":"quiescent"}
"#;

fn judged(more: &[&str]) -> String {
    let folder = folder(&[("lift.hri", SCENARIO), ("run.jsonl", RECORDING)]);
    let mut command = command();
    let out = command.current_dir(folder.path()).args(["judge", "lift.hri", "run.jsonl"]).args(more);
    let out = out.output().unwrap();
    expect_code(&out, 3);
    assert!(!stderr(&out).contains("error"), "{}", stderr(&out));
    stdout(&out)
}

fn document(more: &[&str]) -> Value {
    serde_json::from_str(&judged(&[more, &["--json"]].concat())).unwrap()
}

/// The parts of the requirement at a place, as `[text, unit, event, [[time, value], …]]`.
fn parts(document: &Value, verdict: usize) -> Vec<Value> {
    let around = document["tests"][0]["verdicts"][verdict]["failure"]["around"].as_array().unwrap();
    let values = |part: &Value| {
        let all = part["values"].as_array().unwrap().iter();
        all.map(|value| json!([value["time"], value["value"]])).collect::<Vec<_>>()
    };
    around.iter().map(|part| json!([part["text"], part["unit"], part["event"], values(part)])).collect()
}

#[test]
fn each_part_is_told_from_before_the_violation_to_after_it() {
    let found = document(&["--around", "2s"]);
    let expected = json!([
        ["placed(_)", "", true, [[4.5, true]]],
        ["distance(hand, post)", "m", false, [[2.5, 0.5], [3.5, 0.1], [5.0, 0.6]]],
        ["distance(hand, post) < 0.2 m", "", false, [[2.5, false], [3.5, true], [5.0, false]]],
        ["lifted", "", false, [[2.5, true], [3.5, false]]],
        ["distance(hand, post) < 0.2 m and not lifted", "", false, [[2.5, false], [3.5, true], [5.0, false]],],
    ]);
    assert_eq!(json!(parts(&found, 0)), expected);
    // The deadline passed at 4 s: what was done instead is not far.
    let expected = json!([["asked", "", true, [[6.0, true]]], ["placed(true)", "", true, []]]);
    assert_eq!(json!(parts(&found, 1)), expected);
    let expected =
        json!([["asked", "", true, [[1.0, true], [6.0, true]]], ["placed(true)", "", true, [[9.0, true]]]]);
    assert_eq!(json!(parts(&document(&["--around", "5s"]), 1)), expected);
}

#[test]
fn nothing_else_of_the_judgement_changes() {
    let mut with = document(&["--around", "500ms"]);
    let verdicts = with["tests"][0]["verdicts"].as_array_mut().unwrap();
    for verdict in verdicts.iter_mut() {
        verdict["failure"].as_object_mut().unwrap().remove("around").unwrap();
    }
    assert_eq!(with, document(&[]));
}

#[test]
fn formulas_tell_what_they_name_and_the_formulas_in_them() {
    let formula = "always (placed(_) implies distance(hand, post) > 30 cm)";
    let found = document(&["--formula", formula, "--around", "1s"]);
    let expected = json!([
        ["placed(_)", "", true, [[4.5, true]]],
        ["distance(hand, post)", "m", false, [[3.5, 0.1], [5.0, 0.6]]],
        ["distance(hand, post) > 30 cm", "", false, [[3.5, false], [5.0, true]]],
        ["margin of distance(hand, post) > 30 cm", "m", false, [[3.5, 0.1 - 0.3], [5.0, 0.6 - 0.3]]],
        [
            "placed(_) implies distance(hand, post) > 30 cm",
            "",
            false,
            [[3.5, true], [4.5, false], [4.500_000_001, true]]
        ],
        [
            "margin of placed(_) implies distance(hand, post) > 30 cm",
            "m",
            false,
            [
                [3.5, "holds whatever is measured"],
                [4.5, 0.1 - 0.3],
                [4.500_000_001, "holds whatever is measured"]
            ]
        ],
    ]);
    assert_eq!(json!(parts(&found, 2)), expected);
}

#[test]
fn people_read_it_below_the_summary() {
    let out = judged(&["--around", "2s"]);
    let tail = out.split_once("\nrun: R1 around").unwrap().1;
    assert_eq!(
        tail,
        " 4.50 s
  placed(_)
      4.500 s
  distance(hand, post)
      2.500 s: 0.500 m · 3.500 s: 0.100 m · 5.000 s: 0.600 m
  distance(hand, post) < 0.2 m
      2.500 s: false · 3.500 s: true · 5.000 s: false
  lifted
      2.500 s: true · 3.500 s: false
  distance(hand, post) < 0.2 m and not lifted
      2.500 s: false · 3.500 s: true · 5.000 s: false

run: R2 around 4.00 s
  asked
      6.000 s
  placed(true)
      –
"
    );
}

#[test]
fn of_many_values_those_nearest_to_the_violation_are_shown() {
    let many: String = (0..100)
        .map(|k| {
            format!(
                "{{\"t\":{},\"signal\":\"distance(hand, post)\",\"value\":{}}}\n",
                k,
                0.1 + f64::from(k) / 1e3
            )
        })
        .collect();
    let recording = format!(
        "{{\"hrdsl\":\"trace\",\"version\":2,\"scenario\":\"lift\"}}\n{{\"t\":0,\"signal\":\"lifted\",\"value\":false}}\n{many}\
         {{\"t\":99.5,\"event\":\"placed\",\"args\":{{\"gently\":false}}}}\n{{\"end\":120,\"ended\":\"quiescent\"}}\n"
    );
    let folder = folder(&[("lift.hri", SCENARIO), ("run.jsonl", &recording)]);
    let mut command = command();
    let out = command.current_dir(folder.path()).args(["judge", "lift.hri", "run.jsonl", "--around", "50s"]);
    let out = out.output().unwrap();
    expect_code(&out, 3);
    let line = "      43 earlier · 92.000 s: 0.192 m · 93.000 s: 0.193 m · ";
    assert!(stdout(&out).contains(line), "{}", stdout(&out));
}
