//! Keywords that can only be names where they stand, and where one token of looking ahead is too little for the grammar.
//!
//! Everywhere else the grammar itself takes a keyword for a name where the keyword does not fit.

use crate::token::{Kind, Lexeme};

/// Makes names of the keywords that what stands around them shows to be names.
pub(crate) fn names(tokens: &mut [Lexeme]) {
    let stimuli = stimuli(tokens);
    let mut open: Vec<usize> = Vec::new();
    let mut place = Place::default();
    for at in 0..tokens.len() {
        place.token(tokens, at);
        match tokens[at].kind {
            Kind::LParen => open.push(at),
            Kind::RParen => {
                let called = open.pop().and_then(|from| from.checked_sub(1));
                if let Some(called) = called
                    && called_before(tokens[called].kind, tokens.get(at + 1).copied())
                {
                    tokens[called].kind = Kind::Ident;
                }
            }
            kind => {
                let does = place.test || stimuli.contains(&kind);
                if lacks_its_rest(tokens, at, does) || place.is_step(tokens, at) {
                    tokens[at].kind = Kind::Ident;
                }
            }
        }
    }
}

/// The keywords that are names of stimuli here: without anything after it such a word is a step.
fn stimuli(tokens: &[Lexeme]) -> Vec<Kind> {
    let named = tokens.windows(2).filter(|w| w[0].kind == Kind::Stimulus && w[1].kind.class().is_some());
    let mut kinds: Vec<Kind> = Vec::new();
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
    let ends = does && matches!(next.kind, Kind::Semi | Kind::RBrace);
    let follows = ends || follows_a_name(tokens[at], *next);
    let empty = next.kind == Kind::LParen && tokens.get(at + 2).is_some_and(|t| t.kind == Kind::RParen);
    match tokens[at].kind {
        Kind::Await
        | Kind::Else
        | Kind::Fork
        | Kind::Method
        | Kind::Because
        | Kind::Predicts
        | Kind::With => next.kind == Kind::LParen || follows,
        Kind::If => {
            let step = at
                .checked_sub(1)
                .is_none_or(|i| matches!(tokens[i].kind, Kind::Semi | Kind::LBrace | Kind::RBrace));
            let last = matches!(next.kind, Kind::Semi | Kind::LBrace | Kind::RBrace)
                || next.first && next.kind.is_head();
            empty || follows || !step && last
        }
        Kind::While | Kind::For | Kind::Wait | Kind::Seed => empty || follows,
        Kind::Imply => {
            let operand = at.checked_sub(1).is_some_and(|i| {
                let before = tokens[i].kind;
                before.ends_operand() || before.can_be_name()
            });
            !operand || follows
        }
        Kind::After | Kind::Never | Kind::Globally => {
            next.kind == Kind::Or || starts_a_response(tokens.get(at + 1..).unwrap_or_default())
        }
        _ => false,
    }
}

/// What ends a name within something else, or goes on with it, and starts nothing.
fn follows_a_name(word: Lexeme, next: Lexeme) -> bool {
    if next.kind == Kind::Dot {
        return word.end == next.start && matches!(word.kind, Kind::If | Kind::Else | Kind::Imply);
    }
    matches!(
        next.kind,
        Kind::RParen
            | Kind::RBracket
            | Kind::Comma
            | Kind::Colon
            | Kind::DotDot
            | Kind::Pipe
            | Kind::Assign
            | Kind::PlusAssign
            | Kind::MinusAssign
            | Kind::Eq
            | Kind::Ne
            | Kind::Lt
            | Kind::Le
            | Kind::Gt
            | Kind::Ge
            | Kind::Plus
            | Kind::Star
            | Kind::Slash
            | Kind::Percent
            | Kind::And
            | Kind::AndAnd
            | Kind::Or
            | Kind::OrOr
    )
}

/// `causes x`: what is before is the trigger. In `after causes: x` and `never causes while c` it is not.
fn starts_a_response(tokens: &[Lexeme]) -> bool {
    let [word, next, ..] = tokens else { return false };
    let event = next.kind.can_be_name() && next.kind != Kind::While && !(next.first && next.kind.is_head());
    matches!(word.kind, Kind::Causes | Kind::Forbids) && event
}

/// Whether a keyword that parentheses follow is a call by what follows them.
fn called_before(kind: Kind, next: Option<Lexeme>) -> bool {
    let after = next.map(|t| t.kind);
    match kind {
        Kind::If | Kind::While | Kind::For => matches!(
            after,
            Some(
                Kind::Semi
                    | Kind::RBrace
                    | Kind::RParen
                    | Kind::RBracket
                    | Kind::Comma
                    | Kind::Pipe
                    | Kind::With
            )
        ),
        Kind::After | Kind::Never => matches!(after, Some(Kind::Causes | Kind::Forbids | Kind::Or)),
        Kind::Globally => matches!(after, Some(Kind::Causes | Kind::Forbids)),
        _ => false,
    }
}

/// Where in the text a token is: in the steps of a test a line is a step.
#[derive(Default)]
struct Place {
    test: bool,
    braces: usize,
}

impl Place {
    fn token(&mut self, tokens: &[Lexeme], at: usize) {
        let token = tokens[at];
        match token.kind {
            Kind::LBrace => self.braces += 1,
            Kind::RBrace => self.braces = self.braces.saturating_sub(1),
            kind if kind.is_head() && token.first => {
                // The closing brace of what is before may be missing.
                let path = tokens.get(at + 1).is_some_and(|t| !t.first && t.kind.can_be_name());
                if kind == Kind::Test && path {
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
        let starts = tokens[at].first || at.checked_sub(1).is_some_and(|i| tokens[i].kind == Kind::Semi);
        let alone = tokens.get(at + 1).is_some_and(|t| t.first && t.kind.is_word());
        let step = matches!(
            tokens[at].kind,
            Kind::Await
                | Kind::Wait
                | Kind::Seed
                | Kind::Method
                | Kind::Because
                | Kind::Predicts
                | Kind::With
        );
        let step = step && alone || tokens[at].kind == Kind::Imply && tokens[at].first;
        self.test && self.braces == 1 && step && starts
    }
}
