//! Text to tokens: comments go, doc comments are kept aside, a number takes the unit after it.

use hrdsl_source::{Diagnostic, DiagnosticCode, FileId, Span};
use logos::Logos;

use crate::token::{KeywordClass, Lexeme, TokenKind, TokenTrait};
use crate::words;

/// The tokens of a file, and what was found on the way.
pub(crate) struct LexedFile {
    pub tokens: Vec<Lexeme>,
    /// Doc comments, by the start of the token that they stand before, in order.
    pub docs: Vec<(u32, String)>,
    pub diagnostics: Vec<Diagnostic>,
}

/// Reads a text; what it cannot read becomes an error token and a diagnostic.
pub(crate) fn lex(file: FileId, text: &str) -> LexedFile {
    let mut scan = LexemeScanner {
        file,
        text,
        raw: Vec::with_capacity(text.len() / 5 + 8),
        docs: Vec::new(),
        doc: None,
        first: true,
        diagnostics: Vec::new(),
    };
    scan.run();
    let LexemeScanner { raw, docs, mut diagnostics, .. } = scan;
    let mut tokens = LexemeJoiner {
        file,
        text,
        raw: &raw,
        out: Vec::with_capacity(raw.len()),
        diagnostics: &mut diagnostics,
    }
    .run();
    words::names(&mut tokens);
    LexedFile { tokens, docs, diagnostics }
}

/// First pass: the tokens as logos sees them.
struct LexemeScanner<'t> {
    file: FileId,
    text: &'t str,
    raw: Vec<Lexeme>,
    docs: Vec<(u32, String)>,
    doc: Option<String>,
    first: bool,
    diagnostics: Vec<Diagnostic>,
}

impl LexemeScanner<'_> {
    fn run(&mut self) {
        let text = self.text;
        let bom = if text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
        let mut lexer = TokenKind::lexer(text);
        lexer.bump(bom);
        while let Some(result) = lexer.next() {
            let span = lexer.span();
            match result {
                Ok(TokenKind::Newline) => self.first = true,
                Ok(TokenKind::Comment) => self.comment(&text[span]),
                Ok(TokenKind::OpenStr) => {
                    self.unterminated(&text[span.clone()], span.start);
                    self.push(TokenKind::Str, span.start, span.end);
                }
                Ok(TokenKind::Str) => {
                    if text[span.clone()].contains('\\') {
                        self.escapes(&text[span.clone()], span.start);
                    }
                    self.push(TokenKind::Str, span.start, span.end);
                }
                Ok(kind) => self.push(kind, span.start, span.end),
                Err(()) => {
                    let end = self.bad(span.start);
                    lexer.bump(end.saturating_sub(span.end));
                }
            }
        }
    }

    fn push(&mut self, kind: TokenKind, start: usize, end: usize) {
        let (start, end) = (start as u32, end as u32);
        if let Some(doc) = self.doc.take() {
            self.docs.push((start, doc));
        }
        self.raw.push(Lexeme { kind, first: self.first, start, end, unit: end });
        self.first = false;
    }

    /// Keeps the text of a `///` line; `//` and `////` are plain comments.
    fn comment(&mut self, comment: &str) {
        let Some(line) = comment.strip_prefix("///").filter(|rest| !rest.starts_with('/')) else { return };
        let line = line.strip_prefix(' ').unwrap_or(line).trim_end();
        match &mut self.doc {
            Some(doc) => {
                doc.push('\n');
                doc.push_str(line);
            }
            None => self.doc = Some(line.to_owned()),
        }
    }

    fn unterminated(&mut self, string: &str, start: usize) {
        let end = start + string.trim_end().len();
        let span = Span::new(self.file, start, end.max(start + 1));
        self.diagnostics.push(
            Diagnostic::error(
                DiagnosticCode::UNTERMINATED_STRING,
                span,
                "the string has no end on this line",
            )
            .here("starts here")
            .help("put `\"` at its end; a line break within is written `\\n`"),
        );
    }

    fn escapes(&mut self, string: &str, start: usize) {
        let mut chars = string.char_indices();
        while let Some((at, c)) = chars.next() {
            if c != '\\' {
                continue;
            }
            let Some((_, escaped)) = chars.next() else { return };
            if !matches!(escaped, '"' | '\\' | 'n') {
                let span = Span::new(self.file, start + at, start + at + 1 + escaped.len_utf8());
                self.diagnostics.push(
                    Diagnostic::error(
                        DiagnosticCode::BAD_CHARACTER,
                        span,
                        format!("there is no escape `\\{escaped}`"),
                    )
                    .help("the escapes are `\\\"`, `\\\\` and `\\n`"),
                );
            }
        }
    }

    /// Takes a run of text that is no token, and gives its end.
    fn bad(&mut self, start: usize) -> usize {
        let rest = &self.text[start..];
        let Some(c) = rest.chars().next() else { return start };
        if c == '#' {
            return self.hash(start);
        }
        if c.is_alphabetic() {
            return self.bad_word(start);
        }
        let end = start + rest.chars().take_while(|other| *other == c).count() * c.len_utf8();
        let shown = if c.is_control() || c.is_whitespace() {
            format!("U+{:04X}", u32::from(c))
        } else {
            c.to_string()
        };
        let span = Span::new(self.file, start, end);
        let mut diagnostic = Diagnostic::error(
            DiagnosticCode::BAD_CHARACTER,
            span,
            format!("the language does not use the character `{shown}`"),
        );
        if let Some(help) = instead_of(c) {
            diagnostic = diagnostic.help(help);
        }
        if let Some((text, certain)) = replacement(c)
            && (end - start == c.len_utf8() || text == " ")
        {
            let text = text.repeat((end - start) / c.len_utf8());
            let title = if text.trim().is_empty() {
                "put a plain blank here".to_owned()
            } else {
                format!("replace `{c}` by `{}`", text.trim())
            };
            diagnostic = diagnostic.fix(title, span, text, certain);
        }
        self.diagnostics.push(diagnostic);
        self.push(TokenKind::Error, start, end);
        end
    }

    /// A comment as other languages have it: to the end of the line.
    fn hash(&mut self, start: usize) -> usize {
        let rest = &self.text[start..];
        let end = start + rest.find('\n').unwrap_or(rest.len());
        let marks = start + rest.len() - rest.trim_start_matches('#').len();
        let span = Span::new(self.file, start, marks);
        self.diagnostics.push(
            Diagnostic::error(DiagnosticCode::BAD_CHARACTER, span, "comments begin with `//`, not with `#`")
                .here("the rest of the line is read as a comment")
                .help("write `//`")
                .fix("replace `#` by `//`", span, "//", true),
        );
        end
    }

    /// A word with letters that are not ASCII; the ASCII part before it, if any, has been read as a token.
    fn bad_word(&mut self, at: usize) -> usize {
        let rest = &self.text[at..];
        let end = at + rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
        let mut start = at;
        if let Some(last) = self.raw.last()
            && last.end as usize == at
            && last.kind.is_word()
        {
            start = last.start as usize;
            self.first = last.first;
            self.raw.pop();
        }
        let word = &self.text[start..end];
        let span = Span::new(self.file, start, end);
        self.diagnostics.push(
            Diagnostic::error(
                DiagnosticCode::BAD_CHARACTER,
                span,
                format!("`{word}` has letters that a name cannot have"),
            )
            .help("names are made of the letters a to z and A to Z, digits and `_`"),
        );
        self.push(TokenKind::Error, start, end);
        end
    }
}

