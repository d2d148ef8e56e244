//! Requirements in metric temporal logic from end to end: a run and its recording have the same verdicts, and they are explained, drawn and told.
#![allow(clippy::disallowed_methods, reason = "tests read what the binary wrote")]

mod support;

use serde_json::Value;
use support::{expect_code, folder, hrdsl_in, stderr, stdout};

const SCENARIO: &str = r#"scenario watchful

actor child : environment
actor robot : system
event braked, asked from robot to child

stimulus run_by by child {
  child.move_to((70 cm, 0 m, 50 cm), 500 ms)
  hold 2 s
}

world {
  body ground: fixed box(10 m, 10 m, 10 cm) at (0 m, 0 m, -5 cm)
  body child: kinematic box(20 cm, 20 cm, 1 m) at (2 m, 0 m, 50 cm)
  body post: kinematic cylinder(20 cm, 20 cm) at (0 m, 0 m, 10 cm)
  signal near: bool to robot = distance(child, post) < 1 m every 100 ms late 50 ms
}

require M1 safety "it brakes soon" formula always (rising(near) implies eventually[0 s, 1 s] braked)
require M2 safety "it brakes at once" formula always (rising(near) implies eventually[0 s, 10 ms] braked)
require M3 safety "it brakes for a reason" formula always (braked implies once[0 s, 1 s] near)
require M4 safety "the child keeps away" formula always distance(child, post) > 90 cm
require M5 functional "it asks" formula eventually asked
require M6 functional "it asks in time" formula always (asked implies once[0 s, 1 s] near)
require M7 safety "the child has been away" formula always (near implies historically[2 s, 3 s] distance(child, post) > 1 m)

system robot { run "python3 watcher.py" }
"#;

const WATCHER: &str = "import hrdsl
node = hrdsl.Node('watcher')
braked = False
for _ in range(80):
    if node.read('near') and not braked:
        node.emit('braked')
        braked = True
    node.sleep(0.025)
";

const TESTS: &str = "test a { seed 7; wait 200 ms; run_by }\ntest b { seed 8; wait 3 s }\n";

fn world() -> tempfile::TempDir {
    folder(&[("scenario.hri", SCENARIO), ("watcher.py", WATCHER), ("a.tests.hri", TESTS)])
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|e| panic!("{e}: {text}"))
}

/// By test, the verdicts.
fn verdicts(document: &Value) -> Vec<Value> {
    document["tests"].as_array().unwrap().iter().map(|test| test["verdicts"].clone()).collect()
}

