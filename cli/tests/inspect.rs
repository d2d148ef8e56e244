//! `hrdsl inspect`, and what `hrdsl gen` says of agents' reasoning.

mod support;

use std::{fs, process::Output};

use serde_json::Value;
use support::{command, expect_code, folder, handover, hrdsl, hrdsl_in, stderr, stdout, tree};
use tempfile::TempDir;

/// Two agents that talk.
fn kitchen() -> TempDir {
    folder(&[("scenario.hri", include_str!("reasoning/scenario.hri"))])
}

/// Of the example, with these arguments besides.
fn inspect(more: &[&str]) -> Output {
    let scenario = handover();
    let mut command = command();
    command.args(["inspect", "scenario.hri"]).args(more).current_dir(scenario.parent().unwrap());
    command.output().unwrap()
}

fn lines(out: &Output) -> Vec<Value> {
    stdout(out).lines().map(|l| serde_json::from_str(l).unwrap()).collect()
}

// ── What is shown ──

#[test]
fn messages_refused_plans_and_failures_are_told_with_their_places() {
    let here = kitchen();
    let out = hrdsl_in(here.path(), "inspect scenario.hri calm --set 2");
    expect_code(&out, 0);
    insta::assert_snapshot!("a_failing_goal", stdout(&out));
    let out = hrdsl_in(here.path(), "inspect scenario.hri calm --set 3 --from 0 --until 0");
    expect_code(&out, 0);
    insta::assert_snapshot!("a_plan_that_nobody_has", stdout(&out));
}

#[test]
fn the_example_with_beliefs_by_hand() {
    let beliefs = "wants(1), shows(1, true, false, true), Sensors.away";
    let given = ["--beliefs", beliefs, "--agent", "Human", "--until", "30 s"];
    let out = inspect(&given);
    expect_code(&out, 0);
    insta::assert_snapshot!("beliefs_by_hand", stdout(&out));
    let steps = stdout(&inspect(&[&given[..], &["--steps"]].concat()));
    assert!(
        !steps.contains("is not applicable")
            && steps.contains("→ show#4 (L = 1, G = true, P = false, X = true)")
    );
    assert_eq!(stdout(&inspect(&[&given[..], &["--reasons"]].concat())), stdout(&out));
}

#[test]
fn how_things_stand_at_a_time() {
    let given = ["--beliefs", "wants(1), shows(1, true, false, true), Sensors.away", "--agent", "Human"];
    let at = |time: &str, more: &[&str]| {
        let out = inspect(&[&given[..], &["--at", time], more].concat());
        expect_code(&out, 0);
        stdout(&out)
    };
    let text = at("5 s", &[]);
    insta::assert_snapshot!("at_a_time", text);
    // What stands in the log up to then is what is believed and intended then.
    let log = stdout(&inspect(&[&given[..], &["--until", "5 s"]].concat()));
    let last = log.rsplit("still to do").next().unwrap().lines().nth(1).unwrap();
    let stands = last.trim().strip_prefix("Human ").unwrap();
    assert!(text.contains(stands), "{stands}\n{text}");
    let json: Value = serde_json::from_str(&at("5 s", &["--json"])).unwrap();
    assert_eq!((&json["how"], &json["time"]), (&"under way".into(), &5_000_000_000_u64.into()));
    let place = json["agents"][0]["intentions"][0]["place"].as_str().unwrap();
    assert!(stands.contains(place), "{place}: {stands}");
    // A time after the end is the end.
    let end = stdout(&inspect(&[&given[..], &["--end"]].concat()));
    assert_eq!(at("1000 s", &[]), end);
    let out = inspect(&["--at", "5 s", "--end"]);
    expect_code(&out, 2);
}

#[test]
fn beliefs_by_hand_are_those_of_a_set() {
    let here = kitchen();
    let of = |line: &str| {
        let out = hrdsl_in(here.path(), &format!("inspect scenario.hri calm {line} --json"));
        expect_code(&out, 0);
        stdout(&out)
    };
    assert_eq!(of("--beliefs hungry(2)"), of("--set 2"));
    assert_ne!(of("--beliefs hungry(1)"), of("--set 2"));
    assert_ne!(of("--beliefs hungry(1),hungry(2)"), of("--beliefs hungry(2),hungry(1)"), "in their order");
}

