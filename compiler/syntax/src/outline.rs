//! Tokens to one run for each declaration: where it starts, where its block ends, and that it is not nested too deep.
//!
//! Missing closing braces are put in where the next declaration or member shows that they are missing, so that the runs
//! are balanced and a fault in one cannot reach the next.

use hrdsl_source::{Diagnostic, DiagnosticCode, FileId, Span};

use crate::heads::{has_its_rest, wants_a_name};
use crate::report::{found, nearest};
use crate::token::{Class, KEYWORDS, Kind, Lexeme};

/// Brackets within brackets, in one declaration.
pub const MAX_NESTING: usize = 128;

/// Levels of an expression: operators that wait for each other, and brackets.
pub const MAX_HEIGHT: u32 = 512;

/// What a run of tokens is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sort {
    /// A declaration; starts with its keyword.
    Item,
    /// Text outside every declaration, or nested beyond the limit: reported, not to be read.
    Unread,
}

/// The tokens of one declaration.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chunk {
    pub sort: Sort,
    pub start: usize,
    pub end: usize,
}

/// The tokens of a file, braces balanced, and its declarations.
pub(crate) struct Outline {
    pub tokens: Vec<Lexeme>,
    pub chunks: Vec<Chunk>,
}

/// Splits the tokens of a file into declarations.
pub(crate) fn outline(
    file: FileId,
    text: &str,
    tokens: &[Lexeme],
    diagnostics: &mut Vec<Diagnostic>,
) -> Outline {
    let mut splitter = Splitter {
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
    Outline { tokens: splitter.out, chunks: splitter.chunks }
}

/// A declaration that has begun.
#[derive(Clone, Copy)]
struct Current {
    sort: Sort,
    head: Kind,
    start: usize,
}

/// An open bracket, and the heights of the expressions in it. The first is the declaration itself.
#[derive(Clone, Copy, Default)]
struct Bracket {
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

impl Bracket {
    fn end_of_expression(&mut self) {
        self.highest = self.highest.max(self.operators + self.child);
        self.operators = 0;
        self.child = 0;
    }
}

struct Splitter<'t> {
    file: FileId,
    text: &'t str,
    input: &'t [Lexeme],
    out: Vec<Lexeme>,
    chunks: Vec<Chunk>,
    diagnostics: &'t mut Vec<Diagnostic>,
    /// `None`: between two declarations.
    current: Option<Current>,
    brackets: Vec<Bracket>,
    /// How many of the brackets are braces.
    braces: usize,
}

impl Splitter<'_> {
    fn token(&mut self, i: usize) {
        let mut token = self.input[i];
        if self.starts_item(i) {
            self.close_braces(0, Some(token));
            self.begin(Sort::Item, token);
        } else if self.braces >= 2 && self.starts_member(i) {
            self.close_braces(1, Some(token));
        } else if self.braces == 0 {
            match self.outside(i) {
                Outside::Skip => return,
                Outside::Keep => {}
                Outside::Head(kind) => {
                    token.kind = kind;
                    self.begin(Sort::Item, token);
                }
                Outside::Stray => {
                    self.stray(token);
                    self.begin(Sort::Unread, token);
                }
            }
        }
        self.measure(token, i);
        self.out.push(token);
        self.bracket(token);
    }

    fn begin(&mut self, sort: Sort, token: Lexeme) {
        self.finish();
        self.current = Some(Current { sort, head: token.kind, start: self.out.len() });
        self.brackets.push(Bracket::default());
    }

    /// Ends the current declaration.
    fn finish(&mut self) {
        if let Some(Current { sort, start, .. }) = self.current.take() {
            self.chunks.push(Chunk { sort, start, end: self.out.len() });
        }
        self.brackets.clear();
        self.braces = 0;
    }

    fn kind(&self, i: usize) -> Option<Kind> {
        self.input.get(i).map(|t| t.kind)
    }

    fn before(&self, i: usize) -> Option<Kind> {
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
        if matches!(before, Kind::Colon | Kind::Dot) {
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
            .is_some_and(|next| next.kind.is_word() && next.kind != Kind::With && !next.first);
        let belongs = match token.kind {
            Kind::Var => self
                .current
                .is_some_and(|c| c.sort == Sort::Unread || matches!(c.head, Kind::Automaton | Kind::Fn)),
            Kind::Fn => self.current.is_some_and(|c| c.sort == Sort::Unread || c.head == Kind::Automaton),
            Kind::Part => self.kind(i + 2) == Some(Kind::Assign),
            Kind::Allow => true,
            _ => false,
        };
        token.first && (rest || named) && !before.continues() && !belongs
    }

    /// Whether the current declaration, of which no brace is open, ends before the head keyword at `i`.
    fn ends_before(&self, i: usize, before: Kind, rest: bool) -> bool {
        let token = self.input[i];
        if self.brackets.len() > 1 && before.continues() {
            return false;
        }
        // In `at most 4 test` the word after the number is an event.
        let counted = i.checked_sub(2).is_some_and(|i| self.input[i].kind == Kind::Most);
        let named = self.current.is_some_and(|c| c.start + 1 == self.out.len());
        if named || counted {
            return rest && token.first;
        }
        if wants_a_name(before) {
            // On the same line it is one after the name that ends the declaration before.
            let after_name = before.starts_call() && before != token.kind && token.kind != Kind::World;
            return rest && (token.first || after_name);
        }
        let head = before.is_head() && before != token.kind;
        token.first || before == Kind::Semi || (before.ends_operand() || head) && rest
    }

    /// A member that cannot be inside another one: the brace of the one before is missing.
    fn starts_member(&self, i: usize) -> bool {
        let token = self.input[i];
        if !token.first || self.before(i).is_some_and(Kind::continues) {
            return false;
        }
        let next = self.kind(i + 1);
        match (self.current.map(|c| c.head), token.kind) {
            (Some(Kind::Agent), Kind::Plan) => {
                matches!(next, Some(Kind::Plus | Kind::Minus | Kind::On | Kind::At_))
            }
            (Some(Kind::Agent), Kind::Goal) => next.is_some_and(|k| k == Kind::Bang || k.can_be_name()),
            (Some(Kind::Agent), Kind::Belief) => next.is_some_and(Kind::can_be_name),
            (Some(Kind::Agent), Kind::Rule) => next.is_some_and(|k| k == Kind::Tilde || k.can_be_name()),
            (Some(Kind::Automaton), Kind::From) => true,
            (Some(Kind::Automaton), Kind::Location | Kind::Init | Kind::Committed | Kind::Urgent) => {
                next.is_some_and(Kind::can_be_name)
            }
            (_, _) => false,
        }
    }

    /// What a token is that no brace holds and that is no head keyword.
    fn outside(&mut self, i: usize) -> Outside {
        let token = self.input[i];
        match self.current {
            None => match token.kind {
                Kind::Semi => Outside::Skip,
                Kind::RBrace => {
                    let span = self.span(token);
                    self.diagnostics.push(
                        Diagnostic::error(DiagnosticCode::SYNTAX, span, "this `}` closes nothing")
                            .help("take it away, or look for a `{` that is missing before it")
                            .fix("take the `}` away", span, "", false),
                    );
                    Outside::Skip
                }
                _ => self.misspelt(i).map_or(Outside::Stray, Outside::Head),
            },
            Some(current) => {
                if token.kind == Kind::Semi && current.sort == Sort::Item && self.brackets.len() <= 1 {
                    self.finish();
                    return Outside::Skip;
                }
                let ended = self.before(i).is_some_and(Kind::ends_operand);
                let named = self.kind(i + 1) == Some(Kind::Ident);
                if token.first && ended && named && current.head != Kind::Assume {
                    return self.misspelt(i).map_or(Outside::Keep, Outside::Head);
                }
                Outside::Keep
            }
        }
    }

    /// A word that is nearly a head keyword and has the look of one: it is read as that keyword.
    fn misspelt(&mut self, i: usize) -> Option<Kind> {
        let token = self.input[i];
        let next = self.input.get(i + 1)?;
        if token.kind != Kind::Ident || next.first || !(next.kind.is_word() || next.kind == Kind::LBrace) {
            return None;
        }
        let word = &self.text[token.start as usize..token.end as usize];
        let heads = KEYWORDS.iter().filter(|k| k.class == Class::Head);
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
        if token.kind == Kind::Error {
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
            Kind::LBrace | Kind::LParen | Kind::LBracket => {
                let brace = token.kind == Kind::LBrace;
                self.braces += usize::from(brace);
                self.brackets.push(Bracket { brace, at: self.out.len() - 1, ..Bracket::default() });
                if self.brackets.len() > MAX_NESTING + 1 {
                    self.too_deep(token, &format!("brackets are nested more than {MAX_NESTING} levels deep"));
                }
            }
            Kind::RParen | Kind::RBracket
                if self.brackets.len() > 1 && self.brackets.last().is_some_and(|b| !b.brace) =>
            {
                self.pop(token);
            }
            Kind::RBrace => self.close(token),
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
        let block = self.current.is_some_and(|c| c.sort == Sort::Item && c.head.has_block());
        if self.braces == 0 && block {
            self.finish();
        }
    }

    fn pop(&mut self, token: Lexeme) {
        let Some(inner) = self.brackets.pop() else { return };
        let height = inner.highest.max(inner.operators + inner.child) + 1;
        if let Some(outer) = self.brackets.last_mut() {
            outer.child = outer.child.max(height);
            outer.element = token.kind == Kind::RBracket;
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
            let brace = Lexeme::synthetic(Kind::RBrace, end);
            self.out.push(brace);
            self.close(brace);
        }
    }

    // ── Height ── the tree of an expression is walked by recursion, so it must not be too high.

    /// Counts the operators that wait for each other; where an operand follows an operand, a new expression starts.
    fn measure(&mut self, token: Lexeme, i: usize) {
        let after_operand = self.before(i).is_some_and(Kind::ends_operand);
        let Some(top) = self.brackets.last_mut() else { return };
        top.element = match token.kind {
            Kind::Dot => top.element,
            kind => top.element && kind.can_be_name(),
        };
        // `a[0][0].x` is as high as it has indices and names after them.
        let part = match token.kind {
            Kind::LBracket => after_operand || self.before(i).is_some_and(Kind::can_be_name),
            Kind::Dot => top.element,
            _ => false,
        };
        // `if` after a block or operand, and the words between the branches of a fork, are no operators of what is before.
        let step = match token.kind {
            Kind::If => after_operand,
            Kind::And | Kind::Or => self.kind(i + 1) == Some(Kind::LBrace),
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
            Kind::Comma | Kind::Semi | Kind::Colon | Kind::Pipe | Kind::Assign | Kind::From => true,
            Kind::True | Kind::False | Kind::Else | Kind::LParen | Kind::LBracket => false,
            // Where an operand is missing, a word is one.
            kind => {
                let word = matches!(kind.class(), Some(Class::Head | Class::Hard));
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
            && current.sort == Sort::Item
        {
            current.sort = Sort::Unread;
            self.diagnostics.push(
                Diagnostic::error(DiagnosticCode::TOO_DEEP, span, message)
                    .help("name parts of it with `const`, or divide it into several declarations"),
            );
        }
    }
}

enum Outside {
    /// Belongs to nothing.
    Skip,
    /// Belongs to the current declaration.
    Keep,
    /// Starts a declaration: a misspelt keyword.
    Head(Kind),
    /// Starts text that no declaration holds.
    Stray,
}
