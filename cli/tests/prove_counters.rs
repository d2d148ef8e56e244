//! `hrdsl prove` of scenarios with a variable that nobody reads, through the binary.

mod support;

use serde_json::Value;
use support::{expect_code, folder, hrdsl_in};

fn row<'v>(document: &'v Value, kind: &str, name: &str) -> &'v Value {
    let rows = document["networks"][0][kind].as_array().unwrap();
    rows.iter().find(|r| r["name"] == name).unwrap_or_else(|| panic!("no {name}: {document:#}"))
}

/// A robot that counts its laps, which nobody reads.
const LAPS: &str = "\
scenario laps

actor robot : system

event home from robot

automaton Robot plays robot {
  clock x
  var laps: 0..7
  var speed: 0..3
  init location going { invariant x <= 2 s }
  location done
  going -> going when x >= 1 s && speed < 3 do speed += 1; laps += 1; x = 0
  going -> going when x >= 1 s && speed == 3 do speed = 0; laps += 1; x = 0
  going -> done when speed == 2 do home
}

network net = Robot

query gets_home of net = E<> Robot.done
query keeps of net = A[] Robot.speed <= 3
";

#[test]
fn a_counter_that_nobody_reads_has_an_answer_of_its_own() {
    let laps = |text: &str, more: &str| {
        let folder = folder(&[("laps.hri", text)]);
        let out = hrdsl_in(folder.path(), &format!("prove laps.hri --json {more}"));
        expect_code(&out, 1);
        serde_json::from_slice::<Value>(&out.stdout).unwrap()
    };
    let all = laps(LAPS, "");
    assert_eq!(row(&all, "queries", "gets_home")["verdict"], "satisfied");
    assert_eq!(row(&all, "queries", "keeps")["verdict"], "satisfied");
    let range = row(&all, "ranges", "Robot.laps");
    assert_eq!(range["verdict"], "fault_of_the_model");
    assert!(range["remark"].as_str().unwrap().contains("`laps` becomes 8, outside 0..7"), "{range:#}");
    assert_eq!(range["run"]["steps"].as_array().unwrap().len(), 7);
    assert_eq!(all["networks"][0]["searches"][0]["discrete_states"], 5);
    // With the counter a part of the state, the search for what always holds ends with the fault.
    let all = laps(LAPS, "--exact-counters");
    assert_eq!(row(&all, "queries", "gets_home")["verdict"], "satisfied");
    assert_eq!(row(&all, "queries", "keeps")["verdict"], "fault_of_the_model");
    assert!(all["networks"][0]["ranges"].is_null());
    // What is reached beyond the overflow alone is the fault.
    let all = laps(&LAPS.replace("laps: 0..7", "laps: 0..1"), "");
    assert_eq!(row(&all, "queries", "gets_home")["verdict"], "fault_of_the_model");
    assert_eq!(row(&all, "queries", "keeps")["verdict"], "satisfied");
    // A range that the budget leaves open is said to be so, and which variable grows.
    let folder = folder(&[("laps.hri", LAPS.replace("laps: 0..7", "laps: 0..100000").as_str())]);
    let out = hrdsl_in(folder.path(), "prove laps.hri --json --budget-states 30");
    expect_code(&out, 4);
    let all: Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!(row(&all, "queries", "keeps")["verdict"], "satisfied");
    let range = row(&all, "ranges", "Robot.laps");
    assert_eq!(range["verdict"], "inconclusive");
    assert!(
        range["remark"].as_str().unwrap().contains("`Robot.laps` has the most values so far"),
        "{range:#}"
    );
}

#[test]
fn queries_of_all_kinds_leave_out_what_nobody_reads() {
    let more = "query stuck of net = E<> deadlock\nquery fastest of net = sup: Robot.speed\n\
        query slow of net = Robot.going --> Robot.done\n";
    let text = format!("{}{more}", LAPS.replace("laps: 0..7", "laps: 0..100000"));
    let folder = folder(&[("laps.hri", text.as_str())]);
    let out = hrdsl_in(folder.path(), "prove laps.hri --json --explain --budget-states 30");
    expect_code(&out, 4);
    let all: Value = serde_json::from_slice(&out.stdout).unwrap();
    let stuck = row(&all, "queries", "stuck");
    assert_eq!(stuck["verdict"], "satisfied");
    let remark = stuck["remark"].as_str().unwrap();
    assert!(remark.contains("searched with one time for all automata: deadlocks, bounds"), "{remark}");
    assert_eq!(row(&all, "queries", "fastest")["bounds"], serde_json::json!(["3"]));
    // The loop that shows it raises the count with each round, and more rounds than are looked at lead to its end.
    let slow = row(&all, "queries", "slow");
    assert_eq!(slow["verdict"], "inconclusive");
    assert!(slow["remark"].as_str().unwrap().contains("`Robot.laps` has the most values so far"), "{slow:#}");
    assert_eq!(all["networks"][0]["ranges"].as_array().unwrap().len(), 1);
}

#[test]
fn each_variable_has_one_answer_whatever_each_search_reads() {
    let ranges = |queries: &str| {
        let model = "scenario twice\nactor robot : system\nautomaton Robot plays robot {\n  clock x\n  var a: 0..9\n  \
            var c: 0..9\n  init location going\n  location done\n  \
            going -> done when x >= 1 s do a += 1; c = a + 1\n}\nnetwork net = Robot\n";
        let folder = folder(&[("twice.hri", format!("{model}{queries}").as_str())]);
        let out = hrdsl_in(folder.path(), "prove twice.hri --json");
        expect_code(&out, 0);
        let all: Value = serde_json::from_slice(&out.stdout).unwrap();
        let rows = all["networks"][0]["ranges"].as_array().unwrap();
        rows.iter().map(|row| row["name"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    // The first search reads neither, the second `a`; then the other way round.
    let both = ranges("query q of net = E<> Robot.done\nquery r of net = sup: Robot.a\n");
    assert_eq!(both, ["Robot.a, Robot.c"]);
    let one_by_one = ranges("query q of net = E<> Robot.a == 1\nquery r of net = sup: Robot.x\n");
    assert_eq!(one_by_one, ["Robot.a", "Robot.c"]);
}
