//! Blanks between two tokens, and where a line may break.

use crate::print::trivia::Tok;
use crate::token::Kind;

/// How weakly two tokens hold together: the lower, the sooner a line breaks there.
pub(super) type Weakness = u16;

/// Before the pattern of a requirement.
const PATTERN: Weakness = 0;
/// Before a clause, such as `when`.
const CLAUSE: Weakness = 1;
/// After a comma, or a semicolon of an edge.
const COMMA: Weakness = 2;

/// Whether a blank stands between the token before `at` and this one.
pub(super) fn blank(toks: &[Tok<'_>], at: usize) -> bool {
    let Some(before) = at.checked_sub(1) else { return false };
    let (p, n) = (&toks[before], &toks[at]);
    if matches!(n.kind, Kind::Comma | Kind::Semi | Kind::RParen | Kind::RBracket | Kind::Dot) {
        return false;
    }
    match p.kind {
        Kind::LParen
        | Kind::LBracket
        | Kind::Dot
        | Kind::Internal
        | Kind::At_
        | Kind::Tilde
        | Kind::MinusPlus => return false,
        // A participant that may stay away, and not a question.
        Kind::Question if n.kind != Kind::Pipe => return false,
        Kind::Bang | Kind::BangBang => return matches!(n.kind, Kind::Bang | Kind::BangBang),
        Kind::Plus | Kind::Minus if p.mark.prefix => return false,
        Kind::DotDot => return !p.mark.tight,
        _ => {}
    }
    match n.kind {
        // What may stay away or be left out is marked behind it.
        Kind::Question => !(p.kind.can_be_name() || p.kind == Kind::RBracket),
        Kind::Colon => before > 0 && toks[before - 1].kind == Kind::Actor || of_channel(toks, at),
        Kind::LParen => !n.mark.call,
        // An index and annotations belong to what is before; a list stands alone.
        Kind::LBracket => n.mark.apart || !(p.kind.ends_operand() || p.kind.can_be_name()),
        Kind::DotDot => !n.mark.tight,
        _ => true,
    }
}

/// A colon with the kind of a channel behind it: it belongs to all names, as that of an actor does not to the name alone.
fn of_channel(toks: &[Tok<'_>], at: usize) -> bool {
    toks.get(at + 1).is_some_and(|t| matches!(t.kind, Kind::Urgent | Kind::Broadcast | Kind::Joint))
}

/// How weakly the token at `at` holds to the one before; `None`: a line does not break here.
pub(super) fn weakness(toks: &[Tok<'_>], at: usize, first: usize) -> Option<Weakness> {
    let before = at.checked_sub(1)?;
    let (p, n) = (&toks[before], &toks[at]);
    if matches!(p.kind, Kind::Comma | Kind::Semi) {
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

fn operator(n: &Tok<'_>) -> Option<Weakness> {
    Some(match n.kind {
        Kind::Else | Kind::Or | Kind::OrOr | Kind::Pipe => 3,
        Kind::And | Kind::AndAnd => 4,
        Kind::Eq | Kind::Ne | Kind::Lt | Kind::Le | Kind::Gt | Kind::Ge => 5,
        Kind::Plus | Kind::Minus if !n.mark.prefix => 6,
        Kind::Star | Kind::Slash | Kind::Percent => 7,
        _ => return None,
    })
}

/// A word that starts a clause, after the end of another one.
fn clause(p: Kind, n: Kind) -> bool {
    let starts = matches!(
        n,
        Kind::When
            | Kind::On
            | Kind::Do
            | Kind::Select
            | Kind::Emit
            | Kind::Within
            | Kind::While
            | Kind::Until
            | Kind::Causes
            | Kind::Forbids
            | Kind::FromWord
            | Kind::Bins
            | Kind::With
            | Kind::Tip
            | Kind::Tool
            | Kind::Speed
            | Kind::Reach
            | Kind::Delay
            | Kind::At
            | Kind::Axis
            | Kind::Limits
            | Kind::Rotated
            | Kind::Mass
            | Kind::Ghost
            | Kind::Graspable
            | Kind::Expect
    );
    starts && p.ends_operand()
}

/// A line ends before the token at `at`, whatever the room: for a comment, or because the author decided so and may.
pub(super) fn ends_line(toks: &[Tok<'_>], at: usize, first: usize) -> bool {
    let Some(before) = at.checked_sub(1) else { return false };
    let (p, n) = (&toks[before], &toks[at]);
    if !n.leading.is_empty() || p.trailing.is_some() {
        return true;
    }
    let broken_list = (p.broken && p.kind == Kind::LParen) || (n.broken && n.kind == Kind::RParen);
    let decided = matches!(weakness(toks, at, first), Some(PATTERN | CLAUSE | COMMA));
    broken_list || (n.newline && (decided || would_join(toks, before)))
}

/// On one line the number before would take the next token as its unit, or lose its `%`.
fn would_join(toks: &[Tok<'_>], before: usize) -> bool {
    let (p, n) = (&toks[before], &toks[before + 1]);
    match p.kind {
        Kind::Int | Kind::Float => {
            let counts = before > 0 && toks[before - 1].kind == Kind::Most;
            matches!(n.kind, Kind::Ident | Kind::Percent) && !counts
        }
        Kind::Quantity => p.text.ends_with('%') && n.kind.starts_operand(),
        _ => false,
    }
}
