//! The lines of a file that a diagnostic speaks of: printable, of long lines the pieces at the labels, of long labels the
//! start. Only these are looked at, however large the file is.

use std::{collections::BTreeSet, ops::Range};

use hrdsl_source::{SourceFile, Span, SpanLabel, printable_char, printable_line};
use miette::{MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};

/// Labels that are shown, at most; what is said of more is in the message and in JSON.
const LABELS: usize = 12;
/// A line of more characters is shown in pieces.
const WIDE: usize = 200;
/// What is shown of such a line on each side of a label, and of a long label at each end.
const AROUND: usize = 50;
/// Lines of a label that are shown, at most.
const LINES: usize = 8;
const LEFT_OUT: &str = " … ";

/// A piece of a file, with labels in it.
#[derive(Debug, Default)]
pub struct SourceExcerpt {
    name: String,
    text: String,
    lines: Vec<ExcerptLine>,
    /// The label's place in the file and here, and its column in the file, from 0.
    labels: Vec<(Span, Range<usize>, usize)>,
}

/// A line of the excerpt.
#[derive(Debug)]
struct ExcerptLine {
    /// In the file, from 0.
    number: usize,
    /// Here, with its end.
    range: Range<usize>,
    pieces: Vec<ExcerptPiece>,
}

/// Bytes of the file, and where they begin here. One character stands for one, of whatever length.
#[derive(Debug)]
struct ExcerptPiece {
    source: Range<usize>,
    start: usize,
}

impl SourceExcerpt {
    /// The lines of these labels, which are of this file.
    pub fn new<'l>(file: &SourceFile, labels: impl Iterator<Item = &'l SpanLabel>) -> Self {
        let spans: Vec<Span> = labels.take(LABELS).map(|l| short(file, l.span)).collect();
        let mut numbers = BTreeSet::new();
        for span in &spans {
            let (first, last) = (file.line_at(span.start), file.line_at(last_byte(*span)));
            numbers.extend(first.saturating_sub(1)..=last + 1);
        }
        let mut excerpt = Self { name: printable_line(&file.name).into_owned(), ..Self::default() };
        for number in numbers {
            let Some(line) = file.line(number) else { continue };
            // The text's last line end begins no line.
            if !line.is_empty() || number == 0 || line.start < file.text.len() {
                excerpt.add(file, number, line, &spans);
            }
        }
        for span in spans {
            let range = excerpt.place(file, span.start)..excerpt.place(file, span.end);
            let column = file.position(span.start).column.saturating_sub(1) as usize;
            excerpt.labels.push((span, range, column));
        }
        excerpt
    }

    /// Where each label is, here.
    pub fn labels(&self) -> impl Iterator<Item = Range<usize>> {
        self.labels.iter().map(|(_, range, _)| range.start..range.end.max(range.start))
    }

    fn add(&mut self, file: &SourceFile, number: usize, line: Range<usize>, spans: &[Span]) {
        let start = self.text.len();
        let mut pieces = Vec::new();
        for source in kept(file, &line, spans) {
            if source.start > line.start {
                self.text += LEFT_OUT;
            }
            pieces.push(ExcerptPiece { source: source.clone(), start: self.text.len() });
            self.text.extend(file.text[source].chars().map(shown));
        }
        if pieces.last().is_some_and(|p| p.source.end < line.end) {
            self.text += LEFT_OUT;
        }
        self.text.push('\n');
        self.lines.push(ExcerptLine { number, range: start..self.text.len(), pieces });
    }

    /// Where a byte of the file is, here; of what is left out, where that is said.
    fn place(&self, file: &SourceFile, byte: u32) -> usize {
        let number = file.line_at(byte);
        let Some(line) = self.lines.iter().rfind(|l| l.number <= number) else { return 0 };
        let byte = byte as usize;
        let Some(piece) = line.pieces.iter().rfind(|p| p.source.start <= byte) else {
            return line.range.start;
        };
        let before = file.text.get(piece.source.start..byte.min(piece.source.end)).unwrap_or("");
        piece.start + before.chars().map(|c| shown(c).len_utf8()).sum::<usize>()
    }

    /// The line, by its index here, that holds a byte of the excerpt.
    fn line_of(&self, byte: usize) -> usize {
        self.lines.partition_point(|l| l.range.end <= byte).min(self.lines.len().saturating_sub(1))
    }
}

