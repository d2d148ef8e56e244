//! Pages of Markdown: where they are, their blocks, their links.

use std::{
    fs,
    path::{Path, PathBuf},
};

pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().unwrap()
}

pub fn read(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap_or_else(|e| panic!("{path}: {e}"))
}

/// The Markdown files directly in a folder, by name.
pub fn pages(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|e| e.unwrap().path());
    let mut pages: Vec<PathBuf> = entries.filter(|p| p.extension().is_some_and(|e| e == "md")).collect();
    pages.sort();
    pages
}

/// The path from the root of the project.
pub fn shown(path: &Path) -> String {
    path.strip_prefix(root()).unwrap_or(path).display().to_string()
}

/// A fenced block of a page.
#[derive(Clone)]
pub struct Block {
    /// What follows the opening fence: `hri`, `hri,fails=HR0101`, `text`.
    pub info: String,
    /// Of the opening fence, from 1.
    pub line: usize,
    pub text: String,
}

/// The blocks of a page, and the text outside of them with its line numbers.
pub fn split(page: &str) -> (Vec<Block>, Vec<(usize, &str)>) {
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

/// The targets of inline links, `[text](target)`, code spans left out.
pub fn links(line: &str) -> Vec<String> {
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
pub fn broken(from: &Path, target: &str) -> Option<String> {
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
fn blocks_links_and_headings_are_found() {
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
}
