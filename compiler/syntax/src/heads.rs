//! Keywords that start declarations and can be names: which of the two one is, by the tokens around it.

use crate::token::{Kind, Lexeme};

/// Whether the tokens after the keyword at `at` are those of its declaration.
pub(crate) fn has_its_rest(tokens: &[Lexeme], at: usize) -> bool {
    let kind = |n: usize| tokens.get(at + n).map(|t| t.kind);
    let (Some(head), Some(next)) = (kind(0), kind(1)) else { return false };
    let after = |kinds: &[Kind]| next.can_be_name() && kind(2).is_some_and(|k| kinds.contains(&k));
    match head {
        Kind::Use => next == Kind::Str || after(&[Kind::Dot]),
        Kind::Actor | Kind::Var => after(&[Kind::Colon]),
        Kind::Const | Kind::Network => after(&[Kind::Assign]),
        Kind::Event => after(&[Kind::FromWord, Kind::Comma, Kind::LParen]),
        Kind::Stimulus => after(&[Kind::By, Kind::LParen]),
        Kind::Agent => after(&[Kind::Plays, Kind::LParen, Kind::Assign]),
        Kind::Automaton => after(&[Kind::LBrace, Kind::Plays, Kind::LParen, Kind::Assign]),
        Kind::Fn => after(&[Kind::LParen]),
        Kind::Query => after(&[Kind::Of, Kind::Str]),
        Kind::Require => {
            after(&[Kind::LParen, Kind::Assign])
                || ((tokens[at].first || !goes_on(next))
                    && next.can_be_name()
                    && kind(2).is_some_and(Kind::can_be_name)
                    && starts_pattern(kind(3)))
        }
        Kind::Assume => next == Kind::At && kind(2) == Some(Kind::Most),
        Kind::Cover | Kind::Cross => after(&[Kind::Assign, Kind::LParen]),
        Kind::Suite => after(&[Kind::By]),
        Kind::Part => after(&[Kind::LBrace, Kind::LParen, Kind::Assign]),
        Kind::World => next == Kind::LBrace,
        Kind::System | Kind::Device | Kind::Enum | Kind::Record => after(&[Kind::LBrace]),
        Kind::Test => after(&[Kind::LBrace, Kind::Dot]),
        Kind::Allow => after(&[Kind::Str]),
        Kind::Channel => {
            after(&[Kind::Comma, Kind::Colon, Kind::LParen])
                || (next.can_be_name() && tokens.get(at + 2).is_none_or(|t| t.first))
        }
        Kind::Scenario => tokens[at].first && next.can_be_name() && !tokens[at + 1].first,
        _ => false,
    }
}

/// What follows an event in a requirement.
fn goes_on(kind: Kind) -> bool {
    matches!(kind, Kind::Causes | Kind::Forbids | Kind::Until | Kind::Within | Kind::While)
}

/// What follows the kind of a requirement.
fn starts_pattern(kind: Option<Kind>) -> bool {
    kind.is_some_and(|k| k.can_be_name() || matches!(k, Kind::Str | Kind::LParen))
}

/// Words that a name follows, at the level of declarations.
pub(crate) fn wants_a_name(kind: Kind) -> bool {
    kind.continues()
        || matches!(
            kind,
            Kind::FromWord
                | Kind::To
                | Kind::By
                | Kind::Plays
                | Kind::Of
                | Kind::Agents
                | Kind::After
                | Kind::Never
                | Kind::Globally
                | Kind::While
                | Kind::Causes
                | Kind::Forbids
                | Kind::Until
                | Kind::Within
                | Kind::Most
                | Kind::Bins
        )
}
