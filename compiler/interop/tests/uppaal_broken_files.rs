//! Files of UPPAAL that are cut off, changed at random, deep or long: no file breaks the import.
#![allow(clippy::disallowed_methods, reason = "tests read files")]

use std::{fs, path::Path};

use hrdsl_interop::{
    ForeignSource, ImportedScenario, SyntaxError,
    uppaal::{UppaalOptions, import},
};
use hrdsl_source::FileId;

fn from_text(text: &str, queries: &str) -> Result<ImportedScenario, Vec<SyntaxError>> {
    let model = ForeignSource { name: "m.xml".to_owned(), text: text.to_owned() };
    let queries = ForeignSource { name: "m.q".to_owned(), text: queries.to_owned() };
    import(&model, Some(&queries), &UppaalOptions::default())
}

/// The text can be read, and is in the style of the language.
fn is_readable(text: &str) {
    let (_, diagnostics) = hrdsl_syntax::parse(FileId(0), text);
    let said: Vec<String> = diagnostics.iter().map(|d| d.message.clone()).collect();
    assert_eq!(said, Vec::<String>::new(), "{text}");
    assert_eq!(hrdsl_syntax::format(text).unwrap(), text);
}

/// A file that is cut off, or in which something is missing, doubled or exchanged, is an error or a scenario, and
/// never the end of the program.
#[test]
fn no_file_breaks_the_import() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/uppaal");
    let text = fs::read_to_string(root.join("handover.xml")).unwrap();
    let places: Vec<usize> = text.char_indices().map(|(i, _)| i).collect();
    let (mut refused, mut read) = (0, 0);
    let mut seed = 12_345_u64;
    let mut next = |n: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize % n
    };
    let swaps = [
        "&lt;",
        "(",
        "]",
        "{",
        "<location",
        "&#x0;",
        "int",
        "++",
        "'",
        "9999999999",
        "forall (i : sensor_t)",
        "\u{1F916}",
    ];
    for round in 0..600 {
        let start = places[next(places.len())];
        let length = [1, 3, 20, 200][next(4)];
        let end = places.get(places.partition_point(|p| *p < start) + length).copied().unwrap_or(text.len());
        let changed = match round % 4 {
            0 => text[..start].to_owned(),
            1 => format!("{}{}", &text[..start], &text[end..]),
            2 => format!("{}{}{}", &text[..end], &text[start..end], &text[end..]),
            _ => format!("{}{}{}", &text[..start], swaps[next(swaps.len())], &text[end..]),
        };
        match from_text(&changed, "E<> Human.Told\nA[] not deadlock") {
            Ok(imported) => {
                read += 1;
                is_readable(&imported.text);
            }
            Err(errors) => {
                refused += 1;
                assert!(!errors.is_empty() && errors.iter().all(|e| e.line > 0 && !e.message.is_empty()));
            }
        }
    }
    assert!(refused > 300 && read > 5, "{refused} refused, {read} read");
}

#[test]
fn deep_and_long_texts_are_errors() {
    let nested = format!("int n = {}1{};", "(".repeat(10_000), ")".repeat(10_000));
    let long = format!("int n = {}1;", "1 + ".repeat(10_000));
    let indexed = format!("int n = m{};", "[0]".repeat(10_000));
    let blocks = format!("void f() {{ {} }}", "{".repeat(10_000));
    let with = |global: &str| {
        let text = format!(
            "<nta><declaration>{global}</declaration><template><name>P</name><location id=\"a\"/>\
             <init ref=\"a\"/></template><system>system P;</system></nta>"
        );
        from_text(&text, "")
    };
    assert!(with("int n = 1;").is_ok());
    assert!([nested, long, indexed, blocks].iter().all(|global| with(global).is_err()));
}

fn faults(name: &str, text: &str) -> Vec<String> {
    let model = ForeignSource { name: name.to_owned(), text: text.to_owned() };
    let errors = import(&model, None, &UppaalOptions::default()).unwrap_err();
    errors.into_iter().map(|e| format!("{}:{}: {}", e.line, e.column, e.message)).collect()
}

#[test]
fn what_is_wrong_in_several_places_is_told_at_once() {
    let xml = "<nta><declaration>int[0,5] a = 7;\nint n;\nclock c;</declaration>\n\
        <template><name>T</name><location id=\"a\"/><location id=\"b\"/><init ref=\"a\"/>\n\
        <transition><source ref=\"a\"/><target ref=\"b\"/><label kind=\"guard\">foo == 1</label>\n\
        <label kind=\"assignment\">a = 1, n = c</label></transition>\n\
        <transition><source ref=\"b\"/><target ref=\"zz\"/></transition></template>\n\
        <system>system T;</system></nta>";
    let all = faults("m.xml", xml);
    // `a`, whose declaration is at fault, is not missed where it is used.
    let expected = ["1:", "5:", "6:", "7:"];
    assert!(all.len() >= 3, "{all:?}");
    assert!(all.iter().all(|fault| expected.iter().any(|line| fault.starts_with(line))), "{all:?}");
    assert!(all.iter().any(|fault| fault.contains("there is no location with the id `zz`")), "{all:?}");
    assert!(all.iter().any(|fault| fault.contains("there is no `foo` here")), "{all:?}");
    assert!(!all.iter().any(|fault| fault.contains("there is no `a` here")), "{all:?}");

    let xta = "clock c;\n\
        process T() { state A { c <= zz }, B; init A;\ntrans A -> B { guard foo > 1; },\nB -> C { guard c > 1; }; }\n\
        process U() { state D; init E; trans D -> D { guard bar == 1; }; }\n\
        process V() { state F; init F; trans F -> F { guard; effect x; }; }\nsystem T, U;\n";
    let all = faults("m.xta", xta);
    let said: Vec<&str> = all.iter().map(String::as_str).collect();
    for (fault, line) in
        [("`zz`", "2:"), ("`foo`", "3:"), ("`C`", "4:"), ("`E`", "5:"), ("`bar`", "5:"), ("`effect`", "6:")]
    {
        assert!(said.iter().any(|s| s.starts_with(line) && s.contains(fault)), "{fault}: {all:?}");
    }
}

#[test]
fn a_process_that_cannot_be_read_ends_at_its_bracket() {
    let all = faults(
        "m.xta",
        "process T() { state A, ; init A; { } }\nprocess U() { state B; init C; }\nsystem T, U;\n",
    );
    let lines: Vec<&str> = all.iter().map(|fault| &fault[..1]).collect();
    assert_eq!(lines, ["1", "2"], "{all:?}");
}
