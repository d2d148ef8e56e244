//! The schema on the pages is that of the types, and documents of all kinds keep to it.
#![allow(clippy::disallowed_methods, reason = "tests read the schema")]

use std::path::{Path, PathBuf};

use hrdsl_viewer::ViewDocument;
use serde_json::Value;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

#[test]
fn the_schema_is_that_of_the_types() {
    let now = hrdsl_viewer::schema().unwrap();
    let path = root().join("spec/view.schema.json");
    if std::env::var_os("HRDSL_UPDATE").is_some() {
        std::fs::write(&path, &now).unwrap();
    }
    assert_eq!(now, std::fs::read_to_string(path).unwrap(), "update with HRDSL_UPDATE=1");
}

/// The document that the tests of the page read, too: it has every field.
fn example() -> Value {
    let text = std::fs::read_to_string(root().join("viewer/test/every-field.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

#[test]
fn a_document_with_every_field_is_valid_and_reads_back() {
    let schema: Value = serde_json::from_str(&hrdsl_viewer::schema().unwrap()).unwrap();
    let validator = jsonschema::validator_for(&schema).unwrap();
    let faults: Vec<String> = validator.iter_errors(&example()).map(|e| e.to_string()).collect();
    assert_eq!(faults, Vec::<String>::new());
    let read: ViewDocument = serde_json::from_value(example()).unwrap();
    assert_eq!(plain(serde_json::to_value(read).unwrap()), plain(example()));
    let empty = serde_json::to_value(ViewDocument::new()).unwrap();
    assert!(validator.is_valid(&empty));
}

/// Numbers as floats: `1` and `1.0` are the same to whoever reads JSON.
fn plain(value: Value) -> Value {
    match value {
        Value::Number(n) => Value::from(n.as_f64().unwrap()),
        Value::Array(all) => all.into_iter().map(plain).collect(),
        Value::Object(all) => all.into_iter().map(|(k, v)| (k, plain(v))).collect(),
        other => other,
    }
}

#[test]
fn the_example_leaves_no_field_out() {
    let schema: Value = serde_json::from_str(&hrdsl_viewer::schema().unwrap()).unwrap();
    let text = example().to_string();
    let definitions = schema["$defs"].as_object().unwrap().iter().filter(|(name, _)| *name != "SharedAssets");
    let objects = definitions.map(|(_, d)| d).chain([&schema]);
    let variants = objects.flat_map(|d| d["oneOf"].as_array().cloned().unwrap_or_else(|| vec![d.clone()]));
    let mut missing = Vec::new();
    for object in variants {
        for (field, of) in object["properties"].as_object().into_iter().flatten() {
            // A tag: each variant has to be there.
            let said = of["const"].as_str().map(|v| format!("\"{field}\":\"{v}\""));
            let said = said.unwrap_or_else(|| format!("\"{field}\":"));
            if !text.contains(&said) {
                missing.push(said);
            }
        }
    }
    assert_eq!(missing, Vec::<String>::new());
}
