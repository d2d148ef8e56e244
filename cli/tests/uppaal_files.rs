//! The files that UPPAAL's models come in: the textual format beside the XML, and files of queries.

mod support;

use std::fs;

use support::{
    expect_code, hrdsl_in, stderr,
    uppaal::{NO, SMALL, SmallModel, YES, answers},
};

const XTA: &str = "// Who waits, and gets in\nconst int N = 2; chan c; // told\nint[0,9] n;\n\
        process P(const int[0,1] id) {\n  clock x; // since it came\n\
          void more() { if (n < 9) { n++; } }\n\
          state a { x <= 5 }, b { ; 1 : 3 }, d;\n  branchpoint f;\n  commit d;\n  init a;\n\
          trans a -> b { select k : int[1,N]; guard x >= 2 && id == 0; sync c!; assign n = k, x = 0; },\n\
                -> d { guard id == 1; sync c?; assign more(); },\n  d -u-> a { assign x = 0; },\n\
                b -> f { guard x > 1; }, f -> a { assign n = 0; probability 3; }, f -> b { assign x = 0; probability 1; };\n}\n\
        // Both\nQ(const int[0,1] i) = P(i);\nsystem Q;\n";

/// What only statistical model checking asks for is kept as comments, and goes out again.
#[test]
fn rates_are_kept_there_and_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let model = "<nta><declaration>const int N = 3;</declaration>\
        <template><name>P</name><parameter>const int[1,2] id</parameter>\
        <location id=\"a\"><name>a</name><label kind=\"invariant\">true</label>\
        <label kind=\"exponentialrate\">N + id : 7</label></location>\
        <location id=\"b\"><name>b</name><label kind=\"exponentialrate\">0.5</label></location>\
        <location id=\"c\"><name>c</name></location><init ref=\"a\"/>\
        <transition><source ref=\"a\"/><target ref=\"b\"/></transition>\
        <transition><source ref=\"b\"/><target ref=\"c\"/></transition></template>\
        <system>system P;</system></nta>";
    fs::write(path.join("rates.xml"), model).unwrap();
    expect_code(&hrdsl_in(path, "import uppaal rates.xml -o rates.hri"), 0);
    expect_code(&hrdsl_in(path, "export uppaal rates.hri -o back.xml"), 0);
    let back = fs::read_to_string(path.join("back.xml")).unwrap();
    let rates = |text: &str| -> Vec<String> {
        let labels = text.split("<label kind=\"exponentialrate\"").skip(1);
        labels.map(|rest| rest.split(['>', '<']).nth(1).unwrap_or_default().to_owned()).collect()
    };
    assert_eq!(rates(&back), ["3 + 1 : 7", "0.5", "3 + 2 : 7", "0.5"], "{back}");
    // Once more: what was written is read to the same.
    expect_code(&hrdsl_in(path, "import uppaal back.xml -o again.hri"), 0);
    expect_code(&hrdsl_in(path, "export uppaal again.hri -o again.xml"), 0);
    assert_eq!(rates(&fs::read_to_string(path.join("again.xml")).unwrap()), rates(&back));
}

