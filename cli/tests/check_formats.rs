//! `hrdsl check --format`: the same findings for people, as JSON and as SARIF.

mod support;

use std::collections::BTreeSet;

use hrdsl_source::REGISTRY;
use serde_json::Value;
use support::{expect_code, folder, handover, hrdsl, hrdsl_in, scenario, stderr, stdout};

const BROKEN: &str = include_str!("broken/scenario.hri");

fn broken(format: &str) -> std::process::Output {
    let folder = folder(&[("cups/scenario.hri", BROKEN)]);
    let out = hrdsl_in(folder.path(), &format!("check cups --format {format}"));
    expect_code(&out, 1);
    out
}

#[test]
fn people_read_it_on_stderr() {
    let out = broken("human");
    assert_eq!(stdout(&out), "");
    insta::assert_snapshot!(stderr(&out));
}

#[test]
fn json_is_one_document_on_stdout() {
    let out = broken("json");
    assert_eq!(stderr(&out), "");
    let document: Value = serde_json::from_slice(&out.stdout).unwrap();
    let places = places(&document);
    assert!(places.len() >= 10, "{places:?}");
    for place in places {
        for point in [&place["start"], &place["end"]] {
            let byte = point["byte"].as_u64().unwrap() as usize;
            let before = &BROKEN[..byte];
            let line = before.matches('\n').count() + 1;
            let column = before.rsplit('\n').next().unwrap().chars().count() + 1;
            assert_eq!(point["line"], line, "{place}");
            assert_eq!(point["column"], column, "{place}");
        }
        assert_eq!(place["file"], "cups/scenario.hri");
    }
    insta::assert_snapshot!(stdout(&out));
}

/// All objects that have a start and an end.
fn places(value: &Value) -> Vec<&Value> {
    match value {
        Value::Object(map) if map.contains_key("start") => vec![value],
        Value::Object(map) => map.values().flat_map(places).collect(),
        Value::Array(all) => all.iter().flat_map(places).collect(),
        _ => Vec::new(),
    }
}

/// What the three say is the same.
#[test]
fn the_formats_agree() {
    let human = stderr(&broken("human"));
    let json: Value = serde_json::from_slice(&broken("json").stdout).unwrap();
    let sarif: Value = serde_json::from_slice(&broken("sarif").stdout).unwrap();
    let json = json["diagnostics"].as_array().unwrap();
    let sarif = sarif["runs"][0]["results"].as_array().unwrap();
    assert_eq!(json.len(), sarif.len());
    for (a, b) in json.iter().zip(sarif) {
        let message = a["message"].as_str().unwrap();
        assert_eq!(a["code"], b["ruleId"]);
        assert_eq!(a["severity"], b["level"]);
        assert!(b["message"]["text"].as_str().unwrap().starts_with(message));
        assert!(human.contains(message), "{message}");
        let region = &b["locations"][0]["physicalLocation"]["region"];
        assert_eq!(a["labels"][0]["start"]["line"], region["startLine"]);
        assert_eq!(a["labels"][0]["end"]["column"], region["endColumn"]);
        assert_eq!(a["fixes"].as_array().unwrap().len(), b["fixes"].as_array().map_or(0, Vec::len));
    }
}

#[test]
fn sarif_is_valid_and_says_the_same() {
    let out = broken("sarif");
    assert_eq!(stderr(&out), "");
    let mut log: Value = serde_json::from_slice(&out.stdout).unwrap();
    sarif(&log);
    // The rules are the pages, which have tests of their own.
    log["runs"][0]["tool"]["driver"].as_object_mut().unwrap().remove("rules");
    for result in log["runs"][0]["results"].as_array_mut().unwrap() {
        result.as_object_mut().unwrap().remove("ruleIndex");
    }
    insta::assert_snapshot!(serde_json::to_string_pretty(&log).unwrap());
}

#[test]
fn a_scenario_without_faults_gives_empty_lists() {
    let out = hrdsl(["check", "--format", "sarif", handover().to_str().unwrap()]);
    expect_code(&out, 0);
    let log: Value = serde_json::from_slice(&out.stdout).unwrap();
    sarif(&log);
    assert_eq!(log["runs"][0]["results"], Value::Array(Vec::new()));
    let uri = log["runs"][0]["artifacts"][0]["location"]["uri"].as_str().unwrap();
    assert!(uri.starts_with("file:///"), "{uri}");

    let folder = folder(&[("a b/scenario.hri", &scenario("one", "ask")), ("a b/t.hri", "test t { ask }\n")]);
    let out = hrdsl_in(folder.path(), "check . --format json");
    expect_code(&out, 0);
    let document: Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!(document["diagnostics"], Value::Array(Vec::new()));
    assert_eq!(document["summary"]["errors"], 0);
    let file = |i: usize, key: &str| document["files"][i][key].as_str().unwrap().to_owned();
    assert_eq!([file(0, "path"), file(0, "kind")], ["a b/scenario.hri", "scenario"]);
    assert_eq!([file(1, "kind"), file(1, "with")], ["tests", "a b/scenario.hri"]);
}

// ── SARIF 2.1.0, as far as its schema demands it of what is written here ──

