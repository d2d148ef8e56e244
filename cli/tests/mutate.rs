//! `hrdsl mutate`: small tests of a small program, and what they notice of its mutants.

#![allow(clippy::disallowed_methods, reason = "tests read what the command wrote")]

mod support;

use std::{
    fs,
    io::{BufRead as _, BufReader},
    path::Path,
    process::{Command, Output, Stdio},
    time::Duration,
};

use serde_json::{Value, json};
use support::{command, expect_code, root, stderr, stdout};

/// A copy of the scenario, so that nothing is left in the sources.
fn project() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for name in ["scenario.hri", "tests.hri", "robot.py", "elsewhere.py"] {
        fs::copy(root().join("cli/tests/mutate").join(name), folder.path().join(name)).unwrap();
    }
    folder
}

fn mutate(folder: &Path, line: &str) -> Output {
    let mut command = command();
    command.args(["mutate", "scenario.hri"]).args(line.split_whitespace());
    command.current_dir(folder).output().unwrap()
}

fn report(out: &Output) -> Value {
    serde_json::from_str(&stdout(out)).unwrap_or_else(|e| panic!("{e}: {}", stderr(out)))
}

/// The mutant of a line with this change.
fn mutant<'r>(report: &'r Value, line: u64, what: &str) -> &'r Value {
    let all = report["mutants"].as_array().unwrap();
    let found = all.iter().find(|m| m["line"] == line && m["what"] == what);
    found.unwrap_or_else(|| panic!("no mutant of line {line}: {what}"))
}

#[test]
fn each_fate_is_told_and_what_would_notice_a_survivor() {
    let folder = project();
    let before = fs::read(folder.path().join("robot.py")).unwrap();
    let out = mutate(folder.path(), "tests.hri -j 2 --json -o out");
    expect_code(&out, 0);
    assert!(stderr(&out).contains("30 mutants to run, at most 60 runs"), "{}", stderr(&out));
    let found = report(&out);
    let sentinel = &found["sentinels"][0];
    assert_eq!((&sentinel["fate"], &sentinel["ran"]), (&json!("killed"), &json!(1)));
    assert!(sentinel["noticed"][0]["error"].as_str().unwrap().ends_with("the sentinel mutant ends at once"));

    let killed = mutant(&found, 23, "emit is not called");
    assert_eq!(killed["fate"], "killed");
    assert_eq!(
        killed["noticed"],
        json!([{ "test": "lamp.once", "oracles": ["requirement R1"], "method": "hand" }])
    );
    assert_eq!((&killed["reached"], &killed["ran"]), (&json!(2), &json!(1)), "until the first kill");

    let late = mutant(&found, 5, "the time is doubled");
    assert_eq!(late["fate"], "survived");
    let difference = &late["difference"];
    assert_eq!((&difference["test"], &difference["time"]), (&json!("lamp.once"), &json!(0.5)));
    assert_eq!(difference["original"], "robot lit at 0.500 s");
    assert_eq!(difference["mutant"], "robot lit at 1.000 s");
    assert_eq!(late["proposals"][0]["pattern"], "asked causes lit within 0.6 s");
    let early = mutant(&found, 5, "the time is halved");
    assert_eq!(early["proposals"][0]["pattern"], "asked causes lit not before 0.4 s within 0.6 s");
    let twice = mutant(&found, 23, "emit is called twice");
    assert_eq!(twice["proposals"][0]["pattern"], "lit forbids lit until asked");

    let unseen = mutant(&found, 10, "emit is not called");
    assert_eq!((&unseen["fate"], &unseen["reached"]), (&json!("not_reached"), &json!(0)));
    assert_eq!(mutant(&found, 19, "the check is always False")["fate"], "not_distinguished");
    let counts = json!({
        "killed": 14, "survived": 15, "not_distinguished": 1, "not_reached": 14,
        "permissive": 0, "equivalent": 0, "duplicate": 3, "invalid": 0, "not_run": 0,
    });
    assert_eq!(found["counts"], counts);
    assert_eq!(found["score"], json!(14.0 / 43.0));
    assert_eq!(found["methods"][0]["killed"], 14);

    let written = fs::read_to_string(folder.path().join("out/mutation.json")).unwrap();
    assert_eq!(written, stdout(&out));
    let text = fs::read_to_string(folder.path().join("out/mutation.txt")).unwrap();
    assert!(text.contains("would notice in lamp.once at 0.600 s: asked causes lit within 0.6 s"), "{text}");
    assert_eq!(fs::read(folder.path().join("robot.py")).unwrap(), before, "no file is written");
}

