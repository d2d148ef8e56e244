//! What the editors' grammars take from this crate: the keywords, and texts that must be read without fault.
//!
//! `HRDSL_UPDATE=1 cargo test -p hrdsl-syntax --test editors` writes the keywords anew.

#![allow(clippy::disallowed_methods, reason = "the test reads and writes files")]

use std::collections::BTreeSet;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use hrdsl_source::FileId;
use hrdsl_syntax::parse;
use hrdsl_syntax::token::{KEYWORDS, KeywordClass};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn grammar() -> PathBuf {
    root().join("editors/tree-sitter")
}

/// Compares a generated file with the one that is committed.
fn same(path: &Path, expected: &str) {
    if std::env::var_os("HRDSL_UPDATE").is_some() {
        fs::write(path, expected).expect("the file can be written");
    }
    let found = fs::read_to_string(path).unwrap_or_default();
    assert!(found == expected, "{} is not that of the registry; HRDSL_UPDATE=1 writes it", path.display());
}

fn keywords_json() -> String {
    let rows: Vec<String> = KEYWORDS
        .iter()
        .map(|k| {
            let class = match k.class {
                KeywordClass::Head => "head",
                KeywordClass::Hard | KeywordClass::Reserved => "hard",
                KeywordClass::Soft => "soft",
            };
            format!("  {{ \"word\": \"{}\", \"class\": \"{class}\", \"place\": \"{}\" }}", k.word, k.place)
        })
        .collect();
    format!("[\n{}\n]\n", rows.join(",\n"))
}

fn keywords_h() -> String {
    let mut text = String::from(
        "// The registry of keywords, in its order. Generated: see compiler/syntax/tests/editors.rs.\n",
    );
    for keyword in KEYWORDS {
        let class = match keyword.class {
            KeywordClass::Head => "HEAD",
            KeywordClass::Hard | KeywordClass::Reserved => "HARD",
            KeywordClass::Soft => "SOFT",
        };
        let _ = writeln!(text, "{class}({0}, \"{0}\")", keyword.word);
    }
    text
}

/// The query with all keywords that it does not name by themselves in its one long list.
fn highlights(query: &str) -> String {
    let (before, rest) = query.split_once("[\n  \"").expect("the list of keywords");
    let (_, after) = rest.split_once("\n] @keyword\n").expect("the end of the list");
    let others = || before.lines().chain(after.lines()).filter(|line| line.starts_with(['[', '"']));
    let alone = |word: &str| others().any(|line| line.contains(&format!("\"{word}\"")));
    let listed = KEYWORDS.iter().filter(|k| k.class != KeywordClass::Reserved && !alone(k.word));
    let mut list = String::new();
    let mut width = usize::MAX;
    for keyword in listed {
        let word = format!("\"{}\"", keyword.word);
        let wraps = width.saturating_add(word.len()) > 118;
        list += if wraps { "\n  " } else { " " };
        width = if wraps { 2 } else { width + 1 } + word.len();
        list += &word;
    }
    format!("{before}[{list}\n] @keyword\n{after}")
}

#[test]
fn keywords_are_those_of_the_registry() {
    let query = grammar().join("queries/highlights.scm");
    same(&query, &highlights(&fs::read_to_string(&query).expect("the query is there")));
    same(&grammar().join("keywords.json"), &keywords_json());
    same(&grammar().join("src/keywords.h"), &keywords_h());
}

#[test]
fn every_keyword_has_a_colour() {
    let query = fs::read_to_string(grammar().join("queries/highlights.scm")).expect("the query is there");
    for keyword in KEYWORDS {
        assert!(query.contains(&format!("\"{}\"", keyword.word)), "`{}` is not highlighted", keyword.word);
    }
}

/// The files below a folder whose names end so, in order.
fn files(folder: &Path, end: &str, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> =
        fs::read_dir(folder).into_iter().flatten().flatten().map(|e| e.path()).collect();
    entries.sort();
    for path in entries {
        let name = path.file_name().and_then(|n| n.to_str()).unwrap_or("");
        if path.is_dir() {
            if !name.starts_with('.') && name != "target" && name != "node_modules" {
                files(&path, end, found);
            }
        } else if name.ends_with(end) {
            found.push(path);
        }
    }
}

