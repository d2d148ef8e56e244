//! What the edges of automata are written as: where, and with which guard.

use std::collections::BTreeMap;

use hrdsl_compiler::{
    CompilationResult,
    ast::{AutomatonMemberKind, ItemSyntaxKind},
};
use hrdsl_runtime::prove::EdgeSource;
use hrdsl_source::{SourceFiles, Span, printable_line};

/// The edges of a scenario by their places.
pub struct EdgeSources<'c> {
    files: &'c SourceFiles,
    /// The guard of each edge that has one.
    guards: BTreeMap<Span, Option<Span>>,
}

impl<'c> EdgeSources<'c> {
    pub fn of(compilation: &'c CompilationResult) -> Self {
        let mut guards = BTreeMap::new();
        for item in compilation.ast.iter().flat_map(|file| &file.items) {
            let ItemSyntaxKind::Automaton(automaton) = &item.kind else { continue };
            for member in &automaton.members {
                if let AutomatonMemberKind::Edge(edge) = &member.kind {
                    guards.insert(member.span, edge.guard.as_ref().map(|g| g.span));
                }
            }
        }
        Self { files: &compilation.files, guards }
    }

    /// The edge at a place; `None`: no edge is written there, since an observer or the compiler made it.
    pub fn at(&self, origin: Span) -> Option<EdgeSource> {
        let guard = *self.guards.get(&origin)?;
        Some(EdgeSource {
            file: printable_line(self.files.name(origin.file)).into_owned(),
            line: self.files.position(origin).line,
            guard: guard.map(|span| one_line(self.files.text(span))),
        })
    }
}

/// A condition without its line breaks and comments.
fn one_line(text: &str) -> String {
    let code = text.lines().map(|line| line.split("//").next().unwrap_or(line));
    code.flat_map(str::split_whitespace).collect::<Vec<_>>().join(" ")
}
