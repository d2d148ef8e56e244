//! Text to AST: lexes, splits into declarations, reads each, and hands the broken ones to recovery.

use hrdsl_source::{Diagnostic, DiagnosticCode, FileId, Span};

use crate::ast::{FileSyntax, ItemSyntax, ItemSyntaxKind};
use crate::context::{ParseContext, ParsedUnit};
use crate::lex::{LexedFile, lex};
use crate::outline::{ChunkKind, DeclarationChunk, FileOutline, outline};
use crate::recover::RecoveringParser;
use crate::run::run;
use crate::token::{Lexeme, TokenKind};
use crate::{expected::ParseFault, report::report};

/// The largest file that is read.
pub const MAX_BYTES: usize = 64 << 20;

/// Reads a file. Whatever the text, the result is a tree; where the text does not fit, there is a diagnostic, in the
/// order of the text.
#[must_use]
pub fn parse(file: FileId, text: &str) -> (FileSyntax, Vec<Diagnostic>) {
    let (tree, _, diagnostics) = read(file, text);
    (tree, diagnostics)
}

/// The tree, the tokens as they were written, the diagnostics.
pub(crate) fn read(file: FileId, text: &str) -> (FileSyntax, Vec<Lexeme>, Vec<Diagnostic>) {
    if text.len() > MAX_BYTES {
        let message = format!("the file is larger than {} MiB", MAX_BYTES >> 20);
        let diagnostic = Diagnostic::error(DiagnosticCode::TOO_DEEP, Span::new(file, 0, 0), message)
            .help("divide it into several files");
        return (FileSyntax::default(), Vec::new(), vec![diagnostic]);
    }
    let LexedFile { tokens: written, docs, mut diagnostics } = lex(file, text);
    let FileOutline { tokens, chunks } = outline(file, text, &written, &mut diagnostics);
    let mut cx = ParseContext { file, text, docs: &docs, diagnostics };
    let mut result = FileSyntax { scenario: None, items: Vec::with_capacity(chunks.len()) };
    for chunk in chunks {
        declaration(&mut cx, &tokens, chunk, &mut result);
    }
    cx.diagnostics.sort_by_key(|d| (d.span().start, d.span().end));
    (result, written, cx.diagnostics)
}

fn declaration(
    cx: &mut ParseContext<'_>,
    tokens: &[Lexeme],
    chunk: DeclarationChunk,
    result: &mut FileSyntax,
) {
    let run = &tokens[chunk.start..chunk.end];
    let (Some(first), Some(last)) = (run.first(), run.last()) else { return };
    if first.kind == TokenKind::Scenario && chunk.sort == ChunkKind::Item {
        return scenario(cx, tokens, chunk, result);
    }
    let said = cx.diagnostics.len();
    let kind = match chunk.sort {
        ChunkKind::Item => item(cx, tokens, chunk),
        ChunkKind::Unread => ItemSyntaxKind::Error,
    };
    let span = cx.span(first.start, last.end);
    // What was kept of a broken declaration without a block may have swallowed the next one.
    let swallowed = cx.diagnostics.len() > said && !first.kind.has_block() && kind != ItemSyntaxKind::Error;
    result.items.push(ItemSyntax { doc: cx.doc(first.start), kind, span });
    if swallowed {
        result.items.push(ItemSyntax { doc: String::new(), kind: ItemSyntaxKind::Error, span });
    }
}

fn item(cx: &mut ParseContext<'_>, tokens: &[Lexeme], chunk: DeclarationChunk) -> ItemSyntaxKind {
    match run(cx, None, &tokens[chunk.start..chunk.end]) {
        Ok(ParsedUnit::Item(kind)) => kind,
        Ok(_) => ItemSyntaxKind::Error,
        Err(fault) => RecoveringParser { cx, tokens }.item(chunk.start..chunk.end, &fault),
    }
}

/// `scenario name`: the first line, once.
fn scenario(cx: &mut ParseContext<'_>, tokens: &[Lexeme], chunk: DeclarationChunk, result: &mut FileSyntax) {
    let run = &tokens[chunk.start..chunk.end];
    let name = run.get(1).filter(|t| t.kind.can_be_name());
    if name.is_none() || run.len() > 2 {
        let expected = if name.is_some() { "END" } else { "IDENT" };
        let fault = ParseFault {
            of: "declaration",
            within: None,
            at: if name.is_some() { 2 } else { 1 },
            expected: vec![expected.to_owned()],
        };
        report(cx, &fault, run, tokens.get(chunk.end).copied());
    }
    let Some(name) = name else { return };
    if result.scenario.is_some() || !result.items.is_empty() {
        let span = cx.span_of(run[0]);
        cx.diagnostics.push(
            Diagnostic::error(DiagnosticCode::SYNTAX, span, "`scenario` comes first, and once")
                .help("begin the file with this line, or take it away"),
        );
    }
    let name = cx.name(*name);
    result.scenario.get_or_insert(name);
}