/// A requirement that was proposed notices the mutant that it was proposed for, and the score says so.
#[test]
fn the_report_of_a_campaign_says_which_faults_each_requirement_noticed() {
    let folder = project();
    expect_code(&mutate(folder.path(), "tests.hri -j 2 -o mutated"), 0);
    let hrdsl = |line: &str| {
        let mut command = command();
        command.args(line.split_whitespace()).current_dir(folder.path()).output().unwrap()
    };
    let page = || fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    expect_code(&hrdsl("sim scenario.hri tests.hri --exit-zero -o out"), 0);
    assert!(page().contains("Whether a requirement would notice a fault"), "and how to find out");
    expect_code(&hrdsl("report out --mutants mutated"), 0);
    let with = page();
    assert!(with.contains("<a href=\"#faults\">noticed 8 of 43 faults</a>"), "R1's");
    for text in [
        "14 of 43 faults noticed.",
        "robot.py:23</span> dropped: <code>emit is not called</code> <small>lamp.once</small>",
        "would notice it: <code>asked causes lit within 0.6 s</code>",
        "no test executes it",
        "the same as the original’s in 1 more fault",
    ] {
        assert!(with.contains(text), "{text}");
    }
    expect_code(&hrdsl("report out"), 0);
    assert_eq!(page(), with, "they are kept with the results");
    expect_code(&hrdsl("sim scenario.hri tests.hri --exit-zero -o out"), 0);
    assert!(!page().contains("id=\"faults\""), "another campaign has its own");

    let found = fs::read_to_string(folder.path().join("mutated/mutation.json")).unwrap();
    let refused = |text: &str, why: &str| {
        fs::write(folder.path().join("bad.json"), text).unwrap();
        let out = hrdsl("report out --mutants bad.json");
        expect_code(&out, 2);
        assert!(stderr(&out).contains(why), "{}", stderr(&out));
    };
    refused(&found.replace("\"version\": 1", "\"version\": 9"), "`hrdsl-mutation` of version 9");
    refused(&found.replacen("\"scenario\": \"", "\"scenario\": \"x", 1), "the results are of `lamp`");
    refused(&found[..found.len() / 2], "bad.json: ");
    refused("{}", "this is `` of version 0");
}

/// Survivors with what is proposed first for each, as requirements of the scenario.
fn proposed(found: &Value) -> Vec<(&Value, String)> {
    let mutants = found["mutants"].as_array().unwrap();
    let first = |mutant: &Value| Some(mutant["proposals"][0]["pattern"].as_str()?.to_owned());
    mutants.iter().filter_map(|mutant| Some((mutant, first(mutant)?))).collect()
}

