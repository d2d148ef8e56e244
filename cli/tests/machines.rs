//! State machines of the code under test: covered, recorded, judged again, and reported.
#![allow(clippy::disallowed_methods, reason = "tests read files")]

mod support;

use std::fs;

use serde_json::Value;
use support::{expect_code, folder, handover, hrdsl, hrdsl_in, root, scenario, stdout};

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

/// The labels of the states with how many tests entered each.
fn states(machine: &Value) -> Vec<(String, u64)> {
    let sum = |item: &Value| item["hits"].as_array().unwrap().iter().filter_map(Value::as_u64).sum();
    let states = machine["states"].as_array().unwrap().iter();
    states.map(|state| (state["state"].as_str().unwrap().to_owned(), sum(state))).collect()
}

#[test]
fn the_machine_of_the_rospy_handover_is_covered_and_judged_again() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let (scenario, out_text) = (handover(), out.to_str().unwrap().to_owned());
    let system = root().join("examples/handover/with_rospy/system.hri");
    let args = ["sim", scenario.to_str().unwrap(), "-o", &out_text, "-n", "3", "--exit-zero", "--system"];
    let run = hrdsl(args.iter().chain(&[system.to_str().unwrap()]));
    expect_code(&run, 0);
    let results = json(&fs::read_to_string(out.join("results.json")).unwrap());
    let machines = results["machines"].as_array().unwrap();
    assert_eq!(machines.len(), 1);
    let (states, transitions) = (states(&machines[0]), machines[0]["transitions"].as_array().unwrap());
    assert_eq!((states.len(), transitions.len()), (14, 22), "as many as those of the SDK's robot");
    assert_eq!(states[0].1, 9, "every test enters the first");
    assert!(states.iter().any(|(_, tests)| *tests < 9), "and not all of them: {states:?}");
    let printed = stdout(&run);
    assert!(printed.contains("State machine TABLE  1") && printed.contains(" of 14 states, "), "{printed}");
    assert!(!printed.contains("Interfaces"), "everybody meets somebody: {printed}");

    // The recordings have all of it.
    let judged = hrdsl(["judge", scenario.to_str().unwrap(), &out_text, "--json", "--exit-zero"]);
    expect_code(&judged, 0);
    let judged = json(&stdout(&judged));
    let of = |document: &Value| {
        let tests = document["tests"].as_array().unwrap().iter();
        let mut tests: Vec<(String, String)> =
            tests.map(|t| (t["name"].to_string(), serde_json::to_string(&t["machines"]).unwrap())).collect();
        tests.sort();
        tests
    };
    assert_eq!(of(&results), of(&judged));
    let again = judged["machines"].as_array().unwrap();
    assert_eq!(self::states(&again[0]), states);

    // The reports are made of the results alone.
    let reports = ["report.html", "junit.xml"];
    let before = reports.map(|name| fs::read(out.join(name)).unwrap());
    let page = String::from_utf8(before[0].clone()).unwrap();
    assert!(page.contains("<h2>State machines</h2>"));
    expect_code(&hrdsl(["report", &out_text]), 0);
    assert!(before == reports.map(|name| fs::read(out.join(name)).unwrap()));
}

const PROGRAM: &str = r#"import hrdsl
node = hrdsl.Node("robot")
machine = hrdsl.StateMachine("talk", {"WAIT": {"called": "ANSWER"}, "ANSWER": {"said": "WAIT", "tired": "asleep"}}, ["asleep"])
machine.begin("WAIT")
node.wait_for("called")
machine.take("called")
node.sleep(1)
"#;

#[test]
fn a_machine_declared_through_the_sdk_counts() {
    let suite = "suite some by random { stimuli call; length 1..1; tests 2 }\nsystem robot { run \"python3 robot.py\"; limit 9 s }\n";
    let text = scenario("s", "call") + suite;
    let folder = folder(&[("robot.py", PROGRAM), ("s.hri", &text)]);
    let run = hrdsl_in(folder.path(), "sim s.hri -o out");
    expect_code(&run, 0);
    let said = "State machine talk  2 of 2 states, 1 of 3 transitions\n○ never taken  ANSWER -said-> WAIT\n\
                ○ never taken  ANSWER -tired-> asleep\n";
    assert!(stdout(&run).contains(said), "{}", stdout(&run));
    let recording = fs::read_to_string(folder.path().join("out/traces/s.some.t001.jsonl")).unwrap();
    let lines: Vec<&str> = recording.lines().filter(|line| line.contains("\"machine\"")).collect();
    assert_eq!(lines.len(), 3);
    assert!(lines[1].ends_with("\"machine\":\"talk\",\"to\":\"WAIT\"}"), "{recording}");
    let judged = hrdsl_in(folder.path(), "judge s.hri out");
    assert!(stdout(&judged).contains(said), "{}", stdout(&judged));
}
