//! Files of TChecker go in, are proved, go out and come in again: the answers are the same both times. And networks as
//! pictures.

mod support;

use std::{fs, path::Path};

use support::{expect_code, hrdsl_in, stderr, stdout};

const FISCHER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../compiler/interop/tests/tchecker/fischer.txt");

/// Two that shake hands, one that hears a broadcast, a function and an array: every location is told apart by its label.
const TABLE: &str = "scenario table
channel take(cup: 0..1), full : urgent
channel bell : broadcast
var cups: (0..2)[2]
fn fill(cup: 0..1) { cups[cup] += 1 }
automaton Guest {
  clock x
  init location idle { invariant x <= 5 s }
  location happy
  location late
  idle -> happy select c: 0..1 when x >= 2 s do take(c); x = 0
  idle -> late  when x > 5 s
  happy -> idle when x < 2 s && (cups[1] == 1 || cups[0] == 2) do bell; x = 0
}
automaton Kitchen {
  init location open
  location shut
  location never
  open -> open on take(cup) when cups[cup] < 2 do fill(cup)
  open -> shut on bell when cups[1] == 2
  shut -> never when cups[0] > cups[1]
}
network all = Guest | Kitchen
";

/// What is asked of each location, and the verdict.
fn verdicts(folder: &Path, file: &str, asked: &str) -> Vec<(String, String)> {
    let out = hrdsl_in(folder, &format!("prove {file} --json{asked}"));
    let document: serde_json::Value = serde_json::from_str(&stdout(&out))
        .unwrap_or_else(|e| panic!("{e}: {}{}", stdout(&out), stderr(&out)));
    let queries = document["networks"][0]["queries"].as_array().unwrap();
    let text = |v: &serde_json::Value| v.as_str().unwrap_or_default().to_owned();
    queries.iter().map(|q| (text(&q["name"]), text(&q["verdict"]))).collect()
}

#[test]
fn fischer_keeps_its_answers_there_and_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::copy(FISCHER, path.join("fischer.txt")).unwrap();
    expect_code(&hrdsl_in(path, "import tchecker fischer.txt -o fischer.hri"), 0);
    let labels = verdicts(path, "fischer.hri", "");
    assert_eq!(labels.len(), 2);
    assert!(labels.iter().all(|(_, verdict)| verdict == "satisfied"), "{labels:?}");
    fs::write(
        path.join("asked.hri"),
        fs::read_to_string(path.join("fischer.hri")).unwrap()
            + "query excludes of all = A[] not (P1.cs && P2.cs)\nquery both of all = E<> P1.cs && P2.req\n",
    )
    .unwrap();
    for how in ["", " --local-time", " --threads 2 --order depth"] {
        let found = verdicts(path, "asked.hri", how);
        let verdicts: Vec<&str> = found.iter().map(|(_, v)| v.as_str()).collect();
        assert_eq!(verdicts, ["satisfied", "satisfied", "satisfied", "not_satisfied"], "{how}");
    }
    expect_code(&hrdsl_in(path, "export tchecker fischer.hri -o back.txt"), 0);
    expect_code(&hrdsl_in(path, "import tchecker back.txt -o back.hri"), 0);
    let back = verdicts(path, "back.hri", "");
    // A label for each location; all can be reached.
    assert_eq!(back.len(), 8);
    assert!(back.iter().all(|(_, verdict)| verdict == "satisfied"), "{back:?}");
}

#[test]
fn a_network_keeps_its_answers_there_and_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("table.hri"), TABLE.replace(", full : urgent", "")).unwrap();
    let locations =
        ["Guest.idle", "Guest.happy", "Guest.late", "Kitchen.open", "Kitchen.shut", "Kitchen.never"];
    let here: Vec<String> = locations
        .iter()
        .map(|l| {
            let out = hrdsl_in(path, &format!("prove table.hri --ask E<>{l}"));
            let satisfied = out.status.code() == Some(0);
            format!("label_{} {satisfied}", l.replace('.', "_"))
        })
        .collect();
    expect_code(&hrdsl_in(path, "export tchecker table.hri -o table.txt"), 0);
    expect_code(&hrdsl_in(path, "import tchecker table.txt -o back.hri"), 0);
    let back: Vec<String> = verdicts(path, "back.hri", "")
        .into_iter()
        .map(|(name, verdict)| format!("{name} {}", verdict == "satisfied"))
        .collect();
    assert_eq!(back, here);
    assert!(here.iter().any(|h| h.ends_with("false")) && here.iter().any(|h| h.ends_with("true")));
}

#[test]
fn what_cannot_be_exported_is_listed_with_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let urgent = TABLE
        .replace("take(cup: 0..1), full : urgent", "take(cup: 0..1) : urgent")
        .replace("x >= 2 s do take", "do take");
    let urgent = urgent.replace("select c: 0..1 when do", "select c: 0..1 do");
    fs::write(path.join("table.hri"), urgent).unwrap();
    let out = hrdsl_in(path, "export tchecker table.hri");
    expect_code(&out, 1);
    assert!(stderr(&out).contains("table.hri:2:1: error: the channel `take` is urgent"), "{}", stderr(&out));
}

#[test]
fn networks_are_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("table.hri"), TABLE.replace(", full : urgent", "")).unwrap();
    let dot = hrdsl_in(path, "export dot table.hri");
    expect_code(&dot, 0);
    assert!(stdout(&dot).contains("label = \"Guest\""), "{}", stdout(&dot));
    let mermaid = hrdsl_in(path, "export mermaid table.hri --network all");
    expect_code(&mermaid, 0);
    assert!(stdout(&mermaid).starts_with("stateDiagram-v2\n"));
    let unknown = hrdsl_in(path, "export dot table.hri --network some");
    expect_code(&unknown, 2);
}
