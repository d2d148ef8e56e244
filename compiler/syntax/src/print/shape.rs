//! Members and blocks: what the lines are made of.

use std::ops::Range;

use crate::print::marks::BlockKind;
use crate::print::trivia::Tok;

/// A declaration, a member, a step, an element.
#[derive(Debug)]
pub(super) struct Member {
    /// Its first token.
    pub first: usize,
    /// After its last token.
    pub end: usize,
    pub parts: Vec<Part>,
}

/// A piece of a member.
#[derive(Debug)]
pub(super) enum Part {
    /// Tokens outside blocks.
    Run(Range<usize>),
    Block(Block),
}

/// `{ … }`
#[derive(Debug)]
pub(super) struct Block {
    pub kind: BlockKind,
    pub open: usize,
    pub close: usize,
    pub members: Vec<Member>,
}

/// The declarations of a file.
pub(super) fn members(toks: &[Tok<'_>]) -> Vec<Member> {
    within(toks, 0, toks.len().saturating_sub(1))
}

/// The members from one token to another. Brackets nest no deeper than the parser lets them.
fn within(toks: &[Tok<'_>], from: usize, to: usize) -> Vec<Member> {
    let mut members = Vec::new();
    let mut at = from;
    while at < to {
        let member = member(toks, at, to);
        at = member.end;
        members.push(member);
    }
    members
}

fn member(toks: &[Tok<'_>], first: usize, to: usize) -> Member {
    let mut parts = Vec::new();
    let (mut run, mut at) = (first, first);
    while at < to && (at == first || !toks[at].mark.start) {
        let Some(kind) = toks[at].mark.block else {
            at += 1;
            continue;
        };
        if run < at {
            parts.push(Part::Run(run..at));
        }
        let close = toks[at].close.clamp(at, to);
        parts.push(Part::Block(Block { kind, open: at, close, members: within(toks, at + 1, close) }));
        at = close + 1;
        run = at;
    }
    if run < at {
        parts.push(Part::Run(run..at));
    }
    Member { first, end: at, parts }
}
