//! Fixing texts by the certain fixes of their diagnostics.

use std::collections::BTreeMap;

use hrdsl_compiler::CompilationResult;
use hrdsl_source::SuggestedFix;

use crate::project::CheckedProject;

/// A fix that was applied.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AppliedFix {
    /// `file:line:column`, in the text that it was applied to.
    pub place: String,
    pub title: String,
}

/// A fix brings new things to light; a text that is not at rest after so many rounds is left as it is then.
const ROUNDS: usize = 10;

/// An edit of a source of the project.
#[derive(Clone, Debug)]
struct SourceEdit {
    source: usize,
    start: usize,
    end: usize,
    text: String,
}

/// Applies what is certain to the texts in memory, until nothing more is.
pub fn apply(project: &mut CheckedProject) -> Vec<AppliedFix> {
    let mut applied = Vec::new();
    for _ in 0..ROUNDS {
        let mut chosen = ChosenEdits::default();
        for unit in &project.units {
            let compilation = project.compile(unit);
            for diagnostic in &compilation.diagnostics {
                let Some(fix) = diagnostic.fixes.iter().find(|f| f.certain) else { continue };
                let Some(changes) = changes(project, &compilation, fix) else { continue };
                if chosen.take(changes) {
                    let place = compilation.files.place(fix.edits[0].span);
                    applied.push(AppliedFix { place, title: fix.title.clone() });
                }
            }
        }
        if chosen.changes.is_empty() {
            break;
        }
        chosen.apply(project);
    }
    applied
}

/// A fix's edits as changes of the project's sources; none if one of them lies elsewhere.
fn changes(
    project: &CheckedProject,
    compilation: &CompilationResult,
    fix: &SuggestedFix,
) -> Option<Vec<SourceEdit>> {
    let change = |edit: &hrdsl_source::TextEdit| {
        let source = project.source(compilation, edit.span.file)?;
        let range = edit.span.range();
        project.sources[source].text().get(range.clone())?;
        Some(SourceEdit { source, start: range.start, end: range.end, text: edit.text.clone() })
    };
    let changes: Option<Vec<SourceEdit>> = fix.edits.iter().map(change).collect();
    changes.filter(|c| !c.is_empty())
}

/// Changes that do not overlap, by source and start.
#[derive(Debug, Default)]
struct ChosenEdits {
    changes: BTreeMap<(usize, usize), SourceEdit>,
}

impl ChosenEdits {
    /// Takes all changes of a fix, or none if one of them overlaps one that was taken.
    fn take(&mut self, changes: Vec<SourceEdit>) -> bool {
        let free = changes.iter().all(|c| self.is_free(c));
        if free {
            self.changes.extend(changes.into_iter().map(|c| ((c.source, c.start), c)));
        }
        free
    }

    fn is_free(&self, change: &SourceEdit) -> bool {
        let key = (change.source, change.start);
        let before = self.changes.range(..=key).next_back().map(|(_, c)| c);
        let after = self.changes.range(key..).next().map(|(_, c)| c);
        let clashes = |other: &SourceEdit| {
            other.source == change.source
                && (other.start == change.start || (other.start < change.end && change.start < other.end))
        };
        !before.into_iter().chain(after).any(clashes)
    }

    fn apply(self, project: &mut CheckedProject) {
        let mut texts: BTreeMap<usize, String> = BTreeMap::new();
        // From the back, so that the places of the others stay.
        for ((source, _), change) in self.changes.into_iter().rev() {
            let text = texts.entry(source).or_insert_with(|| project.sources[source].text().to_owned());
            text.replace_range(change.start..change.end, &change.text);
        }
        for (source, text) in texts {
            project.sources[source].rewrite(text);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn change(start: usize, end: usize) -> SourceEdit {
        SourceEdit { source: 0, start, end, text: "x".to_owned() }
    }

    #[test]
    fn what_overlaps_is_left_for_the_next_round() {
        let mut chosen = ChosenEdits::default();
        assert!(chosen.take(vec![change(4, 6), change(10, 10)]));
        assert!(!chosen.take(vec![change(5, 7)]) && !chosen.take(vec![change(0, 5)]));
        assert!(!chosen.take(vec![change(3, 8)]) && !chosen.take(vec![change(10, 11)]));
        assert!(!chosen.take(vec![change(0, 1), change(9, 11)]), "all or none");
        assert!(
            chosen.take(vec![change(6, 7)])
                && chosen.take(vec![change(0, 1)])
                && chosen.take(vec![change(2, 4)])
        );
        assert_eq!(chosen.changes.len(), 5);
    }
}