/// Every requirement that is proposed first is one that `check` accepts, keeps the tests of the original as they are, and notices its mutant.
fn expect_deaths(folder: &Path, found: &Value) {
    let path = folder.join("scenario.hri");
    let mut text = fs::read_to_string(&path).unwrap();
    let all = proposed(found);
    for (at, (_, pattern)) in all.iter().enumerate() {
        text += &format!("\nrequire Proposed{at} functional {pattern}\n");
    }
    fs::write(&path, text).unwrap();
    let check = command().args(["check", "scenario.hri"]).current_dir(folder).output().unwrap();
    expect_code(&check, 0);
    let again = report(&mutate(folder, "tests.hri --json --matrix"));
    assert_eq!(again["failing"], found["failing"], "the original keeps what is proposed");
    for (at, (survivor, pattern)) in all.iter().enumerate() {
        let now = mutant(&again, survivor["line"].as_u64().unwrap(), survivor["what"].as_str().unwrap());
        let oracle = json!(format!("requirement Proposed{at}"));
        let in_test = |noticed: &Value| {
            noticed["test"] == survivor["proposals"][0]["test"]
                && noticed["oracles"].as_array().unwrap().contains(&oracle)
        };
        assert_eq!(now["fate"], "killed", "{pattern}: {now}");
        assert!(now["noticed"].as_array().unwrap().iter().any(in_test), "{pattern}: {now}");
    }
}

#[test]
fn what_is_proposed_notices() {
    let folder = project();
    let found = report(&mutate(folder.path(), "tests.hri --json"));
    assert_eq!(proposed(&found).len(), 12, "all survivors but the three that only end at another time");
    expect_deaths(folder.path(), &found);
}

