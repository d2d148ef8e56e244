//! Every snippet of the Visual Studio Code extension, left as it comes, is text that the parser reads.

use std::collections::{BTreeMap, BTreeSet};

use hrdsl_source::FileId;
use hrdsl_syntax::parse;
use serde_json::Value;

const SNIPPETS: &str = include_str!("../vscode/snippets/hrdsl.json");

/// What stands around the snippets that are members, by prefix.
const AROUND: &[(&[&str], &str, &str)] = &[
    (&["plan", "planon", "planf"], "agent A plays p {\n", "\n}"),
    (&["location", "edge"], "automaton A plays p {\n", "\n}"),
    (&["body"], "world {\n", "\n}"),
    (&["ros1"], "system s {\n", "\n}"),
    (&["topicin", "topicout"], "system s { ros1 {\n", "\n} }"),
];

fn snippets() -> BTreeMap<String, Value> {
    serde_json::from_str(SNIPPETS).unwrap()
}

fn body(snippet: &Value) -> String {
    let lines = snippet["body"].as_array().unwrap().iter().map(|l| l.as_str().unwrap());
    lines.collect::<Vec<_>>().join("\n")
}

/// The text of a snippet in which nobody has typed anything: stops are replaced by their defaults.
fn expanded(body: &str) -> String {
    let mut defaults = BTreeMap::new();
    let first = fill(body, &mut defaults);
    // A stop may be used before the place that has its default.
    let mut text = first;
    for (stop, default) in defaults.iter().rev() {
        text = text.replace(&format!("\u{1}{stop}\u{1}"), default);
    }
    text.replace("\u{1}0\u{1}", "")
}

/// Replaces `${n:default}` and `${n|a,b|}` by their texts, `$n` by a mark.
fn fill(body: &str, defaults: &mut BTreeMap<u32, String>) -> String {
    let (mut out, mut rest) = (String::new(), body);
    while let Some((before, after)) = rest.split_once('$') {
        out.push_str(before);
        if let Some(inner) = after.strip_prefix('{') {
            let end = closing(inner);
            let (field, tail) = (&inner[..end], &inner[end + 1..]);
            let digits = field.find(|c: char| !c.is_ascii_digit()).unwrap();
            let stop: u32 = field[..digits].parse().unwrap();
            let text = match &field[digits..=digits] {
                ":" => fill(&field[digits + 1..], defaults),
                "|" => field[digits + 1..].split([',', '|']).next().unwrap().to_owned(),
                other => panic!("`{other}` after the number of a stop"),
            };
            out.push_str(&text);
            assert!(defaults.insert(stop, text).is_none(), "the stop {stop} has two defaults");
            rest = tail;
        } else {
            let digits = after.find(|c: char| !c.is_ascii_digit()).unwrap_or(after.len());
            assert!(digits > 0, "`$` without a number");
            out.push_str(&format!("\u{1}{}\u{1}", &after[..digits]));
            rest = &after[digits..];
        }
    }
    out + rest
}

/// Where the brace that has been opened is closed.
fn closing(text: &str) -> usize {
    let mut depth = 0;
    let end = text.char_indices().find(|&(_, c)| {
        depth += i32::from(c == '{') - i32::from(c == '}');
        depth < 0
    });
    end.expect("a stop is closed").0
}

#[test]
fn every_snippet_is_read_without_an_error() {
    let mut faults = Vec::new();
    for (name, snippet) in snippets() {
        let prefix = snippet["prefix"].as_str().unwrap();
        let around = AROUND.iter().find(|a| a.0.contains(&prefix));
        let (before, after) = around.map_or(("", ""), |a| (a.1, a.2));
        let text = format!("{before}{}{after}\n", expanded(&body(&snippet)));
        assert!(!text.contains(['$', '\u{1}']), "{name}: not expanded: {text}");
        let (tree, diagnostics) = parse(FileId(0), &text);
        assert!(tree.scenario.is_some() || !tree.items.is_empty(), "{name} declares nothing");
        faults.extend(diagnostics.iter().map(|d| format!("{name}: {}\n{text}", d.message)));
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn prefixes_differ_and_are_explained() {
    let all = snippets();
    let prefixes: BTreeSet<_> = all.values().map(|s| s["prefix"].as_str().unwrap()).collect();
    assert_eq!(prefixes.len(), all.len());
    assert!(all.values().all(|s| !s["description"].as_str().unwrap().is_empty()));
    for member in AROUND.iter().flat_map(|a| a.0) {
        assert!(prefixes.contains(member), "there is no snippet `{member}`");
    }
}

#[test]
fn stops_are_expanded() {
    assert_eq!(expanded("a $2 ${1:b${2:c}} ${3|d,e|} $1$0"), "a c bc d bc");
}

#[test]
fn a_bad_snippet_is_noticed() {
    assert!(!parse(FileId(0), &expanded("agent ${1:A} plays { }")).1.is_empty());
}
