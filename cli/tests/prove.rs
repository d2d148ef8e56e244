//! `hrdsl prove`, through the binary.

mod support;

use serde_json::Value;
use support::{expect_code, folder, hrdsl_in, stderr, stdout};

/// A robot that answers within 4 s to 6 s, or never, if it is asked a second time.
const SCENARIO: &str = "\
scenario door

actor person : environment
actor robot  : system

event asked(again: bool) from person to robot
event opened             from robot
event closed             from robot
event rung               from person

var opens: 0..3

automaton Person plays person {
  clock x
  init location outside
  location waiting
  location tired
  outside -> waiting when x >= 10 s do asked(false); x = 0
  waiting -> outside on opened do x = 0
  waiting -> tired when x >= 2 s do asked(true)
}

automaton Door plays robot {
  clock x
  init location shut
  location moving { invariant x <= 6 s }
  location stuck
  location open { invariant x <= 2 s }
  shut   -> moving on asked(false) do x = 0
  moving -> stuck  on asked(true)
  moving -> open   when x >= 4 s && opens < 3 do opened; opens += 1; x = 0
  moving -> open   when x >= 4 s && opens == 3 do opened; x = 0
  open   -> shut   when x >= 2 s do closed
}

network house = Person | Door

require R1 functional \"who asks gets in\" asked(_) causes opened within 6 s
require R2 functional \"who asks once gets in, or stops\" asked(false) causes opened or asked(true) within 6 s
require R3 safety never rung
require R4 safety \"nobody is pushed\" never opened while distance(hand, leaf) < 1 cm
require R5 safety opened forbids opened until closed

query waits \"somebody waits\" of house = E<> Person.waiting and Door.moving
query ends of house = A[] not deadlock
query in_time of house = A[] Person.waiting and not Door.stuck imply Person.x <= 6 s
query served of house = Person.waiting --> Person.outside
query longest of house = sup{Person.waiting and Door.moving}: Person.x, opens

suite all_of_it by search of house {
  reach each location
  reach each pair
  reach each use
  reach violation of R1, R2
  reach trigger of R1, R3
  reach query waits
  witness shortest
  tests 20
}

world {
  body hand : fixed sphere(1 cm) at (0 m, 0 m, 0 m)
  body leaf : fixed sphere(1 cm) at (1 m, 0 m, 0 m)
}
";

fn proved(args: &str) -> (std::process::Output, Value) {
    let folder = folder(&[("door.hri", SCENARIO)]);
    let out = hrdsl_in(folder.path(), &format!("prove door.hri --json {args}"));
    let json = serde_json::from_slice(&out.stdout)
        .unwrap_or_else(|e| panic!("{e}: {} {}", stdout(&out), stderr(&out)));
    (out, json)
}

fn row<'v>(document: &'v Value, kind: &str, name: &str) -> &'v Value {
    let rows = document["networks"][0][kind].as_array().unwrap();
    rows.iter().find(|r| r["name"] == name).unwrap_or_else(|| panic!("no {name}: {document:#}"))
}

#[test]
fn requirements_and_queries_are_decided() {
    let (out, all) = proved("");
    expect_code(&out, 3);
    let requirement = |name| row(&all, "requirements", name);
    let query = |name| row(&all, "queries", name);
    assert_eq!((&all["format"], &all["scenario"]), (&"hrdsl-prove".into(), &"door".into()));
    assert_eq!(requirement("R1")["verdict"], "violated");
    assert_eq!(requirement("R2")["verdict"], "holds");
    assert!(requirement("R2").get("remark").is_none());
    assert_eq!(requirement("R3")["verdict"], "holds");
    assert_eq!(requirement("R3")["remark"], "vacuously: it is never triggered");
    assert_eq!(requirement("R4")["verdict"], "not_on_the_model");
    assert_eq!(requirement("R5")["verdict"], "holds");
    assert_eq!(query("waits")["verdict"], "satisfied");
    assert_eq!(query("ends")["verdict"], "not_satisfied");
    assert_eq!(query("in_time")["verdict"], "satisfied");
    assert_eq!(query("served")["verdict"], "not_satisfied");
    assert_eq!(query("longest")["verdict"], "answered");
    let bounds: Vec<&str> =
        query("longest")["bounds"].as_array().unwrap().iter().map(|b| b.as_str().unwrap()).collect();
    assert_eq!(bounds, ["6 s", "3"]);
    // The second time is asked 2 s after the first at the earliest, and the obligation counts from the first.
    let run = &requirement("R1")["run"];
    let steps = run["steps"].as_array().unwrap();
    assert_eq!(steps.len(), 2, "{run:#}");
    assert!(run["end_nanos"].as_i64().unwrap() > 16_000_000_000, "{run:#}");
}