#[test]
fn a_run_and_its_recording_have_the_same_verdicts() {
    let folder = world();
    let at = folder.path();
    let ran = hrdsl_in(at, "sim scenario.hri a.tests.hri -o out --exit-zero -j 1");
    expect_code(&ran, 0);
    let results = json(&std::fs::read_to_string(at.join("out/results.json")).unwrap());
    let judged = hrdsl_in(at, "judge scenario.hri out --json --exit-zero");
    expect_code(&judged, 0);
    assert_eq!(verdicts(&results), verdicts(&json(&stdout(&judged))));
    let outcomes = |test: usize| {
        let of = verdicts(&results)[test].as_array().unwrap().clone();
        of.iter().map(|v| v["outcome"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(
        outcomes(0),
        ["pass", "fail", "pass", "fail", "inconclusive", "vacuous", "pass"],
        "{results:#}"
    );
    assert_eq!(outcomes(1), ["vacuous", "vacuous", "vacuous", "pass", "inconclusive", "vacuous", "vacuous"]);

    // The first failure is the physics step at which the child was near, and its margin by how much it came nearer at the most.
    let away = &verdicts(&results)[0][3];
    let margin = away["worst_margin"][0].as_f64().unwrap();
    assert!(margin < -0.4 && margin > -0.6 && away["worst_margin"][1] == "m", "{away}");
    let time = away["failure"]["time"].as_f64().unwrap();
    assert!(time > 0.2 && time < 0.7 && away["failure"]["deadline"] == false, "{away}");
    let late = &verdicts(&results)[0][1];
    assert!(late["failure"]["counterexample"].as_array().unwrap().len() == 1, "{late}");
    let two = hrdsl_in(at, "sim scenario.hri a.tests.hri -o two --exit-zero -j 2 --triggers");
    expect_code(&two, 0);
    let triggers = stdout(&two);
    let told = triggers.split("Triggers  of each requirement").nth(1).unwrap();
    let of = |name: &str| told.lines().find(|line| line.contains(name)).unwrap().to_owned();
    assert!(of("M1").contains("once  in 1 of 2 tests"), "{told}");
    assert!(of("M4").contains("least margin \u{2212}0.") && of("M4").ends_with("m in a"), "{told}");
    assert!(of("M6").contains("0 times  in 0 of 2 tests"), "{told}");
    assert_eq!(support::tree(&at.join("out/traces")), support::tree(&at.join("two/traces")));
}

#[test]
fn the_same_text_on_the_command_line_says_the_same() {
    let folder = world();
    let at = folder.path();
    expect_code(&hrdsl_in(at, "sim scenario.hri a.tests.hri -o out --exit-zero"), 0);
    let mut command = support::command();
    command.current_dir(at).args(["judge", "scenario.hri", "out", "--json", "--exit-zero"]);
    for formula in ["always distance(child, post) > 90 cm", "always (braked implies once[0 s, 1 s] near)"] {
        command.args(["--formula", formula]);
    }
    let document = json(&stdout(&command.output().unwrap()));
    for test in verdicts(&document) {
        for (requirement, formula) in [(3, 7), (2, 8)] {
            let named = |place: usize| {
                let mut verdict = test[place].clone();
                verdict.as_object_mut().unwrap().remove("requirement");
                verdict
            };
            assert_eq!(named(requirement), named(formula));
        }
    }
}

#[test]
fn what_a_violated_formula_consists_of_is_told() {
    let folder = world();
    let at = folder.path();
    expect_code(&hrdsl_in(at, "sim scenario.hri a.tests.hri -o out --exit-zero"), 0);
    let document = json(&stdout(&hrdsl_in(at, "judge scenario.hri out --json --exit-zero --around 300ms")));
    let around = verdicts(&document)[0][1]["failure"]["around"].clone();
    let texts: Vec<&str> = around.as_array().unwrap().iter().map(|p| p["text"].as_str().unwrap()).collect();
    assert_eq!(
        texts,
        [
            "braked",
            "near",
            "not near",
            "once[1 ns, 1 ns] not near",
            "near and once[1 ns, 1 ns] not near",
            "eventually[0 s, 10 ms] braked",
            "near and once[1 ns, 1 ns] not near implies eventually[0 s, 10 ms] braked",
        ]
    );
    let whole = around[6]["values"].as_array().unwrap();
    let truths: Vec<&Value> = whole.iter().map(|v| &v["value"]).collect();
    assert_eq!(truths, [&Value::Bool(true), &Value::Bool(false), &Value::Bool(true)], "{around:#}");
    assert_eq!(whole[1]["time"], verdicts(&document)[0][1]["failure"]["time"]);
    // Numbers have their margin, too.
    let around = verdicts(&document)[0][3]["failure"]["around"].clone();
    let margin = &around[2];
    assert_eq!(
        (&margin["text"], &margin["unit"]),
        (&"margin of distance(child, post) > 90 cm".into(), &"m".into())
    );
    let values: Vec<f64> =
        margin["values"].as_array().unwrap().iter().map(|v| v["value"].as_f64().unwrap()).collect();
    assert!(
        values.first().is_some_and(|m| *m > 0.0) && values.last().is_some_and(|m| *m < 0.0),
        "{around:#}"
    );
    let told = stdout(&hrdsl_in(at, "judge scenario.hri out --exit-zero --around 300ms"));
    assert!(told.contains("  eventually[0 s, 10 ms] braked\n"), "{told}");
}

#[test]
fn formulas_are_explained_drawn_and_not_proved() {
    let folder = world();
    let at = folder.path();
    let read = |name: &str| {
        let out = hrdsl_in(at, &format!("explain scenario.hri {name} --json"));
        expect_code(&out, 0);
        json(&stdout(&out))[0].clone()
    };
    let soon = read("M1");
    assert_eq!(
        soon["says"],
        "At every moment, (whenever `rising(near)` happens, (at some moment in the next 1 s, `braked` happens))."
    );
    assert!(
        soon["fail"].is_string() && soon["inconclusive"].is_string() && soon["vacuous"].is_string(),
        "{soon}"
    );
    let away = read("M4");
    assert!(away["inconclusive"].is_null() && away["fail"].is_string(), "{away}");
    let asks = read("M5");
    assert!(
        asks["fail"].is_null() && asks["vacuous"].is_null() && asks["inconclusive"].is_string(),
        "{asks}"
    );

    let monitors = hrdsl_in(at, "emit monitors scenario.hri");
    expect_code(&monitors, 0);
    let emitted = json(&stdout(&monitors));
    let first = &emitted["monitors"][0];
    assert_eq!(first["formula"]["atoms"][0]["text"], "near", "{first}");
    assert_eq!(first["states"], serde_json::json!([]));
    let automata = emitted["formula_automata"].as_array().unwrap();
    let soon = &automata[0]["automaton"];
    let outcomes: Vec<&str> =
        soon["states"].as_array().unwrap().iter().map(|s| s["outcome"].as_str().unwrap()).collect();
    assert_eq!(outcomes, ["vacuous", "pass", "inconclusive", "fail"], "{soon:#}");
    let late = soon["edges"].as_array().unwrap().iter().find(|edge| edge["to"] == 3).unwrap();
    assert_eq!(late["text"], "not braked and x >= 1 s", "{soon:#}");
    let away = &automata[6];
    assert!(away["automaton"].is_null(), "{away:#}");
    assert!(away["obstacle"].as_str().unwrap().starts_with("`historically[2 s, 3 s] "), "{away:#}");
    let drawn = hrdsl_in(at, "emit monitors scenario.hri --dot");
    expect_code(&drawn, 0);
    let dot = stdout(&drawn);
    for part in [
        "waiting for braked\\n(inconclusive)",
        "rising(near) and not braked\\nx = 0",
        "not braked and x >= 1 s",
        "No automaton. `historically[2 s, 3 s]",
        "historically[2 s, 3 s]\"",
    ] {
        assert!(dot.contains(part), "{part}: {dot}");
    }
    assert!(stderr(&drawn).is_empty(), "{}", stderr(&drawn));
}

/// A formula keeps each change of what it compares, a pattern the changes of the truth and the least margin.
#[test]
fn how_much_a_formula_adds_to_a_recording() {
    let lines = |requirement: &str| {
        let kept = SCENARIO.lines().filter(|line| !line.starts_with("require"));
        let mut text: String = kept.map(|line| format!("{line}\n")).collect();
        text += &format!("require R1 safety {requirement}\n");
        let folder = folder(&[("scenario.hri", &text), ("watcher.py", WATCHER), ("a.tests.hri", TESTS)]);
        let out =
            hrdsl_in(folder.path(), "sim scenario.hri a.tests.hri -o out --exit-zero --test watchful.a");
        expect_code(&out, 0);
        let recordings = support::tree(&folder.path().join("out/traces"));
        recordings.values().map(|text| String::from_utf8_lossy(text).lines().count()).sum::<usize>()
    };
    let pattern = lines("globally distance(child, post) > 90 cm");
    let formula = lines("formula always distance(child, post) > 90 cm");
    assert_eq!((pattern, formula), (16, 55));
    // Of events and truths nothing more is kept.
    let pattern = lines("rising(near) causes braked within 1 s");
    let formula = lines("formula always (rising(near) implies eventually[0 s, 1 s] braked)");
    assert_eq!(pattern, formula);
}
