//! The page of the modules, `ARCHITECTURE-modules.md`.

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt::Write,
};

use crate::{
    knots::{Graph, floors, without_shortcuts},
    rooms::{Package, room},
};

const HEAD: &str = "\
# The house, room by room

Every crate, every folder, every file: what it is for in one sentence, and what it uses. A *room* is a folder directly under a crate's
`src`, or a file that lies there. What is higher uses what is lower, never the other way round; `lib.rs` and `main.rs` are façades, which see all
rooms. [ARCHITECTURE.md](ARCHITECTURE.md) says why the house is built so.

This page is made from the sources by `HRDSL_UPDATE=1 cargo test -p hrdsl-tests --test modules`; the test compares it and finds files
that import each other in circles.

";

/// The whole page.
pub fn page(packages: &[Package]) -> String {
    let mut out = HEAD.to_owned();
    let graph: Graph = packages.iter().map(|p| (p.name.clone(), p.depends.clone())).collect();
    out.push_str("## The crates\n\n");
    mermaid(&mut out, &without_shortcuts(&graph), &BTreeSet::new());
    out.push_str("\nFrom the highest floor to the lowest; arrows that a longer way replaces are left out.\n");
    for (floor, names) in by_floor(&graph) {
        let _ = writeln!(out, "\n## Floor {floor}");
        for package in names.iter().filter_map(|n| packages.iter().find(|p| p.name == **n)) {
            section(&mut out, package);
        }
    }
    out
}

fn section(out: &mut String, package: &Package) {
    let _ = writeln!(out, "\n### {}\n", package.name);
    let root = package.files.iter().find(|(name, _)| ["lib.rs", "main.rs"].contains(&name.as_str()));
    let said = root.and_then(|(_, f)| f.sentence.as_deref());
    let said =
        without_links(said.unwrap_or_else(|| panic!("{} does not say what it is for", package.folder)));
    let _ = writeln!(out, "`{}`: {said}.", package.folder);
    let rooms = package.rooms();
    if rooms.is_empty() {
        return;
    }
    let folders = package.folders();
    if folders.len() >= 2 {
        out.push('\n');
        mermaid(out, &without_shortcuts(&rooms), &folders);
    }
    out.push_str("\n| room | file | what it is for | uses |\n|---|---|---|---|\n");
    for (_, names) in by_floor(&rooms) {
        for name in names {
            let shown = if folders.contains(name.as_str()) { format!("**{name}/**") } else { name.clone() };
            row_by_row(out, package, name, &shown, &rooms[name]);
        }
    }
}

/// The files of a room; its name and what it uses stand in the first row.
fn row_by_row(out: &mut String, package: &Package, name: &str, shown: &str, uses: &BTreeSet<String>) {
    let inside = package.files.iter().filter(|(file, _)| room(file) == name);
    let mut files: Vec<_> = inside.filter(|(file, _)| !package.facades.contains(*file)).collect();
    // The head of a folder comes first, then what is in it, then the folders in it.
    let head = |file: &str| file == format!("{name}.rs") || file == format!("{name}/mod.rs");
    files.sort_by_key(|(file, _)| (!head(file), file.matches('/').count(), file.as_str()));
    let uses = uses.iter().cloned().collect::<Vec<_>>().join(", ");
    for (at, (file, said)) in files.into_iter().enumerate() {
        let (room, uses) = if at == 0 { (shown, uses.as_str()) } else { ("", "") };
        let said = said.sentence.as_deref();
        let said = said.unwrap_or_else(|| panic!("{}/{file} does not say what it is for", package.folder));
        let said = without_links(said).replace('|', "\\|");
        let _ = writeln!(out, "| {room} | `{file}` | {said} | {uses} |");
    }
}

/// Links of doc comments lead nowhere on a page: only their text stays.
fn without_links(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some((before, (link, after))) =
        rest.split_once('[').and_then(|(b, a)| Some((b, a.split_once(']')?)))
    {
        out.push_str(before);
        out.push_str(link);
        let target = after.strip_prefix('(').and_then(|a| a.split_once(')'));
        rest = target.map_or(after, |(_, after)| after);
    }
    out + rest
}

fn by_floor(graph: &Graph) -> Vec<(usize, Vec<&String>)> {
    let floors = floors(graph);
    let mut by: BTreeMap<usize, Vec<&String>> = BTreeMap::new();
    for name in graph.keys() {
        by.entry(floors[name]).or_default().push(name);
    }
    by.into_iter().rev().collect()
}

/// Those in `folders` are drawn as boxes, all others are round.
fn mermaid(out: &mut String, graph: &Graph, folders: &BTreeSet<&str>) {
    out.push_str("```mermaid\nflowchart TD\n");
    let id = |name: &str| format!("n_{}", name.replace('-', "_"));
    for name in graph.keys() {
        let (open, close) = if folders.contains(name.as_str()) { ("[", "/]") } else { ("(", ")") };
        let close = close.replace("/]", "/\"]").replace(')', "\")");
        let _ = writeln!(out, "  {}{open}\"{name}{close}", id(name));
    }
    for (from, to) in graph {
        for to in to {
            let _ = writeln!(out, "  {} --> {}", id(from), id(to));
        }
    }
    out.push_str("```\n");
}
