//! Prints what every word of `.hri` files is to the compiler, as JSON: the yardstick of the tests of highlighting.
//!
//! For each file given: its errors of syntax, `[start, message]`, and `[start, end, "name" | "keyword"]` for its names
//! and for the keywords that are none, in bytes.

use std::collections::BTreeMap;

use hrdsl_source::FileId;
use hrdsl_syntax::{parse, token::KEYWORDS};
use serde_json::{Value, json};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut files = BTreeMap::new();
    for path in std::env::args().skip(1) {
        let text = std::fs::read_to_string(&path)?;
        files.insert(path, judged(&text)?);
    }
    println!("{}", serde_json::to_string(&files)?);
    Ok(())
}

fn judged(text: &str) -> Result<Value, serde_json::Error> {
    let (tree, diagnostics) = parse(FileId(0), text);
    let mut names = BTreeMap::new();
    collect(&serde_json::to_value(&tree)?, text, &mut names);
    let mut words: Vec<Value> = names.iter().map(|(start, end)| json!([start, end, "name"])).collect();
    let keywords = words_of(text)
        .into_iter()
        .filter(|(start, word)| !names.contains_key(start) && KEYWORDS.iter().any(|k| k.word == *word));
    words.extend(keywords.map(|(start, word)| json!([start, start + word.len(), "keyword"])));
    let errors = diagnostics.iter().filter(|d| d.is_error());
    let errors: Vec<_> = errors.map(|d| json!([d.span().start, d.message])).collect();
    Ok(json!({ "errors": errors, "words": words }))
}

/// The names of the tree: whatever has a text that stands at its span.
fn collect(value: &Value, text: &str, names: &mut BTreeMap<usize, usize>) {
    match value {
        Value::Array(values) => values.iter().for_each(|v| collect(v, text, names)),
        Value::Object(fields) => {
            let at = |end: &str| usize::try_from(fields.get("span")?.get(end)?.as_u64()?).ok();
            if let (Some(start), Some(end)) = (at("start"), at("end"))
                && let Some(Value::String(name)) = fields.get("text")
                && text.get(start..end) == Some(name)
            {
                names.insert(start, end);
            }
            // Which middleware is bound: a keyword, of which the tree keeps the text.
            fields.iter().filter(|(field, _)| *field != "version").for_each(|(_, v)| collect(v, text, names));
        }
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
    }
}

/// The words outside of comments and texts, and where they start.
fn words_of(text: &str) -> Vec<(usize, &str)> {
    let (mut found, mut at) = (Vec::new(), 0);
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    while let Some(c) = text[at..].chars().next() {
        let rest = &text[at..];
        let taken = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if c == '"' {
            let mut escaped = false;
            let end = rest[1..].find(|c| {
                let ends = (c == '"' && !escaped) || c == '\n';
                escaped = c == '\\' && !escaped;
                ends
            });
            end.map_or(rest.len(), |end| end + 2)
        } else if is_word(c) {
            let end = rest.find(|c| !is_word(c)).unwrap_or(rest.len());
            found.push((at, &rest[..end]));
            end
        } else {
            c.len_utf8()
        };
        at += taken;
    }
    found
}
