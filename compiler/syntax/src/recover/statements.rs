//! The statements of a function, one by one: a bad one costs that one alone, also within the blocks of others.

use std::ops::Range;

use hrdsl_source::{Diagnostic, DiagnosticCode};

use super::RecoveringParser;
use crate::ast::{
    AutomatonMember, AutomatonMemberKind, FunctionSyntax, StatementSyntax, StatementSyntaxKind,
};
use crate::context::ParsedUnit;
use crate::run::run;
use crate::token::TokenKind;
use crate::{
    expected::ParseFault,
    report::{found, report},
};

impl RecoveringParser<'_, '_> {
    /// A function of an automaton whose header or body is broken.
    pub(super) fn function(&mut self, range: &Range<usize>) -> Option<ParsedUnit> {
        let (open, close) = self.pairs(range).pop()?;
        let shell = self.shell(range.start, &[(open, close)]);
        let unit = match run(self.cx, Some(TokenKind::StartAutomatonMember), &shell) {
            Ok(unit) => Some(unit),
            Err(fault) => {
                report(self.cx, &fault, &shell, None);
                None
            }
        };
        let body = self.statements(open + 1..close);
        match unit {
            Some(ParsedUnit::AutomatonMember(AutomatonMember {
                doc,
                kind: AutomatonMemberKind::Function(function),
                ..
            })) => {
                let kind = AutomatonMemberKind::Function(FunctionSyntax { body, ..function });
                let span = self.span(&(range.start..close + 1));
                Some(ParsedUnit::AutomatonMember(AutomatonMember { doc, kind, span }))
            }
            _ => None,
        }
    }

    pub(super) fn statements(&mut self, block: Range<usize>) -> Vec<StatementSyntax> {
        let mut statements = Vec::new();
        let mut at = block.start;
        while at < block.end {
            at = if self.tokens[at].kind == TokenKind::Semi {
                self.empty_statement(&block, at)
            } else if let Some(next) = self.block_statement(at, block.end, &mut statements) {
                next
            } else {
                self.plain_statement(at, block.end, &mut statements)
            };
        }
        statements
    }

    /// Takes the statement at `at` and gives where the next one starts.
    fn plain_statement(&mut self, at: usize, end: usize, statements: &mut Vec<StatementSyntax>) -> usize {
        let stop = self.end_of_step(at, end);
        let fault = match run(self.cx, Some(TokenKind::StartStatement), &self.tokens[at..stop]) {
            Ok(ParsedUnit::Statement(statement)) => {
                statements.push(statement);
                return stop + 1;
            }
            Ok(_) => return stop + 1,
            Err(fault) => fault,
        };
        let next = at + fault.at;
        if next > at
            && next < stop
            && fault.complete()
            && starts_statement(self.tokens[next].kind)
            && let Ok(ParsedUnit::Statement(statement)) =
                run(self.cx, Some(TokenKind::StartStatement), &self.tokens[at..next])
        {
            statements.push(statement);
            self.missing_separator(next);
            return next;
        }
        let next = self.resume_statement(at, next, end);
        self.said_of_statement(&fault, at..next);
        statements.push(StatementSyntax { kind: StatementSyntaxKind::Error, span: self.span(&(at..next)) });
        next + usize::from(next < end && self.tokens[next].kind == TokenKind::Semi)
    }

    fn said_of_statement(&mut self, fault: &ParseFault, range: Range<usize>) {
        let next = self.tokens.get(range.end).copied();
        report(self.cx, fault, &self.tokens[range], next);
    }

