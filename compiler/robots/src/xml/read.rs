//! Text to tree, by roxmltree.

use std::borrow::Cow;

use hrdsl_source::{FileId, Span};
use roxmltree::{Document, Error, Node};

use super::tree::{XmlAttribute, XmlElement, XmlNode, XmlText};
use crate::{
    fault::{RobotFault, RobotFaultKind, RobotPlace},
    limits::{MOST_ELEMENTS, MOST_XML_DEPTH},
};

/// How many prefixes a file may use without declaring them.
const MOST_PREFIXES: usize = 16;

/// A text in which all prefixes are declared: included files of xacro often do without, as its own reader lets them.
pub(crate) struct DeclaredText<'t> {
    pub text: Cow<'t, str>,
    /// Where declarations were put in, and how many bytes.
    at: usize,
    added: usize,
}

impl<'t> DeclaredText<'t> {
    pub fn new(text: &'t str) -> Self {
        let mut declared = Self { text: Cow::Borrowed(text), at: 0, added: 0 };
        for _ in 0..MOST_PREFIXES {
            let Err(Error::UnknownNamespace(prefix, _)) = Document::parse(&declared.text) else { break };
            let Some(at) = end_of_root_name(text) else { break };
            let declaration = format!(" xmlns:{prefix}=\"{prefix}\"");
            declared.at = at;
            declared.added += declaration.len();
            declared.text.to_mut().insert_str(at, &declaration);
        }
        declared
    }

    /// The byte of the text as it was.
    pub fn original(&self, byte: usize) -> usize {
        if byte > self.at { byte.saturating_sub(self.added).max(self.at) } else { byte }
    }
}

/// Where the name of the root element ends.
fn end_of_root_name(text: &str) -> Option<usize> {
    let mut at = 0;
    loop {
        at += text.get(at..)?.find('<')?;
        let rest = text.get(at..)?;
        let end = if rest.starts_with("<!--") {
            "-->"
        } else if rest.starts_with("<?") {
            "?>"
        } else if rest.starts_with("<!") {
            ">"
        } else {
            let ends = |c: char| c.is_whitespace() || c == '/' || c == '>';
            return Some(at + rest.find(ends)?);
        };
        at += rest.find(end)? + end.len();
    }
}

/// The byte of a line and column, both from 1.
fn byte_of(text: &str, row: u32, column: u32) -> usize {
    let line = text.split_inclusive('\n').take(row.saturating_sub(1) as usize).map(str::len).sum::<usize>();
    let rest = text.get(line..).unwrap_or_default();
    let inside = rest.char_indices().nth(column.saturating_sub(1) as usize).map_or(rest.len(), |(at, _)| at);
    line + inside
}

/// The root of a document.
pub(crate) fn read_xml(file: FileId, text: &str) -> Result<XmlElement, RobotFault> {
    if depth_of(text) > MOST_XML_DEPTH {
        let kind = RobotFaultKind::TooMuch { what: "elements within elements", limit: MOST_XML_DEPTH };
        return Err(kind.at(Span::new(file, 0, 0), "name a description of a robot"));
    }
    let declared = DeclaredText::new(text);
    let document = Document::parse(&declared.text).map_err(|error| {
        let place = error.pos();
        let at = declared.original(byte_of(&declared.text, place.row, place.col));
        let kind = RobotFaultKind::BrokenXml(error.to_string());
        kind.at(Span::new(file, at, (at + 1).min(text.len())), "fix the XML")
    })?;
    let mut tree = TreeReader { file, declared: &declared, elements: 0 };
    tree.element(document.root_element())
}

/// How deep elements lie in elements, at most: the parser goes down once for each.
pub(crate) fn depth_of(text: &str) -> usize {
    let (mut depth, mut deepest) = (0_usize, 0_usize);
    let mut rest = text;
    while let Some((_, after)) = rest.split_once('<') {
        let skipped = [("!--", "-->"), ("![CDATA[", "]]>"), ("?", "?>")]
            .iter()
            .find_map(|(begin, end)| Some(after.strip_prefix(begin)?.split_once(end).map_or("", |(_, r)| r)));
        if let Some(after) = skipped {
            rest = after;
            continue;
        }
        let (closes, (inside, after)) = (after.starts_with('/'), tag_end(after));
        if closes {
            depth = depth.saturating_sub(1);
        } else if !inside.ends_with('/') && !inside.starts_with('!') {
            depth += 1;
            deepest = deepest.max(depth);
        }
        rest = after;
    }
    deepest
}

