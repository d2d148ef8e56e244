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
    for (dependency, owner) in [
        ("rapier3d", "runtime/sim"),
        ("zstd", "runtime/recording"),
        ("logos", "compiler/syntax"),
        ("clap", "cli"),
    ] {
        for (name, (folder, _)) in from_cargo() {
            let manifest = std::fs::read_to_string(root().join(&folder).join("Cargo.toml")).unwrap();
            let has = manifest.lines().any(|l| l.starts_with(dependency));
            assert_eq!(has, folder == owner, "{name} and {dependency}");
        }
    }
}

/// The words in backquotes of a document that are paths, with the lines that they stand on.
fn paths_in(document: &str) -> Vec<(usize, String)> {
    const FILES: [&str; 12] =
        [".cjs", ".hri", ".js", ".json", ".lalrpop", ".md", ".py", ".rs", ".sh", ".toml", ".txt", ".yml"];
    let text = std::fs::read_to_string(root().join(document)).unwrap();
    let (mut found, mut in_block) = (Vec::new(), false);
    for (at, line) in text.lines().enumerate() {
        if line.trim_start().starts_with("```") {
            in_block = !in_block;
            continue;
        }
        let quoted = line.split('`').skip(1).step_by(2).filter(|_| !in_block);
        for word in quoted.flat_map(str::split_whitespace) {
            let word = word.trim_end_matches([',', ';', ':', '.']);
            // `//!` is a comment, `.hri` the end of names, `…` stands for what is left out, `-o` is an option.
            let is_none = word.starts_with("//") || word.starts_with(['.', '-']) && !word.contains('/');
            let is_path = word.contains('/') || FILES.iter().any(|f| word.ends_with(f));
            if is_path && !is_none && !word.contains('…') {
                found.push((at + 1, word.to_owned()));
            }
        }
    }
    found
}

/// `a/{b,c}.rs` as `a/b.rs` and `a/c.rs`.
fn alternatives(path: &str) -> Vec<String> {
    let Some((before, (inside, after))) =
        path.split_once('{').and_then(|(b, rest)| Some((b, rest.split_once('}')?)))
    else {
        return vec![path.to_owned()];
    };
    inside.split(',').map(|part| format!("{before}{part}{after}")).collect()
}

/// Whether a path leads to something; with a `*` in its last part, to something that begins and ends so.
fn is_there(path: &str) -> bool {
    let Some((before, after)) = path.split_once('*') else { return root().join(path).exists() };
    let (folder, begin) = before.rsplit_once('/').unwrap_or((".", before));
    let entries = std::fs::read_dir(root().join(folder)).into_iter().flatten().flatten();
    let mut names = entries.map(|e| e.file_name().to_string_lossy().into_owned());
    names.any(|n| n.starts_with(begin) && n.ends_with(after))
}

/// What only a run of hrdsl makes, and what many folders have.
const ANYWHERE: [&str; 5] = ["lib.rs", "main.rs", "results.json", "run.json", "tests.rs"];

#[test]
fn every_path_leads_somewhere() {
    let (mut faults, mut seen) = (Vec::new(), 0);
    for document in ["ARCHITECTURE.md", "CONTRIBUTING.md"] {
        let paths = paths_in(document);
        let paths = paths.iter().filter(|(_, p)| !p.contains(['=', '\'']) && !ANYWHERE.contains(&p.as_str()));
        for (line, path) in paths {
            seen += 1;
            let missing: Vec<String> = alternatives(path).into_iter().filter(|p| !is_there(p)).collect();
            faults.extend(missing.iter().map(|p| format!("{document}:{line}: `{p}` is not there")));
        }
    }
    assert!(seen > 150, "only {seen} paths were found: does the test still see them?");
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// The reading order is one that can be kept: a dozen files, none of them long.
#[test]
fn a_newcomer_reads_twelve_files() {
    let text = std::fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let (_, section) = text.split_once("\n## Where to begin reading\n").unwrap();
    let (section, _) = section.split_once("\n## ").unwrap();
    let files: Vec<&str> = section
        .lines()
        .filter_map(|l| l.split_once(". `")?.1.split_once('`'))
        .map(|(file, _)| file)
        .collect();
    assert_eq!(files.len(), 12, "{files:?}");
    for file in files {
        let lines = std::fs::read_to_string(root().join(file)).unwrap().lines().count();
        assert!(lines <= 600, "{file} has {lines} lines: nobody begins with that");
    }
}
