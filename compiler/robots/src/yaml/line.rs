//! Lines of YAML: how far they are indented, and what stands on them without their comment.

/// A line that says something.
#[derive(Clone, Copy, Debug)]
pub(super) struct YamlLine<'a> {
    pub indent: usize,
    pub text: &'a str,
    /// The byte of the file that `text` begins at.
    pub at: usize,
}

/// What is wrong, and at which byte.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct YamlFault {
    pub at: usize,
    pub reason: String,
}

pub(super) fn fault<T>(at: usize, reason: impl Into<String>) -> Result<T, YamlFault> {
    Err(YamlFault { at, reason: reason.into() })
}

/// The lines of the first document that are neither empty nor comments.
pub(super) fn lines(text: &str) -> Result<Vec<YamlLine<'_>>, YamlFault> {
    let mut lines = Vec::new();
    let mut at = 0;
    for whole in text.split_inclusive('\n') {
        let start = at;
        at += whole.len();
        let line = whole.trim_end();
        let text = line.trim_start_matches(' ');
        let indent = line.len() - text.len();
        let said = without_comment(text).trim_end();
        if said.is_empty() || said.starts_with("%YAML") {
            continue;
        }
        if said.starts_with('\t') {
            return fault(start + indent, "a tab cannot indent a line; write blanks");
        }
        if indent == 0 && matches!(said, "---" | "...") {
            if lines.is_empty() {
                continue;
            }
            break;
        }
        lines.push(YamlLine { indent, text: said, at: start + indent });
    }
    Ok(lines)
}

/// Up to a `#` that begins a comment: one at the start or behind a blank, not in quotes.
fn without_comment(text: &str) -> &str {
    let mut quote = None;
    let mut before = ' ';
    for (at, c) in text.char_indices() {
        match quote {
            Some(open) if c == open && !(open == '"' && before == '\\') => quote = None,
            Some(_) => {}
            None if matches!(c, '"' | '\'') && matches!(before, ' ' | '[' | '{' | ',' | ':') => {
                quote = Some(c)
            }
            None if c == '#' && before.is_whitespace() => return text.get(..at).unwrap_or(text),
            None => {}
        }
        before = c;
    }
    text
}
