//! The rooms of each crate: its folders, and the files that lie beside them.

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt::Write,
    path::{Path, PathBuf},
    process::Command,
};

use crate::{
    arrows::{Arrows, arrows},
    knots::{Graph, knots},
    tree::{File, Tree},
};

/// The most files that may import each other.
const KNOT: usize = 3;

/// A crate of the workspace.
pub struct Package {
    pub name: String,
    /// From the root of the repository.
    pub folder: String,
    /// The crates of the workspace that it depends on.
    pub depends: BTreeSet<String>,
    /// By their path from `src`.
    pub files: BTreeMap<String, File>,
    pub arrows: Arrows,
    /// Roots of targets: façades, which may import everything.
    pub facades: BTreeSet<String>,
}

pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().unwrap()
}

/// All crates of the workspace, as `cargo metadata` has them.
pub fn packages() -> Vec<Package> {
    let out = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--no-deps", "--offline"])
        .current_dir(root())
        .output()
        .unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let metadata: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    let all = metadata["packages"].as_array().unwrap();
    let names: BTreeSet<&str> = all.iter().map(|p| p["name"].as_str().unwrap()).collect();
    all.iter().map(|p| package(p, &names)).collect()
}

fn package(metadata: &serde_json::Value, names: &BTreeSet<&str>) -> Package {
    let manifest = Path::new(metadata["manifest_path"].as_str().unwrap());
    let src = manifest.parent().unwrap().join("src");
    let normal = metadata["dependencies"].as_array().unwrap().iter().filter(|d| d["kind"].is_null());
    let own = normal.map(|d| d["name"].as_str().unwrap()).filter(|n| names.contains(n));
    let targets = metadata["targets"].as_array().unwrap().iter();
    let roots = targets.map(|t| Path::new(t["src_path"].as_str().unwrap())).filter(|p| p.starts_with(&src));
    let mut package = Package {
        name: metadata["name"].as_str().unwrap().to_owned(),
        folder: manifest.parent().unwrap().strip_prefix(root()).unwrap().display().to_string(),
        depends: own.map(str::to_owned).collect(),
        files: BTreeMap::new(),
        arrows: Arrows::new(),
        facades: BTreeSet::new(),
    };
    for root in roots {
        let mut tree = Tree::read(&src, root);
        package.arrows.extend(arrows(&tree));
        package.facades.insert(tree.modules[0].file.clone());
        package.files.append(&mut tree.files);
    }
    package
}

/// The room of a file: the folder directly under `src`, or the file itself.
pub fn room(file: &str) -> &str {
    file.split('/').next().unwrap_or(file).trim_end_matches(".rs")
}

impl Package {
    /// Folders directly under `src`.
    pub fn folders(&self) -> BTreeSet<&str> {
        let inside = self.files.keys().filter(|f| f.contains('/')).map(|f| room(f));
        inside.filter(|r| *r != "bin").collect()
    }

    /// Which room imports which; the façades are none.
    pub fn rooms(&self) -> Graph {
        let rooms = self.files.keys().filter(|f| !self.facades.contains(*f));
        let mut graph: Graph = rooms.map(|f| (room(f).to_owned(), BTreeSet::new())).collect();
        for (from, to) in &self.arrows {
            let others = to.keys().filter(|to| room(to) != room(from) && !self.facades.contains(*to));
            if let Some(room) = graph.get_mut(room(from)) {
                room.extend(others.map(|to| self::room(to).to_owned()));
            }
        }
        graph
    }

    /// Knots that are too large or go across folders, and what ties each.
    pub fn forbidden_knots(&self) -> Vec<(BTreeSet<String>, String)> {
        let graph: Graph =
            self.arrows.iter().map(|(from, to)| (from.clone(), to.keys().cloned().collect())).collect();
        let folder = |file: &String| file.contains('/').then(|| room(file).to_owned());
        let forbidden = |knot: &BTreeSet<String>| {
            let folders: BTreeSet<_> = knot.iter().map(folder).collect();
            // `part.rs` is the head of the folder `part`.
            let rooms: BTreeSet<_> = knot.iter().map(|f| room(f)).collect();
            knot.len() > KNOT || (folders.len() > 1 && rooms.len() > 1)
        };
        let told = |knot: BTreeSet<String>| {
            let text = self.ties(&|file| knot.contains(file).then(|| file.to_owned()));
            (knot, text)
        };
        knots(&graph).into_iter().filter(forbidden).map(told).collect()
    }

    /// Rooms, a folder among them, of which none is the lowest, and what ties them.
    pub fn cycles(&self) -> Vec<(BTreeSet<String>, String)> {
        let folders = self.folders();
        let told = |cycle: BTreeSet<String>| {
            let text = self.ties(&|file| cycle.contains(room(file)).then(|| room(file).to_owned()));
            (cycle, text)
        };
        let cycles = knots(&self.rooms()).into_iter();
        cycles.filter(|c| c.iter().any(|r| folders.contains(r.as_str()))).map(told).collect()
    }

    /// The arrows between different `place`s, some of each pair, with some of the names that make them.
    fn ties(&self, place: &dyn Fn(&str) -> Option<String>) -> String {
        let mut pairs: BTreeMap<(String, String), Vec<String>> = BTreeMap::new();
        for (from, to) in &self.arrows {
            for (to, names) in to {
                if let (Some(one), Some(other)) = (place(from), place(to))
                    && one != other
                {
                    let some: Vec<&str> = names.iter().take(6).map(String::as_str).collect();
                    let more = if names.len() > 6 { ", …" } else { "" };
                    let told = format!("    {from} -> {to}: {}{more}\n", some.join(", "));
                    pairs.entry((one, other)).or_default().push(told);
                }
            }
        }
        let mut text = String::new();
        for told in pairs.values() {
            text.extend(told.iter().take(4).map(String::as_str));
            if told.len() > 4 {
                let _ = writeln!(text, "    … and {} more like the last", told.len() - 4);
            }
        }
        text
    }
}
