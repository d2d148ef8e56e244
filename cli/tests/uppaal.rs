//! A model of UPPAAL goes in, is proved, goes out and comes in again: the answers are those that its author states, both times.

mod support;

use std::{fs, path::Path};

use support::{expect_code, hrdsl_in, stderr, stdout};

const MODELS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../compiler/interop/tests/uppaal");

/// What the author of `handover.q` states of each query, in order: a verdict, or a bound.
const STATED: [&str; 16] = [
    "satisfied",
    "satisfied",
    "satisfied",
    "satisfied",
    "not_satisfied",
    "satisfied",
    "not_satisfied",
    "satisfied",
    "satisfied",
    "satisfied",
    "satisfied",
    "not_satisfied",
    "satisfied",
    "6",
    "2",
    "2",
];

fn copy(folder: &Path) {
    for name in ["handover.xml", "handover.q"] {
        fs::copy(Path::new(MODELS).join(name), folder.join(name)).unwrap();
    }
}

/// Verdict and bounds of each query.
fn answers(folder: &Path, file: &str) -> Vec<(String, Vec<String>)> {
    let out = hrdsl_in(folder, &format!("prove {file} --json"));
    let document: serde_json::Value = serde_json::from_str(&stdout(&out))
        .unwrap_or_else(|e| panic!("{e}: {}{}", stdout(&out), stderr(&out)));
    let queries = document["networks"][0]["queries"].as_array().unwrap();
    let text = |v: &serde_json::Value| v.as_str().unwrap_or_default().to_owned();
    let bounds =
        |v: &serde_json::Value| v.as_array().map(|all| all.iter().map(text).collect()).unwrap_or_default();
    queries.iter().map(|q| (text(&q["verdict"]), bounds(&q["bounds"]))).collect()
}

#[test]
fn handover_keeps_its_answers_there_and_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    copy(path);
    let out = hrdsl_in(path, "import uppaal handover.xml handover.q -o there.hri");
    expect_code(&out, 0);
    assert!(stderr(&out).contains("handover.q:50:1: left out: the query `Pr[<=100]"), "{}", stderr(&out));
    expect_code(&hrdsl_in(path, "check there.hri"), 0);
    let there = answers(path, "there.hri");
    assert_eq!(there.len(), STATED.len());
    for (n, ((verdict, bounds), stated)) in there.iter().zip(STATED).enumerate() {
        match stated.parse::<u32>() {
            Ok(number) => {
                let shown = bounds.concat();
                let has =
                    shown.split(|c: char| !c.is_ascii_digit() && c != '.').any(|w| w == number.to_string());
                assert!(has, "query {}: {shown}, not {number}", n + 1);
            }
            Err(_) => assert_eq!(verdict, stated, "query {}", n + 1),
        }
    }
    expect_code(&hrdsl_in(path, "export uppaal there.hri -o back.xml --queries back.q"), 0);
    expect_code(&hrdsl_in(path, "import uppaal back.xml -o back.hri"), 0);
    assert_eq!(answers(path, "back.hri"), there);
    // The queries of the file are those in the model.
    let text = fs::read_to_string(path.join("back.xml")).unwrap();
    let (model, queries) = (text.find("<queries>").unwrap(), text.find("</queries>").unwrap());
    fs::write(path.join("bare.xml"), format!("{}{}", &text[..model], &text[queries + 10..])).unwrap();
    expect_code(&hrdsl_in(path, "import uppaal bare.xml back.q -o bare.hri"), 0);
    assert_eq!(answers(path, "bare.hri"), there);
}

#[test]
fn errors_name_file_line_and_next_step() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    copy(path);
    let text = fs::read_to_string(path.join("handover.xml")).unwrap();
    fs::write(path.join("bad.xml"), text.replace("clock x;", "hybrid clock x;")).unwrap();
    let out = hrdsl_in(path, "import uppaal bad.xml");
    expect_code(&out, 1);
    assert!(stderr(&out).contains("bad.xml:") && stderr(&out).contains("`hybrid`"), "{}", stderr(&out));
    fs::write(path.join("cut.xml"), &text[..text.len() / 2]).unwrap();
    expect_code(&hrdsl_in(path, "import uppaal cut.xml"), 1);
    let out = hrdsl_in(path, "import uppaal handover.q");
    assert!(stderr(&out).contains("name the model (.xml)"), "{}", stderr(&out));

    expect_code(&hrdsl_in(path, "import uppaal handover.xml -o there.hri"), 0);
    let out = hrdsl_in(path, "export uppaal there.hri --network other");
    assert!(stderr(&out).contains("no network `other`: it has `model`"), "{}", stderr(&out));
    fs::write(path.join("none.hri"), "scenario none\nactor robot : system\n").unwrap();
    let out = hrdsl_in(path, "export uppaal none.hri");
    assert!(stderr(&out).contains("has no network"), "{}", stderr(&out));
}

/// Three processes, of which one at a time is in `cs`, and the ways in which UPPAAL's models ask for that.
#[test]
fn locations_are_counted_as_uppaal_counts_them() {
    let template = "<template><name>P</name><parameter>const int[0,2] i</parameter>\n\
        <location id=\"a\"><name>idle</name></location><location id=\"b\"><name>cs</name></location><init ref=\"a\"/>\n\
        <transition><source ref=\"a\"/><target ref=\"b\"/><label kind=\"guard\">free</label>\
        <label kind=\"assignment\">free = false</label></transition>\n\
        <transition><source ref=\"b\"/><target ref=\"a\"/><label kind=\"assignment\">free = true</label></transition>\
        </template>";
    let model = format!(
        "<nta><declaration>bool free = true;</declaration>{template}<system>system P;</system></nta>"
    );
    let asked = [
        ("A[] (sum(i : int[0,2]) P(i).cs) <= 1", "satisfied"),
        ("A[] P(0).cs + P(1).cs + P(2).cs <= 1", "satisfied"),
        ("A[] P(0).cs + P(1).cs + P(2).cs == 1", "not_satisfied"),
        ("A[] P(0).idle + P(1).idle + P(2).idle >= 2", "satisfied"),
        ("E<> P(2).cs == 1", "satisfied"),
        ("E<> P(0).cs == P(1).cs && P(2).cs", "satisfied"),
        ("A[] P(0).cs == P(1).cs", "not_satisfied"),
        ("E<> (P(0).cs ? P(1).cs : P(2).cs)", "satisfied"),
        ("E<> P(0).cs && (P(0).cs ? P(1).cs : P(2).cs)", "not_satisfied"),
        ("A<> P(0).cs + P(1).cs > 0", "not_satisfied"),
        ("A[] (P(0).cs ? 2 : 1) < 3", "satisfied"),
    ];
    let queries: Vec<&str> = asked.iter().map(|a| a.0).collect();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("m.xml"), model).unwrap();
    fs::write(path.join("m.q"), queries.join("\n")).unwrap();
    expect_code(&hrdsl_in(path, "import uppaal m.xml m.q -o there.hri"), 0);
    expect_code(&hrdsl_in(path, "check there.hri"), 0);
    let verdicts = |file: &str| -> Vec<String> { answers(path, file).into_iter().map(|a| a.0).collect() };
    let stated: Vec<&str> = asked.iter().map(|a| a.1).collect();
    assert_eq!(verdicts("there.hri"), stated);
    expect_code(&hrdsl_in(path, "export uppaal there.hri -o back.xml"), 0);
    expect_code(&hrdsl_in(path, "import uppaal back.xml -o back.hri"), 0);
    assert_eq!(verdicts("back.hri"), stated);
}
