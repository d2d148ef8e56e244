//! Text to AST: lexes, splits into declarations, reads each, and hands the broken ones to recovery.

use std::cell::Cell;

use hrdsl_source::{Code, Diagnostic, FileId, Span};
use lalrpop_util::ParseError;

use crate::ast::{File, Item, ItemKind};
use crate::context::{Context, Unit};
use crate::grammar::UnitParser;
use crate::lex::{Lexed, lex};
use crate::outline::{Chunk, Outline, Sort, outline};
use crate::recover::Recovery;
use crate::report::{Fault, report};
use crate::token::{Kind, Lexeme};

/// The largest file that is read.
pub const MAX_BYTES: usize = 64 << 20;

/// Reads a file. Whatever the text, the result is a tree; where the text does not fit, there is a diagnostic, in the
/// order of the text.
#[must_use]
pub fn parse(file: FileId, text: &str) -> (File, Vec<Diagnostic>) {
    let (tree, _, diagnostics) = read(file, text);
    (tree, diagnostics)
}

/// The tree, the tokens as they were written, the diagnostics.
pub(crate) fn read(file: FileId, text: &str) -> (File, Vec<Lexeme>, Vec<Diagnostic>) {
    if text.len() > MAX_BYTES {
        let message = format!("the file is larger than {} MiB", MAX_BYTES >> 20);
        let diagnostic = Diagnostic::error(Code::TOO_DEEP, Span::new(file, 0, 0), message)
            .help("divide it into several files");
        return (File::default(), Vec::new(), vec![diagnostic]);
    }
    let Lexed { tokens: written, docs, mut diagnostics } = lex(file, text);
    let Outline { tokens, chunks } = outline(file, text, &written, &mut diagnostics);
    let mut cx = Context { file, text, docs: &docs, diagnostics };
    let mut result = File { scenario: None, items: Vec::with_capacity(chunks.len()) };
    for chunk in chunks {
        declaration(&mut cx, &tokens, chunk, &mut result);
    }
    cx.diagnostics.sort_by_key(|d| (d.span().start, d.span().end));
    (result, written, cx.diagnostics)
}

fn declaration(cx: &mut Context<'_>, tokens: &[Lexeme], chunk: Chunk, result: &mut File) {
    let run = &tokens[chunk.start..chunk.end];
    let (Some(first), Some(last)) = (run.first(), run.last()) else { return };
    if first.kind == Kind::Scenario && chunk.sort == Sort::Item {
        return scenario(cx, tokens, chunk, result);
    }
    let said = cx.diagnostics.len();
    let kind = match chunk.sort {
        Sort::Item => item(cx, tokens, chunk),
        Sort::Unread => ItemKind::Error,
    };
    let span = cx.span(first.start, last.end);
    // What was kept of a broken declaration without a block may have swallowed the next one.
    let swallowed = cx.diagnostics.len() > said && !first.kind.has_block() && kind != ItemKind::Error;
    result.items.push(Item { doc: cx.doc(first.start), kind, span });
    if swallowed {
        result.items.push(Item { doc: String::new(), kind: ItemKind::Error, span });
    }
}

fn item(cx: &mut Context<'_>, tokens: &[Lexeme], chunk: Chunk) -> ItemKind {
    match run(cx, None, &tokens[chunk.start..chunk.end]) {
        Ok(Unit::Item(kind)) => kind,
        Ok(_) => ItemKind::Error,
        Err(fault) => Recovery { cx, tokens }.item(chunk.start..chunk.end, &fault),
    }
}

/// `scenario name`: the first line, once.
fn scenario(cx: &mut Context<'_>, tokens: &[Lexeme], chunk: Chunk, result: &mut File) {
    let run = &tokens[chunk.start..chunk.end];
    let name = run.get(1).filter(|t| t.kind.can_be_name());
    if name.is_none() || run.len() > 2 {
        let expected = if name.is_some() { "END" } else { "IDENT" };
        let fault = Fault {
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
            Diagnostic::error(Code::SYNTAX, span, "`scenario` comes first, and once")
                .help("begin the file with this line, or take it away"),
        );
    }
    let name = cx.name(*name);
    result.scenario.get_or_insert(name);
}

/// Reads one run of tokens as what `start` says: `None` a declaration. Of a run that does not fit, no diagnostics stay.
pub(crate) fn run(cx: &mut Context<'_>, start: Option<Kind>, tokens: &[Lexeme]) -> Result<Unit, Fault> {
    let said = cx.diagnostics.len();
    let fault = match attempt(cx, start, tokens) {
        Ok(unit) => return Ok(unit),
        Err(fault) => fault,
    };
    let fault = forgotten(cx, start, tokens, &fault).unwrap_or(fault);
    cx.diagnostics.truncate(said);
    Err(fault)
}

/// In `stimulus by cook` the keyword was taken for the name that is missing before it: it is still expected after itself.
fn forgotten(cx: &mut Context<'_>, start: Option<Kind>, tokens: &[Lexeme], fault: &Fault) -> Option<Fault> {
    let at = fault.at.checked_sub(1)?;
    let word = tokens.get(at).filter(|t| t.kind.class().is_some())?;
    if !fault.has(cx.text_of(*word)) {
        return None;
    }
    let mut named = tokens[..=fault.at.min(tokens.len() - 1)].to_vec();
    named[at].kind = Kind::Ident;
    let same = attempt(cx, start, &named).err()?;
    let before = attempt(cx, start, &tokens[..at]).err()?;
    let name = same.at == fault.at && same.expected == fault.expected;
    (name && before.at == at && before.has("IDENT")).then_some(before)
}

fn attempt(cx: &mut Context<'_>, start: Option<Kind>, tokens: &[Lexeme]) -> Result<Unit, Fault> {
    let (from, to) = (tokens.first().map_or(0, |t| t.start), tokens.last().map_or(0, |t| t.end));
    let taken = Cell::new(0_usize);
    let stream = start
        .map(|kind| Lexeme::synthetic(kind, from))
        .into_iter()
        .chain(tokens.iter().copied())
        .chain(std::iter::once(Lexeme::synthetic(Kind::End, to)))
        .map(|t| {
            taken.set(taken.get() + 1);
            (t.start, t, t.end)
        });
    let error = match UnitParser::new().parse(cx, stream) {
        Ok(unit) => return Ok(*unit),
        Err(error) => error,
    };
    // The token that does not fit is the last that was taken.
    let at = taken.get().saturating_sub(1 + usize::from(start.is_some()));
    let expected = match error {
        ParseError::UnrecognizedToken { expected, .. } | ParseError::UnrecognizedEof { expected, .. } => {
            expected
        }
        ParseError::InvalidToken { .. } | ParseError::ExtraToken { .. } => Vec::new(),
        ParseError::User { error } => match error {},
    };
    let of = match start {
        None => "declaration",
        Some(Kind::StartStep | Kind::StartStimulusStep) => "step",
        Some(Kind::StartStatement) => "statement",
        Some(_) => "member",
    };
    Err(Fault { of, within: start.or_else(|| tokens.first().map(|t| t.kind)), at, expected })
}
