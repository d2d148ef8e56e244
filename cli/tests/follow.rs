//! Runs that name their edges, and `hrdsl prove --follow`, through the binary.

mod support;

use serde_json::Value;
use support::{expect_code, folder, hrdsl_in, stderr, stdout};

/// A queue of two, with a selected place; the second automaton must answer within 3 s.
const QUEUE: &str = "\
scenario queue
actor person : environment
channel come(i: 0..2)
var last: 0..2
automaton Guest {
  clock x
  init location away
  location here
  away -> here select n: 1..2 when x >= 2 s   // not at once
    && last != n do come(n); x = 0
  here -> away when x >= 1 s do x = 0
}
automaton Desk {
  clock y
  init location free
  location busy { invariant y <= 3 s }
  free -> busy on come(m) do last = m; y = 0
  busy -> free when y > 1 s
}
network hall = Guest | Desk
query second of hall = E<> last == 2 and Guest.away and Desk.busy
query back   of hall = E<> last == 1 and Desk.free
query always of hall = Desk.busy --> Guest.away
";

fn json(out: &std::process::Output) -> Value {
    serde_json::from_slice(&out.stdout).unwrap_or_else(|e| panic!("{e}: {} {}", stdout(out), stderr(out)))
}

/// A folder with the scenario and all that is found in it.
fn found() -> tempfile::TempDir {
    let folder = folder(&[("queue.hri", QUEUE)]);
    let out = hrdsl_in(folder.path(), "prove queue.hri --json");
    std::fs::write(folder.path().join("found.json"), &out.stdout).unwrap();
    folder
}

/// The run of a query, alone in a file, after a change.
fn changed(folder: &tempfile::TempDir, query: usize, change: impl FnOnce(&mut Value)) {
    let text = std::fs::read_to_string(folder.path().join("found.json")).unwrap();
    let mut document: Value = serde_json::from_str(&text).unwrap();
    let mut run = document["networks"][0]["queries"][query]["run"].take();
    assert!(run.is_object(), "{text}");
    change(&mut run);
    std::fs::write(folder.path().join("one.json"), run.to_string()).unwrap();
}

#[test]
fn runs_name_edges_lines_guards_and_selected_values() {
    let folder = found();
    let text = std::fs::read_to_string(folder.path().join("found.json")).unwrap();
    let document: Value = serde_json::from_str(&text).unwrap();
    let parts = &document["networks"][0]["queries"][0]["run"]["steps"][0]["parts"];
    let (guest, desk) = (&parts[0], &parts[1]);
    assert_eq!((&guest["edge"], &guest["file"], &guest["line"]), (&1.into(), &"queue.hri".into(), &9.into()));
    assert_eq!(guest["guard"], "x >= 2 s && last != n");
    assert_eq!(guest["selected"], serde_json::json!(["n = 2"]));
    assert_eq!((&desk["edge"], &desk["line"]), (&1.into(), &17.into()));
    // No guard, and what it receives is not selected.
    assert!(desk.get("guard").is_none() && desk.get("selected").is_none(), "{desk:#}");
    let out = hrdsl_in(folder.path(), "prove queue.hri --query second --trace");
    expect_code(&out, 0);
    let told = stdout(&out);
    assert!(
        told.contains("queue.hri:9: Guest: away -> here when x >= 2 s && last != n with n = 2\n"),
        "{told}"
    );
    assert!(told.contains("queue.hri:17: Desk: free -> busy\n"), "{told}");
}

#[test]
fn what_prove_prints_is_followed() {
    let folder = found();
    let out = hrdsl_in(folder.path(), "prove queue.hri --follow found.json");
    expect_code(&out, 0);
    let told = stdout(&out);
    for query in ["second", "back", "always"] {
        assert!(told.contains(&format!("query {query}: a run of the network hall")), "{told}");
    }
    let out = hrdsl_in(folder.path(), "prove queue.hri --follow found.json --json");
    expect_code(&out, 0);
    let document = json(&out);
    assert_eq!((&document["format"], &document["version"]), (&"hrdsl-follow".into(), &1.into()));
    assert_eq!(document["runs"].as_array().unwrap().len(), 3);
    assert_eq!(document["runs"][0]["is_run"], true);
}