#[test]
fn a_livelock_is_an_error_and_its_log_is_folded() {
    let here = kitchen();
    let out = hrdsl_in(here.path(), "inspect scenario.hri meals --set 2");
    expect_code(&out, 1);
    let (text, end) =
        (stdout(&out), "the end, at 0 s: livelock (agent `Guest`: at one instant its state repeats");
    assert!(text.contains(end) && text.contains(" cycles (--all shows them)\n"), "{text}");
    assert!(text.contains("\n       livelock\n"));
    assert!(text.lines().count() < 300);
    let all = hrdsl_in(here.path(), "inspect scenario.hri meals --set 2 --all");
    expect_code(&all, 1);
    assert!(stdout(&all).lines().count() > 3000);

    let end = hrdsl_in(here.path(), "inspect scenario.hri meals --set 2 --end --json");
    expect_code(&end, 1);
    let end: Value = serde_json::from_slice(&end.stdout).unwrap();
    assert_eq!((&end["how"], &end["time"]), (&Value::from("livelock"), &Value::from(0)));
    assert_eq!(end["agents"][0]["beliefs"][1], "dizzy[source(self)]");
}

/// The sets are those that the suite tries, also if its choices have conditions.
#[test]
fn a_set_is_one_that_the_conditions_allow() {
    let picky = include_str!("reasoning/scenario.hri").replace(
        "choose one hungry of Guest\n  choose any",
        "choose one hungry of Guest where hungry(C) && C > 1\n  choose any",
    );
    let here = folder(&[("scenario.hri", &picky)]);
    let out = hrdsl_in(here.path(), "inspect scenario.hri meals --set 1 --end");
    assert!(stdout(&out).contains("beliefs: hungry(2)\n"), "{}", stdout(&out));
    let listed = hrdsl_in(here.path(), "inspect scenario.hri");
    expect_code(&listed, 2);
    let text = stdout(&listed) + &stderr(&listed);
    assert!(text.contains("meals: 4 of 6 belief sets"), "{text}");
}

#[test]
fn the_bound_of_cycles_is_an_error_too() {
    let spin = include_str!("reasoning/scenario.hri").replace(
        "plan @round +!spin { !!spin }",
        "belief turns(n: int) = turns(0)\n  plan @round +!spin { ?turns(N); -+turns(N + 1); !!spin }",
    );
    let here = folder(&[("scenario.hri", &spin)]);
    let out = hrdsl_in(here.path(), "inspect scenario.hri meals --set 2 --end");
    expect_code(&out, 1);
    let text = stdout(&out);
    assert!(text.contains("the end, at 0 s: cycle bound (agent `Guest`: more than 1000000 cycles"), "{text}");
    assert!(!text.contains(" entries of the log are left out"), "none are shown: {text}");
    let steps = stdout(&hrdsl_in(here.path(), "inspect scenario.hri meals --set 2 --steps"));
    assert!(steps.contains(" entries of the log are left out"), "{steps}");
}

#[test]
fn the_end_says_what_is_waited_for_and_believed() {
    let out = inspect(&["--set", "2", "--end"]);
    expect_code(&out, 0);
    let text = stdout(&out);
    assert!(text.starts_with("handover, suite bdi_tests, belief set 2\n  beliefs: wants("), "{text}");
    assert!(
        text.contains("\nthe end, at ") && text.contains("\n  Sensors\n    intends nothing\n    believes\n")
    );
    assert!(!text.contains("round "), "{text}");
}

