//! `hrdsl gen` of suites that reach values together and bounds of time, and of several witnesses, through the binary.

mod support;

use std::fs;

use serde_json::Value;
use support::{expect_code, folder, hrdsl_in, stderr, stdout};

/// A robot that waits three seconds for a hand and a look.
const SCENARIO: &str = "\
scenario table

actor person : environment
actor robot  : system

event leg_request       from person to robot
event gripped(ok: bool) from person to robot
event offered           from robot to person
event given             from robot
event kept              from robot

stimulus ask_leg by person { emit leg_request }
stimulus grip(ok: bool) by person { emit gripped(ok) }
stimulus leave by person { hold 1 s }

agent Human plays person {
  goal !leg
  plan +!leg { ask_leg; await offered within 60 s; wait 2 s; grip(true) }
}
automaton Person plays person {
  clock t
  init location idle
  location asked
  location offered_
  idle     -> asked    do ask_leg
  asked    -> offered_ on offered do t = 0
  offered_ -> idle     select ok: bool when t >= 1 s do grip(ok)
}
automaton Robot plays robot {
  clock x
  var legs: 0..2 = 0
  var hold: bool = false
  init location idle
  location fetching { invariant x <= 5 s }
  location waiting  { invariant x <= 3 s }
  committed location decide
  idle     -> fetching on leg_request when legs < 2 do legs += 1; x = 0
  fetching -> waiting  when x == 5 s do offered; x = 0
  waiting  -> decide   on gripped(ok) do hold = ok
  waiting  -> idle     when x == 3 s do kept
  decide   -> idle     when hold do given
  decide   -> idle     when not hold do kept
}
network scene = Person | Robot

require R1 functional \"who holds in time gets it\" gripped(true) causes given within 2 s

suite edges by search of scene { reach each edge; tests 4 }
suite outcomes by search of scene {
  reach each combination of Robot.legs, Robot.hold when Robot.decide
  tests 6
}
suite beside by search of scene { reach each bound by 10 ms; tests 40 }
suite several by search of scene { reach each edge; diverse 3; tests 40 }
suite people by agents Human, Robot { reach each bound by 10 ms; tests 2 }
suite chance by random { stimuli ask_leg, grip; pause 0 s .. 4 s; boundary 1; tests 20 }
";

fn generated(folder: &std::path::Path, suite: &str, seed: &str) -> String {
    let out = hrdsl_in(folder, &format!("gen scenario.hri --suite {suite} --seed {seed} -o tests"));
    expect_code(&out, 0);
    fs::read_to_string(folder.join("tests").join(format!("{suite}.hri"))).unwrap()
}

/// The status of each goal.
fn goals(folder: &std::path::Path, suite: &str) -> Vec<(String, String)> {
    let out = hrdsl_in(folder, &format!("gen scenario.hri --suite {suite} -o tests --json"));
    expect_code(&out, 0);
    let json: Value = serde_json::from_str(&stdout(&out)).unwrap();
    let goals = json["suites"][0]["goals"].as_array().unwrap().clone();
    let text = |v: &Value| v.as_str().unwrap().to_owned();
    goals.iter().map(|g| (text(&g["goal"]), text(&g["status"]))).collect()
}

#[test]
fn values_together_have_a_witness_each() {
    let folder = folder(&[("scenario.hri", SCENARIO)]);
    let found = goals(folder.path(), "outcomes");
    let reached: Vec<&str> = found.iter().filter(|g| g.1 == "reached").map(|g| g.0.as_str()).collect();
    let name = |legs, hold| format!("combination Robot.legs = {legs}, Robot.hold = {hold} when Robot.decide");
    assert_eq!(reached, [name(1, false), name(1, true), name(2, false), name(2, true)]);
    assert!(found.iter().filter(|g| g.0.contains("legs = 0")).all(|g| g.1 == "unreachable"), "{found:?}");
    // The shortest witness of each edge never chooses a held leg after a refused one.
    let (few, all) = (generated(folder.path(), "edges", "0"), generated(folder.path(), "outcomes", "0"));
    assert!(all.matches("grip(true)").count() > few.matches("grip(true)").count(), "{all}");
}

