//! `--format sarif`: SARIF 2.1.0, which code hosts and editors show beside the text.

use hrdsl_compiler::pages;
use hrdsl_source::{Diagnostic, REGISTRY, Severity, SourceFiles, Span, SuggestedFix};
use serde_json::{Value, json};

use crate::{
    fault::CommandFault,
    project::{CheckedProject, CheckedUnit},
};

/// The log of a whole check.
///
/// # Errors
/// None that is known: the log holds nothing that JSON cannot say.
pub fn document(project: &CheckedProject, checked: &[CheckedUnit]) -> Result<String, CommandFault> {
    let results = checked
        .iter()
        .flat_map(|c| c.compilation.diagnostics.iter().map(|d| result(&c.compilation.files, d)));
    let results: Vec<Value> = results.collect();
    let artifacts: Vec<Value> =
        project.sources.iter().map(|s| json!({ "location": { "uri": uri(&s.name) } })).collect();
    let log = json!({
        "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
        "version": "2.1.0",
        "runs": [{
            "tool": { "driver": {
                "name": "hrdsl",
                "version": env!("CARGO_PKG_VERSION"),
                "semanticVersion": env!("CARGO_PKG_VERSION"),
                "informationUri": env!("CARGO_PKG_REPOSITORY"),
                "rules": rules(),
            } },
            "columnKind": "unicodeCodePoints",
            "artifacts": artifacts,
            "results": results,
        }],
    });
    crate::files::json(&log)
}

/// One rule for each code, in the order of the registry.
fn rules() -> Vec<Value> {
    let rule = |info: &hrdsl_source::CodeInfo| {
        let page = pages::page(info.code).unwrap_or(info.title);
        json!({
            "id": info.code.to_string(),
            "shortDescription": { "text": info.title },
            "help": { "text": super::page(page, false), "markdown": page },
            "helpUri": format!("{}/blob/main/{}", env!("CARGO_PKG_REPOSITORY"), pages::path(info.code)),
            "properties": { "group": info.code.group() },
        })
    };
    REGISTRY.iter().map(rule).collect()
}

fn result(files: &SourceFiles, diagnostic: &Diagnostic) -> Value {
    let mut message = diagnostic.message.clone();
    if let Some(help) = &diagnostic.help {
        message += &format!(" ({help})");
    }
    let level = match diagnostic.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
    };
    let mut result = json!({
        "ruleId": diagnostic.code.to_string(),
        "level": level,
        "message": { "text": message },
        "locations": [location(files, diagnostic.span(), &diagnostic.labels[0].text)],
    });
    if let Some(index) = REGISTRY.iter().position(|i| i.code == diagnostic.code) {
        result["ruleIndex"] = json!(index);
    }
    if diagnostic.labels.len() > 1 {
        let others = diagnostic.labels[1..].iter().enumerate().map(|(i, label)| {
            let mut other = location(files, label.span, &label.text);
            other["id"] = json!(i + 1);
            other
        });
        result["relatedLocations"] = others.collect();
    }
    if !diagnostic.fixes.is_empty() {
        result["fixes"] = diagnostic.fixes.iter().map(|f| fix(files, f)).collect();
    }
    result
}

fn location(files: &SourceFiles, span: Span, text: &str) -> Value {
    let mut location = json!({ "physicalLocation": { "artifactLocation": artifact(files, span), "region": region(files, span) } });
    if !text.is_empty() {
        location["message"] = json!({ "text": text });
    }
    location
}

/// The edits of a fix, those of each file together.
fn fix(files: &SourceFiles, fix: &SuggestedFix) -> Value {
    let mut changes: Vec<Value> = Vec::new();
    let mut last = None;
    for edit in &fix.edits {
        let replacement = json!({
            "deletedRegion": region(files, edit.span),
            "insertedContent": { "text": edit.text },
        });
        if last.replace(edit.span.file) == Some(edit.span.file)
            && let Some(Value::Array(all)) = changes.last_mut().map(|c| &mut c["replacements"])
        {
            all.push(replacement);
        } else {
            changes.push(
                json!({ "artifactLocation": artifact(files, edit.span), "replacements": [replacement] }),
            );
        }
    }
    json!({
        "description": { "text": fix.title },
        "artifactChanges": changes,
        "properties": { "certain": fix.certain },
    })
}

fn artifact(files: &SourceFiles, span: Span) -> Value {
    json!({ "uri": files.get(span.file).map_or_else(|| "unknown".to_owned(), |f| uri(&f.name)) })
}

/// Lines and columns from 1; the end is the place after the last character.
fn region(files: &SourceFiles, span: Span) -> Value {
    let Some(file) = files.get(span.file) else { return json!({ "startLine": 1 }) };
    let (start, end) = (file.position(span.start), file.position(span.end));
    json!({
        "startLine": start.line,
        "startColumn": start.column,
        "endLine": end.line,
        "endColumn": end.column,
    })
}

/// A path as a URI: absolute ones with `file://`, relative ones as they are; what a URI cannot hold is escaped. A module that
/// comes with hrdsl is no file.
fn uri(name: &str) -> String {
    if name.starts_with("std.") && !name.ends_with(".hri") {
        return format!("hrdsl:{name}");
    }
    let mut out = if name.starts_with('/') { "file://".to_owned() } else { String::new() };
    for byte in name.bytes() {
        match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b'/' => {
                out.push(char::from(byte));
            }
            _ => out += &format!("%{byte:02X}"),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::uri;

    #[test]
    fn paths_are_escaped() {
        assert_eq!(uri("a b/ü.hri"), "a%20b/%C3%BC.hri");
        assert_eq!(uri("/tmp/x:y.hri"), "file:///tmp/x%3Ay.hri");
        assert_eq!(uri("<stdin>"), "%3Cstdin%3E");
        assert_eq!(uri("std.person"), "hrdsl:std.person");
    }
}
