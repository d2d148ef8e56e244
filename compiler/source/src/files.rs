//! The files of a compilation, and places in them as people count.

use std::ops::Range;

use crate::{FileId, Span, printable_line};

/// One file's name and text.
#[derive(Clone, Debug)]
pub struct SourceFile {
    /// As it is shown: a path, or `std.person`.
    pub name: String,
    pub text: String,
    /// The byte at which each line starts.
    line_starts: Vec<u32>,
    /// How many characters begin before each block of [`BLOCK`] bytes: a column of a long line is not counted from its start.
    chars_before: Vec<u32>,
}

const BLOCK: usize = 256;

/// What stands for the name of a file where there is none: a span of what was made up lies in no file.
const NO_FILE: &str = "(no file)";

/// A place as people count: from 1, columns in characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct TextPosition {
    pub line: u32,
    pub column: u32,
}

/// All files of a compilation.
#[derive(Clone, Debug, Default)]
pub struct SourceFiles {
    files: Vec<SourceFile>,
}

impl SourceFiles {
    /// Adds a file and gives its id.
    pub fn add(&mut self, name: impl Into<String>, text: impl Into<String>) -> FileId {
        let text = text.into();
        self.files.push(SourceFile::new(name.into(), text));
        FileId(u16::try_from(self.files.len() - 1).unwrap_or(u16::MAX))
    }

    /// The file of this id; `None` for an id of another compilation.
    #[must_use]
    pub fn get(&self, id: FileId) -> Option<&SourceFile> {
        self.files.get(id.0 as usize)
    }

    /// The name of the file of this id, as it is shown.
    #[must_use]
    pub fn name(&self, id: FileId) -> &str {
        self.get(id).map_or(NO_FILE, |f| &f.name)
    }

    pub fn iter(&self) -> impl Iterator<Item = (FileId, &SourceFile)> {
        self.files.iter().enumerate().map(|(i, f)| (FileId(u16::try_from(i).unwrap_or(u16::MAX)), f))
    }

    /// The text that a span covers; empty if it lies outside its file.
    #[must_use]
    pub fn text(&self, span: Span) -> &str {
        self.get(span.file).and_then(|f| f.text.get(span.range())).unwrap_or("")
    }

    /// Where a span starts.
    #[must_use]
    pub fn position(&self, span: Span) -> TextPosition {
        self.get(span.file).map_or(TextPosition { line: 1, column: 1 }, |f| f.position(span.start))
    }

    /// `file:line:column`, on one line whatever the file is called.
    #[must_use]
    pub fn place(&self, span: Span) -> String {
        let TextPosition { line, column } = self.position(span);
        format!("{}:{line}:{column}", printable_line(self.name(span.file)))
    }
}

impl SourceFile {
    fn new(name: String, text: String) -> Self {
        let ends = memchr::memchr_iter(b'\n', text.as_bytes());
        let line_starts = std::iter::once(0).chain(ends.map(|end| end as u32 + 1)).collect();
        let mut before = 0;
        let block = |bytes: &[u8]| {
            let here = before;
            before += starts(bytes);
            here
        };
        let chars_before = text.as_bytes().chunks(BLOCK).map(block).collect();
        Self { name, text, line_starts, chars_before }
    }

    /// The line and column of a byte.
    #[must_use]
    pub fn position(&self, byte: u32) -> TextPosition {
        let line = self.line_at(byte);
        let before = self.chars_until(byte as usize).saturating_sub(self.chars_until(self.start_of(line)));
        TextPosition { line: line as u32 + 1, column: before + 1 }
    }

    /// The line of a byte, from 0.
    #[must_use]
    pub fn line_at(&self, byte: u32) -> usize {
        self.line_starts.partition_point(|start| *start <= byte).max(1) - 1
    }

    /// The bytes of a line, from 0, without its end; none if there are fewer lines.
    #[must_use]
    pub fn line(&self, line: usize) -> Option<Range<usize>> {
        let start = *self.line_starts.get(line)? as usize;
        let end = self.line_starts.get(line + 1).map_or(self.text.len(), |next| *next as usize - 1);
        let text = &self.text[start..end];
        Some(start..start + text.strip_suffix('\r').unwrap_or(text).len())
    }

    fn start_of(&self, line: usize) -> usize {
        self.line_starts.get(line).map_or(self.text.len(), |start| *start as usize)
    }

    /// How many characters begin before this byte.
    fn chars_until(&self, byte: usize) -> u32 {
        let byte = byte.min(self.text.len());
        let block = (byte / BLOCK).min(self.chars_before.len().saturating_sub(1));
        let before = self.chars_before.get(block).copied().unwrap_or(0);
        before + self.text.as_bytes().get((block * BLOCK).min(byte)..byte).map_or(0, starts)
    }
}

/// How many characters begin in these bytes.
fn starts(bytes: &[u8]) -> u32 {
    bytes.iter().filter(|b| **b & 0xc0 != 0x80).count() as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_counted_in_characters_from_the_start_of_their_line() {
        let text = format!("ä{}\r\n{}x\n", "é€".repeat(300), "b".repeat(255));
        let mut files = SourceFiles::default();
        let file = files.add("a\nb", text.as_str());
        let source = files.get(file).unwrap();
        let (mut line, mut column) = (1, 1);
        for (at, c) in text.char_indices() {
            assert_eq!(source.position(at as u32), TextPosition { line, column }, "{at}");
            (line, column) = if c == '\n' { (line + 1, 1) } else { (line, column + 1) };
        }
        assert_eq!(source.position(text.len() as u32), TextPosition { line: 3, column: 1 });
        assert_eq!(source.line(0).map(|l| l.end), text.find('\r'));
        assert_eq!((source.line(2).map(|l| l.len()), source.line(3)), (Some(0), None));
        assert_eq!(files.place(Span::new(file, 2, 3)), "a␊b:1:2");
        assert_eq!(files.place(Span::new(FileId(7), 2, 3)), "(no file):1:1");
        files.add("", "");
        assert_eq!(files.get(FileId(1)).unwrap().position(0), TextPosition { line: 1, column: 1 });
    }
}
