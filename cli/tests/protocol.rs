//! Dialogs of the protocol, word for word, between `hrdsl sim` and a program that has no SDK.
#![allow(clippy::disallowed_methods, reason = "tests start processes and read files")]

mod support;

use std::{fs, path::Path};

use serde_json::Value;
use support::hrdsl_in;

const SCENARIO: &str = r#"scenario mini

actor person : environment
actor robot  : system

event asked from person to robot
event said(n: 0..9) from robot

stimulus ask by person { emit asked }

part hand {
  body palm: fixed box(4 cm, 8 cm, 8 cm) at (0 m, 0 m, 1 m)
  gripper grip: palm tool (6 cm, 0 m, 0 m) reach 4 cm delay 100 ms
}

world { part robot = hand at (0 m, 0 m, 0 m) }

system robot {
  run "env python3 player.py DIALOG"
  limit 20 s
}
"#;

/// Plays a dialog of `cli/tests/protocol`; what was wrong with it.
fn fault(dialog: &str) -> Option<String> {
    let here = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/protocol");
    let folder = tempfile::tempdir().unwrap();
    for file in ["player.py", dialog] {
        fs::copy(here.join(file), folder.path().join(file)).unwrap();
    }
    fs::write(folder.path().join("scenario.hri"), SCENARIO.replace("DIALOG", dialog)).unwrap();
    fs::write(folder.path().join("tests.hri"), "test hand.t1 { seed 1; ask; wait 1 s }\n").unwrap();
    let out = hrdsl_in(folder.path(), "sim scenario.hri tests.hri -o out");
    let results = fs::read(folder.path().join("out/results.json")).unwrap_or_default();
    let Ok(results) = serde_json::from_slice::<Value>(&results) else {
        return Some(support::stderr(&out));
    };
    results["tests"][0]["error"].as_str().map(str::to_owned)
}

#[test]
fn version_2_is_spoken_as_the_page_says() {
    assert_eq!(fault("version2.dialog"), None);
}
