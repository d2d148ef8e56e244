//! `hrdsl step`, through the binary, with what is typed on its standard input.

mod support;

use std::path::Path;

use serde_json::Value;
use support::{expect_code, folder, hrdsl_in, hrdsl_reading, stderr, stdout};

/// Somebody rings between 2 s and 5 s after the start; the door opens, or it is answered with a counted knock.
const BELL: &str = "\
scenario bell
actor person : environment
channel ring
var knocks: 0..2
automaton Guest {
  clock x
  init location outside { invariant x <= 5 s }
  location inside
  outside -> inside  when x >= 2 s do ring; x = 0
  outside -> outside select n: 1..2 when x > 1 s do knocks += n
}
automaton Door {
  init location shut
  location open
  shut -> open on ring
}
network house = Guest | Door
";

fn walk(folder: &Path, line: &str, typed: &str) -> (std::process::Output, String) {
    let out = hrdsl_reading(folder, &format!("step bell.hri {line}"), typed);
    let text = stdout(&out);
    (out, text)
}

#[test]
fn a_walk_shows_what_can_happen_and_when() {
    let folder = folder(&[("bell.hri", BELL)]);
    let (out, text) = walk(folder.path(), "", "1 @ 3.5 s\n");
    expect_code(&out, 0);
    let shown = "\
at the start, from 0 s to 5 s
  in      Guest.outside  Door.shut
  vars    knocks = 0
  clocks  Guest.x: 0 s to 5 s
  1  2 s to 5 s            ring  Guest: outside -> inside, Door: shut -> open   [Guest.x = 0]
                             bell.hri:9: Guest: outside -> inside when x >= 2 s
                             bell.hri:15: Door: shut -> open
  2  after 1 s, up to 5 s  Guest: stays in outside   [knocks: 0 -> 1]
                             bell.hri:10: Guest: outside -> outside when x > 1 s with n = 1
  3  after 1 s, up to 5 s  Guest: stays in outside   [knocks: 0 -> 2]
                             bell.hri:10: Guest: outside -> outside when x > 1 s with n = 2
after 1 transition, from 3.5 s on
  in      Guest.inside  Door.open
  vars    knocks = 0
  clocks  Guest.x: from 0 s on
  nothing can happen, time can pass for ever
";
    assert_eq!(text, shown);
}

#[test]
fn a_walk_is_undone_and_told_with_times() {
    let folder = folder(&[("bell.hri", BELL)]);
    let (out, text) = walk(folder.path(), "--quiet", "3\n1\nundo 2\n2\n1 @ 4500ms\ntrace\n");
    expect_code(&out, 0);
    assert_eq!(
        text,
        "\
1.000000001 s  Guest        stays in outside   [knocks: 0 -> 1]
                 bell.hri:10: Guest: outside -> outside when x > 1 s with n = 1
        4.5 s  Guest  ring  outside -> inside, Door: shut -> open   [Guest.x = 0]
                 bell.hri:9: Guest: outside -> inside when x >= 2 s
                 bell.hri:15: Door: shut -> open
"
    );
}

#[test]
fn a_random_walk_is_the_same_each_time_and_a_run_of_the_network() {
    let folder = folder(&[("bell.hri", BELL)]);
    let drawn = |seed: u64| walk(folder.path(), &format!("--quiet --seed {seed}"), "random 3\njson\n").1;
    assert_eq!(drawn(3), drawn(3));
    let different = (0..8).map(drawn).collect::<std::collections::BTreeSet<_>>();
    assert!(different.len() > 1, "{different:?}");
    for text in different {
        std::fs::write(folder.path().join("walk.json"), &text).unwrap();
        let out = hrdsl_in(folder.path(), "prove bell.hri --follow walk.json");
        // The fault of a third knock is listed and never taken.
        expect_code(&out, 0);
        let (out, again) = walk(folder.path(), "--quiet --replay walk.json", "json\n");
        expect_code(&out, 0);
        assert_eq!(again, text);
    }
}

#[test]
fn faults_are_shown_and_not_taken() {
    let folder = folder(&[("bell.hri", BELL)]);
    let (out, text) = walk(folder.path(), "", "3\n2\n");
    expect_code(&out, 2);
    assert!(
        text.contains("fault of the model: automaton `Guest`, edge outside -> outside: `knocks` becomes 3"),
        "{text}"
    );
    assert!(stderr(&out).contains("`2`: it is a fault of the model"), "{}", stderr(&out));
}

#[test]
fn a_replay_ends_where_the_network_does_not_go_along() {
    let folder = folder(&[("bell.hri", BELL)]);
    let (_, run) = walk(folder.path(), "--quiet", "2 @ 2 s\n1 @ 3 s\njson\n");
    let mut run: Value = serde_json::from_str(&run).unwrap();
    run["steps"][1]["time"] = "6".into();
    std::fs::write(folder.path().join("late.json"), run.to_string()).unwrap();
    let (out, _) = walk(folder.path(), "", "replay late.json\n");
    expect_code(&out, 2);
    assert!(
        stderr(&out)
            .contains("the run leaves the network at step 2 of 2: it can be taken from 2 s to 5 s only"),
        "{}",
        stderr(&out)
    );
}

#[test]
fn what_is_wrong_is_said_and_ends_a_script() {
    let folder = folder(&[("bell.hri", BELL)]);
    for (typed, said) in [
        ("dance\n", "`dance`: `dance` is no command"),
        ("9\n", "`9`: only 1 to 3 can happen here"),
        ("0\n", "transitions are numbered from 1"),
        ("1 @ 1 s\n", "it can be taken at 2 s to 5 s only"),
        ("undo\n", "only 0 could be taken back"),
        ("replay none.json\n", "none.json"),
    ] {
        let (out, _) = walk(folder.path(), "--quiet", typed);
        expect_code(&out, 2);
        assert!(stderr(&out).contains(said), "{typed}: {}", stderr(&out));
    }
    let (out, help) = walk(folder.path(), "--quiet", "# a comment\n\nhelp\nquit\ndance\n");
    expect_code(&out, 0);
    assert!(help.contains("random [N]"), "{help}");
    let (out, _) = walk(folder.path(), "--network hut", "");
    expect_code(&out, 2);
    assert!(stderr(&out).contains("no network `hut`; the scenario has: house"), "{}", stderr(&out));
}