/// What to write in place of a character that people type or paste.
fn instead_of(c: char) -> Option<&'static str> {
    Some(match c {
        '&' => "`and` is written `&&` or `and`",
        '\'' | '`' | '‘' | '’' | '“' | '”' | '«' | '»' => "texts are written between `\"` and `\"`",
        '\\' => "`not equal` is written `!=`",
        '≤' => "write `<=`",
        '≥' => "write `>=`",
        '≠' => "write `!=`",
        '→' => "write `->`",
        '…' => "write `..`",
        '×' | '·' => "write `*`",
        '−' | '–' | '—' => "write `-`",
        '°' => "angles are written in `deg`",
        '\u{a0}' => "this is a blank that does not break; write a plain blank",
        _ => return None,
    })
}

/// The text in place of such a character, and whether it can have meant nothing else. A dash may be a range or a minus,
/// a point between numbers a decimal one: those are offered only.
fn replacement(c: char) -> Option<(&'static str, bool)> {
    Some(match c {
        '≤' => ("<=", true),
        '≥' => (">=", true),
        '≠' => ("!=", true),
        '→' => ("->", true),
        '×' => ("*", true),
        '−' => ("-", true),
        '\u{a0}' => (" ", true),
        '&' => ("&&", false),
        '[' => ("(", false),
        ']' => (")", false),
        '…' => ("..", false),
        '·' => ("*", false),
        '–' | '—' => ("-", false),
        '°' => (" deg", false),
        _ => return None,
    })
}

/// Second pass: numbers take their units; words take the role that their neighbours give them.
struct LexemeJoiner<'t> {
    file: FileId,
    text: &'t str,
    raw: &'t [Lexeme],
    out: Vec<Lexeme>,
    diagnostics: &'t mut Vec<Diagnostic>,
}