/// A tag up to its `>`, which does not count within quotes, and what follows.
fn tag_end(text: &str) -> (&str, &str) {
    let mut quote = None;
    for (at, byte) in text.bytes().enumerate() {
        match (quote, byte) {
            (None, b'"' | b'\'') => quote = Some(byte),
            (Some(open), _) if open == byte => quote = None,
            (None, b'>') => return (text.get(..at).unwrap_or(""), text.get(at + 1..).unwrap_or("")),
            _ => {}
        }
    }
    (text, "")
}

struct TreeReader<'a> {
    file: FileId,
    declared: &'a DeclaredText<'a>,
    elements: usize,
}

impl TreeReader<'_> {
    fn span(&self, range: std::ops::Range<usize>) -> Span {
        Span::new(self.file, self.declared.original(range.start), self.declared.original(range.end))
    }

    fn element(&mut self, node: Node) -> Result<XmlElement, RobotFault> {
        let (name, place) = self.name(node);
        self.elements += 1;
        if self.elements > MOST_ELEMENTS {
            let kind = RobotFaultKind::TooMuch { what: "elements of a description", limit: MOST_ELEMENTS };
            return Err(kind.at(place, "describe a smaller robot"));
        }
        let attribute = |attribute: roxmltree::Attribute| XmlAttribute {
            name: self.declared.text.get(attribute.range_qname()).unwrap_or(attribute.name()).to_owned(),
            value: attribute.value().to_owned(),
            span: self.span(attribute.range_value()),
        };
        let attributes = node.attributes().map(attribute).collect();
        let mut children = Vec::new();
        for child in node.children() {
            if child.is_element() {
                children.push(XmlNode::Element(self.element(child)?));
            } else if let Some(text) = child.text().filter(|_| child.is_text()) {
                children
                    .push(XmlNode::Text(XmlText { text: text.to_owned(), span: self.span(child.range()) }));
            }
        }
        Ok(XmlElement { name, place, attributes, children })
    }

    /// The name as it is written, with its prefix.
    fn name(&self, node: Node) -> (String, RobotPlace) {
        let start = node.range().start + 1;
        let rest = self.declared.text.get(start..).unwrap_or_default();
        let length = rest.find(|c: char| c.is_whitespace() || c == '/' || c == '>').unwrap_or(rest.len());
        let name = rest.get(..length).unwrap_or_default().to_owned();
        (name, self.span(start..start + length).into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hrdsl_source::SourceFiles;

    #[test]
    fn places_are_those_of_the_file_whatever_is_declared() {
        let text = "<?xml version=\"1.0\"?>\n<!-- <x> -->\n<robot name='a&amp;b'><xacro:if value=\"${1}\">t</xacro:if></robot>";
        let mut files = SourceFiles::default();
        let file = files.add("r", text);
        let root = read_xml(file, text).unwrap();
        assert_eq!((root.name.as_str(), files.text(root.place.span)), ("robot", "robot"));
        let name = root.attribute("name").unwrap();
        assert_eq!((name.value.as_str(), files.text(name.span)), ("a&b", "a&amp;b"));
        let inner = root.elements().next().unwrap();
        assert_eq!((inner.name.as_str(), files.text(inner.place.span)), ("xacro:if", "xacro:if"));
        assert_eq!(files.text(inner.attribute("value").unwrap().span), "${1}");
        assert_eq!(inner.text(), "t");
    }

    #[test]
    fn broken_and_deep_documents_are_faults() {
        let file = FileId(0);
        for (text, word) in
            [("<a><b></a>", "broken-xml"), ("", "broken-xml"), ("<a b=\"1\" b=\"2\"/>", "broken-xml")]
        {
            assert_eq!(read_xml(file, text).unwrap_err().kind.word(), word, "{text}");
        }
        let deep = format!("{}{}", "<a>".repeat(100_000), "</a>".repeat(100_000));
        assert_eq!(read_xml(file, &deep).unwrap_err().kind.word(), "too-much");
    }
}
