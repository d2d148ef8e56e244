//! The tokens with the comments and line ends around them. Separators that mean nothing are left out: `layout` writes
//! those that the style wants.

use crate::print::marks::{BlockKind, TokenMark};
use crate::token::{Lexeme, TokenKind};

/// A comment on lines of its own, or at the end of a line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Comment<'t> {
    pub text: &'t str,
    /// A blank line is before it.
    pub blank: bool,
}

/// A token, and what is around it.
#[derive(Debug)]
pub(super) struct PrintToken<'t> {
    pub kind: TokenKind,
    pub text: &'t str,
    /// Where the unit starts in the text of a quantity.
    pub unit: usize,
    pub mark: TokenMark,
    /// The first of its line.
    pub newline: bool,
    /// A blank line is before it, and before no comment of its own.
    pub blank: bool,
    /// Comments between the token before and this one, on lines of their own.
    pub leading: Vec<Comment<'t>>,
    /// The comment at the end of its line.
    pub trailing: Option<&'t str>,
    /// Of an opening bracket: the token that closes it.
    pub close: usize,
    /// A parenthesis whose list was broken after the opening one.
    pub broken: bool,
}

/// The tokens of a text, and one more for its end.
pub(super) fn tokens<'t>(text: &'t str, lexemes: &[Lexeme], marks: &[TokenMark]) -> Vec<PrintToken<'t>> {
    let mut reader =
        TriviaReader { out: Vec::with_capacity(lexemes.len() + 1), open: Vec::new(), kept: None };
    let mut end = if text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
    for (at, (lexeme, mark)) in lexemes.iter().zip(marks).enumerate() {
        let (from, to) = (lexeme.start as usize, lexeme.end as usize);
        reader.gap(&text[end..from], at == 0);
        let next = lexemes.get(at + 1).map(|t| t.kind);
        let before_action = marks.get(at + 1).is_some_and(|m| m.action);
        let tok = PrintToken {
            kind: lexeme.kind,
            text: &text[from..to],
            unit: lexeme.unit.saturating_sub(lexeme.start) as usize,
            mark: *mark,
            newline: false,
            blank: false,
            leading: Vec::new(),
            trailing: None,
            close: 0,
            broken: false,
        };
        reader.token(tok, next, before_action);
        end = to;
    }
    reader.gap(&text[end..], lexemes.is_empty());
    reader.finish(text);
    let mut out = reader.out;
    brackets(&mut out);
    out
}

/// What is between two tokens.
#[derive(Default)]
struct TokenGap<'t> {
    newline: bool,
    blank: bool,
    leading: Vec<Comment<'t>>,
}

struct TriviaReader<'t> {
    out: Vec<PrintToken<'t>>,
    /// Of the brackets that are open: whether it is a block of elements with commas.
    open: Vec<bool>,
    /// What is before the next token, since the last one that was kept.
    kept: Option<TokenGap<'t>>,
}

impl<'t> TriviaReader<'t> {
    /// Takes up the comments and line ends of the text between two tokens.
    fn gap(&mut self, between: &'t str, first: bool) {
        let gap = self.kept.get_or_insert_default();
        let mut lines = if first { 1_usize } else { 0 };
        gap.newline |= first;
        for (n, line) in between.split('\n').enumerate() {
            if n > 0 {
                lines += 1;
                gap.newline = true;
            }
            let comment = line.trim();
            if comment.is_empty() {
                continue;
            }
            let same_line = n == 0 && !first && gap.leading.is_empty();
            match self.out.last_mut() {
                Some(last) if same_line && last.trailing.is_none() => last.trailing = Some(comment),
                _ => {
                    gap.leading.push(Comment { text: comment, blank: lines >= 2 });
                    lines = 0;
                }
            }
        }
        gap.blank |= lines >= 2;
    }

    /// Keeps a token, unless it is a separator without meaning.
    fn token(&mut self, mut tok: PrintToken<'t>, next: Option<TokenKind>, before_action: bool) {
        let listed = self.open.last().copied().unwrap_or(false);
        let dropped = match tok.kind {
            TokenKind::Semi => !before_action,
            TokenKind::Comma => listed || next == Some(TokenKind::RParen),
            _ => false,
        };
        if dropped {
            return;
        }
        match tok.kind {
            TokenKind::LBrace | TokenKind::LParen | TokenKind::LBracket => {
                self.open.push(tok.mark.block == Some(BlockKind::List));
            }
            TokenKind::RBrace | TokenKind::RParen | TokenKind::RBracket => {
                self.open.pop();
            }
            _ => {}
        }
        let gap = self.kept.take().unwrap_or_default();
        (tok.newline, tok.blank, tok.leading) = (gap.newline, gap.blank, gap.leading);
        self.out.push(tok);
    }

    fn finish(&mut self, text: &'t str) {
        let gap = self.kept.take().unwrap_or_default();
        self.out.push(PrintToken {
            kind: TokenKind::End,
            text: &text[text.len()..],
            unit: 0,
            mark: TokenMark::default(),
            newline: true,
            blank: false,
            leading: gap.leading,
            trailing: None,
            close: 0,
            broken: false,
        });
    }
}

/// Finds the partner of every bracket, and the lists that are broken after their opening parenthesis.
fn brackets(toks: &mut [PrintToken<'_>]) {
    let mut open: Vec<(usize, bool)> = Vec::new();
    for at in 0..toks.len() {
        match toks[at].kind {
            TokenKind::LBrace | TokenKind::LParen | TokenKind::LBracket => open.push((at, false)),
            TokenKind::Comma => {
                if let Some(top) = open.last_mut() {
                    top.1 = true;
                }
            }
            TokenKind::RBrace | TokenKind::RParen | TokenKind::RBracket => {
                let Some((from, commas)) = open.pop() else { continue };
                toks[from].close = at;
                if toks[at].kind == TokenKind::RParen && commas && toks[from + 1].newline {
                    toks[from].broken = true;
                    toks[at].broken = true;
                }
            }
            _ => {}
        }
    }
}
