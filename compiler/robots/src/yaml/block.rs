//! Blocks: mappings and sequences by their indentation.

use super::{
    flow::FlowReader,
    line::{YamlFault, YamlLine, fault, lines},
    scalar::quoted,
    value::YamlValue,
};
use crate::limits::MOST_NESTING;

/// Reads the first document of a file.
pub(crate) fn read_yaml(text: &str) -> Result<YamlValue, YamlFault> {
    let text_lines = lines(text)?;
    let Some(first) = text_lines.first().copied() else { return Ok(YamlValue::Null) };
    let mut reader = BlockReader { lines: text_lines, next: 0 };
    let value = reader.block(first.indent, 0)?;
    match reader.peek() {
        Some(line) => fault(line.at, "this line is indented otherwise than those above it"),
        None => Ok(value),
    }
}

struct BlockReader<'a> {
    lines: Vec<YamlLine<'a>>,
    next: usize,
}

impl<'a> BlockReader<'a> {
    fn peek(&self) -> Option<YamlLine<'a>> {
        self.lines.get(self.next).copied()
    }

    /// What is indented so far.
    fn block(&mut self, indent: usize, depth: usize) -> Result<YamlValue, YamlFault> {
        let Some(line) = self.peek() else { return Ok(YamlValue::Null) };
        if depth > MOST_NESTING {
            return fault(line.at, format!("blocks lie deeper than {MOST_NESTING} in each other"));
        }
        if dash(line.text) {
            self.sequence(indent, depth)
        } else if key_of(line)?.is_some() {
            self.mapping(indent, depth)
        } else {
            self.next += 1;
            self.inline(line)
        }
    }

    fn sequence(&mut self, indent: usize, depth: usize) -> Result<YamlValue, YamlFault> {
        let mut items = Vec::new();
        while let Some(line) = self.peek().filter(|line| line.indent == indent && dash(line.text)) {
            let rest = line.text.get(1..).unwrap_or_default();
            let said = rest.trim_start();
            if said.is_empty() {
                self.next += 1;
                items.push(self.below(indent, depth)?);
                continue;
            }
            // What follows the dash is a line of its own, which is indented by the dash, too.
            let by = line.text.len() - said.len();
            if let Some(slot) = self.lines.get_mut(self.next) {
                *slot = YamlLine { indent: indent + by, text: said, at: line.at + by };
            }
            items.push(self.block(indent + by, depth + 1)?);
        }
        Ok(YamlValue::List(items))
    }

    fn mapping(&mut self, indent: usize, depth: usize) -> Result<YamlValue, YamlFault> {
        let mut pairs: Vec<(YamlValue, YamlValue)> = Vec::new();
        while let Some(line) = self.peek().filter(|line| line.indent == indent && !dash(line.text)) {
            let Some((key, length)) = key_of(line)? else {
                return fault(line.at, "a `key: value` is missing");
            };
            let rest = line.text.get(length..).unwrap_or_default();
            let said = rest.trim_start();
            self.next += 1;
            let value = if said.is_empty() {
                // A sequence may stand right below its key, not indented.
                match self.peek().filter(|next| next.indent == indent && dash(next.text)) {
                    Some(_) => self.sequence(indent, depth + 1)?,
                    None => self.below(indent, depth)?,
                }
            } else {
                let by = line.text.len() - said.len();
                self.inline(YamlLine { indent: line.indent + by, text: said, at: line.at + by })?
            };
            // Of two values of one key the later counts, as for the readers that descriptions are written for.
            match pairs.iter_mut().find(|(other, _)| *other == key) {
                Some((_, old)) => *old = value,
                None => pairs.push((key, value)),
            }
        }
        match self.peek() {
            Some(line) if line.indent > indent => fault(line.at, "this line belongs to none above it"),
            Some(_) | None => Ok(YamlValue::Map(pairs)),
        }
    }

    /// What is indented further than this, or nothing.
    fn below(&mut self, indent: usize, depth: usize) -> Result<YamlValue, YamlFault> {
        match self.peek().filter(|line| line.indent > indent) {
            Some(line) => self.block(line.indent, depth + 1),
            None => Ok(YamlValue::Null),
        }
    }

    /// A value that begins on a line; one in brackets may go on on the next ones.
    fn inline(&mut self, line: YamlLine<'a>) -> Result<YamlValue, YamlFault> {
        if line.text.starts_with(['|', '>']) {
            return fault(line.at, "texts of several lines (`|`, `>`) are not read");
        }
        if line.text.starts_with(['@', '`', '%']) {
            return fault(line.at, "a text cannot begin so; put it into quotes");
        }
        if !line.text.starts_with(['[', '{', '"', '\'', '!', '&', '*']) {
            return Ok(super::scalar::plain(line.text));
        }
        let mut joined = line.text.to_owned();
        while open_brackets(&joined) && self.peek().is_some() {
            let next = self.peek().map(|next| next.text).unwrap_or_default();
            joined = format!("{joined} {next}");
            self.next += 1;
        }
        let mut reader = FlowReader { text: &joined, start: line.at, at: 0 };
        let value = reader.value(0)?;
        if reader.is_done() {
            Ok(value)
        } else {
            fault(line.at, "something follows that does not belong to the value")
        }
    }
}