    /// Where a bad statement ends that starts at `at` and stops to fit at `stop`: at its semicolon, or before a line
    /// that can be nothing but a statement.
    fn resume_statement(&self, at: usize, stop: usize, end: usize) -> usize {
        let mut depth = 0_usize;
        for i in at..end {
            let token = self.tokens[i];
            if depth == 0 && i + 1 >= stop && i > at && token.first && starts_only_statements(token.kind) {
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

    /// Two semicolons, or one before the first statement.
    fn empty_statement(&mut self, block: &Range<usize>, at: usize) -> usize {
        let span = self.cx.span_of(self.tokens[at]);
        self.cx.diagnostics.push(
            Diagnostic::error(
                DiagnosticCode::SYNTAX,
                span,
                "expected a statement such as `n = 1` or `return`, found `;`",
            )
            .help("take the `;` away")
            .fix("take the `;` away", span, "", true),
        );
        (at..block.end).find(|i| self.tokens[*i].kind != TokenKind::Semi).unwrap_or(block.end)
    }

    fn missing_separator(&mut self, at: usize) {
        let token = self.tokens[at];
        if token.kind == TokenKind::Error {
            return;
        }
        let message = format!("expected `;`, found {}", found(token, self.cx.text));
        let span = self.cx.span_of(token);
        let before = self.tokens[at - 1];
        let after = self.cx.span(before.end, before.end);
        self.cx.diagnostics.push(
            Diagnostic::error(DiagnosticCode::SYNTAX, span, message)
                .help("put `;` between two statements of a function; none is needed after a block")
                .fix("put `;` after the statement before", after, ";", token.first),
        );
    }

    /// Takes the statement at `at` if it is one with blocks, and gives where the next one starts.
    fn block_statement(
        &mut self,
        at: usize,
        end: usize,
        statements: &mut Vec<StatementSyntax>,
    ) -> Option<usize> {
        let blocks = self.blocks(at, end);
        let close = blocks.last()?.1;
        let statement = match run(self.cx, Some(TokenKind::StartStatement), &self.tokens[at..close + 1]) {
            Ok(ParsedUnit::Statement(statement)) => statement,
            Ok(_) | Err(_) => self.broken_block_statement(at, &blocks),
        };
        statements.push(statement);
        let after = close + 1;
        Some(after + usize::from(after < end && self.tokens[after].kind == TokenKind::Semi))
    }

    /// Reads the statement with empty blocks, and the statements of the blocks by themselves.
    fn broken_block_statement(&mut self, at: usize, blocks: &[(usize, usize)]) -> StatementSyntax {
        let shell = self.shell(at, blocks);
        let statement = match run(self.cx, Some(TokenKind::StartStatement), &shell) {
            Ok(ParsedUnit::Statement(statement)) => Some(statement),
            Ok(_) => None,
            Err(fault) => {
                let next = blocks.last().and_then(|block| self.tokens.get(block.1 + 1)).copied();
                report(self.cx, &fault, &shell, next);
                None
            }
        };
        let mut bodies: Vec<Vec<StatementSyntax>> =
            blocks.iter().map(|(open, close)| self.statements(open + 1..*close)).collect();
        bodies.reverse();
        match statement {
            Some(StatementSyntax { kind, span }) => StatementSyntax { kind: filled(kind, &mut bodies), span },
            None => {
                let close = blocks.last().map_or(at, |block| block.1);
                StatementSyntax { kind: StatementSyntaxKind::Error, span: self.span(&(at..close + 1)) }
            }
        }
    }
}

/// The statement with these bodies for its empty blocks; the first is the last of the list.
fn filled(kind: StatementSyntaxKind, bodies: &mut Vec<Vec<StatementSyntax>>) -> StatementSyntaxKind {
    let mut next = || bodies.pop().unwrap_or_default();
    match kind {
        StatementSyntaxKind::If { condition, otherwise, .. } => {
            let then = next();
            // Of an empty shell, only `else if` has a statement.
            let otherwise = match otherwise.into_iter().next() {
                Some(StatementSyntax { kind, span }) => {
                    vec![StatementSyntax { kind: filled(kind, bodies), span }]
                }
                None => next(),
            };
            StatementSyntaxKind::If { condition, then, otherwise }
        }
        StatementSyntaxKind::While { condition, .. } => {
            StatementSyntaxKind::While { condition, body: next() }
        }
        StatementSyntaxKind::For { name, range, .. } => {
            StatementSyntaxKind::For { name, range, body: next() }
        }
        plain @ (StatementSyntaxKind::Var(_)
        | StatementSyntaxKind::Assign { .. }
        | StatementSyntaxKind::Call(_)
        | StatementSyntaxKind::Return(_)
        | StatementSyntaxKind::Error) => plain,
    }
}

fn starts_statement(kind: TokenKind) -> bool {
    kind.starts_call() || matches!(kind, TokenKind::Var | TokenKind::If | TokenKind::Return)
}

/// A token that starts a statement and, at the start of a line, is nothing else.
fn starts_only_statements(kind: TokenKind) -> bool {
    matches!(kind, TokenKind::Var | TokenKind::If | TokenKind::While | TokenKind::For | TokenKind::Return)
}