#[test]
fn bounds_are_met_just_before_at_and_just_after() {
    let folder = folder(&[("scenario.hri", SCENARIO)]);
    let found = goals(folder.path(), "beside");
    let status = |name: &str| found.iter().find(|g| g.0 == name).map(|g| g.1.as_str());
    for side in ["just before", "at it", "just after"] {
        assert_eq!(status(&format!("bound Robot.waiting: x = 3 s, {side}")), Some("reached"), "{found:?}");
    }
    // Nobody acts while the robot fetches: the model's person waits.
    assert_eq!(status("bound Robot.fetching: x = 5 s, just before"), Some("unreachable"));
    assert_eq!(status("bound Person.offered_: t = 1 s, just before"), Some("unreachable"));
    assert_eq!(status("bound Person.offered_: t = 1 s, at it"), Some("reached"));
    let tests = generated(folder.path(), "beside", "0");
    for wait in ["wait 2.99 s", "wait 3 s", "wait 3.01 s", "wait 1 s", "wait 1.01 s"] {
        assert!(tests.contains(&format!("await offered within 60 s\n  {wait}\n  grip(")), "{wait}\n{tests}");
    }
    assert!(tests.contains("because \"witness of bound Robot.waiting: x = 3 s, just after\""), "{tests}");
}

#[test]
fn pauses_of_agents_are_made_shorter_and_longer() {
    let folder = folder(&[("scenario.hri", SCENARIO)]);
    let tests = generated(folder.path(), "people", "0");
    for wait in ["wait 2 s", "wait 1.99 s", "wait 2.01 s"] {
        assert!(tests.contains(wait), "{tests}");
    }
    assert!(tests.contains("just before the pause of 2 s before grip(true)"), "{tests}");
}

#[test]
fn pauses_at_random_are_put_beside_bounds() {
    let folder = folder(&[("scenario.hri", SCENARIO)]);
    let tests = generated(folder.path(), "chance", "3");
    let waits = tests.lines().filter_map(|line| line.trim().strip_prefix("wait "));
    let beside =
        ["0.1 s", "0.9 s", "1 s", "1.1 s", "1.9 s", "2 s", "2.1 s", "2.9 s", "3 s", "3.1 s", "3.9 s", "4 s"];
    let seen: std::collections::BTreeSet<&str> = waits.collect();
    assert!(seen.iter().all(|wait| beside.contains(wait)), "{seen:?}");
    assert_eq!(seen.len(), beside.len());
}

#[test]
fn further_witnesses_are_different_ones_and_the_same_every_time() {
    let folder = folder(&[("scenario.hri", SCENARIO)]);
    let bodies = |tests: &str| -> Vec<String> {
        let of = |test: &str| {
            let steps = test.lines().skip(1).filter(|l| !l.contains("seed ") && !l.contains("because "));
            steps.collect::<Vec<_>>().join("\n")
        };
        let mut all: Vec<String> = tests.split("\ntest ").skip(1).map(of).collect();
        all.sort();
        all.dedup();
        all
    };
    let (few, many) = (generated(folder.path(), "edges", "0"), generated(folder.path(), "several", "0"));
    assert!(bodies(&many).len() > bodies(&few).len(), "{many}");
    for suite in ["outcomes", "beside", "several", "people", "chance"] {
        let once = generated(folder.path(), suite, "7");
        assert_eq!(generated(folder.path(), suite, "7"), once, "{suite}");
    }
}

