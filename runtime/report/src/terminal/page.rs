//! Lines of styled text on a terminal of some width.

use std::fmt::Write as _;

use hrdsl_results::{CampaignResults, TestResult, VerdictOutcome as Outcome};

use crate::text;

/// Room for a label at the start of a line, at the least.
pub const LABEL: usize = 20;

/// Colours; each comes with a symbol or word that says the same.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum TerminalStyle {
    Plain,
    Bold,
    Dim,
    Good,
    Bad,
    Warn,
}

impl TerminalStyle {
    fn code(self) -> &'static str {
        match self {
            TerminalStyle::Plain => "",
            TerminalStyle::Bold => "1",
            TerminalStyle::Dim => "2",
            TerminalStyle::Good => "36",
            TerminalStyle::Bad => "1;31",
            TerminalStyle::Warn => "33",
        }
    }

    pub fn of(outcome: Outcome) -> Self {
        match outcome {
            Outcome::Pass => TerminalStyle::Good,
            Outcome::Fail => TerminalStyle::Bad,
            Outcome::Vacuous => TerminalStyle::Dim,
            Outcome::Inconclusive | Outcome::Error => TerminalStyle::Warn,
        }
    }
}

/// A piece of a line. Its text is clean.
pub struct StyledSpan(pub String, pub TerminalStyle);

pub fn left(text: &str, width: usize, style: TerminalStyle) -> StyledSpan {
    let text = text::cut(text, width);
    StyledSpan(format!("{text:<width$}"), style)
}

pub fn right(text: &str, width: usize, style: TerminalStyle) -> StyledSpan {
    let text = text::cut(text, width);
    StyledSpan(format!("{text:>width$}"), style)
}

pub struct TerminalPage {
    pub out: String,
    pub width: usize,
    color: bool,
}

impl TerminalPage {
    pub fn new(width: usize, color: bool) -> Self {
        Self { out: String::new(), width: width.max(40), color }
    }

    pub fn line(&mut self, cells: &[StyledSpan]) {
        let used = cells.iter().rposition(|c| !c.0.trim_end().is_empty()).map_or(0, |last| last + 1);
        let mut room = self.width;
        for (i, StyledSpan(text, style)) in cells[..used].iter().enumerate() {
            let text = text::cut(text, room);
            room -= text.chars().count();
            let text = if i + 1 == used { text.trim_end() } else { &text };
            if self.color && *style != TerminalStyle::Plain && !text.trim().is_empty() {
                let _ = write!(self.out, "\u{1b}[{}m{text}\u{1b}[0m", style.code());
            } else {
                self.out.push_str(text);
            }
        }
        self.out.push('\n');
    }

    /// The command that runs a test again.
    pub fn command(&mut self, results: &CampaignResults, test: &TestResult) {
        if let Some(command) = results.rerun_of(test) {
            self.whole(&format!("  {}", text::line(&command)));
        }
    }

    /// A line that is there to be copied: it is not cut.
    pub fn whole(&mut self, text: &str) {
        let width = std::mem::replace(&mut self.width, text.chars().count());
        self.line(&[StyledSpan(text.to_owned(), TerminalStyle::Dim)]);
        self.width = width;
    }

    /// How many columns of a width fit beside the least label.
    pub fn fit(&self, column: usize) -> usize {
        (self.width.saturating_sub(LABEL) / column).max(1)
    }

    pub fn label(&self, columns: usize, column: usize) -> usize {
        self.width.saturating_sub(columns * column).max(8)
    }
}