/// Fails where a log breaks the schema: required properties, their types, and no properties that the schema lacks.
fn sarif(log: &Value) {
    object(log, &["version", "runs"], &["$schema"]);
    assert_eq!(log["version"], "2.1.0");
    for run in array(&log["runs"]) {
        object(run, &["tool"], &["results", "artifacts", "columnKind"]);
        assert!(["utf16CodeUnits", "unicodeCodePoints"].contains(&string(&run["columnKind"])));
        object(&run["tool"], &["driver"], &[]);
        let driver = &run["tool"]["driver"];
        object(driver, &["name"], &["version", "semanticVersion", "informationUri", "rules"]);
        assert!(string(&driver["informationUri"]).starts_with("https://"));
        let rules = array(&driver["rules"]);
        rules.iter().for_each(rule);
        let ids: Vec<&str> = rules.iter().map(|r| string(&r["id"])).collect();
        assert_eq!(ids, REGISTRY.iter().map(|i| i.code.to_string()).collect::<Vec<_>>());
        assert_eq!(ids.iter().collect::<BTreeSet<_>>().len(), ids.len(), "ids are unique");
        for artifact in array(&run["artifacts"]) {
            object(artifact, &[], &["location"]);
            artifact_location(&artifact["location"]);
        }
        for result in array(&run["results"]) {
            self::result(result, &ids);
        }
    }
}

fn rule(rule: &Value) {
    object(rule, &["id"], &["shortDescription", "help", "helpUri", "properties"]);
    message(&rule["shortDescription"]);
    object(&rule["help"], &["text"], &["markdown"]);
    assert!(string(&rule["help"]["markdown"]).contains("```hri"), "the page");
    assert!(string(&rule["helpUri"]).ends_with(&format!("spec/codes/{}.md", string(&rule["id"]))));
    assert!(rule["properties"].is_object());
}

fn result(result: &Value, rules: &[&str]) {
    object(result, &["message"], &["ruleId", "ruleIndex", "level", "locations", "relatedLocations", "fixes"]);
    message(&result["message"]);
    assert!(["none", "note", "warning", "error"].contains(&string(&result["level"])));
    assert_eq!(string(&result["ruleId"]), rules[result["ruleIndex"].as_u64().unwrap() as usize]);
    array(&result["locations"]).iter().for_each(location);
    let related = result.get("relatedLocations").map_or(&[][..], array);
    related.iter().for_each(location);
    let ids: BTreeSet<u64> = related.iter().map(|l| l["id"].as_u64().unwrap()).collect();
    assert_eq!(ids.len(), related.len(), "ids are unique in a result");
    for fix in result.get("fixes").map_or(&[][..], array) {
        object(fix, &["artifactChanges"], &["description", "properties"]);
        message(&fix["description"]);
        assert!(fix["properties"]["certain"].is_boolean());
        assert!(!array(&fix["artifactChanges"]).is_empty(), "at least one change");
        for change in array(&fix["artifactChanges"]) {
            object(change, &["artifactLocation", "replacements"], &[]);
            artifact_location(&change["artifactLocation"]);
            assert!(!array(&change["replacements"]).is_empty(), "at least one replacement");
            for replacement in array(&change["replacements"]) {
                object(replacement, &["deletedRegion"], &["insertedContent"]);
                region(&replacement["deletedRegion"]);
                object(&replacement["insertedContent"], &[], &["text"]);
                string(&replacement["insertedContent"]["text"]);
            }
        }
    }
}

fn location(location: &Value) {
    object(location, &[], &["id", "physicalLocation", "message"]);
    let physical = &location["physicalLocation"];
    object(physical, &["artifactLocation"], &["region"]);
    artifact_location(&physical["artifactLocation"]);
    region(&physical["region"]);
    if let Some(text) = location.get("message") {
        message(text);
    }
}

fn artifact_location(location: &Value) {
    object(location, &[], &["uri"]);
    let uri = string(&location["uri"]);
    let allowed = |c: char| c.is_ascii_alphanumeric() || "-._~/%:".contains(c);
    assert!(!uri.is_empty() && uri.chars().all(allowed), "{uri}");
}

/// Lines and columns count from 1, and a region does not end before it starts.
fn region(region: &Value) {
    object(region, &[], &["startLine", "startColumn", "endLine", "endColumn"]);
    let number = |key: &str| region[key].as_u64().filter(|n| *n >= 1).unwrap();
    let (start, end) =
        ((number("startLine"), number("startColumn")), (number("endLine"), number("endColumn")));
    assert!(start <= end, "{region}");
}

fn message(message: &Value) {
    object(message, &["text"], &[]);
    assert!(!string(&message["text"]).is_empty());
}

fn object(value: &Value, required: &[&str], allowed: &[&str]) {
    let map = value.as_object().unwrap_or_else(|| panic!("no object: {value}"));
    for key in required {
        assert!(map.contains_key(*key), "`{key}` is missing: {value}");
    }
    for key in map.keys() {
        assert!(required.contains(&key.as_str()) || allowed.contains(&key.as_str()), "`{key}`: {value}");
    }
}

fn array(value: &Value) -> &[Value] {
    value.as_array().unwrap_or_else(|| panic!("no array: {value}"))
}

fn string(value: &Value) -> &str {
    value.as_str().unwrap_or_else(|| panic!("no string: {value}"))
}
