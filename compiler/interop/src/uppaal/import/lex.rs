//! Text of labels and declarations to tokens, with their places in the file.

use hrdsl_source::{FileId, Span};

use super::fault::UppaalFault;

/// A piece of a file: its characters with their places. In XML the characters are those that the entities stand for.
#[derive(Clone, Debug, Default)]
pub struct UppaalFragment {
    pub file: FileId,
    pub chars: Vec<(u32, char)>,
    /// The place after the last character.
    pub end: u32,
}

impl UppaalFragment {
    /// A whole file.
    pub fn of_file(file: FileId, text: &str) -> Self {
        let chars = text.char_indices().map(|(i, c)| (i as u32, c)).collect();
        Self { file, chars, end: text.len() as u32 }
    }

    pub fn span(&self) -> Span {
        let start = self.chars.first().map_or(self.end, |(at, _)| *at);
        Span { file: self.file, start, end: self.end }
    }

    pub fn text(&self) -> String {
        self.chars.iter().map(|(_, c)| *c).collect()
    }

    pub fn is_blank(&self) -> bool {
        self.chars.iter().all(|(_, c)| c.is_whitespace())
    }

    /// The characters of these indices.
    pub fn part(&self, from: usize, to: usize) -> Self {
        let end = self.chars.get(to).map_or(self.end, |(at, _)| *at);
        let chars = self.chars.get(from..to.min(self.chars.len())).unwrap_or_default().to_vec();
        Self { file: self.file, chars, end }
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum UppaalTokenKind {
    Word(String),
    Int(i64),
    Mark(&'static str),
    End,
}

impl UppaalTokenKind {
    pub fn shown(&self) -> String {
        match self {
            UppaalTokenKind::Word(w) => format!("`{w}`"),
            UppaalTokenKind::Int(n) => format!("`{n}`"),
            UppaalTokenKind::Mark(m) => format!("`{m}`"),
            UppaalTokenKind::End => "the end".to_owned(),
        }
    }
}

#[derive(Clone, Debug)]
pub struct UppaalToken {
    pub tok: UppaalTokenKind,
    pub span: Span,
    /// The comments before it.
    pub comments: Vec<UppaalComment>,
}

#[derive(Clone, Debug)]
pub struct UppaalComment {
    pub lines: Vec<String>,
    /// It begins in the line in which the token before it ends.
    pub trailing: bool,
}

const NO_DOUBLE: &str = "numbers with a fraction (`double`) are not supported";

/// The longest first.
const MARKS: &[&str] = &[
    "<<=", ">>=", "-->", ":=", "==", "!=", "<=", ">=", "<?", ">?", "&&", "||", "++", "--", "+=", "-=", "*=",
    "/=", "%=", "&=", "|=", "^=", "<<", ">>", "->", "=", "<", ">", "+", "-", "*", "/", "%", "!", "?", ":",
    ";", ",", ".", "(", ")", "[", "]", "{", "}", "&", "|", "^", "'", "~", "@", "#",
];

/// All tokens, the last of which is the end.
pub fn lex(piece: &UppaalFragment) -> Result<Vec<UppaalToken>, UppaalFault> {
    let mut lexer = UppaalLexer { piece, at: 0, comments: Vec::new() };
    let mut tokens = Vec::new();
    loop {
        lexer.blanks()?;
        let start = lexer.place();
        let tok = lexer.token()?;
        let is_end = tok == UppaalTokenKind::End;
        let comments = std::mem::take(&mut lexer.comments);
        tokens.push(UppaalToken { tok, span: Span { file: piece.file, start, end: lexer.last() }, comments });
        if is_end {
            return Ok(tokens);
        }
    }
}

struct UppaalLexer<'a> {
    piece: &'a UppaalFragment,
    at: usize,
    /// Since the last token.
    comments: Vec<UppaalComment>,
}

impl UppaalLexer<'_> {
    fn char(&self, ahead: usize) -> Option<char> {
        self.piece.chars.get(self.at + ahead).map(|(_, c)| *c)
    }

    fn place(&self) -> u32 {
        self.piece.chars.get(self.at).map_or(self.piece.end, |(at, _)| *at)
    }

    /// The place after the last character that was taken.
    fn last(&self) -> u32 {
        let last = self.at.checked_sub(1).and_then(|i| self.piece.chars.get(i));
        last.map_or(self.piece.end, |(at, c)| at + c.len_utf8() as u32)
    }

    fn fault(&self, message: impl Into<String>) -> UppaalFault {
        let start = self.place();
        UppaalFault { span: Span { file: self.piece.file, start, end: start }, message: message.into() }
    }

    fn blanks(&mut self) -> Result<(), UppaalFault> {
        // The first line of a piece belongs to nothing before it.
        let mut trailing = self.at > 0;
        loop {
            match (self.char(0), self.char(1)) {
                (Some('\n'), _) => {
                    trailing = false;
                    self.at += 1;
                }
                (Some(c), _) if c.is_whitespace() => self.at += 1,
                (Some('\\'), Some('\n')) => self.at += 2,
                (Some('/'), Some('/')) => {
                    let start = self.at + 2;
                    while self.char(0).is_some_and(|c| c != '\n') {
                        self.at += 1;
                    }
                    self.keep(start, self.at, trailing);
                }
                (Some('/'), Some('*')) => {
                    let start = self.at + 2;
                    self.comment()?;
                    self.keep(start, self.at - 2, trailing);
                }
                _ => return Ok(()),
            }
        }
    }

    /// Keeps a comment, without what only frames it.
    fn keep(&mut self, start: usize, end: usize, trailing: bool) {
        let text = self.piece.part(start, end.max(start)).text();
        let is_frame = |c: char| c.is_whitespace() || matches!(c, '*' | '/' | '=' | '-');
        let lines = text.lines().map(|line| line.trim().trim_start_matches('*').trim());
        let lines: Vec<String> = lines.filter(|l| !l.chars().all(is_frame)).map(str::to_owned).collect();
        if !lines.is_empty() {
            self.comments.push(UppaalComment { lines, trailing });
        }
    }

    fn comment(&mut self) -> Result<(), UppaalFault> {
        let open = self.fault("this comment is not closed: `*/` is missing");
        self.at += 2;
        loop {
            match (self.char(0), self.char(1)) {
                (Some('*'), Some('/')) => {
                    self.at += 2;
                    return Ok(());
                }
                (Some(_), _) => self.at += 1,
                (None, _) => return Err(open),
            }
        }
    }

    fn token(&mut self) -> Result<UppaalTokenKind, UppaalFault> {
        let Some(c) = self.char(0) else { return Ok(UppaalTokenKind::End) };
        if c.is_ascii_alphabetic() || c == '_' {
            return Ok(UppaalTokenKind::Word(
                self.run(|c| c.is_ascii_alphanumeric() || c == '_' || c == '$'),
            ));
        }
        if c.is_ascii_digit() {
            return self.number();
        }
        let fits = |mark: &&&str| mark.chars().enumerate().all(|(i, m)| self.char(i) == Some(m));
        let Some(mark) = MARKS.iter().find(fits) else {
            return Err(self.fault(format!("`{c}` is not part of the language of UPPAAL's models")));
        };
        self.at += mark.len();
        Ok(UppaalTokenKind::Mark(mark))
    }

    fn run(&mut self, belongs: impl Fn(char) -> bool) -> String {
        let mut word = String::new();
        while let Some(c) = self.char(0).filter(|c| belongs(*c)) {
            word.push(c);
            self.at += 1;
        }
        word
    }

    fn number(&mut self) -> Result<UppaalTokenKind, UppaalFault> {
        let start = self.at;
        let digits = self.run(|c| c.is_ascii_digit());
        if self.char(0) == Some('.') && self.char(1).is_some_and(|c| c.is_ascii_digit()) {
            self.at = start;
            return Err(self.fault(NO_DOUBLE));
        }
        let span = |lexer: &Self| Span {
            file: lexer.piece.file,
            start: lexer.piece.chars[start].0,
            end: lexer.last(),
        };
        if self.char(0).is_some_and(|c| c.is_ascii_alphabetic() || c == '_') {
            let tail = self.run(|c| c.is_ascii_alphanumeric() || c == '_');
            if tail.strip_prefix(['e', 'E']).is_some_and(|rest| rest.chars().all(|c| c.is_ascii_digit())) {
                return Err(UppaalFault { span: span(self), message: NO_DOUBLE.to_owned() });
            }
            let hex = tail.strip_prefix(['x', 'X']).and_then(|hex| i64::from_str_radix(hex, 16).ok());
            let next = match hex.filter(|_| digits == "0") {
                Some(n) => format!("write `{n}`"),
                None => "a space or an operator is missing".to_owned(),
            };
            let message = format!("`{digits}{tail}` is no number: UPPAAL's are decimal; {next}");
            return Err(UppaalFault { span: span(self), message });
        }
        let number = digits.parse::<i64>().ok().filter(|n| *n <= i64::from(i32::MAX));
        number.map(UppaalTokenKind::Int).ok_or_else(|| UppaalFault {
            span: span(self),
            message: format!("{digits} is larger than UPPAAL's integers"),
        })
    }
}