/// The textual format has the same in it: so have the scenarios.
#[test]
fn the_textual_format_is_read_to_the_same() {
    let model = SmallModel {
        global: "// Who waits, and gets in\nconst int N = 2; chan c; // told\nint[0,9] n;",
        parameters: "const int[0,1] id",
        local: "clock x; // since it came\n void more() { if (n < 9) { n++; } }",
        at_a: &[("invariant", "x <= 5")],
        edges: &[
            (
                "a",
                "b",
                &[
                    ("select", "k : int[1,N]"),
                    ("guard", "x >= 2 && id == 0"),
                    ("synchronisation", "c!"),
                    ("assignment", "n = k, x = 0"),
                ],
            ),
            ("a", "d", &[("guard", "id == 1"), ("synchronisation", "c?"), ("assignment", "more()")]),
            ("d", "a", &[("assignment", "x = 0")]),
            ("b", "f", &[("guard", "x > 1")]),
            ("f", "a", &[("assignment", "n = 0"), ("probability", "3")]),
            ("f", "b", &[("assignment", "x = 0"), ("probability", "1")]),
        ],
        system: "// Both\nQ(const int[0,1] i) = P(i);\nsystem Q;",
    };
    let xml = model
        .xml(&[])
        .replace(
            "<name>b</name></location>",
            "<name>b</name><label kind=\"exponentialrate\">1 : 3</label></location>\
             <location id=\"d\"><name>d</name><committed/></location><branchpoint id=\"f\"/>",
        )
        .replace("<transition><source ref=\"d\"/>", "<transition controllable=\"false\"><source ref=\"d\"/>");
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("small.xml"), xml).unwrap();
    fs::write(folder.path().join("small.xta"), XTA).unwrap();
    let read = |file: &str| {
        let out = hrdsl_in(folder.path(), &format!("import uppaal {file} --name small -o {file}.hri"));
        assert_eq!(out.status.code(), Some(0), "{}", stderr(&out));
        let text = fs::read_to_string(folder.path().join(format!("{file}.hri"))).unwrap();
        text.lines().skip(1).collect::<Vec<_>>().join("\n")
    };
    assert_eq!(read("small.xta"), read("small.xml"));
    fs::write(folder.path().join("small.q"), "// comes\nE<> Q(0).b\n\nA[] n < 3\nE<> Q(1).d and n == 3\n")
        .unwrap();
    assert_eq!(answers(folder.path(), "small.xta"), [YES, NO, YES]);
}

#[test]
fn old_texts_are_read_and_wrong_ones_have_their_places() {
    let folder = tempfile::tempdir().unwrap();
    // Old models have no parentheses, and no branchpoints; what is wrong has its place.
    let old = "process P { clock x; state a, b; init a; trans a -> b { guard x > 3; }; } system P;";
    fs::write(folder.path().join("old.ta"), old).unwrap();
    fs::write(folder.path().join("old.q"), "E<> P.b and P.x < 3\nE<> P.b").unwrap();
    assert_eq!(answers(folder.path(), "old.ta"), [NO, YES]);
    for (wrong, why) in [
        (old.replace("init a;", ""), "1:66: expected the initial state (`init`), found `}`"),
        (old.replace("-> b", "-> c"), "there is no state `c`"),
        (old.replace("guard", "gard"), "a label `gard` of a transition is not known"),
        (old.replace("x > 3;", "x > 3"), "expected"),
        (old.replace("state", "stat"), "the states of the process (`state`)"),
    ] {
        fs::write(folder.path().join("wrong.ta"), wrong).unwrap();
        let out = hrdsl_in(folder.path(), "import uppaal wrong.ta");
        expect_code(&out, 1);
        assert!(
            stderr(&out).contains("error: wrong.ta:1:") && stderr(&out).contains(why),
            "{why}: {}",
            stderr(&out)
        );
    }
}

#[test]
fn a_file_of_queries_takes_the_place_of_those_in_the_model() {
    let model = SmallModel { edges: &[("a", "b", &[])], ..SMALL };
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("m.xml"), model.xml(&["E<> P.b", "A[] P.a"])).unwrap();
    assert_eq!(answers(folder.path(), "m.xml"), [YES, NO]);
    fs::write(folder.path().join("other.q"), "A[] not P.b\n").unwrap();
    assert_eq!(answers(folder.path(), "m.xml other.q"), [NO]);
    let out = hrdsl_in(folder.path(), "import uppaal m.xml other.q -o there.hri");
    assert!(
        stderr(&out).contains("info: the queries of the model give way to those of other.q"),
        "{}",
        stderr(&out)
    );
    fs::write(folder.path().join("m.q"), "E<> P.a\nE<> P.a and P.b\n").unwrap();
    assert_eq!(answers(folder.path(), "m.xml"), [YES, NO]);
    let out = hrdsl_in(folder.path(), "import uppaal m.xml -o there.hri");
    assert!(stderr(&out).contains("m.q:1:1: info: its queries are asked"), "{}", stderr(&out));
    assert_eq!(answers(folder.path(), "m.xml other.q"), [NO]);
}
