//! `package.xml`: the name of a package, which is all that matters here.

use hrdsl_source::{FileId, Span};

use crate::{
    fault::{MessageFault, MessageFaultKind},
    limits::MOST_BYTES,
    name::{NamedPart, RosVersion},
};

/// The name, and where it stands.
pub(crate) fn package_name(
    version: RosVersion,
    file: FileId,
    text: &str,
) -> Result<(String, Span), MessageFault> {
    let malformed =
        |at: usize, help: String| MessageFaultKind::MalformedManifest.at(Span::new(file, at, at), help);
    if text.len() > MOST_BYTES {
        let kind = MessageFaultKind::TooMuch { what: "bytes of a `package.xml`", limit: MOST_BYTES as u64 };
        return Err(kind.at(Span::new(file, 0, 0), "keep it short"));
    }
    let document = roxmltree::Document::parse(text).map_err(|error| {
        let place = error.pos();
        malformed(byte_of(text, place.row, place.col), format!("fix the XML: {error}"))
    })?;
    let root = document.root_element();
    let name = root.children().find(|node| node.has_tag_name("name"));
    let name = name.filter(|_| root.has_tag_name("package"));
    let help = || "write `<package><name>my_package</name>…</package>`".to_owned();
    let node = name.ok_or_else(|| malformed(root.range().start, help()))?;
    let text = node.children().find(|child| child.is_text());
    let text = text.ok_or_else(|| malformed(node.range().start, help()))?;
    let (name, range) = (text.text().unwrap_or_default().trim(), text.range());
    let span = Span::new(file, range.start, range.end);
    if let Some(rule) = NamedPart::Package.broken_rule(version, name) {
        let kind = MessageFaultKind::BadName { part: NamedPart::Package.noun(), name: name.to_owned() };
        return Err(kind.at(span, rule));
    }
    Ok((name.to_owned(), span))
}

/// The byte of a line and column, both from 1.
fn byte_of(text: &str, row: u32, column: u32) -> usize {
    let line = text.split_inclusive('\n').take(row.saturating_sub(1) as usize).map(str::len).sum::<usize>();
    let rest = text.get(line..).unwrap_or_default();
    let inside = rest.char_indices().nth(column.saturating_sub(1) as usize).map_or(rest.len(), |(at, _)| at);
    line + inside
}
