//! The steps of a plan's body, one by one: a bad step costs that step alone, also within the blocks of others.

use std::ops::Range;

use hrdsl_source::{Diagnostic, DiagnosticCode};

use super::RecoveringParser;
use crate::ast::{StepSyntax, StepSyntaxKind};
use crate::context::ParsedUnit;
use crate::run::run;
use crate::token::{Lexeme, TokenKind, TokenTrait};
use crate::{
    expected::ParseFault,
    report::{found, report},
};

impl RecoveringParser<'_, '_> {
    pub(super) fn steps(&mut self, block: Range<usize>) -> Vec<StepSyntax> {
        let mut steps = Vec::new();
        let mut at = block.start;
        while at < block.end {
            at = if self.tokens[at].kind == TokenKind::Semi {
                self.empty_step(&block, at)
            } else if let Some(next) = self.block_step(at, block.end, &mut steps) {
                next
            } else {
                self.plain_step(at, block.end, &mut steps)
            };
        }
        steps
    }

    // ── Steps without blocks ──

    /// Takes the step at `at` and gives where the next one starts.
    fn plain_step(&mut self, at: usize, end: usize, steps: &mut Vec<StepSyntax>) -> usize {
        let stop = self.end_of_step(at, end);
        let fault = match self.read(at..stop) {
            Ok(step) => {
                steps.extend(step);
                return stop + 1;
            }
            Err(fault) => fault,
        };
        let next = at + fault.at;
        if next > at
            && next < stop
            && fault.complete()
            && (starts_step(self.tokens[next].kind) || self.tokens[next].kind == TokenKind::Dot)
            && let Ok(step) = self.read(at..next)
        {
            steps.extend(step);
            if !self.is_full_stop(next) {
                self.missing_semicolon(next);
                return next;
            }
            self.full_stop(next);
            return next + 1 + usize::from(next + 1 == stop);
        }
        let next = self.resume_step(at, next, end);
        self.report(&fault, at..next);
        steps.push(StepSyntax { kind: StepSyntaxKind::Error, span: self.span(&(at..next)) });
        next + usize::from(next < end && self.tokens[next].kind == TokenKind::Semi)
    }

    /// Reads a step. The dot that it starts with is that of an internal action, whatever stands before it.
    fn read(&mut self, range: Range<usize>) -> Result<Option<StepSyntax>, ParseFault> {
        let mut tokens = self.tokens[range].to_vec();
        if let Some(first) = tokens.first_mut()
            && first.kind == TokenKind::Dot
        {
            first.kind = TokenKind::Internal;
        }
        match run(self.cx, Some(TokenKind::StartStep), &tokens)? {
            ParsedUnit::Step(step) => Ok(Some(step)),
            _ => Ok(None),
        }
    }

    pub(super) fn end_of_step(&self, at: usize, end: usize) -> usize {
        let mut depth = 0_usize;
        for i in at..end {
            match self.tokens[i].kind {
                TokenKind::LBrace => depth += 1,
                TokenKind::RBrace => depth = depth.saturating_sub(1),
                TokenKind::Semi if depth == 0 => return i,
                _ => {}
            }
        }
        end
    }

    /// Where a bad step ends that starts at `at` and stops to fit at `stop`: at its semicolon, or before a line that
    /// can be nothing but a step.
    fn resume_step(&self, at: usize, stop: usize, end: usize) -> usize {
        let mut depth = 0_usize;
        for i in at..end {
            let token = self.tokens[i];
            // A soft keyword that starts a line may have been taken for a name, as in `reach(` / `while x`.
            if depth == 0 && i + 1 >= stop && i > at && token.first && starts_only_steps(token.kind) {
                let before = self.tokens[i - 1].kind;
                if !before.continues() {
                    return i;
                }
            }
            match token.kind {
                TokenKind::LBrace => depth += 1,
                TokenKind::RBrace => depth = depth.saturating_sub(1),
                TokenKind::Semi if depth == 0 => return i,
                _ => {}
            }
        }
        end
    }

