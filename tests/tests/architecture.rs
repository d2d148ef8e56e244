//! The crate table of ARCHITECTURE.md is what `cargo metadata` says.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
    process::Command,
};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().unwrap()
}

/// Crate, folder, and the workspace crates that it depends on (development dependencies left out).
fn from_cargo() -> BTreeMap<String, (String, BTreeSet<String>)> {
    let out = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--no-deps", "--offline"])
        .current_dir(root())
        .output()
        .unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let metadata: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    let packages = metadata["packages"].as_array().unwrap();
    let names: BTreeSet<&str> = packages.iter().map(|p| p["name"].as_str().unwrap()).collect();
    let entry = |p: &serde_json::Value| {
        let manifest = Path::new(p["manifest_path"].as_str().unwrap());
        let folder = manifest.parent().unwrap().strip_prefix(root()).unwrap();
        let normal = p["dependencies"].as_array().unwrap().iter().filter(|d| d["kind"].is_null());
        let own = normal.map(|d| d["name"].as_str().unwrap()).filter(|n| names.contains(n));
        let own = own.map(|n| n.trim_start_matches("hrdsl-").to_owned()).collect();
        (p["name"].as_str().unwrap().to_owned(), (folder.display().to_string(), own))
    };
    packages.iter().map(entry).collect()
}

fn from_document() -> BTreeMap<String, (String, BTreeSet<String>)> {
    let text = std::fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let rows = text.lines().filter(|l| l.starts_with("| hrdsl"));
    let row = |line: &str| {
        let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
        let [name, folder, _, may] = cells[..] else { panic!("a row of four cells: {line}") };
        let may = may.split(',').map(str::trim).filter(|c| *c != "–").map(str::to_owned).collect();
        (name.to_owned(), (folder.to_owned(), may))
    };
    rows.map(row).collect()
}

#[test]
fn the_crate_table_is_true() {
    let (cargo, document) = (from_cargo(), from_document());
    let names = |m: &BTreeMap<String, _>| m.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(&cargo), names(&document), "the crates");
    for (name, (folder, depends)) in &cargo {
        let (said, may) = &document[name];
        assert_eq!(folder, said, "the folder of {name}");
        let beyond: Vec<_> = depends.difference(may).collect();
        assert!(beyond.is_empty(), "{name} depends on {beyond:?}, which ARCHITECTURE.md does not allow");
    }
}

#[test]
fn heavy_dependencies_stay_behind_their_fences() {
    for (dependency, owner) in [("rapier3d", "runtime/sim"), ("logos", "compiler/syntax"), ("clap", "cli")] {
        for (name, (folder, _)) in from_cargo() {
            let manifest = std::fs::read_to_string(root().join(&folder).join("Cargo.toml")).unwrap();
            let has = manifest.lines().any(|l| l.starts_with(dependency));
            assert_eq!(has, folder == owner, "{name} and {dependency}");
        }
    }
}