#[test]
fn some_can_be_chosen_and_asked() {
    let (out, one) = proved("--requirement R2 --query waits");
    expect_code(&out, 0);
    let network = &one["networks"][0];
    assert_eq!(network["requirements"].as_array().unwrap().len(), 1);
    assert_eq!(network["queries"].as_array().unwrap().len(), 1);
    let folder = folder(&[("door.hri", SCENARIO)]);
    let ask = |query: &str| {
        let mut command = support::command();
        command.current_dir(folder.path()).args(["prove", "door.hri", "--ask", query]);
        command.output().unwrap()
    };
    let out = ask("E<> Door.open && not Person.outside || opens == 3");
    expect_code(&out, 0);
    assert!(stdout(&out).contains("satisfied") && !stdout(&out).contains("R1"), "{}", stdout(&out));
    expect_code(&ask("E<> opens > 2 and Door.stuck and Door.x > 100 s"), 0);
    expect_code(&ask("A[] Person.x - Door.x < 0 s"), 3);
    let wrong = ask("E<> Door.opn");
    expect_code(&wrong, 1);
    assert!(stderr(&wrong).contains("did you mean `open`?"), "{}", stderr(&wrong));
    // The place is one of the command line.
    assert!(stderr(&wrong).contains("[--ask:1:10]"), "{}", stderr(&wrong));
    let mut two = support::command();
    two.current_dir(folder.path()).args([
        "prove",
        "door.hri",
        "--ask",
        "E<> Door.open",
        "--ask",
        "A[] not (",
    ]);
    let two = two.output().unwrap();
    expect_code(&two, 1);
    assert!(stderr(&two).contains("[--ask:2:"), "{}", stderr(&two));
}

#[test]
fn names_that_do_not_exist_are_said() {
    let folder = folder(&[("door.hri", SCENARIO)]);
    for (args, said) in [
        ("--requirement R9", "no requirement `R9`; the scenario has: R1, R2"),
        ("--query what", "no query `what`; the scenario has: waits"),
        ("--network home", "no network `home`; the scenario has: house"),
        ("--timeout 3parsecs", "no unit of time"),
        ("--budget-memory 2lots", "no unit of data"),
    ] {
        let out = hrdsl_in(folder.path(), &format!("prove door.hri {args}"));
        expect_code(&out, 2);
        assert!(stderr(&out).contains(said), "{}", stderr(&out));
    }
}

#[test]
fn what_the_budget_does_not_suffice_for_is_inconclusive() {
    let (out, rows) = proved("--requirement R2 --budget-states 2");
    expect_code(&out, 4);
    let r2 = row(&rows, "requirements", "R2");
    assert_eq!(
        (&r2["verdict"], &r2["remark"]),
        (&"inconclusive".into(), &"the budget of states was used up".into())
    );
    let (out, late) = proved("--timeout 0s --query served");
    expect_code(&out, 4);
    assert_eq!(row(&late, "queries", "served")["remark"], "the time was over");
}

#[test]
fn all_orders_witnesses_and_threads_agree() {
    let (_, usual) = proved("");
    let verdicts = |document: &Value| -> Vec<String> {
        let network = &document["networks"][0];
        let rows = ["requirements", "queries"].into_iter().flat_map(|k| network[k].as_array().unwrap());
        rows.map(|r| format!("{} {}", r["name"], r["verdict"])).collect()
    };
    for args in [
        "--order depth",
        "--order random --seed 7",
        "--order topological --threads 2",
        "--witness fastest",
        "--witness any --delays latest",
        "--delays sampled --seed 3",
    ] {
        let (out, other) = proved(args);
        expect_code(&out, 3);
        assert_eq!(verdicts(&usual), verdicts(&other), "{args}");
    }
    assert_eq!(proved("--delays sampled --seed 3").1, proved("--delays sampled --seed 3").1);
}

#[test]
fn a_run_is_told_and_drawn() {
    let folder = folder(&[("door.hri", SCENARIO)]);
    let line = "prove door.hri --requirement R1 --trace --mermaid run.mmd --dot run.dot";
    let out = hrdsl_in(folder.path(), line);
    expect_code(&out, 3);
    let text = stdout(&out);
    assert!(
        text.contains("R1  violated") && text.contains("asked(false)") && text.contains("10 s"),
        "{text}"
    );
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    assert!(read("run.mmd").starts_with("sequenceDiagram"), "{}", read("run.mmd"));
    assert!(read("run.dot").contains("digraph"), "{}", read("run.dot"));
}