/// A hundred thousand plans on one stack are told by their ends.
#[test]
fn high_stacks_are_shortened() {
    let scenario = "scenario deep\nactor clerk : environment\nagent Clerk plays clerk {\n  goal !go(0)\n  \
        plan +!go(N) when N < 100000 { !go(N + 1); .print(N) }\n  plan +!go(_) { wait 100 s }\n}\n\
        suite s by agents Clerk { tests 1; horizon 50 s }\n";
    let here = folder(&[("deep.hri", scenario)]);
    let out = hrdsl_in(here.path(), "inspect deep.hri --end --json");
    expect_code(&out, 0);
    let end: Value = serde_json::from_str(&stdout(&out)).unwrap();
    let plans = end["agents"][0]["intentions"][0]["plans"].as_array().unwrap();
    let at = |i: usize| plans[i].as_str().unwrap();
    assert_eq!((plans.len(), at(0), at(7), at(8)), (17, "go#1(0)", "go#1(7)", "(99985 more)"));
    assert_eq!((at(9), at(16), end["left_out"].as_u64()), ("go#1(99993)", "go#2(100000)", Some(0)));
}

#[test]
fn one_agent_and_some_time() {
    let all = lines(&inspect(&["--set", "2", "--json"]));
    let some =
        lines(&inspect(&["--set", "2", "--json", "--agent", "Human", "--from", "5 s", "--until", "2min"]));
    let wanted = |l: &&Value| {
        l["agent"] == "Human" && (5_000_000_000..=120_000_000_000).contains(&l["time"].as_i64().unwrap())
    };
    assert!(!some.is_empty() && some.len() < all.len());
    assert_eq!(some, all.iter().filter(wanted).cloned().collect::<Vec<_>>());
}

#[test]
fn lines_of_json_say_all() {
    let here = kitchen();
    let all = lines(&hrdsl_in(here.path(), "inspect scenario.hri calm --set 2 --json"));
    let of = |kind: &str| all.iter().filter(|l| l["kind"] == kind).collect::<Vec<_>>();
    assert_eq!(of("tried")[0]["event"], "+!eat");
    assert_eq!(of("tried")[0]["text"], "+!eat: wise is not applicable, `patient` has no answer");
    assert_eq!(of("heard")[0]["text"], "hears achieve serve(2) from Guest");
    let failed = of("failed");
    assert_eq!((failed[0]["agent"].as_str(), failed[1]["agent"].as_str()), (Some("Robot"), Some("Guest")));
    assert_eq!(failed[1]["text"], "#1 failed !get(2) in get#1: the time is over");
    assert_eq!(failed[1]["place"], "scenario.hri:23:30");
    assert!(all.is_sorted_by_key(|l| l["time"].as_i64()), "in the order of time");
}

#[test]
fn colours_are_for_terminals() {
    assert!(!stdout(&inspect(&[])).contains('\u{1b}'));
    assert!(stdout(&inspect(&["--color", "always"])).contains("\u{1b}[36m+!table\u{1b}[0m"));
}

// ── Which run ──

#[test]
fn without_a_name_the_only_suite_is_shown_or_all_are_listed() {
    expect_code(&inspect(&["--end"]), 0);
    let here = kitchen();
    let out = hrdsl_in(here.path(), "inspect scenario.hri");
    expect_code(&out, 2);
    let wanted = "the suites by agents are:\n  calm: 3 of 3 belief sets\n  meals: 6 of 6 belief sets\nhelp: hrdsl inspect scenario.hri calm --set 1\n";
    assert!(stderr(&out).ends_with(wanted), "{}", stderr(&out));
}

