//! Diagnostics for people: the place, the text, what to type; in colour where colours are on.

use std::fmt;

use hrdsl_source::{Diagnostic, Severity, SourceFiles, SpanLabel, printable};
use miette::{GraphicalReportHandler, GraphicalTheme, LabeledSpan, SourceCode};

use super::excerpt::SourceExcerpt;

/// Findings of a file that are shown unless somebody asks for more: nobody reads on.
pub const SHOWN: usize = 50;

/// One diagnostic as miette wants it.
struct MietteDiagnostic<'a> {
    diagnostic: &'a Diagnostic,
    source: SourceExcerpt,
}

impl fmt::Debug for MietteDiagnostic<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.diagnostic.fmt(f)
    }
}

impl fmt::Display for MietteDiagnostic<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&clean(&self.diagnostic.message))
    }
}

impl std::error::Error for MietteDiagnostic<'_> {}

impl miette::Diagnostic for MietteDiagnostic<'_> {
    fn code<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(self.diagnostic.code))
    }

    fn severity(&self) -> Option<miette::Severity> {
        Some(match self.diagnostic.severity {
            Severity::Error => miette::Severity::Error,
            Severity::Warning => miette::Severity::Warning,
        })
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.diagnostic.help.as_ref().map(|h| Box::new(clean(h)) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(&self.source)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let first = self.diagnostic.span();
        let own = own_labels(self.diagnostic).zip(self.source.labels());
        Some(Box::new(own.map(move |(label, place)| {
            let text = (!label.text.is_empty()).then(|| clean(&label.text));
            let place = (place.start, place.len());
            if label.span == first {
                LabeledSpan::new_primary_with_span(text, place)
            } else {
                LabeledSpan::new_with_span(text, place)
            }
        })))
    }
}

/// The labels in the file of the first one: only one file is shown.
fn own_labels(diagnostic: &Diagnostic) -> impl Iterator<Item = &SpanLabel> {
    let file = diagnostic.span().file;
    diagnostic.labels.iter().filter(move |l| l.span.file == file)
}

/// Text that may quote the file: printable, without the middle of what nobody reads to the end.
fn clean(text: &str) -> String {
    const START: usize = 1500;
    const END: usize = 300;
    let text = printable(text);
    let (start, end) = (text.char_indices().nth(START), text.char_indices().rev().nth(END));
    match (start, end) {
        (Some((start, _)), Some((end, _))) if start < end => {
            format!("{} … {}", &text[..start], &text[end..])
        }
        _ => text.into_owned(),
    }
}

/// A diagnostic with its piece of source.
#[must_use]
pub fn diagnostic(files: &SourceFiles, diagnostic: &Diagnostic) -> String {
    let theme = if crate::color::stderr_has() {
        GraphicalTheme::unicode()
    } else {
        GraphicalTheme::unicode_nocolor()
    };
    let file = files.get(diagnostic.span().file);
    let source = file.map(|file| SourceExcerpt::new(file, own_labels(diagnostic))).unwrap_or_default();
    let shown = MietteDiagnostic { diagnostic, source };
    let mut out = String::new();
    let handler = GraphicalReportHandler::new_themed(theme).with_width(100).with_links(false);
    if handler.render_report(&mut out, &shown).is_err() {
        out = format!("{}: {}\n", files.place(diagnostic.span()), clean(&diagnostic.message));
    }
    out
}

/// `2 errors, 1 warning`
#[must_use]
pub fn totals(errors: usize, warnings: usize) -> String {
    let plural = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
    match (errors, warnings) {
        (e, 0) => plural(e, "error"),
        (0, w) => plural(w, "warning"),
        (e, w) => format!("{}, {}", plural(e, "error"), plural(w, "warning")),
    }
}
