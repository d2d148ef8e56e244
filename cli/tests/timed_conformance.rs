//! Robot code held against the automaton that models it: code that does as its model, code that is late, code that stops; and the bounds that
//! their recordings give.
#![allow(clippy::disallowed_methods, reason = "tests read files")]

mod support;

use std::fs;

use serde_json::Value;
use support::{expect_code, folder, hrdsl_in, stderr, stdout};

const SCENARIO: &str = r#"scenario mini

actor person : environment
actor robot  : system

event asked from person to robot
event said(n: 0..9) from robot

stimulus ask by person { emit asked }

automaton Robot plays robot {
  clock x
  init location idle
  location thinking { invariant x <= 2 s }

  idle     -> thinking on asked do x = 0
  thinking -> idle     when x >= 1 s do said(1)
}

cover answers = count(said(_)) bins none = 0, some = 1..

system robot {
  run "python3 robot.py"
  limit 20 s
}
"#;

const TESTS: &str =
    "test hand.once { seed 1; ask; wait 5 s }\ntest hand.twice { seed 2; ask; wait 4 s; ask; wait 8 s }\n";

/// A robot that answers the n-th time after so many seconds, and then no more.
fn robot(pauses: &str) -> String {
    format!(
        "import hrdsl\nnode = hrdsl.Node('robot')\nfor pause in {pauses}:\n    node.wait_for('asked')\n    node.sleep(pause)\n    node.emit('said', n=1)\nnode.wait_for('asked')\n"
    )
}

