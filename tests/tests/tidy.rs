//! The rules of CONTRIBUTING.md that can be read off the text of the files.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

/// How long a file may be before its tests.
const LONGEST: usize = 500;

/// Files that are longer, and how long they may be: they get no longer, and whoever makes one short enough takes it out.
const LONG: &[(&str, usize)] = &[
    ("cli/tests/robust.rs", 572),
    ("compiler/model/src/check/value/expr.rs", 581),
    ("compiler/model/src/lint/applicable.rs", 505),
    ("compiler/syntax/src/ast.rs", 672),
    ("compiler/syntax/tests/format.rs", 708),
    ("compiler/tests/lower.rs", 1035),
    ("runtime/harness/tests/programs.rs", 557),
    ("runtime/sut/tests/environment.rs", 541),
    ("runtime/ta/src/network/code.rs", 958),
];

/// Files whose lines may end in blanks: a log that prints one, a text that breaks off after one.
const BLANKS: &[&str] = &["editors/vscode/test/cases/broken.hri", "spec/agentspeak/lists.md"];

/// What is written by people, and read by them.
const TEXTS: [&str; 13] =
    ["cjs", "css", "hri", "html", "js", "lalrpop", "md", "mjs", "py", "rs", "sh", "toml", "yml"];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().unwrap()
}

/// The files of the repository and those that are about to be, with their contents.
fn texts() -> Vec<(String, String)> {
    let out = Command::new("git")
        .args(["ls-files", "--cached", "--others", "--exclude-standard"])
        .current_dir(root())
        .output()
        .unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let names = String::from_utf8(out.stdout).unwrap();
    let is_text =
        |name: &&str| Path::new(name).extension().is_some_and(|e| TEXTS.contains(&e.to_str().unwrap_or("")));
    let read = |name: &str| Some((name.to_owned(), fs::read_to_string(root().join(name)).ok()?));
    let texts: Vec<(String, String)> = names.lines().filter(is_text).filter_map(read).collect();
    assert!(texts.len() > 600, "only {} files were found: does the test still see them?", texts.len());
    texts
}

fn rust() -> Vec<(String, String)> {
    texts().into_iter().filter(|(name, _)| name.ends_with(".rs")).collect()
}

/// `FILE:LINE: …` for each line of which something is to be said.
fn said(texts: &[(String, String)], fault: impl Fn(&str, &str) -> Option<String>) -> String {
    let mut faults = String::new();
    for (name, text) in texts {
        for (at, line) in text.lines().enumerate() {
            if let Some(fault) = fault(name, line) {
                faults += &format!("{name}:{}: {fault}\n", at + 1);
            }
        }
    }
    faults
}

#[test]
fn files_are_short() {
    let mut faults = String::new();
    let mut excepted = Vec::new();
    for (name, text) in rust() {
        let lines = text.lines().take_while(|l| *l != "#[cfg(test)]").count();
        let longest = LONG.iter().find(|(long, _)| *long == name).map(|(_, lines)| *lines);
        excepted.extend(longest.map(|_| name.clone()));
        if lines > longest.unwrap_or(LONGEST) {
            faults += &format!("{name} has {lines} lines before its tests; take something out of it\n");
        } else if longest.is_some() && lines <= LONGEST {
            faults += &format!("{name} has {lines} lines now: take it out of the exceptions\n");
        }
    }
    for (name, _) in LONG.iter().filter(|(name, _)| !excepted.iter().any(|e| e == name)) {
        faults += &format!("{name} is excepted, and is not there\n");
    }
    assert!(faults.is_empty(), "{faults}");
}

#[test]
fn every_source_file_says_what_it_is_for() {
    let silent = |(name, text): (String, String)| (!text.starts_with("//!")).then_some(name);
    let silent: Vec<String> = rust().into_iter().filter_map(silent).collect();
    assert!(silent.is_empty(), "these do not begin with `//! …`:\n{}", silent.join("\n"));
}

#[test]
fn nothing_is_left_to_be_done() {
    // Put together, so that this file does not hold them itself.
    let macros = [concat!("to", "do!"), concat!("unimplemen", "ted!"), concat!("db", "g!")];
    let marks = [concat!("TO", "DO"), concat!("FIX", "ME")];
    let is_word = |line: &str, word: &str| {
        line.match_indices(word).any(|(at, _)| {
            let before = line[..at].chars().next_back();
            !before.is_some_and(|c| c.is_alphanumeric() || c == '_')
        })
    };
    let faults = said(&texts(), |name, line| {
        let macros = macros.iter().filter(|m| name.ends_with(".rs") && is_word(line, m));
        macros.chain(marks.iter().filter(|m| is_word(line, m))).map(|w| format!("`{w}`")).next()
    });
    assert!(faults.is_empty(), "{faults}");
}

#[test]
fn lines_hold_no_tabs_and_end_in_no_blanks() {
    let faults = said(&texts(), |name, line| {
        if line.contains('\t') {
            return Some("a tab".to_owned());
        }
        let ends_in_blank = line.ends_with(char::is_whitespace) && !BLANKS.contains(&name);
        ends_in_blank.then(|| "a blank at the end".to_owned())
    });
    assert!(faults.is_empty(), "{faults}");
    let texts = texts();
    for name in BLANKS {
        let text = texts.iter().find(|(n, _)| n == name).map(|(_, text)| text.as_str()).unwrap_or_default();
        assert!(text.lines().any(|l| l.ends_with(char::is_whitespace)), "{name} needs no exception");
    }
}

