//! Members on one line.

use crate::print::marks::BlockKind;
use crate::print::shape::{Block, Member, Part};
use crate::print::spacing::{blank, ends_line};
use crate::print::trivia::Tok;
use crate::token::Kind;

/// A text on one line, and where its columns start.
#[derive(Debug, Default)]
pub(super) struct Flat {
    pub text: String,
    pub stops: [Option<usize>; 2],
    width: usize,
    room: usize,
    /// The tokens before which columns start.
    columns: [Option<usize>; 2],
}

impl Flat {
    /// A member, if it may stand on one line and has room there.
    pub(super) fn member(toks: &[Tok<'_>], member: &Member, room: usize) -> Option<Self> {
        let mut flat = Self { room, columns: columns(toks, member).1, ..Self::default() };
        flat.write_member(toks, member)?;
        Some(flat)
    }

    /// A block with its braces.
    pub(super) fn block(toks: &[Tok<'_>], block: &Block, room: usize) -> Option<Self> {
        let mut flat = Self { room, ..Self::default() };
        flat.write_block(toks, block)?;
        Some(flat)
    }

    pub(super) fn width(&self) -> usize {
        self.width
    }

    fn write_member(&mut self, toks: &[Tok<'_>], member: &Member) -> Option<()> {
        for part in &member.parts {
            match part {
                Part::Run(run) => {
                    for at in run.clone() {
                        if at > member.first && ends_line(toks, at, member.first) {
                            return None;
                        }
                        self.token(toks, at, at > member.first && blank(toks, at))?;
                    }
                }
                Part::Block(block) => {
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

    fn write_block(&mut self, toks: &[Tok<'_>], block: &Block) -> Option<()> {
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

    fn token(&mut self, toks: &[Tok<'_>], at: usize, space: bool) -> Option<()> {
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
fn commented(toks: &[Tok<'_>], at: usize) -> bool {
    !toks[at].leading.is_empty() || at.checked_sub(1).is_some_and(|before| toks[before].trailing.is_some())
}

/// A token as it is written: a quantity has one blank before its unit.
pub(super) fn write(tok: &Tok<'_>, out: &mut String) {
    if tok.kind == Kind::Quantity {
        out.push_str(tok.text[..tok.unit].trim_end());
        out.push(' ');
        out.push_str(&tok.text[tok.unit..]);
    } else {
        out.push_str(tok.text);
    }
}

/// What sort of member it is, if such members are aligned, and the tokens before which its columns start.
pub(super) fn columns(toks: &[Tok<'_>], member: &Member) -> (Option<Kind>, [Option<usize>; 2]) {
    let first = toks[member.first].kind;
    let find = |kind, from| find(toks, kind, from, member.end);
    let start = member.first + 1;
    match first {
        Kind::Const
        | Kind::Network
        | Kind::Part
        | Kind::Belief
        | Kind::Agent
        | Kind::Automaton
        | Kind::Require
        | Kind::Cross => (Some(first), [find(Kind::Assign, start), None]),
        Kind::Cover => {
            let assign = find(Kind::Assign, start);
            (Some(first), [assign, assign.and_then(|at| find(Kind::Bins, at))])
        }
        Kind::Event => (Some(first), [find(Kind::FromWord, start), None]),
        Kind::Actor | Kind::Var => (Some(first), [find(Kind::Colon, start), None]),
        Kind::Sample => (Some(first), [find(Kind::In, start), None]),
        Kind::Bin => (Some(first), [find(Kind::When, start), None]),
        Kind::From => (Some(first), [Some(start), Some(start + 2).filter(|at| *at < member.end)]),
        Kind::Location | Kind::Init | Kind::Committed | Kind::Urgent => {
            (Some(Kind::Location), [find(Kind::LBrace, start), None])
        }
        Kind::Plan => {
            let reacts = find(Kind::On, start).is_some() && find(Kind::When, start).is_none();
            (Some(first), [find(Kind::LBrace, start).filter(|_| reacts), None])
        }
        _ => (None, [None, None]),
    }
}

/// The first token of a kind outside brackets, near the start of a member.
fn find(toks: &[Tok<'_>], kind: Kind, from: usize, end: usize) -> Option<usize> {
    let mut depth = 0_usize;
    for (at, tok) in toks.iter().enumerate().take(end.min(from + crate::print::measure::WIDTH)).skip(from) {
        if depth == 0 && tok.kind == kind {
            return Some(at);
        }
        match tok.kind {
            Kind::LParen | Kind::LBracket | Kind::LBrace => depth += 1,
            Kind::RParen | Kind::RBracket | Kind::RBrace => depth = depth.saturating_sub(1),
            _ => {}
        }
    }
    None
}