    /// Two semicolons, or one before the first step.
    fn empty_step(&mut self, block: &Range<usize>, at: usize) -> usize {
        let span = self.cx.span_of(self.tokens[at]);
        self.cx.diagnostics.push(
            Diagnostic::error(
                DiagnosticCode::SYNTAX,
                span,
                "expected a step such as `!goal` or `await`, found `;`",
            )
            .help("take the `;` away")
            .fix("take the `;` away", span, "", true),
        );
        (at..block.end).find(|i| self.tokens[*i].kind != TokenKind::Semi).unwrap_or(block.end)
    }

    fn missing_semicolon(&mut self, at: usize) {
        let token = self.tokens[at];
        if token.kind == TokenKind::Error {
            return;
        }
        let message = format!("expected `;`, found {}", found(token, self.cx.text));
        let span = self.cx.span_of(token);
        let before = self.tokens[at - 1];
        let last = self.cx.text_of(before).chars().next_back().map_or(0, char::len_utf8);
        let end = self.cx.span(before.end.saturating_sub(last as u32), before.end);
        // On a line of its own it can be nothing but the next step.
        let after = self.cx.span(before.end, before.end);
        self.cx.diagnostics.push(
            Diagnostic::error(DiagnosticCode::SYNTAX, span, message)
                .label(end, "the step before ends here")
                .help("put `;` between two steps of a plan")
                .fix("put `;` after the step before", after, ";", token.first),
        );
    }

    // ── Full stops, as AgentSpeak has them ──

    /// A dot that ends something: no name is right after it.
    pub(super) fn is_full_stop(&self, at: usize) -> bool {
        let named = |dot: &Lexeme| {
            self.tokens.get(at + 1).is_some_and(|next| next.start == dot.end && next.kind.is_word())
        };
        self.tokens.get(at).is_some_and(|dot| dot.kind == TokenKind::Dot && !named(dot))
    }

    pub(super) fn full_stop(&mut self, at: usize) {
        let span = self.cx.span_of(self.tokens[at]);
        self.cx.diagnostics.push(
            Diagnostic::error(DiagnosticCode::SYNTAX, span, "nothing ends with `.` here")
                .help("take the `.` away: steps are separated by `;`, and a plan ends with its `}`")
                .fix("take the `.` away", span, "", true),
        );
    }

    // ── Steps with blocks ──

    /// Takes the step at `at` if it is one with blocks, and gives where the next one starts.
    fn block_step(&mut self, at: usize, end: usize, steps: &mut Vec<StepSyntax>) -> Option<usize> {
        let blocks = self.blocks(at, end);
        let close = blocks.last()?.1;
        let step = match run(self.cx, Some(TokenKind::StartStep), &self.tokens[at..close + 1]) {
            Ok(ParsedUnit::Step(step)) => step,
            Ok(_) | Err(_) => self.broken_block_step(at, &blocks),
        };
        steps.push(step);
        let after = close + 1;
        Some(after + usize::from(after < end && self.tokens[after].kind == TokenKind::Semi))
    }

    /// The braces of the blocks of an `if`, `while`, `for` or `fork`; none if it is another step, or has no block.
    pub(super) fn blocks(&self, at: usize, end: usize) -> Vec<(usize, usize)> {
        let mut blocks = Vec::new();
        let word = self.tokens[at].kind;
        if !matches!(word, TokenKind::If | TokenKind::While | TokenKind::For | TokenKind::Fork) {
            return blocks;
        }
        let kind = |i: usize| if i < end { self.tokens[i].kind } else { TokenKind::End };
        let mut from = at + 1;
        while let Some((open, close)) = self.block_after(from, end) {
            blocks.push((open, close));
            from = match (word, kind(close + 1), kind(close + 2)) {
                (TokenKind::If, TokenKind::Else, TokenKind::If) => close + 3,
                (TokenKind::If, TokenKind::Else, TokenKind::LBrace)
                | (TokenKind::Fork, TokenKind::And | TokenKind::Or, TokenKind::LBrace) => close + 2,
                _ => break,
            };
        }
        blocks
    }

