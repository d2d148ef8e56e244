//! The specification is executed: every block of code on its pages compiles, or fails as it says, and every link leads
//! somewhere.

use std::{
    fs,
    path::{Path, PathBuf},
};

use hrdsl_compiler::{Compilation, Input, compile};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().unwrap()
}

/// The Markdown files directly in a folder, by name.
fn pages(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|e| e.unwrap().path());
    let mut pages: Vec<PathBuf> = entries.filter(|p| p.extension().is_some_and(|e| e == "md")).collect();
    pages.sort();
    pages
}

fn shown(path: &Path) -> String {
    path.strip_prefix(root()).unwrap_or(path).display().to_string()
}

/// A fenced block of a page.
struct Block {
    /// What follows the opening fence: `hri`, `hri,fails=HR0101`, `text`.
    info: String,
    /// Of the opening fence, from 1.
    line: usize,
    text: String,
}

/// The blocks of a page, and the text outside of them with its line numbers.
fn split(page: &str) -> (Vec<Block>, Vec<(usize, &str)>) {
    let (mut blocks, mut prose) = (Vec::new(), Vec::new());
    let mut open: Option<Block> = None;
    for (number, line) in (1..).zip(page.lines()) {
        match (line.strip_prefix("```"), &mut open) {
            (Some(_), Some(_)) => blocks.extend(open.take()),
            (Some(info), None) => {
                open = Some(Block { info: info.trim().to_owned(), line: number, text: String::new() });
            }
            (None, Some(block)) => {
                block.text.push_str(line);
                block.text.push('\n');
            }
            (None, None) => prose.push((number, line)),
        }
    }
    assert!(open.is_none(), "a block without an end, from line {}", open.map_or(0, |b| b.line));
    (blocks, prose)
}

/// Pieces are compiled together with what they are pieces of, by the test of the standard library.
fn is_executed(block: &Block) -> bool {
    block.info.split(',').next() == Some("hri") && block.info != "hri,piece"
}

/// What is wrong with a block, if anything.
fn fault(name: &str, block: &Block) -> Option<String> {
    let rule = block.info.split_once(',').map_or("", |(_, rule)| rule);
    if !is_executed(block) {
        return None;
    }
    let compilation = compile(Input { name, text: &block.text }, &[]);
    let errors: Vec<_> = compilation.diagnostics.iter().filter(|d| d.is_error()).collect();
    match rule.split_once('=') {
        Some(("fails", code)) => {
            let gives = errors.iter().any(|d| d.code.to_string() == code);
            (!gives).then(|| format!("does not fail with {code}{}", listed(&compilation)))
        }
        None if rule.is_empty() => {
            let compiles = errors.is_empty() && compilation.program.is_some();
            (!compiles).then(|| format!("does not compile{}", listed(&compilation)))
        }
        Some(_) | None => Some(format!("`{rule}` means nothing; a block is `hri` or `hri,fails=HRnnnn`")),
    }
}

/// The errors, by place in the block.
fn listed(compilation: &Compilation) -> String {
    let mut lines = String::new();
    for error in compilation.diagnostics.iter().filter(|d| d.is_error()) {
        let place = compilation.files.place(error.span());
        lines += &format!("\n    {place} {} {}", error.code, error.message);
    }
    if lines.is_empty() { ": it has no error".to_owned() } else { lines }
}

#[test]
fn every_block_compiles_or_fails_as_it_says() {
    let (mut faults, mut executed) = (Vec::new(), 0);
    for path in pages(&root().join("spec")) {
        let page = fs::read_to_string(&path).unwrap();
        for block in split(&page).0 {
            let name = format!("{}:{}", shown(&path), block.line);
            executed += usize::from(is_executed(&block));
            faults.extend(fault(&name, &block).map(|f| format!("{name}: {f}")));
        }
    }
    assert!(executed >= 20, "only {executed} blocks were found: does the test still see the pages?");
    assert!(faults.is_empty(), "{} of {executed} blocks:\n{}", faults.len(), faults.join("\n"));
}

/// The targets of inline links, `[text](target)`, code spans left out.
fn links(line: &str) -> Vec<String> {
    let without_code: String = line.split('`').step_by(2).collect::<Vec<_>>().join("x");
    let parts = without_code.split("](").skip(1);
    parts.filter_map(|rest| Some(rest.split_once(')')?.0.to_owned())).collect()
}

/// The anchors that a page's headings have, as GitHub makes them.
fn anchors(page: &str) -> Vec<String> {
    let anchor = |heading: &str| -> String {
        let lower = heading.to_lowercase();
        let kept = lower.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
        kept.map(|c| if c == ' ' { '-' } else { c }).collect()
    };
    let lines = split(page).1.into_iter().map(|(_, line)| line);
    lines.filter(|l| l.starts_with('#')).map(|l| anchor(l.trim_start_matches('#').trim())).collect()
}

/// What is wrong with a link from a page, if anything.
fn broken(from: &Path, target: &str) -> Option<String> {
    if target.contains("://") || target.starts_with("mailto:") {
        return None;
    }
    let (file, anchor) = target.split_once('#').map_or((target, None), |(f, a)| (f, Some(a)));
    let to = if file.is_empty() { from.to_owned() } else { from.parent().unwrap().join(file) };
    if !to.exists() {
        return Some("leads nowhere".to_owned());
    }
    let anchor = anchor.filter(|_| to.extension().is_some_and(|e| e == "md"))?;
    let known = anchors(&fs::read_to_string(&to).unwrap());
    let missing = !known.iter().any(|a| a == anchor);
    missing.then(|| format!("leads to no heading; the page has: {}", known.join(", ")))
}

#[test]
fn every_link_leads_somewhere() {
    let root = root();
    let mut files: Vec<PathBuf> =
        ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"].iter().map(|f| root.join(f)).collect();
    files.extend(pages(&root.join("spec")));
    files.extend(pages(&root.join("spec/codes")));
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
    let index = fs::read_to_string(spec.join("README.md")).unwrap();
    for page in pages(&spec) {
        let name = page.file_name().unwrap().to_string_lossy().into_owned();
        assert!(
            name == "README.md" || index.contains(&format!("]({name})")),
            "spec/README.md does not name {name}"
        );
    }
}

#[test]
fn the_test_sees_blocks_and_links() {
    let page =
        "# A page: *of* `code`\ntext [a](b.md#c) and `[no](link)`\n```hri,fails=HR0101\nx\n```\nend [d](e)\n";
    let (blocks, prose) = split(page);
    assert_eq!(
        (blocks[0].info.as_str(), blocks[0].line, blocks[0].text.as_str()),
        ("hri,fails=HR0101", 3, "x\n")
    );
    let found: Vec<String> = prose.iter().flat_map(|(_, l)| links(l)).collect();
    assert_eq!(found, ["b.md#c", "e"]);
    assert_eq!(anchors(page), ["a-page-of-code"]);
    let wrong = "scenario x\nevent e from nobody\n";
    let block = |info: &str| Block { info: info.to_owned(), line: 1, text: wrong.to_owned() };
    assert!(fault("a", &block("hri")).is_some() && fault("b", &block("hri,fails=HR0503")).is_some());
    assert!(fault("c", &block("hri,fails=HR0101")).is_none() && fault("d", &block("text")).is_none());
}
