//! Programs of ROS, as people write them, against a scenario that binds their topics, services and actions; and such as go wrong.
#![allow(clippy::disallowed_methods, reason = "tests start processes and read files")]

mod support;

use std::{fmt::Write as _, fs, path::Path};

use serde_json::Value;
use support::hrdsl_in;

const TESTS: &str = "test hand.t1 { seed 1; order(3); wait 1 s; ask; wait 2 s; order(5) }\n";

/// Topics that the scenario publishes, and programs may.
const SHARED: &str = r#"  ros1 {
    topic "/joint_states" : sensor_msgs/JointState in at 1 Hz from robot.arm
    topic "/echo" : std_msgs/Int8 in latched { data = ordered.n }
    topic "/echo" : std_msgs/Int8 out { emit counted(data) when data > 1 }
"#;

/// Puts a program, its companion and their scenario into a folder.
fn prepare(program: &str, folder: &Path) {
    let here = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bindings");
    fs::copy(here.join(format!("{program}.py")), folder.join(format!("{program}.py"))).unwrap();
    let other = if program == "late" { "leaves_early.py" } else { "other.py" };
    fs::copy(here.join(other), folder.join("other.py")).unwrap();
    let (scenario, middleware) = match program {
        "values" | "short" => ("values.hri", "ros1"),
        "frames" => ("frames.hri", "ros1"),
        "logs" | "shares" => ("shares.hri", "ros1"),
        "throws_late" => ("two.hri", "ros1"),
        "throws_two" => ("two.hri", "ros2"),
        _ => ("scenario.hri", "ros1"),
    };
    let scenario = fs::read_to_string(here.join(scenario)).unwrap().replace("MIDDLEWARE", middleware);
    let mut scenario = scenario.replace("PROGRAM", program);
    if program == "says_input" {
        scenario = scenario.replace("  ros1 {\n", SHARED);
    }
    fs::write(folder.join("scenario.hri"), scenario).unwrap();
}

/// What became of a program of `cli/tests/bindings` and its companion: the events, the output, the error of the test.
fn run(program: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    prepare(program, folder.path());
    fs::write(folder.path().join("tests.hri"), TESTS).unwrap();
    let done = hrdsl_in(folder.path(), "sim scenario.hri tests.hri -o out --check-determinism --exit-zero");
    let read = |name: &str| fs::read_to_string(folder.path().join("out").join(name)).unwrap_or_default();
    // The one file of a folder of the results.
    let only = |name: &str| {
        let mut files = fs::read_dir(folder.path().join("out").join(name)).into_iter().flatten().flatten();
        files.next().and_then(|file| fs::read_to_string(file.path()).ok()).unwrap_or_default()
    };
    let Ok(results) = serde_json::from_str::<Value>(&read("results.json")) else {
        return support::stderr(&done);
    };
    let mut text = String::new();
    for line in only("traces").lines() {
        let step: Value = serde_json::from_str(line).unwrap();
        if let Some(event) = step.get("event") {
            let _ = writeln!(text, "{} {event} {}", step["t"], step.get("args").unwrap_or(&Value::Null));
        }
    }
    let _ = writeln!(text, "{}", only("output"));
    for verdict in results["tests"][0]["verdicts"].as_array().into_iter().flatten() {
        let _ = writeln!(text, "{}: {}", verdict["requirement"], verdict["outcome"]);
    }
    if program == "logs" {
        let _ = writeln!(text, "{:#}", results["tests"][0]["log"]);
    }
    if let Some(error) = results["tests"][0]["error"].as_str() {
        let _ = writeln!(text, "error: {error}");
    }
    let _ = writeln!(text, "exit {:?}", done.status.code());
    // Where the libraries lie, and what their lines are, differs between machines and versions.
    let folder = folder.path().display().to_string();
    let mut of_library = false;
    let mut kept = String::new();
    for line in text.lines() {
        if line.contains("File \"") {
            of_library = !line.contains(&folder);
        } else if !line.starts_with("    ") {
            of_library = false;
        }
        let is_caret = !line.trim().is_empty() && line.trim().chars().all(|c| "^~".contains(c));
        if !of_library && !is_caret {
            kept.push_str(&without_addresses(&line.replace(&folder, "…")));
            kept.push('\n');
        }
        // They may begin within a frame.
        of_library |= line.starts_with("its last lines on");
    }
    kept
}