    /// The first block from here on: of choices in a condition the braces belong to the condition.
    fn block_after(&self, from: usize, end: usize) -> Option<(usize, usize)> {
        let mut choices = 0_usize;
        let mut at = from;
        while at < end {
            match self.tokens[at].kind {
                TokenKind::Semi => return None,
                TokenKind::If if at == from || self.tokens[at - 1].kind != TokenKind::Else => choices += 1,
                TokenKind::LBrace => {
                    let close = self.closing(at, end)?;
                    if choices == 0 {
                        return Some((at, close));
                    }
                    choices -= usize::from(self.tokens[at - 1].kind == TokenKind::Else);
                    at = close;
                }
                _ => {}
            }
            at += 1;
        }
        None
    }

    fn closing(&self, open: usize, end: usize) -> Option<usize> {
        let mut depth = 0_usize;
        (open..end).find(|i| {
            match self.tokens[*i].kind {
                TokenKind::LBrace => depth += 1,
                TokenKind::RBrace => depth -= 1,
                _ => {}
            }
            depth == 0
        })
    }

    /// Reads the step with empty blocks, and the steps of the blocks by themselves.
    fn broken_block_step(&mut self, at: usize, blocks: &[(usize, usize)]) -> StepSyntax {
        let shell = self.shell(at, blocks);
        let step = match run(self.cx, Some(TokenKind::StartStep), &shell) {
            Ok(ParsedUnit::Step(step)) => Some(step),
            Ok(_) => None,
            Err(fault) => {
                let next = blocks.last().and_then(|block| self.tokens.get(block.1 + 1)).copied();
                report(self.cx, &fault, &shell, next);
                None
            }
        };
        let mut bodies: Vec<Vec<StepSyntax>> =
            blocks.iter().map(|(open, close)| self.steps(open + 1..*close)).collect();
        bodies.reverse();
        match step {
            Some(StepSyntax { kind, span }) => StepSyntax { kind: filled(kind, &mut bodies), span },
            None => {
                let close = blocks.last().map_or(at, |block| block.1);
                StepSyntax { kind: StepSyntaxKind::Error, span: self.span(&(at..close + 1)) }
            }
        }
    }
}

/// The step with these bodies for its empty blocks; the first is the last of the list.
fn filled(kind: StepSyntaxKind, bodies: &mut Vec<Vec<StepSyntax>>) -> StepSyntaxKind {
    let mut next = || bodies.pop().unwrap_or_default();
    match kind {
        StepSyntaxKind::If { condition, otherwise, .. } => {
            let then = next();
            // Of an empty shell, only `else if` has a step.
            let otherwise = match otherwise.into_iter().next() {
                Some(StepSyntax { kind, span }) => vec![StepSyntax { kind: filled(kind, bodies), span }],
                None => next(),
            };
            StepSyntaxKind::If { condition, then, otherwise }
        }
        StepSyntaxKind::While { condition, .. } => StepSyntaxKind::While { condition, body: next() },
        StepSyntaxKind::For { condition, .. } => StepSyntaxKind::For { condition, body: next() },
        StepSyntaxKind::Fork { all, branches } => {
            StepSyntaxKind::Fork { all, branches: branches.iter().map(|_| next()).collect() }
        }
        plain @ (StepSyntaxKind::Do(_)
        | StepSyntaxKind::Achieve { .. }
        | StepSyntaxKind::Spawn(_)
        | StepSyntaxKind::Query(_)
        | StepSyntaxKind::Test(_)
        | StepSyntaxKind::Unify { .. }
        | StepSyntaxKind::Add(_)
        | StepSyntaxKind::Remove(_)
        | StepSyntaxKind::Replace(_)
        | StepSyntaxKind::Await { .. }
        | StepSyntaxKind::Wait(_)
        | StepSyntaxKind::Internal(_)
        | StepSyntaxKind::Error) => plain,
    }
}

/// A token that starts a step of a plan.
fn starts_step(kind: TokenKind) -> bool {
    kind.starts_call() || kind.is(TokenTrait::StartsStep)
}

/// A token that starts a step and, at the start of a line, is nothing else.
fn starts_only_steps(kind: TokenKind) -> bool {
    kind.is(TokenTrait::StartsOnlyStep)
}