/// What the lamp does depends on the colour that it is asked for. In the shorter test a mutant shows nothing that a requirement can speak of.
#[test]
fn what_is_proposed_speaks_of_arguments_and_is_tried_in_several_runs() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = "
scenario lamp
actor person : environment
actor robot  : system
enum Colour { red, green }
event asked(colour: Colour) from person to robot
event lit from robot
event refused(after: float) from robot
stimulus ask(colour: Colour) by person { emit asked(colour); hold 3 s }
require R1 safety asked(_) precedes lit
system robot { run \"python3 robot.py\"; limit 20 s }
";
    let robot = "
import hrdsl

WARM_UP_TIME = 0.5  # seconds
node = hrdsl.Node(\"robot\")
while True:
    event = node.wait_for(\"asked\", timeout=10.0)
    if event is None:
        break
    if event.args[\"colour\"] == \"red\":
        node.sleep(WARM_UP_TIME)
        node.emit(\"lit\")
    else:
        node.emit(\"refused\", after=WARM_UP_TIME)
";
    let tests = "scenario lamp\ntest green { ask(green) }\ntest red { ask(red) }\n";
    for (name, text) in [("scenario.hri", scenario), ("robot.py", robot), ("tests.hri", tests)] {
        fs::write(folder.path().join(name), text).unwrap();
    }
    let found = report(&mutate(folder.path(), "tests.hri --json"));
    let late = mutant(&found, 4, "the time is doubled");
    assert_eq!((&late["fate"], &late["difference"]["test"]), (&json!("survived"), &json!("lamp.green")));
    let proposals = late["proposals"].as_array().unwrap();
    let first = json!({ "pattern": "asked(red) causes lit within 0.6 s", "time": 0.6, "test": "lamp.red" });
    assert_eq!(proposals[0], first);
    let other = mutant(&found, 10, "the condition is negated");
    let patterns: Vec<&str> =
        other["proposals"].as_array().unwrap().iter().map(|p| p["pattern"].as_str().unwrap()).collect();
    assert!(patterns.contains(&"asked(green) causes refused(_) within 0.1 s"), "{patterns:?}");
    let one = report(&mutate(folder.path(), "tests.hri --test red --json"));
    let new = &mutant(&one, 10, "the condition is negated")["proposals"][0]["pattern"];
    assert_eq!(*new, "never refused(_) after asked(_)", "it says something of the original");
    expect_deaths(folder.path(), &found);
}

#[test]
fn the_number_of_workers_changes_nothing_and_a_seed_draws_the_same() {
    let folder = project();
    let run = |line: &str| {
        let out = mutate(folder.path(), &format!("tests.hri --sample 8 --json {line}"));
        expect_code(&out, 0);
        stdout(&out)
    };
    let one = run("--seed 1 -j 1");
    assert_eq!(one, run("--seed 1 --workers 2"));
    assert_eq!(one, run("--seed 1 -j 2 --isolation copies --no-fork"), "nor how interpreters are started");
    assert_ne!(one, run("--seed 2"));
    let found: Value = serde_json::from_str(&one).unwrap();
    assert_eq!((&found["worth"], &found["drawn"]), (&json!(44), &json!(8)));
}

#[test]
fn a_matrix_runs_all_tests_that_reach_a_mutant() {
    let folder = project();
    let out = mutate(folder.path(), "tests.hri --matrix --json --operator dropped");
    expect_code(&out, 0);
    assert!(stderr(&out).contains(" mutants to run, 6 runs: about "), "{}", stderr(&out));
    let found = report(&out);
    let killed = mutant(&found, 23, "emit is not called");
    let tests: Vec<&str> =
        killed["noticed"].as_array().unwrap().iter().map(|n| n["test"].as_str().unwrap()).collect();
    assert_eq!((tests, &killed["ran"]), (vec!["lamp.once", "lamp.twice"], &json!(2)));
}

#[test]
fn tests_that_measure_nothing_end_with_an_error() {
    let folder = project();
    let out = mutate(folder.path(), "tests.hri --system elsewhere");
    expect_code(&out, 3);
    assert!(stderr(&out).contains("no test notices that robot.py raises at once"), "{}", stderr(&out));
    assert!(stdout(&out).contains("the sentinel of robot.py is noticed by nothing"), "{}", stdout(&out));
}

/// The code's runs contradict a model that allows less than the code does, and none that allows more.
#[test]
fn mutants_of_the_model_are_contradicted_by_what_the_code_does() {
    let folder = project();
    let path = folder.path().join("scenario.hri");
    let text = fs::read_to_string(&path).unwrap();
    let model = "
automaton Lamp plays robot {
  clock t
  init location dark
  location warm { invariant t <= 1 s }
  location mending
  dark -> warm on asked do t = 0
  warm -> dark when t >= 300 ms do lit
  dark -> mending on broke do t = 0
  mending -> dark when t >= 500 ms do mended
}
";
    fs::write(&path, text + model).unwrap();
    let out = mutate(folder.path(), "tests.hri --models --json");
    expect_code(&out, 0);
    assert!(stderr(&out).contains("2 of 2 runs conform to the models as they are"), "{}", stderr(&out));
    let found = report(&out);
    let fates: Vec<(&str, &str)> = found["mutants"]
        .as_array()
        .unwrap()
        .iter()
        .map(|m| (m["what"].as_str().unwrap(), m["fate"].as_str().unwrap()))
        .collect();
    let expected = [
        // Light after 600 ms would show it: the code always takes 500 ms.
        ("Lamp.warm: the bound of 1 s is halved", "survived"),
        ("Lamp.warm: the bound of 1 s is doubled", "permissive"),
        ("Lamp.warm: the bound of 1 s is left out", "permissive"),
        ("Lamp: dark -> warm: the edge is never taken", "killed"),
        ("Lamp: warm -> dark: the bound of 0.3 s is halved", "permissive"),
        ("Lamp: warm -> dark: the bound of 0.3 s is doubled", "killed"),
        ("Lamp: warm -> dark: the bound of 0.3 s is turned round", "killed"),
        ("Lamp: warm -> dark: the bound of 0.3 s is left out", "permissive"),
        ("Lamp: warm -> dark: the edge is never taken", "killed"),
        // No lamp breaks in these tests.
        ("Lamp: dark -> mending: the edge is never taken", "not_reached"),
        ("Lamp: mending -> dark: the bound of 0.5 s is halved", "not_reached"),
        ("Lamp: mending -> dark: the bound of 0.5 s is doubled", "not_reached"),
        ("Lamp: mending -> dark: the bound of 0.5 s is turned round", "not_reached"),
        ("Lamp: mending -> dark: the bound of 0.5 s is left out", "not_reached"),
        ("Lamp: mending -> dark: the edge is never taken", "not_reached"),
    ];
    assert_eq!(fates, expected);
    assert_eq!(found["oracles"][0]["oracle"], "conformance");
    assert_eq!(found["score"], json!(4.0 / 11.0), "what is permissive is no part of it");
    let reached = |what: &str| {
        let all = found["mutants"].as_array().unwrap();
        all.iter().find(|m| m["what"] == what).map(|m| (m["reached"].as_u64(), m["ran"].as_u64())).unwrap()
    };
    assert_eq!(reached("Lamp.warm: the bound of 1 s is doubled"), (Some(2), Some(2)));
    assert_eq!(reached("Lamp: mending -> dark: the edge is never taken"), (Some(0), Some(2)));
    assert_eq!(found["sentinels"][0]["fate"], "killed");
    let out = mutate(folder.path(), "tests.hri --models --operator tme");
    expect_code(&out, 2);
    assert!(stderr(&out).contains("did you mean `time`?"), "{}", stderr(&out));
}

/// What was known when it was interrupted is reported.
#[test]
fn an_interrupt_ends_it_with_what_is_known() {
    let folder = project();
    let tests: String = (0..60).map(|n| format!("test t{n} {{ ask }}\n")).collect();
    fs::write(folder.path().join("many.hri"), format!("scenario lamp\n{tests}")).unwrap();
    let mut command = command();
    command.args(["mutate", "scenario.hri", "many.hri", "--matrix", "--json", "-o", "out", "-j", "1"]);
    command.current_dir(folder.path()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut said = BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap);
    said.find(|line| line.contains("mutants to run")).unwrap();
    std::thread::sleep(Duration::from_secs(3));
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(kill.success());
    let out = child.wait_with_output().unwrap();
    expect_code(&out, 5);
    let found = report(&out);
    assert_eq!(found["interrupted"], true);
    assert!(found["counts"]["not_run"].as_u64().unwrap() > 0, "{}", found["counts"]);
    assert_eq!(fs::read_to_string(folder.path().join("out/mutation.json")).unwrap(), stdout(&out));
}

/// Code that is another one in each process cannot be told from its mutants.
#[test]
fn tests_that_do_not_repeat_end_with_an_error() {
    let folder = project();
    let path = folder.path().join("robot.py");
    let text = fs::read_to_string(&path).unwrap();
    // A tracer is there while coverage is measured, and only then.
    let text = text.replace("node.sleep(WARM_UP_TIME)", "node.sleep(1.0 if sys.gettrace() else 0.5)");
    fs::write(&path, text.replace("import hrdsl", "import hrdsl\nimport sys")).unwrap();
    let out = mutate(folder.path(), "tests.hri --sample 2");
    expect_code(&out, 3);
    assert!(
        stderr(&out).contains("robot.py as it is does not do the same twice in lamp."),
        "{}",
        stderr(&out)
    );
}

#[test]
fn a_score_can_be_demanded_and_bad_input_is_named() {
    let folder = project();
    let demanded = mutate(folder.path(), "tests.hri --operator dropped --min-score 90");
    expect_code(&demanded, 1);
    assert!(stderr(&demanded).contains("the score is below --min-score"));
    for (line, part) in [
        ("tests.hri --operator tiem", "did you mean `time`"),
        ("tests.hri --min-score 120", "it is from 0 to 100"),
        ("tests.hri --test thrice", "no test is called `thrice`"),
        ("tests.hri --sample 0", "0 is not in 1.."),
    ] {
        let out = mutate(folder.path(), line);
        expect_code(&out, 2);
        assert!(stderr(&out).contains(part), "{line}: {}", stderr(&out));
    }
    fs::write(folder.path().join("robot.py"), "x = (\n").unwrap();
    let out = mutate(folder.path(), "tests.hri");
    expect_code(&out, 2);
    assert!(stderr(&out).contains("robot.py:1: "), "{}", stderr(&out));
}
