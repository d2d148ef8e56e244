//! What `deny.toml` allows of dependencies, held against `cargo metadata` as far as that needs no network: licences, sources and fences.
#![allow(clippy::disallowed_methods, reason = "tests start processes and read files")]

use std::{collections::BTreeMap, fs, path::Path, process::Command};

use serde_json::Value;

fn workspace() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

fn rules() -> toml::Table {
    fs::read_to_string(workspace().join("deny.toml")).unwrap().parse().unwrap()
}

/// All crates that the workspace is built or tested of on Linux, and who depends on whom.
fn metadata() -> Value {
    let words = ["metadata", "--format-version", "1", "--offline", "--all-features", "--filter-platform"];
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let out =
        Command::new(cargo).args(words).arg("x86_64-unknown-linux-gnu").current_dir(workspace()).output();
    let out = out.unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    serde_json::from_slice(&out.stdout).unwrap()
}

fn texts(list: &toml::Value) -> Vec<&str> {
    list.as_array().unwrap().iter().map(|text| text.as_str().unwrap()).collect()
}

/// The packages that may not be used, each with the reason.
fn refused(rules: &toml::Table, metadata: &Value) -> Vec<String> {
    let licences = texts(&rules["licenses"]["allow"]);
    let registries = texts(&rules["sources"]["allow-registry"]);
    let mut refused = Vec::new();
    for package in metadata["packages"].as_array().unwrap() {
        let name = package["name"].as_str().unwrap();
        let licence = package["license"].as_str().unwrap_or_default();
        let is_allowed = spdx::Expression::parse_mode(licence, spdx::ParseMode::LAX).is_ok_and(|e| {
            e.evaluate(|need| need.license.id().is_some_and(|id| licences.contains(&id.name)))
        });
        if !is_allowed {
            refused.push(format!("{name}: the licence {licence:?}"));
        }
        let source = package["source"].as_str();
        if !source.is_none_or(|s| s.strip_prefix("registry+").is_some_and(|s| registries.contains(&s))) {
            refused.push(format!("{name}: the source {source:?}"));
        }
    }
    refused
}

/// The dependencies that cross a fence: who depends on what only others may, or what nobody may.
fn crossed(rules: &toml::Table, metadata: &Value) -> Vec<String> {
    let packages = metadata["packages"].as_array().unwrap().iter();
    let names: BTreeMap<&str, &str> =
        packages.map(|p| (p["id"].as_str().unwrap(), p["name"].as_str().unwrap())).collect();
    let mut crossed = Vec::new();
    for node in metadata["resolve"]["nodes"].as_array().unwrap() {
        let who = names[node["id"].as_str().unwrap()];
        for needed in node["dependencies"].as_array().unwrap() {
            let needed = names[needed.as_str().unwrap()];
            let fences = rules["bans"]["deny"].as_array().unwrap().iter();
            let mut fences = fences.filter(|fence| fence["crate"].as_str() == Some(needed));
            if fences.any(|fence| !fence.get("wrappers").is_some_and(|w| texts(w).contains(&who))) {
                crossed.push(format!("{who} depends on {needed}"));
            }
        }
    }
    crossed
}

#[test]
fn what_is_depended_on_is_allowed() {
    let (rules, metadata) = (rules(), metadata());
    assert_eq!(refused(&rules, &metadata), Vec::<String>::new());
    assert_eq!(crossed(&rules, &metadata), Vec::<String>::new());
}

#[test]
fn what_is_not_allowed_is_found() {
    let mut rules = rules();
    rules["licenses"]["allow"] = toml::Value::from(vec!["MIT"]);
    rules["bans"]["deny"] = toml::Value::from(vec![toml::Value::from(toml::Table::from_iter([
        ("crate".to_owned(), "serde_json".into()),
        ("wrappers".to_owned(), vec!["hrdsl"].into()),
    ]))]);
    let metadata = metadata();
    assert!(refused(&rules, &metadata).iter().any(|line| line.contains("unicode-ident")));
    let crossed = crossed(&rules, &metadata);
    assert!(crossed.contains(&"hrdsl-results depends on serde_json".to_owned()), "{crossed:?}");
    assert!(!crossed.contains(&"hrdsl depends on serde_json".to_owned()));
}
