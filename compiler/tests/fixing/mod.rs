//! Applying certain fixes, each by itself.

use hrdsl_compiler::CompilationResult;
use hrdsl_source::{Diagnostic, FileId, SuggestedFix};

/// The text with a fix of it, if the fix is of this file alone.
fn fixed(text: &str, fix: &SuggestedFix) -> Option<String> {
    let mut text = text.to_owned();
    for edit in fix.edits.iter().rev() {
        (edit.span.file == FileId(0)).then(|| text.replace_range(edit.span.range(), &edit.text))?;
    }
    Some(text)
}

/// How often the same is said of the same text: the fix of one finding may uncover another of its kind.
fn said(c: &CompilationResult, of: &Diagnostic, text: &str) -> usize {
    let same = |d: &&Diagnostic| {
        (d.code, d.message.as_str(), c.files.text(d.span())) == (of.code, of.message.as_str(), text)
    };
    c.diagnostics.iter().filter(same).count()
}

fn errors(c: &CompilationResult) -> Vec<String> {
    c.diagnostics.iter().filter(|d| d.is_error()).map(|d| format!("{} {}", d.code, d.message)).collect()
}

/// Errors that were not there before.
fn new_errors(before: &CompilationResult, after: &CompilationResult) -> Vec<String> {
    let mut old = errors(before);
    let is_new = |e: &String| match old.iter().position(|o| o == e) {
        Some(at) => {
            old.swap_remove(at);
            false
        }
        None => true,
    };
    errors(after).into_iter().filter(is_new).collect()
}

/// What is wrong with the certain fixes of a text, and how many there are.
pub fn faults(text: &str, compile: &dyn Fn(&str) -> CompilationResult) -> (Vec<String>, usize) {
    let before = compile(text);
    let (mut faults, mut tried) = (Vec::new(), 0);
    for d in &before.diagnostics {
        for fix in d.fixes.iter().filter(|f| f.certain) {
            let Some(fixed) = fixed(text, fix) else { continue };
            tried += 1;
            let after = compile(&fixed);
            let what = format!("{}: {}: {}", before.files.place(d.span()), d.code, fix.title);
            // An error in the syntax may have kept others from being found.
            let hid_others = d.is_error() && d.code.to_string().starts_with("HR00");
            let new = new_errors(&before, &after);
            if !hid_others && !new.is_empty() {
                faults.push(format!("{what}: now there is {new:?}"));
            }
            let of = before.files.text(d.span());
            if said(&after, d, of) >= said(&before, d, of) {
                faults.push(format!("{what}: it is still said"));
            }
        }
    }
    (faults, tried)
}