/// `0x7ffff719e5d0` is another on another machine.
fn without_addresses(line: &str) -> String {
    let mut parts = line.split("0x");
    let mut kept = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        kept.push_str("0x…");
        kept.push_str(part.trim_start_matches(|c: char| c.is_ascii_hexdigit()));
    }
    kept
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
    says_input: "a publisher of a topic that the scenario itself publishes is refused",
    late: "an answer to a call whose client has ended",
    dies: "a program that dies ends the test, and is named",
    throws: "a callback that throws is logged, and an error of the test that names node and topic",
    throws_late: "so is a timer that does; a violation that was seen before counts",
    throws_two: "in ROS 2 the exception ends the program, with the node and the topic",
    logs: "what two nodes log is counted, and what warns is told with its time",
    locks: "threads that wait for each other are found and named",
    shares: "parameters are one tree for all programs",
    polls: "a loop that polls nothing is found, with its line",
    values: "rows, places of bodies, names of joints and postures are what the scenario says",
    frames: "listeners of tf find where bodies of the scenario are, and where they were",
    short: "a row that is shorter than a rule reads is the program's error",
    imports: "a package of messages that nobody has is named, with what to do",
}

const RATIO: &str = r#"scenario ratio
actor person : environment
actor robot  : system
event ordered(n: 0..9) from person to robot
stimulus order(n: 0..9) by person { emit ordered(n) }
system robot {
  run "env python3 raw.py"
  limit 5 s
  ros1 { topic "/share": geometry_msgs/PointStamped in at 1 Hz { point.z = 1 / ordered.n } }
}
"#;

/// Subscribes to a topic, and waits until the test is over.
const SUBSCRIBES: &str = r#"import os
replies = open(int(os.environ["HRDSL_REPLY_FD"]))
def ask(line):
    os.write(int(os.environ["HRDSL_REQUEST_FD"]), line + b"\n")
    return replies.readline()
ask(b'{"request":"hello","version":2,"name":"raw"}')
ask(b'{"request":"open","port":1,"kind":"subscriber","name":"/share","type":"geometry_msgs/PointStamped"}')
reply = ""
while "stop" not in reply:
    reply = ask(b'{"request":"wait"}')
print(reply)
"#;

#[test]
fn a_value_that_there_is_not_is_the_scenarios_fault_and_its_field_is_named() {
    let test = "test ratio.t1 { seed 1; order(4); wait 1500 ms; order(0); wait 1 s }\n";
    let folder = support::folder(&[("scenario.hri", RATIO), ("tests.hri", test), ("raw.py", SUBSCRIBES)]);
    let done = hrdsl_in(folder.path(), "sim scenario.hri tests.hri -o out --exit-zero");
    let results = fs::read_to_string(folder.path().join("out/results.json")).unwrap_or_default();
    let results: Value =
        serde_json::from_str(&results).unwrap_or_else(|_| panic!("{}", support::stderr(&done)));
    let error = results["tests"][0]["error"].as_str().unwrap_or_default();
    let expected = "the binding: the topic `/share`: `point.z`: ";
    assert!(error.contains(expected), "{error}");
    let mut output = fs::read_dir(folder.path().join("out/output")).unwrap();
    let output = fs::read_to_string(output.next().unwrap().unwrap().path()).unwrap();
    assert!(output.contains("\"reason\":\"the test has broken off: "), "{output}");
}

const FLOOD: &str = r#"scenario flood
actor person : environment
actor robot  : system
event ordered from person to robot
stimulus order by person { emit ordered }
system robot {
  run "python3 flood.py"
  limit 5 s
  ros1 { }
}
"#;

const LOGS: &str = r#"import hrdsl
node, log = hrdsl.Node("flood"), hrdsl.Logger("flood")
while True:
    log.warn("again")
"#;

#[test]
fn a_flood_of_logs_is_the_error_of_its_test_and_takes_no_more_than_so_much() {
    let test = "test flood.t1 { seed 1; order }\n";
    let folder = support::folder(&[("scenario.hri", FLOOD), ("tests.hri", test), ("flood.py", LOGS)]);
    let done = hrdsl_in(folder.path(), "sim scenario.hri tests.hri -o out --exit-zero");
    let results = fs::read_to_string(folder.path().join("out/results.json")).unwrap_or_default();
    let results: Value =
        serde_json::from_str(&results).unwrap_or_else(|_| panic!("{}", support::stderr(&done)));
    let test = &results["tests"][0];
    let error = test["error"].as_str().unwrap_or_default();
    assert!(error.contains("requests without letting simulated time pass"), "{error}");
    let (warn, first) = (&test["log"]["counts"]["warn"], test["log"]["first"].as_array());
    assert!(warn.as_u64().is_some_and(|n| (50_000..=100_000).contains(&n)), "{warn}");
    assert_eq!(first.map(Vec::len), Some(20));
}
