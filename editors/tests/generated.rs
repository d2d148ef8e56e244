//! What is committed for editors is what the registry of keywords makes.

use std::{collections::BTreeSet, fs, path::Path};

use hrdsl_editors::{generated, textmate};
use hrdsl_syntax::token::KEYWORDS;

fn folder() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn the_committed_files_are_what_is_generated() {
    let update = std::env::var_os("HRDSL_UPDATE").is_some();
    let mut stale = Vec::new();
    for file in generated().unwrap() {
        let path = folder().join(file.path);
        if update {
            fs::write(&path, &file.text).unwrap();
        } else if fs::read_to_string(&path).unwrap_or_default() != file.text {
            stale.push(file.path);
        }
    }
    assert!(
        stale.is_empty(),
        "{stale:?} are old: HRDSL_UPDATE=1 cargo test -p hrdsl-editors --test generated"
    );
}

#[test]
fn the_grammar_is_json_and_its_references_lead_somewhere() {
    let grammar: serde_json::Value = serde_json::from_str(&textmate().unwrap()[0].text).unwrap();
    assert_eq!(grammar["scopeName"], "source.hrdsl");
    let repository = grammar["repository"].as_object().unwrap();
    let (mut used, mut open) = (BTreeSet::new(), vec![&grammar]);
    while let Some(value) = open.pop() {
        match value {
            serde_json::Value::Array(values) => open.extend(values),
            serde_json::Value::Object(fields) => {
                if let Some(rule) = fields.get("include").and_then(|i| i.as_str()) {
                    let rule = rule.strip_prefix('#').unwrap();
                    assert!(repository.contains_key(rule), "there is no rule `{rule}`");
                    used.insert(rule.to_owned());
                }
                open.extend(fields.values());
            }
            serde_json::Value::Null
            | serde_json::Value::Bool(_)
            | serde_json::Value::Number(_)
            | serde_json::Value::String(_) => {}
        }
    }
    let unused: Vec<_> = repository.keys().filter(|r| !used.contains(*r)).collect();
    assert!(unused.is_empty(), "rules that nothing uses: {unused:?}");
}

/// Every keyword is somewhere in an expression of the grammar: a new place needs a rule.
#[test]
fn every_keyword_is_in_the_grammar() {
    let text = textmate().unwrap().remove(0).text;
    let words: BTreeSet<&str> = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').collect();
    // `\b` before a word leaves a `b` at its front.
    let has = |word: &str| words.contains(word) || words.contains(format!("b{word}").as_str());
    let missing: Vec<_> = KEYWORDS.iter().map(|k| k.word).filter(|w| !has(w)).collect();
    assert!(missing.is_empty(), "{missing:?}");
}
