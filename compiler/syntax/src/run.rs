//! One run of tokens by the grammar: a node, or the place that does not fit.

use std::cell::Cell;

use lalrpop_util::ParseError;

use crate::context::{ParseContext, ParsedUnit};
use crate::expected::ParseFault;
use crate::grammar::UnitParser;
use crate::token::{Lexeme, TokenKind};

/// Reads one run of tokens as what `start` says: `None` a declaration. Of a run that does not fit, no diagnostics stay.
pub(crate) fn run(
    cx: &mut ParseContext<'_>,
    start: Option<TokenKind>,
    tokens: &[Lexeme],
) -> Result<ParsedUnit, ParseFault> {
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
fn forgotten(
    cx: &mut ParseContext<'_>,
    start: Option<TokenKind>,
    tokens: &[Lexeme],
    fault: &ParseFault,
) -> Option<ParseFault> {
    let at = fault.at.checked_sub(1)?;
    let word = tokens.get(at).filter(|t| t.kind.class().is_some())?;
    if !fault.has(cx.text_of(*word)) {
        return None;
    }
    let mut named = tokens[..=fault.at.min(tokens.len() - 1)].to_vec();
    named[at].kind = TokenKind::Ident;
    let same = attempt(cx, start, &named).err()?;
    let before = attempt(cx, start, &tokens[..at]).err()?;
    let name = same.at == fault.at && same.expected == fault.expected;
    (name && before.at == at && before.has("IDENT")).then_some(before)
}

fn attempt(
    cx: &mut ParseContext<'_>,
    start: Option<TokenKind>,
    tokens: &[Lexeme],
) -> Result<ParsedUnit, ParseFault> {
    let (from, to) = (tokens.first().map_or(0, |t| t.start), tokens.last().map_or(0, |t| t.end));
    let taken = Cell::new(0_usize);
    let stream = start
        .map(|kind| Lexeme::synthetic(kind, from))
        .into_iter()
        .chain(tokens.iter().copied())
        .chain(std::iter::once(Lexeme::synthetic(TokenKind::End, to)))
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
        Some(TokenKind::StartStep | TokenKind::StartStimulusStep) => "step",
        Some(TokenKind::StartStatement) => "statement",
        Some(_) => "member",
    };
    Err(ParseFault { of, within: start.or_else(|| tokens.first().map(|t| t.kind)), at, expected })
}
