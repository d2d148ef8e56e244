//! Blocks in other languages: JSON, Python, commands of a shell.

use std::{
    io::Write,
    process::{Command, Stdio},
};

use crate::page::{Block, read, split};

/// What is wrong with a block, if anything. Blocks of the language itself are judged elsewhere.
pub fn fault(block: &Block) -> Option<String> {
    match block.info.as_str() {
        "text" | "ebnf" | "log" => None,
        "json" => json(&block.text),
        "json,dialog" => dialog(&block.text),
        "python" => python(&block.text),
        "sh" => block.text.lines().find_map(command),
        "" => Some("a block names its language; `text` for none".to_owned()),
        info if info.split(',').next() == Some("hri") => None,
        info => Some(format!("`{info}` is not a language of these pages")),
    }
}

/// One document, or one a line.
fn json(text: &str) -> Option<String> {
    let whole = serde_json::from_str::<serde_json::Value>(text).is_ok();
    let bad = text.lines().find(|l| serde_json::from_str::<serde_json::Value>(l).is_err());
    bad.filter(|_| !whole).map(|l| format!("not JSON: {l}"))
}

/// Messages in both directions.
fn dialog(text: &str) -> Option<String> {
    text.lines().find_map(|line| match line.split_at_checked(2) {
        Some(("> " | "< ", message)) => json(message),
        Some(_) | None => Some(format!("neither `> ` nor `< `: {line}")),
    })
}

/// Compiles, without running it.
fn python(text: &str) -> Option<String> {
    let check = "import sys; compile(sys.stdin.read(), 'block', 'exec')";
    let mut child = Command::new("python3")
        .args(["-c", check])
        .stdin(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("python3 is there");
    child.stdin.take().unwrap().write_all(text.as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    (!output.status.success()).then(|| String::from_utf8_lossy(&output.stderr).into_owned())
}

/// A line with `hrdsl` names a command, and options that the command has. The page of the command line is compared with the
/// program elsewhere.
fn command(line: &str) -> Option<String> {
    let line = line.split('#').next().unwrap_or("");
    let mut words = line.split_whitespace().skip_while(|w| w.contains('=')).peekable();
    words.next_if_eq(&"hrdsl")?;
    let section = words.next().unwrap_or("");
    let page = read("spec/cli.md");
    if section == "--version" || section == "--help" {
        return None;
    }
    let (mut here, mut known) = (false, vec!["--help".to_owned(), "--color".to_owned()]);
    let mut found = false;
    for (_, text) in split(&page).1 {
        if let Some(heading) = text.strip_prefix("## ") {
            here = heading == section;
            found |= here;
        }
        if here {
            let code = text.split('`').skip(1).step_by(2);
            let words = code.flat_map(|c| c.split([' ', ',']));
            known.extend(words.filter(|w| w.starts_with('-')).map(str::to_owned));
        }
    }
    if !found {
        return Some(format!("`hrdsl {section}` is no command of spec/cli.md"));
    }
    let unknown = words.find(|w| w.starts_with('-') && w.len() > 1 && !known.iter().any(|k| k == w));
    unknown.map(|w| format!("`hrdsl {section}` has no option `{w}`; it has {}", known.join(", ")))
}

#[test]
fn wrong_blocks_are_found() {
    let block = |info: &str, text: &str| Block { info: info.to_owned(), line: 1, text: text.to_owned() };
    let is_wrong = |info: &str, text: &str| fault(&block(info, text)).is_some();
    assert!(is_wrong("", "x") && is_wrong("yaml", "x: 1"));
    assert!(is_wrong("json", "{") && !is_wrong("json", "{\n}") && !is_wrong("json", "{}\n{}\n"));
    assert!(is_wrong("json,dialog", "{}") && !is_wrong("json,dialog", "> {}\n< 1\n"));
    assert!(is_wrong("python", "if:") && !is_wrong("python", "import nothing_like_it\n"));
    assert!(is_wrong("sh", "hrdsl chek x") && is_wrong("sh", "hrdsl gen x --sed 4"));
    assert!(!is_wrong("sh", "hrdsl gen x --seed 4 # --why\ncargo test\nNO_COLOR=1 hrdsl check x"));
}
