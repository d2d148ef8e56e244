//! The specification is executed: every block on its pages is what it says, what can be generated is generated, every link
//! leads somewhere, and the book has every page once.

#[path = "spec/agents.rs"]
mod agents;
#[path = "spec/blocks.rs"]
mod blocks;
#[path = "spec/conformance.rs"]
mod conformance;
#[path = "spec/draws.rs"]
mod draws;
#[path = "spec/ebnf.rs"]
mod ebnf;
#[path = "../../compiler/tests/fixing/mod.rs"]
mod fixing;
#[path = "spec/hri.rs"]
mod hri;
#[path = "spec/monitors.rs"]
mod monitors;
#[path = "spec/network.rs"]
mod network;
#[path = "spec/page.rs"]
mod page;
#[path = "spec/tables.rs"]
mod tables;
#[path = "spec/timed_conformance.rs"]
mod timed_conformance;

use std::{collections::BTreeMap, fs, path::PathBuf};

use page::{broken, links, pages, read, root, shown, split};

#[test]
fn every_block_is_what_it_says() {
    let (mut faults, mut executed) = (Vec::new(), 0);
    for path in pages(&root().join("spec")) {
        let page = fs::read_to_string(&path).unwrap();
        let name = shown(&path);
        let blocks = split(&page).0;
        let (wrong, compiled) = hri::faults(&name, &blocks);
        faults.extend(wrong);
        executed += compiled;
        for block in &blocks {
            faults.extend(blocks::fault(block).map(|f| format!("{name}:{}: {f}", block.line)));
        }
    }
    assert!(executed >= 60, "only {executed} blocks were found: does the test still see the pages?");
    assert!(faults.is_empty(), "{} faults in {executed} blocks:\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn every_link_leads_somewhere() {
    let root = root();
    let mut files: Vec<PathBuf> =
        ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"].iter().map(|f| root.join(f)).collect();
    files.extend(pages(&root.join("spec")));
    files.extend(pages(&root.join("spec/codes")));
    files.extend(pages(&root.join("spec/agentspeak")));
    files.extend(pages(&root.join("spec/timed")));
    let (mut faults, mut followed) = (Vec::new(), 0);
    for path in &files {
        let page = fs::read_to_string(path).unwrap();
        for (number, line) in split(&page).1 {
            for target in links(line) {
                followed += 1;
                let fault = broken(path, &target);
                faults.extend(fault.map(|f| format!("{}:{number}: `{target}` {f}", shown(path))));
            }
        }
    }
    assert!(followed >= 40, "only {followed} links were found: does the test still see them?");
    assert!(faults.is_empty(), "{} of {followed} links:\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn the_index_names_every_page() {
    let spec = root().join("spec");
    let index = read("spec/README.md");
    for page in pages(&spec) {
        let name = page.file_name().unwrap().to_string_lossy().into_owned();
        assert!(
            ["README.md", "SUMMARY.md"].contains(&name.as_str()) || index.contains(&format!("]({name})")),
            "spec/README.md does not name {name}"
        );
    }
}

/// `SUMMARY.md` is the contents of the book.
#[test]
fn the_book_has_every_page_once() {
    let summary = read("spec/SUMMARY.md");
    let mut times: BTreeMap<String, usize> = BTreeMap::new();
    for target in summary.lines().flat_map(links) {
        *times.entry(target).or_default() += 1;
    }
    for (folder, before) in
        [("spec", ""), ("spec/codes", "codes/"), ("spec/agentspeak", "agentspeak/"), ("spec/timed", "timed/")]
    {
        for page in pages(&root().join(folder)) {
            let name = format!("{before}{}", page.file_name().unwrap().to_string_lossy());
            if name != "SUMMARY.md" {
                let n = times.remove(&name).unwrap_or(0);
                assert_eq!(n, 1, "spec/SUMMARY.md names {name} {n} times (HRDSL_UPDATE=1 adds it)");
            }
        }
    }
    assert!(times.is_empty(), "spec/SUMMARY.md names what is no page: {times:?}");
}

#[test]
fn the_book_is_made_of_the_specification() {
    let book = read("book.toml");
    assert!(book.lines().any(|l| l == "src = \"spec\""), "{book}");
}
