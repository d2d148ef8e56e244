//! Tokens to one run for each declaration: where it starts, where its block ends, and that it is not nested too deep.
//!
//! Missing closing braces are put in where the next declaration or member shows that they are missing, so that the runs
//! are balanced and a fault in one cannot reach the next.

use hrdsl_source::{Diagnostic, DiagnosticCode, FileId, Span};

use crate::heads::{has_its_rest, wants_a_name};
use crate::report::{found, nearest};
use crate::token::{KEYWORDS, KeywordClass, Lexeme, TokenKind};

/// Brackets within brackets, in one declaration.
pub const MAX_NESTING: usize = 128;

/// Levels of an expression: operators that wait for each other, and brackets.
pub const MAX_HEIGHT: u32 = 512;

/// What a run of tokens is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ChunkKind {
    /// A declaration; starts with its keyword.
    Item,
    /// Text outside every declaration, or nested beyond the limit: reported, not to be read.
    Unread,
}

/// The tokens of one declaration.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DeclarationChunk {
    pub sort: ChunkKind,
    pub start: usize,
    pub end: usize,
}

/// The tokens of a file, braces balanced, and its declarations.
pub(crate) struct FileOutline {
    pub tokens: Vec<Lexeme>,
    pub chunks: Vec<DeclarationChunk>,
}

/// Splits the tokens of a file into declarations.
pub(crate) fn outline(
    file: FileId,
    text: &str,
    tokens: &[Lexeme],
    diagnostics: &mut Vec<Diagnostic>,
) -> FileOutline {
    let mut splitter = DeclarationSplitter {
        file,
        text,
        input: tokens,
        out: Vec::with_capacity(tokens.len() + 8),
        chunks: Vec::new(),
        diagnostics,
        current: None,
        brackets: Vec::new(),
        braces: 0,
    };
    for i in 0..tokens.len() {
        splitter.token(i);
    }
    splitter.close_braces(0, None);
    splitter.finish();
    FileOutline { tokens: splitter.out, chunks: splitter.chunks }
}

/// A declaration that has begun.
#[derive(Clone, Copy)]
struct OpenChunk {
    sort: ChunkKind,
    head: TokenKind,
    start: usize,
}

/// An open bracket, and the heights of the expressions in it. The first is the declaration itself.
#[derive(Clone, Copy, Default)]
struct OpenBracket {
    brace: bool,
    /// Where it is in the output.
    at: usize,
    /// Operators of the expression that is being read.
    operators: u32,
    /// The highest bracket in it.
    child: u32,
    /// The highest expression before it.
    highest: u32,
    /// What is being read belongs to an element: `.x` after `a[0]`.
    element: bool,
}

impl OpenBracket {
    fn end_of_expression(&mut self) {
        self.highest = self.highest.max(self.operators + self.child);
        self.operators = 0;
        self.child = 0;
    }
}

struct DeclarationSplitter<'t> {
    file: FileId,
    text: &'t str,
    input: &'t [Lexeme],
    out: Vec<Lexeme>,
    chunks: Vec<DeclarationChunk>,
    diagnostics: &'t mut Vec<Diagnostic>,
    /// `None`: between two declarations.
    current: Option<OpenChunk>,
    brackets: Vec<OpenBracket>,
    /// How many of the brackets are braces.
    braces: usize,
}

