//! Answers of `hrdsl prove` as they come, interrupted, and what they took.

#![allow(clippy::disallowed_methods, reason = "a test sends a signal")]

mod support;

use std::{
    io::{BufRead, BufReader, Read},
    process::{Command, Stdio},
};

use serde_json::Value;
use support::{expect_code, folder, hrdsl_in, stdout};

/// Automata with clocks of their own: few of them are searched at once, nine take for ever.
fn wide(count: usize) -> String {
    let automaton = |i: usize| {
        format!(
            "automaton A{i} {{\n  clock x\n  init location a {{ invariant x <= {} s }}\n  \
             location b {{ invariant x <= {} s }}\n  a -> b when x >= {} s do x = 0\n  \
             b -> a when x >= 2 s do x = 0\n}}\n",
            7 + 2 * i,
            11 + 3 * i,
            i + 1,
        )
    };
    let automata: String = (0..count).map(automaton).collect();
    let names: Vec<String> = (0..count).map(|i| format!("A{i}")).collect();
    format!(
        "scenario wide\nactor person : environment\n{automata}network net = {}\n\
         query never of net = E<> A0.x > 100 s\nquery early of net = E<> A0.b\n\
         query ends of net = E<> deadlock\nquery left of net = A[] not A1.b\n",
        names.join(" | ")
    )
}

fn lines(text: &str) -> Vec<Value> {
    text.lines().map(|line| serde_json::from_str(line).unwrap_or_else(|e| panic!("{e}: {line}"))).collect()
}

#[test]
fn answers_come_in_the_order_of_their_decision_and_the_document_in_that_of_the_scenario() {
    let folder = folder(&[("wide.hri", &wide(3))]);
    let stream = || hrdsl_in(folder.path(), "prove wide.hri --stream");
    let out = stream();
    expect_code(&out, 3);
    let all = lines(&stdout(&out));
    let (document, early) = all.split_last().unwrap();
    let told: Vec<(&str, &str)> =
        early.iter().map(|l| (l["name"].as_str().unwrap(), l["verdict"].as_str().unwrap())).collect();
    // Those of the joint search first; what is met in it before what all of it takes.
    assert_eq!(told.last(), Some(&("ends", "not_satisfied")));
    let at = |name: &str| told.iter().position(|(n, _)| *n == name).unwrap();
    assert!(at("never") < at("ends") && told.len() == 4, "{told:?}");
    let names: Vec<&str> = document["networks"][0]["queries"]
        .as_array()
        .unwrap()
        .iter()
        .map(|q| q["name"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["never", "early", "ends", "left"]);
    assert_eq!(stdout(&out), stdout(&stream()));
    // The last line is the document of --json.
    let whole = hrdsl_in(folder.path(), "prove wide.hri --json");
    assert_eq!(serde_json::from_slice::<Value>(&whole.stdout).unwrap(), *document);
}

#[test]
fn what_one_search_took_is_told_once() {
    let folder = folder(&[("wide.hri", &wide(3))]);
    let out = hrdsl_in(folder.path(), "prove wide.hri");
    let text = stdout(&out);
    // One of three, and that about the deadlock.
    assert_eq!(text.matches("transitions, ").count(), 2, "{text}");
    assert!(text.contains("\n  3 queries in one search  ("), "{text}");
    let document = |args: &str| -> Value {
        let out = hrdsl_in(folder.path(), &format!("prove wide.hri --json {args}"));
        serde_json::from_slice(&out.stdout).unwrap()
    };
    let plain = document("");
    assert_eq!(plain["version"], 3);
    let searches = plain["networks"][0]["searches"].as_array().unwrap();
    let joint = searches.iter().find(|s| s["for"] == serde_json::json!(["never", "early", "left"])).unwrap();
    for figure in ["stored", "visited", "transitions", "discrete_states", "bytes"] {
        assert!(joint[figure].as_u64().unwrap() > 0, "{joint:#}");
    }
    // Three automata with two locations each.
    assert_eq!(joint["discrete_states"], 8);
    assert_eq!((searches.len(), &searches[1]["discrete_states"]), (2, &8.into()));
    assert!(searches.iter().all(|s| s.get("seconds").is_none()));
    let timed = document("--timings");
    let searches = timed["networks"][0]["searches"].as_array().unwrap();
    assert!(searches.iter().all(|s| s["seconds"].as_f64().unwrap() > 0.0), "{searches:?}");
}

#[test]
fn all_kinds_of_questions_say_what_they_took_and_stop_when_their_time_is_over() {
    let asked = ["E<> deadlock", "A<> A0.b", "E[] not A0.b", "A0.a --> A1.b", "sup: A0.x", "inf{A0.b}: A0.x"];
    let prove = |count: usize, query: &str, args: &[&str]| -> Value {
        let folder = folder(&[("wide.hri", &wide(count))]);
        let mut command = support::command();
        command.args(["prove", "wide.hri", "--json", "--ask", query]).args(args).current_dir(folder.path());
        serde_json::from_slice(&command.output().unwrap().stdout).unwrap()
    };
    for query in asked {
        let document = prove(2, query, &[]);
        let search = &document["networks"][0]["searches"][0];
        assert_eq!(search["for"], serde_json::json!(["ask1"]));
        assert!(search["visited"].as_u64().unwrap() > 0, "{query}: {search:#}");
        assert!(search["discrete_states"].as_u64().unwrap() <= 4, "{query}: {search:#}");
    }
    for query in ["E<> deadlock", "A0.a --> A1.a or A1.b", "sup: A0.x"] {
        let document = prove(9, query, &["--timeout", "300ms", "--budget-memory", "20GB"]);
        let query_row = &document["networks"][0]["queries"][0];
        assert_eq!(query_row["verdict"], "inconclusive", "{query}: {document:#}");
        assert!(
            query_row["remark"].as_str().unwrap().contains("the time was over"),
            "{query}: {query_row:#}"
        );
    }
}

#[test]
fn an_interrupt_tells_what_is_known() {
    for threads in ["1", "2"] {
        interrupted(threads);
    }
}

/// While a round of the search goes on.
fn interrupted(threads: &str) {
    let folder = folder(&[("wide.hri", &wide(9))]);
    let mut command = support::command();
    command.args(["prove", "wide.hri", "--stream", "--budget-memory", "20GB", "--threads", threads]);
    command.current_dir(folder.path());
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let mut out = BufReader::new(child.stdout.take().unwrap());
    let (mut first, mut second) = (String::new(), String::new());
    // Two are known while the search goes on.
    out.read_line(&mut first).unwrap();
    out.read_line(&mut second).unwrap();
    assert!(first.contains("satisfied") && second.contains("satisfied"), "{first}{second}");
    let asked = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(asked.success());
    let mut rest = String::new();
    out.read_to_string(&mut rest).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(5), "{rest}");
    let all = lines(&rest);
    let queries = all.last().unwrap()["networks"][0]["queries"].as_array().unwrap();
    let verdicts: Vec<&str> = queries.iter().map(|q| q["verdict"].as_str().unwrap()).collect();
    assert_eq!(verdicts, ["inconclusive", "satisfied", "inconclusive", "not_satisfied"]);
    assert!(queries[0]["remark"].as_str().unwrap().starts_with("it was interrupted"), "{}", queries[0]);
}
