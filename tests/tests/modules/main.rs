//! The graph of the modules: no large knots, no circles of folders, one sentence for each file; and the page that shows it.

mod arrows;
mod knots;
mod page;
mod rooms;
mod tree;

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt::Write,
    fs,
    path::Path,
    sync::LazyLock,
};

use rooms::{Package, packages, root};

/// They are read once for all tests.
static PACKAGES: LazyLock<Vec<Package>> = LazyLock::new(packages);

/// What is tied in a crate: knots of more files than may be, or across folders; and rooms that import each other in circles.
fn tied(package: &Package) -> String {
    let mut told = String::new();
    for (files, ties) in package.forbidden_knots() {
        let _ = writeln!(told, "  {} files import each other:\n{ties}", files.len());
    }
    for (rooms, ties) in package.cycles() {
        let rooms: Vec<&str> = rooms.iter().map(String::as_str).collect();
        let _ = writeln!(told, "  no order of the rooms {}:\n{ties}", rooms.join(", "));
    }
    told
}

#[test]
fn files_import_in_one_direction() {
    let told = PACKAGES.iter().map(|package| (&package.name, tied(package)));
    let faults: String =
        told.filter(|(_, told)| !told.is_empty()).map(|(name, told)| format!("{name}:\n{told}")).collect();
    assert!(faults.is_empty(), "{faults}");
}

#[test]
fn every_file_says_what_it_is_for() {
    let mut silent = Vec::new();
    for package in &*PACKAGES {
        let files = package.files.iter().filter(|(_, file)| file.sentence.is_none());
        silent.extend(files.map(|(name, _)| format!("{}/src/{name}", package.folder)));
    }
    assert!(silent.is_empty(), "these begin without a sentence (`//! …`):\n{}", silent.join("\n"));
}

#[test]
fn the_page_is_true() {
    let now = page::page(&PACKAGES);
    let path = root().join("ARCHITECTURE-modules.md");
    if std::env::var_os("HRDSL_UPDATE").is_some() {
        fs::write(path, now).unwrap();
        return;
    }
    let kept = fs::read_to_string(path).unwrap_or_default();
    assert!(
        kept == now,
        "ARCHITECTURE-modules.md is old: HRDSL_UPDATE=1 cargo test -p hrdsl-tests --test modules"
    );
}

/// Files of a small crate, and the arrows `FROM -> TO: NAMES` between them.
fn arrows_of(name: &str, files: &[(&str, &str)]) -> Vec<String> {
    let src = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    for (file, text) in files {
        let path = src.join(file);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    let tree = tree::Tree::read(&src, &src.join("lib.rs"));
    let each = |(from, to): (&String, &BTreeMap<String, BTreeSet<String>>)| {
        let line = |(to, names): (&String, &BTreeSet<String>)| {
            format!("{from} -> {to}: {}", names.iter().cloned().collect::<Vec<_>>().join(", "))
        };
        to.iter().map(line).collect::<Vec<_>>()
    };
    arrows::arrows(&tree).iter().flat_map(each).collect()
}

#[test]
fn an_import_leads_to_the_file_that_defines_it() {
    let found = arrows_of(
        "facades",
        &[
            ("lib.rs", "mod high; mod low; mod words; pub use low::{deep::Deep, *}; pub const TOP: u8 = 0;"),
            ("low/mod.rs", "pub mod deep; pub use deep::import as taken; pub struct Low;"),
            ("low/deep.rs", "pub struct Deep; pub fn import() {}"),
            ("words.rs", "ids! { Word, Letter }"),
            (
                "high.rs",
                "use super::low; use crate::{self as all, Low};
                 pub fn f(_: crate::Deep) -> u8 { println!(\"{}\", low::taken()); all::TOP }
                 fn g() -> crate::words::Word { use low::deep; deep::import() }",
            ),
        ],
    );
    let expected = [
        "high.rs -> lib.rs: TOP",
        "high.rs -> low/deep.rs: Deep, import",
        "high.rs -> low/mod.rs: Low",
        "high.rs -> words.rs: Word",
        "low/mod.rs -> low/deep.rs: import",
    ];
    assert_eq!(found, expected);
}

#[test]
fn what_only_tests_import_is_no_arrow() {
    let high = "pub struct High;
        #[cfg(test)] mod tests { use crate::low::Low; }
        #[cfg(test)] use crate::low::Low;
        impl High { #[cfg(test)] fn low() -> crate::low::Low { crate::low::Low } }";
    let files = [("lib.rs", "mod high; mod low;"), ("high.rs", high), ("low.rs", "pub struct Low;")];
    assert_eq!(arrows_of("tests", &files), Vec::<String>::new());
}
