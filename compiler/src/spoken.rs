//! Whether a declaration that nothing uses can go for certain: not if something still speaks its name, such as a template
//! of which there is no instance.

use std::{collections::BTreeMap, sync::Arc};

use hrdsl_source::{Diagnostic, DiagnosticCode, FileId, SourceFiles, Span};
use hrdsl_syntax::{
    ast::{FileSyntax, ItemSyntax, ItemSyntaxKind},
    words,
};
use indexmap::IndexMap;

/// How often each of some words stands in the files. An automaton's own names mean nothing in another one: so they are counted in each
/// automaton, and in what is none.
struct WordFrequencies<'f> {
    /// By word, then by automaton of the first file; `None`: elsewhere.
    counts: IndexMap<&'f str, BTreeMap<Option<usize>, usize>>,
    automata: Vec<Span>,
}

/// Fixes that take a declaration away stay certain only if its name stands nowhere else.
pub(crate) fn doubt(files: &SourceFiles, ast: &[Arc<FileSyntax>], diagnostics: &mut [Diagnostic]) {
    let is_sure = |d: &&Diagnostic| d.code == DiagnosticCode::UNUSED && d.fixes.iter().any(|f| f.certain);
    let names: Vec<&str> = diagnostics.iter().filter(is_sure).map(|d| files.text(d.span())).collect();
    if names.is_empty() {
        return;
    }
    let spoken = WordFrequencies::of(files, ast, &names);
    for diagnostic in diagnostics.iter_mut().filter(|d| is_sure(&&**d)) {
        let at = diagnostic.span();
        let name = files.text(at);
        for fix in diagnostic.fixes.iter_mut().filter(|f| f.certain) {
            fix.certain = fix.edits.iter().all(|e| !spoken.elsewhere(files, name, e.span));
        }
    }
}

impl<'f> WordFrequencies<'f> {
    fn of(files: &'f SourceFiles, ast: &[Arc<FileSyntax>], names: &[&'f str]) -> Self {
        let is_automaton = |i: &&ItemSyntax| matches!(i.kind, ItemSyntaxKind::Automaton(_));
        let automata = ast[0].items.iter().filter(is_automaton).map(|i| i.span).collect();
        let counts = names.iter().map(|name| (*name, BTreeMap::new())).collect();
        let mut spoken = Self { counts, automata };
        // The library's devices name nothing of a scenario.
        for (id, file) in files.iter().filter(|(_, file)| file.name != hrdsl_stdlib::DEVICES) {
            for word in words(&file.text) {
                let Some(at) = spoken.counts.get_index_of(&file.text[word.clone()]) else { continue };
                let place = spoken.automaton(Span::new(id, word.start, word.end));
                *spoken.counts[at].entry(place).or_default() += 1;
            }
        }
        spoken
    }

    /// The automaton of the first file in which a span is, but for the whole of one.
    fn automaton(&self, span: Span) -> Option<usize> {
        let last = self.automata.partition_point(|s| s.start <= span.start).checked_sub(1)?;
        let whole = self.automata[last];
        (span.file == FileId(0) && span.end <= whole.end && span != whole).then_some(last)
    }

    /// Whether a name stands where it may mean what this span declares, other than in the span itself.
    fn elsewhere(&self, files: &SourceFiles, name: &str, whole: Span) -> bool {
        let text = files.text(whole);
        let own = words(text).filter(|word| &text[word.clone()] == name).count();
        let counts = self.counts.get(name);
        let within = |place| counts.and_then(|counts| counts.get(&place)).copied().unwrap_or(0);
        let all = match self.automaton(whole) {
            Some(automaton) => within(Some(automaton)) + within(None),
            None => counts.map_or(0, |counts| counts.values().sum()),
        };
        all > own
    }
}