#[test]
fn a_run_with_an_observer_is_followed_without_it() {
    let lamp = "\
scenario lamp
actor person : environment
event asked from person
event gone  from person
automaton Person plays person {
  clock x
  init location idle
  location waits { invariant x <= 5 s }
  location over
  idle -> waits when x >= 1 s do asked; x = 0
  waits -> over when x >= 4 s do gone
}
network all = Person
require R1 functional asked causes gone within 4 s
";
    let folder = folder(&[("lamp.hri", lamp)]);
    let out = hrdsl_in(folder.path(), "prove lamp.hri --json");
    expect_code(&out, 3);
    assert!(stdout(&out).contains("\"R1.since = 0\""), "{}", stdout(&out));
    std::fs::write(folder.path().join("found.json"), &out.stdout).unwrap();
    let out = hrdsl_in(folder.path(), "prove lamp.hri --follow found.json");
    expect_code(&out, 0);
    assert_eq!(stdout(&out), "requirement R1: a run of the network all (1 step)\n");
}

#[test]
fn where_a_run_leaves_is_said_with_what_was_possible() {
    let folder = found();
    let follow = |line: &str| hrdsl_in(folder.path(), &format!("prove queue.hri --follow one.json {line}"));
    // Too early: the guard wants 2 s.
    changed(&folder, 0, |run| run["steps"][0]["time"] = "1.999999999".into());
    let out = follow("");
    expect_code(&out, 3);
    let told = stdout(&out);
    assert!(
        told.starts_with("leaves the network hall at step 1 of 2: it can be taken from 2 s on only\n"),
        "{told}"
    );
    assert!(told.contains("from 2 s on  come(1)  Guest: away -> here, Desk: free -> busy"), "{told}");
    let document = json(&follow("--json"));
    let left = &document["runs"][0]["leaves"];
    assert_eq!((&left["step"], &left["enabled"].as_array().unwrap().len()), (&1.into(), &2));
    assert_eq!(left["enabled"][1]["parts"][0]["selected"], serde_json::json!(["n = 2"]));
    // From a place where it is not, over another channel, to another value, and an end that comes too late.
    changed(&folder, 0, |run| run["steps"][1]["parts"][0]["from"] = "away".into());
    let told = stdout(&follow(""));
    assert!(told.contains("at step 2 of 2: `Guest` is in `here`, not in `away`"), "{told}");
    changed(&folder, 0, |run| run["steps"][0]["over"] = "come(1)".into());
    let told = stdout(&follow(""));
    assert!(
        told.contains("at step 1 of 2: these edges go over `come(2)` there, not over `come(1)`"),
        "{told}"
    );
    changed(&folder, 0, |run| run["steps"][0]["variables"] = serde_json::json!(["last: 0 -> 1"]));
    let told = stdout(&follow(""));
    assert!(told.contains("these edges change last: 0 -> 2, not last: 0 -> 1"), "{told}");
    changed(&folder, 0, |run| run["end"] = "60".into());
    let told = stdout(&follow(""));
    assert!(told.contains("at its end, after 2 steps: time cannot pass until 60 s there"), "{told}");
    // Nothing is decided where nothing is said: without times and edges it is a run.
    changed(&folder, 0, |run| {
        for step in run["steps"].as_array_mut().unwrap() {
            *step = serde_json::json!({ "parts": step["parts"] });
        }
    });
    expect_code(&follow(""), 0);
}

#[test]
fn edges_that_are_numbered_otherwise_are_compared_by_what_they_do() {
    let folder = found();
    let more = QUEUE.replace("  away -> here", "  away -> away when x > 100 s\n  away -> here");
    std::fs::write(folder.path().join("more.hri"), more).unwrap();
    let out = hrdsl_in(folder.path(), "prove more.hri --follow found.json");
    expect_code(&out, 0);
    assert!(stdout(&out).contains("note: its edges have other numbers here"), "{}", stdout(&out));
}

const UPPAAL: &str = "\
<?xml version=\"1.0\"?>
<nta><declaration>chan go; int n = 0;</declaration>
<template><name>A</name><declaration>clock x;</declaration>
<location id=\"a0\"><name>Start</name></location>
<location id=\"a1\"><name>End</name><label kind=\"invariant\">x &lt;= 5</label></location>
<init ref=\"a0\"/>
<transition><source ref=\"a1\"/><target ref=\"a0\"/><label kind=\"guard\">x &gt;= 4</label></transition>
<transition><source ref=\"a0\"/><target ref=\"a1\"/><label kind=\"select\">k : int[0,3]</label>
<label kind=\"guard\">x &gt;= 2</label><label kind=\"synchronisation\">go!</label>
<label kind=\"assignment\">n = k, x = 0</label></transition>
</template>
<template><name>B</name>
<location id=\"b0\"><name>Idle</name></location>
<init ref=\"b0\"/>
<transition><source ref=\"b0\"/><target ref=\"b0\"/><label kind=\"synchronisation\">go?</label>
<label kind=\"guard\">n != 3</label></transition>
</template>
<system>system A, B;</system></nta>
";