#[test]
fn a_fault_of_the_model_is_told_with_the_way_to_it() {
    let broken = SCENARIO.replace("&& opens < 3", "&& opens < 4");
    let folder = folder(&[("door.hri", broken.as_str())]);
    let out = hrdsl_in(folder.path(), "prove door.hri --requirement R2 --json");
    expect_code(&out, 1);
    let all: Value = serde_json::from_slice(&out.stdout).unwrap();
    let r2 = row(&all, "requirements", "R2");
    assert_eq!(r2["verdict"], "fault_of_the_model");
    assert!(r2["remark"].as_str().unwrap().contains("`opens` becomes 4"), "{r2:#}");
    assert!(r2["run"]["steps"].as_array().unwrap().len() > 5, "{r2:#}");
}

#[test]
fn a_file_that_is_no_scenario_of_its_own_is_said_to_be_so() {
    let folder = folder(&[
        ("tests.hri", "scenario door\ntest one {\n  seed 1\n  knock\n}\n"),
        ("more.hri", "event knocked from person\n"),
    ]);
    for (file, what) in [
        (
            "tests.hri",
            "note: tests.hri holds tests, and no scenario that they are of: give the file in which it begins",
        ),
        (
            "more.hri",
            "note: more.hri holds declarations that are a part of a scenario: give the file in which it begins",
        ),
    ] {
        for command in ["prove", "export uppaal"] {
            let out = hrdsl_in(folder.path(), &format!("{command} {file}"));
            expect_code(&out, 1);
            assert!(stderr(&out).contains(what), "{}", stderr(&out));
        }
    }
}

#[test]
fn a_run_to_a_fault_of_the_model_ends_with_it() {
    let counts = "scenario counts\nautomaton A {\n clock x\n var n: 0..3 = 0\n init location a { invariant x <= 9 s }\n a -> a do n += 1\n}\n\
        network net = A\nquery q of net = E<> A.n == 4\n";
    let folder = folder(&[("counts.hri", counts)]);
    let out = hrdsl_in(folder.path(), "prove counts.hri --trace");
    expect_code(&out, 1);
    let text = String::from_utf8(out.stdout).unwrap();
    assert!(text.contains("0 s  what would happen next is the fault"), "{text}");
    let out = hrdsl_in(folder.path(), "prove counts.hri --json");
    let all: Value = serde_json::from_slice(&out.stdout).unwrap();
    let run = &row(&all, "queries", "q")["run"];
    assert_eq!(
        (run["steps"].as_array().unwrap().len(), &run["ending"]),
        (3, &Value::from("fault")),
        "{run:#}"
    );

    std::fs::write(folder.path().join("run.json"), &out.stdout).unwrap();
    let out = hrdsl_in(folder.path(), "prove counts.hri --follow run.json");
    expect_code(&out, 0);
    let text = String::from_utf8(out.stdout).unwrap();
    assert!(text.contains("a run of the network net (3 steps)\n  and then a fault of the model: "), "{text}");
    assert!(text.contains("`n` becomes 4, outside 0..3"), "{text}");

    std::fs::write(folder.path().join("counts.hri"), counts.replace("0..3 = 0", "0..4 = 0")).unwrap();
    let out = hrdsl_in(folder.path(), "prove counts.hri --follow run.json");
    expect_code(&out, 3);
    let text = String::from_utf8(out.stdout).unwrap();
    assert!(text.contains("it was recorded that a fault of the model is next, and none is"), "{text}");
}

#[test]
fn a_search_reaches_what_it_is_asked_for_and_keeps_few_tests() {
    let folder = folder(&[("door.hri", SCENARIO)]);
    let out = hrdsl_in(folder.path(), "gen door.hri --json");
    expect_code(&out, 0);
    let all: Value = serde_json::from_slice(&out.stdout).unwrap();
    let suite = &all["suites"][0];
    let goals = suite["goals"].as_array().unwrap();
    let goal = |name: &str| {
        goals.iter().find(|g| g["goal"] == name).unwrap_or_else(|| panic!("no {name}: {suite:#}"))
    };
    for reached in [
        "location Door.stuck",
        "edge pair Person: outside -> waiting (edge 1), waiting -> outside (edge 2)",
        "def-use pair of opens: set by Door: moving -> open (edge 3), read by Door: moving -> open (edge 4)",
        "violation of R1",
        "trigger of R1",
        "query waits",
    ] {
        assert_eq!(goal(reached)["status"], "reached", "{reached}");
        let test = goal(reached)["test"].as_str().unwrap();
        assert!(test.starts_with("all_of_it.t0"), "{test}");
    }
    for unreachable in [
        "violation of R2",
        "trigger of R3",
        "def-use pair of opens: its first value, read by Door: moving -> open (edge 4)",
    ] {
        assert_eq!(goal(unreachable)["status"], "unreachable", "{unreachable}");
        assert!(goal(unreachable).get("test").is_none());
    }
    assert!(goals.iter().all(|g| g["status"] != "inconclusive"));
    let reached = goals.iter().filter(|g| g["status"] == "reached").count() as u64;
    assert!(suite["abstract_tests"].as_u64().unwrap() < reached / 3, "{suite:#}");
    for args in ["--witness fastest", "--delays latest --order depth", "--threads 2"] {
        let out = hrdsl_in(folder.path(), &format!("gen door.hri --json {args}"));
        expect_code(&out, 0);
        let other: Value = serde_json::from_slice(&out.stdout).unwrap();
        let fates = |v: &Value| -> Vec<String> {
            let goals = v["suites"][0]["goals"].as_array().unwrap();
            goals.iter().map(|g| format!("{} {}", g["goal"], g["status"])).collect()
        };
        assert_eq!(fates(&all), fates(&other), "{args}");
    }
}

