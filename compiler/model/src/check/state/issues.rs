//! Issues: the diagnostics so far, what bounds the work on them, and the names that are entered or refused.

use std::collections::BTreeSet;

use hrdsl_source::{Diagnostic, DiagnosticCode, Span};
use hrdsl_syntax::ast::NameSyntax;

use super::{
    item::MAX_COPIES,
    table::{MAX_NAMES, NameTable, RefusedName},
};
use crate::{noun::Noun, report::names::duplicate};

/// After so many comparisons no nearest names are looked for.
pub(crate) const MAX_COMPARED: usize = 500_000;

pub(crate) struct IssueList {
    pub list: Vec<Diagnostic>,
    /// How many names were looked at for those that were misspelt.
    pub compared: usize,
    /// How many nodes of expressions may still be copied.
    pub copies: usize,
    /// The codes and places of the first issues, those that were said of an instance among them.
    pub said: BTreeSet<(DiagnosticCode, Span)>,
    pub said_of: usize,
}

impl Default for IssueList {
    fn default() -> Self {
        Self { list: Vec::new(), compared: 0, copies: MAX_COPIES, said: BTreeSet::new(), said_of: 0 }
    }
}

impl IssueList {
    /// Enters a name into a table and gives its id, which is that of the next element of the table's vector.
    pub fn declare(&mut self, table: &mut NameTable, noun: Noun, name: &NameSyntax) -> Option<u16> {
        self.declare_as(table, noun, &name.text, name.span)
    }

    /// The same, for a name that is written otherwise than it is called.
    pub fn declare_as(&mut self, table: &mut NameTable, noun: Noun, full: &str, span: Span) -> Option<u16> {
        match table.insert(full, span) {
            Ok(id) => Some(id),
            Err(refused) => {
                self.list.extend(said_of(refused, noun, full, span));
                None
            }
        }
    }

    /// Whether the nearest names are still looked for: it takes time that grows with the names and with the misspelt ones.
    pub fn compares(&self) -> bool {
        self.compared <= MAX_COMPARED
    }

    /// A part that is used twice has its faults once.
    pub fn distinct(self) -> Vec<Diagnostic> {
        let mut seen: BTreeSet<(Span, DiagnosticCode, String)> = BTreeSet::new();
        self.list.into_iter().filter(|i| seen.insert((i.span(), i.code, i.message.clone()))).collect()
    }
}

/// What is to be said of a name that was not entered.
fn said_of(refused: RefusedName, noun: Noun, name: &str, span: Span) -> Option<Diagnostic> {
    match refused {
        RefusedName::Taken(first) => Some(duplicate(noun, name, span, Some(first))),
        RefusedName::Full { first: true } => {
            let message = format!("there are more than {MAX_NAMES} {}", noun.plural());
            Some(too_many(message, span))
        }
        RefusedName::Full { first: false } => None,
    }
}

/// HR0005: more than can be looked at.
pub(crate) fn too_many(message: String, span: Span) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::TOO_DEEP, span, message)
        .help("divide it into several scenarios, or say less")
}