fn dash(text: &str) -> bool {
    text == "-" || text.starts_with("- ")
}

/// The key that a line begins with, and how long it is with its colon.
fn key_of(line: YamlLine) -> Result<Option<(YamlValue, usize)>, YamlFault> {
    let text = line.text;
    let (key, length) = match text.chars().next() {
        Some('"' | '\'') => {
            let (key, length) = quoted(text, line.at)?;
            (YamlValue::Text(key), length)
        }
        Some('[' | '{' | '!') => return Ok(None),
        Some('&' | '*') => return fault(line.at, "anchors and aliases are not read"),
        Some('?') if text.starts_with("? ") => return fault(line.at, "keys after `?` are not read"),
        Some(_) | None => {
            let ends = text.char_indices().find(|(at, c)| {
                *c == ':' && text.get(at + 1..).is_none_or(|rest| rest.is_empty() || rest.starts_with(' '))
            });
            let Some((at, _)) = ends else { return Ok(None) };
            (super::scalar::plain(text.get(..at).unwrap_or_default().trim_end()), at)
        }
    };
    let rest = text.get(length..).unwrap_or_default();
    let blanks = rest.len() - rest.trim_start().len();
    match rest.trim_start().strip_prefix(':') {
        Some(_) if key == YamlValue::Text("<<".to_owned()) => fault(line.at, "merging (`<<`) is not read"),
        Some(after) if after.is_empty() || after.starts_with(' ') => Ok(Some((key, length + blanks + 1))),
        Some(_) | None => Ok(None),
    }
}

/// Whether brackets are still open, quotes left aside.
fn open_brackets(text: &str) -> bool {
    let (mut open, mut quote) = (0_i64, None);
    for c in text.chars() {
        match (quote, c) {
            (None, '"' | '\'') => quote = Some(c),
            (Some(q), _) if q == c => quote = None,
            (None, '[' | '{') => open += 1,
            (None, ']' | '}') => open -= 1,
            _ => {}
        }
    }
    open > 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use YamlValue::{Bool, Float, Int, List, Map, Null, Tagged, Text};

    fn text(text: &str) -> YamlValue {
        Text(text.to_owned())
    }

    #[test]
    fn blocks_brackets_and_scalars() {
        let read = read_yaml(
            "# map\n---\nimage: a.pgm   # the picture\norigin: [-1.5, 2, 0.0]\nlimits:\n  j1: {lo: !degrees -90, hi: 1e3}\n  \
             j2:\n    - 1\n    - x: yes\n      y: '#no'\n    -\n      - ~\nlist:\n- a\n- \"b: \\\"c\\\"\"\nempty:\n",
        );
        let map = |pairs: Vec<(&str, YamlValue)>| Map(pairs.into_iter().map(|(k, v)| (text(k), v)).collect());
        let tagged = Tagged("!degrees".into(), "-90".into());
        let expected = map(vec![
            ("image", text("a.pgm")),
            ("origin", List(vec![Float(-1.5), Int(2), Float(0.0)])),
            (
                "limits",
                map(vec![
                    ("j1", map(vec![("lo", tagged), ("hi", text("1e3"))])),
                    (
                        "j2",
                        List(vec![
                            Int(1),
                            map(vec![("x", Bool(true)), ("y", text("#no"))]),
                            List(vec![Null]),
                        ]),
                    ),
                ]),
            ),
            ("list", List(vec![text("a"), text("b: \"c\"")])),
            ("empty", Null),
        ]);
        assert_eq!(read, Ok(expected));
    }

    #[test]
    fn what_is_not_read_is_refused_at_its_place() {
        for (source, at, word) in [
            ("a: |\n  b\n", 3, "several lines"),
            ("a: &x 1\n", 3, "anchors"),
            ("a: [1, 2\n", 8, "missing"),
            ("a: 1\n  b: 2\n", 7, "belongs to none"),
            ("a:\n\tb: 1\n", 3, "tab"),
            ("<<: *a\n", 0, "merging"),
            ("a: 'b\n", 3, "end"),
        ] {
            let fault = read_yaml(source).unwrap_err();
            assert!(fault.at == at && fault.reason.contains(word), "{source:?}: {fault:?}");
        }
    }
}