/// A robot that gives up while somebody is still reaching, which takes no time in the model.
const HELD: &str = "\
scenario reach

actor person : environment
actor robot  : system

event started  from person to robot
event finished from person to robot
event gave_up  from robot
event rang     from robot

stimulus reach by person { emit started; hold 2 s; emit finished }
stimulus leave by person { emit finished; hold 2 s }

automaton Person plays person {
  clock x
  init location idle
  location reaching { invariant x <= 5 s }
  idle     -> reaching do reach; x = 0
  reaching -> idle     when x >= 5 s do leave; x = 0
}

automaton Robot plays robot {
  clock x
  init location ready
  location busy
  location late
  location never
  ready -> busy  on started do x = 0
  busy  -> ready on finished
  busy  -> late  when x >= 1 s do gave_up
  late  -> never when x <= 1 s && x >= 3 s do rang
}

network table = Person | Robot

require R1 functional gave_up causes finished within 5 s
require R2 functional rang causes finished within 5 s

query late  of table = E<> Robot.late
query never of table = E<> Robot.never

suite found by search of table {
  reach each location
  reach trigger of R1
}
";

#[test]
fn what_only_a_hold_keeps_from_happening_is_said() {
    let folder = folder(&[("reach.hri", HELD)]);
    let run =
        |args: &str| stdout(&hrdsl_in(folder.path(), args)).split_whitespace().collect::<Vec<_>>().join(" ");
    let why = "a `hold` takes no time in automata: it would be reached if the holds of `reach` did; \
               without that, the nearest is Person doing `reach`, Robot in `busy`";
    let proved = run("prove reach.hri");
    // R1 and `late`, but neither R2 nor `never`.
    assert_eq!(proved.matches(why).count(), 2, "{proved}");
    let generated = run("gen reach.hri");
    assert!(generated.contains(&format!("location Robot.late: proved: none of the 5 symbolic states that the model can reach meets it; {why}")), "{generated}");
    assert!(
        generated.contains(&format!(
            "trigger of R1: proved: none of the 5 symbolic states that the model can reach meets it; {why}"
        )),
        "{generated}"
    );
    assert_eq!(generated.matches(why).count(), 2, "{generated}");
}

/// A lamp that is lit 2 s to 3 s after it was asked for, and somebody who goes 4 s to 5 s after asking.
const LAMP: &str = "\
scenario lamp
actor person : environment
actor robot  : system
event asked, gone from person to robot
event lit from robot
automaton Person plays person {
  clock x
  init location idle { invariant x <= 2 s }
  location waits { invariant x <= 5 s }
  location over
  idle -> waits when x >= 1 s do asked; x = 0
  waits -> over when x >= 4 s do gone
}
automaton Robot plays robot {
  clock y
  init location off
  location on { invariant y <= 3 s }
  location done
  off -> on on asked do y = 0
  on -> done when y >= 2 s do lit
}
network all = Person | Robot
require R1 functional asked causes lit not before 2 s within 3 s
require R2 functional asked causes lit not before 2500 ms
require R3 functional eventually lit within 3 s between asked and gone
require R4 functional eventually lit within 2500 ms between asked and gone
require R5 safety never lit before gone
require R6 safety exactly 1 lit after asked until gone
require R7 safety asked precedes lit within 2 s
require R8 functional eventually lit within 2 s
require R9 safety at most 0 lit after gone
";

#[test]
fn scopes_times_and_counts_are_proved() {
    let here = tempfile::tempdir().unwrap();
    std::fs::write(here.path().join("lamp.hri"), LAMP).unwrap();
    let out = hrdsl_in(here.path(), "prove lamp.hri");
    let text = stdout(&out);
    for (requirement, verdict) in [
        ("R1", "holds"),
        ("R2", "violated"),
        ("R3", "holds"),
        ("R4", "violated"),
        ("R5", "violated"),
        ("R6", "holds"),
        ("R7", "violated"),
        ("R8", "violated"),
        ("R9", "holds"),
    ] {
        let line = text.lines().find(|l| l.trim_start().starts_with(requirement));
        assert!(line.is_some_and(|l| l.contains(verdict)), "{requirement}: {verdict}\n{text}");
    }
    expect_code(&out, 3);
}
