//! HR0803: files that a scenario names, and that are not there.

use std::sync::Arc;

use hrdsl_source::{Diagnostic, DiagnosticCode};
use hrdsl_syntax::ast::{FileSyntax, ItemSyntaxKind, SystemMemberKind as Member, TextSyntax};

use crate::{ModuleLoader, is_file_pattern};

/// The files whose coverage is to be measured, and that are no files beside the scenario.
pub(crate) fn missing(files: &[Arc<FileSyntax>], loader: &dyn ModuleLoader) -> Vec<Diagnostic> {
    let systems = files
        .iter()
        .flat_map(|file| &file.items)
        .filter_map(|i| if let ItemSyntaxKind::System(s) = &i.kind { Some(s) } else { None });
    let members = systems.flat_map(|s| &s.members);
    let named = members.flat_map(|member| {
        let inner =
            if let Member::Program(program) = &member.kind { program.members.as_slice() } else { &[] };
        covered(&member.kind).into_iter().chain(inner.iter().filter_map(|m| covered(&m.kind)))
    });
    let missing = named.flatten().filter(|f| loader.means_a_file(&f.text) == Some(false));
    missing
        .map(|f| {
            let is = if is_file_pattern(&f.text) { "that matches " } else { "" };
            let message = format!("there is no file {is}`{}`, so no coverage is measured of it", f.text);
            Diagnostic::warning(DiagnosticCode::NO_SUCH_FILE, f.span, message)
                .help("name a file of the program, or several by a pattern (`*.py`, `src/**/*.py`), from the scenario's folder")
        })
        .collect()
}

fn covered(kind: &Member) -> Option<&Vec<TextSyntax>> {
    if let Member::Coverage(files) = kind { Some(files) } else { None }
}