/// Every text of the language that the repository holds: files, blocks of the pages, string literals of tests.
fn texts() -> Vec<String> {
    let mut texts = Vec::new();
    let mut paths = Vec::new();
    files(&root(), ".hri", &mut paths);
    for path in &paths {
        texts.extend(fs::read_to_string(path));
    }
    paths.clear();
    files(&root(), ".md", &mut paths);
    for page in paths.iter().filter_map(|p| fs::read_to_string(p).ok()) {
        let blocks = page.split("```").skip(1).step_by(2).filter_map(|b| b.strip_prefix("hri"));
        texts.extend(blocks.filter_map(|b| b.split_once('\n')).map(|(_, block)| block.to_owned()));
    }
    paths.clear();
    files(&root().join("compiler"), ".rs", &mut paths);
    for code in paths.iter().filter_map(|p| fs::read_to_string(p).ok()) {
        texts.extend(code.split("r#\"").skip(1).filter_map(|s| s.split("\"#").next()).map(str::to_owned));
        let plain = code.split('"').skip(1).step_by(2).filter(|s| s.contains(' '));
        texts.extend(plain.map(|s| s.replace("{{", "{").replace("}}", "}")));
    }
    texts
}

/// Every soft keyword as a name, wherever it can be one.
fn soft_names() -> Vec<String> {
    let code = include_str!("keywords.rs");
    let pattern = code
        .split("let text = format!(")
        .nth(1)
        .and_then(|s| s.split('"').nth(1))
        .expect("the text of soft_keywords_are_names")
        .replace("{{", "{")
        .replace("}}", "}");
    let soft = KEYWORDS.iter().filter(|k| k.class == KeywordClass::Soft);
    soft.map(|k| pattern.replace("{word}", k.word)).collect()
}

/// The single declarations of a text that is read without fault, and the text itself.
fn declarations(text: &str) -> Vec<String> {
    let (file, diagnostics) = parse(FileId(0), text);
    if !diagnostics.is_empty() || (file.items.is_empty() && file.scenario.is_none()) {
        return Vec::new();
    }
    let single = file.items.iter().filter_map(|i| text.get(i.span.range())).map(str::to_owned);
    single.filter(|t| parse(FileId(0), t).1.is_empty()).chain([text.to_owned()]).collect()
}

/// Nodes of this crate's trees, and what they are called in that grammar's.
const SAME_NODES: [(&str, &str); 6] = [
    ("quantity", "quantity"),
    ("binary", "binary_expression"),
    ("edge", "edge"),
    ("location", "location"),
    ("act", "act_step"),
    ("plan", "plan"),
];

/// How many nodes of some sorts there are in all the texts, a line for each sort.
fn counts(texts: &BTreeSet<String>) -> String {
    let mut declarations = 0;
    let mut nodes = [0; SAME_NODES.len()];
    for text in texts {
        let (file, _) = parse(FileId(0), text);
        declarations += file.items.len() + usize::from(file.scenario.is_some());
        let tree = serde_json::to_string(&file).expect("trees are plain data");
        for (count, (here, _)) in nodes.iter_mut().zip(SAME_NODES) {
            *count += tree.matches(&format!("\"{here}\":{{")).count();
        }
    }
    let rows = SAME_NODES.iter().zip(nodes).map(|((_, there), count)| format!("{there} {count}\n"));
    format!("declaration {declarations}\n{}", rows.collect::<String>())
}

/// Leaves the texts where `editors/tree-sitter/test.sh` finds them: what this crate accepts, that grammar must.
#[test]
fn accepted_texts_are_collected() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("accepted");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("the folder can be made");
    let all: BTreeSet<String> = texts().iter().chain(&soft_names()).flat_map(|t| declarations(t)).collect();
    for (i, text) in all.iter().enumerate() {
        fs::write(folder.join(format!("{i:04}.hri")), text).expect("the text can be written");
    }
    fs::write(folder.join("counts"), counts(&all)).expect("the counts can be written");
    assert!(all.len() > 200, "{} texts", all.len());
}
