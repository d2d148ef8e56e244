//! Keywords that can only be names where they stand, and where one token of looking ahead is too little for the grammar.
//!
//! Everywhere else the grammar itself takes a keyword for a name where the keyword does not fit.

use crate::token::{Lexeme, TokenKind, TokenTrait};

/// Makes names of the keywords that what stands around them shows to be names.
pub(crate) fn names(tokens: &mut [Lexeme]) {
    let stimuli = stimuli(tokens);
    let mut open: Vec<usize> = Vec::new();
    let mut place = TestLineTracker::default();
    for at in 0..tokens.len() {
        place.token(tokens, at);
        match tokens[at].kind {
            TokenKind::LParen => open.push(at),
            TokenKind::RParen => {
                let called = open.pop().and_then(|from| from.checked_sub(1));
                if let Some(called) = called
                    && called_before(tokens[called].kind, tokens.get(at + 1).copied())
                {
                    tokens[called].kind = TokenKind::Ident;
                }
            }
            kind => {
                let does = place.test || stimuli.contains(&kind);
                if lacks_its_rest(tokens, at, does) || place.is_step(tokens, at) {
                    tokens[at].kind = TokenKind::Ident;
                }
            }
        }
    }
}

/// The keywords that are names of stimuli here: without anything after it such a word is a step.
fn stimuli(tokens: &[Lexeme]) -> Vec<TokenKind> {
    let named = tokens.windows(2).filter(|w| w[0].kind == TokenKind::Stimulus && w[1].kind.class().is_some());
    let mut kinds: Vec<TokenKind> = Vec::new();
    for pair in named {
        if !kinds.contains(&pair[1].kind) {
            kinds.push(pair[1].kind);
        }
    }
    kinds
}

/// Whether the keyword at `at` is followed by what can follow a name alone; `does`: by the end of a step, too.
fn lacks_its_rest(tokens: &[Lexeme], at: usize, does: bool) -> bool {
    let Some(next) = tokens.get(at + 1) else { return false };
    let ends = does && matches!(next.kind, TokenKind::Semi | TokenKind::RBrace);
    let follows = ends || follows_a_name(tokens[at], *next);
    let empty =
        next.kind == TokenKind::LParen && tokens.get(at + 2).is_some_and(|t| t.kind == TokenKind::RParen);
    match tokens[at].kind {
        kind if kind.is(TokenTrait::WantsRest) => next.kind == TokenKind::LParen || follows,
        TokenKind::If => {
            let step = at.checked_sub(1).is_none_or(|i| {
                matches!(tokens[i].kind, TokenKind::Semi | TokenKind::LBrace | TokenKind::RBrace)
            });
            let last = matches!(next.kind, TokenKind::Semi | TokenKind::LBrace | TokenKind::RBrace)
                || next.first && next.kind.is_head();
            empty || follows || !step && last
        }
        TokenKind::While | TokenKind::For | TokenKind::Wait | TokenKind::Seed => empty || follows,
        TokenKind::Imply => {
            let operand = at.checked_sub(1).is_some_and(|i| {
                let before = tokens[i].kind;
                before.ends_operand() || before.can_be_name()
            });
            !operand || follows
        }
        TokenKind::After
        | TokenKind::Never
        | TokenKind::Globally
        | TokenKind::Always
        | TokenKind::EventuallyWord
        | TokenKind::Whenever
        | TokenKind::Formula => {
            next.kind == TokenKind::Or || starts_a_response(tokens.get(at + 1..).unwrap_or_default())
        }
        _ => false,
    }
}

/// What ends a name within something else, or goes on with it, and starts nothing.
fn follows_a_name(word: Lexeme, next: Lexeme) -> bool {
    if next.kind == TokenKind::Dot {
        return word.end == next.start
            && matches!(word.kind, TokenKind::If | TokenKind::Else | TokenKind::Imply);
    }
    next.kind.is(TokenTrait::EndsName)
}

/// `causes x`: what is before is the trigger. In `after causes: x` and `never causes while c` it is not.
fn starts_a_response(tokens: &[Lexeme]) -> bool {
    let [word, next, ..] = tokens else { return false };
    let event =
        next.kind.can_be_name() && next.kind != TokenKind::While && !(next.first && next.kind.is_head());
    word.kind.is(TokenTrait::Response) && event
}

/// Whether a keyword that parentheses follow is a call by what follows them.
fn called_before(kind: TokenKind, next: Option<Lexeme>) -> bool {
    let after = next.map(|t| t.kind);
    match kind {
        TokenKind::If | TokenKind::While | TokenKind::For => matches!(
            after,
            Some(
                TokenKind::Semi
                    | TokenKind::RBrace
                    | TokenKind::RParen
                    | TokenKind::RBracket
                    | TokenKind::Comma
                    | TokenKind::Pipe
                    | TokenKind::With
            )
        ),
        TokenKind::After | TokenKind::Never => {
            after.is_some_and(|k| k == TokenKind::Or || k.is(TokenTrait::Response))
        }
        TokenKind::Globally
        | TokenKind::Always
        | TokenKind::EventuallyWord
        | TokenKind::Whenever
        | TokenKind::Formula => after.is_some_and(|k| k.is(TokenTrait::Response)),
        _ => false,
    }
}

/// Where in the text a token is: in the steps of a test a line is a step.
#[derive(Default)]
struct TestLineTracker {
    test: bool,
    braces: usize,
}

impl TestLineTracker {
    fn token(&mut self, tokens: &[Lexeme], at: usize) {
        let token = tokens[at];
        match token.kind {
            TokenKind::LBrace => self.braces += 1,
            TokenKind::RBrace => self.braces = self.braces.saturating_sub(1),
            kind if kind.is_head() && token.first => {
                // The closing brace of what is before may be missing.
                let path = tokens.get(at + 1).is_some_and(|t| !t.first && t.kind.can_be_name());
                if kind == TokenKind::Test && path {
                    (self.test, self.braces) = (true, 0);
                } else if self.braces == 0 {
                    self.test = false;
                }
            }
            _ => {}
        }
    }

    /// A keyword alone on its line of a test names what is done.
    fn is_step(&self, tokens: &[Lexeme], at: usize) -> bool {
        let starts = tokens[at].first || at.checked_sub(1).is_some_and(|i| tokens[i].kind == TokenKind::Semi);
        let alone = tokens.get(at + 1).is_some_and(|t| t.first && t.kind.is_word());
        let step = tokens[at].kind.is(TokenTrait::TestStep) && alone
            || tokens[at].kind == TokenKind::Imply && tokens[at].first;
        // Of the test, or of an actor's block.
        self.test && matches!(self.braces, 1 | 2) && step && starts
    }
}
