//! Blanks between two tokens, and where a line may break.

use crate::print::trivia::PrintToken;
use crate::token::{TokenKind, TokenTrait};

/// How weakly two tokens hold together: the lower, the sooner a line breaks there.
pub(super) type BindingStrength = u16;

/// Before the pattern of a requirement.
const PATTERN: BindingStrength = 0;
/// Before a clause, such as `when`.
const CLAUSE: BindingStrength = 1;
/// After a comma, or a semicolon of an edge.
const COMMA: BindingStrength = 2;

/// Whether a blank stands between the token before `at` and this one.
pub(super) fn blank(toks: &[PrintToken<'_>], at: usize) -> bool {
    let Some(before) = at.checked_sub(1) else { return false };
    let (p, n) = (&toks[before], &toks[at]);
    if matches!(
        n.kind,
        TokenKind::Comma | TokenKind::Semi | TokenKind::RParen | TokenKind::RBracket | TokenKind::Dot
    ) {
        return false;
    }
    match p.kind {
        kind if kind.is(TokenTrait::NoBlankAfter) => return false,
        // A participant that may stay away, and not a question.
        TokenKind::Question if n.kind != TokenKind::Pipe => return false,
        TokenKind::Bang | TokenKind::BangBang => {
            return matches!(n.kind, TokenKind::Bang | TokenKind::BangBang);
        }
        TokenKind::Plus | TokenKind::Minus if p.mark.prefix => return false,
        TokenKind::DotDot => return !p.mark.tight,
        TokenKind::Slash if p.mark.tight => return false,
        _ => {}
    }
    match n.kind {
        // What may stay away or be left out is marked behind it.
        TokenKind::Question => !(p.kind.can_be_name() || p.kind == TokenKind::RBracket),
        TokenKind::Colon => before > 0 && toks[before - 1].kind == TokenKind::Actor || of_channel(toks, at),
        TokenKind::LParen => !n.mark.call,
        // An index and annotations belong to what is before; a list stands alone.
        TokenKind::LBracket => n.mark.apart || !(p.kind.ends_operand() || p.kind.can_be_name()),
        TokenKind::DotDot | TokenKind::Slash => !n.mark.tight,
        _ => true,
    }
}

/// A colon with the kind of a channel behind it: it belongs to all names, as that of an actor does not to the name alone.
fn of_channel(toks: &[PrintToken<'_>], at: usize) -> bool {
    toks.get(at + 1)
        .is_some_and(|t| matches!(t.kind, TokenKind::Urgent | TokenKind::Broadcast | TokenKind::Joint))
}

/// How weakly the token at `at` holds to the one before; `None`: a line does not break here.
pub(super) fn weakness(toks: &[PrintToken<'_>], at: usize, first: usize) -> Option<BindingStrength> {
    let before = at.checked_sub(1)?;
    let (p, n) = (&toks[before], &toks[at]);
    if matches!(p.kind, TokenKind::Comma | TokenKind::Semi) {
        return Some(COMMA);
    }
    if n.mark.pattern {
        return Some(PATTERN);
    }
    if before > first && clause(p.kind, n.kind) {
        return Some(CLAUSE);
    }
    operator(n)
}

fn operator(n: &PrintToken<'_>) -> Option<BindingStrength> {
    Some(match n.kind {
        TokenKind::Else | TokenKind::Or | TokenKind::OrOr | TokenKind::Pipe | TokenKind::Implies => 3,
        TokenKind::And | TokenKind::AndAnd => 4,
        TokenKind::Eq | TokenKind::Ne | TokenKind::Lt | TokenKind::Le | TokenKind::Gt | TokenKind::Ge => 5,
        TokenKind::Plus | TokenKind::Minus if !n.mark.prefix => 6,
        TokenKind::Slash if n.mark.tight => return None,
        TokenKind::Star | TokenKind::Slash | TokenKind::Percent => 7,
        _ => return None,
    })
}

/// A word that starts a clause, after the end of another one.
fn clause(p: TokenKind, n: TokenKind) -> bool {
    n.is(TokenTrait::Clause) && p.ends_operand()
}

/// A line ends before the token at `at`, whatever the room: for a comment, or because the author decided so and may.
pub(super) fn ends_line(toks: &[PrintToken<'_>], at: usize, first: usize) -> bool {
    let Some(before) = at.checked_sub(1) else { return false };
    let (p, n) = (&toks[before], &toks[at]);
    if !n.leading.is_empty() || p.trailing.is_some() {
        return true;
    }
    let broken_list = (p.broken && p.kind == TokenKind::LParen) || (n.broken && n.kind == TokenKind::RParen);
    let decided = matches!(weakness(toks, at, first), Some(PATTERN | CLAUSE | COMMA));
    broken_list || (n.newline && (decided || would_join(toks, before)))
}

/// On one line the number before would take the next token as its unit, or lose its `%`.
fn would_join(toks: &[PrintToken<'_>], before: usize) -> bool {
    let (p, n) = (&toks[before], &toks[before + 1]);
    match p.kind {
        TokenKind::Int | TokenKind::Float => {
            let counts = before > 0
                && matches!(toks[before - 1].kind, TokenKind::Most | TokenKind::Least | TokenKind::Exactly);
            matches!(n.kind, TokenKind::Ident | TokenKind::Percent) && !counts
        }
        TokenKind::Quantity => {
            p.text.ends_with('%') && n.kind.starts_operand() && !n.kind.is(TokenTrait::Sensing)
        }
        _ => false,
    }
}
