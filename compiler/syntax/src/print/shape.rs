//! Members and blocks: what the lines are made of.

use std::ops::Range;

use crate::print::marks::BlockKind;
use crate::print::trivia::PrintToken;

/// A declaration, a member, a step, an element.
#[derive(Debug)]
pub(super) struct MemberShape {
    /// Its first token.
    pub first: usize,
    /// After its last token.
    pub end: usize,
    pub parts: Vec<MemberPart>,
}

/// A piece of a member.
#[derive(Debug)]
pub(super) enum MemberPart {
    /// Tokens outside blocks.
    Run(Range<usize>),
    Block(BlockShape),
}

/// `{ … }`
#[derive(Debug)]
pub(super) struct BlockShape {
    pub kind: BlockKind,
    pub open: usize,
    pub close: usize,
    pub members: Vec<MemberShape>,
}

/// The declarations of a file.
pub(super) fn members(toks: &[PrintToken<'_>]) -> Vec<MemberShape> {
    within(toks, 0, toks.len().saturating_sub(1))
}

/// The members from one token to another. Brackets nest no deeper than the parser lets them.
fn within(toks: &[PrintToken<'_>], from: usize, to: usize) -> Vec<MemberShape> {
    let mut members = Vec::new();
    let mut at = from;
    while at < to {
        let member = member(toks, at, to);
        at = member.end;
        members.push(member);
    }
    members
}

fn member(toks: &[PrintToken<'_>], first: usize, to: usize) -> MemberShape {
    let mut parts = Vec::new();
    let (mut run, mut at) = (first, first);
    while at < to && (at == first || !toks[at].mark.start) {
        let Some(kind) = toks[at].mark.block else {
            at += 1;
            continue;
        };
        if run < at {
            parts.push(MemberPart::Run(run..at));
        }
        let close = toks[at].close.clamp(at, to);
        parts.push(MemberPart::Block(BlockShape {
            kind,
            open: at,
            close,
            members: within(toks, at + 1, close),
        }));
        at = close + 1;
        run = at;
    }
    if run < at {
        parts.push(MemberPart::Run(run..at));
    }
    MemberShape { first, end: at, parts }
}