impl DeclarationSplitter<'_> {
    fn token(&mut self, i: usize) {
        let mut token = self.input[i];
        if self.starts_item(i) {
            self.close_braces(0, Some(token));
            self.begin(ChunkKind::Item, token);
        } else if self.braces >= 2 && self.starts_member(i) {
            self.close_braces(1, Some(token));
        } else if self.braces == 0 {
            match self.outside(i) {
                OutsideTokenRole::Skip => return,
                OutsideTokenRole::Keep => {}
                OutsideTokenRole::Head(kind) => {
                    token.kind = kind;
                    self.begin(ChunkKind::Item, token);
                }
                OutsideTokenRole::Stray => {
                    self.stray(token);
                    self.begin(ChunkKind::Unread, token);
                }
            }
        }
        self.measure(token, i);
        self.out.push(token);
        self.bracket(token);
    }

    fn begin(&mut self, sort: ChunkKind, token: Lexeme) {
        self.finish();
        self.current = Some(OpenChunk { sort, head: token.kind, start: self.out.len() });
        self.brackets.push(OpenBracket::default());
    }

    /// Ends the current declaration.
    fn finish(&mut self) {
        if let Some(OpenChunk { sort, start, .. }) = self.current.take() {
            self.chunks.push(DeclarationChunk { sort, start, end: self.out.len() });
        }
        self.brackets.clear();
        self.braces = 0;
    }

    fn kind(&self, i: usize) -> Option<TokenKind> {
        self.input.get(i).map(|t| t.kind)
    }

    fn before(&self, i: usize) -> Option<TokenKind> {
        i.checked_sub(1).and_then(|i| self.kind(i))
    }

    // ── Where declarations start ──

    /// A head keyword in a place where a declaration can start, or must have been meant to.
    fn starts_item(&self, i: usize) -> bool {
        let token = self.input[i];
        if !token.kind.is_head() {
            return false;
        }
        let Some(before) = self.before(i) else { return true };
        if matches!(before, TokenKind::Colon | TokenKind::Dot) {
            return false;
        }
        let rest = has_its_rest(self.input, i);
        if self.braces == 0 {
            return self.current.is_none() || self.ends_before(i, before, rest);
        }
        // A declaration with a fault: its name is on its line. `with` follows the name of a stimulus.
        let named = self
            .input
            .get(i + 1)
            .is_some_and(|next| next.kind.is_word() && next.kind != TokenKind::With && !next.first);
        let belongs = match token.kind {
            TokenKind::Var => self.current.is_some_and(|c| {
                c.sort == ChunkKind::Unread || matches!(c.head, TokenKind::Automaton | TokenKind::Fn)
            }),
            TokenKind::Fn => {
                self.current.is_some_and(|c| c.sort == ChunkKind::Unread || c.head == TokenKind::Automaton)
            }
            TokenKind::Part => self.kind(i + 2) == Some(TokenKind::Assign),
            TokenKind::Allow => true,
            _ => false,
        };
        token.first && (rest || named) && !before.continues() && !belongs
    }

    /// Whether the current declaration, of which no brace is open, ends before the head keyword at `i`.
    fn ends_before(&self, i: usize, before: TokenKind, rest: bool) -> bool {
        let token = self.input[i];
        if self.brackets.len() > 1 && before.continues() {
            return false;
        }
        // In `at most 4 test` the word after the number is an event.
        let counted = i.checked_sub(2).is_some_and(|i| self.input[i].kind == TokenKind::Most);
        let named = self.current.is_some_and(|c| c.start + 1 == self.out.len());
        if named || counted {
            return rest && token.first;
        }
        if wants_a_name(before) {
            // On the same line it is one after the name that ends the declaration before.
            let after_name = before.starts_call() && before != token.kind && token.kind != TokenKind::World;
            return rest && (token.first || after_name);
        }
        let head = before.is_head() && before != token.kind;
        token.first || before == TokenKind::Semi || (before.ends_operand() || head) && rest
    }

    /// A member that cannot be inside another one: the brace of the one before is missing.
    fn starts_member(&self, i: usize) -> bool {
        let token = self.input[i];
        if !token.first || self.before(i).is_some_and(TokenKind::continues) {
            return false;
        }
        let next = self.kind(i + 1);
        match (self.current.map(|c| c.head), token.kind) {
            (Some(TokenKind::Agent), TokenKind::Plan) => {
                matches!(next, Some(TokenKind::Plus | TokenKind::Minus | TokenKind::On | TokenKind::At_))
            }
            (Some(TokenKind::Agent), TokenKind::Goal) => {
                next.is_some_and(|k| k == TokenKind::Bang || k.can_be_name())
            }
            (Some(TokenKind::Agent), TokenKind::Belief) => next.is_some_and(TokenKind::can_be_name),
            (Some(TokenKind::Agent), TokenKind::Rule) => {
                next.is_some_and(|k| k == TokenKind::Tilde || k.can_be_name())
            }
            (Some(TokenKind::Automaton), TokenKind::From) => true,
            (
                Some(TokenKind::Automaton),
                TokenKind::Location | TokenKind::Init | TokenKind::Committed | TokenKind::Urgent,
            ) => next.is_some_and(TokenKind::can_be_name),
            (_, _) => false,
        }
    }

    /// What a token is that no brace holds and that is no head keyword.
    fn outside(&mut self, i: usize) -> OutsideTokenRole {
        let token = self.input[i];
        match self.current {
            None => match token.kind {
                TokenKind::Semi => OutsideTokenRole::Skip,
                TokenKind::RBrace => {
                    let span = self.span(token);
                    self.diagnostics.push(
                        Diagnostic::error(DiagnosticCode::SYNTAX, span, "this `}` closes nothing")
                            .help("take it away, or look for a `{` that is missing before it")
                            .fix("take the `}` away", span, "", false),
                    );
                    OutsideTokenRole::Skip
                }
                _ => self.misspelt(i).map_or(OutsideTokenRole::Stray, OutsideTokenRole::Head),
            },
            Some(current) => {
                if token.kind == TokenKind::Semi
                    && current.sort == ChunkKind::Item
                    && self.brackets.len() <= 1
                {
                    self.finish();
                    return OutsideTokenRole::Skip;
                }
                let ended = self.before(i).is_some_and(TokenKind::ends_operand);
                let named = self.kind(i + 1) == Some(TokenKind::Ident);
                if token.first && ended && named && current.head != TokenKind::Assume {
                    return self.misspelt(i).map_or(OutsideTokenRole::Keep, OutsideTokenRole::Head);
                }
                OutsideTokenRole::Keep
            }
        }
    }

    /// A word that is nearly a head keyword and has the look of one: it is read as that keyword.
    fn misspelt(&mut self, i: usize) -> Option<TokenKind> {
        let token = self.input[i];
        let next = self.input.get(i + 1)?;
        if token.kind != TokenKind::Ident
            || next.first
            || !(next.kind.is_word() || next.kind == TokenKind::LBrace)
        {
            return None;
        }
        let word = &self.text[token.start as usize..token.end as usize];
        let heads = KEYWORDS.iter().filter(|k| k.class == KeywordClass::Head);
        let near = nearest(word, heads.clone().map(|k| k.word))?;
        let kind = heads.into_iter().find(|k| k.word == near)?.kind;
        let span = self.span(token);
        self.diagnostics.push(
            Diagnostic::error(
                DiagnosticCode::SYNTAX,
                span,
                format!("expected a declaration, found `{word}`"),
            )
            .here("no declaration starts with this word")
            .help(format!("did you mean `{near}`?"))
            .fix(format!("replace `{word}` by `{near}`"), span, near, false),
        );
        Some(kind)
    }

    fn stray(&mut self, token: Lexeme) {
        if token.kind == TokenKind::Error {
            return;
        }
        let what = found(token, self.text);
        let span = self.span(token);
        let message = format!("expected a declaration such as `event` or `agent`, found {what}");
        self.diagnostics.push(Diagnostic::error(DiagnosticCode::SYNTAX, span, message));
    }

    fn span(&self, token: Lexeme) -> Span {
        Span { file: self.file, start: token.start, end: token.end }
    }

    // ── Brackets ──

    fn bracket(&mut self, token: Lexeme) {
        match token.kind {
            TokenKind::LBrace | TokenKind::LParen | TokenKind::LBracket => {
                let brace = token.kind == TokenKind::LBrace;
                self.braces += usize::from(brace);
                self.brackets.push(OpenBracket { brace, at: self.out.len() - 1, ..OpenBracket::default() });
                if self.brackets.len() > MAX_NESTING + 1 {
                    self.too_deep(token, &format!("brackets are nested more than {MAX_NESTING} levels deep"));
                }
            }
            TokenKind::RParen | TokenKind::RBracket
                if self.brackets.len() > 1 && self.brackets.last().is_some_and(|b| !b.brace) =>
            {
                self.pop(token);
            }
            TokenKind::RBrace => self.close(token),
            _ => {}
        }
    }

    /// Closes the innermost brace, and the parentheses that were forgotten in it.
    fn close(&mut self, token: Lexeme) {
        if self.braces == 0 {
            return;
        }
        while self.brackets.last().is_some_and(|b| !b.brace) && self.brackets.len() > 1 {
            self.pop(token);
        }
        self.pop(token);
        self.braces -= 1;
        let block = self.current.is_some_and(|c| c.sort == ChunkKind::Item && c.head.has_block());
        if self.braces == 0 && block {
            self.finish();
        }
    }

    fn pop(&mut self, token: Lexeme) {
        let Some(inner) = self.brackets.pop() else { return };
        let height = inner.highest.max(inner.operators + inner.child) + 1;
        if let Some(outer) = self.brackets.last_mut() {
            outer.child = outer.child.max(height);
            outer.element = token.kind == TokenKind::RBracket;
        }
        self.limit(token);
    }

    /// Puts in the closing braces that are missing before `next`, until `keep` braces are open.
    fn close_braces(&mut self, keep: usize, next: Option<Lexeme>) {
        if self.braces <= keep {
            return;
        }
        let missing = self.braces - keep;
        let end = self.out.last().map_or(0, |t| t.end);
        let opener = self.brackets.iter().rev().find(|b| b.brace).map(|b| self.out[b.at]);
        let closing = if missing == 1 { "a `}` is".to_owned() } else { format!("{missing} `}}` are") };
        let place = next.map_or("the end of the file".to_owned(), |t| found(t, self.text));
        let here = next.map_or(Span { file: self.file, start: end, end }, |t| self.span(t));
        let mut diagnostic =
            Diagnostic::error(DiagnosticCode::SYNTAX, here, format!("{closing} missing before {place}"));
        if let Some(opener) = opener {
            diagnostic = diagnostic.label(self.span(opener), "this `{` is not closed");
        }
        self.diagnostics.push(diagnostic.help("put `}` where the block ends"));
        while self.braces > keep {
            let brace = Lexeme::synthetic(TokenKind::RBrace, end);
            self.out.push(brace);
            self.close(brace);
        }
    }

    // ── Height ── the tree of an expression is walked by recursion, so it must not be too high.

    /// Counts the operators that wait for each other; where an operand follows an operand, a new expression starts.
    fn measure(&mut self, token: Lexeme, i: usize) {
        let after_operand = self.before(i).is_some_and(TokenKind::ends_operand);
        let Some(top) = self.brackets.last_mut() else { return };
        top.element = match token.kind {
            TokenKind::Dot => top.element,
            kind => top.element && kind.can_be_name(),
        };
        // `a[0][0].x` is as high as it has indices and names after them.
        let part = match token.kind {
            TokenKind::LBracket => after_operand || self.before(i).is_some_and(TokenKind::can_be_name),
            TokenKind::Dot => top.element,
            _ => false,
        };
        // `if` after a block or operand, and the words between the branches of a fork, are no operators of what is before.
        let step = match token.kind {
            TokenKind::If => after_operand,
            TokenKind::And | TokenKind::Or => self.kind(i + 1) == Some(TokenKind::LBrace),
            _ => false,
        };
        let Some(top) = self.brackets.last_mut() else { return };
        if step {
            top.end_of_expression();
        }
        if token.kind.is_operator() || part {
            top.operators += 1;
            self.limit(token);
            return;
        }
        let boundary = match token.kind {
            TokenKind::Comma
            | TokenKind::Semi
            | TokenKind::Colon
            | TokenKind::Pipe
            | TokenKind::Assign
            | TokenKind::From => true,
            TokenKind::True
            | TokenKind::False
            | TokenKind::Else
            | TokenKind::LParen
            | TokenKind::LBracket => false,
            // Where an operand is missing, a word is one.
            kind => {
                let word = matches!(kind.class(), Some(KeywordClass::Head | KeywordClass::Hard));
                after_operand && (word || kind.starts_operand())
            }
        };
        if boundary {
            top.end_of_expression();
        }
    }

    fn limit(&mut self, token: Lexeme) {
        if self.brackets.last().is_some_and(|top| top.operators + top.child > MAX_HEIGHT) {
            self.too_deep(token, &format!("the expression is more than {MAX_HEIGHT} levels high"));
        }
    }

    /// Reports the first place of a declaration that is nested too deep, and gives the declaration up.
    fn too_deep(&mut self, token: Lexeme, message: &str) {
        let span = self.span(token);
        if let Some(current) = &mut self.current
            && current.sort == ChunkKind::Item
        {
            current.sort = ChunkKind::Unread;
            self.diagnostics.push(
                Diagnostic::error(DiagnosticCode::TOO_DEEP, span, message)
                    .help("name parts of it with `const`, or divide it into several declarations"),
            );
        }
    }
}

enum OutsideTokenRole {
    /// Belongs to nothing.
    Skip,
    /// Belongs to the current declaration.
    Keep,
    /// Starts a declaration: a misspelt keyword.
    Head(TokenKind),
    /// Starts text that no declaration holds.
    Stray,
}