fn project(pauses: &str) -> tempfile::TempDir {
    folder(&[("scenario.hri", SCENARIO), ("robot.py", &robot(pauses)), ("tests.hri", TESTS)])
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

/// What each test's only model says, after a run of both.
fn verdicts(pauses: &str) -> (tempfile::TempDir, String, Vec<Value>) {
    let project = project(pauses);
    let run = hrdsl_in(project.path(), "sim scenario.hri tests.hri -o out");
    expect_code(&run, 0);
    let results = json(&fs::read_to_string(project.path().join("out/results.json")).unwrap());
    let tests = results["tests"].as_array().unwrap().iter();
    let found = tests.map(|t| t["conformance"][0].clone()).collect();
    (project, stdout(&run), found)
}

#[test]
fn code_that_does_as_its_model_conforms() {
    let (project, page, found) = verdicts("[1.5, 2]");
    assert!(found.iter().all(|v| v["outcome"] == "conforms" && v["model"] == "Robot"), "{found:?}");
    assert!(page.contains("Conformance  to the model in 2 of 2 tests\n"), "{page}");
    let calibrated = hrdsl_in(project.path(), "calibrate scenario.hri out");
    expect_code(&calibrated, 0);
    assert_eq!(stdout(&calibrated), "Robot: 2 of 2 recordings conform to it as it is\n");
}

#[test]
fn code_that_is_late_departs_with_the_time_the_window_and_the_line_and_is_judged_so_again() {
    let (project, page, found) = verdicts("[1.5, 3.25]");
    assert_eq!(found[0]["outcome"], "conforms");
    let departure = &found[1]["departure"];
    assert_eq!(
        (&found[1]["outcome"], &departure["kind"]),
        (&Value::from("departs"), &Value::from("silence"))
    );
    assert_eq!((&departure["time"], &departure["event"]["time"]), (&Value::from(6.0), &Value::from(7.25)));
    let allowed = &departure["allowed"][0];
    assert_eq!((&allowed["from"], &allowed["until"]), (&Value::from(5.0), &Value::from(6.0)));
    assert_eq!(
        (&allowed["edges"][0]["name"], &allowed["edges"][0]["line"]),
        (&Value::from("Robot: thinking -> idle"), &Value::from(17))
    );
    assert!(page.contains("Conformance  to the model in 1 of 2 tests\n"), "{page}");
    let told = "Robot: nothing came by 6 s, and said(n: 1) at 7.25 s";
    for report in ["report.html", "junit.xml"] {
        let text = fs::read_to_string(project.path().join("out").join(report)).unwrap();
        assert!(text.contains(told), "{report}");
    }
    let judged = hrdsl_in(project.path(), "judge scenario.hri out --json");
    expect_code(&judged, 0);
    let judged = json(&stdout(&judged));
    let again: Vec<Value> =
        judged["tests"].as_array().unwrap().iter().map(|t| t["conformance"][0].clone()).collect();
    assert_eq!(again, found);
    // What may be seen later may be late.
    let later = hrdsl_in(project.path(), "judge scenario.hri out --latency 1.25s");
    assert!(stdout(&later).contains("Conformance  to the model in 2 of 2 tests\n"), "{}", stdout(&later));
}

#[test]
fn code_that_answers_no_more_departs_by_its_silence() {
    let (_project, _, found) = verdicts("[1.5]");
    let departure = &found[1]["departure"];
    assert_eq!((&departure["kind"], &departure["time"]), (&Value::from("silence"), &Value::from(6.0)));
    assert_eq!(departure["event"], Value::Null);
}

#[test]
fn calibration_finds_the_bound_and_what_would_fit() {
    let (project, ..) = verdicts("[0.5, 3.25]");
    let calibrated = hrdsl_in(project.path(), "calibrate scenario.hri out");
    expect_code(&calibrated, 0);
    assert_eq!(
        stdout(&calibrated),
        "Robot: 0 of 2 recordings conform to it as it is\n\
         \u{20} Robot.thinking (line 14): x <= 2 s is contradicted by 1 of them\n\
         \u{20}   observed 0.500 s to 3.250 s, 3 times; x <= 3.25 s would fit\n\
         \u{20} Robot: thinking -> idle (line 17): x >= 1 s is contradicted by 2 of them\n\
         \u{20}   observed 0.500 s to 3.250 s, 3 times; x >= 0.5 s would fit\n\
         \u{20} with these bounds 2 of 2 conform\n"
    );
    let document = json(&stdout(&hrdsl_in(project.path(), "calibrate scenario.hri out --json")));
    assert_eq!(document["models"][0]["bounds"][1]["fits"][0], "x >= 0.5 s");
}

/// The recording asks once more while the waiter still fetches: only when it holds what it fetched is hidden.
#[test]
fn what_calibration_proposes_is_what_judge_finds_to_conform() {
    let events = "scenario counter\nactor guest : environment\nactor waiter : system\nevent ask from guest to waiter\n\
        event give from waiter\n";
    let model = |most: &str| {
        format!(
            "{events}automaton Waiter plays waiter {{\n clock x\n init location idle\n\
             location fetching {{ invariant x <= {most} s }}\n location holding {{ invariant x <= 2 s }}\n\
             idle -> fetching on ask do x = 0\n fetching -> holding when x >= 2 s do x = 0\n holding -> idle do give\n}}\n"
        )
    };
    let log = "{\"hrdsl\":\"trace\",\"version\":2,\"scenario\":\"counter\"}\n{\"t\":1,\"event\":\"ask\"}\n\
        {\"t\":11,\"event\":\"ask\"}\n{\"t\":13,\"event\":\"give\"}\n{\"end\":30,\"ended\":\"quiescent\"}\n";
    let project = folder(&[
        ("scenario.hri", &model("5")),
        ("tight.hri", &model("10")),
        ("tighter.hri", &model("9.99")),
        ("log.jsonl", log),
    ]);
    let calibrated = stdout(&hrdsl_in(project.path(), "calibrate scenario.hri log.jsonl"));
    assert!(
        calibrated.contains("no edge was taken that shows its times; x <= 10 s would fit\n"),
        "{calibrated}"
    );
    assert!(calibrated.contains("with these bounds 1 of 1 conform\n"), "{calibrated}");
    for (file, outcome) in [("tight.hri", "conforms"), ("tighter.hri", "departs")] {
        let judged = json(&stdout(&hrdsl_in(project.path(), &format!("judge {file} log.jsonl --json"))));
        assert_eq!(judged["tests"][0]["conformance"][0]["outcome"], outcome, "{file}: {judged}");
    }
}

#[test]
fn what_cannot_be_calibrated_is_said_with_the_next_step() {
    let plain = SCENARIO
        .replace("plays robot {", "plays person {")
        .replace("on asked ", "")
        .replace(" do said(1)", "");
    let project = folder(&[
        ("scenario.hri", &plain),
        (
            "log.jsonl",
            "{\"hrdsl\":\"trace\",\"version\":2,\"scenario\":\"mini\"}\n{\"end\":1,\"ended\":\"limit\"}\n",
        ),
    ]);
    let none = hrdsl_in(project.path(), "calibrate scenario.hri log.jsonl");
    expect_code(&none, 2);
    assert!(stderr(&none).contains("no automaton plays the system under test"), "{}", stderr(&none));
    let unknown = hrdsl_in(project.path(), "judge scenario.hri log.jsonl --unobserved sayd");
    expect_code(&unknown, 2);
    assert!(stderr(&unknown).contains("no event `sayd`; did you mean `said`?"), "{}", stderr(&unknown));
    let of_the_test = hrdsl_in(project.path(), "judge scenario.hri log.jsonl --unobserved asked");
    expect_code(&of_the_test, 2);
    assert!(stderr(&of_the_test).contains("`asked` comes from `person`"), "{}", stderr(&of_the_test));
}
