//! `hrdsl import`: files in, a scenario and a report out.

mod support;

use std::fs;

use support::{expect_code, hrdsl_in, stderr, stdout};

const ROBOT: &str =
    "at(home).\n!go(shop).\n+!go(P) : at(Q) & P \\== Q <- move(P); -+at(P); .nonsense(P).\n+!go(_).\n";

#[test]
fn a_program_becomes_a_scenario_with_a_report() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("robot.asl"), ROBOT).unwrap();
    let out = hrdsl_in(folder.path(), "import agentspeak robot.asl -o out/robot.hri --name errands");
    expect_code(&out, 0);
    assert_eq!(stdout(&out), "");
    assert!(stderr(&out).starts_with("robot.asl:3:"), "{}", stderr(&out));
    assert!(stderr(&out).contains("robot.asl:3:48: left out: "), "{}", stderr(&out));
    let text = fs::read_to_string(folder.path().join("out/robot.hri")).unwrap();
    assert!(text.starts_with("scenario errands\n"), "{text}");
    expect_code(&hrdsl_in(folder.path(), "fmt --check out/robot.hri"), 0);
    expect_code(&hrdsl_in(folder.path(), "check out/robot.hri"), 0);
    expect_code(&hrdsl_in(folder.path(), "import agentspeak robot.asl --strict"), 1);

    let out = hrdsl_in(folder.path(), "import agentspeak robot.asl --json");
    let document: serde_json::Value = serde_json::from_str(&stdout(&out)).unwrap();
    assert_eq!((&document["format"], &document["version"]), (&"hrdsl-import".into(), &1.into()));
    assert!(document["text"].as_str().unwrap().starts_with("scenario robot\n"));
    let left_out: Vec<_> =
        document["notes"].as_array().unwrap().iter().filter(|n| n["severity"] == "left out").collect();
    assert_eq!((left_out.len(), &left_out[0]["line"]), (1, &3.into()));
}

#[test]
fn what_is_no_program_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("robot.asl"), "at(home)\n+!go <- .").unwrap();
    let out = hrdsl_in(folder.path(), "import agentspeak robot.asl");
    expect_code(&out, 1);
    assert!(stderr(&out).contains("error: robot.asl:2:1: expected `.`"), "{}", stderr(&out));
    fs::write(folder.path().join("house.mas2j"), "MAS house { agents: robot; owner; }").unwrap();
    let out = hrdsl_in(folder.path(), "import agentspeak house.mas2j");
    expect_code(&out, 1);
    assert!(stderr(&out).contains("there is no file owner.asl"), "{}", stderr(&out));
    expect_code(&hrdsl_in(folder.path(), "import agentspeak house.hri"), 2);
}