impl LexemeJoiner<'_> {
    fn run(mut self) -> Vec<Lexeme> {
        let mut i = 0;
        while i < self.raw.len() {
            let token = self.raw[i];
            let taken = match token.kind {
                TokenKind::Int | TokenKind::Float => self.number(i),
                TokenKind::Dot if self.starts_internal(i) => {
                    self.out.push(Lexeme { kind: TokenKind::Internal, ..token });
                    1
                }
                kind if kind.is_word() => {
                    self.out.push(Lexeme { kind: self.word(i), ..token });
                    1
                }
                _ => {
                    self.out.push(token);
                    1
                }
            };
            i += taken;
        }
        self.out
    }

    fn kind(&self, i: usize) -> Option<TokenKind> {
        self.raw.get(i).map(|t| t.kind)
    }

    /// A dot right before a name, and after nothing that has parts: `.count`. After a name or index a dot is always that
    /// of a part, also on a new line; after a keyword, as in `while .count(…)` or
    /// `when .member(…)`, it is one right after it.
    fn starts_internal(&self, i: usize) -> bool {
        let dot = self.raw[i];
        let named = self.raw.get(i + 1).is_some_and(|t| t.start == dot.end && t.kind.is_word());
        let part = self.out.last().is_some_and(|before| match before.kind {
            TokenKind::RBrace => false,
            // Words that an expression may follow.
            TokenKind::While | TokenKind::For | TokenKind::Where => before.end == dot.start,
            kind => kind.ends_operand() || (kind.can_be_name() && before.end == dot.start),
        });
        named && !part
    }

    /// The kind of a word: a name before `->` is an origin, and after a dot every word is a name.
    fn word(&self, i: usize) -> TokenKind {
        let kind = self.raw[i].kind;
        if kind.can_be_name() && self.kind(i + 1) == Some(TokenKind::Arrow) {
            return TokenKind::From;
        }
        let hard =
            matches!(kind.class(), Some(KeywordClass::Head | KeywordClass::Hard | KeywordClass::Reserved));
        if hard
            && !self.raw[i].first
            && self.out.last().is_some_and(|t| matches!(t.kind, TokenKind::Dot | TokenKind::Internal))
        {
            return TokenKind::Ident;
        }
        kind
    }

    /// A number with its unit; gives how many tokens it took.
    fn number(&mut self, i: usize) -> usize {
        let number = self.raw[i];
        let mut token = number;
        let taken = self.unit(i);
        if taken > 0 {
            token = Lexeme {
                kind: TokenKind::Quantity,
                end: self.raw[i + taken].end,
                unit: self.raw[i + 1].start,
                ..number
            };
        }
        let digits = &self.text[number.start as usize..number.end as usize];
        let fits = if token.kind == TokenKind::Int {
            digits.len() < 19 || digits.parse::<i64>().is_ok()
        } else {
            digits.parse::<f64>().is_ok_and(f64::is_finite)
        };
        if !fits {
            let span = Span::new(self.file, number.start as usize, number.end as usize);
            let message = if token.kind == TokenKind::Int {
                "the number is larger than 9223372036854775807"
            } else {
                "the number is too large to be represented"
            };
            self.diagnostics.push(Diagnostic::error(DiagnosticCode::BAD_NUMBER, span, message));
            token.kind = TokenKind::Error;
        }
        self.out.push(token);
        taken + 1
    }

    /// How many tokens after the number at `i` are its unit: none, one (`s`, `%`), three (`m/s`), five (`m/s^2`).
    fn unit(&self, i: usize) -> usize {
        let taken = self.plain_unit(i);
        if taken > 0
            && let (Some(last), Some(caret)) = (self.raw.get(i + taken), self.raw.get(i + taken + 1))
            && let Some(power) = self.raw.get(i + taken + 2)
            && (caret.kind, power.kind) == (TokenKind::Caret, TokenKind::Int)
            && (last.end, caret.end) == (caret.start, power.start)
        {
            return taken + 2;
        }
        taken
    }

    fn plain_unit(&self, i: usize) -> usize {
        let Some(unit) = self.raw.get(i + 1).filter(|t| !t.first) else { return 0 };
        let after = self.raw.get(i + 2).filter(|t| !t.first);
        if unit.kind == TokenKind::Percent {
            // `50 %` is a quantity, `7 % 2` a remainder; in `2 % late 50 ms` a clause follows.
            let of_clause = self.raw.get(i + 3).is_some_and(|t| {
                !t.first && matches!(t.kind, TokenKind::Int | TokenKind::Float | TokenKind::Ident)
            });
            let clause = after.is_some_and(|t| of_clause && t.kind.is(TokenTrait::Sensing));
            return usize::from(clause || !after.is_some_and(|t| t.kind.starts_operand()));
        }
        if unit.kind != TokenKind::Ident || self.counts_events() {
            return 0;
        }
        if let Some(slash) = after
            && slash.kind == TokenKind::Slash
            && slash.start == unit.end
            && let Some(per) = self.raw.get(i + 3)
            && per.kind == TokenKind::Ident
            && per.start == slash.end
        {
            return 3;
        }
        let is_name = after.is_some_and(|t| t.kind.is(TokenTrait::AfterName));
        usize::from(!is_name)
    }

    /// In `at most 4 leg_request` and `exactly 4 leg_request` the word after the number is an event.
    fn counts_events(&self) -> bool {
        let bounds = |kind| matches!(kind, TokenKind::Most | TokenKind::Least);
        match self.out.as_slice() {
            // In `for at most 4 s` it is a unit.
            [.., word, at, bound] if at.kind == TokenKind::At && bounds(bound.kind) => {
                word.kind != TokenKind::For
            }
            [.., exactly] => exactly.kind == TokenKind::Exactly,
            [] => false,
        }
    }
}