/// As `verifyta` writes it: go with k = 2, then back.
const XTR: &str = "0 0 \n.\n0 1 0\n.\n1 2 0\n.\n2 1 0\n.\n.\n0 \n.\n1 0 \n.\n0 1 -4\n.\n2 0 10\n.\n.\n2 \n.\n0 1 2 ; 1 0 ; .\n0 0 \n.\n0 1 -12\n.\n.\n2 \n.\n0 0 ; .\n.\n";

#[test]
fn traces_of_uppaal_are_followed() {
    let folder = folder(&[("model.xml", UPPAAL), ("good.xtr", XTR)]);
    expect_code(&hrdsl_in(folder.path(), "import uppaal model.xml -o model.hri"), 0);
    let follow = |text: &str| {
        std::fs::write(folder.path().join("trace.xtr"), text).unwrap();
        hrdsl_in(folder.path(), "prove model.hri --follow trace.xtr")
    };
    let out = follow(XTR);
    expect_code(&out, 0);
    assert!(
        stdout(&out).starts_with("a run of the network ") && stdout(&out).contains("(2 steps)"),
        "{}",
        stdout(&out)
    );
    assert!(!stdout(&out).contains("note"), "{}", stdout(&out));
    // The receiver does not take 3: its guard is evaluated before the update, so 3 goes once and not again.
    let again = XTR.replace("0 0 ; .\n.\n", "0 0 ; .\n1 0\n.\n.\n3\n.\n0 1 1 ; 1 0 ; .\n.\n");
    expect_code(&follow(&again), 0);
    let blocked = follow(&again.replace("0 1 2 ; 1 0", "0 1 3 ; 1 0"));
    expect_code(&blocked, 3);
    assert!(stdout(&blocked).contains("at step 3 of 3"), "{}", stdout(&blocked));
    // What is of another model, or no trace, is refused.
    for (text, said) in [
        (XTR.replace("0 0 \n", "0 0 0\n"), "is it of this model?"),
        (XTR.replacen("0 0 \n", "1 0\n", 1), "starts with `A` in its location 1"),
        (XTR.replace("1 0 ; .", "7 0 ; ."), "there is no process 7"),
        ("hello".to_owned(), "neither JSON nor a trace of UPPAAL (.xtr): line 1"),
    ] {
        let out = follow(&text);
        expect_code(&out, 2);
        assert!(stderr(&out).contains("trace.xtr: ") && stderr(&out).contains(said), "{}", stderr(&out));
    }
}

#[test]
fn what_is_no_run_is_said() {
    let folder = found();
    for (text, said) in [
        ("{}", "there is no run in it"),
        ("{\"steps\": 3}", "invalid type"),
        ("{\"network\": \"cellar\", \"steps\": []}", "a network `cellar`; the scenario has: hall"),
        (
            "{\"steps\": [{\"parts\": [{\"automaton\": \"Gast\"}]}]}",
            "step 1: `Gast` is no automaton of the network",
        ),
        ("{\"steps\": [{\"time\": \"soon\", \"parts\": []}]}", "step 1: `soon` is no time in seconds"),
    ] {
        std::fs::write(folder.path().join("bad.json"), text).unwrap();
        let out = hrdsl_in(folder.path(), "prove queue.hri --follow bad.json");
        expect_code(&out, 2);
        assert!(stderr(&out).contains("bad.json: ") && stderr(&out).contains(said), "{}", stderr(&out));
    }
    expect_code(&hrdsl_in(folder.path(), "prove queue.hri --follow none.json"), 2);
    // A network that cannot start has no runs.
    let never = QUEUE.replace("init location free", "init location free { invariant last > 0 }");
    std::fs::write(folder.path().join("never.hri"), never).unwrap();
    let out = hrdsl_in(folder.path(), "prove never.hri --follow found.json");
    expect_code(&out, 1);
    assert!(
        stderr(&out).contains("network `hall`: the invariants of the initial locations"),
        "{}",
        stderr(&out)
    );
    expect_code(&hrdsl_in(folder.path(), "step never.hri"), 1);
}