#[test]
fn what_does_not_exist_is_named_with_what_does() {
    for (args, reason) in [
        (&["nope"][..], "no suite or test `nope`"),
        (&["ta_tests"], "suite `ta_tests` is not by agents"),
        (&["bdi_tests.t999"], "no test `bdi_tests.t999`: the suite has 160"),
        (&["--test", "bdi_tests"], "no test `bdi_tests`: write it like `SUITE.t001`"),
        (&["--set", "161"], "suite `bdi_tests` has no belief set 161: it has 160"),
        (&["--agent", "Robot"], "no agent `Robot` in the suite; it has: Human, Sensors"),
        (&["bdi_tests.t001", "--set", "2"], "a test has its beliefs"),
        (&["--until", "1 h"], "no unit `h`"),
        (&["--set", "2", "--beliefs", "wants(1)"], "cannot be used with"),
        (&["--beliefs", "wnts(1)"], "no belief `wnts`; the suite's agents have: Human.wants, "),
        (&["--beliefs", "wants(9)"], "--beliefs: `wants(9)`: 9 is outside 0..4"),
        (&["--beliefs", "Sensors.wants(1)"], "no belief `wants`; the suite's agents have: Sensors.away"),
        (&["--beliefs", "Robot.wants(1)"], "no agent `Robot` in the suite; it has: Human, Sensors"),
        (&["--beliefs", "wants(1"], "something that is not closed"),
        (&["--beliefs", "wants(1),"], "something that is no belief"),
    ] {
        let out = inspect(args);
        expect_code(&out, 2);
        assert!(stderr(&out).contains(reason), "{args:?}: {}", stderr(&out));
    }
    let out = hrdsl_in(kitchen().path(), "inspect scenario.hri calm --beliefs dizzy");
    expect_code(&out, 2);
    assert!(
        stderr(&out).contains("several agents have `dizzy`: write `Guest.dizzy` or `Robot.dizzy`"),
        "{}",
        stderr(&out)
    );
}

// ── gen ──

/// The run of a test is that which its trace shows, and starts with the beliefs that the test says it came from.
#[test]
fn traces_are_the_runs_that_tests_came_from() {
    let here = tempfile::tempdir().unwrap();
    let (scenario, out) = (handover(), here.path().join("tests"));
    let line = "gen scenario.hri --suite bdi_tests -n 30 --seed 5 --trace -o";
    let args = line.split(' ').chain([out.to_str().unwrap()]);
    let run = command().args(args).current_dir(scenario.parent().unwrap()).output().unwrap();
    expect_code(&run, 0);
    let files = tree(&out);
    assert_eq!(files.len(), 32, "those, the tests and the mark of results");
    let tests = String::from_utf8(files["bdi_tests.hri"].clone()).unwrap();
    for name in ["t001", "t017"] {
        let log = String::from_utf8(files[&format!("bdi_tests.traces/{name}.log")].clone()).unwrap();
        let test = format!("bdi_tests.{name}");
        for by in [&[test.as_str()][..], &["--test", &test], &[&format!("handover.{test}")]] {
            let shown = inspect(&[by, &["--all", "-n", "30", "--seed", "5"]].concat());
            expect_code(&shown, 0);
            assert_eq!(stdout(&shown), log, "{by:?}");
        }
        let of_it = tests.split(&format!("\ntest {test} ")).nth(1).unwrap();
        let beliefs = log.lines().nth(1).unwrap().trim().strip_prefix("beliefs: ").unwrap();
        assert!(of_it.split("\ntest ").next().unwrap().contains(beliefs), "{beliefs}\n{of_it}");
    }
}

#[test]
fn traces_are_the_same_with_any_number_of_threads() {
    let here = kitchen();
    let make = |threads: &str, line: &str| {
        let mut command = command();
        command.current_dir(here.path()).env("RAYON_NUM_THREADS", threads);
        let out = command.args(line.split(' ')).output().unwrap();
        expect_code(&out, 0);
        (stdout(&out), tree(here.path()))
    };
    let line = "gen scenario.hri --suite calm --trace -o tests";
    let one = make("1", line);
    assert_eq!(one, make("4", line));
    assert_eq!(one.1.keys().filter(|k| k.starts_with("tests/calm.traces/t")).count(), 5);
    // A later generation of fewer tests leaves none of the earlier ones.
    let fewer = make("2", &format!("{line} -n 2 --json"));
    let traces: Vec<&String> = fewer.1.keys().filter(|k| k.contains(".traces/")).collect();
    assert_eq!(traces, ["tests/calm.traces/t001.jsonl", "tests/calm.traces/t002.jsonl"]);
    let document: Value = serde_json::from_str(&fewer.0).unwrap();
    let test = &document["suites"][0]["tests"][1];
    assert_eq!((&test["set"], &test["trace"]), (&Value::from(2), &Value::from(traces[1].as_str())));
    let shown = hrdsl_in(here.path(), "inspect scenario.hri calm.t002 -n 2 --json");
    assert_eq!(shown.stdout, fewer.1[traces[1]]);
}

