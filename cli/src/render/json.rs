//! `--format json`: one document, whose schema is in `spec/cli.md`.

use hrdsl_compiler::pages;
use hrdsl_source::{Diagnostic, Severity, SourceFiles, Span, TextEdit};
use serde::Serialize;

use crate::{
    fault::CommandFault,
    project::{CheckedProject, CheckedUnit, SourceKind},
};

#[derive(Serialize)]
struct DiagnosticsDocument<'a> {
    format: &'static str,
    version: u32,
    files: Vec<JsonFile<'a>>,
    diagnostics: Vec<JsonDiagnostic<'a>>,
    summary: FindingCounts,
}

#[derive(Serialize)]
struct JsonFile<'a> {
    path: &'a str,
    kind: SourceKind,
    /// The scenario or module that it was compiled with.
    with: &'a str,
}

#[derive(Serialize)]
struct JsonDiagnostic<'a> {
    code: String,
    title: &'static str,
    severity: Severity,
    message: &'a str,
    labels: Vec<JsonLabel<'a>>,
    help: Option<&'a str>,
    fixes: Vec<JsonFix<'a>>,
    page: String,
}

#[derive(Serialize)]
struct JsonLabel<'a> {
    primary: bool,
    text: &'a str,
    #[serde(flatten)]
    place: JsonPlace<'a>,
}

#[derive(Serialize)]
struct JsonPlace<'a> {
    file: &'a str,
    start: JsonPoint,
    end: JsonPoint,
}

#[derive(Serialize)]
struct JsonPoint {
    line: u32,
    column: u32,
    byte: u32,
}

#[derive(Serialize)]
struct JsonFix<'a> {
    title: &'a str,
    certain: bool,
    edits: Vec<JsonEdit<'a>>,
}

#[derive(Serialize)]
struct JsonEdit<'a> {
    #[serde(flatten)]
    place: JsonPlace<'a>,
    text: &'a str,
}

#[derive(Serialize)]
struct FindingCounts {
    errors: usize,
    warnings: usize,
}

/// The document of a whole check.
///
/// # Errors
/// None that is known: the document holds nothing that JSON cannot say.
pub fn document(project: &CheckedProject, checked: &[CheckedUnit]) -> Result<String, CommandFault> {
    let file = |i: usize, head: usize| {
        let source = &project.sources[i];
        JsonFile { path: &source.name, kind: source.kind, with: &project.sources[head].name }
    };
    let of_unit = |c: &CheckedUnit| {
        let head = c.unit.head;
        let all = std::iter::once(head).chain(c.unit.tests.clone()).chain(c.unit.systems.clone());
        all.map(move |i| (i, head))
    };
    let files = checked.iter().flat_map(of_unit).map(|(i, head)| file(i, head));
    let said =
        || checked.iter().flat_map(|c| c.compilation.diagnostics.iter().map(|d| (&c.compilation.files, d)));
    let errors = said().filter(|(_, d)| d.is_error()).count();
    let document = DiagnosticsDocument {
        format: "hrdsl-check",
        version: 1,
        files: files.collect(),
        diagnostics: said().map(|(files, d)| shown(files, d)).collect(),
        summary: FindingCounts { errors, warnings: said().count() - errors },
    };
    crate::files::json(&document)
}

fn shown<'a>(files: &'a SourceFiles, diagnostic: &'a Diagnostic) -> JsonDiagnostic<'a> {
    let label = |(i, label): (usize, &'a hrdsl_source::SpanLabel)| JsonLabel {
        primary: i == 0,
        text: &label.text,
        place: place(files, label.span),
    };
    let edit = |edit: &'a TextEdit| JsonEdit { place: place(files, edit.span), text: &edit.text };
    let fix = |fix: &'a hrdsl_source::SuggestedFix| JsonFix {
        title: &fix.title,
        certain: fix.certain,
        edits: fix.edits.iter().map(edit).collect(),
    };
    JsonDiagnostic {
        code: diagnostic.code.to_string(),
        title: diagnostic.code.info().map_or("", |i| i.title),
        severity: diagnostic.severity,
        message: &diagnostic.message,
        labels: diagnostic.labels.iter().enumerate().map(label).collect(),
        help: diagnostic.help.as_deref(),
        fixes: diagnostic.fixes.iter().map(fix).collect(),
        page: pages::path(diagnostic.code),
    }
}

fn place(files: &SourceFiles, span: Span) -> JsonPlace<'_> {
    let file = files.get(span.file);
    let point = |byte: u32| {
        let (line, column) = file.map_or((1, 1), |f| {
            let position = f.position(byte);
            (position.line, position.column)
        });
        JsonPoint { line, column, byte }
    };
    JsonPlace { file: files.name(span.file), start: point(span.start), end: point(span.end) }
}
