//! Pieces of a text that know where in their file they are.

use hrdsl_source::{FileId, Span};

/// A piece of a file's text, and the byte that it begins at.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedText<'a> {
    pub file: FileId,
    pub at: usize,
    pub text: &'a str,
}

impl<'a> PlacedText<'a> {
    pub fn span(self) -> Span {
        Span::new(self.file, self.at, self.at + self.text.len())
    }

    pub fn is_empty(self) -> bool {
        self.text.is_empty()
    }

    /// A part of this text, which begins at the byte `from` of it.
    pub fn part(self, from: usize, text: &'a str) -> Self {
        Self { at: self.at + from, text, ..self }
    }

    /// Without the blanks around it.
    pub fn trimmed(self) -> Self {
        let text = self.text.trim_start();
        self.part(self.text.len() - text.len(), text.trim_end())
    }

    /// Up to the first character that ends it, and from there on.
    pub fn split_before(self, ends: impl Fn(char) -> bool) -> (Self, Self) {
        let (before, after) = self.text.split_at(self.text.find(ends).unwrap_or(self.text.len()));
        (self.part(0, before), self.part(before.len(), after))
    }

    /// Without what it begins with.
    pub fn after(self, prefix: &str) -> Option<Self> {
        self.text.strip_prefix(prefix).map(|rest| self.part(prefix.len(), rest))
    }

    /// The lines, without their ends.
    pub fn lines(self) -> impl Iterator<Item = Self> {
        let mut at = 0;
        self.text.split('\n').map(move |line| {
            let placed = self.part(at, line.strip_suffix('\r').unwrap_or(line));
            at += line.len() + 1;
            placed
        })
    }
}