#[test]
fn what_tests_are_for_is_explained() {
    let here = kitchen();
    let out = hrdsl_in(here.path(), "gen scenario.hri --suite calm --explain");
    expect_code(&out, 0);
    let text = stdout(&out);
    assert!(
        text.contains("\n  calm.t001  reaches ")
            && text.contains("\nGoals that no test reaches\n  plan Guest.wise\n"),
        "{text}"
    );
    let plain = stdout(&hrdsl_in(here.path(), "gen scenario.hri --suite calm"));
    assert!(text.starts_with(plain.as_str()) && !plain.contains("reaches"), "{plain}");

    let out = hrdsl_in(here.path(), "gen scenario.hri --suite calm --json");
    expect_code(&out, 0);
    let document: Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!((document["format"].as_str(), document["version"].as_i64()), (Some("hrdsl-gen"), Some(2)));
    let suite = &document["suites"][0];
    let uncovered = suite["explanation"]["uncovered"].as_array().unwrap();
    assert!(uncovered.iter().any(|u| u["goal"] == "plan Guest.wise" && u["reason"] != ""), "{suite}");
    assert_eq!(suite["tests"].as_array().unwrap().len(), 5);
}

#[test]
fn suites_are_minimised_on_request() {
    let (here, scenario) = (tempfile::tempdir().unwrap(), handover());
    let count = |more: &[&str]| {
        let args = ["gen", scenario.to_str().unwrap(), "--suite", "bdi_tests", "--json", "-o"];
        let args = args.into_iter().chain([here.path().to_str().unwrap()]).chain(more.iter().copied());
        let out = hrdsl(args);
        expect_code(&out, 0);
        let document: Value = serde_json::from_slice(&out.stdout).unwrap();
        document["suites"][0]["tests"].as_array().unwrap().len()
    };
    assert_eq!(count(&[]), 160);
    let few = count(&["--minimise"]);
    assert!(few > 2 && few < 80, "{few}");
    let text = fs::read_to_string(here.path().join("bdi_tests.hri")).unwrap();
    assert_eq!(text.matches("\ntest ").count(), few);
    let last = format!("bdi_tests.t{few:03}");
    expect_code(&inspect(&[&last, "--minimise", "--end"]), 0);
    let beyond = format!("bdi_tests.t{:03}", few + 1);
    expect_code(&inspect(&[&beyond, "--minimise", "--end"]), 2);
}

#[test]
fn too_few_tests_for_all_pairs_are_warned_of() {
    let (here, scenario) = (tempfile::tempdir().unwrap(), handover());
    let out = here.path().join("out");
    let args = [scenario.to_str().unwrap(), "--suite", "bdi_tests", "-n", "2", "-o", out.to_str().unwrap()];
    let with = |first: &str, last: &str| {
        let out = hrdsl([first].into_iter().chain(args).chain([last]));
        expect_code(&out, 0);
        out.stdout
    };
    let document: Value = serde_json::from_slice(&with("gen", "--json")).unwrap();
    let suite = &document["suites"][0];
    let lost = &suite["lost_tuples"];
    let number = |name: &str| lost[name].as_u64().unwrap();
    assert_eq!(number("strength"), 2);
    assert!(0 < number("lost") && number("lost") < number("all") && number("needed") > 2, "{lost}");
    let warning = format!(
        "warning: {} of {} pairs of alternatives are in none of the 2 tests; `tests {}` is enough for all",
        lost["lost"], lost["all"], lost["needed"]
    );
    assert!(suite["notes"].as_array().unwrap().iter().any(|note| *note == warning), "{suite}");
    let said = with("sim", "--exit-zero");
    assert!(String::from_utf8(said).unwrap().contains(&warning));
    let enough = lost["needed"].to_string();
    let args = ["gen", args[0], args[1], args[2], "-n", &enough, "-o", args[6], "--json"];
    let document: Value = serde_json::from_slice(&hrdsl(args).stdout).unwrap();
    assert!(document["suites"][0].get("lost_tuples").is_none(), "{document}");
}