/// A tab is no line's end, and is shown as blanks.
fn shown(c: char) -> char {
    if c == '\t' { c } else { printable_char(c) }
}

/// The last byte of a span that is not empty.
fn last_byte(span: Span) -> u32 {
    span.end.saturating_sub(1).max(span.start)
}

/// A span over many lines without all but the first of them.
fn short(file: &SourceFile, span: Span) -> Span {
    let first = file.line_at(span.start);
    if file.line_at(last_byte(span)) < first + LINES {
        return span;
    }
    let end = file.line(first + LINES - 1).map_or(span.end, |l| l.end as u32);
    Span { end: end.max(span.start), ..span }
}

/// What is shown of a line: all of it, or what is near a label.
fn kept(file: &SourceFile, line: &Range<usize>, spans: &[Span]) -> Vec<Range<usize>> {
    let text = &file.text[line.clone()];
    if text.len() <= WIDE || text.char_indices().nth(WIDE).is_none() {
        return vec![line.clone()];
    }
    let mut ends: Vec<usize> = spans
        .iter()
        .flat_map(|s| [s.start as usize, s.end as usize])
        .filter(|end| (line.start..=line.end).contains(end))
        .collect();
    ends.sort_unstable();
    if ends.is_empty() {
        ends.push(line.start);
    }
    let mut kept: Vec<Range<usize>> = Vec::new();
    for end in ends {
        let around = around(text, end - line.start);
        let (start, end) = (line.start + around.start, line.start + around.end);
        match kept.last_mut() {
            Some(last) if start <= last.end + LEFT_OUT.len() => last.end = end,
            _ => kept.push(start..end),
        }
    }
    kept
}

/// The characters near a byte.
fn around(text: &str, byte: usize) -> Range<usize> {
    let byte = text.floor_char_boundary(byte);
    let start = text[..byte].char_indices().rev().nth(AROUND - 1).map_or(0, |(at, _)| at);
    let end = text[byte..].char_indices().nth(AROUND).map_or(text.len(), |(at, _)| byte + at);
    start..end
}

impl SourceCode for SourceExcerpt {
    /// The lines of a span with those around them, as far as they follow one another in the file.
    fn read_span<'s>(
        &'s self,
        span: &SourceSpan,
        before: usize,
        after: usize,
    ) -> Result<Box<dyn SpanContents<'s> + 's>, MietteError> {
        let follows = |line: usize| self.lines[line].number == self.lines[line - 1].number + 1;
        let (start, end) = (span.offset(), span.offset() + span.len());
        if self.lines.is_empty() || end > self.text.len() {
            return Err(MietteError::OutOfBounds);
        }
        let (mut first, mut last) = (self.line_of(start), self.line_of(end.saturating_sub(1).max(start)));
        if !(first + 1..=last).all(follows) {
            return Err(MietteError::OutOfBounds);
        }
        for _ in 0..before {
            first -= usize::from(first > 0 && follows(first));
        }
        for _ in 0..after {
            last += usize::from(last + 1 < self.lines.len() && follows(last + 1));
        }
        // Without lines around it, what is asked for is where the span is.
        let column = self.labels.iter().find(|(_, range, _)| before + after == 0 && range.start == start);
        let whole = self.lines[first].range.start..self.lines[last].range.end;
        Ok(Box::new(MietteSpanContents::new_named(
            self.name.clone(),
            &self.text.as_bytes()[whole.clone()],
            (whole.start, whole.len()).into(),
            self.lines[first].number,
            column.map_or(0, |(_, _, column)| *column),
            last - first + 1,
        )))
    }
}
