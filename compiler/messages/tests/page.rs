//! `spec/messages.md` and the sources: its tables of packages and of bounds, its example of a table.
//! `HRDSL_UPDATE=1` writes the tables.

#![allow(clippy::disallowed_methods, reason = "the test reads and writes the page")]

mod common;

use std::{collections::BTreeSet, env, fmt::Write, fs, path::Path};

use common::{packages, standard};
use hrdsl_messages::{InterfaceName, InterfaceSpace, RosVersion, limits};

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../spec/messages.md");

fn page() -> String {
    fs::read_to_string(Path::new(PAGE)).unwrap()
}

/// What stands between `<!-- NAME -->` and `<!-- end -->`.
fn generated(name: &str, text: &str) {
    let old = page();
    let start = format!("<!-- {name} -->\n");
    let (before, rest) =
        old.split_once(&start).unwrap_or_else(|| panic!("the page has no `{}`", start.trim()));
    let (_, after) = rest.split_once("<!-- end -->").unwrap();
    let new = format!("{before}{start}\n{}\n\n<!-- end -->{after}", text.trim());
    if env::var_os("HRDSL_UPDATE").is_some() {
        fs::write(PAGE, new).unwrap();
    } else {
        assert!(old == new, "spec/messages.md differs from the code: update `{name}` with HRDSL_UPDATE=1");
    }
}

/// Both tables, one after the other: they are written to one file.
#[test]
fn its_tables_are_true() {
    let both = [RosVersion::Ros1, RosVersion::Ros2];
    let names: BTreeSet<&str> =
        both.iter().flat_map(|version| packages(*version)).map(|(name, _)| *name).collect();
    let mut table = String::from(
        "| package | ROS 1: messages | services | actions | ROS 2: messages | services | actions |\n",
    );
    table += "|---|---|---|---|---|---|---|\n";
    for name in names {
        let _ = write!(table, "| `{name}` |");
        for version in both {
            let text = packages(version).iter().find(|(package, _)| *package == name).map(|(_, text)| text);
            for space in InterfaceSpace::ALL {
                let head = format!("== {}/", space.folder());
                let count =
                    text.map_or(0, |text| text.lines().filter(|line| line.starts_with(&head)).count());
                let _ = write!(table, " {} |", if count == 0 { String::new() } else { count.to_string() });
            }
        }
        table.push('\n');
    }
    generated("packages", &table);

    let bounds = [
        ("bytes of a file with a definition, and of a `package.xml`", limits::MOST_BYTES as u64),
        ("characters of a name", limits::MOST_NAME_BYTES as u64),
        ("fields and constants of a message", limits::MOST_MEMBERS as u64),
        ("messages within messages", limits::MOST_DEPTH.into()),
        (
            "values in a message whose sequences are empty: arrays of a fixed size, multiplied",
            limits::MOST_FIXED_VALUES,
        ),
        ("elements of an array, characters of a string, where a bound says how many", u32::MAX.into()),
        ("faults that are told of one definition", limits::MOST_FAULTS as u64),
        ("files of a workspace that are read", limits::MOST_FILES as u64),
        ("folders of a workspace that are looked into", limits::MOST_FOLDERS as u64),
        ("folders between a workspace and its packages", limits::MOST_FOLDER_DEPTH as u64),
    ];
    let row = |(what, most): (&str, u64)| format!("| {what} | {most} |\n");
    let rows: String = bounds.into_iter().map(row).collect();
    generated("bounds", &format!("| of | at most |\n|---|---|\n{rows}"));
}

#[test]
fn its_example_is_a_table() {
    let page = page();
    let (_, rest) = page.split_once("```json\n").unwrap();
    let (block, _) = rest.split_once("```").unwrap();
    let said: serde_json::Value = serde_json::from_str(block).unwrap();
    let library = standard(RosVersion::Ros1);
    let string = InterfaceName::message("std_msgs", "String");
    let empty = InterfaceName::new("std_srvs", InterfaceSpace::Srv, "Empty");
    let mut table = serde_json::to_value(library.closure(&[string, empty]).unwrap()).unwrap();
    // The page leaves out the two messages without fields.
    let messages = table["messages"].as_array_mut().unwrap();
    messages.retain(|m| m["package"] == "std_msgs");
    assert_eq!(said, table);
}
