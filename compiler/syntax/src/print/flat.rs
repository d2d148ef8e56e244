//! Members on one line.

use crate::print::marks::BlockKind;
use crate::print::shape::{BlockShape, MemberPart, MemberShape};
use crate::print::spacing::{blank, ends_line};
use crate::print::trivia::PrintToken;
use crate::token::{TokenKind, TokenTrait};

/// A text on one line, and where its columns start.
#[derive(Debug, Default)]
pub(super) struct FlatText {
    pub text: String,
    pub stops: [Option<usize>; 2],
    width: usize,
    room: usize,
    /// The tokens before which columns start.
    columns: [Option<usize>; 2],
}

impl FlatText {
    /// A member, if it may stand on one line and has room there.
    pub(super) fn member(toks: &[PrintToken<'_>], member: &MemberShape, room: usize) -> Option<Self> {
        let mut flat = Self { room, columns: columns(toks, member).1, ..Self::default() };
        flat.write_member(toks, member)?;
        Some(flat)
    }

    /// A block with its braces.
    pub(super) fn block(toks: &[PrintToken<'_>], block: &BlockShape, room: usize) -> Option<Self> {
        let mut flat = Self { room, ..Self::default() };
        flat.write_block(toks, block)?;
        Some(flat)
    }

    pub(super) fn width(&self) -> usize {
        self.width
    }

    fn write_member(&mut self, toks: &[PrintToken<'_>], member: &MemberShape) -> Option<()> {
        for part in &member.parts {
            match part {
                MemberPart::Run(run) => {
                    for at in run.clone() {
                        if at > member.first && ends_line(toks, at, member.first) {
                            return None;
                        }
                        self.token(toks, at, at > member.first && blank(toks, at))?;
                    }
                }
                MemberPart::Block(block) => {
                    if commented(toks, block.open) {
                        return None;
                    }
                    self.stop(block.open);
                    self.add(" ")?;
                    self.write_block(toks, block)?;
                }
            }
        }
        Some(())
    }

    fn write_block(&mut self, toks: &[PrintToken<'_>], block: &BlockShape) -> Option<()> {
        self.add("{")?;
        for (n, member) in block.members.iter().enumerate() {
            if toks[member.first].newline || commented(toks, member.first) {
                return None;
            }
            let separator = match block.kind {
                BlockKind::List => ", ",
                BlockKind::Members | BlockKind::Steps => "; ",
            };
            self.add(if n == 0 { " " } else { separator })?;
            self.write_member(toks, member)?;
        }
        let close = &toks[block.close];
        if commented(toks, block.close) || (close.newline && !block.members.is_empty()) {
            return None;
        }
        self.add(" }")
    }

    fn token(&mut self, toks: &[PrintToken<'_>], at: usize, space: bool) -> Option<()> {
        self.stop(at);
        if space {
            self.add(" ")?;
        }
        let from = self.text.len();
        write(&toks[at], &mut self.text);
        self.width += self.text[from..].chars().count();
        (self.width <= self.room).then_some(())
    }

    fn stop(&mut self, at: usize) {
        for (stop, column) in self.stops.iter_mut().zip(self.columns) {
            if column == Some(at) {
                *stop = Some(self.text.len());
            }
        }
    }

    fn add(&mut self, text: &str) -> Option<()> {
        self.text += text;
        self.width += text.len();
        (self.width <= self.room).then_some(())
    }
}

/// A comment is before a token.
fn commented(toks: &[PrintToken<'_>], at: usize) -> bool {
    !toks[at].leading.is_empty() || at.checked_sub(1).is_some_and(|before| toks[before].trailing.is_some())
}

/// A token as it is written: a quantity has one blank before its unit.
pub(super) fn write(tok: &PrintToken<'_>, out: &mut String) {
    if tok.kind == TokenKind::Quantity {
        out.push_str(tok.text[..tok.unit].trim_end());
        out.push(' ');
        out.push_str(&tok.text[tok.unit..]);
    } else {
        out.push_str(tok.text);
    }
}

/// What sort of member it is, if such members are aligned, and the tokens before which its columns start.
pub(super) fn columns(
    toks: &[PrintToken<'_>],
    member: &MemberShape,
) -> (Option<TokenKind>, [Option<usize>; 2]) {
    let first = toks[member.first].kind;
    let find = |kind, from| find(toks, kind, from, member.end);
    let start = member.first + 1;
    match first {
        kind if kind.is(TokenTrait::AlignedAtAssign) => (Some(first), [find(TokenKind::Assign, start), None]),
        TokenKind::Cover => {
            let assign = find(TokenKind::Assign, start);
            (Some(first), [assign, assign.and_then(|at| find(TokenKind::Bins, at))])
        }
        TokenKind::Event => (Some(first), [find(TokenKind::FromWord, start), None]),
        TokenKind::Actor | TokenKind::Var => (Some(first), [find(TokenKind::Colon, start), None]),
        TokenKind::Sample => (Some(first), [find(TokenKind::In, start), None]),
        TokenKind::Bin => (Some(first), [find(TokenKind::When, start), None]),
        TokenKind::From => (Some(first), [Some(start), Some(start + 2).filter(|at| *at < member.end)]),
        TokenKind::Location | TokenKind::Init | TokenKind::Committed | TokenKind::Urgent => {
            (Some(TokenKind::Location), [find(TokenKind::LBrace, start), None])
        }
        TokenKind::Plan => {
            let reacts = find(TokenKind::On, start).is_some() && find(TokenKind::When, start).is_none();
            (Some(first), [find(TokenKind::LBrace, start).filter(|_| reacts), None])
        }
        _ => (None, [None, None]),
    }
}

/// The first token of a kind outside brackets, near the start of a member.
fn find(toks: &[PrintToken<'_>], kind: TokenKind, from: usize, end: usize) -> Option<usize> {
    let mut depth = 0_usize;
    for (at, tok) in toks.iter().enumerate().take(end.min(from + crate::print::measure::WIDTH)).skip(from) {
        if depth == 0 && tok.kind == kind {
            return Some(at);
        }
        match tok.kind {
            TokenKind::LParen | TokenKind::LBracket | TokenKind::LBrace => depth += 1,
            TokenKind::RParen | TokenKind::RBracket | TokenKind::RBrace => depth = depth.saturating_sub(1),
            _ => {}
        }
    }
    None
}
