//! One declaration, whose text has changed, checked again alone: what an editor asks at every key.

use hrdsl_model::{DefinedType, KnownSources, Resolutions};
use hrdsl_source::{Diagnostic, DiagnosticCode, FileId, Span};
use hrdsl_syntax::ast::{self, ItemSyntaxKind};

use crate::CompilationResult;

/// What is to be said of a declaration with other text.
#[derive(Clone, Debug)]
pub struct RecheckResult {
    /// Errors, and warnings that need no look at the whole scenario. Places are those in the first file with the new text in
    /// place of the old.
    pub diagnostics: Vec<Diagnostic>,
    /// Whether it declares what it declared before. If it does not, the rest of the scenario is to be checked as well.
    pub same_names: bool,
}

/// Checks a declaration of the first file again: the one that holds the byte `at`, as if `text` stood in its place. `None`: no
/// declaration is there, or the text is not one; or it is a `use` or an `allow`, which speak of others.
///
/// Everything else is as it was compiled; of the other declarations no more is looked at than their names.
#[must_use]
pub fn recheck(compilation: &CompilationResult, at: usize, text: &str) -> Option<RecheckResult> {
    let scenario = compilation.ast.first()?;
    let index = scenario.items.iter().position(|item| item.span.range().contains(&at))?;
    let old = &scenario.items[index];
    let file = FileId(u16::try_from(compilation.files.iter().count()).unwrap_or(u16::MAX));
    let (read, mut diagnostics) = hrdsl_syntax::parse(file, text);
    let [item] = read.items.as_slice() else { return None };
    if read.scenario.is_some() || [old, item].iter().any(|i| is_of_the_whole(&i.kind)) {
        return None;
    }
    let modules: Vec<&ast::FileSyntax> =
        compilation.modules.iter().filter_map(|m| Some(&**compilation.ast.get(*m)?)).collect();
    let missing = compilation.diagnostics.iter().any(|d| d.code == DiagnosticCode::UNKNOWN_MODULE);
    let known = KnownSources {
        missing_modules: missing,
        interfaces: &compilation.interfaces,
        descriptions: Some(&compilation.descriptions),
    };
    diagnostics.extend(hrdsl_model::resolve_alone(scenario, (index, item), &modules, known));
    let before = declares(old, &|span| compilation.files.text(span).to_owned());
    let same_names = before == declares(item, &|span| text.get(span.range()).unwrap_or("").to_owned());
    let moved = SpanShift { alone: file, old: old.span, len: text.len() };
    diagnostics.iter_mut().for_each(|d| moved.diagnostic(d));
    diagnostics.sort_by_key(|d| (d.span(), d.code));
    Some(RecheckResult { diagnostics, same_names })
}

fn is_of_the_whole(kind: &ItemSyntaxKind) -> bool {
    matches!(kind, ItemSyntaxKind::Use(_) | ItemSyntaxKind::Allow(_))
}

/// What the rest of a scenario sees of a declaration. Of some all is seen: the value of a constant, the parts of the world.
fn declares(item: &ast::ItemSyntax, written: &dyn Fn(Span) -> String) -> Vec<(&'static str, String, String)> {
    let whole = if item.kind.rules().is_seen_by_name { String::new() } else { written(item.span) };
    let names = Resolutions::of_declaration(item);
    let ty = |ty: &DefinedType| match ty {
        DefinedType::None => String::new(),
        DefinedType::Written(span) => written(*span),
        DefinedType::Inferred(ty) => ty.clone(),
    };
    let names = names.definitions().map(|d| (d.noun, d.name.clone(), ty(&d.ty)));
    names.chain([("", whole, String::new())]).collect()
}

/// How places change when the text of a declaration does.
struct SpanShift {
    /// The file that held the new text alone.
    alone: FileId,
    old: Span,
    /// Of the new text, in bytes.
    len: usize,
}

impl SpanShift {
    fn diagnostic(&self, of: &mut Diagnostic) {
        of.labels.iter_mut().for_each(|label| label.span = self.span(label.span));
        let edits = of.fixes.iter_mut().flat_map(|fix| &mut fix.edits);
        edits.for_each(|edit| edit.span = self.span(edit.span));
    }

    fn span(&self, span: Span) -> Span {
        let start = self.old.start as usize;
        let at = |n: u32| match span.file {
            file if file == self.alone => start + n as usize,
            FileId(0) if n >= self.old.end => n as usize - self.old.range().len() + self.len,
            _ => n as usize,
        };
        let file = if span.file == self.alone { FileId(0) } else { span.file };
        Span::new(file, at(span.start), at(span.end))
    }
}
