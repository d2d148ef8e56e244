//! Whether a declaration that nothing uses can go for certain: not if something still speaks its name, such as a template
//! of which there is no instance.

use std::collections::BTreeMap;

use hrdsl_source::{Diagnostic, DiagnosticCode, FileId, SourceFiles, Span};
use hrdsl_syntax::{
    ast::{FileSyntax, ItemSyntax, ItemSyntaxKind},
    words,
};

/// How often each word stands in the files. An automaton's own names mean nothing in another one: words are also counted in
/// each automaton, and in what is none.
struct WordFrequencies<'f> {
    all: BTreeMap<&'f str, usize>,
    /// By automaton of the first file; `None`: elsewhere.
    within: BTreeMap<(Option<usize>, &'f str), usize>,
    automata: Vec<Span>,
}

/// Fixes that take a declaration away stay certain only if its name stands nowhere else.
pub(crate) fn doubt(files: &SourceFiles, ast: &[FileSyntax], diagnostics: &mut [Diagnostic]) {
    let is_sure = |d: &&mut Diagnostic| d.code == DiagnosticCode::UNUSED && d.fixes.iter().any(|f| f.certain);
    let mut unused = diagnostics.iter_mut().filter(is_sure).peekable();
    if unused.peek().is_none() {
        return;
    }
    let spoken = WordFrequencies::of(files, ast);
    for diagnostic in unused {
        let at = diagnostic.span();
        let name = files.text(at);
        for fix in diagnostic.fixes.iter_mut().filter(|f| f.certain) {
            fix.certain = fix.edits.iter().all(|e| !spoken.elsewhere(files, name, e.span));
        }
    }
}

impl<'f> WordFrequencies<'f> {
    fn of(files: &'f SourceFiles, ast: &[FileSyntax]) -> Self {
        let is_automaton = |i: &&ItemSyntax| matches!(i.kind, ItemSyntaxKind::Automaton(_));
        let automata = ast[0].items.iter().filter(is_automaton).map(|i| i.span).collect();
        let mut spoken = Self { all: BTreeMap::new(), within: BTreeMap::new(), automata };
        // The library's devices name nothing of a scenario.
        for (id, file) in files.iter().filter(|(_, file)| file.name != hrdsl_stdlib::DEVICES) {
            for word in words(&file.text) {
                let text = &file.text[word.clone()];
                *spoken.all.entry(text).or_default() += 1;
                let place = spoken.automaton(Span::new(id, word.start, word.end));
                *spoken.within.entry((place, text)).or_default() += 1;
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
        let within = |place| self.within.get(&(place, name)).copied().unwrap_or(0);
        let all = match self.automaton(whole) {
            Some(automaton) => within(Some(automaton)) + within(None),
            None => self.all.get(name).copied().unwrap_or(0),
        };
        all > own
    }
}
