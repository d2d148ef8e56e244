//! `--format json`: one document, whose schema is in `spec/cli.md`.

use hrdsl_compiler::pages;
use hrdsl_source::{Diagnostic, Edit, Files, Severity, Span};
use serde::Serialize;

use crate::{
    fault::Fault,
    project::{Checked, Kind, Project},
};

#[derive(Serialize)]
struct Document<'a> {
    format: &'static str,
    version: u32,
    files: Vec<File<'a>>,
    diagnostics: Vec<Shown<'a>>,
    summary: Summary,
}

#[derive(Serialize)]
struct File<'a> {
    path: &'a str,
    kind: Kind,
    /// The scenario or module that it was compiled with.
    with: &'a str,
}

#[derive(Serialize)]
struct Shown<'a> {
    code: String,
    title: &'static str,
    severity: Severity,
    message: &'a str,
    labels: Vec<Label<'a>>,
    help: Option<&'a str>,
    fixes: Vec<Fix<'a>>,
    page: String,
}

#[derive(Serialize)]
struct Label<'a> {
    primary: bool,
    text: &'a str,
    #[serde(flatten)]
    place: Place<'a>,
}

#[derive(Serialize)]
struct Place<'a> {
    file: &'a str,
    start: Point,
    end: Point,
}

#[derive(Serialize)]
struct Point {
    line: u32,
    column: u32,
    byte: u32,
}

#[derive(Serialize)]
struct Fix<'a> {
    title: &'a str,
    certain: bool,
    edits: Vec<Change<'a>>,
}

#[derive(Serialize)]
struct Change<'a> {
    #[serde(flatten)]
    place: Place<'a>,
    text: &'a str,
}

#[derive(Serialize)]
struct Summary {
    errors: usize,
    warnings: usize,
}

/// The document of a whole check.
///
/// # Errors
/// None that is known: the document holds nothing that JSON cannot say.
pub fn document(project: &Project, checked: &[Checked]) -> Result<String, Fault> {
    let file = |i: usize, head: usize| {
        let source = &project.sources[i];
        File { path: &source.name, kind: source.kind, with: &project.sources[head].name }
    };
    let files = checked
        .iter()
        .flat_map(|c| std::iter::once(c.unit.head).chain(c.unit.tests.clone()).map(|i| file(i, c.unit.head)));
    let said =
        || checked.iter().flat_map(|c| c.compilation.diagnostics.iter().map(|d| (&c.compilation.files, d)));
    let errors = said().filter(|(_, d)| d.is_error()).count();
    let document = Document {
        format: "hrdsl-check",
        version: 1,
        files: files.collect(),
        diagnostics: said().map(|(files, d)| shown(files, d)).collect(),
        summary: Summary { errors, warnings: said().count() - errors },
    };
    crate::files::json(&document)
}

fn shown<'a>(files: &'a Files, diagnostic: &'a Diagnostic) -> Shown<'a> {
    let label = |(i, label): (usize, &'a hrdsl_source::Label)| Label {
        primary: i == 0,
        text: &label.text,
        place: place(files, label.span),
    };
    let edit = |edit: &'a Edit| Change { place: place(files, edit.span), text: &edit.text };
    let fix = |fix: &'a hrdsl_source::Fix| Fix {
        title: &fix.title,
        certain: fix.certain,
        edits: fix.edits.iter().map(edit).collect(),
    };
    Shown {
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

fn place(files: &Files, span: Span) -> Place<'_> {
    let file = files.get(span.file);
    let point = |byte: u32| {
        let (line, column) = file.map_or((1, 1), |f| {
            let position = f.position(byte);
            (position.line, position.column)
        });
        Point { line, column, byte }
    };
    Place { file: file.map_or("?", |f| &f.name), start: point(span.start), end: point(span.end) }
}
