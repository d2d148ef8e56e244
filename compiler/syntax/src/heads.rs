//! Keywords that start declarations and can be names: which of the two one is, by the tokens around it.

use crate::token::{Lexeme, TokenKind, TokenTrait};

/// Whether the tokens after the keyword at `at` are those of its declaration.
pub(crate) fn has_its_rest(tokens: &[Lexeme], at: usize) -> bool {
    let kind = |n: usize| tokens.get(at + n).map(|t| t.kind);
    let (Some(head), Some(next)) = (kind(0), kind(1)) else { return false };
    let after = |kinds: &[TokenKind]| next.can_be_name() && kind(2).is_some_and(|k| kinds.contains(&k));
    match head {
        TokenKind::Use => next == TokenKind::Str || after(&[TokenKind::Dot]),
        TokenKind::Actor | TokenKind::Var => after(&[TokenKind::Colon]),
        TokenKind::Const | TokenKind::Network => after(&[TokenKind::Assign]),
        TokenKind::Event => after(&[TokenKind::FromWord, TokenKind::Comma, TokenKind::LParen]),
        TokenKind::Stimulus => after(&[TokenKind::By, TokenKind::LParen]),
        TokenKind::Agent => after(&[TokenKind::Plays, TokenKind::LParen, TokenKind::Assign]),
        TokenKind::Automaton => {
            after(&[TokenKind::LBrace, TokenKind::Plays, TokenKind::LParen, TokenKind::Assign])
        }
        TokenKind::Fn => after(&[TokenKind::LParen]),
        TokenKind::Query => after(&[TokenKind::Of, TokenKind::Str]),
        TokenKind::Require => {
            after(&[TokenKind::LParen, TokenKind::Assign])
                || ((tokens[at].first || !next.is(TokenTrait::AfterEvent))
                    && next.can_be_name()
                    && kind(2).is_some_and(TokenKind::can_be_name)
                    && starts_pattern(kind(3)))
        }
        TokenKind::Assume => next == TokenKind::At && kind(2) == Some(TokenKind::Most),
        TokenKind::Cover | TokenKind::Cross => after(&[TokenKind::Assign, TokenKind::LParen]),
        TokenKind::Suite => after(&[TokenKind::By]),
        TokenKind::Part => {
            after(&[TokenKind::LBrace, TokenKind::LParen, TokenKind::Assign, TokenKind::FromWord])
        }
        TokenKind::World => next == TokenKind::LBrace,
        TokenKind::System => after(&[TokenKind::LBrace, TokenKind::Plays]),
        TokenKind::Device | TokenKind::Enum | TokenKind::Record => after(&[TokenKind::LBrace]),
        TokenKind::Test => after(&[TokenKind::LBrace, TokenKind::Dot]),
        TokenKind::Allow => after(&[TokenKind::Str]),
        TokenKind::Channel => {
            after(&[TokenKind::Comma, TokenKind::Colon, TokenKind::LParen])
                || (next.can_be_name() && tokens.get(at + 2).is_none_or(|t| t.first))
        }
        TokenKind::Scenario => tokens[at].first && next.can_be_name() && !tokens[at + 1].first,
        _ => false,
    }
}

/// What follows the kind of a requirement.
fn starts_pattern(kind: Option<TokenKind>) -> bool {
    kind.is_some_and(|k| k.can_be_name() || matches!(k, TokenKind::Str | TokenKind::LParen))
}

/// Words that a name follows, at the level of declarations.
pub(crate) fn wants_a_name(kind: TokenKind) -> bool {
    kind.continues() || kind.is(TokenTrait::WantsName)
}