/// A path of one machine leads nowhere on another.
#[test]
fn no_file_names_a_folder_of_one_machine() {
    let folders = [concat!("/wo", "rk/"), concat!("/ho", "me/"), concat!("/ro", "ot/")];
    let faults = said(&texts(), |_, line| {
        let is_absolute = |at: usize| {
            let before = line[..at].chars().next_back();
            !before.is_some_and(|c| c.is_alphanumeric() || "._*~-}".contains(c))
        };
        let found = |folder: &&&str| line.match_indices(**folder).any(|(at, _)| is_absolute(at));
        folders.iter().find(found).map(|folder| format!("`{folder}`"))
    });
    assert!(faults.is_empty(), "{faults}");
}

#[test]
fn whoever_allows_what_a_lint_forbids_says_why() {
    let mut faults = String::new();
    let mut seen = 0;
    for (name, text) in rust() {
        for opening in ["#[allow(", "#![allow(", "#[expect(", "#![expect("] {
            for (at, _) in text.match_indices(opening) {
                let before = text[..at].rsplit('\n').next().unwrap_or_default();
                // In a comment or a string it allows nothing.
                if !before.trim().is_empty() {
                    continue;
                }
                seen += 1;
                let attribute = text[at..].split_once(")]").map_or(&text[at..], |(inside, _)| inside);
                if !attribute.contains("reason = \"") {
                    let line = text[..at].lines().count() + 1;
                    faults += &format!("{name}:{line}: {attribute})] has no reason\n");
                }
            }
        }
    }
    assert!(seen > 20, "only {seen} were found: does the test still see them?");
    assert!(faults.is_empty(), "{faults}");
}

/// Which crates deny which of the two lints, as CONTRIBUTING.md says and as they do.
#[test]
fn the_table_of_lints_is_true() {
    let read = |name: &str| fs::read_to_string(root().join(name)).unwrap();
    let folder_of = |line: &str| {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        (cells[1].to_owned(), cells[2].to_owned())
    };
    let crates = read("ARCHITECTURE.md");
    let crates = crates.lines().filter(|l| l.starts_with("| hrdsl")).map(folder_of);
    let contributing = read("CONTRIBUTING.md");
    let mut faults = String::new();
    for (name, folder) in crates.filter(|(name, _)| name != "hrdsl-tests") {
        let row = contributing.lines().find(|l| l.starts_with(&format!("| {name} |")));
        let Some(row) = row else {
            faults += &format!("{name} is not in the table\n");
            continue;
        };
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        let library = root().join(&folder).join("src/lib.rs");
        let text = fs::read_to_string(library).unwrap_or_else(|_| read(&format!("{folder}/src/main.rs")));
        let denied = text.lines().find(|l| l.contains("deny(clippy::")).unwrap_or_default();
        for (lint, count, said) in
            [("wildcard_enum_match_arm", cells[2], cells[4]), ("indexing_slicing", cells[3], cells[5])]
        {
            let is_denied = denied.contains(lint);
            if said != if is_denied { "yes" } else { "no" } || (count == "0" && !is_denied) {
                faults +=
                    &format!("{name}: {lint}: {count}, denied: {said}, and in the source: {is_denied}\n");
            }
        }
    }
    assert!(faults.is_empty(), "{faults}");
}

/// The names of the types that the sources declare at the left margin, tests excepted, with the files.
fn type_names() -> Vec<(String, String)> {
    let mut names = Vec::new();
    for (file, text) in rust().into_iter().filter(|(name, _)| name.contains("src/")) {
        if file.ends_with("/tests.rs") {
            continue;
        }
        for line in text.lines().take_while(|l| *l != "#[cfg(test)]") {
            let said =
                line.strip_prefix("pub ").or_else(|| line.split_once("pub(").map(|(_, l)| l)).unwrap_or(line);
            let said = said.split_once(") ").filter(|_| line.starts_with("pub(")).map_or(said, |(_, l)| l);
            let declared = ["struct ", "enum ", "trait ", "type "].iter().find_map(|k| said.strip_prefix(k));
            if let Some(rest) = declared {
                let name: String = rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
                names.push((name, file.clone()));
            }
        }
    }
    names
}

/// Where one looks for a type by its name, only one is found: in the sources, and in the pages of types that are made from them.
#[test]
fn no_name_of_a_type_is_given_twice() {
    let mut files: std::collections::BTreeMap<String, Vec<String>> = std::collections::BTreeMap::new();
    for (name, file) in type_names() {
        files.entry(name).or_default().push(file);
    }
    let twice: Vec<String> = files
        .into_iter()
        .filter(|(_, files)| files.len() > 1)
        .map(|(name, files)| format!("{name}: {}", files.join(", ")))
        .collect();
    assert!(twice.is_empty(), "these types need a name of their own:\n{}", twice.join("\n"));
}

/// `cargo test -p hrdsl-tests --test tidy names -- --nocapture` prints the shares.
#[test]
fn names_of_types_are_distinct_and_of_more_than_one_word() {
    let names = type_names();
    let all = names.len();
    assert!(all > 1_000, "only {all} types were found: does the test still see them?");
    let mut files: std::collections::BTreeMap<&str, Vec<&str>> = std::collections::BTreeMap::new();
    for (name, file) in &names {
        files.entry(name).or_default().push(file);
    }
    let twice: Vec<_> = files.iter().filter(|(_, files)| files.len() > 1).collect();
    let words = |name: &str| name.chars().filter(|c| c.is_uppercase()).count();
    let one = files.keys().filter(|name| words(name) < 2).count();
    let (distinct, one) = (100.0 * files.len() as f64 / all as f64, 100.0 * one as f64 / files.len() as f64);
    println!("{all} types, {distinct:.0} % of their names distinct, {one:.0} % of one word");
    assert!(distinct >= 99.0, "these names are given twice: {twice:#?}");
    assert!(one <= 10.0, "{one} % of the names of types are one word");
}