/// A tray is cleared by the robot in its own time, or when the cook calls it off; what is washed up then is one step further.
const TWO_WAYS: &str = "\
scenario kitchen
actor cook  : environment
actor robot : system
event order(plates: 1..3) from cook to robot
event enough              from cook to robot
event cleared             from robot to cook
event washed              from robot
stimulus call(plates: 1..3) by cook { emit order(plates) }
stimulus call_off by cook { emit enough }
automaton Cook plays cook {
  clock t
  init location free
  location waiting
  location content
  free    -> waiting select n: 1..3 do call(n); t = 0
  waiting -> content when t >= 2 s do call_off
  waiting -> content on cleared
}
automaton Robot plays robot {
  clock x
  init location ready
  location clearing { invariant x <= 9 s }
  location at_sink  { invariant x <= 9 s }
  location over
  ready    -> clearing on order do x = 0
  clearing -> at_sink  when x >= 5 s do cleared; x = 0
  clearing -> at_sink  on enough do x = 0
  at_sink  -> over     when x >= 1 s do washed
}
network scene = Cook | Robot
suite ways by search of scene { reach each location; diverse 4; tests 40 }
suite two by search of scene { reach each location; diverse 2; tests 40 }
";

#[test]
fn further_witnesses_go_other_ways_before_they_have_other_values() {
    let folder = folder(&[("scenario.hri", TWO_WAYS)]);
    for seed in ["0", "1", "2", "3"] {
        for suite in ["two", "ways"] {
            let tests = generated(folder.path(), suite, seed);
            let bodies: Vec<&str> = tests.split("\ntest ").skip(1).collect();
            assert!(bodies.iter().all(|test| test.contains("\n  call(")), "an empty test\n{tests}");
            let called_off = bodies.iter().position(|test| test.contains("\n  call_off"));
            assert_eq!(called_off, Some(1), "the other way comes first\n{tests}");
        }
        let ways = generated(folder.path(), "ways", seed);
        let args = ["call(1)", "call(2)", "call(3)"];
        assert!(
            args.iter().filter(|call| ways.contains(**call)).count() >= 2,
            "other values come later\n{ways}"
        );
    }
}

#[test]
fn what_holds_from_the_start_has_no_test_of_its_own() {
    let asked =
        "suite start by search of scene { reach each value of Cook.waiting; reach each location; tests 9 }
suite still by search of scene { reach each value of Cook.free when Cook.free && Robot.ready; tests 1 }
";
    let folder = folder(&[("scenario.hri", &format!("{TWO_WAYS}{asked}"))]);
    let tests = generated(folder.path(), "start", "0");
    assert!(tests.split("\ntest ").skip(1).all(|test| test.contains("\n  call(")), "{tests}");
    let out = hrdsl_in(folder.path(), "gen scenario.hri --suite start -o tests");
    let said = "  from the start, so in every test: value Cook.waiting = false, location Cook.free, location Robot.ready\n";
    assert!(stdout(&out).contains(said), "{}", stdout(&out));
    let out = hrdsl_in(folder.path(), "gen scenario.hri --suite start -o tests --json");
    let json: Value = serde_json::from_str(&stdout(&out)).unwrap();
    let goals = json["suites"][0]["goals"].as_array().unwrap();
    let initial = goals.iter().filter(|goal| goal["reason"] == "from the start, so in every test");
    let tests: Vec<&Value> = initial.map(|goal| &goal["test"]).collect();
    assert_eq!(tests, ["start.t001"; 3]);
    // Without any other test, one lets the robot alone.
    let still = generated(folder.path(), "still", "0");
    assert_eq!(still.matches("\ntest ").count(), 1, "{still}");
}

#[test]
fn what_cannot_be_asked_is_said_where_it_stands() {
    let asks =
        SCENARIO.replace("reach each combination of Robot.legs", "reach each combination of Robot.lesg");
    let folder = folder(&[("scenario.hri", &asks)]);
    let out = hrdsl_in(folder.path(), "gen scenario.hri");
    expect_code(&out, 1);
    let said = stderr(&out);
    assert!(
        said.contains("HR0101") && said.contains("lesg") && said.contains("did you mean `legs`?"),
        "{said}"
    );
    assert!(!folder.path().join("hrdsl-tests").exists());
}
