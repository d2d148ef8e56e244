//! What is wrong with a formula of the command line: its text, with a mark at the place.

use std::fmt;

use hrdsl_runtime::judge::FormulaError;
use hrdsl_source::{printable, printable_line};
use miette::{GraphicalReportHandler, GraphicalTheme, LabeledSpan, NamedSource, SourceCode};

/// The error as miette wants it.
#[derive(Debug)]
struct FormulaReport {
    message: String,
    help: Option<String>,
    source: NamedSource<String>,
    place: (usize, usize),
}

impl fmt::Display for FormulaReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for FormulaReport {}

impl miette::Diagnostic for FormulaReport {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.help.as_ref().map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(&self.source)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        Some(Box::new(std::iter::once(LabeledSpan::new_primary_with_span(None, self.place))))
    }
}

/// The error, for people.
#[must_use]
pub fn formula(name: &str, text: &str, error: &FormulaError) -> String {
    let theme = if crate::color::stderr_has() {
        GraphicalTheme::unicode()
    } else {
        GraphicalTheme::unicode_nocolor()
    };
    // What cannot be printed may take more bytes once it is shown.
    let shown = |to: usize| printable(text.get(..to).unwrap_or(text)).len();
    let (start, end) = (shown(error.range.start), shown(error.range.end));
    let report = FormulaReport {
        message: printable_line(&error.message).into_owned(),
        help: error.help.as_deref().map(|help| printable_line(help).into_owned()),
        source: NamedSource::new(name, printable(text).into_owned()),
        place: (start, end - start),
    };
    let mut out = String::new();
    let handler = GraphicalReportHandler::new_themed(theme).with_width(100).with_links(false);
    if handler.render_report(&mut out, &report).is_err() {
        out = format!("{name}: {error}\n");
    }
    out
}
