//! Programs of ROS, as people write them, against a scenario that binds their topics, services and actions; and such as go wrong.
#![allow(clippy::disallowed_methods, reason = "tests start processes and read files")]

mod support;

use std::{fmt::Write as _, fs, path::Path};

use serde_json::Value;
use support::hrdsl_in;

const TESTS: &str = "test hand.t1 { seed 1; order(3); wait 1 s; ask; wait 2 s; order(5) }\n";

/// What became of a program of `cli/tests/bindings` and its companion: the events, the output, the error of the test.
fn run(program: &str) -> String {
    let here = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bindings");
    let folder = tempfile::tempdir().unwrap();
    for file in [&format!("{program}.py"), "other.py"] {
        fs::copy(here.join(file), folder.path().join(file)).unwrap();
    }
    let scenario = fs::read_to_string(here.join("scenario.hri")).unwrap();
    fs::write(folder.path().join("scenario.hri"), scenario.replace("PROGRAM", program)).unwrap();
    fs::write(folder.path().join("tests.hri"), TESTS).unwrap();
    let done = hrdsl_in(folder.path(), "sim scenario.hri tests.hri -o out --check-determinism --exit-zero");
    let read = |name: &str| fs::read_to_string(folder.path().join("out").join(name)).unwrap_or_default();
    let Ok(results) = serde_json::from_str::<Value>(&read("results.json")) else {
        return support::stderr(&done);
    };
    let mut text = String::new();
    for line in read("traces/hand.t1.jsonl").lines() {
        let step: Value = serde_json::from_str(line).unwrap();
        if let Some(event) = step.get("event") {
            let _ = writeln!(text, "{} {event} {}", step["t"], step.get("args").unwrap_or(&Value::Null));
        }
    }
    let _ = writeln!(text, "{}", read("output/hand.t1.txt"));
    if let Some(error) = results["tests"][0]["error"].as_str() {
        let _ = writeln!(text, "error: {error}");
    }
    let _ = writeln!(text, "exit {:?}", done.status.code());
    // Where the libraries lie differs between machines.
    let folder = folder.path().display().to_string();
    text.lines().map(|line| without_places(line, &folder) + "\n").collect()
}

/// `File "…/rospy/topics.py", line 3` without the folders and the line.
fn without_places(line: &str, folder: &str) -> String {
    let line = line.replace(folder, "…");
    match (line.find("File \"/"), line.find("/ros1/"), line.find("\", line ")) {
        (Some(begin), Some(place), Some(end)) if begin < place && place < end => {
            let rest = line[end + 8..].find(',').map_or("", |at| &line[end + 8 + at..]);
            format!("{}File \"…{}\"{rest}", &line[..begin], &line[place..end])
        }
        _ => line,
    }
}

macro_rules! programs {
    ($($name:ident: $what:literal),* $(,)?) => {$(
        #[test]
        fn $name() {
            insta::with_settings!({ description => $what, omit_expression => true }, {
                insta::assert_snapshot!(concat!("bindings_", stringify!($name)), run(stringify!($name)));
            });
        }
    )*};
}

programs! {
    good: "everything that is bound is heard, said, asked and driven",
    wrong_type: "a publisher of another type than the binding's is refused, with both types",
    out_of_range: "a message that makes no event of the scenario is the program's error",
    dies: "a program that dies ends the test, and is named",
    throws: "a callback that throws is logged, and the node goes on",
    locks: "threads that wait for each other are found and named",
    polls: "a loop that polls nothing is found, with its line",
    imports: "a package of messages that nobody has is named, with what to do",
}
