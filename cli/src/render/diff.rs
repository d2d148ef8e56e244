//! What `--fix` would change, as a unified diff.

use std::fmt::Write;

use hrdsl_source::printable_line;
use similar::TextDiff;

use crate::color::{TextStyle, paint};

/// The difference of two texts of one file; empty if there is none.
#[must_use]
pub fn unified(name: &str, before: &str, after: &str, colour: bool) -> String {
    let name = printable_line(name);
    let diff = TextDiff::from_lines(before, after);
    let text = diff.unified_diff().context_radius(3).header(&name, &name).to_string();
    let mut out = String::new();
    for line in text.split_inclusive('\n') {
        let (text, end) = line.strip_suffix('\n').map_or((line, ""), |text| (text, "\n"));
        let text = &*printable_line(text.strip_suffix('\r').unwrap_or(text));
        let style = match text.as_bytes().first() {
            Some(b'+') => Some(TextStyle::Added),
            Some(b'-') => Some(TextStyle::Removed),
            Some(b'@') => Some(TextStyle::Code),
            _ => None,
        };
        let shown = style.map_or_else(|| text.to_owned(), |style| paint(colour, style, text));
        let _ = write!(out, "{shown}{end}");
    }
    out
}
